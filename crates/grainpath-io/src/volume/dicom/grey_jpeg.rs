//! JPEG of one component: coded by cosines with 8 or 12 bits, or lossless with 2 to 16 bits.
//!
//! Method: Huffman codes are looked up in a table of all words of 16 bits. A block of cosines is dequantised and transformed
//! by two products with an 8 x 8 matrix, in f32. A lossless pixel is the prediction from its neighbours to the left, above
//! and above left, plus a difference modulo 2^16.
//!
//! Source: ITU-T T.81 (1992), annexes A.3.3 (cosines), B (segments), C and F.2 (Huffman codes), H (lossless). DICOM's
//! transfer syntaxes 1.2.840.10008.1.2.4.50, .51, .57 and .70 use these processes.
//!
//! Cost: one pass; memory for the pixels, which is reserved row by row, so that a header without data takes none. Limits:
//! sequential scans of one component with Huffman codes. Progressive and arithmetic coding are recognised and refused; DICOM
//! retired both. A scan that ends early is damaged, and no row of it is used.
//!
//! Measured against the crate jpeg-decoder 0.3.2, which dicom-pixeldata 0.10 uses: it does not decode cosines of 12 bits
//! (.51), applies the point transform to lossless values before it predicts from them, and ignores restarts with the default
//! predictor. zune-jpeg 0.5, which reads photographs in grainpath, has only 8 bits and no lossless process.

use grainpath_core::math;

use super::jpeg_stream::{self, Segments, marker, word};
use super::unpacked::{Fault, Frame};

type Bits<'a> = jpeg_stream::Bits<'a, false>;

/// Position in the block, counted row after row, of each coefficient in the order in which a stream stores them. Source:
/// T.81, figure A.6.
const ZIGZAG: [u8; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7,
    14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39,
    46, 53, 60, 61, 54, 47, 55, 62, 63,
];

/// Huffman codes as a segment states them: the number of codes of each length, and their symbols.
#[derive(Clone, Copy)]
struct Codes<'a> {
    n_of_length: &'a [u8],
    symbols: &'a [u8],
}

/// For each word of 16 bits, the length and symbol of the code at its beginning. Length 0: no code.
struct Lookup(Vec<(u8, u8)>);

impl Codes<'_> {
    fn lookup(self) -> Result<Lookup, Fault> {
        let mut table = vec![(0, 0); 1 << 16];
        let mut symbols = self.symbols.iter();
        // Codes are numbered in order: all of one length first, then those of the next length (T.81, annex C).
        let mut at = 0;
        for (length, n) in (1u8..).zip(self.n_of_length) {
            let span = 1usize << (16 - length);
            for symbol in symbols.by_ref().take((*n).into()) {
                let words = table.get_mut(at..at + span).ok_or("more codes than their lengths allow")?;
                words.fill((length, *symbol));
                at += span;
            }
        }
        Ok(Lookup(table))
    }
}

impl Lookup {
    fn symbol(&self, bits: &mut Bits<'_>) -> Result<u8, Fault> {
        let (length, symbol) = self.0[bits.peek_16()];
        if length == 0 {
            return Err("a code that stands for nothing".into());
        }
        bits.skip(length.into());
        Ok(symbol)
    }
}

/// The number of `n` bits, which has a sign: the lower half of the words is negative (T.81, F.2.2.1).
fn signed(bits: &mut Bits<'_>, n: u32) -> i32 {
    if n == 0 {
        return 0;
    }
    let v = bits.take(n) as i32;
    if v >> (n - 1) == 0 { v - (1 << n) + 1 } else { v }
}

/// What the segments before the scan state.
#[derive(Default)]
struct Tables<'a> {
    /// Four tables for coefficients without direction (DC), four for those with one (AC). A lossless scan uses the first
    /// four.
    codes: [[Option<Codes<'a>>; 4]; 2],
    quantisation: [Option<[f32; 64]>; 4],
    restart: usize,
}

impl<'a> Tables<'a> {
    fn add_codes(&mut self, mut content: &'a [u8]) -> Result<(), Fault> {
        while let Some((&place, rest)) = content.split_first() {
            let short = || Fault::from("a table of codes cut short");
            let n_of_length = rest.get(..16).ok_or_else(short)?;
            let n = n_of_length.iter().map(|n| usize::from(*n)).sum::<usize>();
            let symbols = rest.get(16..16 + n).ok_or_else(short)?;
            let kind = self.codes.get_mut(usize::from(place >> 4)).ok_or("an unknown table of codes")?;
            let slot = kind.get_mut(usize::from(place & 15)).ok_or("an unknown table of codes")?;
            *slot = Some(Codes { n_of_length, symbols });
            content = &rest[16 + n..];
        }
        Ok(())
    }

    fn add_quantisation(&mut self, mut content: &[u8]) -> Result<(), Fault> {
        while let Some((&place, rest)) = content.split_first() {
            // Steps have 8 or 16 bits.
            let width = if place >> 4 == 0 { 1 } else { 2 };
            let steps = rest.get(..64 * width).ok_or("a table of quantisation cut short")?;
            let mut table = [0.0; 64];
            for (step, k) in steps.chunks_exact(width).zip(ZIGZAG) {
                table[usize::from(k)] = step.iter().fold(0.0, |v, b| 256.0 * v + f32::from(*b));
            }
            let slot = self.quantisation.get_mut(usize::from(place & 15));
            *slot.ok_or("an unknown table of quantisation")? = Some(table);
            content = &rest[64 * width..];
        }
        Ok(())
    }

    fn lookup(&self, kind: usize, number: u8) -> Result<Lookup, Fault> {
        let codes = self.codes[kind].get(usize::from(number)).copied().flatten();
        codes.ok_or("no table of codes for the scan")?.lookup()
    }
}

/// Unpacks a frame.
pub(super) fn unpack(bytes: &[u8], size: [usize; 2]) -> Result<Frame, Fault> {
    let mut segments = Segments::new(bytes)?;
    let mut tables = Tables::default();
    let mut header = None;
    loop {
        let (marker, content) = segments.segment()?;
        match marker {
            0xc4 => tables.add_codes(content)?,
            0xdb => tables.add_quantisation(content)?,
            marker::RESTART_INTERVAL => {
                tables.restart = word(content, 0).ok_or("a restart interval cut short")?.into();
            }
            // Baseline and extended cosines, and lossless (T.81, table B.1).
            0xc0 | 0xc1 | 0xc3 => header = Some((jpeg_stream::header(content, size)?, marker == 0xc3)),
            0xc2 | 0xc6 | 0xca | 0xce => return Err(Fault::Unsupported("progressive coding".to_owned())),
            0xc9..=0xcf => return Err(Fault::Unsupported("arithmetic coding".to_owned())),
            0xc5..=0xc7 => return Err(Fault::Unsupported("hierarchical coding".to_owned())),
            marker::SCAN => {
                let (header, lossless) = header.ok_or("pixels without a header")?;
                let &[1, _, numbers, predictor, _, point] = content else {
                    return Err("a scan that is not of one component".into());
                };
                let mut bits = Bits::new(segments.rest());
                let patterns = if lossless {
                    let codes = tables.lookup(0, numbers >> 4)?;
                    let scan = Lossless { bits: header.bits, predictor, point: u32::from(point & 15), codes };
                    scan.rows(&mut bits, size, tables.restart)?
                } else {
                    let table = tables.quantisation.get(usize::from(header.table)).copied().flatten();
                    let scan = Cosines {
                        bits: header.bits,
                        quantisation: table.ok_or("no table of quantisation for the scan")?,
                        constant: tables.lookup(0, numbers >> 4)?,
                        varying: tables.lookup(1, numbers & 15)?,
                        basis: basis(),
                    };
                    scan.rows(&mut bits, size, tables.restart)?
                };
                return Ok(Frame { patterns, bits: header.bits, signed: false });
            }
            // Comments and applications' own data.
            _ => {}
        }
    }
}

const ENDS_EARLY: &str = "they end before the last pixel";

/// A lossless scan.
struct Lossless {
    bits: u32,
    predictor: u8,
    point: u32,
    codes: Lookup,
}

impl Lossless {
    fn rows(&self, bits: &mut Bits<'_>, [w, h]: [usize; 2], restart: usize) -> Result<Vec<u32>, Fault> {
        if !(2..=16).contains(&self.bits) || self.point >= self.bits || !(1..=7).contains(&self.predictor) {
            return Err("a lossless scan with impossible numbers".into());
        }
        // Restarts come at ends of rows (T.81, H.1.1).
        if !restart.is_multiple_of(w) {
            return Err("a restart within a row".into());
        }
        let rows_to_restart = if restart == 0 { h } else { restart / w };
        let mut patterns = Vec::new();
        let (mut above, mut row) = (vec![0u16; w], vec![0u16; w]);
        for y in 0..h {
            let first = y % rows_to_restart == 0;
            if first && y > 0 {
                bits.restart(y / rows_to_restart - 1)?;
            }
            for x in 0..w {
                // The first row knows only its left, the first column only what is above (H.1.2.1).
                let prediction = match (first, x) {
                    (true, 0) => 1 << (self.bits - self.point - 1),
                    (true, _) => i32::from(row[x - 1]),
                    (false, 0) => i32::from(above[0]),
                    _ => self.predict(i32::from(row[x - 1]), i32::from(above[x]), i32::from(above[x - 1])),
                };
                let difference = match self.codes.symbol(bits)? {
                    // A difference of 16 bits has no further bits (H.1.2.2).
                    16 => 1 << 15,
                    n @ 0..16 => signed(bits, n.into()),
                    _ => return Err("a difference of more than 16 bits".into()),
                };
                row[x] = (prediction + difference) as u16;
            }
            if bits.ended() {
                return Err(ENDS_EARLY.into());
            }
            patterns.extend(row.iter().map(|v| u32::from(*v) << self.point));
            std::mem::swap(&mut above, &mut row);
        }
        Ok(patterns)
    }

    /// The prediction from left, above and above left. Source: T.81, table H.1.
    fn predict(&self, a: i32, b: i32, c: i32) -> i32 {
        match self.predictor {
            1 => a,
            2 => b,
            3 => c,
            4 => a + b - c,
            5 => a + ((b - c) >> 1),
            6 => b + ((a - c) >> 1),
            _ => (a + b) >> 1,
        }
    }
}

/// A scan of cosines.
struct Cosines {
    bits: u32,
    quantisation: [f32; 64],
    constant: Lookup,
    varying: Lookup,
    basis: [[f32; 8]; 8],
}

/// `basis[x][u]` is the value of cosine u at position x, both from 0 to 7. Source: T.81, A.3.3.
fn basis() -> [[f32; 8]; 8] {
    let at = |x: usize, u: usize| {
        let angle = (2 * x + 1) as f64 * u as f64 * std::f64::consts::PI / 16.0;
        let scale = if u == 0 { std::f64::consts::FRAC_1_SQRT_2 } else { 1.0 };
        (0.5 * scale * math::cos(angle)) as f32
    };
    std::array::from_fn(|x| std::array::from_fn(|u| at(x, u)))
}

impl Cosines {
    fn rows(&self, bits: &mut Bits<'_>, [w, h]: [usize; 2], restart: usize) -> Result<Vec<u32>, Fault> {
        if self.bits != 8 && self.bits != 12 {
            return Err("cosines with neither 8 nor 12 bits".into());
        }
        let (columns, rows) = (w.div_ceil(8), h.div_ceil(8));
        let mut patterns = Vec::new();
        let mut band = vec![0u32; 64 * columns];
        let mut mean = 0;
        for row in 0..rows {
            for column in 0..columns {
                let block = row * columns + column;
                if restart > 0 && block > 0 && block.is_multiple_of(restart) {
                    bits.restart(block / restart - 1)?;
                    mean = 0;
                }
                self.block(bits, &mut mean, &mut band[8 * column..], 8 * columns)?;
            }
            if bits.ended() {
                return Err(ENDS_EARLY.into());
            }
            for line in band.chunks_exact(8 * columns).take(h - 8 * row) {
                patterns.extend(&line[..w]);
            }
        }
        Ok(patterns)
    }

    /// Reads a block into rows that lie `stride` apart. `mean` is the constant coefficient of the block before.
    fn block(
        &self,
        bits: &mut Bits<'_>,
        mean: &mut i32,
        out: &mut [u32],
        stride: usize,
    ) -> Result<(), Fault> {
        let mut block = [0f32; 64];
        let n = self.constant.symbol(bits)?;
        // 12 bits need differences of up to 15 (T.81, table F.6).
        if n > 15 {
            return Err("a coefficient of more than 15 bits".into());
        }
        *mean = mean.wrapping_add(signed(bits, n.into()));
        block[0] = *mean as f32 * self.quantisation[0];
        let mut k = 1;
        while k < 64 {
            let symbol = self.varying.symbol(bits)?;
            let (n_zeros, n) = (usize::from(symbol >> 4), u32::from(symbol & 15));
            if n == 0 && n_zeros < 15 {
                break;
            }
            // A run of 15 zeros followed by a value of no bits means 16 zero coefficients.
            k += n_zeros;
            let place = usize::from(*ZIGZAG.get(k).ok_or("more than 64 coefficients to a block")?);
            block[place] = signed(bits, n) as f32 * self.quantisation[place];
            k += 1;
        }
        let middle = (1u32 << (self.bits - 1)) as f32;
        let most = ((1u32 << self.bits) - 1) as f32;
        // Rows are transformed first, then columns. Most rows are all zero and stay zero, so they are skipped.
        let mut half = [[0f32; 8]; 8];
        for (half, row) in half.iter_mut().zip(block.as_chunks::<8>().0) {
            if row.iter().any(|v| *v != 0.0) {
                *half = std::array::from_fn(|x| (0..8).map(|u| self.basis[x][u] * row[u]).sum());
            }
        }
        for (line, basis) in out.chunks_mut(stride).take(8).zip(&self.basis) {
            for (x, v) in line.iter_mut().take(8).enumerate() {
                let sum: f32 = (0..8).map(|u| basis[u] * half[u][x]).sum();
                *v = (sum + middle + 0.5).clamp(0.0, most) as u32;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lossless picture of one pixel a row, 16 bits, whose differences have the code 0 for none and 1 for 2^15.
    fn stream(rows: u8, restart: u8, data: &[u8]) -> Vec<u8> {
        let mut out = vec![0xff, marker::START, 0xff, 0xc3, 0, 11, 16, 0, rows, 0, 1, 1, 1, 0x11, 0];
        out.extend([0xff, marker::RESTART_INTERVAL, 0, 4, 0, restart]);
        out.extend([0xff, 0xc4, 0, 21, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 16]);
        out.extend([0xff, marker::SCAN, 0, 8, 1, 1, 0, 1, 0, 0]);
        out.extend(data);
        out
    }

    #[test]
    fn differences_of_all_16_bits_and_restarts() {
        let grey = |rows: u8, restart, data: &[u8]| {
            unpack(&stream(rows, restart, data), [1, rows.into()]).map(|frame| frame.patterns)
        };
        // From the middle of the range 2^15 leads to 0, and back.
        assert_eq!(grey(4, 0, &[0b0101_1111]), Ok(vec![1 << 15, 0, 0, 1 << 15]));
        // Every two rows the range's middle is the first prediction again.
        let twice = [0b1011_1111, 0xff, marker::RESTART, 0b0111_1111];
        assert_eq!(grey(4, 2, &twice), Ok(vec![0, 0, 1 << 15, 0]));
        let wrong = [0b1011_1111, 0xff, marker::RESTART + 1, 0b0111_1111];
        assert_eq!(grey(4, 2, &wrong), Err("no restart marker where one is due".into()));
        assert_eq!(grey(9, 0, &[0b0101_1111]), Err(ENDS_EARLY.into()));
    }

    #[test]
    fn more_codes_than_words_are_refused() {
        let codes = Codes { n_of_length: &[3; 16], symbols: &[0; 48] };
        assert!(codes.lookup().is_err());
    }
}
