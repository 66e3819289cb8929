//! JPEG-LS of one component, lossless and near-lossless, 2 to 16 bits.
//!
//! Method (LOCO-I): a pixel is predicted from its neighbours to the left and above, by the median of three guesses. The
//! steps between neighbours choose one of 365 contexts. Each context keeps the mean error, which corrects the prediction,
//! and the mean size of errors, which sets the parameter of a Golomb code. Where all neighbours are equal, the length of a
//! run is coded instead.
//!
//! Source: ITU-T T.87 (1998), annex A; the comments name the variables of the standard in brackets. Weinberger, Seroussi &
//! Sapiro (2000), The LOCO-I lossless image compression algorithm. DICOM's transfer syntaxes 1.2.840.10008.1.2.4.80 and .81
//! use this format.
//!
//! Cost: one pass over the pixels, a few operations each; memory for the pixels. Limits: one component, no palette and no
//! restarts, which DICOM's encoders do not write. No crate in pure Rust decodes it; the C++ library CharLS, which
//! dicom-pixeldata 0.10 binds, needs a C++ compiler.

use super::jpeg_stream::{self, Segments, marker, word};
use super::unpacked::{Fault, Frame};

type Bits<'a> = jpeg_stream::Bits<'a, true>;

/// Run lengths are counted in steps of 2 to these exponents (J). Source: T.87, A.2.1.
const RUN_EXPONENTS: [u32; 32] =
    [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Numbers that a segment may state; 0 stands for the value that the standard computes.
#[derive(Debug, Clone, Copy, Default)]
struct Preset {
    greatest: i32,
    thresholds: [i32; 3],
    reset: i32,
}

/// Unpacks a frame.
pub(super) fn unpack(bytes: &[u8], size: [usize; 2]) -> Result<Frame, Fault> {
    let mut segments = Segments::new(bytes)?;
    let mut preset = Preset::default();
    let mut header = None;
    loop {
        let (marker, content) = segments.segment()?;
        match marker {
            0xf7 => header = Some(jpeg_stream::header(content, size)?),
            // Presets of the coder (T.87, C.2.4.1): kind 1 states numbers; 2 and 3 a palette, 4 a larger size.
            0xf8 => match content {
                [1, numbers @ ..] => {
                    let number = |k: usize| word(numbers, 2 * k).map(i32::from).ok_or("a preset cut short");
                    preset = Preset {
                        greatest: number(0)?,
                        thresholds: [number(1)?, number(2)?, number(3)?],
                        reset: number(4)?,
                    };
                }
                _ => return Err(Fault::Unsupported("a palette".to_owned())),
            },
            marker::RESTART_INTERVAL if content.iter().any(|b| *b != 0) => {
                return Err(Fault::Unsupported("restarts".to_owned()));
            }
            marker::SCAN => {
                let header = header.ok_or("pixels without a header")?;
                let &[1, _, palette, near, _, point] = content else {
                    return Err("a scan that is not of one component".into());
                };
                if palette != 0 || point & 15 != 0 {
                    return Err(Fault::Unsupported("a palette or a point transform".to_owned()));
                }
                let mut coder = Coder::new(header.bits, near.into(), preset)?;
                let patterns = coder.rows(&mut Bits::new(segments.rest()), size)?;
                return Ok(Frame { patterns, bits: header.bits, signed: false });
            }
            0xc0..=0xcf => return Err("they are JPEG and not JPEG-LS".into()),
            _ => {}
        }
    }
}

/// Statistics of the pixels coded in one context.
#[derive(Debug, Clone, Copy)]
struct Context {
    /// Sum of the errors' sizes (A).
    sizes: i64,
    /// Sum of the errors (B); for runs, the number of negative ones (Nn).
    errors: i64,
    /// Correction of the prediction (C).
    correction: i32,
    /// Number of pixels (N).
    n: i64,
}

impl Context {
    /// The parameter of the Golomb code for errors whose sizes sum up to `sizes` (k).
    fn golomb(&self, sizes: i64) -> u32 {
        let mut k = 0;
        // k is chosen so that 2^k is about the mean error size, so contexts with small errors get short codes.
        while self.n << k < sizes {
            k += 1;
        }
        k
    }

    /// Halves the sums from time to time, so that the latest pixels count most, and counts a pixel.
    fn count(&mut self, reset: i64) {
        // Halving keeps the sums small and lets a context follow a picture that changes.
        if self.n == reset {
            self.sizes >>= 1;
            self.errors >>= 1;
            self.n >>= 1;
        }
        self.n += 1;
    }
}

struct Coder {
    /// Largest value (MAXVAL).
    greatest: i32,
    /// Largest difference between a pixel and what is decoded (NEAR).
    near: i32,
    thresholds: [i32; 3],
    reset: i64,
    /// Number of different errors (RANGE), and the bits of one (qbpp).
    range: i32,
    error_bits: u32,
    /// Most bits of a code (LIMIT).
    limit: u32,
    contexts: [Context; 365],
    /// The two contexts for the pixel after a run: the pixel above differs from the run, or equals it.
    after_run: [Context; 2],
    run: usize,
}

impl Coder {
    fn new(bits: u32, near: i32, preset: Preset) -> Result<Self, Fault> {
        if !(2..=16).contains(&bits) {
            return Err("values with neither 2 to 16 bits".into());
        }
        let all = (1i32 << bits) - 1;
        let greatest = if preset.greatest == 0 { all } else { preset.greatest };
        if greatest > all || near > 255.min(greatest / 2) {
            return Err("a preset that its bits cannot hold".into());
        }
        let step = 2 * near + 1;
        let range = (greatest + 2 * near) / step + 1;
        let error_bits = bits_for(range);
        let value_bits = bits_for(greatest + 1).max(2);
        let usual = thresholds(greatest, near);
        let thresholds: [i32; 3] =
            std::array::from_fn(|k| if preset.thresholds[k] == 0 { usual[k] } else { preset.thresholds[k] });
        let ordered = thresholds.windows(2).all(|t| t[0] <= t[1]);
        if !ordered || thresholds[0] <= near || thresholds[2] > greatest {
            return Err("thresholds out of order".into());
        }
        // Source: T.87, A.2.1 and table C.3: the first error size of a context depends on the range; statistics are halved
        // after 64 pixels.
        let reset = if preset.reset == 0 { 64 } else { preset.reset };
        if reset < 3 {
            return Err("a preset that counts fewer than 3 pixels".into());
        }
        let context =
            Context { sizes: i64::from(((range + 32) / 64).max(2)), errors: 0, correction: 0, n: 1 };
        Ok(Self {
            greatest,
            near,
            thresholds,
            reset: reset.into(),
            range,
            error_bits,
            limit: 2 * (value_bits + value_bits.max(8)),
            contexts: [context; 365],
            after_run: [context; 2],
            run: 0,
        })
    }

    fn rows(&mut self, bits: &mut Bits<'_>, [w, h]: [usize; 2]) -> Result<Vec<u32>, Fault> {
        let mut patterns = Vec::new();
        // A row and one pixel on either side of it: before the first row all are 0 (A.2.1).
        let (mut above, mut row) = (vec![0i32; w + 2], vec![0i32; w + 2]);
        for _ in 0..h {
            // Source: T.87, A.2.1: the pixel left of a row is the first of the row above, that right of it its last.
            row[0] = above[1];
            above[w + 1] = above[w];
            let mut x = 1;
            while x <= w {
                let (a, b, c, d) = (row[x - 1], above[x], above[x - 1], above[x + 1]);
                // Left, above, above left and above right; the steps between them choose the context.
                let steps = [d - b, b - c, c - a];
                // A flat neighbourhood begins a run of equal pixels.
                if steps.iter().all(|s| s.abs() <= self.near) {
                    let n = self.run_length(bits, w + 1 - x)?;
                    row[x..x + n].fill(a);
                    x += n;
                    if x <= w {
                        row[x] = self.end_of_run(bits, a, above[x])?;
                        x += 1;
                    }
                } else {
                    row[x] = self.pixel(bits, [a, b, c], steps)?;
                    x += 1;
                }
            }
            // Bits past the end read as 0, so this check must report a file that is cut short; the picture would be wrong.
            if bits.ended() {
                return Err("they end before the last pixel".into());
            }
            patterns.extend(row[1..=w].iter().map(|v| *v as u32));
            std::mem::swap(&mut above, &mut row);
        }
        Ok(patterns)
    }

    /// Decodes a pixel whose neighbours differ; they are left, above and above left. Source: T.87, A.3 to A.6.
    fn pixel(&mut self, bits: &mut Bits<'_>, [a, b, c]: [i32; 3], steps: [i32; 3]) -> Result<i32, Fault> {
        let number = steps.iter().fold(0, |sum, step| 9 * sum + self.region(*step));
        // Three regions of nine give 729 numbers from -364 to 364.
        // A context and its mirror image are one, told apart by the sign.
        let (context, sign) = (&mut self.contexts[number.unsigned_abs() as usize], number.signum());
        // Source: T.87, A.4.1: the prediction follows an edge and continues a slope.
        let median = if c >= a.max(b) {
            a.min(b)
        } else if c <= a.min(b) {
            a.max(b)
        } else {
            a + b - c
        };
        let prediction = (median + sign * context.correction).clamp(0, self.greatest);
        let k = context.golomb(context.sizes);
        let mapped = code(bits, k, self.limit, self.error_bits, self.range)?;
        // Codes alternate between positive and negative errors. A context whose errors are mostly negative starts with the
        // negative one (A.5.2). Near-lossless coding never exchanges them, since its errors are counted in steps.
        let exchanged = self.near == 0 && k == 0 && 2 * context.errors <= -context.n;
        let odd = mapped & 1 == 1;
        let error = if odd == exchanged { mapped >> 1 } else { -(mapped >> 1) - 1 };
        context.errors += i64::from(error) * i64::from(2 * self.near + 1);
        context.sizes += i64::from(error.abs());
        context.count(self.reset);
        // The mean error is kept between -1 and 0 by moving the correction (A.6.2).
        if context.errors <= -context.n {
            context.errors = (context.errors + context.n).max(1 - context.n);
            context.correction = (context.correction - 1).max(-128);
        } else if context.errors > 0 {
            context.errors = (context.errors - context.n).min(0);
            context.correction = (context.correction + 1).min(127);
        }
        Ok(self.value(prediction, sign * error))
    }

    /// Decodes the length of a run; `left` pixels of the row remain. Source: T.87, A.7.1.
    fn run_length(&mut self, bits: &mut Bits<'_>, left: usize) -> Result<usize, Fault> {
        let mut n = 0;
        while bits.take(1) == 1 {
            let whole = 1 << RUN_EXPONENTS[self.run];
            if n + whole > left {
                return Ok(left);
            }
            n += whole;
            self.run = (self.run + 1).min(31);
            if n == left {
                return Ok(left);
            }
        }
        n += bits.take(RUN_EXPONENTS[self.run]) as usize;
        if n >= left {
            return Err("a run past the end of its row".into());
        }
        Ok(n)
    }

    /// Decodes the pixel that ends a run; the run has value `a`, the pixel above has value `b`. Source: T.87, A.7.2.
    fn end_of_run(&mut self, bits: &mut Bits<'_>, a: i32, b: i32) -> Result<i32, Fault> {
        let alike = (a - b).abs() <= self.near;
        let context = &mut self.after_run[usize::from(alike)];
        let sizes = if alike { context.sizes + (context.n >> 1) } else { context.sizes };
        let k = context.golomb(sizes);
        let limit = self.limit - RUN_EXPONENTS[self.run] - 1;
        let mapped = code(bits, k, limit, self.error_bits, self.range)?;
        let shifted = mapped + i32::from(alike);
        let odd = shifted & 1 == 1;
        let size = (shifted + 1) >> 1;
        let negative = odd == (k != 0 || 2 * context.errors >= context.n);
        let error = if negative { -size } else { size };
        context.errors += i64::from(error < 0);
        context.sizes += i64::from((mapped + 1 - i32::from(alike)) >> 1);
        context.count(self.reset);
        self.run = self.run.saturating_sub(1);
        let (prediction, sign) = if alike { (a, 1) } else { (b, if a > b { -1 } else { 1 }) };
        Ok(self.value(prediction, sign * error))
    }

    /// The region number, from -4 to 4, of a step between neighbours. Source: T.87, A.3.3.
    fn region(&self, step: i32) -> i32 {
        let size = step.abs();
        let region = match size {
            _ if size <= self.near => 0,
            _ if size < self.thresholds[0] => 1,
            _ if size < self.thresholds[1] => 2,
            _ if size < self.thresholds[2] => 3,
            _ => 4,
        };
        region * step.signum()
    }

    /// The value of a pixel from its prediction and error; the sum wraps around at the range. Source: T.87, A.4.4 and A.5.
    fn value(&self, prediction: i32, error: i32) -> i32 {
        let step = 2 * self.near + 1;
        let value = prediction + error * step;
        let value = if value < -self.near {
            value + self.range * step
        } else if value > self.greatest + self.near {
            value - self.range * step
        } else {
            value
        };
        value.clamp(0, self.greatest)
    }
}

/// A Golomb code of parameter `k`: the quotient as zeros and a 1, then `k` bits. If the quotient does not fit in `limit`
/// bits, an escape is coded and the number itself follows. Source: T.87, A.5.3.
fn code(bits: &mut Bits<'_>, k: u32, limit: u32, error_bits: u32, range: i32) -> Result<i32, Fault> {
    let most = limit - error_bits - 1;
    let n = bits.zeros(most).ok_or("a code longer than any")?;
    let value = if n < most { n << k | bits.take(k) } else { bits.take(error_bits) + 1 };
    // No error is larger than half the range, and each has two codes at most. This keeps sums small.
    i32::try_from(value)
        .ok()
        .filter(|v| *v <= 2 * range + 1)
        .ok_or_else(|| "an error larger than its range".into())
}

/// The number of bits that can hold every number below `n`.
fn bits_for(n: i32) -> u32 {
    32 - ((n - 1) as u32).leading_zeros()
}

/// The default thresholds between the regions of steps. Source: T.87, C.2.4.1.1.
fn thresholds(greatest: i32, near: i32) -> [i32; 3] {
    let within = |v: i32, low: i32| if v > greatest || v < low { low } else { v };
    let [t1, t2, t3] = [(3, 2, 3), (7, 3, 5), (21, 4, 7)].map(|(usual, least, n)| {
        if greatest >= 128 {
            let factor = (greatest.min(4095) + 128) / 256;
            factor * (usual - least) + least + n * near
        } else {
            let factor = 256 / (greatest + 1);
            i32::max(least, usual / factor + n * near)
        }
    });
    let t1 = within(t1, near + 1);
    let t2 = within(t2, t1);
    [t1, t2, within(t3, t2)]
}
