//! Affine maps of 3MF components and build items.

use grainpath_core::DVec3;

/// An affine map as 3MF writes it: the row vector `(x y z 1)` times a 4 x 3 matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform([f64; 12]);

impl Transform {
    pub(super) const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);

    pub(super) fn parse(text: &[u8]) -> Option<Self> {
        let mut m = [0.0; 12];
        let mut words = text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        for value in &mut m {
            *value = grainpath_core::number::number(words.next()?).filter(|v| v.is_finite())?;
        }
        // More than twelve numbers are an error, as fewer are.
        words.next().is_none().then_some(Self(m))
    }

    pub(super) fn apply(&self, p: DVec3) -> DVec3 {
        let m = &self.0;
        let row = |k: usize| DVec3::new(m[k], m[k + 1], m[k + 2]);
        row(0) * p.x + row(3) * p.y + row(6) * p.z + row(9)
    }

    /// The map that applies `self` first and `after` second.
    pub(super) fn then(&self, after: &Self) -> Self {
        // The first three rows are directions, which are not translated.
        let linear = Self({
            let mut m = after.0;
            m[9..].fill(0.0);
            m
        });
        let row = |k: usize| DVec3::new(self.0[k], self.0[k + 1], self.0[k + 2]);
        let rows = [linear.apply(row(0)), linear.apply(row(3)), linear.apply(row(6)), after.apply(row(9))];
        let mut m = [0.0; 12];
        for (to, from) in m.chunks_exact_mut(3).zip(rows) {
            to.copy_from_slice(&from.to_array());
        }
        Self(m)
    }

    /// Whether the map turns shapes into their mirror images.
    pub(super) fn mirrors(&self) -> bool {
        self.determinant() < 0.0
    }

    /// Whether the map flattens every shape: its volume becomes zero.
    pub(super) fn is_singular(&self) -> bool {
        let lengths = self.0[..9].chunks_exact(3).map(|r| DVec3::new(r[0], r[1], r[2]).length());
        // Rounding gives a flat map a determinant slightly off zero, so the determinant is compared with the product of the
        // row lengths.
        self.determinant().abs() <= 1e-12 * lengths.product::<f64>()
    }

    fn determinant(&self) -> f64 {
        let m = &self.0;
        let row = |k: usize| DVec3::new(m[k], m[k + 1], m[k + 2]);
        row(0).dot(row(3).cross(row(6)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_follow_one_another() {
        let shift = Transform::parse(b"1 0 0 0 1 0 0 0 1 10 20 30").expect("12 numbers");
        let turn = Transform::parse(b"0 1 0 -1 0 0 0 0 1 0 0 0").expect("12 numbers");
        assert_eq!(shift.then(&turn).apply(DVec3::X), turn.apply(shift.apply(DVec3::X)));
        assert_eq!(turn.apply(DVec3::X), DVec3::Y);
        let mirror = Transform::parse(b"-1 0 0 0 1 0 0 0 1 0 0 0").expect("12 numbers");
        assert!(mirror.mirrors() && !turn.mirrors());
        assert_eq!(Transform::parse(b"1 2 3"), None);
    }
}
