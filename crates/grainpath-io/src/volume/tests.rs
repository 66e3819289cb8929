use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use super::*;

mod orientation;
#[cfg(feature = "zarr")]
mod zarr;

/// Files in memory.
fn files(all: &[(&str, Vec<u8>)], folder: bool) -> Files {
    let map: BTreeMap<String, Vec<u8>> = all.iter().map(|(n, b)| ((*n).to_owned(), b.clone())).collect();
    let names: Vec<String> = map.keys().cloned().collect();
    let open = move |name: &str| -> std::io::Result<Box<dyn ReadSeek>> {
        let bytes = map.get(name).cloned().ok_or(std::io::ErrorKind::NotFound)?;
        Ok(Box::new(Cursor::new(bytes)))
    };
    if folder { Files::folder("scan", names, open) } else { Files::single(all[0].0, open) }
}

fn single(all: &[(&str, Vec<u8>)]) -> Result<Box<dyn SliceSource>, VolumeError> {
    open_volume(files(all, false), None)
}

fn folder(all: &[(&str, Vec<u8>)]) -> Result<Box<dyn SliceSource>, VolumeError> {
    open_volume(files(all, true), None)
}

fn all(source: &mut dyn SliceSource) -> Result<Vec<Vec<f32>>, SliceError> {
    let (mut out, mut slice) = (Vec::new(), Vec::new());
    while source.next_slice(&mut slice)? {
        out.push(slice.clone());
    }
    Ok(out)
}

fn says(result: Result<Box<dyn SliceSource>, VolumeError>, file: &str, what: &str) {
    let error = match result {
        Err(e) => e,
        Ok(mut source) => {
            let error = all(&mut *source).expect_err("should fail");
            error.downcast_ref::<VolumeError>().expect("an error of the reader").clone()
        }
    };
    let named = error.file.contains(file) && error.problem.to_string().contains(what);
    assert!(named, "{error} should name {file}: {what}");
}

/// 3 x 2 x 4 voxels that tell where they are.
fn voxels() -> Vec<i16> {
    (0..24).map(|i| (i * 37 - 300) as i16).collect()
}

fn check(source: &mut dyn SliceSource) {
    let expect: Vec<Vec<f32>> =
        voxels().chunks(6).map(|c| c.iter().map(|&v| f32::from(v)).collect()).collect();
    assert_eq!(source.info().size, [3, 2, 4]);
    assert_eq!(all(source).expect("slices"), expect);
    source.restart().expect("again");
    assert!(source.skip_slice().expect("a slice"));
    let mut slice = Vec::new();
    assert!(source.next_slice(&mut slice).expect("a slice"));
    assert_eq!(slice, expect[1]);
}

fn little() -> Vec<u8> {
    voxels().iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn big() -> Vec<u8> {
    voxels().iter().flat_map(|v| v.to_be_bytes()).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    e.write_all(bytes).expect("memory");
    e.finish().expect("memory")
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut e = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    e.write_all(bytes).expect("memory");
    e.finish().expect("memory")
}

#[test]
fn nrrd_in_all_its_ways() {
    let head = |extra: &str| {
        format!("NRRD0004\n# comment: 1\ntype: short\ndimension: 3\nsizes: 3 2 4\n{extra}").into_bytes()
    };
    let spaced = "spacings: 0.1 0.2 0.5\nendian: little\nencoding: raw\n\n";
    let mut source = single(&[("a.nrrd", [head(spaced), little()].concat())]).expect("raw");
    assert_eq!(source.info().spacing_mm, [Some(0.1), Some(0.2), Some(0.5)]);
    check(&mut *source);
    let turned = "space directions: (0.4,0.3,0) (-0.12,0.16,0) (0,0,2)\nendian: big\nencoding: gzip\n\n";
    let mut source = single(&[("a.nrrd", [head(turned), gzip(&big())].concat())]).expect("gzip");
    assert_eq!(source.info().spacing_mm, [Some(0.5), Some(0.2), Some(2.0)]);
    check(&mut *source);
    let detached = head("encoding: raw\nendian: little\nbyte skip: 3\ndata file: b.raw\n");
    let mut source =
        single(&[("d/a.nhdr", detached), ("d/b.raw", [vec![9; 3], little()].concat())]).expect("two");
    check(&mut *source);
    says(single(&[("a.nrrd", head("encoding: hex\n\n"))]), "a.nrrd", "encoding");
    says(single(&[("a.nrrd", [head("encoding: raw\n\n"), vec![0; 47]].concat())]), "a.nrrd", "need 48 bytes");
    says(
        single(&[("a.nrrd", [head("encoding: gzip\n\n"), gzip(&[0; 40])].concat())]),
        "a.nrrd",
        "ends in slice 4",
    );
    says(single(&[("a.nrrd", b"NRRD0004\ntype: short\nsizes: 3 2\n\n".to_vec())]), "a.nrrd", "2 axes");
    says(single(&[("a.nhdr", head("encoding: raw\ndata file: gone.raw\n"))]), "gone.raw", "not found");
}

#[test]
fn metaimage_beside_and_in_one() {
    let head = |extra: &str| {
        let start = "ObjectType = Image\nNDims = 3\nDimSize = 3 2 4\nElementType = MET_SHORT\n";
        format!("{start}ElementSpacing = 0.5 0.5 1.5\n{extra}").into_bytes()
    };
    let mut source =
        single(&[("d/a.mhd", head("ElementDataFile = a.raw\n")), ("d/a.raw", little())]).expect("raw");
    assert_eq!(source.info().spacing_mm, [Some(0.5), Some(0.5), Some(1.5)]);
    check(&mut *source);
    let packed = head("CompressedData = True\nBinaryDataByteOrderMSB = True\nElementDataFile = a.zraw\n");
    check(&mut *single(&[("a.mhd", packed), ("a.zraw", zlib(&big()))]).expect("zlib"));
    let local = [head("ElementDataFile = LOCAL\n"), little()].concat();
    check(&mut *single(&[("a.mha", local)]).expect("one file"));
    // Words are told by their first letter, and of two keys for the byte order one counts.
    let packed = head("CompressedData = 1\nElementByteOrderMSB = T\nElementDataFile = a.zraw\n");
    check(&mut *single(&[("a.mhd", packed), ("a.zraw", zlib(&big()))]).expect("zlib"));
    for (binary, element, voxels) in [("False", "True", little()), ("1", "F", big())] {
        let order = format!("BinaryDataByteOrderMSB = {binary}\nElementByteOrderMSB = {element}\n");
        let both = [head(&format!("{order}ElementDataFile = LOCAL\n")), voxels].concat();
        check(&mut *single(&[("a.mha", both)]).expect("one file"));
    }
    says(single(&[("a.mhd", head("ElementDataFile = LIST\n"))]), "a.mhd", "several files");
    says(single(&[("a.mhd", b"NDims = 3\nDimSize = 3 2 4\n".to_vec())]), "a.mhd", "no ElementType");
    // Voxels as text, a size that is no number and an offset that is none are refused and not guessed.
    let text = [head("BinaryData = False\nElementDataFile = LOCAL\n"), b"0 1 2".to_vec()].concat();
    says(single(&[("a.mha", text)]), "a.mha", "voxels written as text");
    says(single(&[("a.mhd", b"NDims = 3\nDimSize = 3 x 2 4\n".to_vec())]), "a.mhd", "DimSize");
    let offset = head("HeaderSize = some\nElementDataFile = a.raw\n");
    says(single(&[("a.mhd", offset), ("a.raw", little())]), "a.mhd", "HeaderSize");
}

fn nifti() -> Vec<u8> {
    let mut h = vec![0u8; 352];
    h[..4].copy_from_slice(&348i32.to_le_bytes());
    for (i, v) in [3i16, 3, 2, 4, 1, 1, 1, 1].iter().enumerate() {
        h[40 + 2 * i..42 + 2 * i].copy_from_slice(&v.to_le_bytes());
    }
    h[70..72].copy_from_slice(&4i16.to_le_bytes());
    for (i, v) in [1f32, 250.0, 500.0, 1000.0].iter().enumerate() {
        h[76 + 4 * i..80 + 4 * i].copy_from_slice(&v.to_le_bytes());
    }
    h[108..112].copy_from_slice(&352f32.to_le_bytes());
    h[112..116].copy_from_slice(&1f32.to_le_bytes());
    h[123] = 3;
    h[344..348].copy_from_slice(b"n+1\0");
    [h, little()].concat()
}

#[test]
fn nifti_plain_and_gzipped() {
    let mut source = single(&[("a.nii", nifti())]).expect("plain");
    assert_eq!(source.info().spacing_mm, [Some(0.25), Some(0.5), Some(1.0)]);
    check(&mut *source);
    check(&mut *single(&[("a.nii.gz", gzip(&nifti()))]).expect("gzip"));
    let mut scaled = nifti();
    scaled[112..116].copy_from_slice(&2f32.to_le_bytes());
    scaled[116..120].copy_from_slice(&5f32.to_le_bytes());
    let slices = all(&mut *single(&[("a.nii", scaled)]).expect("scaled")).expect("slices");
    assert_eq!(slices[0][1], f32::from(voxels()[1]) * 2.0 + 5.0);
    // A pair of files, whichever of them is named.
    let mut header = nifti()[..348].to_vec();
    header[345] = b'i';
    header[108..112].fill(0);
    let (header, voxels) = (("d/a.hdr", header), ("d/a.img", little()));
    check(&mut *single(&[header.clone(), voxels.clone()]).expect("the header"));
    check(&mut *single(&[voxels.clone(), header.clone()]).expect("the voxels"));
    says(single(std::slice::from_ref(&header)), "a.img", "not found");
    says(single(&[voxels]), "a.img", "not a volume");
    says(single(&[("a.hdr.gz", gzip(&header.1))]), "a.hdr.gz", "unpack both files");
    let mut wrong = nifti();
    wrong[70] = 128;
    says(single(&[("a.nii", wrong)]), "a.nii", "datatype = 128");
    // No voxels along an axis, in a file that states its place twice.
    let mut empty = nifti();
    empty[42] = 0;
    (empty[252], empty[254]) = (1, 1);
    for row in 0..3 {
        empty[280 + 20 * row..284 + 20 * row].copy_from_slice(&0.5f32.to_le_bytes());
    }
    says(single(&[("a.nii", empty)]), "a.nii", "0 x 2 x 4");
    says(single(&[("a.nii.gz", gzip(b"hello"))]), "a.nii.gz", "not NIfTI");
    says(single(&[("a.nii", nifti()[..380].to_vec())]), "a.nii", "need 48 bytes");
}

#[test]
fn raw_data_with_a_header_given() {
    let header = RawHeader { size: [3, 2, 4], sample: SampleType::I16, big_endian: true, offset_bytes: 5 };
    let file = [vec![7; 5], big()].concat();
    check(&mut *open_volume(files(&[("a.raw", file)], false), Some(&header)).expect("raw"));
    let huge = RawHeader { size: [60_000, 60_000, 1], ..header };
    let error = open_volume(files(&[("a.raw", vec![0; 9])], false), Some(&huge)).err().expect("too large");
    assert!(matches!(error.problem, VolumeProblem::TooLarge { .. }), "{error}");
}

#[test]
fn a_written_stack_is_read_back_with_its_voxels() {
    let mut bytes = Vec::new();
    let slice = |k: usize| (0..20).map(|i| (i * 100 + k * 3000) as u16).collect::<Vec<u16>>();
    write_tiff_stack([5, 4, 3], [0.4, 0.2, 1.25], slice, &mut bytes).expect("memory");
    let mut source = single(&[("a.tif", bytes.clone())]).expect("a stack");
    assert_eq!((source.info().size, source.info().sample), ([5, 4, 3], SampleType::U16));
    let spacing = source.info().spacing_mm.map(|s| s.expect("stated"));
    assert!((spacing[0] - 0.4).abs() < 1e-6 && (spacing[1] - 0.2).abs() < 1e-6 && spacing[2] == 1.25);
    let slices = all(&mut *source).expect("slices");
    assert_eq!(slices[2], slice(2).iter().map(|&v| f32::from(v)).collect::<Vec<f32>>());
    source.restart().expect("again");
    assert!(source.skip_slice().expect("one") && source.skip_slice().expect("two"));
    let mut last = Vec::new();
    source.next_slice(&mut last).expect("three");
    assert_eq!(last, slices[2]);
    assert!(!source.skip_slice().expect("none"));
    says(single(&[("a.tif", bytes[..150].to_vec())]), "a.tif", "page");
}

fn bmp(width: usize, height: usize, value: u8) -> Vec<u8> {
    let row = (width * 3).next_multiple_of(4);
    let mut out = b"BM".to_vec();
    out.extend((54 + row * height).to_le_bytes()[..4].iter());
    out.extend([0; 4]);
    out.extend(54u32.to_le_bytes());
    out.extend(40u32.to_le_bytes());
    out.extend((width as u32).to_le_bytes());
    out.extend((height as u32).to_le_bytes());
    out.extend(1u16.to_le_bytes());
    out.extend(24u16.to_le_bytes());
    out.extend([0; 24]);
    out.extend(vec![value; row * height]);
    out
}

fn tiff16(value: u16) -> Vec<u8> {
    let mut out = Vec::new();
    write_tiff_stack([4, 3, 1], [1.0; 3], |_| vec![value; 12], &mut out).expect("memory");
    out
}

#[test]
fn folders_are_sorted_as_people_count_and_held_together() {
    let name = ["scan/s2.bmp", "scan/s10.bmp", "scan/s1.bmp", "scan/s3.bmp", "scan/s4.bmp"];
    let more = ["scan/s5.bmp", "scan/s6.bmp", "scan/s7.bmp", "scan/s8.bmp", "scan/s9.bmp"];
    let values = [2, 10, 1, 3, 4, 5, 6, 7, 8, 9];
    let mut series: Vec<(&str, Vec<u8>)> =
        name.iter().chain(&more).zip(values).map(|(n, v)| (*n, bmp(4, 3, v))).collect();
    series.push(("scan/notes.txt", b"hello".to_vec()));
    let mut source = folder(&series).expect("a series");
    assert_eq!(source.info().size, [4, 3, 10]);
    assert!(source.info().warnings[0].text.contains("1 files are not images"));
    let grey: Vec<f32> = all(&mut *source).expect("slices").iter().map(|s| s[0].round()).collect();
    assert_eq!(grey, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
    says(folder(&[series[0].clone(), series[1].clone(), series[2].clone()]), "s2.bmp", "from 2 to 10");
    says(
        folder(&[("a1.bmp", bmp(4, 3, 1)), ("a2.bmp", bmp(4, 4, 1))]),
        "a2.bmp",
        "4 x 4 pixels; a1.bmp has 4 x 3",
    );
    says(folder(&[("a1.bmp", bmp(4, 3, 1)), ("a2.tif", tiff16(9))]), "a2.tif", "u16 grey values");
    says(folder(&[("a1.bmp", bmp(4, 3, 1)), ("a2.bmp", b"BM".to_vec())]), "a2.bmp", "");
    let one = |name| (name, bmp(4, 3, 1));
    let stranger = folder(&["s1.bmp", "s2.bmp", "s3.bmp", "thumb.bmp"].map(one));
    says(stranger, "thumb.bmp", "does not go with s1.bmp and 2 more");
    says(folder(&["a1.bmp", "a2.bmp", "b1.bmp", "b2.bmp"].map(one)), "b1.bmp", "another series");
    assert_eq!(folder(&["low.bmp", "mid.bmp", "top.bmp"].map(one)).expect("a series").info().size[2], 3);
    says(folder(&[("notes.txt", b"hello".to_vec())]), "scan", "no DICOM, PNG");
    says(folder(&[]), "scan", "no images");
    says(single(&[("a.xyz", b"hello".to_vec())]), "a.xyz", "not a volume");
}

/// An element of a DICOM file.
fn element(tag: u32, vr: &[u8; 2], value: &[u8], implicit: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let mut value = value.to_vec();
    if value.len() % 2 == 1 {
        value.push(b' ');
    }
    out.extend(((tag >> 16) as u16).to_le_bytes());
    out.extend((tag as u16).to_le_bytes());
    if implicit {
        out.extend((value.len() as u32).to_le_bytes());
    } else if [b"OW", b"SQ"].contains(&vr) {
        out.extend(vr);
        out.extend([0; 2]);
        out.extend((value.len() as u32).to_le_bytes());
    } else {
        out.extend(vr);
        out.extend((value.len() as u16).to_le_bytes());
    }
    out.extend(value);
    out
}

/// A sequence of items, each and as a whole with its length or, if `open`, with delimiters.
fn sequence(tag: u32, items: &[Vec<u8>], open: bool) -> Vec<u8> {
    let delimiter = |tag: u32| [(tag >> 16) as u16, tag as u16].map(u16::to_le_bytes).concat();
    let ended = |value: &[u8], end: u32| {
        let length = if open { u32::MAX } else { value.len() as u32 };
        let end = if open { [delimiter(end), vec![0; 4]].concat() } else { Vec::new() };
        [&length.to_le_bytes()[..], value, &end].concat()
    };
    let items: Vec<u8> =
        items.iter().flat_map(|item| [delimiter(0xfffe_e000), ended(item, 0xfffe_e00d)].concat()).collect();
    [delimiter(tag), b"SQ\0\0".to_vec(), ended(&items, 0xfffe_e0dd)].concat()
}

/// A DICOM slice, explicit or implicit little endian.
struct Dicom {
    syntax: &'static str,
    series: &'static str,
    position: [f64; 3],
    orientation: [f64; 6],
    pixel_mm: [f64; 2],
    size: [u16; 2],
    /// Counted up from pixel to pixel where `pixels` are not given.
    value: u16,
    pixels: Option<Vec<u16>>,
    /// Slope and intercept.
    rescale: (f64, f64),
    /// Elements that are left out.
    without: &'static [u32],
    /// Further elements, explicit little endian, before the pixels.
    more: Vec<u8>,
}

impl Default for Dicom {
    fn default() -> Self {
        Self {
            syntax: "1.2.840.10008.1.2.1",
            series: "1.2.3",
            position: [-10.0, 0.0, 0.0],
            orientation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            pixel_mm: [0.7, 0.5],
            size: [3, 2],
            value: 1100,
            pixels: None,
            rescale: (2.0, -1000.0),
            without: &[],
            more: Vec::new(),
        }
    }
}

impl Dicom {
    fn bytes(&self) -> Vec<u8> {
        let mut out = vec![0u8; 128];
        out.extend(b"DICM");
        let implicit = self.syntax == "1.2.840.10008.1.2";
        let mut put = |tag: u32, vr: &[u8; 2], value: &[u8], implicit: bool| {
            if self.without.contains(&tag) {
                return;
            }
            out.extend(element(tag, vr, value, implicit));
        };
        put(0x0002_0010, b"UI", self.syntax.as_bytes(), false);
        let sequence = [&[0xfe, 0xff, 0x00, 0xe0, 4, 0, 0, 0][..], b"nest"].concat();
        put(0x0008_1140, b"SQ", &sequence, implicit);
        put(0x0020_000e, b"UI", self.series.as_bytes(), implicit);
        let list = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join("\\");
        put(0x0020_0032, b"DS", list(&self.position).as_bytes(), implicit);
        put(0x0020_0037, b"DS", list(&self.orientation).as_bytes(), implicit);
        for (tag, v) in [(0x0028_0002, 1u16), (0x0028_0010, self.size[1]), (0x0028_0011, self.size[0])] {
            put(tag, b"US", &v.to_le_bytes(), implicit);
        }
        put(0x0028_0030, b"DS", list(&self.pixel_mm).as_bytes(), implicit);
        for (tag, v) in [(0x0028_0100, 16u16), (0x0028_0101, 16), (0x0028_0103, 0)] {
            put(tag, b"US", &v.to_le_bytes(), implicit);
        }
        put(0x0028_1052, b"DS", list(&[self.rescale.1]).as_bytes(), implicit);
        put(0x0028_1053, b"DS", list(&[self.rescale.0]).as_bytes(), implicit);
        out.extend(&self.more);
        let n = usize::from(self.size[0]) * usize::from(self.size[1]);
        let counted = || (0..n).map(|i| self.value + i as u16).collect();
        let pixels = self.pixels.clone().unwrap_or_else(counted);
        let pixels: Vec<u8> = pixels.iter().flat_map(|v| v.to_le_bytes()).collect();
        if self.syntax == "1.2.840.10008.1.2.5" {
            // Two planes: the high bytes as one run, the low ones as they are.
            let high = pixels[1];
            let mut packed = vec![2u32, 64, 66];
            packed.resize(16, 0);
            let mut fragment: Vec<u8> = packed.iter().flat_map(|v| v.to_le_bytes()).collect();
            fragment.extend([(257 - n) as u8, high, (n - 1) as u8]);
            fragment.extend(pixels.iter().step_by(2));
            out.extend([0xe0, 0x7f, 0x10, 0x00, b'O', b'B', 0, 0, 0xff, 0xff, 0xff, 0xff]);
            out.extend([0xfe, 0xff, 0x00, 0xe0, 0, 0, 0, 0, 0xfe, 0xff, 0x00, 0xe0]);
            out.extend((fragment.len() as u32).to_le_bytes());
            out.extend(fragment);
        } else {
            out.extend(element(0x7fe0_0010, b"OW", &pixels, implicit));
        }
        out
    }
}

#[test]
fn dicom_series_go_by_position() {
    let slice =
        |z: f64| Dicom { position: [-10.0, 0.0, z], value: 1000 + (z * 10.0) as u16, ..Dicom::default() };
    let series = |zs: &[f64]| -> Vec<(&'static str, Vec<u8>)> {
        let names = ["c", "a", "d", "b", "e"];
        names.iter().zip(zs).map(|(n, z)| (*n, slice(*z).bytes())).collect()
    };
    let mut source = folder(&series(&[5.0, 0.0, 7.5, 2.5])).expect("a series");
    assert_eq!(source.info().spacing_mm, [Some(0.5), Some(0.7), Some(2.5)]);
    let grey: Vec<f32> = all(&mut *source).expect("slices").iter().map(|s| s[1]).collect();
    assert_eq!(grey, [1002.0, 1052.0, 1102.0, 1152.0], "slope 2, intercept -1000");
    for syntax in ["1.2.840.10008.1.2", "1.2.840.10008.1.2.5"] {
        let mut one = folder(&[("x", Dicom { syntax, ..Dicom::default() }.bytes())]).expect("one slice");
        assert_eq!(
            all(&mut *one).expect("it")[0],
            [1200.0, 1202.0, 1204.0, 1206.0, 1208.0, 1210.0],
            "{syntax}"
        );
    }
    let uneven = folder(&series(&[0.0, 1.0, 2.2, 3.0])).expect("uneven");
    assert_eq!(uneven.info().z_mm, [0.0, 1.0, 2.2, 3.0]);
    let with = |extra: Dicom| {
        let mut all = series(&[0.0, 1.0, 2.0]);
        all.push(("x", extra.bytes()));
        folder(&all)
    };
    says(folder(&series(&[0.0, 1.0, 2.0, 4.0, 5.0])), "d", "slices are missing after it (1)");
    says(with(Dicom { position: [-10.0, 0.0, 3.0], series: "9", ..Dicom::default() }), "x", "another series");
    says(with(Dicom { position: [-10.0, 0.0, 3.0], size: [2, 2], ..Dicom::default() }), "x", "2 x 2 pixels");
    says(with(Dicom { position: [-10.0, 0.0, 1.0], ..Dicom::default() }), "", "same position");
    says(with(Dicom { position: [-10.0, 1.5, 3.0], ..Dicom::default() }), "", "beside the line");
    says(with(Dicom { syntax: "1.2.840.10008.1.2.4.110", ..Dicom::default() }), "x", "JPEG XL");
    let cut = Dicom::default().bytes();
    says(folder(&[("x", cut[..cut.len() - 2].to_vec())]), "x", "cut short");
    says(folder(&[("x", cut[..200].to_vec())]), "x", "");
}

/// Frames of one file with positions of their own, stored in any order and with mirrored columns.
struct Frames {
    z_mm: Vec<f64>,
    /// Directions of frames that are turned against the others.
    turned: Option<usize>,
    open: bool,
}

impl Frames {
    fn bytes(&self) -> Vec<u8> {
        let text = |tag, value: &str| element(tag, b"DS", value.as_bytes(), false);
        let group = |tag, elements: Vec<u8>| sequence(tag, &[elements], self.open);
        let shared = [
            group(0x0028_9110, [text(0x0018_0050, "9"), text(0x0028_0030, "0.7\\0.5")].concat()),
            group(0x0020_9116, text(0x0020_0037, "-1\\0\\0\\0\\1\\0")),
            group(0x0028_9145, [text(0x0028_1052, "-1000"), text(0x0028_1053, "2")].concat()),
        ];
        let frame = |(k, z): (usize, &f64)| {
            // Groups that hold nothing of use, and one that is nested deeper, are passed over.
            let other = sequence(0x0018_9301, &[sequence(0x0008_9007, &[Vec::new()], self.open)], self.open);
            let mut all = [other, group(0x0020_9113, text(0x0020_0032, &format!("50\\0\\{z}")))].concat();
            if self.turned == Some(k) {
                all.extend(group(0x0020_9116, text(0x0020_0037, "1\\0\\0\\0\\0\\-1")));
            }
            all
        };
        let frames: Vec<Vec<u8>> = self.z_mm.iter().enumerate().map(frame).collect();
        let pixels = self.z_mm.iter().flat_map(|z| (0..6).map(move |i| 1000 + (*z * 100.0) as u16 + i));
        let more = [
            element(0x0028_0008, b"IS", self.z_mm.len().to_string().as_bytes(), false),
            sequence(0x5200_9229, &[shared.concat()], self.open),
            sequence(0x5200_9230, &frames, self.open),
        ];
        Dicom {
            without: &[0x0020_0032, 0x0020_0037, 0x0028_0030, 0x0028_1052, 0x0028_1053],
            more: more.concat(),
            pixels: Some(pixels.collect()),
            ..Dicom::default()
        }
        .bytes()
    }
}

#[test]
fn frames_of_one_file_go_by_their_own_positions() {
    for open in [false, true] {
        let of = |z_mm: &[f64]| Frames { z_mm: z_mm.to_vec(), turned: None, open };
        let bytes = of(&[2.6, 0.0, 5.2, 1.3, 3.9]).bytes();
        let mut source = single(&[("a.dcm", bytes.clone())]).expect("five frames");
        assert_eq!(source.info().size, [3, 2, 5]);
        let spacing = source.info().spacing_mm.map(|mm| mm.expect("stated"));
        assert!(spacing.iter().zip([0.5, 0.7, 1.3]).all(|(a, b)| (a - b).abs() < 1e-9), "{spacing:?}");
        assert!(source.info().warnings.is_empty(), "{:?}", source.info().warnings);
        for (k, slice) in all(&mut *source).expect("slices").iter().enumerate() {
            // Columns run to the right, against the world's x, and come reversed.
            let row = |j: usize| [2, 1, 0].map(|i| (k * 130 + 3 * j + i) as f32 * 2.0 + 1000.0);
            assert_eq!(*slice, [row(0), row(1)].concat(), "slice {k}");
        }
        // The same as single slices of a series.
        let mirrored = |z: f64| Dicom {
            position: [50.0, 0.0, z],
            orientation: [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            value: 1000 + (z * 100.0) as u16,
            ..Dicom::default()
        };
        let names = ["a", "b", "c", "d", "e"];
        let series: Vec<(&str, Vec<u8>)> =
            names.iter().enumerate().map(|(k, n)| (*n, mirrored(k as f64 * 1.3).bytes())).collect();
        let mut slices = folder(&series).expect("a series");
        source.restart().expect("again");
        assert_eq!(all(&mut *slices).expect("slices"), all(&mut *source).expect("slices"));
        assert_eq!(slices.info().world, source.info().world);
        says(
            single(&[("a.dcm", of(&[0.0, 1.0, 1.0]).bytes())]),
            "a.dcm, frame 3",
            "same position as a.dcm, frame 2",
        );
        says(
            single(&[("a.dcm", of(&[0.0, 4.0, 1.0, 2.0]).bytes())]),
            "a.dcm, frame 2",
            "missing after it (1)",
        );
        let turned = Frames { turned: Some(1), ..of(&[0.0, 1.0, 2.0]) };
        says(single(&[("a.dcm", turned.bytes())]), "a.dcm, frame 2", "is turned against a.dcm, frame 1");
        let uneven = single(&[("a.dcm", of(&[0.0, 1.0, 2.25]).bytes())]).expect("uneven");
        assert_eq!(uneven.info().z_mm, [0.0, 1.0, 2.25]);
        // Every cut and every changed byte is refused or read.
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x55;
            for damaged in [bytes[..at].to_vec(), changed] {
                if let Ok(mut source) = single(&[("a.dcm", damaged)]) {
                    let _ = all(&mut *source);
                }
            }
        }
    }
}

#[test]
fn slices_that_do_not_state_all_of_their_place_say_what_was_assumed() {
    let slice = |z: f64, without: &'static [u32], location: Option<f64>| {
        let more = location.map(|mm| element(0x0020_1041, b"DS", mm.to_string().as_bytes(), false));
        let value = 1000 + (z * 10.0) as u16;
        Dicom { position: [0.0, 0.0, z], value, without, more: more.unwrap_or_default(), ..Dicom::default() }
            .bytes()
    };
    let series = |without: &'static [u32], location: &dyn Fn(f64) -> Option<f64>| {
        let places = [("a", 2.0), ("b", 0.0), ("c", 1.0)];
        let bytes = places.map(|(name, z)| (name, slice(z, without, location(z))));
        let mut source = folder(&bytes).expect("a series");
        let grey: Vec<f32> = all(&mut *source).expect("slices").iter().map(|s| s[0]).collect();
        let told: Vec<String> = source.info().warnings.iter().map(|w| w.text.clone()).collect();
        assert_eq!(told.len(), 1, "{told:?}");
        (grey, source.info().spacing_mm[2], told[0].clone())
    };
    let rising = vec![1000.0, 1020.0, 1040.0];
    let (grey, rise, told) = series(&[0x0020_0037], &|_| None);
    assert_eq!((grey, rise), (rising.clone(), Some(1.0)));
    assert!(told.contains("no ImageOrientationPatient; they are taken for axial"), "{told}");
    let (grey, rise, told) = series(&[0x0020_0032], &|z| Some(3.0 * z - 7.0));
    assert_eq!((grey, rise), (rising, Some(3.0)));
    assert!(told.contains("state no positions") && told.contains("sorted by SliceLocation"), "{told}");
    let (grey, rise, told) = series(&[0x0020_0032], &|_| Some(5.0));
    assert_eq!((grey, rise), (vec![1040.0, 1000.0, 1020.0], None));
    assert!(told.contains("sorted by instance number"), "{told}");
}

#[test]
fn padding_of_dicom_comes_as_air_and_is_counted() {
    let tag = |tag: u32, value: u16| element(tag, b"US", &value.to_le_bytes(), false);
    let slice = |z: f64, pixels: [u16; 6], more: Vec<u8>| Dicom {
        position: [0.0, 0.0, z],
        pixels: Some(pixels.to_vec()),
        rescale: (1.0, -1024.0),
        more,
        ..Dicom::default()
    };
    let read = |all_of: &[Vec<u8>]| {
        let names = ["a", "b", "c"];
        let series: Vec<(&str, Vec<u8>)> = names.iter().copied().zip(all_of.iter().cloned()).collect();
        let mut source = folder(&series).expect("a series");
        let slices = all(&mut *source).expect("slices");
        assert!(source.info().padded);
        (slices, source.n_not_finite())
    };
    // -2000 as a word without a sign, beyond the grey values; a slice of padding alone comes first.
    let value = || tag(0x0028_0120, 63536);
    let (slices, n) = read(&[
        slice(0.0, [63536; 6], value()).bytes(),
        slice(1.0, [63536, 10, 63536, 20, 2000, 3000], value()).bytes(),
    ]);
    assert_eq!(n, 8);
    assert_eq!(slices[0], [-1014.0; 6], "air of the slice above");
    assert_eq!(slices[1], [-1014.0, -1014.0, -1014.0, -1004.0, 976.0, 1976.0]);
    // A range of values, its limit below the value or above it.
    for (value, limit) in [(5, 9), (9, 5)] {
        let more = [tag(0x0028_0120, value), tag(0x0028_0121, limit)].concat();
        let (slices, n) = read(&[slice(0.0, [4, 5, 7, 9, 10, 2000], more).bytes()]);
        assert_eq!((n, slices[0][3]), (3, -1020.0));
    }
    // 12 bits with a sign: -2000 fits and is a value. Without a sign it does not, and all 16 bits are compared, so that
    // a value with the same 12 bits stays.
    for (signed, kept) in [(1, -2000.0 - 1024.0), (0, 0x0830 as f32 - 1024.0)] {
        let more = [value(), tag(0x0028_0101, 12), tag(0x0028_0102, 11), tag(0x0028_0103, signed)];
        let (slices, n) = read(&[slice(0.0, [0xf830, 0x0830, 1, 2, 3, 4], more.concat()).bytes()]);
        assert_eq!(n, if signed == 1 { 2 } else { 1 }, "{signed}");
        assert_eq!(slices[0][1] == kept, signed == 0, "{signed}");
        assert_eq!(slices[0][0], -1023.0);
    }
}

#[test]
fn axes_of_negative_spacing_run_backwards() {
    let nrrd = |spacings: &str| {
        let head = format!(
            "NRRD0004\ntype: short\nsizes: 3 2 4\nspacings: {spacings}\nunits: \"inches\" \"inches\" \"inches\"\n"
        );
        [format!("{head}endian: little\nencoding: raw\n\n").into_bytes(), little()].concat()
    };
    let mha = |spacing: &str, more: &str| {
        let start = "NDims = 3\nDimSize = 3 2 4\nElementType = MET_SHORT\n";
        [format!("{start}ElementSpacing = {spacing}\n{more}ElementDataFile = LOCAL\n").into_bytes(), little()]
            .concat()
    };
    let read = |bytes: Vec<u8>| {
        let mut source = single(&[("a", bytes)]).expect("a volume");
        (all(&mut *source).expect("slices"), source.info().spacing_mm)
    };
    let (plain, spacing) = read(nrrd("1 2 3"));
    assert_eq!(spacing, [25.4, 50.8, 3.0 * 25.4].map(Some));
    assert_eq!(plain, read(mha("1 2 3", "")).0);
    let x_backwards: Vec<Vec<f32>> =
        plain.iter().map(|s| s.chunks(3).flat_map(|row| row.iter().rev().copied()).collect()).collect();
    let z_backwards: Vec<Vec<f32>> = plain.iter().rev().cloned().collect();
    let (turned, turned_mm) = read(nrrd("-1 2 3"));
    assert!(
        turned_mm.iter().zip(spacing).all(|(a, b)| (a.unwrap() - b.unwrap()).abs() < 1e-9),
        "{turned_mm:?}"
    );
    assert_eq!(turned, x_backwards);
    assert_eq!(read(nrrd("1 2 -3")).0, z_backwards);
    assert_eq!(read(mha("-1 2 3", "")).0, x_backwards);
    assert_eq!(read(mha("1 2 -3", "TransformMatrix = 1 0 0 0 1 0 0 0 1\n")).0, z_backwards);
    assert_eq!(read(mha("1 2 -3", "TransformMatrix = 1 0 0 0 1 0 0 0 -1\n")).0, plain);
}

#[test]
fn a_zip_archive_is_the_folder_in_it() {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for k in [2, 0, 1] {
        zip.start_file(format!("s/{k}.bmp"), zip::write::SimpleFileOptions::default()).expect("memory");
        zip.write_all(&bmp(4, 3, k * 10)).expect("memory");
    }
    let bytes = zip.finish().expect("memory").into_inner();
    let mut source = single(&[("a.zip", bytes)]).expect("an archive");
    let grey: Vec<f32> = all(&mut *source).expect("slices").iter().map(|s| s[0].round()).collect();
    assert_eq!(grey, [0.0, 10.0, 20.0]);
}

#[test]
fn any_bytes_are_survived() {
    let seeds = [
        nifti(),
        Dicom::default().bytes(),
        Dicom { syntax: "1.2.840.10008.1.2.5", ..Dicom::default() }.bytes(),
        tiff16(7),
        b"NRRD0004\ntype: short\nsizes: 3 2 4\nencoding: raw\n\n".to_vec(),
        b"NDims = 3\nDimSize = 3 2 4\nElementType = MET_SHORT\nElementDataFile = LOCAL\n".to_vec(),
    ];
    let mut state = 1u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for seed in &seeds {
        for _ in 0..300 {
            let mut bytes = seed.clone();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                bytes[at] = random(256) as u8;
            }
            bytes.truncate(bytes.len() - random(bytes.len() / 4 + 1));
            if let Ok(mut source) = single(&[("a", bytes)]) {
                let mut slice = Vec::new();
                for _ in 0..8 {
                    if !matches!(source.next_slice(&mut slice), Ok(true)) {
                        break;
                    }
                    assert_eq!(slice.len(), source.info().size[0] * source.info().size[1]);
                }
            }
        }
    }
}

#[test]
fn voxels_that_are_no_numbers_come_as_air_and_are_counted() {
    let values: Vec<f32> = (0..24).map(|i| if i % 5 == 0 { f32::NAN } else { i as f32 - 1000.0 }).collect();
    let stored: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let head = b"NRRD0004\ntype: float\nsizes: 3 2 4\nendian: little\nencoding: raw\n\n".to_vec();
    let mut source = single(&[("a.nrrd", [head.clone(), stored].concat())]).expect("a volume");
    let slices = all(&mut *source).expect("slices");
    assert_eq!(source.n_not_finite(), 5);
    assert_eq!(slices[0][0], -999.0, "the least value of the slice");
    assert_eq!(slices[3][2], -1000.0 + 18.0, "20 of 18 to 23");
    source.restart().expect("again");
    assert_eq!(source.n_not_finite(), 0);
    let none: Vec<u8> = [f32::INFINITY; 24].iter().flat_map(|v| v.to_le_bytes()).collect();
    let mut source = single(&[("a.nrrd", [head.clone(), none].concat())]).expect("a volume");
    assert_eq!(all(&mut *source).expect("slices")[2], [0.0; 6]);
    assert_eq!(source.n_not_finite(), 24);
    // Slices without a value before the first that has some: 0 would be material.
    let late: Vec<f32> = (0..24).map(|i| if i < 12 { f32::NAN } else { i as f32 - 1000.0 }).collect();
    let late: Vec<u8> = late.iter().flat_map(|v| v.to_le_bytes()).collect();
    let mut nifti = nifti()[..352].to_vec();
    nifti[70] = 16;
    let nifti = [nifti, late.clone()].concat();
    let raw = RawHeader { size: [3, 2, 4], sample: SampleType::F32, big_endian: false, offset_bytes: 0 };
    for source in [
        single(&[("a.nrrd", [head, late.clone()].concat())]),
        single(&[("a.nii", nifti.clone())]),
        single(&[("a.nii.gz", gzip(&nifti))]),
        open_volume(files(&[("a.raw", late)], false), Some(&raw)),
    ] {
        let mut source = source.expect("a volume");
        for _ in 0..2 {
            let slices = all(&mut *source).expect("slices");
            assert_eq!(slices[..2], [[-988.0; 6], [-988.0; 6]]);
            assert_eq!((slices[2][1], slices[3][5], source.n_not_finite()), (-987.0, -977.0, 12));
            source.restart().expect("again");
        }
        // The first slice may be passed over.
        assert!(source.skip_slice().expect("a slice"));
        let mut slice = Vec::new();
        assert!(source.next_slice(&mut slice).expect("a slice"));
        assert_eq!((slice[0], source.n_not_finite()), (-988.0, 6));
    }
}

#[test]
fn packed_data_that_cannot_hold_the_voxels_are_refused_at_once() {
    let head =
        |nz: usize| format!("NRRD0004\ntype: uchar\nsizes: 1000 1000 {nz}\nencoding: gzip\n\n").into_bytes();
    says(single(&[("a.nrrd", [head(100_000), gzip(&[0; 4000])].concat())]), "a.nrrd", "cannot hold as many");
    let mut bomb = nifti();
    bomb[42..48].copy_from_slice(&[0x00, 0x10, 0x00, 0x10, 0xff, 0x7f]);
    says(single(&[("a.nii.gz", gzip(&bomb))]), "a.nii.gz", "cannot hold as many");
}

#[test]
fn headers_name_files_in_their_own_folder_only() {
    let head = |name: &str| {
        format!("NRRD0004\ntype: short\nsizes: 3 2 4\nencoding: raw\ndata file: {name}\n").into_bytes()
    };
    for name in ["../b.raw", "/d/b.raw", "e/../../b.raw", "C:\\b.raw", "..\\b.raw"] {
        let held = [("d/a.nhdr", head(name)), ("b.raw", little()), ("/d/b.raw", little())];
        says(single(&held), "d/a.nhdr", "outside the folder");
    }
    let mhd = |name: &str| {
        format!("NDims = 3\nDimSize = 3 2 4\nElementType = MET_SHORT\nElementDataFile = {name}\n")
    };
    says(single(&[("d/a.mhd", mhd("../b.raw").into_bytes())]), "d/a.mhd", "outside the folder");
    // A file in the folder may be a link that leads out of it.
    for name in ["d/a.nhdr", "d/a.mhd"] {
        let header = if name.ends_with("mhd") { mhd("b.raw").into_bytes() } else { head("b.raw") };
        let held = [(name, header), ("d/b.raw", little())];
        let link = |header: &str, other: &str| header.starts_with("d/a.") && other == "d/b.raw";
        says(
            open_volume(files(&held, false).staying_within(link), None),
            name,
            "the file that b.raw links to lies outside",
        );
        let asked = files(&held, false).staying_within(link).allowing_outside(true);
        check(&mut *open_volume(asked, None).expect("asked for"));
    }
    let below = [("d/a.nhdr", head("e/b.raw")), ("d/e/b.raw", little())];
    check(&mut *single(&below).expect("a folder below"));
    let asked =
        files(&[("d/a.nhdr", head("/d/b.raw")), ("/d/b.raw", little())], false).allowing_outside(true);
    check(&mut *open_volume(asked, None).expect("asked for"));
}
