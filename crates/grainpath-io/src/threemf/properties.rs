//! Property groups of a model part: materials, colours and textures.
//!
//! grainpath prints with one material and uses none of them. References among them are still checked: a broken reference
//! shows that the program that wrote the file has a fault, so the user should inspect the rest of the file.
//! Source: 3MF Core Specification 1.4, chapter 5, and 3MF Materials and Properties Extension.

use std::collections::BTreeMap;

use quick_xml::events::BytesStart;

use crate::xml::attribute;

/// A broken rule: the section of the specification that states the rule, and how the file breaks it.
pub(super) type Broken = (&'static str, String);

/// The largest resource id that the schema allows, 2^31 - 1.
const MAX_ID: u32 = i32::MAX as u32;

/// A property group or another resource that can be referred to.
#[derive(Debug)]
struct Resource {
    /// Local name of its element.
    kind: String,
    /// Number of members that an index can refer to: base materials, colours, texture coordinates and so on.
    n_members: u32,
}

/// All resources of a model part that were defined so far.
#[derive(Debug, Default)]
pub(super) struct Resources {
    by_id: BTreeMap<u32, Resource>,
    /// The property group whose members are being read.
    open: Option<u32>,
}

/// A reference to a member of a property group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reference {
    Good,
    /// No property group has this id.
    NoGroup,
    /// The group has fewer members.
    NoMember,
}

impl Resources {
    /// Registers the resource that an element defines. Returns its id if the id is valid.
    pub(super) fn define(&mut self, kind: &str, e: &BytesStart<'_>, broken: &mut Vec<Broken>) -> Option<u32> {
        self.open = None;
        let Some(id) = attribute(e, "id").and_then(|t| t.trim().parse().ok()) else {
            broken.push(("core 3.4.2", format!("a {kind} without an id")));
            return None;
        };
        if id == 0 || id > MAX_ID {
            broken.push(("core 3.4.2", format!("resource id {id}; ids run from 1 to {MAX_ID}")));
        }
        if self.by_id.insert(id, Resource { kind: kind.to_owned(), n_members: 0 }).is_some() {
            broken.push(("core 3.4.2", format!("resource id {id} is given twice")));
        }
        Some(id)
    }

    /// Checks a property group id and an index into the group.
    pub(super) fn check(&self, pid: u32, index: Option<u32>) -> Reference {
        match (self.by_id.get(&pid), index) {
            (Some(r), _) if r.kind == "object" || r.kind == "texture2d" => Reference::NoGroup,
            (None, _) => Reference::NoGroup,
            // The members of a group are not counted if its extension is not read, so an index into such a group cannot be
            // checked.
            (Some(r), Some(i)) if i >= r.n_members && is_property_group(&r.kind) => Reference::NoMember,
            _ => Reference::Good,
        }
    }

    /// Whether an id is that of a `basematerials` group.
    pub(super) fn is_base_materials(&self, id: u32) -> bool {
        self.by_id.get(&id).is_some_and(|r| r.kind == "basematerials")
    }

    /// Reads an element of the material chapters; other elements are passed over.
    pub(super) fn element(&mut self, name: &str, e: &BytesStart<'_>, broken: &mut Vec<Broken>) {
        let ids = |name: &str| -> Vec<u32> {
            attribute(e, name).unwrap_or_default().split_whitespace().filter_map(|w| w.parse().ok()).collect()
        };
        match name {
            "base" | "color" | "tex2coord" | "composite" | "multi" => {
                if let Some(group) = self.open.and_then(|id| self.by_id.get_mut(&id)) {
                    // Only a damaged file has more members than a u32 can count; the count then stays at the largest
                    // u32.
                    group.n_members = group.n_members.saturating_add(1);
                }
                if name == "color" && attribute(e, "color").is_none() {
                    broken.push(("materials 2", "a color without its value".into()));
                }
            }
            "texture2d" => {
                self.define(name, e, broken);
                let kind = attribute(e, "contenttype").unwrap_or_default();
                if kind != "image/png" && kind != "image/jpeg" {
                    let text =
                        format!("a texture of content type {kind:?}; image/png or image/jpeg is allowed");
                    broken.push(("materials 6", text));
                }
            }
            _ if !is_property_group(name) => {}
            _ => {
                let own = self.define(name, e, broken);
                match name {
                    "texture2dgroup" if ids("texid").is_empty() => {
                        broken.push(("materials 3", "a texture2dgroup without a texid".into()));
                    }
                    "compositematerials" => {
                        if !ids("matid").first().is_some_and(|&id| self.is_base_materials(id)) {
                            let text = "a compositematerials whose matid is not a basematerials";
                            broken.push(("materials 4", text.into()));
                        }
                        if attribute(e, "matindices").is_none() {
                            broken.push(("materials 4", "a compositematerials without matindices".into()));
                        }
                    }
                    "multiproperties" => self.multiproperties(&ids("pids"), broken),
                    _ => {}
                }
                // Members follow as children of this element until the next group begins.
                self.open = own;
            }
        }
    }

    fn multiproperties(&self, pids: &[u32], broken: &mut Vec<Broken>) {
        let kinds: Vec<&str> = pids.iter().filter_map(|id| Some(self.by_id.get(id)?.kind.as_str())).collect();
        // Materials extension, section 5: at most one material and one colour group, and no nesting.
        let count = |wanted: &[&str]| kinds.iter().filter(|k| wanted.contains(k)).count();
        let mut complain = |text: &str| broken.push(("materials 5", text.to_owned()));
        if kinds.len() < pids.len() {
            complain("a multiproperties that refers to a group that does not exist");
        }
        if count(&["basematerials", "compositematerials"]) > 1 {
            complain("a multiproperties with more than one material group");
        }
        if count(&["multiproperties"]) > 0 {
            complain("a multiproperties that refers to another one");
        }
        if count(&["colorgroup"]) > 1 {
            complain("a multiproperties with more than one colorgroup");
        }
    }
}

fn is_property_group(kind: &str) -> bool {
    matches!(
        kind,
        "basematerials" | "colorgroup" | "texture2dgroup" | "compositematerials" | "multiproperties"
    )
}
