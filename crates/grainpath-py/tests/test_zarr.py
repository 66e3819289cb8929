"""Scans in Zarr by their path: the reader of the command line, held against stores that zarr-python writes."""

import json
import shutil

import numpy as np
import pytest

import grainpath as gp
from test_dask import CHUNKINGS, SETTINGS, SPACING, bone
from test_omezarr import ome
from test_plan import command_line

zarr = pytest.importorskip("zarr")
codecs = pytest.importorskip("zarr.codecs")

# What zarr-python warns of its own codecs is no error of ours.
pytestmark = pytest.mark.filterwarnings("default")

#: The sizes of voxels that a plain array does not state.
SIZES = {"shape__ct__pixel_mm": SPACING[1], "shape__ct__slice_mm": SPACING[0]}


@pytest.fixture(scope="module")
def scan():
    return bone()


def planned(path, **more):
    return gp.Job(shape__ct__path=str(path), **{**SETTINGS, **SIZES, **more}).plan()


@pytest.fixture(scope="module")
def expected(scan):
    return gp.Job(gp.Volume(scan, spacing=SPACING), **SETTINGS).plan().to_gcode()


@pytest.mark.parametrize("chunking", CHUNKINGS)
def test_bytes_are_those_of_nrrd_and_of_a_cluster(chunking, scan, expected, tmp_path):
    """One job file and the command line; the same voxels as NRRD; and `plan_zarr` on a worker."""
    array = zarr.create_array(tmp_path / "scan.zarr", shape=scan.shape, dtype="u1", chunks=CHUNKINGS[chunking])
    array[...] = scan
    planes, rows, columns = scan.shape
    header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {columns} {rows} {planes}\nencoding: raw\n\n"
    (tmp_path / "scan.nrrd").write_bytes(header.encode() + scan.tobytes())
    sets = [f"--set={key.replace('__', '.')}={value}" for key, value in {**SETTINGS, **SIZES}.items()]
    for name in ("scan.zarr", "scan.nrrd"):
        (tmp_path / "job.toml").write_text(f'[shape]\nct = "{name}"\n[output]\ngcode = "{name}.gcode"\n')
        ran = command_line("run", tmp_path / "job.toml", *sets)
        assert ran.returncode == 0, ran.stderr
        assert (tmp_path / f"{name}.gcode").read_bytes() == expected, name
    plan = gp.dask.plan_zarr(tmp_path / "scan.zarr", gp.Job(**SETTINGS), workers=1, spacing=SPACING)
    assert plan.to_gcode() == expected


BLOSC = [(name, shuffle) for name in ("lz4", "zstd", "zlib", "blosclz", "lz4hc") for shuffle in ("shuffle", "bitshuffle", "noshuffle")]


@pytest.mark.parametrize("dtype", ["u1", "u2", ">i2", "f4", "f8"])
@pytest.mark.parametrize(
    "compressor",
    [None, codecs.ZstdCodec(level=5), codecs.ZstdCodec(level=1, checksum=True), codecs.GzipCodec(level=4)]
    + [codecs.BloscCodec(cname=name, shuffle=shuffle) for name, shuffle in BLOSC],
    ids=lambda c: "none" if c is None else json.dumps(c.to_dict()["configuration"]),
)
def test_every_codec_and_type(dtype, compressor, scan, expected, tmp_path):
    kind = np.dtype(dtype)
    serializer = codecs.BytesCodec(endian="big" if kind.byteorder == ">" else "little")
    array = zarr.create_array(
        tmp_path / "scan.zarr",
        shape=scan.shape,
        dtype=kind.newbyteorder("="),
        chunks=(11, 33, 40),
        compressors=None if compressor is None else [compressor],
        serializer=serializer,
    )
    array[...] = scan
    assert planned(tmp_path / "scan.zarr").to_gcode() == expected


@pytest.mark.parametrize("checked", [True, False])
@pytest.mark.parametrize("place", ["start", "end"])
def test_shards(checked, place, scan, expected, tmp_path):
    index = [codecs.BytesCodec()] + ([codecs.Crc32cCodec()] if checked else [])
    inner = [codecs.TransposeCodec(order=(2, 0, 1)), codecs.BytesCodec(), codecs.ZstdCodec(), codecs.Crc32cCodec()]
    shards = codecs.ShardingCodec(chunk_shape=(4, 20, 35), codecs=inner, index_codecs=index, index_location=place)
    array = zarr.create_array(
        tmp_path / "scan.zarr", shape=scan.shape, dtype="u2", chunks=(12, 40, 70), serializer=shards, compressors=None
    )
    array[...] = scan
    assert planned(tmp_path / "scan.zarr").to_gcode() == expected


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("separator", [".", "/"])
def test_version_2(order, separator, scan, expected, tmp_path):
    numcodecs = pytest.importorskip("numcodecs")
    for k, compressor in enumerate([numcodecs.Blosc("lz4"), numcodecs.Zlib(3), numcodecs.LZ4(), numcodecs.GZip(2), numcodecs.Zstd(3)]):
        path = tmp_path / f"{k}.zarr"
        array = zarr.create_array(
            path,
            shape=scan.shape,
            dtype=">u2",
            chunks=(9, 60, 31),
            order=order,
            zarr_format=2,
            compressors=[compressor],
            chunk_key_encoding={"name": "v2", "separator": separator},
        )
        array[...] = scan
        assert planned(path).to_gcode() == expected, compressor


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_images_and_their_levels(version, scan, tmp_path):
    path = ome(tmp_path / "scan.ome.zarr", scan, version, level_scale=(250.0, 300.0, 300.0))
    for level, data in enumerate((scan, scan[:, ::2, ::2])):
        spacing = (0.25, 0.3 * 2**level, 0.3 * 2**level)
        of_array = gp.Job(gp.Volume(data, spacing=spacing), **SETTINGS).plan().to_gcode()
        of_level = path if level == 0 else path / str(level)
        assert gp.Job(shape__ct__path=str(of_level), **SETTINGS).plan().to_gcode() == of_array
        assert gp.Job(gp.read_zarr(path, level=level), **SETTINGS).plan().to_gcode() == of_array
    told = gp.inspect(path)
    assert told["format"] == f"OME-Zarr {version}" and told["voxels"] == [70, 60, 44] and told["sample"] == "u8"
    assert told["spacing_mm"] == [0.3, 0.3, 0.25] and told["stored"]["unit"] == "micrometer"
    assert told["stored"]["levels"] == "2 (0, 1); level 0 is read"
    assert ("in shards of" in told["stored"]["chunks"]) == (version == "0.5")


def test_the_first_channel_is_read_and_told(scan, tmp_path):
    both = np.stack([scan, np.zeros_like(scan)])[None]
    path = ome(tmp_path / "a.zarr", both, "0.5", before="tc", level_scale=(250.0, 300.0, 300.0))
    plan = gp.Job(shape__ct__path=str(path), **SETTINGS).plan()
    assert plan.to_gcode() == gp.Job(gp.read_zarr(path), **SETTINGS).plan().to_gcode()
    assert [w.text for w in plan.warnings if w.id == "scan-first-entry"] == ["axis 1 c has 2 entries; the first is read"]


def test_missing_and_damaged_chunks(scan, tmp_path):
    array = zarr.create_array(tmp_path / "a.zarr", shape=scan.shape, dtype="u1", chunks=(11, 60, 70))
    array[...] = scan
    file = tmp_path / "a.zarr/c/2/0/0"
    kept = file.read_bytes()
    file.unlink()
    plan = planned(tmp_path / "a.zarr")
    holed = scan.copy()
    holed[22:33] = 0
    assert plan.to_gcode() == gp.Job(gp.Volume(holed, spacing=SPACING), **SETTINGS).plan().to_gcode()
    assert [w.text for w in plan.warnings if w.id == "scan-chunks-missing"] == ["1 chunks of the scan are not there; they have its fill value"]
    for damaged in (kept[: len(kept) // 2], b"\x28\xb5\x2f\xfd broken", b""):
        file.write_bytes(damaged)
        with pytest.raises(gp.InputError, match=r"a\.zarr/c/2/0/0: damaged chunk \[2, 0, 0\]"):
            planned(tmp_path / "a.zarr")


def test_a_sweep_sees_that_chunks_have_changed(scan, tmp_path):
    path = tmp_path / "a.zarr"
    array = zarr.create_array(path, shape=scan.shape, dtype="u1", chunks=(11, 60, 70))
    array[...] = scan
    job = gp.Job(shape__ct__path=str(path), **SETTINGS, **SIZES)

    def cached():
        return [row["cached"] for row in gp.sweep(job, {"fill.density": [0.2]}, cache=tmp_path / "cache")]

    assert cached() == [False] and cached() == [True]
    array[20:30, 20:30, 20:30] = 0
    assert cached() == [False]


def test_what_is_no_scan_is_told(tmp_path, scan):
    zarr.open_group(tmp_path / "g.zarr", mode="w")
    with pytest.raises(gp.InputError, match="without the multiscales of OME-Zarr"):
        planned(tmp_path / "g.zarr")
    array = zarr.create_array(tmp_path / "c.zarr", shape=(4, 9, 9), dtype="c8", chunks=(4, 9, 9))
    with pytest.raises(gp.InputError, match='type = "complex64" cannot be read'):
        planned(tmp_path / "c.zarr")
    array = zarr.create_array(tmp_path / "s.zarr", shape=scan.shape, dtype="u1", chunks=(11, 60, 70))
    array[...] = scan
    with pytest.raises(gp.InputError, match="pixel"):
        gp.Job(shape__ct__path=str(tmp_path / "s.zarr"), **SETTINGS).plan()
    with pytest.raises(gp.InputError, match="unpack the archive"):
        planned(shutil.make_archive(str(tmp_path / "s"), "zip", tmp_path / "s.zarr"))
