//! Writes and reads unordered paths as bytes, for windows of layers that are filled on other machines.
//!
//! Numbers are stored exactly, so that the program is the same. All numbers are little-endian:
//!
//! ```text
//! layers   "GPLP"  version: u8 = 2  n: u32  layer*
//! layer    adhesion: paths  n_supports: u32  island*  n_islands: u32  island*
//! island   n_walls: u32  (depth: u32  path)*  fills: paths
//! paths    n: u32  path*
//! path     role: u8  speed: u8  closed: u8  rank: u8  flow: f64  bottom: f64  top: f64
//!          n_widths: u32  each: u8  width: f64*
//!          n_points: u32  (x: f64  y: f64)*
//! ```
//!
//! `bottom` and `top` state how far the bead is raised above its layer. `each` is 1 if every point has a width of its own,
//! and 0 if all points share one width. Time and memory for reading are linear in the number of bytes, even if damaged
//! bytes state huge counts.

use grainpath_core::{BeadRaise, BeadWidth, DVec2, Role, SpeedClass, Toolpath};

use super::{Island, LayerPaths};
use crate::wall::Wall;

const MAGIC: &[u8; 5] = b"GPLP\x02";
const SPEEDS: [SpeedClass; 4] =
    [SpeedClass::Normal, SpeedClass::SmallWall, SpeedClass::Overhang, SpeedClass::Bridge];

/// The bytes do not hold paths of layers, or are damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are no paths of layers of this version: {wanted} should be at byte {offset}")]
pub struct PathBytesError {
    /// Position of the error in the bytes.
    pub offset: usize,
    /// The value that should be there.
    pub wanted: &'static str,
}

/// The paths of layers as bytes.
///
/// ```
/// use grainpath::order::{Island, LayerPaths, paths_from_bytes, paths_to_bytes};
/// use grainpath_core::{DVec2, Role, Toolpath};
///
/// let path = Toolpath::new(vec![DVec2::ZERO, DVec2::new(0.1, 7.0)], 0.45, Role::SparseFill, false);
/// let island = Island { walls: Vec::new(), fills: vec![path] };
/// let layers = [LayerPaths { islands: vec![island], ..LayerPaths::default() }];
/// assert_eq!(paths_from_bytes(&paths_to_bytes(&layers)).unwrap(), layers);
/// ```
pub fn paths_to_bytes(layers: &[LayerPaths]) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    put_n(&mut out, layers.len());
    for layer in layers {
        put_paths(&mut out, &layer.adhesion);
        for islands in [&layer.supports, &layer.islands] {
            put_n(&mut out, islands.len());
            for island in islands {
                put_n(&mut out, island.walls.len());
                for wall in &island.walls {
                    put_n(&mut out, wall.depth);
                    put_path(&mut out, &wall.path);
                }
                put_paths(&mut out, &island.fills);
            }
        }
    }
    out
}

/// The paths in these bytes.
///
/// # Errors
/// [`PathBytesError`] for bytes of another kind or version, and for damaged ones.
pub fn paths_from_bytes(bytes: &[u8]) -> Result<Vec<LayerPaths>, PathBytesError> {
    let mut reader = Reader { bytes, offset: 0 };
    if reader.take::<5>("the mark of the format")? != *MAGIC {
        return Err(PathBytesError { offset: 0, wanted: "the mark of the format" });
    }
    let layers = reader.list(|r| {
        let adhesion = r.paths()?;
        let supports = r.islands()?;
        Ok(LayerPaths { adhesion, supports, islands: r.islands()? })
    })?;
    if reader.offset < bytes.len() { Err(reader.wrong("the end")) } else { Ok(layers) }
}

fn put_n(out: &mut Vec<u8>, n: usize) {
    out.extend((n as u32).to_le_bytes());
}

fn put_paths(out: &mut Vec<u8>, paths: &[Toolpath]) {
    put_n(out, paths.len());
    paths.iter().for_each(|p| put_path(out, p));
}

fn put_path(out: &mut Vec<u8>, path: &Toolpath) {
    let role = Role::ALL.iter().position(|r| *r == path.role).unwrap_or_default() as u8;
    let speed = SPEEDS.iter().position(|s| *s == path.speed).unwrap_or_default() as u8;
    out.extend([role, speed, u8::from(path.closed), path.rank]);
    for mm in [path.flow, path.raise.bottom_mm, path.raise.top_mm] {
        out.extend(mm.to_le_bytes());
    }
    let widths = match &path.width {
        BeadWidth::Constant(mm) => std::slice::from_ref(mm),
        BeadWidth::PerVertex(all) => all.as_slice(),
    };
    put_n(out, widths.len());
    out.push(u8::from(matches!(path.width, BeadWidth::PerVertex(_))));
    widths.iter().for_each(|mm| out.extend(mm.to_le_bytes()));
    put_n(out, path.points.len());
    path.points.iter().flat_map(|p| p.to_array()).for_each(|v| out.extend(v.to_le_bytes()));
}

struct Reader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl Reader<'_> {
    fn wrong(&self, wanted: &'static str) -> PathBytesError {
        PathBytesError { offset: self.offset, wanted }
    }

    fn take<const N: usize>(&mut self, wanted: &'static str) -> Result<[u8; N], PathBytesError> {
        let taken = self.bytes.get(self.offset..).and_then(|b| b.first_chunk::<N>().copied());
        let taken = taken.ok_or_else(|| self.wrong(wanted))?;
        self.offset += N;
        Ok(taken)
    }

    fn n(&mut self) -> Result<usize, PathBytesError> {
        Ok(u32::from_le_bytes(self.take("a number")?) as usize)
    }

    fn float(&mut self) -> Result<f64, PathBytesError> {
        let v = f64::from_le_bytes(self.take("a number")?);
        if v.is_finite() { Ok(v) } else { Err(self.wrong("a finite number")) }
    }

    /// Reads a list. No memory is reserved for it, because damaged bytes may state any number of items.
    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self) -> Result<T, PathBytesError>,
    ) -> Result<Vec<T>, PathBytesError> {
        (0..self.n()?).map(|_| item(self)).collect()
    }

    fn paths(&mut self) -> Result<Vec<Toolpath>, PathBytesError> {
        self.list(Self::path)
    }

    fn islands(&mut self) -> Result<Vec<Island>, PathBytesError> {
        self.list(|r| {
            let walls = r.list(|r| Ok(Wall { depth: r.n()?, path: r.path()? }))?;
            Ok(Island { walls, fills: r.paths()? })
        })
    }

    fn path(&mut self) -> Result<Toolpath, PathBytesError> {
        let [role, speed, closed, rank] = self.take("a path")?;
        let role = Role::ALL.get(usize::from(role)).copied().ok_or_else(|| self.wrong("a role"))?;
        let speed = SPEEDS.get(usize::from(speed)).copied().ok_or_else(|| self.wrong("a class of speed"))?;
        let flow = self.float()?;
        let raise = BeadRaise { bottom_mm: self.float()?, top_mm: self.float()? };
        let n_widths = self.n()?;
        let [each] = self.take("a kind of width")?;
        let widths = (0..n_widths).map(|_| self.float()).collect::<Result<Vec<_>, _>>()?;
        let points = self.list(|r| Ok(DVec2::new(r.float()?, r.float()?)))?;
        let width = match (each, widths.as_slice()) {
            (0, [mm]) => BeadWidth::Constant(*mm),
            (1, all) if all.len() == points.len() => BeadWidth::PerVertex(widths),
            (_, _) => return Err(self.wrong("a width, or one for each point")),
        };
        if points.is_empty() {
            return Err(self.wrong("a point"));
        }
        Ok(Toolpath { points, width, flow, role, speed, closed: closed != 0, rank, raise })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn path() -> impl Strategy<Value = Toolpath> {
        let points = prop::collection::vec((-1e3f64..1e3, -1e3f64..1e3), 1..9);
        (points, 0usize..13, 0usize..4, any::<[bool; 2]>(), any::<u8>(), 0.1f64..2.0).prop_map(
            |(points, role, speed, [closed, each], rank, flow)| {
                let points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
                let width = if each {
                    BeadWidth::PerVertex(points.iter().map(|p| 0.4 + 1e-4 * p.x).collect())
                } else {
                    BeadWidth::Constant(0.45)
                };
                let (role, speed) = (Role::ALL[role], SPEEDS[speed]);
                let raise = BeadRaise { bottom_mm: 0.1 * flow, top_mm: 0.2 * flow };
                Toolpath { points, width, flow, role, speed, closed, rank, raise }
            },
        )
    }

    fn layers() -> impl Strategy<Value = Vec<LayerPaths>> {
        let paths = || prop::collection::vec(path(), 0..3);
        let island = move || {
            (prop::collection::vec((0usize..4, path()), 0..3), paths()).prop_map(|(walls, fills)| {
                let walls = walls.into_iter().map(|(depth, path)| Wall { path, depth }).collect();
                Island { walls, fills }
            })
        };
        let islands = move || prop::collection::vec(island(), 0..3);
        let layer = (paths(), islands(), islands()).prop_map(|(adhesion, supports, islands)| LayerPaths {
            adhesion,
            supports,
            islands,
        });
        prop::collection::vec(layer, 0..4)
    }

    proptest! {
        #[test]
        fn a_round_trip_keeps_every_path(layers in layers()) {
            let bytes = paths_to_bytes(&layers);
            prop_assert_eq!(paths_from_bytes(&bytes).expect("our own bytes"), layers);
        }

        /// No damage panics; every cut is an error.
        #[test]
        fn damaged_bytes_are_refused_or_read(layers in layers(), cut in 0.0f64..1.0, byte in any::<u8>()) {
            let mut bytes = paths_to_bytes(&layers);
            let at = (cut * bytes.len() as f64) as usize;
            prop_assert!(paths_from_bytes(&bytes[..at]).is_err());
            bytes[at] = byte;
            if let Ok(read) = paths_from_bytes(&bytes) {
                prop_assert!(read.len() <= bytes.len());
            }
        }
    }
}
