//! Placement: a mesh in millimetres, rotated and standing on the plate.

use grainpath_core::math::{direction, rotated};
use grainpath_core::units::LengthUnit;
use grainpath_core::{DMat3, DVec2, DVec3, TriMesh};

use super::ShapeError;

/// Unit, scale and rotation of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The unit its coordinates are in.
    pub unit: LengthUnit,
    /// Further factor on all lengths.
    pub scale: f64,
    /// Rotations about X, then Y, then Z, radians.
    pub rotate_rad: [f64; 3],
}

/// Where a part stands: the transformation from the coordinates of its file, in mm, to those of the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// Factor on all lengths.
    pub scale: f64,
    /// The rotation.
    pub rotation: DMat3,
    /// Height by which the turned part is lowered onto the plate, mm.
    pub lowered_mm: f64,
}

impl Standing {
    /// The transformation that scales a part, turns it about x, then y, then z, and lowers it.
    pub fn new(scale: f64, rotate_rad: [f64; 3], lowered_mm: f64) -> Self {
        let [x, y, z] = rotate_rad.map(direction);
        let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.x, x.y), DVec3::new(0.0, -x.y, x.x));
        let about_y = DMat3::from_cols(DVec3::new(y.x, 0.0, -y.y), DVec3::Y, DVec3::new(y.y, 0.0, y.x));
        let about_z = DMat3::from_cols(DVec3::new(z.x, z.y, 0.0), DVec3::new(-z.y, z.x, 0.0), DVec3::Z);
        Self { scale, rotation: about_z * about_y * about_x, lowered_mm }
    }

    /// Whether the part has the same size and rotation as in its file.
    pub fn is_as_in_file(&self) -> bool {
        self.scale == 1.0 && self.rotation == DMat3::IDENTITY
    }

    /// Unit vector in the plane of the layers along which the X axis of the file lies, or its Y axis where X stands upright:
    /// grids along it turn with the part.
    pub fn plan_axis(&self) -> DVec2 {
        // Of the two, one lies at least half in the plane.
        let [x, y] = [self.rotation.x_axis, self.rotation.y_axis].map(DVec3::truncate);
        if x.length_squared() >= 0.5 { x } else { y }.normalize_or(DVec2::X)
    }

    /// The shift after scale and rotation, mm.
    pub fn shift(&self) -> DVec3 {
        DVec3::new(0.0, 0.0, -self.lowered_mm)
    }
}

/// Size above which a part is taken for a damaged file, mm.
/// Source: chosen; ten times the longest axis of large-format FDM printers (1 m).
const MAX_SIZE_MM: f64 = 10_000.0;

/// Scales and rotates bodies and moves them together down to z = 0. Returned is the height they
/// were lowered by, mm. X and Y stay as in the file.
///
/// # Errors
/// [`ShapeError::Empty`], or [`ShapeError::TooLarge`] beyond 10 m.
pub fn place(bodies: &mut [TriMesh], placement: &Placement) -> Result<f64, ShapeError> {
    let factor = placement.unit.mm() * placement.scale;
    let turns = placement.rotate_rad.map(direction);
    for p in bodies.iter_mut().flat_map(|b| &mut b.vertices) {
        let mut v = *p * factor;
        // A rotation by zero is skipped, so that coordinates of an unrotated part keep their bits.
        if placement.rotate_rad[0] != 0.0 {
            let q = rotated(DVec2::new(v.y, v.z), turns[0]);
            v = DVec3::new(v.x, q.x, q.y);
        }
        if placement.rotate_rad[1] != 0.0 {
            let q = rotated(DVec2::new(v.z, v.x), turns[1]);
            v = DVec3::new(q.y, v.y, q.x);
        }
        if placement.rotate_rad[2] != 0.0 {
            v = rotated(v.truncate(), turns[2]).extend(v.z);
        }
        *p = v;
    }
    // One shift for all bodies: they keep their positions relative to each other.
    let bounds = bodies.iter().filter_map(TriMesh::bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = bounds.ok_or(ShapeError::Empty)?;
    let size_mm = (high - low).max_element();
    if size_mm > MAX_SIZE_MM {
        return Err(ShapeError::TooLarge { size_mm, limit_mm: MAX_SIZE_MM });
    }
    bodies.iter_mut().flat_map(|b| &mut b.vertices).for_each(|p| p.z -= low.z);
    Ok(low.z)
}

/// The likely unit of a mesh, judged by its longest extent in the file's numbers: printed things
/// are between a centimetre and a metre long.
pub fn likely_unit(longest: f64) -> LengthUnit {
    // A part of 0.6 mm is unlikely and a part of 0.6 m is likely, so smaller numbers are taken for
    // metres. Numbers from 0.6 to 8 are taken for inches, which makes 15 to 200 mm.
    if longest < 0.6 {
        LengthUnit::Metre
    } else if longest < 8.0 {
        LengthUnit::Inch
    } else {
        LengthUnit::Millimetre
    }
}

/// The unit that is assumed for a mesh whose file states none: the likely one where mm is out of the question.
pub fn assumed_unit(longest: f64) -> LengthUnit {
    // A part of less than 0.6 mm is about a bead wide and cannot be meant. Parts of 0.6 to 8 mm are
    // printed, so numbers of that size stay mm although inches are likely.
    match likely_unit(longest) {
        LengthUnit::Metre => LengthUnit::Metre,
        _ => LengthUnit::Millimetre,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_scaled_and_on_the_plate() {
        let vertices = vec![DVec3::new(0.0, 0.0, 5.0), DVec3::new(1.0, 0.0, 5.0), DVec3::new(0.0, 0.0, 7.0)];
        let mut bodies = [TriMesh { vertices, triangles: vec![[0, 1, 2]] }];
        let quarter = std::f64::consts::FRAC_PI_2;
        let placement = Placement { unit: LengthUnit::Inch, scale: 2.0, rotate_rad: [0.0, quarter, 0.0] };
        place(&mut bodies, &placement).expect("small enough");
        let (low, high) = bodies[0].bounds().expect("a triangle");
        assert!(low.z.abs() < 1e-12 && (high.z - 50.8).abs() < 1e-9, "{low} {high}");
        assert!((high.x - low.x - 101.6).abs() < 1e-9);
        // The same way as a matrix.
        let standing = Standing::new(2.0, [0.3, quarter, -1.1], 0.0);
        let p = DVec3::new(1.0, 2.0, 3.0);
        let mut one = [TriMesh { vertices: vec![p, p + 1.0, p * 2.0], triangles: vec![[0, 1, 2]] }];
        let lowered_mm = place(
            &mut one,
            &Placement { unit: LengthUnit::Millimetre, scale: 2.0, rotate_rad: [0.3, quarter, -1.1] },
        );
        let shift = Standing { lowered_mm: lowered_mm.expect("small"), ..standing }.shift();
        assert!((standing.rotation * (2.0 * p) + shift).distance(one[0].vertices[0]) < 1e-12);
        bodies[0].vertices[1].x = 1e6;
        assert!(matches!(place(&mut bodies, &placement), Err(ShapeError::TooLarge { .. })));
    }
}
