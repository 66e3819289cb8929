//! Writes a mesh with arrays on its nodes as VTU, as ParaView, VTK and meshio read it.
//!
//! Source: Kitware, *VTK File Formats*. Little endian, 64-bit headers, blocks of 32 KiB. The same input gives the same bytes.

use std::io::{self, Write};

use grainpath_core::DVec3;

use super::model::Element;
use grainpath_core::tensor::{principal, von_mises};

/// Bytes of a block that is compressed by itself. Source: VTK, `vtkXMLWriter::BlockSize`, 32 768 by
/// default.
const BLOCK: usize = 1 << 15;

/// Encoding of arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// Text: large, but readable in an editor.
    Ascii,
    /// Raw bytes in an appended section after the XML.
    Raw,
    /// Bytes compressed by zlib, in an appended section after the XML.
    #[default]
    Zlib,
}

/// An array on the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct PointData {
    /// Name of the array.
    pub name: String,
    /// Numbers in a tuple.
    pub components: usize,
    /// Names of the components, or none.
    pub component_names: Vec<String>,
    /// The numbers, tuple after tuple, one tuple for every node.
    pub values: Vec<f64>,
}

impl PointData {
    /// One number a node.
    pub fn scalars(name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let values = values.into_iter().collect();
        Self { name: name.into(), components: 1, component_names: Vec::new(), values }
    }

    /// A vector a node.
    pub fn vectors(name: &str, values: impl IntoIterator<Item = DVec3>) -> Self {
        let values = values.into_iter().flat_map(|v| v.to_array()).collect();
        Self { name: name.into(), components: 3, component_names: Vec::new(), values }
    }
}

/// A mesh to be written.
#[derive(Debug, Clone, Copy)]
pub struct VtuMesh<'a> {
    /// Positions, mm.
    pub nodes: &'a [DVec3],
    /// Elements over them.
    pub elements: &'a [Element],
}

/// The arrays of a stress result: displacement `U` (mm), stress `S` (MPa; components XX, YY, ZZ, XY, YZ, XZ), its von
/// Mises stress, and the three principal directions, each as long as its principal stress is in MPa.
pub fn stress_point_data(stress: &[[f64; 6]], displacement: Option<&[DVec3]>) -> Vec<PointData> {
    let mut data = Vec::new();
    if let Some(u) = displacement {
        data.push(PointData::vectors("U", u.iter().copied()));
    }
    data.push(PointData {
        name: "S".into(),
        components: 6,
        // ParaView shows these names. Without them a reader would have to guess the order of the shears.
        component_names: ["XX", "YY", "ZZ", "XY", "YZ", "XZ"].map(str::to_owned).to_vec(),
        values: stress.iter().flatten().copied().collect(),
    });
    data.push(PointData::scalars("von_Mises", stress.iter().map(von_mises)));
    let all: Vec<_> = stress.iter().map(principal).collect();
    for (i, name) in ["principal_max", "principal_mid", "principal_min"].into_iter().enumerate() {
        data.push(PointData::vectors(name, all.iter().map(|p| p.values_mpa[i] * p.axes[i])));
    }
    data
}

/// The numbers of an array to be written, by type.
enum Numbers<'a> {
    F64(Vec<f64>),
    Borrowed(&'a [f64]),
    I64(Vec<i64>),
    U8(Vec<u8>),
}

impl Numbers<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::F64(_) | Self::Borrowed(_) => "Float64",
            Self::I64(_) => "Int64",
            Self::U8(_) => "UInt8",
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::F64(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::Borrowed(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::I64(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::U8(v) => v.clone(),
        }
    }

    fn text(&self) -> String {
        match self {
            Self::F64(v) => joined(v),
            Self::Borrowed(v) => joined(v),
            Self::I64(v) => joined(v),
            Self::U8(v) => joined(v),
        }
    }
}

fn joined<T: ToString>(values: &[T]) -> String {
    values.iter().map(T::to_string).collect::<Vec<_>>().join(" ")
}

/// Writes a VTU file.
///
/// # Errors
/// Errors of the writer; [`io::ErrorKind::InvalidInput`] when an array does not fit.
///
/// ```
/// use grainpath_core::DVec3;
/// use grainpath_io::fe::{Element, ElementKind, Encoding, PointData, VtuMesh, parse_fe, write_vtu};
/// let nodes = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let elements: Vec<Element> = Element::new(ElementKind::Tet4, &[0, 1, 2, 3]).into_iter().collect();
/// let mesh = VtuMesh { nodes: &nodes, elements: &elements };
/// let mut bytes = Vec::new();
/// write_vtu(mesh, &[PointData::scalars("T", [1.0, 2.0, 3.0, 4.0])], Encoding::Zlib, &mut bytes)?;
/// assert_eq!(parse_fe(&bytes, None).expect("our own file").arrays[0].values[3], 4.0);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_vtu(
    mesh: VtuMesh<'_>,
    data: &[PointData],
    encoding: Encoding,
    out: &mut dyn Write,
) -> io::Result<()> {
    let n = mesh.nodes.len();
    // An array of the wrong length makes ParaView refuse the whole file, so nothing is written.
    if let Some(bad) = data.iter().find(|d| d.values.len() != n * d.components) {
        let text = format!("array {} has {} numbers for {n} nodes", bad.name, bad.values.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    let packed = if encoding == Encoding::Zlib { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{packed}>"
    )?;
    writeln!(out, "<UnstructuredGrid>")?;
    writeln!(out, "<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{}\">", mesh.elements.len())?;
    // Offsets of appended arrays are known only as the arrays are encoded, so their bytes are collected
    // and written last.
    let mut body = ArrayWriter { encoding, appended: Vec::new() };
    writeln!(out, "<Points>")?;
    let points: Vec<f64> = mesh.nodes.iter().flat_map(|p| p.to_array()).collect();
    body.array(out, "Points", 3, &[], &Numbers::F64(points))?;
    writeln!(out, "</Points>\n<Cells>")?;
    let nodes = mesh.elements.iter().flat_map(|e| e.nodes());
    body.array(out, "connectivity", 1, &[], &Numbers::I64(nodes.map(|&i| i64::from(i)).collect()))?;
    // VTK's offsets are the ends of the cells, not their beginnings.
    let mut end = 0i64;
    let ends = mesh.elements.iter().map(|e| {
        end += e.nodes().len() as i64;
        end
    });
    body.array(out, "offsets", 1, &[], &Numbers::I64(ends.collect()))?;
    let types = mesh.elements.iter().map(|e| e.kind.vtk_type()).collect();
    body.array(out, "types", 1, &[], &Numbers::U8(types))?;
    writeln!(out, "</Cells>\n<PointData>")?;
    for d in data {
        body.array(out, &d.name, d.components, &d.component_names, &Numbers::Borrowed(&d.values))?;
    }
    writeln!(out, "</PointData>\n</Piece>\n</UnstructuredGrid>")?;
    if encoding != Encoding::Ascii {
        // The underscore marks the first byte of appended data and belongs to none of them.
        write!(out, "<AppendedData encoding=\"raw\">\n_")?;
        out.write_all(&body.appended)?;
        writeln!(out, "\n</AppendedData>")?;
    }
    writeln!(out, "</VTKFile>")
}

struct ArrayWriter {
    encoding: Encoding,
    appended: Vec<u8>,
}

impl ArrayWriter {
    fn array(
        &mut self,
        out: &mut dyn Write,
        name: &str,
        components: usize,
        component_names: &[String],
        numbers: &Numbers<'_>,
    ) -> io::Result<()> {
        let name = quick_xml::escape::escape(name);
        write!(
            out,
            "<DataArray type=\"{}\" Name=\"{name}\" NumberOfComponents=\"{components}\"",
            numbers.kind()
        )?;
        for (i, c) in component_names.iter().enumerate() {
            write!(out, " ComponentName{i}=\"{}\"", quick_xml::escape::escape(c.as_str()))?;
        }
        match self.encoding {
            Encoding::Ascii => {
                writeln!(out, " format=\"ascii\">\n{}\n</DataArray>", numbers.text())
            }
            Encoding::Raw => {
                writeln!(out, " format=\"appended\" offset=\"{}\"/>", self.appended.len())?;
                let bytes = numbers.bytes();
                // The header of an uncompressed array is its length in bytes, here in 64 bits.
                self.appended.extend((bytes.len() as u64).to_le_bytes());
                self.appended.extend(bytes);
                Ok(())
            }
            Encoding::Zlib => {
                writeln!(out, " format=\"appended\" offset=\"{}\"/>", self.appended.len())?;
                self.pack(&numbers.bytes())
            }
        }
    }

    fn pack(&mut self, bytes: &[u8]) -> io::Result<()> {
        let blocks: Vec<&[u8]> = bytes.chunks(BLOCK).collect();
        // 0 where the last block is full, as VTK's own reader expects.
        let last = bytes.len() % BLOCK;
        for word in [blocks.len(), BLOCK, last] {
            self.appended.extend((word as u64).to_le_bytes());
        }
        // The compressed sizes precede the blocks but are known only after compression. Room for them is reserved here and
        // filled in below.
        let mut sizes = self.appended.len();
        self.appended.resize(sizes + 8 * blocks.len(), 0);
        for block in blocks {
            let before = self.appended.len();
            let mut encoder =
                // Level 5 is the default of VTK's writers. A fixed level keeps the bytes of the file
                // the same from run to run.
                flate2::write::ZlibEncoder::new(&mut self.appended, flate2::Compression::new(5));
            encoder.write_all(block)?;
            encoder.finish()?;
            let size = (self.appended.len() - before) as u64;
            self.appended[sizes..sizes + 8].copy_from_slice(&size.to_le_bytes());
            sizes += 8;
        }
        Ok(())
    }
}
