//! Scans as a sequence of slices: the interface between the readers of volume files and the code
//! that uses their grey values.
//!
//! A [`SliceSource`] hands out one slice after another, so a consumer holds a few slices and never
//! the whole volume. Columns run along x, rows along y, slices along z, all counted from 0. A slice
//! is row-major: the value of column `i` and row `j` is `slice[j * n_columns + i]`. The axes are
//! right-handed: a part cut from the slices is never the mirror image of what was scanned.

use std::error::Error;

use crate::{DMat3, DVec3};

/// The number type of a voxel in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum SampleType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    F32,
    F64,
}

impl SampleType {
    /// The names that [`SampleType::from_name`] accepts.
    pub const NAMES: [&str; 8] = ["u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"];

    /// The type with this name.
    ///
    /// ```
    /// use grainpath_core::slices::SampleType;
    ///
    /// assert_eq!(SampleType::from_name("u16"), Some(SampleType::U16));
    /// assert_eq!(SampleType::from_name("u12"), None);
    /// ```
    pub fn from_name(name: &str) -> Option<Self> {
        use SampleType::{F32, F64, I8, I16, I32, U8, U16, U32};
        let all = [U8, I8, U16, I16, U32, I32, F32, F64];
        Self::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }

    /// The name used in jobs and messages.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Bytes of one voxel.
    pub const fn n_bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// What a file's header states about a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeInfo {
    /// The format's name for people.
    pub format: &'static str,
    /// Columns, rows, slices.
    pub size: [usize; 3],
    /// Number type of a voxel.
    pub sample: SampleType,
    /// Distance between voxel centres in x, y and z, mm; `None` where the file does not state it.
    pub spacing_mm: [Option<f64>; 3],
    /// Heights of the slices where their distances differ, mm, rising from 0; otherwise empty.
    pub z_mm: Vec<f64>,
    /// Position of the voxels in the file's world, if the file states one.
    pub world: Option<WorldFrame>,
    /// Whether the file names grey values that stand for no measurement (padding around a round field of view). Its
    /// voxels count as those that are not finite: [`SliceSource::n_not_finite`].
    pub padded: bool,
    /// How the file stores the voxels, for people: pairs of a property and its value.
    pub stored: Vec<(&'static str, String)>,
    /// Irregularities of the file that were found while it was read, for example uneven spacing.
    pub warnings: Vec<crate::Warning>,
}

/// Position of a volume in the coordinates of the scanner, mm.
///
/// The world is LPS as in DICOM: x to the patient's left, y to the back, z to the head. Files in
/// other worlds (NIfTI is RAS) are converted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldFrame {
    /// The world position of the centre of the first voxel, mm.
    pub origin_mm: DVec3,
    /// The world directions of columns, rows and slices: the columns of a rotation matrix.
    pub axes: DMat3,
}

impl VolumeInfo {
    /// A volume of `size` (columns, rows, slices) without stated spacing.
    ///
    /// ```
    /// use grainpath_core::slices::{SampleType, VolumeInfo};
    ///
    /// let info = VolumeInfo::new("raw", [512, 512, 200], SampleType::U16);
    /// assert_eq!(info.spacing_mm, [None; 3]);
    /// ```
    pub fn new(format: &'static str, size: [usize; 3], sample: SampleType) -> Self {
        Self {
            format,
            size,
            sample,
            spacing_mm: [None; 3],
            z_mm: Vec::new(),
            world: None,
            padded: false,
            stored: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The world position of a voxel's centre, mm; `None` where the file states no world or no
    /// spacing.
    ///
    /// ```
    /// use grainpath_core::slices::{SampleType, VolumeInfo, WorldFrame};
    /// use grainpath_core::{DMat3, DVec3};
    ///
    /// let mut info = VolumeInfo::new("NRRD", [64, 64, 32], SampleType::U16);
    /// info.spacing_mm = [Some(0.5), Some(0.5), Some(2.0)];
    /// info.world = Some(WorldFrame { origin_mm: DVec3::new(-16.0, -16.0, 100.0), axes: DMat3::IDENTITY });
    /// assert_eq!(info.world_mm([2, 0, 3]), Some(DVec3::new(-15.0, -16.0, 106.0)));
    /// ```
    pub fn world_mm(&self, voxel: [usize; 3]) -> Option<DVec3> {
        let world = self.world?;
        let along = |axis: usize| Some(voxel[axis] as f64 * self.spacing_mm[axis]?);
        // Unevenly spaced slices state their heights; the mean spacing would misplace all slices
        // but the first and the last.
        let z_mm = if self.z_mm.is_empty() { along(2)? } else { *self.z_mm.get(voxel[2])? };
        Some(world.origin_mm + world.axes * DVec3::new(along(0)?, along(1)?, z_mm))
    }
}

/// Why a source cannot give its next slice. It wraps the reader's error; its message and its
/// [`Error::source`] are those of that error.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct SliceError(Box<dyn Error + Send + Sync>);

impl SliceError {
    /// Wraps the error of a reader.
    pub fn new(error: impl Error + Send + Sync + 'static) -> Self {
        Self(Box::new(error))
    }

    /// The reader's error, where it is of type `E`.
    pub fn downcast_ref<E: Error + 'static>(&self) -> Option<&E> {
        self.0.downcast_ref()
    }
}

/// A volume that gives one slice after another, starting with the first.
///
/// ```
/// use grainpath_core::slices::{SampleType, SliceError, SliceSource, VolumeInfo};
///
/// /// Two slices of 2 x 1 voxels.
/// struct Ramp {
///     info: VolumeInfo,
///     next: usize,
/// }
///
/// impl SliceSource for Ramp {
///     fn info(&self) -> &VolumeInfo {
///         &self.info
///     }
///     fn restart(&mut self) -> Result<(), SliceError> {
///         self.next = 0;
///         Ok(())
///     }
///     fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
///         out.clear();
///         out.extend([self.next as f32, 10.0]);
///         self.skip_slice()
///     }
///     fn skip_slice(&mut self) -> Result<bool, SliceError> {
///         let more = self.next < self.info.size[2];
///         self.next += usize::from(more);
///         Ok(more)
///     }
/// }
///
/// let mut ramp = Ramp { info: VolumeInfo::new("made up", [2, 1, 2], SampleType::F32), next: 0 };
/// let mut slice = Vec::new();
/// ramp.skip_slice()?;
/// assert!(ramp.next_slice(&mut slice)?);
/// assert_eq!(slice, [1.0, 10.0]);
/// assert!(!ramp.next_slice(&mut slice)?, "there are two slices");
/// # Ok::<(), SliceError>(())
/// ```
pub trait SliceSource: Send {
    /// The header, known before the slices are read.
    fn info(&self) -> &VolumeInfo;

    /// Goes back to the first slice.
    ///
    /// # Errors
    /// [`SliceError`] where a file can no longer be read.
    fn restart(&mut self) -> Result<(), SliceError>;

    /// Puts the next slice into `out`, row-major, and moves on; `false` after the last slice.
    ///
    /// # Errors
    /// [`SliceError`] with the file's name and what is wrong in it.
    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError>;

    /// As [`SliceSource::next_slice`], but voxels that have no grey value of their own are NaN: those that are NaN,
    /// infinite or padding in the file, and those beyond the stored slices where these were moved or turned.
    ///
    /// # Errors
    /// As [`SliceSource::next_slice`].
    fn next_known(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        self.next_slice(out)
    }

    /// Passes over the next slice; `false` after the last slice.
    ///
    /// # Errors
    /// As [`SliceSource::next_slice`].
    fn skip_slice(&mut self) -> Result<bool, SliceError>;

    /// Number of voxels in the slices read since the last restart that are NaN, infinite or padding in the file. Slices
    /// from [`SliceSource::next_slice`] contain only finite values: such voxels get the least grey value of their slice,
    /// which is air.
    fn n_not_finite(&self) -> u64 {
        0
    }

    /// Number of pieces of the volume (chunks) that were read since the last restart, but are not stored in the
    /// files. Their voxels have the fill value that the file states for missing pieces.
    fn n_absent(&self) -> u64 {
        0
    }
}

/// The position in a source that can read its slices in any order: the index of the next slice.
///
/// ```
/// use grainpath_core::slices::SliceCursor;
///
/// let mut cursor = SliceCursor::new(2);
/// assert_eq!(cursor.slice(), Some(0));
/// assert!(cursor.pass() && cursor.pass());
/// assert_eq!(cursor.slice(), None);
/// assert!(!cursor.pass(), "there are two slices");
/// cursor.restart();
/// assert_eq!(cursor.slice(), Some(0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SliceCursor {
    next: usize,
    n_slices: usize,
}

impl SliceCursor {
    /// A cursor in front of the first of `n_slices` slices.
    pub const fn new(n_slices: usize) -> Self {
        Self { next: 0, n_slices }
    }

    /// Goes back to the first slice.
    pub const fn restart(&mut self) {
        self.next = 0;
    }

    /// The next slice; `None` after the last one.
    pub fn slice(&self) -> Option<usize> {
        (self.next < self.n_slices).then_some(self.next)
    }

    /// Passes over the next slice; `false` after the last one.
    pub fn pass(&mut self) -> bool {
        let more = self.next < self.n_slices;
        self.next += usize::from(more);
        more
    }
}

impl<S: SliceSource + ?Sized> SliceSource for &mut S {
    fn info(&self) -> &VolumeInfo {
        (**self).info()
    }
    // A mutable reference to a source is a source too, so that a caller may lend one instead of giving it away.
    fn restart(&mut self) -> Result<(), SliceError> {
        (**self).restart()
    }
    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        (**self).next_slice(out)
    }
    fn next_known(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        (**self).next_known(out)
    }
    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        (**self).skip_slice()
    }
    fn n_not_finite(&self) -> u64 {
        (**self).n_not_finite()
    }
    fn n_absent(&self) -> u64 {
        (**self).n_absent()
    }
}
