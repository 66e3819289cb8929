//! Volumes of project files that do not belong to the solid: modifiers, negative volumes, support enforcers and blockers.
//!
//! Source: files written by PrusaSlicer 2.x and by OrcaSlicer and Bambu Studio; neither format has a specification.
//! PrusaSlicer keeps all volumes of an object in one mesh, and `Metadata/Slic3r_PE_model.config` says which triangles belong
//! to which (`firstid` to `lastid`). OrcaSlicer and Bambu Studio make each volume a component, and
//! `Metadata/model_settings.config` names the object of each (`part id`). Both give volumes a type and settings of their own:
//!
//! ```text
//! <object id="1"><volume firstid="12" lastid="23"><metadata key="volume_type" value="ParameterModifier"/>
//!                                                 <metadata key="fill_density" value="80%"/></volume></object>
//! <object id="3"><part id="2" subtype="modifier_part"><metadata key="sparse_infill_density" value="80%"/></part></object>
//! ```
//!
//! Limits: in files of OrcaSlicer the ids name direct components of an object in the build; nested components count as
//! solid.

use std::collections::BTreeMap;

use grainpath_core::{TriMesh, Warning, WarningId};
use quick_xml::events::{BytesStart, Event};

use super::package::{Package, events};
use crate::mesh::model::MeshError;
use crate::xml::attribute;

/// The files that describe volumes: of PrusaSlicer, and of OrcaSlicer and Bambu Studio.
const CONFIGS: [&str; 2] = ["/Metadata/Slic3r_PE_model.config", "/Metadata/model_settings.config"];

/// Limit on the volumes that a project describes. Source: chosen; projects of real parts have tens. It bounds the time of
/// the search for the volume of a triangle or component.
const MAX_VOLUMES: usize = 1000;

/// What a volume is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum VolumeKind {
    Solid,
    Modifier,
    Negative,
    Enforcer,
    Blocker,
}

impl VolumeKind {
    fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "ModelPart" | "normal_part" => Self::Solid,
            "ParameterModifier" | "modifier_part" => Self::Modifier,
            "NegativeVolume" | "negative_part" => Self::Negative,
            "SupportEnforcer" | "support_enforcer" => Self::Enforcer,
            "SupportBlocker" | "support_blocker" => Self::Blocker,
            _ => return None,
        })
    }

    /// The text that a warning gives about a volume of a kind that is left out.
    fn left_out(self) -> Option<&'static str> {
        Some(match self {
            Self::Solid | Self::Modifier => return None,
            Self::Negative => "a negative volume, which is not cut out of the part",
            Self::Enforcer => "a support enforcer; only painted ones are read",
            Self::Blocker => "a support blocker; only painted ones are read",
        })
    }
}

/// A volume of an object.
#[derive(Debug, Clone)]
pub(super) struct Volume {
    pub(super) kind: VolumeKind,
    pub(super) name: Option<String>,
    /// Its settings as the file has them.
    pub(super) settings: Vec<(String, String)>,
    /// First and last triangle in the object's mesh.
    triangles: Option<[usize; 2]>,
    /// Id of the object that the component uses.
    part: Option<u32>,
}

/// The volumes of all objects that a project describes.
#[derive(Debug, Default)]
pub(super) struct Volumes(BTreeMap<u32, Vec<Volume>>);

impl Volumes {
    /// Reads the volume descriptions of a package. A damaged description gives a warning, and its volumes count as solid.
    pub(super) fn read(package: &mut Package<'_>, warnings: &mut Vec<Warning>) -> Self {
        let mut all = Self::default();
        for path in CONFIGS.into_iter().filter(|path| package.has(path)).collect::<Vec<_>>() {
            let mut builder = Builder::default();
            // A project often passes through several programs, and one damaged description should not make the part
            // unreadable.
            match package.read(path, |r| events(r, path, |event| builder.event(event))) {
                Ok(()) => {
                    for (object, volumes) in builder.objects.iter_mut().filter(|(_, v)| overlap(v)) {
                        // Overlapping ranges would each copy the same triangles, so all ranges of the object are dropped.
                        volumes.retain(|v| v.triangles.is_none());
                        let text = format!(
                            "volumes of object {object} share triangles; all of it is taken for solid"
                        );
                        warnings.push(Warning::new(WarningId::ThreemfVolumes, text));
                    }
                    all.0.append(&mut builder.objects);
                }
                Err(e) => {
                    let text = format!("{e}; modifiers of the project are taken for solid bodies");
                    warnings.push(Warning::new(WarningId::ThreemfVolumes, text));
                }
            }
        }
        let volumes = all.0.values().flatten();
        for (volume, why) in volumes.filter_map(|v| Some((v, v.kind.left_out()?))) {
            let name = volume.name.as_deref().unwrap_or("without a name");
            let text = format!("volume {name:?} is {why}; it is left out");
            warnings.push(Warning::new(WarningId::ThreemfVolumes, text));
        }
        all
    }

    /// The volume that this component of an object describes, or `None` if the component is solid.
    pub(super) fn of_component(&self, object: u32, component: u32) -> Option<&Volume> {
        let volumes = self.0.get(&object)?;
        volumes.iter().find(|v| v.part == Some(component) && v.kind != VolumeKind::Solid)
    }

    /// The volumes of an object that are triangle ranges of its mesh, in rising order and without overlap. `None` if the
    /// whole object is solid.
    pub(super) fn ranges(&self, object: u32) -> Option<Vec<(&Volume, [usize; 2])>> {
        // Files of OrcaSlicer have no ranges; their volumes are components.
        let ranges = self.0.get(&object)?.iter().filter_map(|v| Some((v, v.triangles?)));
        let mut ranges: Vec<_> = ranges.filter(|(v, _)| v.kind != VolumeKind::Solid).collect();
        ranges.sort_unstable_by_key(|(_, range)| *range);
        (!ranges.is_empty()).then_some(ranges)
    }
}

/// Whether two of the volumes share a triangle, or a range ends before it begins.
fn overlap(volumes: &[Volume]) -> bool {
    let mut ranges: Vec<[usize; 2]> = volumes.iter().filter_map(|v| v.triangles).collect();
    ranges.sort_unstable();
    ranges.iter().any(|[first, last]| first > last) || ranges.windows(2).any(|w| w[0][1] >= w[1][0])
}

/// These triangles of a mesh, with the vertices that they use.
fn piece(mesh: &TriMesh, triangles: impl Iterator<Item = [u32; 3]>) -> TriMesh {
    let mut to: BTreeMap<u32, u32> = BTreeMap::new();
    let mut out = TriMesh::default();
    for triangle in triangles {
        out.triangles.push(triangle.map(|v| {
            *to.entry(v).or_insert_with(|| {
                out.vertices.push(mesh.vertices[v as usize]);
                out.vertices.len() as u32 - 1
            })
        }));
    }
    out
}

/// The solid part of an object's mesh, and its modifiers. The ranges are in rising order and do not overlap.
pub(super) fn divided<'v>(
    mesh: &TriMesh,
    ranges: &[(&'v Volume, [usize; 2])],
) -> (TriMesh, Vec<(&'v Volume, TriMesh)>) {
    let all = &mesh.triangles;
    let named = |k: usize| {
        let at = ranges.partition_point(|(_, range)| range[1] < k);
        ranges.get(at).is_some_and(|(_, range)| range[0] <= k)
    };
    // Triangles outside every range stay solid, because a file may describe only some of its volumes.
    let solid = piece(mesh, all.iter().enumerate().filter(|(k, _)| !named(*k)).map(|(_, t)| *t));
    let of_range = |[first, last]: [usize; 2]| {
        let end = last.saturating_add(1).min(all.len());
        piece(mesh, all[first.min(end)..end].iter().copied())
    };
    let modifiers = ranges.iter().filter(|(v, _)| v.kind == VolumeKind::Modifier);
    (solid, modifiers.map(|(v, range)| (*v, of_range(*range))).collect())
}

#[derive(Default)]
struct Builder {
    objects: BTreeMap<u32, Vec<Volume>>,
    object: Option<u32>,
    volume: Option<Volume>,
    n_volumes: usize,
}

impl Builder {
    fn event(&mut self, event: &Event<'_>) -> Result<(), MeshError> {
        match event {
            Event::Start(e) => self.open(e),
            Event::Empty(e) => {
                self.open(e);
                self.close(e.local_name().as_ref())?;
            }
            Event::End(e) => self.close(e.local_name().as_ref())?,
            _ => {}
        }
        Ok(())
    }

    fn open(&mut self, e: &BytesStart<'_>) {
        let number = |name: &str| attribute(e, name).and_then(|n| n.trim().parse::<u32>().ok());
        match e.local_name().as_ref() {
            "object" => self.object = number("id"),
            // The settings follow as child elements, so the volume stays open until its end tag.
            "volume" | "part" => {
                let range = number("firstid").zip(number("lastid"));
                let kind = attribute(e, "subtype").and_then(|word| VolumeKind::from_word(&word));
                self.volume = Some(Volume {
                    kind: kind.unwrap_or(VolumeKind::Solid),
                    name: None,
                    settings: Vec::new(),
                    triangles: range.map(|(a, b)| [a as usize, b as usize]),
                    part: number("id"),
                });
            }
            "metadata" => {
                // Settings outside a volume hold for the whole object. They are skipped, because the job states them.
                let Some(volume) = &mut self.volume else { return };
                let (Some(key), Some(value)) = (attribute(e, "key"), attribute(e, "value")) else { return };
                match key.as_str() {
                    "name" => volume.name = Some(value),
                    "volume_type" => volume.kind = VolumeKind::from_word(&value).unwrap_or(volume.kind),
                    // Files of PrusaSlicer 1.x and 2.0.
                    "modifier" if value == "1" => volume.kind = VolumeKind::Modifier,
                    _ => volume.settings.push((key, value)),
                }
            }
            _ => {}
        }
    }

    fn close(&mut self, name: &str) -> Result<(), MeshError> {
        match name {
            "object" => self.object = None,
            "volume" | "part" => {
                if let (Some(object), Some(volume)) = (self.object, self.volume.take()) {
                    self.n_volumes += 1;
                    if self.n_volumes > MAX_VOLUMES {
                        return Err(MeshError::TooMany { what: "volumes", limit: MAX_VOLUMES as u64 });
                    }
                    self.objects.entry(object).or_default().push(volume);
                }
            }
            _ => {}
        }
        Ok(())
    }
}
