//! The loads of a deck's step as forces on its nodes.
//!
//! Pressures on faces and gravity become consistent nodal forces: the integral of the load times the shape function of each
//! node, by Gauss quadrature that is exact for straight elements. Forces on nodes are taken as they are. Moments on nodes
//! are left out, because nodes of solids do not turn. Forces are in the deck's unit.

use grainpath_core::DVec3;

use super::deck::{Behaviour, BodyForce, Deck};
use super::element::ElementKind;
use super::model::{Element, FeError, FeFile, invalid};
use super::problem::FeProblem;

impl FeFile {
    /// Forces on every node in a step of the deck, in the deck's unit of force. Forces on nodes are taken
    /// as they are; pressures, gravity and centrifugal loads are distributed by the shape functions. Moments are left
    /// out, because nodes of solids do not rotate.
    ///
    /// # Errors
    /// No such step, axisymmetric elements, or a plane element without thickness under load.
    pub fn nodal_forces(&self, step: usize) -> Result<Vec<DVec3>, FeError> {
        let deck = self.deck.as_deref();
        let (deck, step) = deck
            .and_then(|d| Some((d, d.steps.get(step)?)))
            .ok_or_else(|| invalid(format!("step {}", step + 1), FeProblem::NoStep))?;
        let mut forces = vec![DVec3::ZERO; self.nodes.len()];
        // Axes 3 to 5 are moments.
        for load in step.point_loads.iter().filter(|l| l.axis < 3) {
            forces[load.node as usize][load.axis as usize] += load.value;
        }
        for load in &step.face_loads {
            let e = &self.elements[load.element as usize];
            let Some((kind, nodes)) = face_of(e, load.face as usize) else { continue };
            // A positive pressure pushes inwards, against the outward normal. An element wound the other
            // way round has its outside on the other side.
            let sign = -load.pressure * self.thickness(deck, load.element)? * self.winding(e);
            for (x, weight) in kind.quadrature() {
                let shape = kind.shape(x);
                let column = |k: usize| {
                    nodes.iter().zip(shape.d).map(|(&i, d)| self.nodes[i as usize] * d[k]).sum::<DVec3>()
                };
                let normal = column(0).cross(column(1));
                for (&i, n) in nodes.iter().zip(shape.n) {
                    forces[i as usize] += sign * weight * n * normal;
                }
            }
        }
        for load in &step.face_loads {
            let e = &self.elements[load.element as usize];
            let Some(nodes) = edge_of(e, load.face as usize) else { continue };
            let sign = -load.pressure * self.thickness(deck, load.element)? * self.winding(e);
            let p = |k: usize| self.nodes[nodes[k] as usize];
            // Gauss-Legendre quadrature with three points on -1..1, exact to degree 5: enough for a
            // quadratic edge.
            let far = 0.6f64.sqrt();
            for (t, weight) in [(-far, 5.0 / 9.0), (0.0, 8.0 / 9.0), (far, 5.0 / 9.0)] {
                let (n, d) = if nodes.len() == 3 {
                    ([0.5 * t * (t - 1.0), 0.5 * t * (t + 1.0), 1.0 - t * t], [t - 0.5, t + 0.5, -2.0 * t])
                } else {
                    ([0.5 * (1.0 - t), 0.5 * (1.0 + t), 0.0], [-0.5, 0.5, 0.0])
                };
                let along = (0..nodes.len()).map(|k| d[k] * p(k)).sum::<DVec3>();
                // The edge is turned by a quarter to the right: outwards for an element numbered
                // counter-clockwise.
                let normal = DVec3::new(along.y, -along.x, 0.0);
                for (k, &i) in nodes.iter().enumerate() {
                    forces[i as usize] += sign * weight * n[k] * normal;
                }
            }
        }
        for load in &step.body_loads {
            let e = &self.elements[load.element as usize];
            let density = deck.section_of(load.element).and_then(|(m, _)| m.density).unwrap_or(0.0);
            // The mass of the element; gravity acts on the mass.
            let size = e.size(&self.nodes) * density * self.thickness(deck, load.element)?;
            // Each Gauss point takes its share of the element's mass. Dividing by the sum of the weights
            // keeps the total mass exact.
            let points = e.kind.quadrature();
            let whole: f64 = points.iter().map(|p| p.1).sum();
            for (x, weight) in points {
                let weights = e.kind.weights(x);
                let acceleration = match load.force {
                    BodyForce::Gravity(a) => DVec3::from(a),
                    BodyForce::Centrifugal { speed_squared, point, axis } => {
                        let p: DVec3 =
                            e.nodes().iter().zip(weights).map(|(&i, w)| self.nodes[i as usize] * w).sum();
                        let axis = DVec3::from(axis).normalize_or_zero();
                        speed_squared * (p - DVec3::from(point)).reject_from_normalized(axis)
                    }
                };
                for (&i, n) in e.nodes().iter().zip(weights) {
                    forces[i as usize] += size * weight / whole * n * acceleration;
                }
            }
        }
        Ok(forces)
    }

    /// Thickness of a plane element; 1 for solids.
    fn thickness(&self, deck: &Deck, element: u32) -> Result<f64, FeError> {
        let place = || format!("element {}", deck.element_numbers[element as usize]);
        match deck.behaviours[element as usize] {
            Behaviour::Solid => Ok(1.0),
            Behaviour::Axisymmetric => Err(FeError::Unsupported {
                what: format!("{}: axisymmetric", place()),
                reads: "plane and solid elements",
            }),
            _ => match deck.section_of(element) {
                // Abaqus and CalculiX take a plane element without a stated thickness as 1 thick.
                Some((_, thickness)) => Ok(thickness.unwrap_or(1.0)),
                None => Err(invalid(place(), FeProblem::NoSection)),
            },
        }
    }

    /// 1 for an element whose nodes have the winding that the format asks for, -1 for the opposite winding.
    pub(super) fn winding(&self, e: &Element) -> f64 {
        let shape = e.kind.shape(e.kind.centre());
        let column = |k: usize| {
            e.nodes().iter().zip(shape.d).map(|(&i, d)| self.nodes[i as usize] * d[k]).sum::<DVec3>()
        };
        let normal = column(0).cross(column(1));
        let size = if e.kind.dimension() == 2 { normal.z } else { normal.dot(column(2)) };
        if size < 0.0 { -1.0 } else { 1.0 }
    }
}

/// The face of a solid as a surface element of its own, seen from outside.
pub(super) fn face_of(e: &Element, face: usize) -> Option<(ElementKind, Vec<u32>)> {
    if e.kind.dimension() != 3 {
        return None;
    }
    let corners = e.kind.faces().get(face)?;
    let n = corners.len();
    let mut nodes: Vec<u32> = corners.iter().map(|&i| e.nodes()[i]).collect();
    // Middle nodes follow the corners, as in every surface element.
    nodes.extend((0..n).filter_map(|i| middle(e, corners[i], corners[(i + 1) % n])));
    let kind = match nodes.len() {
        3 => ElementKind::Tri3,
        4 => ElementKind::Quad4,
        6 => ElementKind::Tri6,
        8 => ElementKind::Quad8,
        _ => return None,
    };
    Some((kind, nodes))
}

/// An edge of a plane element: its ends and, where there is one, its middle.
fn edge_of(e: &Element, edge: usize) -> Option<Vec<u32>> {
    if e.kind.dimension() != 2 {
        return None;
    }
    let &[a, b] = *e.kind.faces().get(edge)? else { return None };
    let mut nodes = vec![e.nodes()[a], e.nodes()[b]];
    nodes.extend(middle(e, a, b));
    Some(nodes)
}

/// The node in the middle of the edge between two corners.
fn middle(e: &Element, a: usize, b: usize) -> Option<u32> {
    let k = e.kind.edges().iter().position(|edge| *edge == [a, b] || *edge == [b, a])?;
    e.nodes().get(e.kind.n_corners() + k).copied()
}
