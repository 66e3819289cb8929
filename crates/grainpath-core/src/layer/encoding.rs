//! Encodes layer stacks as bytes, for files and other machines: compact, exact, and the same bytes for the same stack.
//!
//! Format, version 1. Numbers called *varint* are LEB128: seven bits a byte, lowest first, the
//! highest bit set on all bytes but the last; signed numbers are first zigzag-coded (0, -1, 1, -2,
//! ... become 0, 1, 2, 3, ...). An *f64* is eight bytes, little-endian.
//!
//! ```text
//! stack    "GPLS"  version: u8 = 1  n_layers: varint  layer*
//! layer    z_top_mm: f64  height_mm: f64  n_polygons: varint  polygon*
//! polygon  n_contours: varint (>= 1; the outline, then the holes)  contour*
//! contour  n_points: varint  mode: u8  point*
//!          mode 0: x: f64  y: f64, as they are
//!          mode 1: x and y as steps of GRID_MM (1e-4 mm), signed varints, each less that of the point before
//! ```
//!
//! Sections that result from a polygon boolean lie on the grid, so nearly every contour has mode 1, in
//! which a vertex takes 4 to 6 bytes instead of 16. Mode 1 is used only if the steps times [`GRID_MM`]
//! give exactly the original bits. A decoded stack therefore equals the encoded one in every bit, and a
//! plan made from it has the same G-code.
//!
//! Time and memory for reading are proportional to the number of bytes (at most 48 bytes of memory per
//! byte), even if the counts in them are false.

use glam::DVec2;

use super::{Layer, LayerStack};
use crate::poly::{Contour, GRID_MM, Polygon, Region};

const MAGIC: &[u8; 4] = b"GPLS";

/// The version that is written, and the only one that is read.
const VERSION: u8 = 1;

const RAW: u8 = 0;
const ON_GRID: u8 = 1;

/// The reason why bytes are not a layer stack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LayerStackError {
    /// The bytes do not begin with "GPLS".
    #[error("not a layer stack: the bytes do not begin with \"GPLS\"")]
    NotAStack,
    /// The version is not supported.
    #[error("layer stack of version {version}; this program reads version 1")]
    Version {
        /// The version found.
        version: u8,
    },
    /// The bytes end too early.
    #[error("the layer stack ends at byte {offset}, where {wanted} should be")]
    Truncated {
        /// Number of bytes read.
        offset: usize,
        /// The value that should follow.
        wanted: &'static str,
    },
    /// A value that is not valid in a stack.
    #[error("the layer stack has {found} at byte {offset}")]
    Invalid {
        /// Position of the first byte after the value.
        offset: usize,
        /// Description of the value.
        found: &'static str,
    },
}

impl LayerStack {
    /// Encodes the stack; see the [module](self) for the format.
    ///
    /// ```
    /// use grainpath_core::{DVec2, Layer, LayerStack, Region};
    ///
    /// let square = Region::rectangle(DVec2::ZERO, DVec2::splat(10.0));
    /// let layers = (1..=3).map(|i| Layer::new(0.2 * f64::from(i), 0.2, square.clone()).unwrap());
    /// let stack = LayerStack::new(layers.collect()).unwrap();
    /// let bytes = stack.to_bytes();
    /// assert_eq!(LayerStack::from_bytes(&bytes), Ok(stack));
    /// ```
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = MAGIC.to_vec();
        out.push(VERSION);
        put_varint(&mut out, self.layers.len() as u64);
        for layer in &self.layers {
            out.extend(layer.z_top_mm.to_le_bytes());
            out.extend(layer.height_mm.to_le_bytes());
            put_varint(&mut out, layer.region.polygons.len() as u64);
            for polygon in &layer.region.polygons {
                put_varint(&mut out, 1 + polygon.holes.len() as u64);
                polygon.contours().for_each(|c| put_contour(&mut out, c));
            }
        }
        out
    }

    /// Decodes a stack.
    ///
    /// # Errors
    /// [`LayerStackError`] for bytes of another kind or version, for bytes that end too early or go on after the stack,
    /// and for invalid values, such as heights that do not rise or coordinates that are not finite.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LayerStackError> {
        let mut reader = Reader { bytes, offset: 0 };
        if bytes.get(..4) != Some(MAGIC) {
            return Err(LayerStackError::NotAStack);
        }
        reader.offset = 4;
        let version = reader.byte("the version")?;
        if version != VERSION {
            return Err(LayerStackError::Version { version });
        }
        let n_layers = reader.varint("the number of layers")?;
        let mut layers: Vec<Layer> = Vec::new();
        for _ in 0..n_layers {
            let layer = reader.layer()?;
            // `LayerStack::new` would check the same, but without the position in the bytes.
            if layers.last().is_some_and(|below| below.z_top_mm >= layer.z_top_mm) {
                return Err(reader.invalid("a layer that does not end above the one below it"));
            }
            layers.push(layer);
        }
        if reader.offset != bytes.len() {
            return Err(reader.invalid("further bytes after the last layer"));
        }
        Ok(Self { layers })
    }
}

fn put_varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

const fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

const fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

/// The number of grid steps that, times [`GRID_MM`], gives exactly the bits of `v`; `None` if there is none.
fn steps(v: f64) -> Option<i64> {
    let steps = (v / GRID_MM).round();
    // Below this bound steps are exact in an `f64`, and the difference of two of them fits an
    // `i64`.
    let small = steps.abs() < (1u64 << 53) as f64;
    // The bits are compared, because -0.0 equals 0.0 as a number. A value off the grid by a single rounding
    // error is refused too.
    (small && (steps as i64 as f64 * GRID_MM).to_bits() == v.to_bits()).then_some(steps as i64)
}

fn put_contour(out: &mut Vec<u8>, contour: &[DVec2]) {
    put_varint(out, contour.len() as u64);
    // If one coordinate is off the grid, the whole contour is stored raw; otherwise each point would need
    // its own mode.
    let on_grid: Option<Vec<[i64; 2]>> = contour.iter().map(|p| Some([steps(p.x)?, steps(p.y)?])).collect();
    match on_grid {
        Some(points) => {
            out.push(ON_GRID);
            let mut before = [0; 2];
            for p in points {
                (0..2).for_each(|k| put_varint(out, zigzag(p[k] - before[k])));
                before = p;
            }
        }
        None => {
            out.push(RAW);
            contour.iter().flat_map(|p| p.to_array()).for_each(|v| out.extend(v.to_le_bytes()));
        }
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl Reader<'_> {
    fn invalid(&self, found: &'static str) -> LayerStackError {
        LayerStackError::Invalid { offset: self.offset, found }
    }

    fn byte(&mut self, wanted: &'static str) -> Result<u8, LayerStackError> {
        let end = LayerStackError::Truncated { offset: self.offset, wanted };
        let byte = *self.bytes.get(self.offset).ok_or(end)?;
        self.offset += 1;
        Ok(byte)
    }

    fn varint(&mut self, wanted: &'static str) -> Result<u64, LayerStackError> {
        let mut value = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte(wanted)?;
            let bits = u64::from(byte & 0x7f);
            // Only the lowest bit of the tenth byte belongs to a 64-bit number.
            if shift == 63 && bits > 1 {
                break;
            }
            value |= bits << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.invalid("a number of more than 64 bits"))
    }

    fn float(&mut self, wanted: &'static str) -> Result<f64, LayerStackError> {
        let end = LayerStackError::Truncated { offset: self.offset, wanted };
        let bytes = self.bytes[self.offset..].first_chunk().ok_or(end)?;
        self.offset += 8;
        Ok(f64::from_le_bytes(*bytes))
    }

    fn layer(&mut self) -> Result<Layer, LayerStackError> {
        let z_top_mm = self.float("the height of a layer's top")?;
        let height_mm = self.float("the height of a layer")?;
        // No memory is reserved by the counts in the file: malicious bytes may state any count, but each
        // polygon needs at least one byte.
        let n_polygons = self.varint("a number of polygons")?;
        let mut polygons = Vec::new();
        for _ in 0..n_polygons {
            let n_contours = self.varint("a number of contours")?;
            if n_contours == 0 {
                return Err(self.invalid("a polygon without an outline"));
            }
            let outer = self.contour()?;
            let mut holes = Vec::new();
            for _ in 1..n_contours {
                holes.push(self.contour()?);
            }
            polygons.push(Polygon { outer, holes });
        }
        Layer::new(z_top_mm, height_mm, Region { polygons })
            .ok_or_else(|| self.invalid("a layer of no positive height, or below the plate"))
    }

    fn contour(&mut self) -> Result<Contour, LayerStackError> {
        const POINT: &str = "a point";
        let n_points = self.varint("a number of points")?;
        let mode = self.byte("the mode of a contour")?;
        let mut contour = Contour::new();
        let mut at = [0i64; 2];
        for _ in 0..n_points {
            let p = match mode {
                RAW => DVec2::new(self.float(POINT)?, self.float(POINT)?),
                ON_GRID => {
                    for v in &mut at {
                        let step = unzigzag(self.varint(POINT)?);
                        // Only malicious bytes overflow here. Wrapping would give a wrong but valid
                        // point.
                        *v = v.checked_add(step).ok_or_else(|| self.invalid("a point beyond all bounds"))?;
                    }
                    DVec2::new(at[0] as f64 * GRID_MM, at[1] as f64 * GRID_MM)
                }
                _ => return Err(self.invalid("an unknown mode of a contour")),
            };
            if !p.is_finite() {
                return Err(self.invalid("a coordinate that is not finite"));
            }
            contour.push(p);
        }
        Ok(contour)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Coordinates on the grid, off it, and the awkward ones: zeros of both signs, huge and tiny numbers.
    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            8 => (-3_000_000i64..3_000_000).prop_map(|k| k as f64 * GRID_MM),
            2 => -300.0f64..300.0,
            1 => prop::sample::select(vec![0.0, -0.0, 1e300, -1e300, f64::MIN_POSITIVE, 1e12, 0.3]),
        ]
    }

    fn contour() -> impl Strategy<Value = Contour> {
        prop::collection::vec((coordinate(), coordinate()), 0..9)
            .prop_map(|v| v.into_iter().map(DVec2::from).collect())
    }

    fn stack() -> impl Strategy<Value = LayerStack> {
        let polygon = (contour(), prop::collection::vec(contour(), 0..3))
            .prop_map(|(outer, holes)| Polygon { outer, holes });
        let region = prop::collection::vec(polygon, 0..4).prop_map(|polygons| Region { polygons });
        prop::collection::vec((0.01f64..0.5, region), 0..6).prop_map(|layers| {
            let mut z = 0.0;
            let layer = |(height, region)| {
                z += height;
                Layer::new(z, height, region).expect("a sound layer")
            };
            LayerStack::new(layers.into_iter().map(layer).collect()).expect("rising layers")
        })
    }

    fn bits(stack: &LayerStack) -> Vec<u64> {
        let points = |r: &Region| -> Vec<u64> {
            r.contours().flatten().flat_map(|p| [p.x.to_bits(), p.y.to_bits()]).collect()
        };
        let layer =
            |l: &Layer| [vec![l.z_top_mm.to_bits(), l.height_mm.to_bits()], points(&l.region)].concat();
        stack.layers.iter().flat_map(layer).collect()
    }

    proptest! {
        /// What comes back equals what went in, bit for bit.
        #[test]
        fn a_round_trip_keeps_every_bit(stack in stack()) {
            let bytes = stack.to_bytes();
            let back = LayerStack::from_bytes(&bytes).expect("our own bytes");
            prop_assert_eq!(bits(&back), bits(&stack));
            prop_assert_eq!(&back, &stack);
            prop_assert_eq!(back.to_bytes(), bytes);
        }

        /// No cut and no changed byte panics or takes more memory than the bytes allow; every cut
        /// is an error.
        #[test]
        fn damaged_bytes_are_refused_or_give_a_sound_stack(
            stack in stack(), cut in 0.0f64..1.0, at in 0.0f64..1.0, byte in any::<u8>(),
        ) {
            let bytes = stack.to_bytes();
            let cut = (cut * bytes.len() as f64) as usize;
            prop_assert!(LayerStack::from_bytes(&bytes[..cut]).is_err());
            let mut changed = bytes.clone();
            changed[(at * bytes.len() as f64) as usize] = byte;
            if let Ok(read) = LayerStack::from_bytes(&changed) {
                prop_assert!(read.layers.windows(2).all(|w| w[0].z_top_mm < w[1].z_top_mm));
            }
        }

        /// Arbitrary bytes after a good header.
        #[test]
        fn hostile_bytes_never_panic(tail in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut bytes = MAGIC.to_vec();
            bytes.push(VERSION);
            bytes.extend(tail);
            if let Ok(read) = LayerStack::from_bytes(&bytes) {
                prop_assert!(read.layers.windows(2).all(|w| w[0].z_top_mm < w[1].z_top_mm));
                prop_assert!(read.layers.len() <= bytes.len());
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        use LayerStackError as E;
        let with = |tail: &[u8]| LayerStack::from_bytes(&[b"GPLS\x01".as_slice(), tail].concat());
        assert_eq!(LayerStack::from_bytes(b"solid"), Err(E::NotAStack));
        assert_eq!(LayerStack::from_bytes(b"GPLS\x07"), Err(E::Version { version: 7 }));
        assert_eq!(with(&[]), Err(E::Truncated { offset: 5, wanted: "the number of layers" }));
        // A promise of 2^63 layers costs nothing.
        let many = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f];
        assert_eq!(with(&many), Err(E::Truncated { offset: 14, wanted: "the height of a layer's top" }));
        assert!(matches!(with(&[0xff; 12]), Err(E::Invalid { .. })));
        assert!(matches!(with(&[0, 0]), Err(E::Invalid { found: "further bytes after the last layer", .. })));
        assert_eq!(with(&[0]), Ok(LayerStack::default()));
    }

    /// On the grid a vertex takes a few bytes.
    #[test]
    fn sections_on_the_grid_are_compact() {
        let n = 400;
        let circle: Contour = (0..n)
            .map(|i| 20.0 * crate::math::direction(std::f64::consts::TAU * f64::from(i) / f64::from(n)))
            .collect();
        let round = Region::from_contours([&circle], crate::poly::FillRule::NonZero);
        let vertices = round.n_vertices();
        let stack = LayerStack::new(vec![Layer::new(0.2, 0.2, round).expect("a layer")]).expect("a stack");
        let bytes = stack.to_bytes();
        assert!(bytes.len() < 5 * vertices, "{} bytes for {vertices} vertices", bytes.len());
    }
}
