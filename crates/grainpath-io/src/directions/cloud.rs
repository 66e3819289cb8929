//! Directions at scattered points and at the nodes of meshes.

use grainpath_core::triangulation::delaunay;
use grainpath_core::{DVec2, DVec3};

use super::grid::DirectionGrid;
use super::model::BlendedDirection;
use crate::fe::{Element, ElementKind, FeFormat, FeResult, StressField};

/// The data structure that interpolates the samples at a point.
#[derive(Debug, Clone)]
pub(super) enum Carrier {
    Grid(DirectionGrid),
    /// Planes of points, each with its height in mm, from the lowest up. A single plane applies at all heights.
    Planes(Vec<(f64, Cloud)>),
    /// Points or a mesh in space, or a mesh of a plane.
    Cloud(Box<Cloud>),
}

/// A direction at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub place_mm: DVec3,
    /// Of unit length.
    pub axis: DVec3,
    pub strength: f64,
    pub spacing_mm: f64,
}

/// Points with the tensors of their directions, joined by elements or loose.
#[derive(Debug, Clone)]
pub(super) struct Cloud {
    tensors: StressField,
    /// Bead spacings, where the samples state them. The first component of the stress holds the spacing.
    spacings: Option<StressField>,
    /// The nodes that have a direction. They serve elements whose nodes all have none.
    known: Option<StressField>,
}

/// Where heights have fewer points than this on average, the points are taken as points in space. Source: derived: a plane
/// of fewer than eight points says less about the field than the eight nearest points in space.
const MIN_POINTS_PER_PLANE: usize = 8;

impl Carrier {
    pub(super) fn is_plane(&self) -> bool {
        match self {
            Self::Grid(_) => true,
            Self::Planes(planes) => planes.len() == 1,
            Self::Cloud(cloud) => cloud.tensors.result().plane,
        }
    }

    pub(super) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        match self {
            Self::Grid(grid) => grid.bounds(),
            Self::Planes(planes) => {
                let all = planes.iter().filter_map(|(_, cloud)| cloud.tensors.result().bounds());
                all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            }
            Self::Cloud(cloud) => cloud.tensors.result().bounds(),
        }
    }

    pub(super) fn sample(&self, p: DVec3) -> BlendedDirection {
        match self {
            Self::Grid(grid) => grid.sample(p),
            Self::Cloud(cloud) => cloud.sample(p),
            Self::Planes(planes) => {
                let above = planes.partition_point(|(z, _)| *z <= p.z);
                let last = planes.len() - 1;
                let (low, high) = (&planes[above.saturating_sub(1).min(last)], &planes[above.min(last)]);
                let below = low.1.sample(p);
                if high.0 <= low.0 {
                    return below;
                }
                let (over, t) = (high.1.sample(p), ((p.z - low.0) / (high.0 - low.0)).clamp(0.0, 1.0));
                let mix = |a: f64, b: f64| a + t * (b - a);
                let mut tensor = below.tensor;
                tensor.iter_mut().zip(over.tensor).for_each(|(a, b)| *a = mix(*a, b));
                let spacing_mm = below.spacing_mm.zip(over.spacing_mm).map(|(a, b)| mix(a, b));
                BlendedDirection { tensor, spacing_mm }
            }
        }
    }
}

/// Points as planes of triangles, or as points in space where their heights hardly repeat. There is
/// at least one sample.
pub(super) fn of_points(mut samples: Vec<Sample>, has_spacing: bool) -> Carrier {
    samples.sort_by(|a, b| {
        let (p, q) = (a.place_mm, b.place_mm);
        p.z.total_cmp(&q.z).then(p.x.total_cmp(&q.x)).then(p.y.total_cmp(&q.y))
    });
    let n_heights = samples.chunk_by(|a, b| a.place_mm.z == b.place_mm.z).count();
    if n_heights > 1 && samples.len() < MIN_POINTS_PER_PLANE * n_heights {
        let cloud = Cloud::new(merged(&samples), Vec::new(), has_spacing, false);
        return Carrier::Cloud(Box::new(cloud));
    }
    let plane = |all: &[Sample]| {
        let nodes = merged(all);
        let points: Vec<DVec2> = nodes.iter().map(|n| n.place_mm.truncate()).collect();
        let triangle = |t: [u32; 3]| Element::new(ElementKind::Tri3, &t);
        let elements = delaunay(&points).into_iter().filter_map(triangle).collect();
        (all[0].place_mm.z, Cloud::new(nodes, elements, has_spacing, true))
    };
    Carrier::Planes(samples.chunk_by(|a, b| a.place_mm.z == b.place_mm.z).map(plane).collect())
}

/// A node with the tensor of all its samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub place_mm: DVec3,
    pub tensor: [f64; 6],
    pub spacing_mm: f64,
}

/// Samples at one place become one node with their mean. The samples are sorted.
fn merged(samples: &[Sample]) -> Vec<Node> {
    let node = |group: &[Sample]| {
        let share = 1.0 / group.len() as f64;
        let mut node = Node { place_mm: group[0].place_mm, tensor: [0.0; 6], spacing_mm: 0.0 };
        for s in group {
            let tensor = tensor(s.axis, s.strength);
            node.tensor.iter_mut().zip(tensor).for_each(|(to, v)| *to += share * v);
            node.spacing_mm += share * s.spacing_mm;
        }
        node
    };
    samples.chunk_by(|a, b| a.place_mm == b.place_mm).map(node).collect()
}

/// `strength * d d^T`, components xx, yy, zz, xy, yz, zx.
pub(super) fn tensor(d: DVec3, strength: f64) -> [f64; 6] {
    [d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.z * d.x].map(|v| strength * v)
}

impl Cloud {
    /// Nodes, and elements over them if there are any. Nodes of a mesh may have a tensor of zero:
    /// no direction.
    pub(super) fn new(nodes: Vec<Node>, elements: Vec<Element>, has_spacing: bool, plane: bool) -> Self {
        let field = |nodes: &[Node], elements: Vec<Element>, value: &dyn Fn(&Node) -> [f64; 6]| {
            StressField::new(FeResult {
                format: FeFormat::Csv,
                nodes: nodes.iter().map(|n| n.place_mm).collect(),
                elements,
                stress: nodes.iter().map(value).collect(),
                displacement: None,
                plane,
                stress_array: String::new(),
                warnings: Vec::new(),
            })
        };
        let known: Vec<Node> = nodes.iter().copied().filter(|n| n.tensor != [0.0; 6]).collect();
        let known = (known.len() < nodes.len()).then(|| field(&known, Vec::new(), &|n| n.tensor));
        let spacing = |n: &Node| [n.spacing_mm, 0.0, 0.0, 0.0, 0.0, 0.0];
        let spacings = has_spacing.then(|| field(&nodes, elements.clone(), &spacing));
        Self { tensors: field(&nodes, elements, &|n| n.tensor), spacings, known }
    }

    fn sample(&self, p: DVec3) -> BlendedDirection {
        let mut tensor = self.tensors.sample(p);
        if let Some(known) = self.known.as_ref().filter(|_| tensor.iter().all(|v| v.abs() < 1e-9)) {
            // The nearest nodes with a direction give it here, with a strength that is almost zero.
            tensor = known.sample(p).map(|v| 1e-6 * v);
        }
        BlendedDirection { tensor, spacing_mm: self.spacings.as_ref().map(|s| s.sample(p)[0]) }
    }
}
