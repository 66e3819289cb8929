"""Writes the DICOM files of this folder, which `tests/dicom.rs` reads.

    make.py [FOLDER]

Needs numpy, pydicom, imagecodecs (libjpeg-turbo, CharLS, OpenJPEG) and pylibjpeg with pylibjpeg-openjpeg and
pylibjpeg-libjpeg. The volume is made here: a disc with a hole and a gradient, of 7 frames of 21 x 13 pixels, with noise of a
fixed seed. Every file holds it with another transfer syntax. `X-truth.dcm` is uncompressed and has the voxels that X must
give: those that were packed where packing is lossless, otherwise those that the codec's own library unpacks.
"""

import sys
from pathlib import Path

import imagecodecs
import numpy as np
from pydicom import dcmread
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.uid import UID

FOLDER = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent)
N, H, W = 7, 13, 21
EXPLICIT = "1.2.840.10008.1.2.1"


def volume(bits, signed):
    z, y, x = np.mgrid[:N, :H, :W]
    r = np.hypot(x - 10.3, y - 6.1)
    solid = (r < 6.2) & (r > 1.5 + 0.2 * z)
    noise = np.random.default_rng(7).normal(0, 0.01, (N, H, W))
    # Flat air with a flat border gives runs, the gradient gives every context.
    grey = np.where(solid, 0.5 + 0.03 * x - 0.02 * y + noise, 0.0)
    grey[:, :, -3:] += np.where(np.arange(N) % 2, 0.01 + noise.std(), 0.0)[:, None, None]
    top = (1 << bits) - 1
    v = np.clip(np.round(grey * top), 0, top).astype(np.int64)
    return (v - (1 << (bits - 1))).astype(f"i{1 if bits <= 8 else 2}") if signed else v.astype(f"u{1 if bits <= 8 else 2}")


def write(name, syntax, pixels, voxels, stored, high=None, frames=None, photometric="MONOCHROME2"):
    d = Dataset()
    d.file_meta = FileMetaDataset()
    d.file_meta.TransferSyntaxUID = UID(syntax)
    d.file_meta.MediaStorageSOPClassUID = UID("1.2.840.10008.5.1.4.1.1.7.3")
    d.file_meta.MediaStorageSOPInstanceUID = UID("1.2.3.4")
    d.SOPClassUID, d.SOPInstanceUID = d.file_meta.MediaStorageSOPClassUID, d.file_meta.MediaStorageSOPInstanceUID
    d.SeriesInstanceUID = "1.2.3"
    d.SamplesPerPixel, d.PhotometricInterpretation = 1, photometric
    d.NumberOfFrames, d.Rows, d.Columns = frames or N, H, W
    d.PixelSpacing, d.SliceThickness = [0.5, 0.5], 0.6
    d.BitsAllocated, d.BitsStored = 8 * voxels.dtype.itemsize, stored
    d.HighBit = stored - 1 if high is None else high
    d.PixelRepresentation = int(voxels.dtype.kind == "i")
    d.PixelData = pixels
    d["PixelData"].VR = "OB" if syntax != EXPLICIT else "OW"
    if syntax != EXPLICIT:
        d["PixelData"].is_undefined_length = True
    d.save_as(FOLDER / f"{name}.dcm", enforce_file_format=True)


def packed(name, syntax, voxels, stored, encode, fragments=1, table=True, lossless=True, decode=None, **more):
    frames = [encode(k, frame) for k, frame in enumerate(voxels)]
    write(name, syntax, encapsulate(frames, fragments_per_frame=fragments, has_bot=table), voxels, stored, **more)
    if lossless:
        truth = voxels
    elif decode:
        truth = np.stack([decode(f) for f in frames])
    if decode or not lossless:
        write(f"{name}-truth", EXPLICIT, truth.astype(voxels.dtype).tobytes(), voxels, stored)
    back = dcmread(FOLDER / f"{name}.dcm").pixel_array
    # libjpeg, through which pydicom reads JPEG, rounds otherwise than libjpeg-turbo.
    off = np.abs(back.astype(int) - truth).max()
    assert off <= (0 if lossless else 2), f"{name}: pydicom reads something else, by up to {off}"
    print(f"{name}: {sum(map(len, frames))} bytes, {off} off pydicom, {np.abs(truth.astype(int) - voxels).max()} off what was packed")


def unsigned(frame):
    return frame.view(frame.dtype.str.replace("i", "u"))


u12, i16, u8, u16 = volume(12, False), volume(16, True), volume(8, False), volume(16, False)
i12 = volume(12, True)
for name, voxels, stored in [("u8", u8, 8), ("u12", u12, 12), ("u16", u16, 16), ("i16", i16, 16)]:
    write(f"{name}-truth", EXPLICIT, voxels.tobytes(), voxels, stored)
# Signed values of 12 bits, two bits up, with other bits about them.
write("i12-truth", EXPLICIT, i12.tobytes(), i12, 16)
dirt = np.random.default_rng(3).integers(0, 1 << 16, i12.shape, dtype=np.uint16) & 0xC003
write("i12", EXPLICIT, ((i12.view("u2") << 2 & 0x3FFC) | dirt).tobytes(), i12, 12, high=13)

BASELINE, EXTENDED = "1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.51"
LOSSLESS, DEFAULT = "1.2.840.10008.1.2.4.57", "1.2.840.10008.1.2.4.70"
LS, NEAR = "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.81"
J2K, LOSSY = "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91"


def rle(frame):
    """Segments for each byte, the high one first (PS3.5, annex G), with literal runs and repeats."""
    planes = [unsigned(frame).astype(">u2").view("u1").reshape(-1, 2)[:, k] for k in (0, 1)]
    out = []
    for plane in planes:
        body, i = bytearray(), 0
        while i < len(plane):
            n = 1
            while i + n < len(plane) and n < 128 and plane[i + n] == plane[i]:
                n += 1
            body += bytes([257 - n, plane[i]]) if n > 1 else bytes([0, plane[i]])
            i += n
        out.append(bytes(body) + b"\0" * (len(body) % 2))
    header = np.zeros(16, "<u4")
    header[:3] = 2, 64, 64 + len(out[0])
    return header.tobytes() + out[0] + out[1]


packed("i16-rle", "1.2.840.10008.1.2.5", i16, 16, lambda k, f: rle(f))
packed("u8-jpeg", BASELINE, u8, 8, lambda k, f: imagecodecs.jpeg8_encode(f, level=90), lossless=False, decode=imagecodecs.jpeg8_decode)
packed("u12-jpeg", EXTENDED, u12, 12, lambda k, f: imagecodecs.jpeg8_encode(f, level=95, bitspersample=12), lossless=False, decode=imagecodecs.jpeg8_decode)
# Every predictor once.
packed("u12-lossless", LOSSLESS, u12, 12, lambda k, f: imagecodecs.jpeg8_encode(f, lossless=True, predictor=k + 1, bitspersample=12))
packed("i16-lossless", DEFAULT, i16, 16, lambda k, f: imagecodecs.jpeg8_encode(unsigned(f), lossless=True, predictor=1, bitspersample=16))
packed("u12-ls", LS, u12, 12, lambda k, f: imagecodecs.jpegls_encode(f), fragments=3)
packed("u16-ls", LS, u16, 16, lambda k, f: imagecodecs.jpegls_encode(f), fragments=2, table=False)
packed("i16-ls", LS, i16, 16, lambda k, f: imagecodecs.jpegls_encode(unsigned(f)))
packed("u8-near", NEAR, u8, 8, lambda k, f: imagecodecs.jpegls_encode(f, level=2), lossless=False, decode=imagecodecs.jpegls_decode)
packed("u12-near", NEAR, u12, 12, lambda k, f: imagecodecs.jpegls_encode(f, level=3), lossless=False, decode=imagecodecs.jpegls_decode)
j2k = lambda f, **more: imagecodecs.jpeg2k_encode(f, codecformat="J2K", **more)
packed("u12-2000", J2K, u12, 12, lambda k, f: j2k(f, reversible=True, bitspersample=12), fragments=2)
packed("i16-2000", J2K, i16, 16, lambda k, f: j2k(f, reversible=True))
packed("u16-2000", LOSSY, u16, 16, lambda k, f: j2k(f, level=60), lossless=False, decode=imagecodecs.jpeg2k_decode)
packed("inverted", LS, u8, 8, lambda k, f: imagecodecs.jpegls_encode(f), photometric="MONOCHROME1")
