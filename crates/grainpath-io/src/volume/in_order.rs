//! Reads slices in order from a volume that can read any slice at the same cost.
//!
//! Files of one slice each, chunks, and an array from the caller give a slice by its number. This module adds what all of
//! them share: it tracks the next slice, and resets on a restart. Slices may hold NaN and infinite values, which
//! [`Finite`](super::Finite) replaces.

use grainpath_core::slices::{SliceCursor, SliceError, SliceSource, VolumeInfo};

/// A volume that can read any of its slices at the same cost.
pub trait AnySlice: Send {
    /// The header.
    fn info(&self) -> &VolumeInfo;

    /// Appends slice `k`, counted from 0, to `out`, which is empty. Values may be NaN or infinite.
    ///
    /// # Errors
    /// [`SliceError`] with what could not be read.
    fn read_slice(&mut self, k: usize, out: &mut Vec<f32>) -> Result<(), SliceError>;

    /// Number of pieces requested since the last [`AnySlice::forget`] that are missing in the files.
    fn n_absent(&self) -> u64 {
        0
    }

    /// Called before the slices are read again from the first; resets the counts.
    fn forget(&mut self) {}
}

/// A source whose slices come from an [`AnySlice`].
pub struct InOrder<V> {
    volume: V,
    cursor: SliceCursor,
}

impl<V: AnySlice> InOrder<V> {
    /// Starts before the first slice of `volume`.
    pub fn new(volume: V) -> Self {
        let cursor = SliceCursor::new(volume.info().size[2]);
        Self { volume, cursor }
    }
}

impl<V: AnySlice> SliceSource for InOrder<V> {
    fn info(&self) -> &VolumeInfo {
        self.volume.info()
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.cursor.restart();
        self.volume.forget();
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let Some(k) = self.cursor.slice() else { return Ok(false) };
        self.volume.read_slice(k, out)?;
        Ok(self.cursor.pass())
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        Ok(self.cursor.pass())
    }

    fn n_absent(&self) -> u64 {
        self.volume.n_absent()
    }
}
