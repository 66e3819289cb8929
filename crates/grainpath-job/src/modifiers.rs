//! Modifier volumes of projects of other slicers as regions.
//!
//! The names of these settings in PrusaSlicer, OrcaSlicer and Bambu Studio, and the settings of a region that they become:
//!
//! | PrusaSlicer | OrcaSlicer, Bambu Studio | region |
//! |---|---|---|
//! | `fill_density` | `sparse_infill_density` | `fill.density` |
//! | `fill_pattern` | `sparse_infill_pattern` | `fill.pattern` |
//! | `fill_angle` | `infill_direction` | `fill.angles_deg`: the angle, and a right angle more in every other layer |
//! | `perimeters` | `wall_loops` | `process.walls` |
//! | `top_solid_layers` | `top_shell_layers` | `process.top_layers` |
//! | `bottom_solid_layers` | `bottom_shell_layers` | `process.bottom_layers` |
//!
//! ```
//! use grainpath_job::modifiers::region_of_modifier;
//! use grainpath_job::regions::RegionPlace;
//!
//! let settings = [("fill_density", "80%"), ("perimeters", "4"), ("seam_position", "rear")];
//! let settings = settings.map(|(key, value)| (key.to_owned(), value.to_owned()));
//! let (region, unread) = region_of_modifier("block", &settings);
//! let region = region.unwrap();
//! assert_eq!((region.density.unwrap().fraction(), region.walls), (0.8, Some(4)));
//! assert_eq!((region.on, unread.as_slice()), (RegionPlace::Mesh("block".into()), ["seam_position = rear".to_owned()].as_slice()));
//! ```

use grainpath_core::Density;

use crate::choices::Pattern;
use crate::combination_error::Combination;
use crate::layer_angles::LayerAngles;
use crate::regions::{JobRegion, RegionPlace};
use crate::settings::Settings;

/// Beginnings of the keys that state the origin of a volume and its placement. These keys are ignored, since the triangles are already placed.
const BOOKKEEPING: [&str; 3] = ["matrix", "mesh_stat", "source_"];

/// The region that a modifier volume becomes, or `None` if it has no setting that a region can have; and its settings that a
/// region cannot have. `name` stands for its mesh.
pub fn region_of_modifier(name: &str, settings: &[(String, String)]) -> (Option<JobRegion>, Vec<String>) {
    let mut region = JobRegion {
        on: RegionPlace::Mesh(name.to_owned()),
        pattern: None,
        density: None,
        angles_deg: None,
        lines: None,
        walls: None,
        top_layers: None,
        bottom_layers: None,
        guide: true,
    };
    let (mut read, mut unread) = (0, Vec::new());
    for (key, value) in settings {
        // Extruder 0 means the extruder of the whole object, so the setting has no effect.
        if BOOKKEEPING.iter().any(|head| key.starts_with(head)) || (key == "extruder" && value == "0") {
            continue;
        }
        if set(&mut region, key, value.trim()).is_some() {
            read += 1;
        } else {
            unread.push(format!("{key} = {value}"));
        }
    }
    ((read > 0).then_some(region), unread)
}

/// Takes over a setting; `None` if the setting or its value has no counterpart here.
fn set(region: &mut JobRegion, key: &str, value: &str) -> Option<()> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let count = || value.parse::<usize>().ok().filter(|n| *n <= 1000);
    match key {
        "fill_density" | "sparse_infill_density" => {
            // A number with a percent sign is in percent; old files state a fraction.
            let share = match value.strip_suffix('%') {
                Some(percent) => 0.01 * number(percent)?,
                None => number(value)?,
            };
            region.density = Some(Density::new((0.0..=1.0).contains(&share).then_some(share)?));
        }
        "fill_pattern" | "sparse_infill_pattern" => region.pattern = Some(pattern(value)?),
        "fill_angle" | "infill_direction" => {
            // The other slicers turn rectilinear lines by a right angle from layer to layer. Patterns that do not
            // turn take the first angle.
            let angle = number(value).filter(|a| a.abs() <= 3600.0)?;
            region.angles_deg = Some(LayerAngles::all(vec![angle, angle + 90.0]));
        }
        "perimeters" | "wall_loops" => region.walls = Some(count()?),
        "top_solid_layers" | "top_shell_layers" => region.top_layers = Some(count()?),
        "bottom_solid_layers" | "bottom_shell_layers" => region.bottom_layers = Some(count()?),
        // Speeds, temperatures, seams and the like hold for the whole part here.
        _ => return None,
    }
    Some(())
}

/// The pattern that has this name in the other slicers.
fn pattern(word: &str) -> Option<Pattern> {
    Some(match word {
        // Rectilinear lines are called zig-zag or zigzag in files of OrcaSlicer and Bambu Studio.
        "rectilinear" | "zig-zag" | "zigzag" => Pattern::Rectilinear,
        "alignedrectilinear" => Pattern::Aligned,
        "grid" => Pattern::Grid,
        "triangles" => Pattern::Triangles,
        "concentric" => Pattern::Concentric,
        "honeycomb" => Pattern::Honeycomb,
        "gyroid" => Pattern::Gyroid,
        // Cubic, lightning, Hilbert curves and others have no counterpart here; the job's own pattern stays.
        _ => return None,
    })
}

impl Settings {
    /// The settings with this region added as the last one.
    ///
    /// # Errors
    /// If the settings of the job and the region do not fit together, or if the job allows no regions.
    pub fn with_region(&self, region: JobRegion) -> Result<Self, Combination> {
        // A valid setting of the part may need something that a region lacks, and some jobs allow no regions.
        let mut all = self.clone();
        all.regions.push(region);
        crate::combinations::check(&all).map(|()| all)
    }
}
