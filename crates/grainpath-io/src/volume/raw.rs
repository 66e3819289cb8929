//! Consecutive voxels, plain or compressed, as NRRD, MetaImage, NIfTI and raw files hold them after their
//! headers.

use grainpath_core::{Warning, WarningId};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use super::{
    Files, SampleType, SliceError, SliceSource, VolumeError, VolumeInfo, VolumeProblem, check_size, damaged,
    error, io_error, sample,
};

/// Header values of a file that has no header, given by the user.
#[derive(Debug, Clone, PartialEq)]
pub struct RawHeader {
    /// Columns, rows, slices.
    pub size: [usize; 3],
    /// Type of a voxel.
    pub sample: SampleType,
    /// Most significant byte first.
    pub big_endian: bool,
    /// Bytes before the first voxel.
    pub offset_bytes: u64,
}

/// Largest number of bytes that Deflate can unpack from one byte. A header that asks for more is damaged or malicious.
/// Source: a match of 258 bytes takes at least two bits, one each for length and distance (RFC 1951), so 8 bits give up to
/// 1032 bytes.
const MAX_DEFLATE_RATIO: u64 = 1032;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    None,
    Gzip,
    Zlib,
}

/// Place of the voxels in their file, and their type.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// The file with the voxels.
    pub file: String,
    /// Bytes before the voxels; unpacked bytes if `inside`.
    pub offset: u64,
    /// Whether `offset` counts unpacked bytes.
    pub inside: bool,
    pub packing: Packing,
    pub big_endian: bool,
    /// Slope and intercept: value = slope * stored + intercept.
    pub scale: (f32, f32),
}

pub(super) struct RawSource {
    info: VolumeInfo,
    files: Files,
    layout: Layout,
    stream: Stream,
    next: usize,
    buffer: Vec<u8>,
}

enum Stream {
    Plain(BufReader<Box<dyn super::ReadSeek>>),
    Packed(Box<dyn BufRead + Send>),
}

impl Stream {
    fn reader(&mut self) -> &mut dyn Read {
        match self {
            Self::Plain(r) => r,
            Self::Packed(r) => r,
        }
    }
}

pub(super) fn open(files: &Files, name: &str, header: &RawHeader) -> Result<RawSource, VolumeError> {
    let info = VolumeInfo::new("raw", header.size, header.sample);
    let layout = Layout {
        file: name.to_owned(),
        offset: header.offset_bytes,
        inside: false,
        packing: Packing::None,
        big_endian: header.big_endian,
        scale: (1.0, 0.0),
    };
    RawSource::new(files, info, layout)
}

impl RawSource {
    pub(super) fn new(files: &Files, info: VolumeInfo, layout: Layout) -> Result<Self, VolumeError> {
        check_size(&layout.file, info.size)?;
        let stream = start(files, &layout)?;
        let mut source = Self { info, files: files.clone(), layout, stream, next: 0, buffer: Vec::new() };
        source.check_length()?;
        Ok(source)
    }

    /// Checks that the file can hold the voxels, before any work is done.
    fn check_length(&mut self) -> Result<(), VolumeError> {
        let needed = (self.slice_bytes() as u64).saturating_mul(self.info.size[2] as u64);
        let (file, offset) = (&self.layout.file, self.layout.offset);
        let (size, sample) = (self.info.size, self.info.sample);
        let Stream::Plain(r) = &mut self.stream else {
            let mut packed = self.files.open(file)?;
            let length = packed.seek(SeekFrom::End(0)).map_err(|e| io_error(file, &e))?;
            let before = if self.layout.inside { offset } else { 0 };
            // The length of a packed stream is unknown, but Deflate has a largest ratio.
            if before.saturating_add(needed) > length.saturating_mul(MAX_DEFLATE_RATIO) {
                return Err(error(file, VolumeProblem::CannotHold { size, sample, needed, length }));
            }
            return Ok(());
        };
        let end = r.seek(SeekFrom::End(0)).map_err(|e| io_error(file, &e))?;
        r.seek(SeekFrom::Start(offset)).map_err(|e| io_error(file, &e))?;
        if end < offset.saturating_add(needed) {
            return Err(error(file, VolumeProblem::TooShort { size, sample, needed, offset, length: end }));
        }
        // More bytes than voxels often mean a wrong size or type in the header, so the user is told.
        if end > offset.saturating_add(needed) {
            let more = end - offset - needed;
            let text = format!("{more} bytes after the last voxel are not read");
            let warning = Warning::new(WarningId::ScanTrailingBytes, text).in_file(file.to_owned());
            self.info.warnings.push(warning);
        }
        Ok(())
    }

    fn slice_bytes(&self) -> usize {
        self.info.size[0] * self.info.size[1] * self.info.sample.n_bytes()
    }

    fn cut_short(&self) -> VolumeError {
        let (slice, n_slices) = (self.next + 1, self.info.size[2]);
        error(&self.layout.file, VolumeProblem::EndsInSlice { slice, n_slices })
    }
}

fn start(files: &Files, layout: &Layout) -> Result<Stream, VolumeError> {
    let file = &layout.file;
    let mut reader = files.open(file)?;
    if !layout.inside {
        reader.seek(SeekFrom::Start(layout.offset)).map_err(|e| io_error(file, &e))?;
    }
    let mut stream = match layout.packing {
        Packing::None => Stream::Plain(reader),
        Packing::Gzip => Stream::Packed(Box::new(BufReader::new(MultiGzDecoder::new(reader)))),
        Packing::Zlib => Stream::Packed(Box::new(BufReader::new(ZlibDecoder::new(reader)))),
    };
    // A packed stream does not support seeking, so the bytes are inflated and dropped.
    if layout.inside {
        let skipped = std::io::copy(&mut stream.reader().take(layout.offset), &mut std::io::sink());
        skipped.map_err(|e| io_error(file, &e))?;
    }
    Ok(stream)
}

impl SliceSource for RawSource {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.stream = start(&self.files, &self.layout)?;
        self.next = 0;
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        if self.next == self.info.size[2] {
            return Ok(false);
        }
        // Reads in pieces of 1 MiB, so that a header cannot make the program reserve more than the file
        // holds.
        let mut left = self.slice_bytes();
        while left > 0 {
            let n = left.min(1 << 20);
            self.buffer.resize(n, 0);
            if let Err(e) = self.stream.reader().read_exact(&mut self.buffer) {
                return Err(SliceError::from(match e.kind() {
                    std::io::ErrorKind::UnexpectedEof => self.cut_short(),
                    _ => damaged(&self.layout.file, format!("data in slice {}", self.next + 1), e),
                }));
            }
            sample::decode(self.info.sample, &self.buffer, self.layout.big_endian, out);
            left -= n;
        }
        let (slope, intercept) = self.layout.scale;
        // Most files are not scaled and need no second pass over the slice.
        if (slope, intercept) != (1.0, 0.0) {
            out.iter_mut().for_each(|v| *v = *v * slope + intercept);
        }
        self.next += 1;
        Ok(true)
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        if self.next == self.info.size[2] {
            return Ok(false);
        }
        let n = self.slice_bytes() as u64;
        let file = &self.layout.file;
        match &mut self.stream {
            Stream::Plain(r) => {
                r.seek_relative(n as i64).map_err(|e| io_error(file, &e))?;
            }
            Stream::Packed(r) => {
                let passed = std::io::copy(&mut r.take(n), &mut std::io::sink());
                let passed = passed.map_err(|e| io_error(file, &e))?;
                if passed < n {
                    return Err(self.cut_short().into());
                }
            }
        }
        self.next += 1;
        Ok(true)
    }
}
