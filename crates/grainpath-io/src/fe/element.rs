//! Element kinds: node numbering, shape functions and faces.
//!
//! Nodes are numbered as VTK numbers them: corners first, then the middles of edges. Hexahedra and wedges
//! list the edges of the lower face, then of the upper face, then the upright ones. Readers convert other
//! numberings to this one.
//!
//! Source: Kitware, *VTK File Formats*, for the numbering; the shape functions are the usual Lagrange and
//! serendipity functions. Natural coordinates run from 0 to 1 in triangles and tetrahedra and from -1 to
//! 1 in quads and hexahedra; a wedge combines both, and a pyramid is a cube collapsed at t = 1. Gauss
//! points are exact for the volume of straight elements. Functions cost a few operations for each node.
//! The gradient of a pyramid is not defined at its apex.

use grainpath_core::DVec3;

/// Largest number of nodes of an element. Source: `Hex20`, the largest kind that is read.
pub const MAX_NODES: usize = 20;

/// A kind of element. Results are interpolated in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum ElementKind {
    Tri3,
    Tri6,
    Quad4,
    Quad8,
    Quad9,
    Tet4,
    Tet10,
    Pyramid5,
    Wedge6,
    Wedge15,
    Hex8,
    Hex20,
}

/// Range of the natural coordinates `r`, `s`, `t` of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Domain {
    /// `r, s >= 0`, `r + s <= 1`.
    Triangle,
    /// `-1..1` each.
    Square,
    /// As the triangle, with `t`.
    Tetrahedron,
    /// `r, s` in `-1..1`, `t` in `0..1`; collapsed at `t = 1`.
    Pyramid,
    /// Triangle times `-1..1`.
    Prism,
    Cube,
}

/// Shape functions at a point and their derivatives by the natural coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Weight of each node.
    pub n: [f64; MAX_NODES],
    /// Derivatives of the weights by `r`, `s`, `t`.
    pub d: [DVec3; MAX_NODES],
}

impl Shape {
    const ZERO: Self = Self { n: [0.0; MAX_NODES], d: [DVec3::ZERO; MAX_NODES] };

    fn set(&mut self, i: usize, n: f64, r: f64, s: f64, t: f64) {
        self.n[i] = n;
        self.d[i] = DVec3::new(r, s, t);
    }
}

/// Corners of the square in natural coordinates.
const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
// Source: Kitware, *VTK File Formats*, figure of the non-linear cell types, VTK_QUADRATIC_QUAD.
const QUAD_EDGES: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
// Source: the same figure, VTK_QUADRATIC_TETRA.
const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
// Source: the same figure, VTK_QUADRATIC_WEDGE.
const WEDGE_EDGES: [[usize; 2]; 9] = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
// Source: the same figure, VTK_QUADRATIC_HEXAHEDRON.
const HEX_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl ElementKind {
    /// Every kind.
    pub const ALL: [Self; 12] = [
        Self::Tri3,
        Self::Tri6,
        Self::Quad4,
        Self::Quad8,
        Self::Quad9,
        Self::Tet4,
        Self::Tet10,
        Self::Pyramid5,
        Self::Wedge6,
        Self::Wedge15,
        Self::Hex8,
        Self::Hex20,
    ];

    /// The name used in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tri3 => "tri3",
            Self::Tri6 => "tri6",
            Self::Quad4 => "quad4",
            Self::Quad8 => "quad8",
            Self::Quad9 => "quad9",
            Self::Tet4 => "tet4",
            Self::Tet10 => "tet10",
            Self::Pyramid5 => "pyramid5",
            Self::Wedge6 => "wedge6",
            Self::Wedge15 => "wedge15",
            Self::Hex8 => "hex8",
            Self::Hex20 => "hex20",
        }
    }

    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        match self {
            Self::Tri3 => 3,
            Self::Quad4 | Self::Tet4 => 4,
            Self::Pyramid5 => 5,
            Self::Tri6 | Self::Wedge6 => 6,
            Self::Quad8 | Self::Hex8 => 8,
            Self::Quad9 => 9,
            Self::Tet10 => 10,
            Self::Wedge15 => 15,
            Self::Hex20 => 20,
        }
    }

    /// Number of corners; they come first among the nodes.
    pub const fn n_corners(self) -> usize {
        match self {
            Self::Tri3 | Self::Tri6 => 3,
            Self::Quad4 | Self::Quad8 | Self::Quad9 | Self::Tet4 | Self::Tet10 => 4,
            Self::Pyramid5 => 5,
            Self::Wedge6 | Self::Wedge15 => 6,
            Self::Hex8 | Self::Hex20 => 8,
        }
    }

    /// 2 for surfaces, 3 for solids.
    pub const fn dimension(self) -> usize {
        match self {
            Self::Tri3 | Self::Tri6 | Self::Quad4 | Self::Quad8 | Self::Quad9 => 2,
            _ => 3,
        }
    }

    /// Number VTK gives the kind.
    pub(crate) const fn vtk_type(self) -> u8 {
        match self {
            // Source: *VTK File Formats*, cell types (vtkCellType.h).
            Self::Tri3 => 5,
            Self::Tri6 => 22,
            Self::Quad4 => 9,
            Self::Quad8 => 23,
            Self::Quad9 => 28,
            Self::Tet4 => 10,
            Self::Tet10 => 24,
            Self::Pyramid5 => 14,
            Self::Wedge6 => 13,
            Self::Wedge15 => 26,
            Self::Hex8 => 12,
            Self::Hex20 => 25,
        }
    }

    /// The corners between which each node after the corners lies; the middle of a `quad9` is not among them.
    pub const fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Self::Tri6 => &[[0, 1], [1, 2], [2, 0]],
            Self::Quad8 | Self::Quad9 => &QUAD_EDGES,
            Self::Tet10 => &TET_EDGES,
            Self::Wedge15 => &WEDGE_EDGES,
            Self::Hex20 => &HEX_EDGES,
            _ => &[],
        }
    }

    /// Corners of every face of a solid, or of every edge of a surface, in the order Abaqus and CalculiX number them
    /// (`P1`, `S1` ...). Faces of solids are counter-clockwise seen from outside, with Abaqus' numbering of corners.
    pub const fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tri3 | Self::Tri6 => &[&[0, 1], &[1, 2], &[2, 0]],
            Self::Quad4 | Self::Quad8 | Self::Quad9 => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            Self::Tet4 | Self::Tet10 => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
            Self::Pyramid5 => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
            Self::Wedge6 | Self::Wedge15 => {
                &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]]
            }
            Self::Hex8 | Self::Hex20 => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }

    const fn domain(self) -> Domain {
        match self {
            Self::Tri3 | Self::Tri6 => Domain::Triangle,
            Self::Quad4 | Self::Quad8 | Self::Quad9 => Domain::Square,
            Self::Tet4 | Self::Tet10 => Domain::Tetrahedron,
            Self::Pyramid5 => Domain::Pyramid,
            Self::Wedge6 | Self::Wedge15 => Domain::Prism,
            Self::Hex8 | Self::Hex20 => Domain::Cube,
        }
    }

    /// The centre of the element in natural coordinates.
    pub const fn centre(self) -> DVec3 {
        match self.domain() {
            Domain::Triangle | Domain::Prism => DVec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0),
            Domain::Tetrahedron => DVec3::splat(0.25),
            Domain::Pyramid => DVec3::new(0.0, 0.0, 0.2),
            Domain::Square | Domain::Cube => DVec3::ZERO,
        }
    }

    /// Distance of natural coordinates outside the element; 0 or less inside.
    pub(crate) fn outside(self, x: DVec3) -> f64 {
        // Each domain is convex, so the largest violation of its bounding planes says how far a point is
        // outside.
        let triangle = (-x.x).max(-x.y).max(x.x + x.y - 1.0);
        let square = x.x.abs().max(x.y.abs()) - 1.0;
        match self.domain() {
            Domain::Triangle => triangle,
            Domain::Square => square,
            Domain::Tetrahedron => (-x.x).max(-x.y).max(-x.z).max(x.x + x.y + x.z - 1.0),
            Domain::Pyramid => square.max(-x.z).max(x.z - 1.0),
            Domain::Prism => triangle.max(x.z.abs() - 1.0),
            Domain::Cube => square.max(x.z.abs() - 1.0),
        }
    }

    /// The nearest natural coordinates that lie in the element.
    pub(crate) fn clamped(self, x: DVec3) -> DVec3 {
        let square = |v: f64| v.clamp(-1.0, 1.0);
        match self.domain() {
            Domain::Triangle => triangle_clamped(x).with_z(0.0),
            Domain::Square => DVec3::new(square(x.x), square(x.y), 0.0),
            Domain::Tetrahedron => tetrahedron_clamped(x),
            // Not the exact nearest point, but one inside the element; the pyramid is a unit cube
            // collapsed at t = 1.
            Domain::Pyramid => DVec3::new(square(x.x), square(x.y), x.z.clamp(0.0, 1.0)),
            Domain::Prism => triangle_clamped(x).with_z(square(x.z)),
            Domain::Cube => DVec3::new(square(x.x), square(x.y), square(x.z)),
        }
    }

    /// Gauss points and weights for the volume (area) of the element.
    pub(crate) fn quadrature(self) -> Vec<(DVec3, f64)> {
        // Two points on a line, exact to degree 3.
        let g = (1.0f64 / 3.0).sqrt();
        let line = [(-g, 1.0), (g, 1.0)];
        // Three points inside the triangle, exact to degree 2; each weighs a third of the triangle's area
        // of 1/2.
        let triangle = [(1.0 / 6.0, 1.0 / 6.0), (2.0 / 3.0, 1.0 / 6.0), (1.0 / 6.0, 2.0 / 3.0)];
        let mut points = Vec::new();
        match self.domain() {
            Domain::Triangle => points.extend(triangle.map(|(r, s)| (DVec3::new(r, s, 0.0), 1.0 / 6.0))),
            Domain::Square => {
                for (r, _) in line {
                    points.extend(line.map(|(s, _)| (DVec3::new(r, s, 0.0), 1.0)));
                }
            }
            Domain::Tetrahedron => {
                // Four points, exact to degree 2: a = (5 + 3 sqrt 5)/20 and b = (5 - sqrt 5)/20. Each
                // weighs a quarter of the volume of 1/6.
                let (a, b) = (0.585_410_196_624_968_5, 0.138_196_601_125_010_5);
                let corners = [[b, b, b], [a, b, b], [b, a, b], [b, b, a]];
                points.extend(corners.map(|c| (DVec3::from(c), 1.0 / 24.0)));
            }
            Domain::Prism => {
                for (t, _) in line {
                    points.extend(triangle.map(|(r, s)| (DVec3::new(r, s, t), 1.0 / 6.0)));
                }
            }
            Domain::Pyramid | Domain::Cube => {
                let half = self.domain() == Domain::Pyramid;
                for (t, _) in line {
                    // The pyramid's t runs over 0..1, half the cube's range.
                    let (t, w) = if half { (0.5 + 0.5 * t, 0.5) } else { (t, 1.0) };
                    for (s, _) in line {
                        points.extend(line.map(|(r, _)| (DVec3::new(r, s, t), w)));
                    }
                }
            }
        }
        points
    }

    /// Weights of the nodes at natural coordinates, as in `shape` but without derivatives.
    pub fn weights(self, x: DVec3) -> [f64; MAX_NODES] {
        let mut n = [0.0; MAX_NODES];
        // Tetrahedra are nearly all elements of a mesh and are evaluated for every sample, so they skip
        // the derivatives.
        let l = [1.0 - x.x - x.y - x.z, x.x, x.y, x.z];
        match self {
            Self::Tet4 => n[..4].copy_from_slice(&l),
            Self::Tet10 => {
                for i in 0..4 {
                    n[i] = l[i] * (2.0 * l[i] - 1.0);
                }
                for (k, [i, j]) in TET_EDGES.into_iter().enumerate() {
                    n[4 + k] = 4.0 * l[i] * l[j];
                }
            }
            _ => return self.shape(x).n,
        }
        n
    }

    /// Shape functions at natural coordinates.
    pub fn shape(self, x: DVec3) -> Shape {
        let mut f = Shape::ZERO;
        let (r, s, t) = (x.x, x.y, x.z);
        match self {
            Self::Tri3 => {
                f.set(0, 1.0 - r - s, -1.0, -1.0, 0.0);
                f.set(1, r, 1.0, 0.0, 0.0);
                f.set(2, s, 0.0, 1.0, 0.0);
            }
            Self::Tet4 => {
                f.set(0, 1.0 - r - s - t, -1.0, -1.0, -1.0);
                f.set(1, r, 1.0, 0.0, 0.0);
                f.set(2, s, 0.0, 1.0, 0.0);
                f.set(3, t, 0.0, 0.0, 1.0);
            }
            Self::Tri6 => simplex_quadratic(&mut f, &Self::Tri3.shape(x), 3, self.edges()),
            Self::Tet10 => simplex_quadratic(&mut f, &Self::Tet4.shape(x), 4, self.edges()),
            Self::Quad4 => {
                for (i, [a, b]) in SQUARE.into_iter().enumerate() {
                    let (u, v) = (1.0 + a * r, 1.0 + b * s);
                    f.set(i, 0.25 * u * v, 0.25 * a * v, 0.25 * b * u, 0.0);
                }
            }
            Self::Quad8 => quad8(&mut f, r, s),
            Self::Quad9 => quad9(&mut f, r, s),
            Self::Pyramid5 => {
                for (i, [a, b]) in SQUARE.into_iter().enumerate() {
                    let (u, v, w) = (1.0 + a * r, 1.0 + b * s, 0.25 * (1.0 - t));
                    // A unit cube whose upper face is collapsed: each corner function fades linearly to
                    // the apex.
                    f.set(i, w * u * v, w * a * v, w * b * u, -0.25 * u * v);
                }
                f.set(4, t, 0.0, 0.0, 1.0);
            }
            Self::Wedge6 => {
                let base = Self::Tri3.shape(x);
                for i in 0..6 {
                    let (n, d, sign) = (base.n[i % 3], base.d[i % 3], if i < 3 { -1.0 } else { 1.0 });
                    let h = 0.5 * (1.0 + sign * t);
                    f.set(i, n * h, d.x * h, d.y * h, 0.5 * sign * n);
                }
            }
            Self::Wedge15 => wedge15(&mut f, x),
            Self::Hex8 => {
                for i in 0..8 {
                    let [a, b] = SQUARE[i % 4];
                    let c = if i < 4 { -1.0 } else { 1.0 };
                    let (u, v, w) = (1.0 + a * r, 1.0 + b * s, 1.0 + c * t);
                    f.set(i, 0.125 * u * v * w, 0.125 * a * v * w, 0.125 * b * u * w, 0.125 * c * u * v);
                }
            }
            Self::Hex20 => hex20(&mut f, x),
        }
        f
    }
}

/// Quadratic triangles and tetrahedra from the linear ones: l (2 l - 1) at corners, 4 l_i l_j on edges.
fn simplex_quadratic(f: &mut Shape, linear: &Shape, n_corners: usize, edges: &[[usize; 2]]) {
    for i in 0..n_corners {
        let l = linear.n[i];
        f.n[i] = l * (2.0 * l - 1.0);
        f.d[i] = linear.d[i] * (4.0 * l - 1.0);
    }
    for (k, &[i, j]) in edges.iter().enumerate() {
        f.n[n_corners + k] = 4.0 * linear.n[i] * linear.n[j];
        f.d[n_corners + k] = 4.0 * (linear.d[i] * linear.n[j] + linear.d[j] * linear.n[i]);
    }
}

fn quad8(f: &mut Shape, r: f64, s: f64) {
    // Serendipity functions: a corner vanishes on the line through its two neighbouring middles.
    for (i, [a, b]) in SQUARE.into_iter().enumerate() {
        let (p, q) = (a * r, b * s);
        let (u, v) = (1.0 + p, 1.0 + q);
        f.set(
            i,
            0.25 * u * v * (p + q - 1.0),
            0.25 * a * v * (2.0 * p + q),
            0.25 * b * u * (p + 2.0 * q),
            0.0,
        );
    }
    for (k, [i, j]) in QUAD_EDGES.into_iter().enumerate() {
        // A node in the middle of an edge has one natural coordinate equal to 0; along that axis its function is a parabola.
        let a = 0.5 * (SQUARE[i][0] + SQUARE[j][0]);
        let b = 0.5 * (SQUARE[i][1] + SQUARE[j][1]);
        if a == 0.0 {
            f.set(
                4 + k,
                0.5 * (1.0 - r * r) * (1.0 + b * s),
                -r * (1.0 + b * s),
                0.5 * b * (1.0 - r * r),
                0.0,
            );
        } else {
            f.set(
                4 + k,
                0.5 * (1.0 - s * s) * (1.0 + a * r),
                0.5 * a * (1.0 - s * s),
                -s * (1.0 + a * r),
                0.0,
            );
        }
    }
}

fn quad9(f: &mut Shape, r: f64, s: f64) {
    // Lagrange polynomials of -1, 0, 1 and their derivatives.
    let l =
        |x: f64| [(0.5 * x * (x - 1.0), x - 0.5), (1.0 - x * x, -2.0 * x), (0.5 * x * (x + 1.0), x + 0.5)];
    let (lr, ls) = (l(r), l(s));
    // Index of the polynomial along r and s for corners, middles and the centre, in VTK's order.
    let at = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];
    for (i, [p, q]) in at.into_iter().enumerate() {
        let ((a, da), (b, db)) = (lr[p], ls[q]);
        f.set(i, a * b, da * b, a * db, 0.0);
    }
}

fn wedge15(f: &mut Shape, x: DVec3) {
    let (base, t) = (ElementKind::Tri3.shape(x), x.z);
    for i in 0..6 {
        let (l, d, c) = (base.n[i % 3], base.d[i % 3], if i < 3 { -1.0 } else { 1.0 });
        // Half the function of the upright edge's middle node is subtracted, so that a corner function vanishes at that
        // node.
        let (h, bubble) = (1.0 + c * t, 1.0 - t * t);
        let n = 0.5 * l * ((2.0 * l - 1.0) * h - bubble);
        let by_l = 0.5 * ((4.0 * l - 1.0) * h - bubble);
        f.set(i, n, by_l * d.x, by_l * d.y, 0.5 * l * ((2.0 * l - 1.0) * c + 2.0 * t));
    }
    for (k, [i, j]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
        let product = base.n[i] * base.n[j];
        let d = base.d[i] * base.n[j] + base.d[j] * base.n[i];
        for (at, c) in [(6 + k, -1.0), (9 + k, 1.0)] {
            let h = 2.0 * (1.0 + c * t);
            f.set(at, product * h, d.x * h, d.y * h, 2.0 * c * product);
        }
    }
    for i in 0..3 {
        let (l, d, bubble) = (base.n[i], base.d[i], 1.0 - t * t);
        f.set(12 + i, l * bubble, d.x * bubble, d.y * bubble, -2.0 * t * l);
    }
}

fn hex20(f: &mut Shape, x: DVec3) {
    let corner = |i: usize| DVec3::new(SQUARE[i % 4][0], SQUARE[i % 4][1], if i < 4 { -1.0 } else { 1.0 });
    for i in 0..8 {
        let c = corner(i);
        let p = c * x;
        let u = DVec3::ONE + p;
        let sum = p.x + p.y + p.z;
        f.set(
            i,
            0.125 * u.x * u.y * u.z * (sum - 2.0),
            0.125 * c.x * u.y * u.z * (sum + p.x - 1.0),
            0.125 * c.y * u.x * u.z * (sum + p.y - 1.0),
            0.125 * c.z * u.x * u.y * (sum + p.z - 1.0),
        );
    }
    for (k, [i, j]) in HEX_EDGES.into_iter().enumerate() {
        let c = 0.5 * (corner(i) + corner(j));
        // Along its edge the function is a parabola; across the edge it is linear.
        let factor = |c: f64, x: f64| if c == 0.0 { (1.0 - x * x, -2.0 * x) } else { (1.0 + c * x, c) };
        let (u, v, w) = (factor(c.x, x.x), factor(c.y, x.y), factor(c.z, x.z));
        f.set(
            8 + k,
            0.25 * u.0 * v.0 * w.0,
            0.25 * u.1 * v.0 * w.0,
            0.25 * u.0 * v.1 * w.0,
            0.25 * u.0 * v.0 * w.1,
        );
    }
}

fn triangle_clamped(x: DVec3) -> DVec3 {
    let (r, s) = (x.x, x.y);
    // The point lies beyond the hypotenuse and between its ends, so it is projected at a right angle.
    let over = 0.5 * (r + s - 1.0);
    if over > 0.0 && (r - s).abs() <= 1.0 {
        return DVec3::new(r - over, s - over, x.z);
    }
    if r + s > 1.0 {
        return if r > s { DVec3::new(1.0, 0.0, x.z) } else { DVec3::new(0.0, 1.0, x.z) };
    }
    DVec3::new(r.clamp(0.0, 1.0), s.clamp(0.0, 1.0), x.z)
}

/// The nearest point of the unit tetrahedron.
fn tetrahedron_clamped(x: DVec3) -> DVec3 {
    let low = x.max(DVec3::ZERO);
    if low.x + low.y + low.z <= 1.0 {
        return low;
    }
    // Projection onto the simplex: the same amount is subtracted from all coordinates, so that the
    // positive ones sum to 1. Sorting finds which of them stay positive.
    let mut sorted = x.to_array();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let (mut sum, mut over) = (0.0, 0.0);
    for (k, v) in sorted.into_iter().enumerate() {
        sum += v;
        let candidate = (sum - 1.0) / (k + 1) as f64;
        if v > candidate {
            over = candidate;
        }
    }
    (x - DVec3::splat(over)).max(DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Natural coordinates of every node.
    fn nodes(kind: ElementKind) -> Vec<DVec3> {
        let mut at: Vec<DVec3> = match kind.domain() {
            Domain::Triangle => [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from).to_vec(),
            Domain::Square => SQUARE.map(|[a, b]| DVec3::new(a, b, 0.0)).to_vec(),
            Domain::Tetrahedron => vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            Domain::Pyramid => {
                let mut base = SQUARE.map(|[a, b]| DVec3::new(a, b, 0.0)).to_vec();
                base.push(DVec3::Z);
                base
            }
            Domain::Prism => (0..6)
                .map(|i| [DVec3::ZERO, DVec3::X, DVec3::Y][i % 3].with_z(if i < 3 { -1.0 } else { 1.0 }))
                .collect(),
            Domain::Cube => (0..8)
                .map(|i| DVec3::new(SQUARE[i % 4][0], SQUARE[i % 4][1], if i < 4 { -1.0 } else { 1.0 }))
                .collect(),
        };
        let middles: Vec<DVec3> = kind.edges().iter().map(|&[i, j]| 0.5 * (at[i] + at[j])).collect();
        at.extend(middles);
        if kind == ElementKind::Quad9 {
            at.push(DVec3::ZERO);
        }
        at
    }

    #[test]
    fn shape_functions_are_one_at_their_node_and_sum_to_one() {
        let inside = [DVec3::new(0.21, 0.34, 0.17), DVec3::new(0.05, 0.4, 0.3), DVec3::new(0.6, 0.1, 0.05)];
        for kind in ElementKind::ALL {
            let at = nodes(kind);
            assert_eq!(at.len(), kind.n_nodes(), "{kind:?}");
            for (i, &x) in at.iter().enumerate() {
                let f = kind.shape(x);
                for j in 0..kind.n_nodes() {
                    let expect = if i == j { 1.0 } else { 0.0 };
                    assert!((f.n[j] - expect).abs() < 1e-14, "{kind:?} node {i} function {j}: {}", f.n[j]);
                }
            }
            for x in inside {
                let f = kind.shape(x);
                assert!((f.n.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{kind:?}");
                assert!(f.n.iter().zip(kind.weights(x)).all(|(a, b)| (a - b).abs() < 1e-15), "{kind:?}");
                let h = 1e-6;
                for (k, step) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
                    if k == 2 && kind.dimension() == 2 {
                        continue;
                    }
                    let (a, b) = (kind.shape(x - h * step), kind.shape(x + h * step));
                    for j in 0..kind.n_nodes() {
                        let difference = (b.n[j] - a.n[j]) / (2.0 * h);
                        assert!((difference - f.d[j][k]).abs() < 1e-8, "{kind:?} {j} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn faces_close_and_look_outwards() {
        for kind in ElementKind::ALL.into_iter().filter(|k| k.dimension() == 3) {
            let at = if kind.domain() == Domain::Pyramid {
                let mut base = nodes(kind);
                base[4] = DVec3::Z;
                base
            } else {
                nodes(kind)
            };
            let n = kind.n_corners() as f64;
            let middle = at[..kind.n_corners()].iter().copied().sum::<DVec3>() / n;
            let mut total = DVec3::ZERO;
            for face in kind.faces() {
                let mut normal = DVec3::ZERO;
                for i in 0..face.len() {
                    normal += 0.5 * at[face[i]].cross(at[face[(i + 1) % face.len()]]);
                }
                assert!(normal.dot(at[face[0]] - middle) > 0.0, "{kind:?} {face:?}");
                total += normal;
            }
            assert!(total.length() < 1e-12, "{kind:?}");
        }
    }

    #[test]
    fn clamping_stays_and_is_nearest() {
        for kind in ElementKind::ALL {
            for i in 0..1000u32 {
                let x = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) * 0.4 - 1.5;
                let c = kind.clamped(x);
                assert!(kind.outside(c) <= 1e-15, "{kind:?} {x} -> {c}");
                assert!((kind.clamped(c) - c).length() < 1e-15, "{kind:?}");
            }
        }
        // Against a search.
        for i in 0..200u32 {
            let x =
                DVec3::new(f64::from(i * 7 % 11), f64::from(i * 5 % 13), f64::from(i * 3 % 17)) * 0.2 - 1.0;
            let best = (x - ElementKind::Tet4.clamped(x)).length();
            for k in 0..1000u32 {
                let q = DVec3::new(f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)) / 9.0;
                if q.x + q.y + q.z <= 1.0 {
                    assert!((x - q).length() > best - 1e-12, "{x} {q}");
                }
            }
        }
    }
}
