//! `grainpath support`: grows the supports of a mesh and writes them as a mesh.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use grainpath::Error;
use grainpath::measure::report::SupportReport;
use grainpath::run::config;
use grainpath::run::{Sliced, mesh_and_layers};
use grainpath::support::{self, Support as Planned};
use grainpath_core::{Diagnostics, LayerStack, TriMesh, WarningId};
use grainpath_io::MeshFile;
use grainpath_job::Settings;
use grainpath_job::choices::SupportStyle;
use serde_json::json;

use crate::args::Support;
use crate::claims::Claims;
use crate::inputs::{read_body, set_threads, settings};
use crate::outputs::{MeshEnding, write_mesh};
use crate::{Failure, files, memory, outputs, progress};

/// `grainpath support`
pub(crate) fn support(args: &Support) -> Result<(), Failure> {
    let mut settings = settings("", "--set", &args.common.sets, Path::new(""))?;
    // The default of a job is no support, but the user of this command wants supports.
    if settings.support.style == SupportStyle::None {
        settings.support.style = SupportStyle::Tree;
    }
    set_threads(args.common.threads)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.model));
    // A wrong file ending is refused before any work is done.
    MeshEnding::from_path(&output)?;
    let mut claims = Claims::default();
    claims.read("model", &args.model);
    claims.write("--output", &output);
    if let Some(folder) = &args.preview {
        claims.write_into("--preview", folder, |name| {
            name.strip_suffix(".png").is_some_and(|name| grainpath_view::support::NAMES.contains(&name))
        });
    }
    claims.check()?;
    let diagnostics = progress::diagnostics();
    settings.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
    let (file, read_s) = read_body(&settings, &args.model, &diagnostics)?;
    let mut stages: BTreeMap<&str, f64> = BTreeMap::from([("read", read_s)]);
    let grown = grow(&settings, file, &args.model.display().to_string(), &diagnostics)?;
    let Grown { mesh, stack, support: found, surface: body, slice_s, support_s } = grown;
    stages.extend([("slice", slice_s), ("support", support_s)]);
    let start = Instant::now();
    let mut written = BTreeMap::new();
    if body.triangles.is_empty() && !args.with_model {
        // A part without overhangs has been warned of already.
        if !diagnostics.warnings().iter().any(|w| w.id == WarningId::SupportNone) {
            diagnostics.warn(WarningId::SupportNone, "support: nothing to write");
        }
    }
    args.common.refuse(&diagnostics.warnings(), false)?;
    if !body.triangles.is_empty() || args.with_model {
        let mut bodies = vec![&body];
        if args.with_model {
            // Both bodies keep the coordinates of the sliced part, so that they fit together in another
            // slicer.
            bodies.push(&mesh);
        }
        write_mesh(&output, &bodies)?;
        written.insert("support", output.display().to_string());
    }
    if let Some(folder) = &args.preview {
        for p in grainpath_view::support::pictures(&mesh, &found) {
            outputs::save(&folder.join(format!("{}.png", p.name)), &p.png)?;
        }
        written.insert("preview", folder.display().to_string());
    }
    stages.insert("write", start.elapsed().as_secs_f64());
    let (beads, solid) = (found.beads_mm3(&stack), found.volume_mm3(&stack));
    let report = SupportReport::new(&found, beads, solid, settings.material.density_g_cm3);
    let warnings = diagnostics.warnings();
    drop(diagnostics);
    if args.common.json {
        let seconds = |s: f64| (s * 1e4).round() / 1e4;
        let stages: BTreeMap<&str, f64> = stages.into_iter().map(|(k, s)| (k, seconds(s))).collect();
        let value = json!({
            "ok": true, "version": env!("CARGO_PKG_VERSION"), "layers": stack.layers().len(),
            "support": report, "triangles": body.triangles.len(), "stages_s": stages,
            "peak_rss_mb": memory::peak_rss_mb(), "warnings": warnings, "outputs": written,
        });
        files::print(&format!("{value}\n"));
    } else {
        let mut lines = vec![report.summary()];
        lines.extend(warnings.iter().map(|w| format!("warning: {w}")));
        lines.extend(written.iter().map(|(what, path)| format!("{what}: {path}")));
        files::print(&format!("{}\n", lines.join("\n")));
    }
    Ok(())
}

/// A mesh and its supports.
pub struct Grown {
    /// The mesh as it is sliced.
    pub mesh: TriMesh,
    /// Its layers.
    pub stack: LayerStack,
    /// The supports.
    pub support: Planned,
    /// The surface of the supports; empty if the part has no overhang.
    pub surface: TriMesh,
    /// Seconds of slicing.
    pub slice_s: f64,
    /// Seconds of growing supports and their surface.
    pub support_s: f64,
}

/// Grows the supports of a mesh, which is called `name` in errors.
///
/// # Errors
/// For a mesh that cannot be sliced, and a style without supports.
pub fn grow(
    settings: &Settings,
    file: MeshFile,
    name: &str,
    diagnostics: &Diagnostics,
) -> Result<Grown, Failure> {
    let (mesh, stack, found, [slice_s, grow_s]) = supported(settings, file, name, diagnostics)?;
    let start = Instant::now();
    let layers = &found.cut.layers;
    let surface =
        support::surface(layers, &stack, settings.support.solid, diagnostics).map_err(Error::from)?;
    let support_s = grow_s + start.elapsed().as_secs_f64();
    Ok(Grown { mesh, stack, support: found, surface, slice_s, support_s })
}

/// Slices a mesh and grows its supports. Returns the mesh, the layers, the supports, and the seconds of both steps.
///
/// # Errors
/// As [`grow`].
pub(super) fn supported(
    settings: &Settings,
    file: MeshFile,
    name: &str,
    diagnostics: &Diagnostics,
) -> Result<(TriMesh, LayerStack, Planned, [f64; 2]), Failure> {
    let start = Instant::now();
    let Sliced { mesh, stack, painted, .. } = mesh_and_layers(&config::placing(settings), file, diagnostics)
        .map_err(|source| Error::Shape { path: name.to_owned(), source })?;
    let slice_s = start.elapsed().as_secs_f64();
    // Only a job knows where the part stands on the bed. Here the part keeps the coordinates of its file,
    // so the bed does not limit the supports.
    let wanted = config::support(settings, None, painted);
    let wanted = wanted.ok_or_else(|| Failure::usage("support.style should be tree, columns or box"))?;
    let found = support::plan(&mesh, &stack, &wanted, diagnostics).map_err(Error::from)?;
    let grow_s = start.elapsed().as_secs_f64() - slice_s;
    Ok((mesh, stack, found, [slice_s, grow_s]))
}

fn default_output(model: &Path) -> PathBuf {
    model.with_file_name(outputs::named_after(model, "_support.stl"))
}
