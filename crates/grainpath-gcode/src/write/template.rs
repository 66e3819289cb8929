//! Fills in placeholders in the printer's own G-code templates.

use super::{GcodeError, WriteConfig};

/// Placeholders and their values.
pub(super) struct Values(Vec<(&'static str, String)>);

/// The placeholders that every template may use.
pub(super) fn values(config: &WriteConfig, n_layers: usize, z_max_mm: f64) -> Values {
    let (machine, material) = (&config.machine, &config.material);
    Values(vec![
        ("nozzle_temp_c", material.nozzle_temp_c.to_string()),
        ("first_layer_nozzle_temp_c", material.first_layer_nozzle_temp_c.to_string()),
        ("bed_temp_c", material.bed_temp_c.to_string()),
        ("first_layer_bed_temp_c", material.first_layer_bed_temp_c.to_string()),
        ("bed_x_mm", machine.bed_mm[0].to_string()),
        ("bed_y_mm", machine.bed_mm[1].to_string()),
        ("bed_z_mm", machine.bed_mm[2].to_string()),
        ("z_max_mm", format!("{z_max_mm:.3}")),
        // 10 mm above the part, so that the nozzle clears it, but within the height of the printer.
        ("z_park_mm", format!("{:.3}", (z_max_mm + 10.0).min(machine.bed_mm[2]))),
        ("nozzle_mm", machine.nozzle_mm.to_string()),
        ("filament_mm", machine.filament_mm.to_string()),
        ("layers", n_layers.to_string()),
        ("material", material.name.clone()),
    ])
}

impl Values {
    /// Adds placeholders.
    pub(super) fn extend(&mut self, more: impl IntoIterator<Item = (&'static str, String)>) {
        self.0.extend(more);
    }

    /// Fills `{placeholders}` in. Braces around anything but a name are left as they are.
    pub(super) fn filled(&self, template: &'static str, text: &str) -> Result<String, GcodeError> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(open) = rest.find('{') {
            out.push_str(&rest[..open]);
            rest = &rest[open..];
            let name = rest.find('}').map_or("", |close| &rest[1..close]);
            // Klipper's macros use braces for their own expressions.
            let is_name = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
            if !is_name {
                out.push('{');
                rest = &rest[1..];
                continue;
            }
            // A misspelled placeholder would reach the printer as text and be ignored there.
            let Some((_, value)) = self.0.iter().find(|(n, _)| *n == name) else {
                let near = grainpath_core::spelling::near(name, self.0.iter().map(|(n, _)| *n));
                return Err(GcodeError::UnknownPlaceholder {
                    template,
                    name: name.to_owned(),
                    near: near.map(str::to_owned),
                });
            };
            out.push_str(value);
            rest = &rest[name.len() + 2..];
        }
        out.push_str(rest);
        Ok(out)
    }
}
