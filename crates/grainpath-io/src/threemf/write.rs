//! Writes 3MF: bodies as objects of one build, in mm.

use std::io::{self, Cursor, Write};

use grainpath_core::TriMesh;
use zip::write::{SimpleFileOptions, ZipWriter};

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// Writes bodies as a 3MF package in mm, one object for each body. The same bodies give the same bytes.
///
/// # Errors
/// Errors of the writer and of the packer.
///
/// ```
/// use grainpath_core::{DVec3, TriMesh};
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriMesh { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] };
/// let mut bytes = Vec::new();
/// grainpath_io::write_3mf(&[&mesh], &mut bytes)?;
/// let file = grainpath_io::parse_mesh(&bytes, None).expect("our own package");
/// assert_eq!(file.unit.map(|u| u.name()), Some("mm"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_3mf(bodies: &[&TriMesh], out: &mut dyn Write) -> io::Result<()> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // No date is stored: it would differ from run to run.
    let options = SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
        .large_file(true);
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(name, options).map_err(io::Error::other)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options).map_err(io::Error::other)?;
    model(bodies, &mut io::BufWriter::new(&mut zip))?;
    let bytes = zip.finish().map_err(io::Error::other)?.into_inner();
    out.write_all(&bytes)
}

fn model(bodies: &[&TriMesh], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources>"#
    )?;
    // An object without triangles would break core 4.1.4, so empty bodies are left out of both lists.
    let shown = || bodies.iter().enumerate().filter(|(_, b)| !b.triangles.is_empty());
    for (i, body) in shown() {
        writeln!(out, r#"<object id="{}" type="model"><mesh><vertices>"#, i + 1)?;
        for p in &body.vertices {
            // Five decimals are 10 nm, finer than every printer and the grid of sections.
            writeln!(out, r#"<vertex x="{:.5}" y="{:.5}" z="{:.5}"/>"#, p.x, p.y, p.z)?;
        }
        writeln!(out, "</vertices><triangles>")?;
        for [a, b, c] in &body.triangles {
            writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
        }
        writeln!(out, "</triangles></mesh></object>")?;
    }
    writeln!(out, "</resources>\n<build>")?;
    for (i, _) in shown() {
        writeln!(out, r#"<item objectid="{}"/>"#, i + 1)?;
    }
    writeln!(out, "</build>\n</model>")?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec3;

    #[test]
    fn what_is_written_is_read_again() {
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 12.5).to_vec();
        let mesh = TriMesh { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] };
        let mut bytes = Vec::new();
        write_3mf(&[&mesh, &TriMesh::default(), &mesh], &mut bytes).expect("memory takes it");
        let file = crate::parse_mesh(&bytes, Some("a.3mf")).expect("a package");
        assert_eq!(file.bodies.len(), 2);
        assert!((file.bodies[0].mesh.signed_volume() - mesh.signed_volume()).abs() < 1e-6);
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
        let mut again = Vec::new();
        write_3mf(&[&mesh, &TriMesh::default(), &mesh], &mut again).expect("memory takes it");
        assert_eq!(bytes, again);
    }
}
