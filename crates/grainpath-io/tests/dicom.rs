//! DICOM files whose pixels are packed, against what the codecs' own libraries unpack. `dicom/make.py` wrote the files.

use std::io::Cursor;

use grainpath_core::slices::SliceSource;
use grainpath_io::volume::{Files, ReadSeek, VolumeError, VolumeProblem, open_volume};

fn bytes_of(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/dicom/{name}.dcm", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

fn open(name: &str, bytes: Vec<u8>) -> Result<Box<dyn SliceSource>, VolumeError> {
    let open =
        move |_: &str| -> std::io::Result<Box<dyn ReadSeek>> { Ok(Box::new(Cursor::new(bytes.clone()))) };
    open_volume(Files::single(name, open), None)
}

/// The voxels, or the first error.
fn voxels(name: &str, bytes: Vec<u8>) -> Result<Vec<f32>, VolumeError> {
    let mut source = open(name, bytes)?;
    let (mut all, mut slice) = (Vec::new(), Vec::new());
    loop {
        match source.next_slice(&mut slice) {
            Ok(true) => all.extend(&slice),
            Ok(false) => return Ok(all),
            Err(e) => return Err(e.downcast_ref::<VolumeError>().expect("an error of the reader").clone()),
        }
    }
}

/// Files and what they must give.
const LOSSLESS: [(&str, &str); 8] = [
    ("i12", "i12-truth"),
    ("i16-rle", "i16-truth"),
    ("u12-lossless", "u12-truth"),
    ("i16-lossless", "i16-truth"),
    ("u12-ls", "u12-truth"),
    ("u16-ls", "u16-truth"),
    ("i16-ls", "i16-truth"),
    ("u8-truth", "u8-truth"),
];
/// Near-lossless JPEG-LS: what is decoded is exact, too.
const NEAR: [&str; 2] = ["u8-near", "u12-near"];
const JPEG: [&str; 2] = ["u8-jpeg", "u12-jpeg"];
#[cfg(feature = "jpeg2000")]
const JPEG_2000: [(&str, &str); 2] = [("u12-2000", "u12-truth"), ("i16-2000", "i16-truth")];

/// Largest difference of two volumes of 7 x 13 x 21 voxels.
fn difference(name: &str, truth: &str) -> f32 {
    let [found, expected] = [name, truth].map(|n| voxels(n, bytes_of(n)).expect("a volume"));
    assert_eq!((found.len(), expected.len()), (7 * 13 * 21, 7 * 13 * 21), "{name}");
    assert!(expected.iter().any(|v| *v != expected[0]), "{truth} is empty");
    found.iter().zip(&expected).fold(0.0, |most, (f, e)| (f - e).abs().max(most))
}

#[test]
fn lossless_packing_gives_every_voxel() {
    for (name, truth) in LOSSLESS {
        assert_eq!(difference(name, truth), 0.0, "{name}");
    }
    for name in NEAR {
        assert_eq!(difference(name, &format!("{name}-truth")), 0.0, "{name}");
    }
}

#[test]
fn cosines_are_those_of_libjpeg_within_rounding() {
    for name in JPEG {
        let off = difference(name, &format!("{name}-truth"));
        println!("{name}: {off}");
        assert!(off <= 1.0, "{name}: {off}");
    }
}

#[cfg(feature = "jpeg2000")]
#[test]
fn jpeg_2000_gives_every_voxel() {
    for (name, truth) in JPEG_2000 {
        assert_eq!(difference(name, truth), 0.0, "{name}");
    }
    assert!(difference("u16-2000", "u16-2000-truth") <= 1.0);
}

#[cfg(not(feature = "jpeg2000"))]
#[test]
fn without_jpeg_2000_the_error_says_which_build_has_it() {
    let error = voxels("u12-2000", bytes_of("u12-2000")).expect_err("not built in").to_string();
    assert!(error.contains("JPEG 2000") && error.contains("--features jpeg2000"), "{error}");
}

#[cfg(not(feature = "zarr"))]
#[test]
fn without_zarr_the_error_says_which_build_has_it() {
    let open = |_: &str| -> std::io::Result<Box<dyn ReadSeek>> { Err(std::io::ErrorKind::NotFound.into()) };
    let files = Files::folder("scan", vec!["scan/zarr.json".to_owned()], open);
    let error = open_volume(files, None).err().expect("not built in").to_string();
    assert!(error.contains("Zarr") && error.contains("--features zarr"), "{error}");
}

#[test]
fn dense_material_is_bright_whichever_way_grey_counts() {
    let [turned, plain] = ["inverted", "u8-truth"].map(|n| voxels(n, bytes_of(n)).expect("a volume"));
    assert!(turned.iter().zip(&plain).all(|(t, p)| *t == -p));
}

/// Every packed file.
fn packed() -> Vec<&'static str> {
    let lossless =
        LOSSLESS.iter().map(|(name, _)| *name).filter(|n| n.contains('-') && !n.ends_with("truth"));
    let all = lossless.chain(NEAR).chain(JPEG);
    #[cfg(feature = "jpeg2000")]
    let all = all.chain(JPEG_2000.iter().map(|(name, _)| *name)).chain(["u16-2000"]);
    all.collect()
}

#[test]
fn files_cut_short_are_refused() {
    for name in packed() {
        let whole = bytes_of(name);
        // The frames fill the end of the file; the last bytes are the end of the sequence.
        for cut in [20, 40, 100, 300, 700] {
            let error = voxels(name, whole[..whole.len() - cut].to_vec()).expect_err(name).to_string();
            assert!(error.contains(name) && !error.contains('\n'), "{error}");
        }
    }
}

#[test]
fn pictures_of_another_size_are_refused() {
    for name in packed().into_iter().filter(|n| !n.ends_with("rle")) {
        let mut bytes = bytes_of(name);
        // Columns (0028,0011).
        let at = bytes.windows(6).position(|w| w == [0x28, 0, 0x11, 0, b'U', b'S']).expect("columns") + 8;
        bytes[at] = 22;
        let error = voxels(name, bytes).expect_err(name);
        assert!(error.to_string().contains("21 x 13"), "{error}");
        assert!(matches!(error.problem, VolumeProblem::Damaged { .. }), "{error}");
    }
}

#[test]
fn any_bytes_in_place_of_the_pixels_are_survived() {
    let mut state = 1u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for name in packed() {
        let whole = bytes_of(name);
        let (mut n_refused, mut n_read) = (0, 0);
        for round in 0..300 {
            let mut bytes = whole.clone();
            // The header has less than 600 bytes; every other file keeps it.
            let first = if round % 2 == 0 { 600 } else { 0 };
            for _ in 0..=random(4) {
                let at = first + random(bytes.len() - first);
                bytes[at] = random(256) as u8;
            }
            match voxels(name, bytes) {
                Ok(all) => {
                    n_read += 1;
                    assert!(all.iter().all(|v| v.is_finite()));
                }
                Err(e) => {
                    n_refused += 1;
                    assert!(!e.to_string().contains('\n'), "{e}");
                }
            }
        }
        println!("{name}: {n_read} read, {n_refused} refused");
        assert!(n_refused > 0, "{name}: damage goes unseen");
    }
}
