//! Modifier volumes of projects of other slicers as regions.
//!
//! What PrusaSlicer, OrcaSlicer and Bambu Studio call these settings, and what they mean here:
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
use crate::layer_angles::LayerAngles;
use crate::regions::{JobRegion, RegionPlace};
use crate::settings::Settings;

/// Keys that say where a volume comes from and how it was placed, which the triangles hold already.
const BOOKKEEPING: [&str; 3] = ["matrix", "mesh_stat", "source_"];

/// The region that a modifier volume is, if it has a setting that a region can have; and the settings that none can
/// have. `name` stands for its mesh.
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
        // The extruder 0 is that of the whole object.
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

/// Takes over a setting; `None` where there is no word for it, or for its value.
fn set(region: &mut JobRegion, key: &str, value: &str) -> Option<()> {
    let number = || value.trim_end_matches('%').trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let count = || value.parse::<usize>().ok().filter(|n| *n <= 1000);
    match key {
        "fill_density" | "sparse_infill_density" => {
            // With a percent sign it counts hundredths; old files have the share itself.
            let share = number()? * if value.ends_with('%') { 0.01 } else { 1.0 };
            region.density = Some(Density::new((0.0..=1.0).contains(&share).then_some(share)?));
        }
        "fill_pattern" | "sparse_infill_pattern" => region.pattern = Some(pattern(value)?),
        "fill_angle" | "infill_direction" => {
            // Both programs turn the lines of such patterns by a right angle from layer to layer. Patterns that
            // do not turn take the first angle.
            let angle = number().filter(|a| a.abs() <= 3600.0)?;
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

/// The pattern that the others call so.
fn pattern(word: &str) -> Option<Pattern> {
    Some(match word {
        // OrcaSlicer calls it zig-zag, Bambu Studio writes one word.
        "rectilinear" | "zig-zag" | "zigzag" => Pattern::Rectilinear,
        "alignedrectilinear" => Pattern::Aligned,
        "grid" => Pattern::Grid,
        "triangles" => Pattern::Triangles,
        "concentric" => Pattern::Concentric,
        "honeycomb" => Pattern::Honeycomb,
        "gyroid" => Pattern::Gyroid,
        // Cubic, lightning, Hilbert curves and others have no like here; the job's own pattern stays.
        _ => return None,
    })
}

impl Settings {
    /// The settings with one region more, which comes last.
    ///
    /// # Errors
    /// Where the settings of the job do not fit together in the region, or go without regions.
    pub fn with_region(&self, region: JobRegion) -> Result<Self, String> {
        // A setting that is sound for the part may need what a region lacks, and some jobs take no regions at all.
        let mut all = self.clone();
        all.regions.push(region);
        crate::combinations::check(&all).map(|()| all)
    }
}
