//! The parts that JPEG and JPEG-LS share: segments after markers, the header of the frame, bits between markers.
//!
//! Source: ITU-T T.81, annex B (markers, segments) and F.2.2.5 (bytes after 0xff); ITU-T T.87, annex C (bits after
//! 0xff).
//! Both formats are read forward only, each byte once.

use super::unpacked::Fault;

/// Markers that both formats use.
pub(super) mod marker {
    // Source: ITU-T T.81, table B.1.
    pub(in super::super) const START: u8 = 0xd8;
    // Source: ITU-T T.81, table B.1.
    pub(in super::super) const END: u8 = 0xd9;
    // Source: ITU-T T.81, table B.1.
    pub(in super::super) const SCAN: u8 = 0xda;
    // Source: ITU-T T.81, table B.1.
    pub(in super::super) const RESTART_INTERVAL: u8 = 0xdd;
    // The first of eight restart markers, which are used in turn.
    // Source: ITU-T T.81, table B.1.
    pub(in super::super) const RESTART: u8 = 0xd0;
}

/// The segments of a stream, one after another.
pub(super) struct Segments<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Segments<'a> {
    /// Starts after the marker that begins a picture.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, Fault> {
        if bytes.get(..2) != Some(&[0xff, marker::START]) {
            return Err("they do not begin with a picture".into());
        }
        Ok(Self { bytes, at: 2 })
    }

    /// The next marker, and the content of its segment without the two bytes of the length.
    pub(super) fn segment(&mut self) -> Result<(u8, &'a [u8]), Fault> {
        let missing = || Fault::from("they end before the picture");
        let rest = &self.bytes[self.at..];
        if rest.first().is_some_and(|b| *b != 0xff) {
            return Err("bytes between two segments".into());
        }
        // Any number of bytes 0xff may stand before a marker (T.81, B.1.1.2).
        let n_fill = rest.iter().take_while(|b| **b == 0xff).count();
        let (&marker, rest) = rest[n_fill..].split_first().ok_or_else(missing)?;
        if marker == marker::END {
            return Err(missing());
        }
        let length = usize::from(word(rest, 0).ok_or_else(missing)?);
        let content = rest.get(2..length).ok_or_else(missing)?;
        self.at += n_fill + 1 + length;
        Ok((marker, content))
    }

    /// The bytes that follow the last segment.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }
}

/// The 16-bit number at byte `at`, most significant byte first.
pub(super) fn word(bytes: &[u8], at: usize) -> Option<u16> {
    let b = bytes.get(at..at + 2)?.try_into().ok()?;
    Some(u16::from_be_bytes(b))
}

/// The header of a picture of one component.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header {
    /// Bits of a pixel.
    pub(super) bits: u32,
    /// Number of the quantisation table.
    pub(super) table: u8,
}

/// Reads the header (T.81, B.2.2) of a picture. It must state `size`, in pixels, columns first.
pub(super) fn header(content: &[u8], size: [usize; 2]) -> Result<Header, Fault> {
    let &[bits, _, _, _, _, n_components, ref components @ ..] = content else {
        return Err("a header cut short".into());
    };
    let stated = [3, 1].map(|at| usize::from(word(content, at).unwrap_or(0)));
    if stated != size {
        let [w, h] = stated;
        return Err(format!(
            "a picture of {w} x {h} pixels, where the file states {} x {}",
            size[0], size[1]
        )
        .into());
    }
    if n_components != 1 {
        return Err(Fault::Unsupported(format!("{n_components} components; slices of grey values have one")));
    }
    let &[_, _, table] = components else { return Err("a header cut short".into()) };
    Ok(Header { bits: u32::from(bits), table })
}

/// Bits of a scan, the highest of a byte first. `STUFFED_BIT` says how a data byte 0xff is told from a marker. If it is
/// true (JPEG-LS), the next byte begins with an extra bit 0; otherwise (JPEG) an extra byte 0 follows.
pub(super) struct Bits<'a, const STUFFED_BIT: bool> {
    bytes: &'a [u8],
    at: usize,
    /// Bits that are not yet taken; the next one is the highest bit.
    window: u64,
    /// Number of bits in the window.
    n_bits: u32,
    /// Number of zero bits that were put into the window after the last bit of the stream, taken or not.
    n_padding: u32,
    /// Whether the byte before was 0xff, so that this one begins with the extra bit.
    after_ff: bool,
}

impl<'a, const STUFFED_BIT: bool> Bits<'a, STUFFED_BIT> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, window: 0, n_bits: 0, n_padding: 0, after_ff: false }
    }

    /// Fills the window to 57 bits or more.
    fn fill(&mut self) {
        while self.n_bits <= 56 {
            let next = self.bytes.get(self.at + 1).copied().unwrap_or(0xff);
            let (byte, n, step) = match self.bytes.get(self.at) {
                Some(&b) if self.after_ff => (b, 7, 1),
                Some(0xff) if STUFFED_BIT && next < 0x80 => (0xff, 8, 1),
                Some(0xff) if !STUFFED_BIT && next == 0 => (0xff, 8, 2),
                Some(&b) if b != 0xff => (b, 8, 1),
                _ => (0, 8, 0),
            };
            self.after_ff = STUFFED_BIT && step == 1 && byte == 0xff && !self.after_ff;
            self.n_padding += if step == 0 { n } else { 0 };
            self.at += step;
            self.window |= u64::from(byte) << (64 - n) >> self.n_bits;
            self.n_bits += n;
        }
    }

    /// The next 16 bits, without taking them.
    pub(super) fn peek_16(&mut self) -> usize {
        if self.n_bits < 16 {
            self.fill();
        }
        (self.window >> 48) as usize
    }

    pub(super) fn skip(&mut self, n: u32) {
        self.window <<= n;
        self.n_bits -= n;
    }

    /// The next `n` bits, at most 32.
    pub(super) fn take(&mut self, n: u32) -> u32 {
        if self.n_bits < n {
            self.fill();
        }
        // Rust does not allow a shift by all 64 bits, so it is done in two steps.
        let value = (self.window >> 1 >> (63 - n)) as u32;
        self.skip(n);
        value
    }

    /// Takes the zeros before the next 1, and the 1. Returns the number of zeros, or `None` if there are more than
    /// `most`, which must be below 56.
    pub(super) fn zeros(&mut self, most: u32) -> Option<u32> {
        self.fill();
        let n = self.window.leading_zeros();
        if n > most {
            return None;
        }
        self.skip(n + 1);
        Some(n)
    }

    /// Whether more bits were taken than the stream holds: some of the padding is then gone from the window.
    pub(super) fn ended(&self) -> bool {
        self.n_bits < self.n_padding
    }

    /// Continues after the restart marker with this number, counted modulo 8.
    pub(super) fn restart(&mut self, number: usize) -> Result<(), Fault> {
        self.fill();
        let rest = &self.bytes[self.at..];
        let n_fill = rest.iter().take_while(|b| **b == 0xff).count();
        let found = rest.get(n_fill).copied();
        if n_fill == 0 || found != Some(marker::RESTART + (number % 8) as u8) {
            return Err("no restart marker where one is due".into());
        }
        *self = Self { at: self.at + n_fill + 1, ..Self::new(self.bytes) };
        Ok(())
    }
}
