//! Finite-element files: meshes, results and decks in, results out.
//!
//! [`parse_fe`] reads a file as it is: nodes, elements and every array, in the units of the file. [`FeFile::result`] then
//! picks the stress, checks its unit and the order of its components, and gives an [`FeResult`] in mm and MPa with a
//! stress at every node. [`StressField`] interpolates that stress at any point. [`FeFile::deck_conditions`] gives the
//! supports and loads of an INP deck, for another mesh of its part.
//!
//! ```
//! use grainpath_core::DVec3;
//! use grainpath_io::fe::{FeOptions, StressField, parse_fe};
//!
//! let table = b"x,y,z,sxx,syy,szz,sxy,syz,szx\n0,0,0,10,0,0,0,0,0\n5,0,0,20,0,0,0,0,0\n";
//! let result = parse_fe(table, Some("stress.csv"))?.result(&FeOptions::default())?;
//! assert!((result.max_von_mises_mpa() - 20.0).abs() < 1e-9);
//! let field = StressField::new(result);
//! assert!((field.sample(DVec3::new(5.0, 0.0, 0.0))[0] - 20.0).abs() < 1e-9);
//! # Ok::<(), grainpath_io::fe::FeError>(())
//! ```

mod bytes;
mod csv;
mod deck;
mod deck_conditions;
mod element;
mod stress_field;
mod frd;
mod gmsh;
mod inp;
mod medit;
mod model;
mod nodal_forces;
mod plate_deck;
mod problem;
mod result;
mod vtk;
mod vtu;
mod write;

use crate::text::skip_space;

pub use deck::{
    Behaviour, BodyForce, BodyLoad, Deck, Elastic, FaceLoad, Fixed, Material, PointLoad, Section, Step,
};
pub use deck_conditions::{DeckConditions, DeckLoad, DeckMaterial, DeckPlace, DeckStep, DeckSupport};
pub use element::{ElementKind, MAX_NODES, Shape};
pub use grainpath_core::tensor::{Principal, principal, von_mises};
pub use model::{Element, FeArray, FeError, FeFile, FeFormat, Group, On};
pub use plate_deck::{PlateDeck, write_plate_deck};
pub use problem::FeProblem;
pub use result::{FeOptions, FeResult, Order, StressUnit};
pub use stress_field::{Location, StressField};
pub use write::{Encoding, PointData, VtuMesh, stress_point_data, write_vtu};

/// The format of these bytes, if they can be a finite-element file.
pub fn sniff_fe(bytes: &[u8], name: Option<&str>) -> Option<FeFormat> {
    let extension = name.and_then(|n| n.rsplit_once('.')).map(|(_, e)| e.to_ascii_lowercase());
    let is = |e: &str| extension.as_deref() == Some(e);
    let text = skip_space(bytes);
    // The first 4096 bytes hold the signature of every format; the rest may be gigabytes.
    let head = &text[..text.len().min(4096)];
    let has = |word: &str| head.windows(word.len()).any(|w| w.eq_ignore_ascii_case(word.as_bytes()));
    let starts = |word: &str| head.get(..word.len()).is_some_and(|h| h.eq_ignore_ascii_case(word.as_bytes()));
    if starts("<") && has("<VTKFile") || is("vtu") {
        return Some(FeFormat::Vtu);
    }
    if starts("# vtk DataFile") {
        return Some(FeFormat::Vtk);
    }
    // A Gmsh file may begin with comments (`$Comments`) before its format.
    if starts("$MeshFormat") || starts("$NOD") || (starts("$") && (has("$MeshFormat") || is("msh"))) {
        return Some(FeFormat::Gmsh);
    }
    if starts("MeshVersionFormatted") {
        return Some(FeFormat::Medit);
    }
    // STEP is recognised so that the user learns why it is refused, instead of reading "unknown format".
    if starts("ISO-10303-21") {
        return Some(FeFormat::Step);
    }
    // An FRD file begins with the record `    1C`, written in fixed columns.
    if is("frd") || bytes.starts_with(b"    1C") || bytes.starts_with(b"    1U") {
        return Some(FeFormat::Frd);
    }
    if is_ansys_rst(bytes, is("rst")) {
        return Some(FeFormat::AnsysRst);
    }
    let keyword = ["*NODE", "*HEADING", "*ELEMENT", "*PART", "*INCLUDE", "*MATERIAL", "*NSET", "*ELSET"];
    // A deck may begin with comments; then one of the usual keywords has to follow within the first 4096
    // bytes.
    let deck = keyword.iter().any(|k| starts(k)) || (starts("**") && keyword.iter().any(|k| has(k)));
    if deck || (is("inp") && starts("*")) {
        return Some(FeFormat::Inp);
    }
    // CSV has no signature and is asked last: its header test accepts any two columns named x and y.
    (is("csv") || csv::looks_like(head)).then_some(FeFormat::Csv)
}

/// Whether these bytes are a binary result file of ANSYS.
///
/// The file is a row of Fortran records in 32-bit words. The first record is the standard header: its length of 100 words,
/// a word of flags, then the kind of the file, which is 12 for results. Source: pymapdl-reader, `common.py`.
fn is_ansys_rst(bytes: &[u8], named_rst: bool) -> bool {
    let word = |i: usize| {
        let b: [u8; 4] = bytes.get(4 * i..4 * i + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(b))
    };
    let is_binary = bytes.iter().take(400).any(|&b| b == 0);
    // Writers differ by one word in where the kind of the file stands. The extension decides where
    // neither place has it.
    is_binary && word(0) == Some(100) && (word(2) == Some(12) || word(3) == Some(12) || named_rst)
}

/// Reads a finite-element file of any format. The content decides the format; `name` (a file name) helps
/// only where the content leaves it open.
///
/// # Errors
/// [`FeError`] with what is wrong and where.
pub fn parse_fe(bytes: &[u8], name: Option<&str>) -> Result<FeFile, FeError> {
    if bytes.is_empty() {
        return Err(FeError::Empty);
    }
    let file = match sniff_fe(bytes, name).ok_or(FeError::Unknown)? {
        FeFormat::Vtu => vtu::read(bytes)?,
        FeFormat::Vtk => vtk::read(bytes)?,
        FeFormat::Gmsh => gmsh::read(bytes)?,
        FeFormat::Frd => frd::read(bytes)?,
        FeFormat::Inp => inp::read(bytes)?,
        FeFormat::Medit => medit::read(bytes)?,
        FeFormat::Csv => csv::read(bytes)?,
        FeFormat::Step => return Err(FeError::Geometry),
        FeFormat::AnsysRst => return Err(FeError::AnsysRst),
    };
    if file.nodes.is_empty() {
        return Err(FeError::NoNodes);
    }
    Ok(file)
}
