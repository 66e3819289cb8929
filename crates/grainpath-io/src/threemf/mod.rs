//! 3MF: a ZIP archive of XML parts, as slicers and CAD programs exchange printable models.
//!
//! Source: 3MF Core Specification 1.4, Production Extension (objects in other parts), Materials and Properties Extension
//! (checked, not used). Painted supports follow the project files of PrusaSlicer, OrcaSlicer and Bambu
//! Studio ([`paint`]), and so do modifiers and other volumes that are not solid ([`volumes`]).
//!
//! [`package`] opens the archive and finds the root model part, [`part`] reads a model part as a stream of XML events, and
//! this module places the objects that the build refers to: transforms, nested components and several items become bodies in
//! the unit that the file states. Where the file breaks a rule of the specification, a warning names its section; where the
//! triangles remain unknown, it is an error.
//!
//! Limits: 1 GiB of inflated data and a ratio of 100 (32 MiB are always allowed), 1000 model parts, components nested 32
//! deep, 50 million triangles in all copies. Beam lattices, slices, volumetric data and encrypted parts are not read.

mod package;
mod paint;
mod part;
mod properties;
mod transform;
mod volumes;
mod write;

pub use write::write_3mf;

use std::collections::BTreeMap;

use grainpath_core::{TriMesh, Warning, WarningId};

use crate::mesh::model::{MAX_ELEMENTS, MeshBody, MeshError, MeshFile, MeshProblem, ModifierVolume};
use package::Package;
use part::{Component, Content, ModelPart, ObjectType};
use transform::Transform;
use volumes::{VolumeKind, Volumes, divided};

/// Limit on the nesting of components. The specification forbids circles; a deeper nesting is damage or
/// malice. Source: chosen; files of real programs stay far below it.
const MAX_DEPTH: usize = 32;
/// Limit on warnings while bodies are assembled. Source: chosen; nobody reads more.
const MAX_WARNINGS: usize = 50;

pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, MeshError> {
    let mut package = Package::open(bytes)?;
    let mut warnings = Vec::new();
    let root_path = package.root_model(&mut warnings)?;
    let volumes = Volumes::read(&mut package, &mut warnings);
    let mut parts: BTreeMap<String, ModelPart> = BTreeMap::new();
    // Parts may refer to parts (production extension). Each is read once, whatever the number of
    // references.
    let mut wanted = vec![root_path.clone()];
    while let Some(path) = wanted.pop() {
        if parts.contains_key(&path) {
            continue;
        }
        if parts.len() > 1000 {
            return Err(MeshError::TooMany { what: "model parts", limit: 1000 });
        }
        let part = ModelPart::read(&mut package, &path)?;
        wanted.extend(part.paths());
        warnings.extend(part.warnings.iter().cloned());
        parts.insert(path, part);
    }
    let root = &parts[&root_path];
    let mut assembly = Assembly {
        parts: &parts,
        volumes: &volumes,
        bodies: Vec::new(),
        modifiers: Vec::new(),
        in_modifier: false,
        n_triangles: 0,
        supports: Vec::new(),
        warnings: Vec::new(),
    };
    for item in &root.items {
        // One body for each build item, as slicers show them; components of an item are merged into it.
        let mut body = MeshBody::default();
        assembly.add(item, &root_path, Transform::IDENTITY, 0, &mut body)?;
        assembly.bodies.push(body);
    }
    // Supports beside a part are dropped without a word, but not where nothing else is there.
    if assembly.bodies.iter().all(|b| b.mesh.triangles.is_empty()) {
        for (path, id) in std::mem::take(&mut assembly.supports) {
            let text = format!("object {id} is a support of another program and is left out (3MF core 4)");
            assembly.warn(&path, text);
        }
    }
    let (bodies, modifiers) = (assembly.bodies, assembly.modifiers);
    warnings.extend(assembly.warnings);
    // A build without items is legal, but leaves nothing to print. Without this warning the error would name no
    // cause.
    if root.items.is_empty() {
        let text = "the build has no items, so nothing is to be printed (3MF core 3.4.3)";
        warnings.push(Warning::new(WarningId::ThreemfRule, text));
    }
    Ok(MeshFile { bodies, unit: Some(root.unit), modifiers, warnings })
}

/// Resolves build items into bodies.
struct Assembly<'a> {
    parts: &'a BTreeMap<String, ModelPart>,
    volumes: &'a Volumes,
    bodies: Vec<MeshBody>,
    modifiers: Vec<ModifierVolume>,
    /// Whether the objects that are being added belong to a modifier.
    in_modifier: bool,
    n_triangles: u64,
    /// Supports that are left out: part and object.
    supports: Vec<(String, u32)>,
    /// Warnings of broken rules that are found only where objects are used.
    warnings: Vec<Warning>,
}

impl Assembly<'_> {
    fn warn(&mut self, path: &str, text: String) {
        let warning = Warning::new(WarningId::ThreemfRule, text).in_file(path.to_owned());
        if self.warnings.len() < MAX_WARNINGS && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    fn add(
        &mut self,
        use_of: &Component,
        path: &str,
        place: Transform,
        depth: usize,
        body: &mut MeshBody,
    ) -> Result<(), MeshError> {
        // A component without a path refers to an object of its own part.
        let path = use_of.path.as_deref().unwrap_or(path);
        let id = use_of.object;
        if depth > MAX_DEPTH {
            let problem = Box::new(MeshProblem::Nested { id, max: MAX_DEPTH });
            return Err(MeshError::Invalid { place: path.to_owned(), problem });
        }
        let object = self.parts.get(path).and_then(|p| p.objects.get(&id)).ok_or_else(|| {
            MeshError::Invalid { place: path.to_owned(), problem: Box::new(MeshProblem::NoObject(id)) }
        })?;
        match object.kind {
            ObjectType::Solid => {}
            // Supports of other programs are dropped; grainpath generates its own.
            ObjectType::Support => {
                self.supports.push((path.to_owned(), id));
                return Ok(());
            }
            ObjectType::Surface => {
                self.warn(
                    path,
                    format!("object {id} is a surface without an inside and is left out (3MF core 4.1)"),
                );
                return Ok(());
            }
            // OrcaSlicer and Bambu Studio write modifiers with this type.
            ObjectType::Other if self.in_modifier => {}
            ObjectType::Other => {
                let text = "has a type that is not printed, but the build refers to it; it is left out";
                self.warn(path, format!("object {id} {text} (3MF core 3.4.3.1)"));
                return Ok(());
            }
        }
        let place = use_of.transform.then(&place);
        // A flat body has no volume, and no slice.
        if place.is_singular() {
            self.warn(path, format!("a transform presses object {id} flat; it is left out (3MF core 3.3)"));
            return Ok(());
        }
        if body.name.is_none() {
            body.name.clone_from(&object.name);
        }
        match &object.content {
            Content::Mesh(mesh, painted) => {
                let all = [mesh, &painted.enforcers, &painted.blockers];
                // Ten levels of ten components each make 10^10 copies of one triangle, so the limit applies to all copies.
                self.n_triangles += all.iter().map(|m| m.triangles.len() as u64).sum::<u64>();
                if self.n_triangles > MAX_ELEMENTS / 4 {
                    return Err(MeshError::TooMany {
                        what: "triangles in all copies",
                        limit: MAX_ELEMENTS / 4,
                    });
                }
                for (to, from) in
                    body.painted_supports.each_mut().into_iter().zip([&painted.enforcers, &painted.blockers])
                {
                    append(to, from, &place, path)?;
                }
                // Projects give ranges of triangles only for objects that the build names, which have depth 0.
                let ranges = if depth == 0 { self.volumes.ranges(id) } else { None };
                let Some(ranges) = ranges else { return append(&mut body.mesh, mesh, &place, path) };
                let (solid, modifiers) = divided(mesh, &ranges);
                for (volume, mesh) in modifiers {
                    let (name, settings) = (volume.name.clone(), volume.settings.clone());
                    let mut modifier = ModifierVolume { name, settings, ..ModifierVolume::default() };
                    append(&mut modifier.mesh, &mesh, &place, path)?;
                    self.modifiers.push(modifier);
                }
                append(&mut body.mesh, &solid, &place, path)
            }
            Content::Components(components) => {
                // Each level may multiply the uses of the one below. The limit on triangles bounds them, so the use of an
                // object without triangles counts as one.
                self.n_triangles += 1;
                for c in components {
                    let volume = if depth == 0 { self.volumes.of_component(id, c.object) } else { None };
                    let Some(volume) = volume else {
                        self.add(c, path, place, depth + 1, body)?;
                        continue;
                    };
                    if volume.kind == VolumeKind::Modifier {
                        // The component's own transform places a modifier, as it places solid components.
                        let mut apart = MeshBody::default();
                        self.in_modifier = true;
                        self.add(c, path, place, depth + 1, &mut apart)?;
                        self.in_modifier = false;
                        let (name, settings) = (volume.name.clone(), volume.settings.clone());
                        self.modifiers.push(ModifierVolume { name, mesh: apart.mesh, settings });
                    }
                }
                Ok(())
            }
        }
    }
}

/// Adds a placed copy of a mesh.
fn append(to: &mut TriMesh, mesh: &TriMesh, place: &Transform, path: &str) -> Result<(), MeshError> {
    let first = to.vertices.len() as u64;
    if first + mesh.vertices.len() as u64 >= u64::from(u32::MAX) {
        return Err(MeshError::TooMany { what: "vertices", limit: u64::from(u32::MAX) });
    }
    for &p in &mesh.vertices {
        to.vertices.push(crate::position::checked(place.apply(p).to_array(), || {
            format!("{path}, after its transform")
        })?);
    }
    // A mirroring transform turns facets inside out, so two corners are exchanged.
    let mirrors = place.mirrors();
    to.triangles.extend(mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| i + first as u32);
        if mirrors { [a, c, b] } else { [a, b, c] }
    }));
    Ok(())
}
