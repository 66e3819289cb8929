//! Warnings: what was assumed, repaired or left out, with a stable id, the place and a remedy.
//!
//! A warning is data. A front end prints it, a program filters it by id, and `--strict` refuses a
//! run that has any. The table in this file is the only list of ids; `docs/warnings.md` repeats it,
//! and a test compares the two.
//!
//! ```
//! use grainpath_core::{Diagnostics, Warning, WarningId};
//!
//! let diagnostics = Diagnostics::default();
//! diagnostics.warn(WarningId::MeshOpen, "12 open edges; the sections were closed where they are cut");
//! let narrow = Warning::new(WarningId::PathNeck, "the neck is too narrow").in_layer(4, 1.0).at_mm(3.0, 2.0);
//! diagnostics.push(narrow.with_remedy("make it 0.54 mm wide, or the bead narrower"));
//!
//! let all = diagnostics.warnings();
//! assert_eq!(all[0].id.name(), "mesh-open");
//! assert_eq!(all[1].place.as_ref().unwrap().to_string(), "layer 5 at z = 1.00 mm, (3.00, 2.00)");
//! ```

use std::borrow::Cow;
use std::cmp::Ordering;
use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Makes the enum and its table from one list: variant = id, what it means, the usual remedy.
macro_rules! warning_ids {
    ($($variant:ident = $id:literal, $meaning:literal, $remedy:literal;)*) => {
        /// What kind of warning it is. The name of a kind never changes once it is released.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum WarningId {
            $(#[doc = $meaning] $variant,)*
        }

        impl WarningId {
            /// Every kind, in the order of the documentation.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The stable name used in JSON and in the terminal.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $id,)* }
            }

            /// What happened, for the documentation.
            pub const fn meaning(self) -> &'static str {
                match self { $(Self::$variant => $meaning,)* }
            }

            /// What usually helps; a warning may state a more precise remedy of its own.
            pub const fn remedy(self) -> &'static str {
                match self { $(Self::$variant => $remedy,)* }
            }
        }
    };
}

warning_ids! {
    JobRenamed = "job-renamed",
        "The job uses an old name of a setting or word; it was read under its new name.",
        "write the new name";
    JobRemoved = "job-removed",
        "The job sets a key that is no setting any more; it was left out.",
        "delete the line";
    JobOverruled = "job-overruled",
        "An argument of the command line replaces another setting of the job.",
        "unset the setting that should not count, as in --set fill.mass_g=none";
    RegionsOverlap = "regions-overlap",
        "Two regions of the job cover the same place; the settings of the later one apply there.",
        "cut the regions to size, or order them so that the one whose settings should apply comes last";
    WallsLevel = "walls-level",
        "process.stagger_walls is on, but no wall could be raised.",
        "lay at least two walls; only an inner wall that continues from layer to layer can be raised";
    MaterialMixed = "material-mixed",
        "The job states some strengths of the material; the others come from the profile.",
        "state all strengths of the material, or none";
    UnitAssumed = "unit-assumed",
        "The file states no unit of length, so a unit was assumed.",
        "set shape.unit, or the voxel size of a scan";
    SizeDoubtful = "size-doubtful",
        "The part is so small or so large that its unit is probably wrong.",
        "check the unit of the file and set shape.unit or shape.scale";
    MeshFileDamaged = "mesh-file-damaged",
        "A mesh file ends too early or has data after its end; what could be read was used.",
        "export the mesh again";
    ThreemfVolumes = "threemf-volumes",
        "A 3MF project has volumes or settings of volumes that are not used: negative volumes, support enforcers and blockers, and settings of modifiers that grainpath does not have.",
        "state in the job what matters, as a [[region]] with mesh or as settings of [support]; cut negative volumes out of the body in the CAD program";
    MeshRepaired = "mesh-repaired",
        "Defects of the mesh were repaired before slicing.",
        "repair the mesh where it was made, or set shape.repair = \"strict\" to refuse it";
    MeshStray = "mesh-stray",
        "The mesh holds facets or sheets without volume beside its bodies; they were left out before it was placed.",
        "delete them where the mesh was made, or set shape.repair = \"strict\" to refuse them";
    MeshOpen = "mesh-open",
        "The surface of the mesh has holes; the outlines of the sections were closed across them.",
        "look at the layers concerned, or close the holes in the mesh";
    MeshNonManifold = "mesh-non-manifold",
        "More than two faces meet at an edge of the mesh; overlapping sections were united.",
        "look at the layers concerned, or unite the bodies in the mesh";
    MeshTangled = "mesh-tangled",
        "The surface of the mesh crosses itself so often that sections were cut on a grid of cells instead of exactly.",
        "repair the mesh where it was made; look at the layers concerned";
    ThreemfRule = "3mf-rule",
        "A 3MF file breaks a rule of the 3MF specification; its meshes could still be read.",
        "export the file again, or report the rule to the maker of the program that wrote it";
    ThreemfNotRead = "3mf-not-read",
        "A 3MF file holds something that grainpath does not read.",
        "export the part as a plain triangle mesh";
    OutlineNotRead = "outline-not-read",
        "A drawing holds elements that grainpath does not read; they were left out.",
        "convert the elements to paths in the drawing program";
    OutlineOpen = "outline-open",
        "A drawing has open lines that enclose no area; they were left out.",
        "close the lines, or give them a fill";
    OutlineDuplicate = "outline-duplicate",
        "A drawing has lines that repeat other lines; the repeated ones were left out.",
        "delete the repeated lines in the drawing";
    ScanFilesSkipped = "scan-files-skipped",
        "Files in the folder of a scan are not slices of it and were skipped.",
        "move the other files out of the folder";
    ScanOrderAssumed = "scan-order-assumed",
        "The slices of a scan state no positions, so their order was assumed.",
        "check the order of the layers in the preview";
    ScanUnevenSlices = "scan-uneven-slices",
        "The slices of a scan are unevenly spaced; their stated heights were kept.",
        "check that no slice is missing";
    ScanDirectionsAssumed = "scan-directions-assumed",
        "The file does not state the directions of a scan's axes, or states them twice, so one interpretation was chosen.",
        "compare the part with the object; if it is mirrored, set shape.ct.flip";
    ScanOblique = "scan-oblique",
        "The voxels of a scan lie at an angle to the axes of its world; the part stands along its voxels.",
        "turn the part with shape.rotate_deg, or resample the scan";
    ScanSheared = "scan-sheared",
        "The slices of a scan lean, as with a tilted gantry; they were resampled upright.",
        "scan without tilt where the finest details matter";
    ScanReadAgain = "scan-read-again",
        "The slices of a scan are not stored along the height of the part; the file is read several times.",
        "store the slices along the height of the part to save time";
    ScanNotFinite = "scan-not-finite",
        "Voxels of a scan are NaN, infinite or padding; they were taken for air.",
        "if these voxels should be material, check the program that wrote the scan";
    ScanImplausible = "scan-implausible",
        "The grey values of a file cannot be those of a scan: all are NaN, infinite or padding, their bytes are in the wrong order, or neighbouring voxels are unrelated. Planning refuses such a scan.",
        "correct the header of the file, or size, sample type and byte order of raw data";
    ScanChunksMissing = "scan-chunks-missing",
        "Chunks of a scan in Zarr are not stored; they were read as the fill value, as Zarr defines.",
        "compare the folder with the original: programs leave out chunks that hold only the fill value, but an incomplete copy lacks other chunks too";
    ScanValuesRounded = "scan-values-rounded",
        "The grey values of a scan stand on an offset so large that few of their steps are left in float32, as which scans are read.",
        "subtract the offset before the scan is written or handed over";
    ScanFirstEntry = "scan-first-entry",
        "A scan in Zarr has several channels or times; the first was read.",
        "export the channel wanted as an image of its own, or choose it in Python with gp.read_zarr";
    ScanHeightRounded = "scan-height-rounded",
        "The height of a scan does not divide into layers, so the print is clearly higher or lower.",
        "choose process.layer_height_mm and process.first_layer_height_mm so that whole layers make the height";
    ScanTrailingBytes = "scan-trailing-bytes",
        "A raw scan file is longer than its header says; the rest was not read.",
        "check the size and the sample type in the header";
    ScanEdgesMissing = "scan-edges-missing",
        "The edge filter found no edge along a part of the contours; these follow the threshold.",
        "lower shape.ct.canny_low and shape.ct.canny_high, or use the threshold alone";
    ScanTooSmall = "scan-too-small",
        "The part reaches beyond the scan that guides it; the nearest directions were used there.",
        "use a scan that covers the part, or move it with guide.volume.origin_mm";
    GrainUnclear = "grain-unclear",
        "The image or the scan shows hardly any preferred direction.",
        "look at the picture of the directions; a larger guide.integration_mm may help";
    FieldAssumed = "field-assumed",
        "The directions of a file are uncertain: the unit of its angles or the order of its axes was assumed, or JPEG changed its grey values.",
        "state it: guide.field.angle_unit, guide.field.axes or a header such as angle_deg";
    FieldLeftOut = "field-left-out",
        "Samples of a file of directions have no direction and were left out, or the directions of a part of the piece stand upright on its layers.",
        "look at the samples concerned; the directions there are interpolated from the samples around them";
    FieldOneSample = "field-one-sample",
        "A file of directions has samples at one place only.",
        "use guide.kind = \"angle\" if one direction everywhere is meant";
    FieldTooSmall = "field-too-small",
        "The part reaches beyond the directions that guide it; those of the nearest place were used there.",
        "give directions for the whole part, or check guide.field.frame and the unit of positions";
    FieldStretched = "field-stretched",
        "A grid of directions does not state its size; it was stretched over the part by different factors in x and y.",
        "set guide.field.cell_mm";
    GuideFar = "guide-far",
        "The infill differs from the directions of its guide by 15 degrees or more on average.",
        "try fill.pattern = \"stripes\", or look at the place with `grainpath render --color direction`";
    GuideTwoDirections = "guide-two-directions",
        "In most of the part tension and compression of about equal amount cross, so that no single direction carries the load.",
        "set guide.follow = \"alternate\": layers then follow tension and compression in turn";
    CasesByWeight = "cases-by-weight",
        "The strengths of the material are not known, so the directions follow the weighted sum of the load cases in all layers.",
        "give the material a card with strengths, or set guide.case_mix = \"weights\"";
    BoardTurnAssumed = "board-turn-assumed",
        "The outline of a board does not tell how the photograph is turned, so a turn was assumed.",
        "check the numbered corners in the picture of the photograph, or give corners_px";
    PhotoProportions = "photo-proportions",
        "A photographed board is wider or narrower for its height than its size_mm says; its grain was stretched.",
        "give width and height of the board in this order, or say where it lies with shape.photo.corners";
    PhotoHoleOutside = "photo-hole-outside",
        "A hole of a photographed board lies outside the board and was not cut.",
        "give x and y in mm from the lower left corner of the board";
    MarkerSheetOld = "marker-sheet-old",
        "The photograph shows an old marker sheet, on which a mirrored photograph cannot be told from a good one.",
        "print a new sheet with `grainpath markers`";
    FeLeftOut = "fe-left-out",
        "Parts of a finite-element file do not fit its mesh or are not read; they were left out.",
        "check with `grainpath inspect` that the stress covers the part";
    FeUnitDoubtful = "fe-unit-doubtful",
        "The values of a finite-element file suggest another unit than the one assumed.",
        "set guide.import_stress_unit or guide.import_length_unit";
    FeOrderDoubtful = "fe-order-doubtful",
        "The stress components of a finite-element file seem to be in another order than the one assumed.",
        "set guide.import_order, or name the array with guide.import_array";
    FeOrderUnused = "fe-order-unused",
        "The order of stress components that the job states does not apply to the array of the file.",
        "unset guide.import_order: the file names its components, or has more or fewer than six";
    FeZeroStress = "fe-zero-stress",
        "The stress of a finite-element file, or that given at points, is zero everywhere or the same in all directions of the layers.",
        "export a step in which the part is loaded";
    DeckCovers = "deck-covers",
        "A fixture or load of a deck covers clearly less or more of the part's surface than of the deck's own.",
        "check that deck and part are the same shape; a finer export of the part follows its curves more closely";
    MassMissed = "mass-missed",
        "No density of the infill gives the required mass to within 0.5 %.",
        "ask for the mass that the warning names, or set fill.density";
    FillLinesSeparate = "fill-lines-separate",
        "Lines of sparse fill touch no other line, neither in their layer nor across layers.",
        "raise fill.density or fill.mass_g until neighbours touch, or use a pattern whose lines cross";
    FillOverAir = "fill-over-air",
        "Of the length of sparse infill, 0.2 % or more hangs over air: ends of lines with nothing below for more than 1 mm, or whole lines.",
        "use another pattern, or grade the density less with the height; ends of 1 to 2 mm print with little harm";
    FillMissing = "fill-missing",
        "Infill along a guide got less than three quarters of the material that its density asks for, or layers of the part got no bead.",
        "raise fill.density, use a pattern of straight lines, or lay more walls, which fill narrow places";
    DensityAssumed = "density-assumed",
        "A file of densities has a single value whose name does not say that it is a density; it was taken for one.",
        "name it in the job, as in fill.density.array = \"rho\", or call it density in the file";
    DensityTooSmall = "density-too-small",
        "The part reaches beyond the densities of its file; those of the nearest place were used there.",
        "give densities for the whole part, or check the unit of positions and shape.rotate_deg";
    DensityOff = "density-off",
        "Over cells of 5 mm, the density of graded infill differs from the density asked for by more than 3 percentage points on average, or by more than 10 at worst.",
        "look at the map of densities in the report; raise fill.density.min, or use the pattern rectilinear or stripes, which follow the density more closely";
    PathNeck = "path-neck",
        "A neck of a region is too narrow for one continuous path; its two sides are printed separately.",
        "widen the neck or print a narrower bead";
    PathNotJoined = "path-not-joined",
        "A piece of path lies too far from the rest of its region to be joined to it.",
        "widen the place or print a narrower bead";
    PathCrossing = "path-crossing",
        "A continuous path crosses itself or another path.",
        "report the job as a bug; a larger guide.smoothing_mm may avoid it";
    PathOutside = "path-outside",
        "A continuous path leaves its infill region.",
        "report the job as a bug; a larger guide.smoothing_mm may avoid it";
    FibreTooShort = "fibre-too-short",
        "Paths shorter than the shortest fibre that can be cut are laid without fibre.",
        "lower fibre.min_length_mm if the machine allows it";
    FibreSharpTurn = "fibre-sharp-turn",
        "Fibre paths turn more sharply than the fibre should be bent.",
        "take fibre.turns = \"wide\", smooth the directions with guide.smoothing_mm, or lower fibre.min_radius_mm";
    FibreGaps = "fibre-gaps",
        "A dense fibre print leaves more of the part unfilled than is usual.",
        "lower fibre.bead_width_mm";
    SupportNone = "support-none",
        "No overhang is steeper than the critical angle, so no support was made.",
        "lower support.critical_angle_deg, or name places in support.enforce_mm";
    SupportUnreached = "support-unreached",
        "No support can reach an overhang.",
        "turn the part, set support.from_plate_only = false, or raise support.margin_mm";
    SupportBends = "support-bends",
        "Tips of the support move by more than half a bead under the drag of the nozzle while they are printed.",
        "raise support.base_radius_mm, support.walls or support.branch_radius_mm, or turn the part so that it needs lower support";
    PartInMidAir = "part-in-mid-air",
        "A piece of the part begins in mid-air, with nothing below it, and there is no support.",
        "set support.style = \"tree\", or turn the part";
    StressNone = "stress-none",
        "A load case leaves the part without stress.",
        "give each load a force, and put it where the part is not held";
    StressBeyondStrength = "stress-beyond-strength",
        "The peak stress is more than twice the strength of the material.",
        "check the loads and their units; at a sharp inner corner the peak grows with every finer mesh";
    StressMeshError = "stress-mesh-error",
        "The elements are too large: the estimated error is more than a tenth of the stress, or a pressure catches clearly more or less area than lies in its place.",
        "lower guide.element_mm";
    StressUnbalanced = "stress-unbalanced",
        "The loads of a solved case are not in equilibrium with its reactions.",
        "report the job as a bug";
    StressLargeDisplacement = "stress-large-displacement",
        "The part moves by more than a twentieth of its size; linear elasticity holds only for smaller displacements.",
        "check the loads and the modulus of the material";
    StrengthNotConverged = "strength-not-converged",
        "The peak load still changes when the cells of the strength test are halved.",
        "lower strength.cell_mm";
    StrengthThinWalls = "strength-thin-walls",
        "Thin walls bend and are fewer than four cells thick, so that the peak load is too high.",
        "lower strength.cell_mm to a quarter of the thickness";
    StrengthLooseMaterial = "strength-loose-material",
        "Some printed material is not connected to a fixture and was left out of the strength test.",
        "check the fixtures and the gaps between beads";
    StrengthOverfilled = "strength-overfilled",
        "A program extrudes more than 1.05 times the part's volume; material that finds no room was left out of the strength test.",
        "check the flow of the program, and that it prints the job's part";
    StrengthUnfinished = "strength-unfinished",
        "The load was still rising when the strength test ended, so the peak is a lower bound.",
        "take the peak as a lower bound; a test with a load that bends the part less may reach the peak";
    GcodeNotRead = "gcode-not-read",
        "Lines of a G-code program cannot be understood and were skipped.",
        "check that the file is G-code and complete";
    HistoryNotWritten = "history-not-written",
        "The studio could not add a run to its list of earlier runs, `history.jsonl`; the run itself is good.",
        "make the working folder of the studio and this file writable, and look for room on the disk";
}

impl fmt::Display for WarningId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for WarningId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for WarningId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let found = Self::ALL.iter().find(|id| id.name() == name);
        found.copied().ok_or_else(|| D::Error::custom(format!("no warning has the id {name:?}")))
    }
}

/// Where a warning applies. Every field is optional, but at least one is given.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Place {
    /// The file, or the part of an archive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line in the file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Layer, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<usize>,
    /// Top of the layer, mm above the plate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<f64>,
    /// A point in the part's coordinates, mm: x, y and, where it is known, z.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub point_mm: Vec<f64>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        parts.extend(self.file.clone());
        parts.extend(self.line.map(|n| format!("line {n}")));
        match (self.layer, self.z_mm) {
            (Some(n), Some(z)) => parts.push(format!("layer {n} at z = {z:.2} mm")),
            (Some(n), None) => parts.push(format!("layer {n}")),
            (None, Some(z)) => parts.push(format!("z = {z:.2} mm")),
            (None, None) => {}
        }
        if !self.point_mm.is_empty() {
            let numbers: Vec<String> = self.point_mm.iter().map(|v| format!("{v:.2}")).collect();
            parts.push(format!("({})", numbers.join(", ")));
        }
        f.write_str(&parts.join(", "))
    }
}

/// One warning: what happened, where, and what helps.
///
/// In JSON it is `{ "id", "text", "place", "remedy" }`; `place` is left out where the warning
/// concerns the whole run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// Its kind, with a stable name.
    pub id: WarningId,
    /// What happened, with numbers; without the place.
    pub text: String,
    /// Place that it concerns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<Place>,
    /// Remedy for the user.
    pub remedy: Cow<'static, str>,
}

impl Warning {
    /// A warning about the whole run, with the usual remedy of its kind.
    pub fn new(id: WarningId, text: impl Into<String>) -> Self {
        Self { id, text: text.into(), place: None, remedy: Cow::Borrowed(id.remedy()) }
    }

    /// Replaces the usual remedy by a more precise one.
    #[must_use]
    pub fn with_remedy(mut self, remedy: impl Into<Cow<'static, str>>) -> Self {
        self.remedy = remedy.into();
        self
    }

    /// Names the file, or the part of an archive.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<String>) -> Self {
        self.place_mut().file = Some(file.into());
        self
    }

    /// Names the line of a text file, from 1.
    #[must_use]
    pub fn in_line(mut self, line: usize) -> Self {
        self.place_mut().line = Some(line);
        self
    }

    /// Names the layer by its index (from 0) and its top.
    #[must_use]
    pub fn in_layer(mut self, layer_idx: usize, z_mm: f64) -> Self {
        let place = self.place_mut();
        (place.layer, place.z_mm) = (Some(layer_idx + 1), Some(z_mm));
        self
    }

    /// Names a point of the layer, mm.
    #[must_use]
    pub fn at_mm(mut self, x_mm: f64, y_mm: f64) -> Self {
        self.place_mut().point_mm = vec![x_mm, y_mm];
        self
    }

    /// Names a point in space, mm.
    #[must_use]
    pub fn at_point_mm(mut self, point_mm: glam::DVec3) -> Self {
        self.place_mut().point_mm = point_mm.to_array().to_vec();
        self
    }

    fn place_mut(&mut self) -> &mut Place {
        self.place.get_or_insert_default()
    }

    /// The order of warnings in a list: first those about the whole run, then layer by layer. Within each the order is that
    /// of [`WarningId`], which begins with what was assumed about the input, since later warnings may follow from it. It
    /// is a total order, so the list does not depend on which thread finishes first.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        let layer = |w: &Self| w.place.as_ref().and_then(|p| p.layer);
        let point = |w: &Self| w.place.as_ref().map_or_else(Vec::new, |p| p.point_mm.clone());
        let file = |w: &Self| w.place.as_ref().map(|p| (p.file.clone(), p.line));
        layer(self)
            .cmp(&layer(other))
            .then_with(|| self.id.cmp(&other.id))
            .then_with(|| self.text.cmp(&other.text))
            .then_with(|| file(self).cmp(&file(other)))
            .then_with(|| {
                let (a, b) = (point(self), point(other));
                let each = a.iter().zip(&b).map(|(a, b)| a.total_cmp(b));
                each.fold(a.len().cmp(&b.len()), Ordering::then)
            })
            .then_with(|| self.remedy.cmp(&other.remedy))
    }
}

/// For the terminal: place, text and id on one line, the remedy on the next.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        write!(f, "{} [{}]\n  remedy: {}", self.text, self.id, self.remedy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The documentation lists every id once, with the words of the table.
    #[test]
    fn the_page_lists_every_id() {
        let page = include_str!("../../../docs/warnings.md");
        let wanted: Vec<String> = WarningId::ALL
            .iter()
            .map(|id| format!("| `{}` | {} | {} |", id.name(), id.meaning(), id.remedy()))
            .collect();
        let rows: Vec<&str> = page.lines().filter(|l| l.starts_with("| `")).collect();
        assert_eq!(rows, wanted, "the table of docs/warnings.md should be:\n{}", wanted.join("\n"));
    }

    #[test]
    fn ids_are_distinct_words_in_kebab_case() {
        let mut names: Vec<&str> = WarningId::ALL.iter().map(|id| id.name()).collect();
        let plain = |n: &&str| n.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-');
        assert!(names.iter().all(plain), "{names:?}");
        names.sort_unstable();
        let n = names.len();
        names.dedup();
        assert_eq!(names.len(), n);
    }

    #[test]
    fn places_and_remedies_are_printed() {
        let w =
            Warning::new(WarningId::GcodeNotRead, "cannot understand \"Q\"").in_file("a.gcode").in_line(7);
        let printed = w.to_string();
        assert!(printed.starts_with("a.gcode, line 7: cannot understand"), "{printed}");
        assert!(printed.contains("[gcode-not-read]\n  remedy: check that"), "{printed}");
    }
}
