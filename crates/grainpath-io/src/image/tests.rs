#[path = "../../../../tests/data.rs"]
mod data;

use super::*;
use ::tiff::encoder::{TiffEncoder, colortype};

fn png_bytes(colour: ::png::ColorType, depth: ::png::BitDepth, w: u32, h: u32, data: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut out, w, h);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.write_header().and_then(|mut w| w.write_image_data(data)).expect("into memory");
    out
}

fn tiff_bytes(fill: impl FnOnce(&mut TiffEncoder<std::io::Cursor<&mut Vec<u8>>>)) -> Vec<u8> {
    let mut out = Vec::new();
    fill(&mut TiffEncoder::new(std::io::Cursor::new(&mut out)).expect("into memory"));
    out
}

/// A BMP of 24 bits, 2 x 2: red, green over blue, white.
fn bmp_bytes() -> Vec<u8> {
    let mut out = b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x02\0\0\0\x02\0\0\0\x01\0\x18\0".to_vec();
    out.extend([0; 24]);
    out.extend([255, 0, 0, 255, 255, 255, 0, 0]);
    out.extend([0, 0, 255, 0, 255, 0, 0, 0]);
    out
}

#[test]
fn sixteen_bits_and_eight_come_back_exactly() {
    let values: Vec<u16> = (0..12).map(|i| i * 5000 + 3).collect();
    let be: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    let image =
        decode(&png_bytes(::png::ColorType::Grayscale, ::png::BitDepth::Sixteen, 4, 3, &be)).expect("PNG");
    assert_eq!((image.width, image.height, image.channels), (4, 3, 1));
    assert_eq!(image.samples, Samples::U16(values.clone()));
    let tiff = tiff_bytes(|t| t.write_image::<colortype::Gray16>(4, 3, &values).expect("into memory"));
    assert_eq!(decode(&tiff).expect("TIFF").samples, Samples::U16(values));
    let floats: Vec<f32> = (0..12).map(|i| i as f32 * 0.1 - 0.3).collect();
    let tiff = tiff_bytes(|t| t.write_image::<colortype::Gray32Float>(4, 3, &floats).expect("into memory"));
    assert_eq!(decode(&tiff).expect("TIFF").to_grey_f32(), floats);
    let rgb: Vec<u8> = (0..36).collect();
    let tiff = tiff_bytes(|t| t.write_image::<colortype::RGB8>(4, 3, &rgb).expect("into memory"));
    let image = decode(&tiff).expect("TIFF");
    assert_eq!((image.channels, &image.samples), (3, &Samples::U8(rgb.clone())));
    let image = decode(&png_bytes(::png::ColorType::Rgb, ::png::BitDepth::Eight, 4, 3, &rgb)).expect("PNG");
    assert_eq!(image.samples, Samples::U8(rgb));
    assert!((image.to_grey_f32()[0] - (0.587 + 0.228)).abs() < 1e-5);
}

#[test]
fn a_bmp_has_its_rows_and_colours_the_right_way() {
    let image = decode(&bmp_bytes()).expect("BMP");
    assert_eq!((image.width, image.height, image.channels), (2, 2, 3));
    assert_eq!(image.samples, Samples::U8(vec![255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]));
}

#[test]
fn one_bit_masks_are_black_and_white() {
    let image =
        decode(&png_bytes(::png::ColorType::Grayscale, ::png::BitDepth::One, 9, 1, &[0b1010_0000, 0x80]));
    assert_eq!(image.expect("PNG").samples, Samples::U8(vec![255, 0, 255, 0, 0, 0, 0, 0, 255]));
}

#[test]
fn what_is_cut_short_or_too_large_is_refused() {
    let noise: Vec<u8> = (0..64u32 * 64).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let png = png_bytes(::png::ColorType::Grayscale, ::png::BitDepth::Eight, 64, 64, &noise);
    let tiff = tiff_bytes(|t| t.write_image::<colortype::Gray8>(64, 64, &noise).expect("into memory"));
    for bytes in [png.clone(), tiff, bmp_bytes()] {
        let whole = decode(&bytes).expect("a whole image");
        assert!(decode(&bytes[..bytes.len() * 2 / 3]).is_err(), "{:?}", whole.format);
        for n in 0..bytes.len().min(200) {
            assert!(decode(&bytes[..n]).is_err(), "{:?}: {n} bytes", whole.format);
        }
    }
    assert_eq!(decode_within(&png, 4095), Err(ImageError::TooLarge { width: 64, height: 64, limit: 4095 }));
    assert_eq!(decode(b""), Err(ImageError::Empty));
    assert_eq!(decode(b"solid cube"), Err(ImageError::Unknown));
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn real_photographs() {
    let entries = std::fs::read_dir(data::data("wood")).expect("a folder of photographs");
    for path in entries.filter_map(|e| Some(e.ok()?.path())) {
        let bytes = std::fs::read(&path).expect("readable");
        if sniff_image(&bytes).is_none() {
            continue;
        }
        let image = decode(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let grey = image.to_grey_f32();
        let mean = grey.iter().sum::<f32>() / grey.len() as f32;
        assert!(image.width >= 128 && (5.0..250.0).contains(&mean), "{}: {mean}", path.display());
        let cut = decode(&bytes[..bytes.len() * 2 / 3]);
        assert!(
            matches!(cut, Err(ImageError::Truncated(_) | ImageError::Malformed { .. })),
            "{}",
            path.display()
        );
        let luma = decode_luma(&bytes).expect("brightness").to_grey_f32();
        let off =
            grey.iter().zip(&luma).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / grey.len() as f64;
        assert!(off < 2.0, "{}: {off}", path.display());
        let has_exif = bytes.windows(6).any(|w| w == b"Exif\0\0");
        if image.format == ImageFormat::Jpeg && !has_exif {
            let mut turned = bytes[..2].to_vec();
            let exif = jpeg::tests::exif(6);
            turned.extend([0xff, 0xe1]);
            turned.extend((exif.len() as u16 + 2).to_be_bytes());
            turned.extend(&exif);
            turned.extend(&bytes[2..]);
            let turned = decode(&turned).expect("a turned photograph");
            assert_eq!((turned.width, turned.height), (image.height, image.width));
            // Top right of what is seen is top left of what the camera stored.
            assert_eq!(turned.to_grey_f32()[turned.width - 1], grey[0]);
        }
    }
}

#[test]
fn known_formats_that_are_not_read_are_named_with_a_way_to_convert_them() {
    for (bytes, name) in [
        (&b"\0\0\0\x18ftypheic\0\0\0\0mif1heic"[..], "HEIC"),
        (b"\0\0\0\x18ftypmif1\0\0\0\0mif1heic", "HEIC"),
        (b"\0\0\0\x1cftypavif\0\0\0\0", "AVIF"),
        (b"RIFF\x24\0\0\0WEBPVP8 ", "WebP"),
        (b"GIF89a\x01\0\x01\0", "GIF"),
        (b"\0\0\0\x0cjP  \r\n\x87\n\0\0\0\x14ftypjp2 ", "JPEG 2000"),
        (b"\xff\x0a\x00", "JPEG XL"),
    ] {
        assert_eq!(decode(bytes), Err(ImageError::OtherFormat(name)));
        let text = ImageError::OtherFormat(name).to_string();
        assert!(text.contains(name) && text.contains("save a copy as JPEG or PNG"), "{text}");
    }
    // Files of the same container that hold no picture, and sound in the same wrapper.
    for bytes in [&b"\0\0\0\x18ftypisom\0\0\0\0"[..], b"RIFF\x24\0\0\0WAVEfmt ", b"ftyp", b"RIFF"] {
        assert_eq!(decode(bytes), Err(ImageError::Unknown));
    }
}

/// The decoder panics on such palettes (png 0.18.1).
#[test]
fn palettes_without_whole_entries_are_refused() {
    for n_bytes in [0, 1, 2, 4, 5] {
        let mut out = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut out, 4, 1);
        encoder.set_color(::png::ColorType::Indexed);
        encoder.set_palette(vec![7_u8; n_bytes]);
        let written = encoder.write_header().and_then(|mut w| w.write_image_data(&[0; 4]));
        if written.is_err() {
            // The encoder refuses an empty palette.
            assert_eq!(n_bytes, 0);
            continue;
        }
        assert!(matches!(decode(&out), Err(ImageError::Malformed { .. })), "{n_bytes} bytes");
    }
}
