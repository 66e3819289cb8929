//! Reads a caller's array as a scan.
//!
//! The planner asks for slices; the caller's thread reads a slab of them from any object with `__getitem__`, so that
//! the whole array is never copied and may be larger than the memory.

use std::sync::mpsc::{self, Sender};

use grainpath_core::slices::{SampleType, SliceError, VolumeInfo};
use grainpath_core::{Warning, WarningId};
use grainpath_io::volume::{AnySlice, Finite, InOrder};

use crate::worker::Request;

/// Bytes of the slices in one request. Source: derived: a chunked store reads a slab of this size in about a millisecond,
/// so that the 20 microseconds of a request do not count; and the slab is small beside any scan.
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

/// Properties of a caller's array that another thread may use: columns, rows and slices; voxel type; voxel spacing, mm.
pub(crate) type ArrayShape = ([usize; 3], String, Option<[f64; 3]>);

/// The scan header that describes a caller's array.
pub(crate) fn info_of((size, sample, spacing_mm): &ArrayShape) -> VolumeInfo {
    let sample = SampleType::from_name(sample).unwrap_or(SampleType::F32);
    let mut info = VolumeInfo::new("array", *size, sample);
    info.spacing_mm = spacing_mm.map_or([None; 3], |all| all.map(Some));
    info
}

/// The scan header, with the warning that `n_missing` chunks of the array's store have its fill value. Readers of our own
/// count such chunks while they read; of an array, the Python side has counted them.
pub(crate) fn info_with(shape: &ArrayShape, n_missing: usize) -> VolumeInfo {
    let mut info = info_of(shape);
    if n_missing > 0 {
        let text = format!("{n_missing} chunks of the scan are not there; they have its fill value");
        info.warnings.push(Warning::new(WarningId::ScanChunksMissing, text));
    }
    info
}

/// A scan whose slices the caller's thread reads.
pub(crate) type ArraySource = Finite<InOrder<Slabs>>;

/// A caller's array, of which one slab of slices is in memory.
pub(crate) struct Slabs {
    info: VolumeInfo,
    requests: Sender<Request>,
    slab: Vec<f32>,
    /// Slice with which the slab begins.
    slab_first: usize,
    /// Slices from here on are not read ahead, because the work does not need them.
    end: usize,
}

impl Slabs {
    /// The slices of the array that `info` describes. Those from `end` on are not read ahead.
    pub(crate) fn in_order(info: VolumeInfo, end: usize, requests: Sender<Request>) -> ArraySource {
        let end = end.min(info.size[2]);
        Finite::new(InOrder::new(Self { info, requests, slab: Vec::new(), slab_first: 0, end }))
    }

    fn voxels(&self) -> usize {
        self.info.size[0] * self.info.size[1]
    }

    /// Makes the slab in memory hold slice `k`. If it does not yet, requests the slab that begins with `k`.
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

impl AnySlice for Slabs {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn read_slice(&mut self, k: usize, out: &mut Vec<f32>) -> Result<(), SliceError> {
        self.load(k)?;
        let (n, at) = (self.voxels(), k - self.slab_first);
        out.extend_from_slice(&self.slab[at * n..(at + 1) * n]);
        Ok(())
    }
}
