//! One model part: its objects and its build, and the rules of the specification that it breaks.
//!
//! Source: 3MF Core Specification 1.4. A broken rule gives a warning that names the section if the triangles can still be
//! read without doubt; otherwise it gives an error. Elements and attributes of namespaces other than core, materials and
//! production are passed over, as section 2.3.3.1 demands.

use std::collections::{BTreeMap, BTreeSet};

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, TriMesh, Warning, WarningId};
use quick_xml::events::{BytesStart, Event};
use quick_xml::name::QName;

use super::package::{Package, events, invalid};
use super::paint;
use super::properties::{Broken, Reference, Resources};
use super::transform::Transform;
use crate::mesh::model::{MeshError, MeshProblem, PaintedSupports, SoupBuilder};
use crate::position::checked;
use crate::xml::attribute;
use grainpath_core::number::{number, whole};

/// Names of metadata that need no prefix. Source: 3MF Core Specification 1.4, table 3-1.
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

/// The namespace of the core specification.
const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";

/// Namespaces of the extensions whose shape data grainpath reads completely. Source: appendix C of the extensions.
const KNOWN_EXTENSIONS: [&str; 5] = [
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    "http://schemas.openxmlformats.org/markup-compatibility/2006",
    CORE,
];

/// Limit on warnings of a part. A damaged file could otherwise give one for each triangle.
/// Source: chosen; nobody reads more.
const MAX_WARNINGS: usize = 50;

/// A use of an object, by a component or a build item.
#[derive(Debug, Clone)]
pub(super) struct Component {
    pub(super) object: u32,
    pub(super) path: Option<String>,
    pub(super) transform: Transform,
}

#[derive(Debug)]
pub(super) enum Content {
    Mesh(TriMesh, PaintedSupports),
    Components(Vec<Component>),
}

/// Purpose of an object. Source: table of section 4, attribute `type`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ObjectType {
    /// `model` or `solidsupport`: printed as solid bodies.
    Solid,
    /// `support`: grainpath makes its own supports, as the specification allows.
    Support,
    /// `surface`: an open surface, which has no inside.
    Surface,
    /// `other` and words that the specification does not know: never printed.
    Other,
}

#[derive(Debug)]
pub(super) struct Object {
    pub(super) name: Option<String>,
    pub(super) content: Content,
    pub(super) kind: ObjectType,
}

pub(super) struct ModelPart {
    pub(super) unit: LengthUnit,
    pub(super) objects: BTreeMap<u32, Object>,
    pub(super) items: Vec<Component>,
    pub(super) warnings: Vec<Warning>,
}

impl ModelPart {
    /// Reads the part at `path` of the package.
    pub(super) fn read(package: &mut Package<'_>, path: &str) -> Result<Self, MeshError> {
        let mut builder = Builder { path: path.to_owned(), ..Builder::default() };
        package.read(path, |r| events(r, path, |event| builder.event(event)))?;
        builder.finish()
    }

    /// Paths of other parts whose objects this one uses.
    pub(super) fn paths(&self) -> Vec<String> {
        let components = self.objects.values().flat_map(|o| match &o.content {
            Content::Components(c) => c.as_slice(),
            Content::Mesh(..) => &[],
        });
        components.chain(&self.items).filter_map(|c| c.path.clone()).collect()
    }
}

#[derive(Default)]
struct Builder {
    path: String,
    unit: Option<LengthUnit>,
    n_models: usize,
    n_resources: usize,
    n_builds: usize,
    /// URI of each namespace prefix that `<model>` declares.
    namespaces: BTreeMap<String, String>,
    metadata: BTreeSet<String>,
    resources: Resources,
    /// Whether the file requires an extension that is not read.
    requires_unread: bool,
    /// Objects whose triangles have properties while the object itself has none.
    n_without_default: usize,
    objects: BTreeMap<u32, Object>,
    items: Vec<Component>,
    warnings: Vec<Warning>,
    current: Option<Current>,
}

/// The object that is being read.
struct Current {
    id: u32,
    name: Option<String>,
    kind: ObjectType,
    pid: Option<u32>,
    has_pindex: bool,
    has_mesh: bool,
    has_components: bool,
    vertices: Vec<u32>,
    soup: SoupBuilder,
    n_triangles: u64,
    /// Number of triangles that break a rule, for each rule.
    broken: BrokenTriangles,
    /// Painted triangles with the digits that describe the paint.
    painted: Vec<([u32; 3], Vec<u8>)>,
    components: Vec<Component>,
}

/// For each rule, the number of triangles of an object that break it, so that one warning covers all of
/// them.
#[derive(Default)]
struct BrokenTriangles {
    repeated_corner: u64,
    index_without_group: u64,
    no_such_group: u64,
    no_such_member: u64,
    gradient: u64,
    p2_without_p1: u64,
    has_property: bool,
}

impl Builder {
    fn event(&mut self, event: &Event<'_>) -> Result<(), MeshError> {
        match event {
            Event::Start(e) | Event::Empty(e) => {
                self.element(e)?;
                if matches!(event, Event::Empty(_))
                    && self.is_core(e.name())
                    && e.local_name().as_ref() == "object"
                {
                    // `<object/>` has no end tag, so its object is complete at once.
                    self.end_object();
                }
            }
            Event::End(e) if self.is_core(e.name()) && e.local_name().as_ref() == "object" => {
                self.end_object()
            }
            Event::Decl(decl) => {
                let encoding = decl.encoding().and_then(Result::ok);
                // UTF-16 is known by its first bytes; all other text is decoded as UTF-8, whatever is declared.
                let is_allowed = |e: &str| ["utf-8", "utf-16"].iter().any(|a| e.eq_ignore_ascii_case(a));
                if encoding.is_some_and(|e| !is_allowed(e.as_ref())) {
                    self.warn("core 2.3.2", "an XML encoding other than UTF-8 and UTF-16 is declared");
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether an element is one of the core specification: unprefixed, or with a prefix of the core namespace.
    fn is_core(&self, name: QName<'_>) -> bool {
        name.prefix().is_none_or(|p| self.namespaces.get(p.as_ref()).is_some_and(|uri| uri == CORE))
    }

    fn element(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let local = e.local_name();
        let name = local.as_ref();
        if name == "model" {
            return self.model(e);
        }
        if !self.is_core(e.name()) {
            return self.foreign(name, e);
        }
        match name {
            "vertex" => return self.vertex(e),
            "triangle" => return self.triangle(e),
            "resources" => self.n_resources += 1,
            "build" => self.n_builds += 1,
            "metadata" => self.metadata(e),
            "object" => self.start_object(e)?,
            "component" => {
                let component = component(e)?;
                // The core specification asks for definition before use, so that readers can stream.
                if component.path.is_none() && !self.objects.contains_key(&component.object) {
                    let id = component.object;
                    self.warn(
                        "core 3.4",
                        format!("a component refers to object {id}, which is not defined before it"),
                    );
                }
                if let Some(current) = &mut self.current {
                    current.components.push(component);
                }
            }
            "item" => {
                let item = component(e)?;
                // `printable="0"` is an attribute of slicers for objects that stay on the plate and are
                // not printed.
                if attribute(e, "printable").is_none_or(|p| p != "0") {
                    self.items.push(item);
                }
            }
            "mesh" | "components" => {
                if let Some(current) = &mut self.current {
                    current.has_mesh |= name == "mesh";
                    current.has_components |= name == "components";
                }
            }
            "vertices" | "triangles" | "metadatagroup" => {}
            "basematerials" | "base" => self.property(name, e),
            // Many programs write elements of the materials extension without its prefix.
            other => {
                let known = self.property_of_extension(other, e);
                if !known {
                    self.warn("core 2.3.2", format!("<{other}>, which the core specification does not know"));
                }
            }
        }
        self.check_attributes(name, e);
        Ok(())
    }

    fn model(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        self.n_models += 1;
        // Core 3.4: `unit` defaults to millimeter.
        let unit = attribute(e, "unit").unwrap_or_else(|| "millimeter".into());
        self.unit = LengthUnit::from_name(&unit);
        if self.unit.is_none() {
            // An unknown unit would scale the part wrongly without a visible sign.
            return Err(invalid("", MeshProblem::Unit(unit)));
        }
        for a in e.attributes().with_checks(false).filter_map(Result::ok) {
            let key: &str = a.key.as_ref();
            // Prefixes are free in XML; only their URIs identify an extension.
            if let Some(prefix) = key.strip_prefix("xmlns:") {
                self.namespaces.insert(prefix.to_owned(), a.value.trim().to_owned());
            } else if key == "xmlns" && a.value.trim() != CORE {
                let uri = a.value.chars().take(100).collect::<String>();
                self.warn(
                    "core 2.3.3.1",
                    format!("<model> is in the namespace {uri:?}, which is not that of 3MF"),
                );
            }
        }
        // Without a prefix or a default namespace, `<model>` and all in it is not 3MF's.
        if e.name().prefix().is_none() && attribute(e, "xmlns").is_none() {
            self.warn("core 2.3.3.1", format!("<model> is in no namespace; 3MF's is {CORE:?}"));
        }
        for (key, word) in [("requiredextensions", "requires"), ("recommendedextensions", "recommends")] {
            for prefix in attribute(e, key).unwrap_or_default().split_whitespace() {
                match self.namespaces.get(prefix) {
                    None => self.warn(
                        "core 3.4",
                        format!("{key} names the prefix {prefix:?}, which is not declared"),
                    ),
                    Some(uri) if KNOWN_EXTENSIONS.contains(&uri.as_str()) => {}
                    Some(uri) => {
                        self.requires_unread |= key == "requiredextensions";
                        let text = format!(
                            "the file {word} the extension {uri:?}, which grainpath does not read; \
                             the part may look different from what is printed (3MF core 3.4)"
                        );
                        self.push(WarningId::ThreemfNotRead, text);
                    }
                }
            }
        }
        self.check_attributes("model", e);
        Ok(())
    }

    /// An element of another namespace.
    fn foreign(&mut self, name: &str, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let declared = e.name().prefix().is_some_and(|p| {
            let own = format!("xmlns:{}", p.as_ref());
            self.namespaces.contains_key(p.as_ref())
                || e.attributes().with_checks(false).flatten().any(|a| a.key.as_ref() == own)
        });
        if !declared && let Some(prefix) = e.name().prefix() {
            self.warn("core 2.3.3.1", format!("the prefix {:?} is used and not declared", prefix.as_ref()));
        }
        // Without its beams the printed part would lack most of its volume.
        if name == "beamlattice" {
            self.push(WarningId::ThreemfNotRead, "a beam lattice; grainpath reads triangles alone".into());
        }
        self.property_of_extension(name, e);
        self.check_attributes(name, e);
        Ok(())
    }

    /// Attributes that are allowed on no element.
    fn check_attributes(&mut self, name: &str, e: &BytesStart<'_>) {
        let has = |start: &str| {
            e.attributes().with_checks(false).flatten().any(|a| a.key.as_ref().starts_with(start))
        };
        if has("xsi:") {
            self.warn("core 2.3.2", format!("<{name}> has a schema instance attribute"));
        }
        if has("xml:space") {
            self.warn("core 2.3.4", format!("<{name}> has the attribute xml:space"));
        }
    }

    fn metadata(&mut self, e: &BytesStart<'_>) {
        let name = attribute(e, "name").unwrap_or_default();
        match name.split_once(':') {
            None if !METADATA.contains(&name.as_str()) => {
                self.warn(
                    "core 3.4.1",
                    format!("metadata named {name:?}, which is neither one of 3MF's nor prefixed"),
                );
            }
            Some((prefix, _)) if !self.namespaces.contains_key(prefix) => {
                self.warn("core 3.4.1", format!("metadata named {name:?}, whose prefix is not declared"));
            }
            _ => {}
        }
        // Objects and items have metadata of their own, whose names may repeat. The model's metadata come before the
        // resources.
        if self.n_resources == 0 && !self.metadata.insert(name.clone()) {
            self.warn("core 3.4.1", format!("metadata named {name:?} is given twice"));
        }
    }

    /// Warns of a broken rule; `section` is the section of the specification that states the rule.
    fn warn(&mut self, section: &str, what: impl std::fmt::Display) {
        self.push(WarningId::ThreemfRule, format!("{what} (3MF {section})"));
    }

    fn push(&mut self, id: WarningId, text: String) {
        let warning = Warning::new(id, text).in_file(self.path.clone());
        // The second test lists each warning once, so that one rule broken a thousand times cannot fill the list.
        if self.warnings.len() < MAX_WARNINGS && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    fn warn_all(&mut self, broken: Vec<Broken>) {
        for (section, what) in broken {
            self.warn(section, what);
        }
    }

    fn property(&mut self, name: &str, e: &BytesStart<'_>) {
        let mut broken = Vec::new();
        self.resources.element(name, e, &mut broken);
        self.warn_all(broken);
    }

    /// Reads an element of the materials extension; false when it is none.
    fn property_of_extension(&mut self, name: &str, e: &BytesStart<'_>) -> bool {
        const ELEMENTS: [&str; 9] = [
            "colorgroup",
            "color",
            "texture2d",
            "texture2dgroup",
            "tex2coord",
            "compositematerials",
            "composite",
            "multiproperties",
            "multi",
        ];
        let known = ELEMENTS.contains(&name);
        if known {
            self.property(name, e);
        }
        known
    }

    fn start_object(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let mut broken = Vec::new();
        let id = self.resources.define("object", e, &mut broken);
        self.warn_all(broken);
        let id = id.ok_or_else(|| invalid("", MeshProblem::ObjectWithoutId))?;
        let kind = match attribute(e, "type").unwrap_or_default().as_str() {
            // Core 4: `type` defaults to model.
            "" | "model" | "solidsupport" => ObjectType::Solid,
            "support" => ObjectType::Support,
            "surface" => ObjectType::Surface,
            "other" => ObjectType::Other,
            unknown => {
                self.warn(
                    "core 4",
                    format!("object {id} is of the unknown type {unknown:?} and is left out"),
                );
                ObjectType::Other
            }
        };
        // A number that cannot be read becomes an index that no group has, and is reported as an invalid index.
        let index = |key: &str| attribute(e, key).map(|t| t.trim().parse::<u32>().unwrap_or(u32::MAX));
        let (pid, pindex) = (index("pid"), index("pindex"));
        match pid.map(|pid| self.resources.check(pid, pindex)) {
            None if pindex.is_some() => self.warn("core 4", format!("object {id} has a pindex and no pid")),
            Some(Reference::NoGroup) => {
                self.warn("core 4", format!("object {id} has a pid that no property group before it has"));
            }
            Some(Reference::NoMember) => {
                self.warn("core 4", format!("object {id} has a pindex beyond the end of its property group"));
            }
            _ => {}
        }
        self.current = Some(Current {
            id,
            name: attribute(e, "name").filter(|n| !n.is_empty()),
            kind,
            pid,
            has_pindex: pindex.is_some(),
            has_mesh: false,
            has_components: false,
            vertices: Vec::new(),
            soup: SoupBuilder::with_capacity(0),
            n_triangles: 0,
            broken: BrokenTriangles::default(),
            painted: Vec::new(),
            components: Vec::new(),
        });
        Ok(())
    }

    fn end_object(&mut self) {
        let Some(current) = self.current.take() else { return };
        self.check_object(&current);
        let body = current.soup.finish(None);
        let mut painted = PaintedSupports::default();
        for (triangle, digits) in &current.painted {
            let corners = triangle.map(|i| body.mesh.vertices[i as usize]);
            // Paint only guides supports and the shape is complete without it, so unreadable paint gives only a warning.
            if paint::decode(digits, corners, &mut painted).is_none() {
                let text = "a triangle whose painted supports cannot be read";
                self.push(WarningId::ThreemfNotRead, text.into());
            }
        }
        // An object has a mesh or components. Where it has both, components win, since they usually refer
        // to the same mesh.
        let content = if current.components.is_empty() {
            Content::Mesh(body.mesh, painted)
        } else {
            Content::Components(current.components)
        };
        self.objects.insert(current.id, Object { name: current.name, content, kind: current.kind });
    }

    /// The rules that concern an object as a whole.
    fn check_object(&mut self, current: &Current) {
        let id = current.id;
        match (current.has_mesh, current.has_components) {
            (true, true) => {
                let left_out = if current.components.is_empty() { "components are" } else { "mesh is" };
                self.warn(
                    "core 4",
                    format!("object {id} has a mesh and components; its {left_out} left out"),
                );
            }
            (false, false) => self.warn("core 4", format!("object {id} has neither a mesh nor components")),
            _ => {}
        }
        if current.has_components && (current.pid.is_some() || current.has_pindex) {
            self.warn("core 4", format!("object {id} has components and a pid or pindex"));
        }
        if current.has_mesh && !current.has_components {
            if current.vertices.len() < 3 {
                self.warn(
                    "core 4.1.3",
                    format!("object {id} has {} vertices; a mesh needs 3", current.vertices.len()),
                );
            }
            // An extension that the file requires may define the shape by other means than triangles
            // (beams, volumetric data).
            // A closed solid has at least four triangles, those of a tetrahedron.
            if current.n_triangles < 4 && current.kind == ObjectType::Solid && !self.requires_unread {
                let n = current.n_triangles;
                self.warn("core 4.1.4", format!("object {id} has {n} triangles; a solid needs 4"));
            }
        }
        let b = &current.broken;
        for (n, what) in [
            (b.repeated_corner, "whose corners are not three different vertices"),
            (b.index_without_group, "with a p1 and no pid, neither their own nor their object's"),
            (b.no_such_group, "with a pid that no property group has"),
            (b.no_such_member, "with a p1, p2 or p3 beyond the end of their property group"),
            (b.gradient, "with a gradient between base materials"),
            (b.p2_without_p1, "with a p2 or p3 and no p1"),
        ] {
            if n > 0 {
                self.warn("core 4.1.4.1", format!("object {id} has {n} triangles {what}"));
            }
        }
        self.n_without_default +=
            usize::from(b.has_property && (current.pid.is_none() || !current.has_pindex));
    }

    fn vertex(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let Some(current) = &mut self.current else { return Ok(()) };
        let place = || format!("{}, object {}, vertex {}", self.path, current.id, current.vertices.len());
        // A missing coordinate stays NaN and is refused by `checked`.
        let mut p = [f64::NAN; 3];
        for a in e.attributes().with_checks(false).filter_map(Result::ok) {
            if let [axis @ b'x'..=b'z'] = a.key.as_ref().as_bytes() {
                let text: String = a.value.chars().take(40).collect();
                p[usize::from(axis - b'x')] = number(a.value.as_bytes().trim_ascii()).ok_or_else(|| {
                    invalid(&place(), MeshProblem::NotNumber { axis: char::from(*axis), text })
                })?;
            }
        }
        let p: DVec3 = checked(p, place)?;
        current.vertices.push(current.soup.index(p)?);
        Ok(())
    }

    fn triangle(&mut self, e: &BytesStart<'_>) -> Result<(), MeshError> {
        let Some(current) = &mut self.current else { return Ok(()) };
        // -1 marks a missing or unreadable index; no vertex has it.
        let mut corners = [-1i64; 3];
        let mut digits = Vec::new();
        let (mut pid, mut indices) = (None, [None; 3]);
        let index = |value: &str| value.trim().parse::<u32>().unwrap_or(u32::MAX);
        for a in e.attributes().with_checks(false).filter_map(Result::ok) {
            match a.key.as_ref().as_bytes() {
                [b'v', k @ b'1'..=b'3'] => {
                    corners[usize::from(k - b'1')] = whole(a.value.as_bytes().trim_ascii()).unwrap_or(-1);
                }
                [b'p', k @ b'1'..=b'3'] => indices[usize::from(k - b'1')] = Some(index(&a.value)),
                b"pid" => pid = Some(index(&a.value)),
                // The attribute names of the slicers that write painted supports.
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
        current.n_triangles += 1;
        if !digits.is_empty() {
            current.painted.push((triangle, digits));
        }
        let [a, b, c] = corners;
        // Compared by the file's indices: merged vertices may coincide in sound files too.
        current.broken.repeated_corner += u64::from(a == b || b == c || c == a);
        current.broken.count_properties(pid, current.pid, indices, &self.resources);
        Ok(())
    }

    fn finish(mut self) -> Result<ModelPart, MeshError> {
        let fail = |problem: MeshProblem| Err(invalid(&self.path, problem));
        match self.n_models {
            0 => return fail(MeshProblem::NoModel),
            1 => {}
            _ => return fail(MeshProblem::Models),
        }
        match self.n_resources {
            // If the model has no resources, the build has no object to use.
            0 => return fail(MeshProblem::NoResources),
            1 => {}
            n => self.warn("core 3.4", format!("{n} <resources> elements; a model has one")),
        }
        match self.n_builds {
            0 => self.warn("core 3.4", "no <build> element"),
            1 => {}
            n => self.warn("core 3.4", format!("{n} <build> elements; a model has one")),
        }
        if self.n_without_default > 0 {
            let n = self.n_without_default;
            self.warn(
                "core 4",
                format!("triangles have properties and their object has no pid and pindex, in {n} objects"),
            );
        }
        let unit = self.unit.unwrap_or(LengthUnit::Millimetre);
        Ok(ModelPart { unit, objects: self.objects, items: self.items, warnings: self.warnings })
    }
}

impl BrokenTriangles {
    /// Checks the property attributes of a triangle.
    fn count_properties(
        &mut self,
        own_pid: Option<u32>,
        object_pid: Option<u32>,
        indices: [Option<u32>; 3],
        resources: &Resources,
    ) {
        if own_pid.is_none() && indices == [None; 3] {
            return;
        }
        self.has_property = true;
        self.p2_without_p1 +=
            u64::from(indices[0].is_none() && (indices[1].is_some() || indices[2].is_some()));
        let Some(pid) = own_pid.or(object_pid) else {
            self.index_without_group += 1;
            return;
        };
        // The first check tests only whether the group exists; the others test each index into it.
        let references = [None, indices[0], indices[1], indices[2]].map(|index| resources.check(pid, index));
        if references.contains(&Reference::NoGroup) {
            self.no_such_group += 1;
        } else if references.contains(&Reference::NoMember) {
            self.no_such_member += 1;
        }
        let first = indices[0];
        // The core specification forbids different base materials on one triangle: a mixture of two
        // materials has no meaning there.
        let gradient = indices[1..].iter().any(|i| i.is_some() && *i != first);
        self.gradient += u64::from(gradient && first.is_some() && resources.is_base_materials(pid));
    }
}

/// The use of an object that a `<component>` or `<item>` states.
fn component(e: &BytesStart<'_>) -> Result<Component, MeshError> {
    let id = attribute(e, "objectid").and_then(|t| t.trim().parse().ok());
    let object = id.ok_or_else(|| invalid("", MeshProblem::NoObjectId))?;
    let transform = match attribute(e, "transform") {
        None => Transform::IDENTITY,
        Some(text) => Transform::parse(text.as_bytes())
            .ok_or_else(|| invalid("", MeshProblem::Transform(text.clone())))?,
    };
    Ok(Component { object, path: attribute(e, "path"), transform })
}
