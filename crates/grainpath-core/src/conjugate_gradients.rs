//! Conjugate gradients for a symmetric positive definite operator, given only by its product with a vector.
//!
//! The method of Hestenes and Stiefel (1952, `hestenes1952` in docs/references.bib) with a
//! preconditioner; with [`CgSettings::flexible`] the direction follows Polak and Ribière's formula,
//! which stays conjugate if the preconditioner changes a little from step to step (Notay 2000,
//! `notay2000`). A step costs one operator product, one preconditioning, two dot products and three
//! vector updates; the memory is four vectors.
//!
//! Sums run in a fixed order for any number of threads, so the same system gives the same bits. The
//! residual is updated in each step and never recomputed from `x`: below about 1e-12 of the right side
//! it is smaller than the true residual. If a search direction has zero or negative stiffness, the run
//! ends with [`CgEnd::NotPositive`]; `x` keeps the values found so far.

use glam::DVec3;

use crate::lanes;

/// The type of an unknown: a number or a small vector.
pub trait CgValue: Copy + Send + Sync {
    /// Zero.
    const ZERO: Self;

    /// The dot product of two vectors, summed in a fixed order.
    fn dot(a: &[Self], b: &[Self]) -> f64;

    /// `self + factor * other`.
    fn plus(self, factor: f64, other: Self) -> Self;

    /// Adds `factor` times `x` to `y`.
    fn add_scaled(y: &mut [Self], factor: f64, x: &[Self]) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = y.plus(factor, *x));
    }

    /// Multiplies `y` by `factor` and adds `x`.
    fn scale_and_add(y: &mut [Self], factor: f64, x: &[Self]) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = x.plus(factor, *y));
    }
}

impl CgValue for f64 {
    const ZERO: Self = 0.0;

    fn dot(a: &[Self], b: &[Self]) -> f64 {
        lanes::dot_f64(a, b)
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        self + factor * other
    }

    fn add_scaled(y: &mut [Self], factor: f64, x: &[Self]) {
        lanes::add_scaled_f64(y, factor, x);
    }

    fn scale_and_add(y: &mut [Self], factor: f64, x: &[Self]) {
        lanes::scale_and_add_f64(y, factor, x);
    }
}

impl CgValue for f32 {
    const ZERO: Self = 0.0;

    fn dot(a: &[Self], b: &[Self]) -> f64 {
        lanes::dot_f32(a, b)
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        self + factor as Self * other
    }

    fn add_scaled(y: &mut [Self], factor: f64, x: &[Self]) {
        lanes::add_scaled_f32(y, factor as Self, x);
    }

    fn scale_and_add(y: &mut [Self], factor: f64, x: &[Self]) {
        lanes::scale_and_add_f32(y, factor as Self, x);
    }
}

/// Products are rounded to `f32` before they are summed in `f64`.
impl<const N: usize> CgValue for [f32; N] {
    const ZERO: Self = [0.0; N];

    fn dot(a: &[Self], b: &[Self]) -> f64 {
        let mut sums = [0.0; 8];
        let ((a, a_rest), (b, b_rest)) =
            (a.as_flattened().as_chunks::<8>(), b.as_flattened().as_chunks::<8>());
        for (a, b) in a.iter().zip(b) {
            (0..8).for_each(|k| sums[k] += f64::from(a[k] * b[k]));
        }
        let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| f64::from(a * b)).sum();
        sums.iter().sum::<f64>() + rest
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        let factor = factor as f32;
        std::array::from_fn(|k| self[k] + factor * other[k])
    }
}

impl CgValue for DVec3 {
    const ZERO: Self = Self::ZERO;

    fn dot(a: &[Self], b: &[Self]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        self + factor * other
    }
}

/// A linear system, given by its operator product. A closure that computes this product is a system without a
/// preconditioner.
pub trait CgSystem<T> {
    /// Whether [`CgSystem::precondition`] does more than copy.
    const PRECONDITIONED: bool = false;

    /// Puts the operator's product with `x` into `out`.
    fn apply(&self, x: &[T], out: &mut [T]);

    /// Puts an approximate solution for the right side `residual` into `out`; called only if
    /// [`CgSystem::PRECONDITIONED`] is true.
    fn precondition(&self, residual: &[T], out: &mut [T])
    where
        T: Copy,
    {
        out.copy_from_slice(residual);
    }

    /// Whether to stop; called before every step.
    fn cancelled(&self) -> bool {
        false
    }
}

impl<T, F: Fn(&[T], &mut [T])> CgSystem<T> for F {
    fn apply(&self, x: &[T], out: &mut [T]) {
        self(x, out);
    }
}

/// The measure that decides whether the solution is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CgGoal {
    /// The length of the residual, in the unit of the right side.
    Residual(f64),
    /// The residual times the preconditioned residual.
    Energy(f64),
}

/// When to stop, and which formula gives the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CgSettings {
    /// The measure of the error and its limit: the iteration ends when the measure is at or below the limit.
    pub goal: CgGoal,
    /// Largest number of steps.
    pub max_steps: usize,
    /// Whether the preconditioner changes from step to step.
    pub flexible: bool,
}

impl CgSettings {
    /// Settings that end when the residual is at most `tolerance` times as long as the right side.
    pub fn relative<T: CgValue>(right_side: &[T], tolerance: f64, max_steps: usize) -> Self {
        let length = T::dot(right_side, right_side).sqrt();
        Self { goal: CgGoal::Residual(tolerance * length), max_steps, flexible: false }
    }
}

/// Why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CgEnd {
    /// The goal is reached.
    Converged,
    /// The number of steps is used up.
    MaxSteps,
    /// The operator is not positive definite, or a value is not finite.
    NotPositive,
    /// [`CgSystem::cancelled`] returned true.
    Cancelled,
}

/// Solves for the right side `b`, starting from the values in `x`. Returns the number of steps
/// and the reason why the iteration ended.
///
/// ```
/// use grainpath_core::conjugate_gradients::{CgEnd, CgGoal, CgSettings, conjugate_gradients};
///
/// // A chain of springs between two walls: 2 on the diagonal, -1 beside it.
/// let chain = |x: &[f64], out: &mut [f64]| {
///     for i in 0..x.len() {
///         let beside = |k: Option<usize>| k.and_then(|k| x.get(k)).copied().unwrap_or(0.0);
///         out[i] = 2.0 * x[i] - beside(i.checked_sub(1)) - beside(Some(i + 1));
///     }
/// };
/// let mut x = vec![0.0; 5];
/// let settings = CgSettings { goal: CgGoal::Residual(1e-12), max_steps: 10, flexible: false };
/// let (steps, end) = conjugate_gradients(&chain, &[1.0; 5], &mut x, settings);
/// assert_eq!(end, CgEnd::Converged);
/// assert!(steps <= 3, "as many as there are different eigenvalues in play");
/// assert!((x[2] - 4.5).abs() < 1e-9);
/// ```
pub fn conjugate_gradients<T: CgValue, S: CgSystem<T>>(
    system: &S,
    b: &[T],
    x: &mut [T],
    settings: CgSettings,
) -> (usize, CgEnd) {
    let n = x.len();
    let mut image = vec![T::ZERO; n];
    system.apply(x, &mut image);
    let mut residual: Vec<T> = b.iter().zip(&image).map(|(b, q)| b.plus(-1.0, *q)).collect();
    let mut better = if S::PRECONDITIONED { vec![T::ZERO; n] } else { Vec::new() };
    let mut direction = vec![T::ZERO; n];
    let mut before = if settings.flexible { vec![T::ZERO; n] } else { Vec::new() };
    let mut energy = 1.0;
    for step in 0..=settings.max_steps {
        let mut now = match settings.goal {
            CgGoal::Energy(_) if S::PRECONDITIONED => f64::INFINITY,
            _ => T::dot(&residual, &residual),
        };
        if matches!(settings.goal, CgGoal::Residual(goal) if now <= goal * goal) {
            return (step, CgEnd::Converged);
        }
        if S::PRECONDITIONED {
            // The residual is preconditioned before the second test, because the energy goal needs it.
            system.precondition(&residual, &mut better);
            now = T::dot(&residual, &better);
        }
        let better = if S::PRECONDITIONED { &better } else { &residual };
        if matches!(settings.goal, CgGoal::Energy(goal) if now <= goal) {
            return (step, CgEnd::Converged);
        }
        if step == settings.max_steps {
            break;
        }
        if system.cancelled() {
            return (step, CgEnd::Cancelled);
        }
        // Fletcher and Reeves' formula, or Polak and Ribiere's if the preconditioner changes: the latter
        // subtracts the product of the old residual with the new preconditioned residual.
        let share = match (step, settings.flexible) {
            (0, _) => 0.0,
            (_, false) => now / energy,
            (_, true) => (now - T::dot(&before, better)) / energy,
        };
        energy = now;
        T::scale_and_add(&mut direction, share, better);
        system.apply(&direction, &mut image);
        let stiffness = T::dot(&direction, &image);
        // With zero stiffness the operator does not resist this direction, for instance a rigid body
        // motion.
        if stiffness.is_nan() || stiffness <= 0.0 || !energy.is_finite() {
            return (step, CgEnd::NotPositive);
        }
        let length = energy / stiffness;
        if settings.flexible {
            before.copy_from_slice(&residual);
        }
        T::add_scaled(x, length, &direction);
        T::add_scaled(&mut residual, -length, &image);
    }
    (settings.max_steps, CgEnd::MaxSteps)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// A second difference whose diagonal varies by a factor of a million, optionally preconditioned by it.
    struct Uneven {
        n: usize,
        preconditioned: bool,
        calls: Cell<usize>,
        most_calls: usize,
    }

    impl Uneven {
        fn new(preconditioned: bool) -> Self {
            Self { n: 60, preconditioned, calls: Cell::new(0), most_calls: usize::MAX }
        }

        fn scale(&self, i: usize) -> f64 {
            crate::math::pow(1e6, i as f64 / self.n as f64)
        }
    }

    impl CgSystem<f64> for Uneven {
        const PRECONDITIONED: bool = true;

        fn apply(&self, x: &[f64], out: &mut [f64]) {
            self.calls.set(self.calls.get() + 1);
            for i in 0..self.n {
                let scaled = |k: usize| x[k] * self.scale(k).sqrt();
                let left = if i > 0 { scaled(i - 1) } else { 0.0 };
                let right = if i + 1 < self.n { scaled(i + 1) } else { 0.0 };
                out[i] = (2.1 * scaled(i) - left - right) * self.scale(i).sqrt();
            }
        }

        fn precondition(&self, residual: &[f64], out: &mut [f64]) {
            for i in 0..self.n {
                out[i] = residual[i] / if self.preconditioned { self.scale(i) } else { 1.0 };
            }
        }

        fn cancelled(&self) -> bool {
            self.calls.get() > self.most_calls
        }
    }

    #[test]
    fn a_preconditioner_saves_steps_and_both_formulas_agree() {
        let b: Vec<f64> = (0..60).map(|i| f64::from(i % 7) - 2.0).collect();
        let settings = CgSettings { goal: CgGoal::Residual(1e-9), max_steps: 2000, flexible: false };
        let solve = |preconditioned: bool, flexible: bool| {
            let mut x = vec![0.0; 60];
            let system = Uneven::new(preconditioned);
            let (steps, end) = conjugate_gradients(&system, &b, &mut x, CgSettings { flexible, ..settings });
            assert_eq!(end, CgEnd::Converged);
            (steps, x)
        };
        let ((plain, x), (better, y), (flexible, z)) =
            (solve(false, false), solve(true, false), solve(true, true));
        assert!(better * 2 < plain, "{better} steps with and {plain} without");
        assert!(better.abs_diff(flexible) <= 2, "{better} {flexible}");
        let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off(&x, &y) < 1e-6 && off(&y, &z) < 1e-6);
    }

    #[test]
    fn it_ends_when_it_must() {
        let b = vec![1.0; 60];
        let settings = CgSettings { goal: CgGoal::Energy(1e-20), max_steps: 3, flexible: false };
        let mut x = vec![0.0; 60];
        assert_eq!(conjugate_gradients(&Uneven::new(true), &b, &mut x, settings), (3, CgEnd::MaxSteps));
        let stopped = Uneven { most_calls: 2, ..Uneven::new(true) };
        let (_, end) = conjugate_gradients(&stopped, &b, &mut x, CgSettings { max_steps: 99, ..settings });
        assert_eq!((end, stopped.calls.get()), (CgEnd::Cancelled, 3));
        let mut nan = vec![f64::NAN; 60];
        let (_, end) = conjugate_gradients(&Uneven::new(true), &b, &mut nan, settings);
        assert_eq!(end, CgEnd::NotPositive);
        // Zero is the solution of zero.
        let mut zero = vec![0.0; 60];
        let (steps, end) = conjugate_gradients(&Uneven::new(true), &zero.clone(), &mut zero, settings);
        assert_eq!((steps, end), (0, CgEnd::Converged));
    }
}
