//! Gives voxels that have no grey value of their own that of air, and counts them.
//!
//! Readers hand out what the file holds, NaN and infinite values among it, and NaN for padding. Here, behind all that moves
//! slices and exchanges their axes, these values become air: the least grey value of their slice, because 0 is water in
//! Hounsfield units and would add material. So each is counted in the slice that shows it, from whichever side the stack
//! is seen.
//!
//! Slices without any grey value get the least value so far. Where none came before them, the slices behind them are
//! searched for it, and those before are then read again; this happens once. Cost: a pass over each slice, and at most one
//! more reading of the volume.

use grainpath_core::slices::{SliceError, SliceSource, VolumeInfo};

use super::resliced::OUTSIDE;

/// A source whose slices are finite.
pub struct Finite<S> {
    source: S,
    /// Whether the source marks voxels beyond the stored slices with [`OUTSIDE`].
    marks_outside: bool,
    n_voxels: u64,
    /// The least grey value of the slices read so far.
    least: Option<f32>,
    /// For each slice since the last restart, whether it was read or passed over.
    was_read: Vec<bool>,
    has_searched: bool,
}

impl<S: SliceSource> Finite<S> {
    /// Makes the slices of `source` finite, which stands before its first slice.
    pub fn new(source: S) -> Self {
        Self {
            source,
            marks_outside: false,
            n_voxels: 0,
            least: None,
            was_read: Vec::new(),
            has_searched: false,
        }
    }

    /// The same for slices that were moved, with [`OUTSIDE`] beyond their borders.
    pub(super) fn of_moved(source: S) -> Self {
        Self { marks_outside: true, ..Self::new(source) }
    }

    /// The least grey value of a slice, which is kept if none before was less.
    fn learn(&mut self, slice: &[f32]) -> Option<f32> {
        let least = slice.iter().copied().filter(|v| v.is_finite()).reduce(f32::min);
        self.least = self.least.into_iter().chain(least).reduce(f32::min);
        least
    }

    /// Reads the next slice with NaN for voxels without a value: whether there was one, and its least grey value.
    fn read(&mut self, out: &mut Vec<f32>) -> Result<(bool, Option<f32>), SliceError> {
        if !self.source.next_slice(out)? {
            return Ok((false, None));
        }
        self.was_read.push(true);
        for v in out.iter_mut().filter(|v| !v.is_finite()) {
            self.n_voxels += u64::from(!(self.marks_outside && *v == OUTSIDE));
            *v = f32::NAN;
        }
        Ok((true, self.learn(out)))
    }

    /// Searches the slices that follow for a grey value, and then reads again what was read before.
    fn search(&mut self) -> Result<(), SliceError> {
        self.has_searched = true;
        let mut slice = Vec::new();
        while self.least.is_none() && self.source.next_slice(&mut slice)? {
            self.learn(&slice);
        }
        self.source.restart()?;
        // Reading again, and not passing over, keeps the number of missing chunks right.
        for &was_read in &self.was_read {
            if was_read {
                self.source.next_slice(&mut slice)?;
            } else {
                self.source.skip_slice()?;
            }
        }
        Ok(())
    }
}

impl<S: SliceSource> SliceSource for Finite<S> {
    fn info(&self) -> &VolumeInfo {
        self.source.info()
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.n_voxels = 0;
        self.was_read.clear();
        self.source.restart()
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        let (more, least) = self.read(out)?;
        if more && self.least.is_none() && !self.has_searched {
            self.search()?;
        }
        let air = least.or(self.least).unwrap_or(0.0);
        out.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = air);
        Ok(more)
    }

    fn next_known(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        Ok(self.read(out)?.0)
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        let more = self.source.skip_slice()?;
        if more {
            self.was_read.push(false);
        }
        Ok(more)
    }

    fn n_not_finite(&self) -> u64 {
        self.n_voxels
    }

    fn n_absent(&self) -> u64 {
        self.source.n_absent()
    }
}
