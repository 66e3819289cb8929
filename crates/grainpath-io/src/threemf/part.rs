//! One model part: its objects, its build, and what is wrong among its resources.

use std::collections::BTreeMap;

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, TriMesh, Warning, WarningId};
use quick_xml::events::{BytesStart, Event};

use super::package::{Package, events, invalid};
use super::paint;
use super::transform::Transform;
use crate::mesh::model::{MeshError, PaintedSupports, SoupBuilder};
use crate::position::checked;
use crate::text::{number, whole};
use crate::xml::attribute;

/// Names of metadata that need no prefix.
const METADATA: [&str; 9] = [
    "Title",
    "Designer",
    "Description",
    "Copyright",
    "LicenseTerms",
    "Rating",
    "CreationDate",
    "ModificationDate",
    "Application",
];

/// A use of an object, by a component or a build item.
#[derive(Debug, Clone)]
pub(crate) struct Component {
    pub(crate) object: u32,
    pub(crate) path: Option<String>,
    pub(crate) transform: Transform,
}

#[derive(Debug)]
pub(crate) enum Content {
    Mesh(TriMesh, PaintedSupports),
    Components(Vec<Component>),
}

#[derive(Debug)]
pub(crate) struct Object {
    pub(crate) name: Option<String>,
    pub(crate) content: Content,
    /// Whether it is of a type that is part of the model, not support or else.
    pub(crate) printed: bool,
}

pub(crate) struct Part {
    pub(crate) unit: LengthUnit,
    pub(crate) objects: BTreeMap<u32, Object>,
    pub(crate) items: Vec<Component>,
    pub(crate) warnings: Vec<Warning>,
}

impl Part {
    pub(crate) fn read(package: &mut Package<'_>, path: &str) -> Result<Self, MeshError> {
        let mut builder = Builder { path: path.to_owned(), ..Builder::default() };
        package.read(path, |r| events(r, path, |event| builder.event(event)))?;
        builder.finish()
    }

    /// Other parts that this one uses.
    pub(crate) fn paths(&self) -> Vec<String> {
        let of_objects = self.objects.values().flat_map(|o| match &o.content {
            Content::Components(c) => c.as_slice(),
            Content::Mesh(..) => &[],
        });
        of_objects.chain(&self.items).filter_map(|c| c.path.clone()).collect()
    }
}

#[derive(Default)]
struct Builder {
    path: String,
    unit: Option<LengthUnit>,
    models: usize,
    has_resources: bool,
    has_build: bool,
    objects: BTreeMap<u32, Object>,
    items: Vec<Component>,
    /// Kind of every resource seen.
    kinds: BTreeMap<u32, String>,
    warnings: Vec<Warning>,
    current: Option<Current>,
}

/// The object being read.
struct Current {
    id: u32,
    name: Option<String>,
    printed: bool,
    has_pid: bool,
    vertices: Vec<u32>,
    soup: SoupBuilder,
    /// Triangles with what is painted on them, not yet understood.
    painted: Vec<([u32; 3], Vec<u8>)>,
    components: Vec<Component>,
}

impl Builder {
    fn event(&mut self, event: &Event<'_>) -> Result<(), MeshError> {
        match event {
            Event::Start(e) | Event::Empty(e) => {
                self.element(e)?;
                if matches!(event, Event::Empty(_)) && e.local_name().as_ref() == "object" {
                    self.end_object();
                }
            }
            Event::End(e) if e.local_name().as_ref() == "object" => self.end_object(),
            _ => {}
        }
        Ok(())
    }

    fn element(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let name = e.local_name();
        match name.as_ref() {
            "vertex" => self.vertex(e),
            "triangle" => self.triangle(e),
            "model" => {
                self.models += 1;
                let unit = attribute(e, "unit").unwrap_or_else(|| "millimeter".into());
                self.unit = LengthUnit::from_name(&unit);
                if self.unit.is_none() {
                    return Err(invalid("", format!("unit {unit:?} is not one of 3MF's")));
                }
                Ok(())
            }
            "resources" => {
                self.has_resources = true;
                Ok(())
            }
            "build" => {
                self.has_build = true;
                Ok(())
            }
            "metadata" => {
                let name = attribute(e, "name").unwrap_or_default();
                if !METADATA.contains(&name.as_str()) && !name.contains(':') {
                    self.warn(format!("metadata named {name:?}, which is neither one of 3MF's nor prefixed"));
                }
                Ok(())
            }
            "object" => self.start_object(e),
            "component" => {
                let component = use_of(e, "objectid")?;
                if let Some(current) = &mut self.current {
                    current.components.push(component);
                }
                Ok(())
            }
            "item" => {
                let item = use_of(e, "objectid")?;
                if attribute(e, "printable").is_none_or(|p| p != "0") {
                    self.items.push(item);
                }
                Ok(())
            }
            "beamlattice" => {
                self.warn_of(WarningId::ThreemfNotRead, "a beam lattice; only triangles are read");
                Ok(())
            }
            other => {
                if e.attributes().with_checks(false).flatten().any(|a| a.key.as_ref().starts_with("xsi:")) {
                    self.warn(format!("<{other}> has a schema instance attribute, which 3MF forbids"));
                }
                self.material(other, e);
                Ok(())
            }
        }
    }

    fn warn(&mut self, rule: impl Into<String>) {
        self.warn_of(WarningId::ThreemfRule, rule);
    }

    fn warn_of(&mut self, id: WarningId, text: impl Into<String>) {
        let warning = Warning::new(id, text).in_file(self.path.clone());
        if self.warnings.len() < 50 && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    fn add_resource(&mut self, kind: &str, e: &BytesStart<'_>) -> Option<u32> {
        let id = attribute(e, "id").and_then(|t| t.trim().parse().ok());
        match id {
            None => self.warn(format!("a {kind} without an id")),
            Some(id) => {
                if self.kinds.insert(id, kind.to_owned()).is_some() {
                    self.warn(format!("resource id {id} is given twice"));
                }
            }
        }
        id
    }

    fn start_object(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let id = self.add_resource("object", e).ok_or_else(|| invalid("", "an object without an id"))?;
        let kind = attribute(e, "type").unwrap_or_default();
        let has_pid = attribute(e, "pid").is_some();
        if attribute(e, "pindex").is_some() && !has_pid {
            self.warn(format!("object {id} has a pindex and no pid"));
        }
        self.current = Some(Current {
            id,
            name: attribute(e, "name").filter(|n| !n.is_empty()),
            printed: matches!(kind.as_str(), "" | "model" | "solidsupport"),
            has_pid,
            vertices: Vec::new(),
            soup: SoupBuilder::with_capacity(0),
            painted: Vec::new(),
            components: Vec::new(),
        });
        Ok(())
    }

    fn end_object(&mut self) {
        let Some(current) = self.current.take() else { return };
        let body = current.soup.finish(None);
        let mut painted = PaintedSupports::default();
        for (triangle, digits) in &current.painted {
            let corners = triangle.map(|i| body.mesh.vertices[i as usize]);
            if paint::decode(digits, corners, &mut painted).is_none() {
                self.warn_of(WarningId::ThreemfNotRead, "a triangle whose painted supports cannot be read");
            }
        }
        let content = if current.components.is_empty() {
            Content::Mesh(body.mesh, painted)
        } else {
            Content::Components(current.components)
        };
        self.objects.insert(current.id, Object { name: current.name, content, printed: current.printed });
    }

    fn vertex(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let Some(current) = &mut self.current else { return Ok(()) };
        let mut p = [f64::NAN; 3];
        for a in e.attributes().with_checks(false).filter_map(Result::ok) {
            if let [axis @ b'x'..=b'z'] = a.key.as_ref().as_bytes() {
                p[usize::from(axis - b'x')] = number(a.value.as_bytes().trim_ascii()).unwrap_or(f64::NAN);
            }
        }
        let place = || format!("{}, object {}, vertex {}", self.path, current.id, current.vertices.len());
        let p: DVec3 = checked(p, place)?;
        current.vertices.push(current.soup.index(p)?);
        Ok(())
    }

    fn triangle(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let Some(current) = &mut self.current else { return Ok(()) };
        let mut corners = [-1i64; 3];
        let mut digits = Vec::new();
        let (mut has_pid, mut has_p1) = (current.has_pid, false);
        for a in e.attributes().with_checks(false).filter_map(Result::ok) {
            match a.key.as_ref().as_bytes() {
                [b'v', k @ b'1'..=b'3'] => {
                    corners[usize::from(k - b'1')] = whole(a.value.as_bytes().trim_ascii()).unwrap_or(-1)
                }
                b"pid" => has_pid = true,
                b"p1" => has_p1 = true,
                _ if paint::ATTRIBUTES.contains(&a.key.as_ref()) => {
                    digits = a.value.as_bytes().trim_ascii().to_vec();
                }
                _ => {}
            }
        }
        let mut triangle = [0; 3];
        for (to, from) in triangle.iter_mut().zip(corners) {
            let n_vertices = current.vertices.len();
            let known = usize::try_from(from).ok().and_then(|i| current.vertices.get(i));
            *to = *known.ok_or_else(|| MeshError::NoSuchVertex {
                place: format!("{}, object {}", self.path, current.id),
                index: from,
                n_vertices,
            })?;
        }
        current.soup.push(triangle)?;
        if !digits.is_empty() {
            current.painted.push((triangle, digits));
        }
        if has_p1 && !has_pid {
            self.warn("a triangle has a p1 and neither it nor its object has a pid");
        }
        Ok(())
    }

    /// Materials: only what shows that the file breaks the specification.
    fn material(&mut self, name: &str, e: &BytesStart<'_>) {
        let ids = |name: &str| -> Option<Vec<u32>> {
            Some(attribute(e, name)?.split_whitespace().filter_map(|w| w.parse().ok()).collect())
        };
        match name {
            "basematerials" => drop(self.add_resource("basematerials", e)),
            "colorgroup" => drop(self.add_resource("colorgroup", e)),
            "color" if attribute(e, "color").is_none() => self.warn("a color without its value"),
            "texture2d" => {
                self.add_resource("texture2d", e);
                let kind = attribute(e, "contenttype").unwrap_or_default();
                if kind != "image/png" && kind != "image/jpeg" {
                    self.warn(format!(
                        "a texture of content type {kind:?}; image/png or image/jpeg is allowed"
                    ));
                }
            }
            "texture2dgroup" => {
                self.add_resource("texture2dgroup", e);
                if ids("texid").is_none_or(|t| t.is_empty()) {
                    self.warn("a texture2dgroup without a texid");
                }
            }
            "compositematerials" => {
                self.add_resource("compositematerials", e);
                let base = ids("matid").and_then(|m| m.first().copied());
                if base.and_then(|id| self.kinds.get(&id)).is_none_or(|k| k != "basematerials") {
                    self.warn("a compositematerials whose matid is not a basematerials");
                }
                if attribute(e, "matindices").is_none() {
                    self.warn("a compositematerials without matindices");
                }
            }
            "multiproperties" => {
                self.add_resource("multiproperties", e);
                let kinds: Vec<String> = ids("pids")
                    .unwrap_or_default()
                    .iter()
                    .filter_map(|id| self.kinds.get(id).cloned())
                    .collect();
                let of = |wanted: &[&str]| kinds.iter().filter(|k| wanted.contains(&k.as_str())).count();
                if of(&["basematerials", "compositematerials"]) > 1 {
                    self.warn("a multiproperties with more than one material group");
                }
                if of(&["multiproperties"]) > 0 {
                    self.warn("a multiproperties that refers to another one");
                }
                if of(&["colorgroup"]) > 1 {
                    self.warn("a multiproperties with more than one colorgroup");
                }
            }
            _ => {}
        }
    }

    fn finish(mut self) -> Result<Part, MeshError> {
        let fail = |problem: &str| Err(invalid(&self.path, problem));
        match self.models {
            0 => return fail("no <model> element"),
            1 => {}
            _ => return fail("more than one <model> element"),
        }
        if !self.has_resources {
            return fail("no <resources> element");
        }
        if !self.has_build {
            self.warn("no <build> element");
        }
        let unit = self.unit.unwrap_or(LengthUnit::Millimetre);
        Ok(Part { unit, objects: self.objects, items: self.items, warnings: self.warnings })
    }
}

fn use_of(e: &BytesStart<'_>, key: &str) -> Result<Component, MeshError> {
    let id = attribute(e, key).and_then(|t| t.trim().parse().ok());
    let object = id.ok_or_else(|| invalid("", format!("no {key} where one is needed")))?;
    let transform = match attribute(e, "transform") {
        None => Transform::IDENTITY,
        Some(text) => Transform::parse(text.as_bytes())
            .ok_or_else(|| invalid("", format!("transform {text:?} is not 12 numbers")))?,
    };
    Ok(Component { object, path: attribute(e, "path"), transform })
}
