//! Merging of vertices: equal ones while a file is read, and ones close together in a mesh with open edges.

use glam::DVec3;

use super::TriMesh;

/// Gives equal positions the same index. Positions are equal if all their bits agree, with -0 taken as 0.
///
/// A hash table with open addressing, whose slots of 4 bytes hold indices of vertices. It welds the
/// vertices of triangles as they are read, so that unwelded triangles are never stored.
#[derive(Debug, Clone)]
pub struct VertexWelder {
    vertices: Vec<DVec3>,
    slots: Vec<u32>,
}

/// Marks a slot without a vertex.
const EMPTY: u32 = u32::MAX;

/// FNV-1a over the bits of the coordinates, with a multiplier that spreads neighbouring values over the table.
fn hash(p: DVec3) -> usize {
    let mut h = 0xcbf2_9ce4_8422_2325u64;
    for bits in [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()] {
        h = (h ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        h ^= h >> 29;
    }
    h as usize
}

impl VertexWelder {
    /// A welder that expects about this many vertices.
    pub fn with_capacity(n_vertices: usize) -> Self {
        let slots = (2 * n_vertices.clamp(16, 1 << 28)).next_power_of_two();
        Self { vertices: Vec::with_capacity(n_vertices), slots: vec![EMPTY; slots] }
    }

    /// The index of this position; a position that occurs for the first time gets a new index.
    /// `None` for a new position after 2^32 - 1 different ones.
    pub fn index(&mut self, p: DVec3) -> Option<u32> {
        // -0 and 0 are equal and have different hashes; adding 0 turns -0 into 0.
        let p = p + DVec3::ZERO;
        // At most three quarters full: in a table with open addressing longer runs would make every
        // search slow.
        if self.vertices.len() * 4 > self.slots.len() * 3 {
            self.grow();
        }
        let mask = self.slots.len() - 1;
        let mut slot = hash(p) & mask;
        loop {
            let found = self.slots[slot];
            if found == EMPTY {
                let index = u32::try_from(self.vertices.len()).ok().filter(|&i| i != EMPTY)?;
                self.slots[slot] = index;
                self.vertices.push(p);
                return Some(index);
            }
            if self.vertices[found as usize] == p {
                return Some(found);
            }
            slot = (slot + 1) & mask;
        }
    }

    fn grow(&mut self) {
        let mut slots = vec![EMPTY; self.slots.len() * 2];
        let mask = slots.len() - 1;
        for (i, &p) in self.vertices.iter().enumerate() {
            let mut slot = hash(p) & mask;
            while slots[slot] != EMPTY {
                slot = (slot + 1) & mask;
            }
            slots[slot] = i as u32;
        }
        self.slots = slots;
    }

    /// The different positions, in the order of their first appearance.
    pub fn into_vertices(mut self) -> Vec<DVec3> {
        self.vertices.shrink_to_fit();
        self.vertices
    }
}

/// Merges vertices closer than `tolerance_mm` and drops triangles that become points or lines. Each
/// vertex moves to the lowest-numbered one within reach, so the result depends on the mesh alone.
///
/// # Errors
/// What `check` returns; see [`weld_targets`].
pub fn weld_within<E>(
    mesh: &TriMesh,
    tolerance_mm: f64,
    check: impl Fn() -> Result<(), E>,
) -> Result<TriMesh, E> {
    let target = weld_targets(mesh, tolerance_mm, check)?;
    let mapped = mesh.triangles.iter().map(|t| t.map(|i| target[i as usize]));
    let triangles = mapped.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Ok(TriMesh { vertices: mesh.vertices.clone(), triangles })
}

/// The vertex that each vertex of a mesh becomes when those closer than `tolerance_mm` are merged:
/// the lowest-numbered one within reach. Half a million vertices take 0.5 s.
///
/// # Errors
/// What `check` returns. It is asked every `CHECK_EVERY` vertices, so that a stop can be heard.
pub fn weld_targets<E>(
    mesh: &TriMesh,
    tolerance_mm: f64,
    check: impl Fn() -> Result<(), E>,
) -> Result<Vec<u32>, E> {
    /// Source: chosen; so many vertices take about 10 ms.
    const CHECK_EVERY: u32 = 16_384;
    let n = mesh.vertices.len();
    let key = |p: DVec3| (p / tolerance_mm).floor();
    let mut order: Vec<u32> = (0..n as u32).collect();
    let cell = |i: u32| {
        let k = key(mesh.vertices[i as usize]);
        (k.x as i64, k.y as i64, k.z as i64)
    };
    // In an array sorted by cell, the 27 cells around a vertex are nine contiguous ranges.
    order.sort_by_cached_key(|&i| (cell(i), i));
    check()?;
    let keys: Vec<(i64, i64, i64)> = order.iter().map(|&i| cell(i)).collect();
    let mut target: Vec<u32> = (0..n as u32).collect();
    for i in 0..n as u32 {
        if i % CHECK_EVERY == 0 {
            check()?;
        }
        let p = mesh.vertices[i as usize];
        let (cx, cy, cz) = cell(i);
        let mut best = i;
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let start = keys.partition_point(|k| *k < (cx + dx, cy + dy, cz - 1));
            for (k, &j) in keys[start..].iter().zip(&order[start..]) {
                if *k > (cx + dx, cy + dy, cz + 1) {
                    break;
                }
                // Only vertices that do not move may be targets. Otherwise a chain of vertices,
                // each near the next, would collapse into one point.
                let free = target[j as usize] == j;
                if j < best && free && mesh.vertices[j as usize].distance(p) <= tolerance_mm {
                    best = j;
                }
            }
        }
        target[i as usize] = best;
    }
    // A vertex that another one moves to does not move itself, so a single step leads to the final
    // vertex.
    Ok(target)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_share_an_index() {
        let mut welder = VertexWelder::with_capacity(1);
        let points = (0..5000).map(|i| DVec3::new(f64::from(i % 100), f64::from(i / 100 % 7), -0.0));
        let indices: Vec<u32> = points.map(|p| welder.index(p).expect("few")).collect();
        assert_eq!(welder.index(DVec3::ZERO), Some(0));
        assert_eq!(welder.into_vertices().len(), 700);
        assert_eq!(indices[0], indices[700]);
    }

    #[test]
    fn near_vertices_are_merged_and_slivers_dropped() {
        let vertices = vec![
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::X + 1e-4,
            DVec3::Y - 1e-4,
            DVec3::new(1.0, 1.0, 0.0),
        ];
        let mesh = TriMesh { vertices, triangles: vec![[0, 1, 2], [3, 5, 4], [1, 3, 2]] };
        let Ok(welded) = weld_within(&mesh, 1e-3, || Ok::<(), std::convert::Infallible>(()));
        assert_eq!(welded.triangles, [[0, 1, 2], [1, 5, 2]]);
        assert_eq!(weld_within(&mesh, 1e-3, || Err("stopped")).err(), Some("stopped"));
    }
}
