//! A caller's array as a scan.
//!
//! The planner asks for slices; the caller's thread reads a slab of them from any object with `__getitem__`, so that
//! the whole array is never copied and may be larger than the memory.

use std::sync::mpsc::{self, Sender};

use grainpath_core::slices::{SampleType, SliceCursor, SliceError, SliceSource, VolumeInfo};
use grainpath_io::volume::NotFinite;

use crate::worker::Request;

/// Bytes of the slices that are asked for at a time. Source: derived: a slab of this size takes a chunked store about a
/// millisecond, so that the 20 microseconds of a request do not count; and it is small beside any scan.
const SLAB_BYTES: usize = 8 << 20;

/// The slices of an array were not read; the exception that says why is raised on the caller's thread.
#[derive(Debug)]
struct NotRead;

impl std::fmt::Display for NotRead {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("the array could not be read")
    }
}

impl std::error::Error for NotRead {}

/// A scan whose slices the caller's thread reads.
pub(crate) struct ArraySource {
    info: VolumeInfo,
    requests: Sender<Request>,
    cursor: SliceCursor,
    slab: Vec<f32>,
    /// Slice with which the slab begins.
    slab_first: usize,
    /// Slices from here on are not asked for, where the caller needs none of them.
    end: usize,
    not_finite: NotFinite,
}

impl ArraySource {
    /// A scan of `size` columns, rows and slices, whose voxels lie `spacing_mm` apart along x, y and z.
    pub(crate) fn new(
        size: [usize; 3],
        sample: SampleType,
        spacing_mm: Option<[f64; 3]>,
        requests: Sender<Request>,
    ) -> Self {
        let mut info = VolumeInfo::new("array", size, sample);
        info.spacing_mm = spacing_mm.map_or([None; 3], |all| all.map(Some));
        Self {
            info,
            requests,
            cursor: SliceCursor::new(size[2]),
            slab: Vec::new(),
            slab_first: 0,
            end: size[2],
            not_finite: NotFinite::default(),
        }
    }

    /// The same scan, of which the slices from `end` on are not read ahead.
    pub(crate) fn up_to(self, end: usize) -> Self {
        Self { end: end.min(self.info.size[2]), ..self }
    }

    fn voxels(&self) -> usize {
        self.info.size[0] * self.info.size[1]
    }

    /// The slab that begins with slice `k`, or has it already.
    fn load(&mut self, k: usize) -> Result<(), SliceError> {
        let n = self.voxels();
        if (self.slab_first..self.slab_first + self.slab.len() / n).contains(&k) {
            return Ok(());
        }
        let count = (SLAB_BYTES / (4 * n)).clamp(1, self.end.saturating_sub(k).max(1));
        let (answer, answered) = mpsc::channel();
        let asked = self.requests.send(Request::Slices(k, count, answer));
        let slab = asked.ok().and_then(|()| answered.recv().ok()).filter(|slab| slab.len() == count * n);
        self.slab = slab.ok_or_else(|| SliceError::new(NotRead))?;
        self.slab_first = k;
        Ok(())
    }
}

impl SliceSource for ArraySource {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.cursor.restart();
        self.not_finite.restart();
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let Some(k) = self.cursor.slice() else { return Ok(false) };
        self.load(k)?;
        let (n, at) = (self.voxels(), k - self.slab_first);
        out.extend_from_slice(&self.slab[at * n..(at + 1) * n]);
        self.not_finite.replace_in(out);
        Ok(self.cursor.pass())
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        Ok(self.cursor.pass())
    }

    fn n_not_finite(&self) -> u64 {
        self.not_finite.n_voxels
    }
}
