//! Reads slices in order from a volume that can read any slice at the same cost.
//!
//! Files of one slice each, chunks, and an array from the caller give a slice by its number. This module adds what all of
//! them share: it tracks the next slice, resets on a restart, and replaces and counts NaN or infinite voxels.

use grainpath_core::slices::{SliceCursor, SliceError, SliceSource, VolumeInfo};

use super::sample::NotFinite;

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
    not_finite: NotFinite,
    /// Whether slices without a finite value were followed by a search for one that has some.
    looked_ahead: bool,
}

impl<V: AnySlice> InOrder<V> {
    /// Starts before the first slice of `volume`.
    pub fn new(volume: V) -> Self {
        let cursor = SliceCursor::new(volume.info().size[2]);
        Self { volume, cursor, not_finite: NotFinite::default(), looked_ahead: false }
    }

    /// Finds the grey value of air for slices of padding that come before the first slice with grey values. Reads at most
    /// all slices, once.
    fn look_ahead(&mut self, k: usize) -> Result<(), SliceError> {
        self.looked_ahead = true;
        let mut slice = Vec::new();
        for later in k + 1..self.volume.info().size[2] {
            slice.clear();
            self.volume.read_slice(later, &mut slice)?;
            self.not_finite.learn(&slice);
            if self.not_finite.knows_air() {
                break;
            }
        }
        Ok(())
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
        // Only formats that state padding read any slice alone; chunks of a Zarr would be unpacked and counted twice.
        let searches = self.volume.info().padded && !self.looked_ahead && !self.not_finite.knows_air();
        if searches && out.iter().all(|v| !v.is_finite()) {
            self.look_ahead(k)?;
        }
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
