//! STL, binary and ASCII.
//!
//! A binary file has a header of 80 bytes, the number of facets (`u32`, little endian) and 50 bytes for each facet: normal
//! and three corners as `f32`, and two bytes of attributes. An ASCII file has one or more `solid` blocks. Source: 3D Systems,
//! *StereoLithography Interface Specification*, 1989; there is no later standard.
//!
//! Units: the format has none. Normals are computed from the corners, because programs write zeros, `nan` and wrong ones.
//! Corners with equal coordinates become one vertex. The size of the file tells the two kinds apart: many
//! binary headers begin with the word `solid`. A binary file that ends early is refused; one with up to
//! 4095 bytes after its last facet is read with a warning.

use std::io::{self, Read, Write};

use grainpath_core::{DVec3, TriMesh, Warning, WarningId};

use super::model::{MeshBody, MeshError, MeshFile, SoupBuilder};
use crate::position::checked;
use crate::text::{TextError, Words};

// Source: 3D Systems, *StereoLithography Interface Specification*: 80 bytes of text and a 32-bit count.
const HEADER: usize = 84;
// Source: the same: 12 floats of 4 bytes and 2 bytes of attributes.
const FACET: usize = 50;

fn promised(head: &[u8]) -> Option<u64> {
    let n: [u8; 4] = head.get(80..HEADER)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(n)))
}

/// Whether the size of a file is that of a binary STL with the number of facets that its header states. `head` holds its
/// first bytes. Up to 4095 bytes of padding are accepted.
pub(crate) fn has_binary_size(head: &[u8], n_bytes: u64) -> bool {
    promised(head).is_some_and(|n| {
        let spare = n_bytes.checked_sub(HEADER as u64 + FACET as u64 * n);
        // A text that begins with `solid` could match the size by chance if padding were accepted, so padding is accepted
        // only after other headers.
        n > 0 && spare.is_some_and(|s| s == 0 || (s < 4096 && !head[..80].starts_with(b"solid")))
    })
}

/// Whether the bytes look like a binary STL whose end is missing: not text, and fewer facets than the
/// header states.
pub(crate) fn is_cut_short(bytes: &[u8], named_stl: bool) -> bool {
    let n = promised(bytes).unwrap_or(0);
    let size = HEADER as u64 + FACET as u64 * n;
    named_stl && bytes.len() >= HEADER && (n == 0 || size > bytes.len() as u64)
}

/// Reads a binary STL of `n_bytes` bytes facet by facet, so that the file is never in memory as a whole.
pub(crate) fn read_binary(mut source: impl Read, n_bytes: u64) -> io::Result<Result<MeshFile, MeshError>> {
    let mut head = [0; HEADER];
    source.read_exact(&mut head)?;
    let promised = promised(&head).unwrap_or(0);
    if promised == 0 {
        return Ok(Err(MeshError::NoTriangles { hints: String::new() }));
    }
    let held = (n_bytes - HEADER as u64) / FACET as u64;
    if held < promised {
        return Ok(Err(MeshError::Truncated { promised, held }));
    }
    let mut soup = SoupBuilder::with_capacity(promised as usize);
    let mut facet = [0; FACET];
    for i in 0..promised {
        source.read_exact(&mut facet)?;
        if let Err(error) = add_facet(&mut soup, &facet, i) {
            return Ok(Err(error));
        }
    }
    let spare = n_bytes - HEADER as u64 - promised * FACET as u64;
    let warnings = if spare > 0 {
        vec![Warning::new(
            WarningId::MeshFileDamaged,
            format!("{spare} bytes after the last facet were left out"),
        )]
    } else {
        vec![]
    };
    Ok(Ok(MeshFile { bodies: vec![soup.finish(None)], unit: None, modifiers: Vec::new(), warnings }))
}

fn add_facet(soup: &mut SoupBuilder, facet: &[u8; FACET], i: u64) -> Result<(), MeshError> {
    let float =
        |k: usize| f64::from(f32::from_le_bytes([facet[k], facet[k + 1], facet[k + 2], facet[k + 3]]));
    let mut corners = [0; 3];
    // Twelve bytes of normal come first and are skipped; the corners give the normal.
    for (c, corner) in corners.iter_mut().enumerate() {
        let k = 12 + 12 * c;
        let p = checked([float(k), float(k + 4), float(k + 8)], || format!("facet {i}"))?;
        *corner = soup.index(p)?;
    }
    soup.push(corners)
}

pub(crate) fn read_ascii(bytes: &[u8]) -> Result<MeshFile, MeshError> {
    let mut words = Words::new(bytes, None);
    let mut bodies: Vec<MeshBody> = Vec::new();
    let mut solid: Option<(SoupBuilder, Option<String>)> = None;
    let mut warnings = Vec::new();
    let mut facet_ended = 0;
    while let Some(word) = words.word() {
        let is = |w: &str| word.eq_ignore_ascii_case(w.as_bytes());
        if is("solid") {
            // A `solid` without `endsolid` before it ends the last body.
            bodies.extend(solid.take().map(|(s, name)| s.finish(name)));
            let name = String::from_utf8_lossy(words.rest_of_line()).into_owned();
            solid = Some((SoupBuilder::with_capacity(0), (!name.is_empty()).then_some(name)));
        } else if is("facet") {
            // Some programs omit the `solid` line.
            let (soup, _) = solid.get_or_insert_with(|| (SoupBuilder::with_capacity(0), None));
            let corners = facet(&mut words)?;
            let mut triangle = [0; 3];
            for (index, p) in triangle.iter_mut().zip(corners) {
                *index = soup.index(p)?;
            }
            soup.push(triangle)?;
            facet_ended = words.line();
        } else if facet_ended == words.line() && !is("endsolid") {
            // Words after `endfacet` on its line mean nothing; some programs leave notes there.
        } else if is("endsolid") {
            bodies.extend(solid.take().map(|(s, name)| s.finish(name)));
            words.rest_of_line();
        } else if solid.is_none() && !bodies.is_empty() {
            let text = "text after the last solid was left out";
            warnings.push(Warning::new(WarningId::MeshFileDamaged, text).in_line(words.line()));
            break;
        } else {
            return Err(words.wrong(word, "`facet` or `endsolid`").into());
        }
    }
    if let Some((soup, name)) = solid {
        // All facets so far are sound, so the mesh is accepted and the user warned.
        let text = "`endsolid` is missing: the file may be cut short";
        warnings.push(Warning::new(WarningId::MeshFileDamaged, text));
        bodies.push(soup.finish(name));
    }
    Ok(MeshFile { bodies, unit: None, modifiers: Vec::new(), warnings })
}

/// Reads the rest of a facet after the word `facet`.
fn facet(words: &mut Words<'_>) -> Result<[DVec3; 3], MeshError> {
    keyword(words, "normal", "`normal`")?;
    // Normals are computed from the corners, so whatever stands here is skipped: programs write nan, inf
    // and worse.
    let mut passed = 0;
    while !words
        .word()
        .ok_or_else(|| TextError::UnexpectedEnd { place: words.place(), expected: "`outer loop`" })?
        .eq_ignore_ascii_case(b"outer")
    {
        passed += 1;
        // More than three words are no normal; stopping here keeps the line number in the message right.
        if passed > 3 {
            return Err(words.wrong(b"a normal of more than 3 numbers", "`outer loop`").into());
        }
    }
    keyword(words, "loop", "`outer loop`")?;
    let mut corners = [DVec3::ZERO; 3];
    for corner in &mut corners {
        keyword(words, "vertex", "`vertex` (a facet has 3)")?;
        let p = words.position()?;
        *corner = checked(p, || words.place())?;
    }
    keyword(words, "endloop", "`endloop` (a facet has 3 vertices)")?;
    let line = words.line();
    // Only words in the line of `endloop` may come before `endfacet`. Elsewhere the file is damaged.
    loop {
        let word = words
            .word()
            .ok_or_else(|| TextError::UnexpectedEnd { place: words.place(), expected: "`endfacet`" })?;
        if word.eq_ignore_ascii_case(b"endfacet") {
            return Ok(corners);
        }
        if words.line() != line {
            return Err(words.wrong(word, "`endfacet`").into());
        }
    }
}

fn keyword(words: &mut Words<'_>, word: &str, expected: &'static str) -> Result<(), TextError> {
    match words.word() {
        Some(found) if found.eq_ignore_ascii_case(word.as_bytes()) => Ok(()),
        Some(found) => Err(words.wrong(found, expected)),
        None => Err(TextError::UnexpectedEnd { place: words.place(), expected }),
    }
}

/// Writes a mesh as binary STL; coordinates as they are, rounded to `f32`.
///
/// # Errors
/// Errors of the writer; `InvalidInput` for more than 2^32 - 1 triangles.
///
/// ```
/// use grainpath_core::{DVec3, TriMesh};
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriMesh { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] };
/// let mut bytes = Vec::new();
/// grainpath_io::write_stl(&mesh, &mut bytes)?;
/// assert_eq!(bytes.len(), 84 + 4 * 50);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_stl(mesh: &TriMesh, out: &mut dyn Write) -> io::Result<()> {
    let n =
        u32::try_from(mesh.triangles.len()).map_err(|_| io::Error::other("too many triangles for STL"))?;
    // The header must not begin with `solid`, or readers would take the file for ASCII.
    let mut header = [0u8; 80];
    header[..9].copy_from_slice(b"grainpath");
    out.write_all(&header)?;
    out.write_all(&n.to_le_bytes())?;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
        // A degenerate triangle gets the normal 0 0 0, which readers recompute.
        let normal = mesh.normal(*t);
        // The last two bytes, the attribute count, stay 0.
        let mut facet = [0u8; FACET];
        let numbers = [normal, a, b, c].into_iter().flat_map(|v| v.to_array());
        for (bytes, number) in facet.chunks_exact_mut(4).zip(numbers) {
            bytes.copy_from_slice(&(number as f32).to_le_bytes());
        }
        out.write_all(&facet)?;
    }
    Ok(())
}
