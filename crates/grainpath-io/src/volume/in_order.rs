//! Slices in their order, from a volume that gives any of them at the same cost.
//!
//! Files of one slice each, chunks and a caller's array are reached by the slice's number. Which slice is next, what a
//! restart resets, and that voxels which are NaN or infinite are replaced and counted, is the same for all of them.

use grainpath_core::slices::{SliceCursor, SliceError, SliceSource, VolumeInfo};

use super::sample::NotFinite;

/// A volume that gives any of its slices at the same cost.
pub trait AnySlice: Send {
    /// The header.
    fn info(&self) -> &VolumeInfo;

    /// Appends slice `k`, counted from 0, to `out`, which is empty. Values may be NaN or infinite.
    ///
    /// # Errors
    /// [`SliceError`] with what could not be read.
    fn read_slice(&mut self, k: usize, out: &mut Vec<f32>) -> Result<(), SliceError>;

    /// Number of pieces that were asked for since the last [`AnySlice::forget`] and that the files do not hold.
    fn n_absent(&self) -> u64 {
        0
    }

    /// Called where the slices begin again: counts start anew.
    fn forget(&mut self) {}
}

/// A source whose slices come from an [`AnySlice`].
pub struct InOrder<V> {
    volume: V,
    cursor: SliceCursor,
    not_finite: NotFinite,
}

impl<V: AnySlice> InOrder<V> {
    /// Before the first slice of `volume`.
    pub fn new(volume: V) -> Self {
        let cursor = SliceCursor::new(volume.info().size[2]);
        Self { volume, cursor, not_finite: NotFinite::default() }
    }
}

impl<V: AnySlice> SliceSource for InOrder<V> {
    fn info(&self) -> &VolumeInfo {
        self.volume.info()
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.cursor.restart();
        self.not_finite.restart();
        self.volume.forget();
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let Some(k) = self.cursor.slice() else { return Ok(false) };
        self.volume.read_slice(k, out)?;
        self.not_finite.replace_in(out);
        Ok(self.cursor.pass())
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        Ok(self.cursor.pass())
    }

    fn n_not_finite(&self) -> u64 {
        self.not_finite.n_voxels
    }

    fn n_absent(&self) -> u64 {
        self.volume.n_absent()
    }
}
