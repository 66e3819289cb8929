//! Results of a stress guide besides directions: VTU files and principal stress lines.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;

use grainpath_core::math::direction;
use grainpath_core::poly::LineClipper;
use grainpath_core::streamlines::{FOUND_SHARE, LineSettings, Seeding, TracedLine, evenly_spaced};
use grainpath_core::{DVec2, DVec3, Region};
use grainpath_fea::principal::plane_principal;
use grainpath_io::fe::{Element, Encoding, PointData, VtuMesh, stress_point_data, write_vtu};

use super::{Guide, ResultMesh};

/// Number of lines of each principal stress across the longer side of the part. Source: chosen by
/// eye; only the picture of the lines depends on it.
const LINES_ACROSS: f64 = 60.0;

/// Evenly spaced principal stress lines of a layer: one set along the greater principal stress, one
/// along the smaller.
pub type Families = [Vec<TracedLine>; 2];

/// Faces of an element, found by its number of corners, with nodes in the order of VTK; a flat element is its own only
/// face.
fn faces(n_corners: usize, is_solid: bool) -> &'static [&'static [usize]] {
    match (n_corners, is_solid) {
        (3, false) => &[&[0, 1, 2]],
        (4, false) => &[&[0, 1, 2, 3]],
        (4, true) => &[&[0, 1, 2], &[0, 1, 3], &[0, 2, 3], &[1, 2, 3]],
        (5, true) => &[&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        (6, true) => &[&[0, 1, 2], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        (8, true) => {
            &[&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
        }
        _ => &[],
    }
}

/// The surface of a result mesh, for drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResultSurface {
    /// Positions, mm, part coordinates.
    pub points: Vec<DVec3>,
    /// For each point, the node of the result whose values it shows.
    pub nodes: Vec<u32>,
    /// Indices of points, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The nodes around a face of an element in order; those along an edge of a flat element.
struct Outline {
    nodes: Vec<u32>,
    /// Whether every second node lies in the middle of a side.
    has_middles: bool,
}

impl Outline {
    /// The outline of a face with these corners, which are numbered as those of the element.
    fn of(element: &Element, corners: &[usize]) -> Self {
        let n_corners = element.kind.n_corners();
        let middle = |a: usize, b: usize| {
            let edge = element.kind.edges().iter().position(|e| *e == [a, b] || *e == [b, a])?;
            Some(element.nodes()[n_corners + edge])
        };
        let mut nodes = Vec::with_capacity(2 * corners.len());
        for (k, &corner) in corners.iter().enumerate() {
            nodes.push(element.nodes()[corner]);
            // An edge has one side, which is not closed.
            if k + 1 < corners.len() || corners.len() > 2 {
                nodes.extend(middle(corner, corners[(k + 1) % corners.len()]));
            }
        }
        Self { has_middles: nodes.len() > corners.len(), nodes }
    }

    /// Triangles that fill it: one at each corner and a fan between the middles of the sides, or a fan between the corners.
    fn triangles(&self) -> Vec<[u32; 3]> {
        let Self { nodes, has_middles } = self;
        let fan = |ring: &[u32]| (1..ring.len() - 1).map(|k| [ring[0], ring[k], ring[k + 1]]).collect();
        if !has_middles {
            return fan(nodes);
        }
        let middles: Vec<u32> = nodes.iter().skip(1).step_by(2).copied().collect();
        let mut found: Vec<[u32; 3]> = fan(&middles);
        let n = nodes.len();
        found.extend((0..n).step_by(2).map(|k| [nodes[(k + n - 1) % n], nodes[k], nodes[k + 1]]));
        found
    }
}

impl ResultMesh {
    /// The surface of the elements through all nodes of their edges. The nodes of a plate lie at mid-height, so it gets
    /// a bottom face at `bottom_mm`, a top face as far above the nodes, and side faces.
    ///
    /// Method: a face that two elements share lies inside; faces are paired by sorting them. A triangle with a node in
    /// the middle of each side becomes four, so that the surface shows the greatest stress also where the node of that
    /// stress is no corner. Cost: n log n in the elements.
    pub fn surface(&self, bottom_mm: f64) -> ResultSurface {
        let is_solid = self.elements.iter().any(|e| e.kind.dimension() == 3);
        let dimension = if is_solid { 3 } else { 2 };
        let elements: Vec<&Element> =
            self.elements.iter().filter(|e| e.kind.dimension() == dimension).collect();
        // A key has room for four corners; triangles and edges fill the rest with a number that is not a node.
        let mut faces: Vec<([u32; 4], usize, usize)> = Vec::new();
        for (k, element) in elements.iter().enumerate() {
            let corners = element.corners();
            for (f, face) in element.kind.faces().iter().enumerate() {
                let mut key = [u32::MAX; 4];
                key.iter_mut().zip(face.iter()).for_each(|(slot, c)| *slot = corners[*c]);
                key.sort_unstable();
                faces.push((key, k, f));
            }
        }
        faces.sort_unstable();
        let alone = faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
        let mut outer: Vec<(usize, usize)> = alone.map(|one| (one[0].1, one[0].2)).collect();
        outer.sort_unstable();
        let outer: Vec<Outline> =
            outer.into_iter().map(|(k, f)| Outline::of(elements[k], elements[k].kind.faces()[f])).collect();
        // A plate is drawn as its elements at the top and at the bottom, and as side faces along its border.
        let whole = |e: &&Element| Outline::of(e, &(0..e.kind.n_corners()).collect::<Vec<_>>());
        let flat: Vec<Outline> = if is_solid { Vec::new() } else { elements.iter().map(whole).collect() };
        let mut point = vec![u32::MAX; self.nodes.len()];
        outer.iter().chain(&flat).flat_map(|o| &o.nodes).for_each(|n| point[*n as usize] = 0);
        let mut surface = ResultSurface::default();
        for (n, place) in self.nodes.iter().enumerate().filter(|(n, _)| point[*n] == 0).collect::<Vec<_>>() {
            point[n] = surface.points.len() as u32;
            if is_solid {
                surface.points.push(*place);
                surface.nodes.push(n as u32);
            } else {
                let top_mm = 2.0 * place.z - bottom_mm;
                surface.points.extend([place.with_z(bottom_mm), place.with_z(top_mm)]);
                surface.nodes.extend([n as u32; 2]);
            }
        }
        let at = |n: u32| point[n as usize];
        let cut = |face: &Outline, lift: u32| -> Vec<[u32; 3]> {
            face.triangles().into_iter().map(|corners| corners.map(|n| at(n) + lift)).collect()
        };
        for face in &outer {
            if is_solid {
                surface.triangles.extend(cut(face, 0));
                continue;
            }
            // Here a face is an edge of the border.
            for ends in face.nodes.windows(2) {
                let (a, b) = (at(ends[0]), at(ends[1]));
                surface.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
        for face in &flat {
            surface.triangles.extend(cut(face, 0).into_iter().map(|[a, b, c]| [a, c, b]));
            surface.triangles.extend(cut(face, 1));
        }
        surface
    }

    /// Edges on the surface of the mesh between corners of elements, each once, as pairs of nodes. A face that two
    /// elements share lies inside.
    pub fn surface_edges(&self) -> BTreeSet<[u32; 2]> {
        let mut outer: BTreeMap<Vec<u32>, Option<Vec<u32>>> = BTreeMap::new();
        for element in &self.elements {
            let corners = element.corners();
            for face in faces(corners.len(), element.kind.dimension() == 3) {
                let face: Vec<u32> = face.iter().map(|k| corners[*k]).collect();
                let mut key = face.clone();
                key.sort_unstable();
                outer.entry(key).and_modify(|other| *other = None).or_insert(Some(face));
            }
        }
        let sides = |face: Vec<u32>| {
            let next = |k: usize| face[(k + 1) % face.len()];
            (0..face.len()).map(|k| [face[k].min(next(k)), face[k].max(next(k))]).collect::<Vec<_>>()
        };
        outer.into_values().flatten().flat_map(sides).collect()
    }
}

impl Guide {
    /// Stress, displacement and principal vectors of every case, as VTU.
    ///
    /// # Errors
    /// Those of the writer; writing into memory cannot fail.
    pub fn vtu(&self) -> std::io::Result<Vec<u8>> {
        let mut out = Vec::new();
        let Some(first) = self.results.first() else { return Ok(out) };
        let mut data: Vec<PointData> = Vec::new();
        for result in &self.results {
            let mut arrays = stress_point_data(&result.stress, result.displacement.as_deref());
            // 1 on the nodes of a fixture or load, 0 elsewhere.
            arrays.extend(result.sets.iter().map(|(name, nodes)| {
                let mut values = vec![0.0; result.nodes.len()];
                nodes.iter().for_each(|n| values[*n as usize] = 1.0);
                PointData::scalars(&name.replace(' ', "_"), values)
            }));
            // Arrays of several cases need different names in one file.
            if self.results.len() > 1 {
                arrays.iter_mut().for_each(|a| a.name = format!("{} {}", result.name, a.name));
            }
            data.extend(arrays);
        }
        let mesh = VtuMesh { nodes: &first.nodes, elements: &first.elements };
        write_vtu(mesh, &data, Encoding::Zlib, &mut out)?;
        Ok(out)
    }

    /// Principal stress lines of a section at height `z_mm`, of the heaviest case.
    pub fn lines(&self, region: &Region, z_mm: f64) -> Families {
        let Some(bounds) = region.bounds() else { return Families::default() };
        let inside = LineClipper::new(region);
        let size = bounds.size();
        // At least six lines across the shorter side, so that a slender part shows its lines too.
        let separation = (size.max_element() / LINES_ACROSS).min(size.min_element() / 6.0).max(1e-3);
        let same = |_: DVec2| separation;
        let seeding = Seeding {
            separation_mm: &same,
            end_share: 0.5,
            shortest_mm: 2.0 * separation,
            shortest_across_mm: 2.0 * separation,
            seed_share: FOUND_SHARE,
            whole: false,
            is_held: &|_| true,
        };
        let settings = LineSettings {
            tolerance_mm: 1e-3 * separation,
            step_mm: 0.5 * separation,
            longest_mm: 10.0 * size.element_sum(),
        };
        let stress = self.main_case();
        [0.0, FRAC_PI_2].map(|turn| {
            let axis = |p: DVec2| {
                if !inside.contains(p) {
                    return None;
                }
                let principal = plane_principal(stress.at(p.extend(z_mm)));
                let apart = principal.values_mpa[0] - principal.values_mpa[1];
                // Where both stresses are equal there is no direction to follow.
                (apart > 1e-9).then(|| direction(principal.axis_rad + turn))
            };
            evenly_spaced(&[bounds.centre()], bounds, &axis, &seeding, &settings)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_io::fe::ElementKind;

    fn mesh(nodes: Vec<DVec3>, elements: Vec<Element>) -> ResultMesh {
        let stress = vec![[0.0; 6]; nodes.len()];
        ResultMesh { name: "loads".into(), nodes, elements, stress, displacement: None, sets: Vec::new() }
    }

    /// Enclosed volume and area of a surface.
    fn measured(surface: &ResultSurface) -> (f64, f64) {
        let corners = surface.triangles.iter().map(|t| t.map(|i| surface.points[i as usize]));
        corners.fold((0.0, 0.0), |(volume, area), [a, b, c]| {
            (volume + a.dot(b.cross(c)) / 6.0, area + 0.5 * (b - a).cross(c - a).length())
        })
    }

    fn element(kind: ElementKind, nodes: &[u32]) -> Element {
        Element::new(kind, nodes).expect("as many nodes as the kind has")
    }

    #[test]
    fn a_cube_of_six_tetrahedra_has_the_surface_of_a_cube() {
        let mut nodes: Vec<DVec3> =
            (0..8).map(|k| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2))).collect();
        // A node of no element is not drawn.
        nodes.insert(0, DVec3::splat(9.0));
        // Kuhn's tetrahedra: along the diagonal, one for each order of the axes.
        let orders = [[1, 2, 4], [2, 4, 1], [4, 1, 2], [2, 1, 4], [1, 4, 2], [4, 2, 1]];
        let tets = orders.iter().enumerate().map(|(k, [a, b, _])| {
            let path = [1, 1 + a, 1 + a + b, 8];
            let turned = [path[0], path[2], path[1], path[3]];
            element(ElementKind::Tet4, if k < 3 { &path } else { &turned })
        });
        let surface = mesh(nodes, tets.collect()).surface(0.0);
        let (volume, area) = measured(&surface);
        assert!((volume - 1.0).abs() < 1e-12 && (area - 6.0).abs() < 1e-12, "{volume} {area}");
        assert_eq!((surface.points.len(), surface.triangles.len()), (8, 12));
        assert_eq!(surface.nodes, [1, 2, 3, 4, 5, 6, 7, 8]);
    }

    #[test]
    fn nodes_in_the_middle_of_edges_are_on_the_surface() {
        // A tetrahedron, and the middles of its edges in the order of VTK.
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let edges = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
        let middles = edges.map(|[a, b]: [usize; 2]| 0.5 * (corners[a] + corners[b]));
        let nodes: Vec<DVec3> = corners.into_iter().chain(middles).collect();
        let numbers: Vec<u32> = (0..10).collect();
        let solid = mesh(nodes.clone(), vec![element(ElementKind::Tet10, &numbers)]).surface(0.0);
        let (volume, area) = measured(&solid);
        assert!((volume - 1.0 / 6.0).abs() < 1e-12, "{volume}");
        assert!((area - (1.5 + 0.75f64.sqrt())).abs() < 1e-12, "{area}");
        assert_eq!((solid.nodes, solid.triangles.len()), (numbers, 16));
        // A flat triangle of six nodes, from 0 to 2 mm.
        let flat = [0, 1, 2, 4, 5, 6].map(|k: usize| nodes[k].with_z(1.0));
        let plate = mesh(flat.to_vec(), vec![element(ElementKind::Tri6, &[0, 1, 2, 3, 4, 5])]);
        let (volume, _) = measured(&plate.surface(0.0));
        assert!((volume - 1.0).abs() < 1e-12, "{volume}");
        // Four triangles above, four below, and two sides of two triangles along each edge.
        assert_eq!(plate.surface(0.0).triangles.len(), 4 + 4 + 12);
    }

    #[test]
    fn a_plate_gets_its_height_back() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 2.0);
        let nodes = vec![at(0.0, 0.0), at(3.0, 0.0), at(3.0, 2.0), at(0.0, 2.0)];
        let triangles = vec![element(ElementKind::Tri3, &[0, 1, 2]), element(ElementKind::Tri3, &[0, 2, 3])];
        let (volume, area) = measured(&mesh(nodes, triangles).surface(1.0));
        // From 1 to 3 mm.
        assert!((volume - 12.0).abs() < 1e-12 && (area - (12.0 + 20.0)).abs() < 1e-12, "{volume} {area}");
    }
}
