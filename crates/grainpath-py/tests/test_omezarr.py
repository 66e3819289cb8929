"""Scans in Zarr: OME-Zarr of both versions, units, levels, and what is wrong with a store."""

import json
import pickle

import numpy as np
import pytest

import grainpath as gp

zarr = pytest.importorskip("zarr")

SETTINGS = {"process__layer_height_mm": 0.2, "process__first_layer_height_mm": 0.2}


def ome(path, scan, version, *, unit="micrometer", before="", level_scale=(200.0, 300.0, 300.0)):
    """An image of two levels, of which the second has every second row and column."""
    group = zarr.open_group(path, mode="w", zarr_format=2 if version == "0.4" else 3)
    datasets = []
    for k, data in enumerate((scan, scan[..., ::2, ::2])):
        chunks = (1,) * len(before) + (3, 25, 40)
        shards = None if version == "0.4" else (1,) * len(before) + (6, 50, 80)
        array = group.create_array(str(k), shape=data.shape, dtype=data.dtype, chunks=chunks, shards=shards)
        array[...] = data
        scale = [1.0] * len(before) + [level_scale[0], level_scale[1] * 2**k, level_scale[2] * 2**k]
        datasets.append({"path": str(k), "coordinateTransformations": [{"type": "scale", "scale": scale}]})
    axes = [{"name": name, "type": "other"} for name in before]
    axes += [{"name": name, "type": "space", "unit": unit} for name in "zyx"]
    multiscales = [{"axes": axes, "datasets": datasets}]
    group.attrs.update({"multiscales": multiscales} if version == "0.4" else {"ome": {"version": "0.5", "multiscales": multiscales}})
    return path


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_the_program_is_that_of_the_array(tmp_path, ball, version):
    path = ome(tmp_path / "scan.ome.zarr", ball, version)
    volume = gp.read_zarr(path)
    assert volume.shape == ball.shape and volume.spacing == pytest.approx((0.2, 0.3, 0.3))
    of_array = gp.Job(gp.Volume(ball, spacing=(0.2, 0.3, 0.3)), **SETTINGS).plan().to_gcode()
    assert gp.Job(volume, **SETTINGS).plan().to_gcode() == of_array
    again = pickle.loads(pickle.dumps(gp.Job(volume, **SETTINGS)))
    assert again.plan().to_gcode() == of_array
    assert isinstance(gp.read(path), gp.Volume)


def test_levels_units_channels_and_times(tmp_path, ball):
    both = np.stack([np.zeros_like(ball), ball])[None]
    path = ome(tmp_path / "a.zarr", both, "0.5", unit="millimeter", before="tc", level_scale=(0.2, 0.3, 0.4))
    second = gp.read_zarr(path, channel=1, level=1)
    assert second.shape == (12, 20, 20) and second.spacing == pytest.approx((0.2, 0.6, 0.8))
    assert np.array_equal(second.array[2:4], ball[2:4, ::2, ::2])
    assert not gp.read_zarr(path).array[0:12].any()
    assert gp.read_zarr(path, spacing=0.1).spacing == (0.1, 0.1, 0.1)
    for wrong, message in (({"level": 2}, "level = 2"), ({"channel": 2}, "index 2 of axis 1"), ({"time": 5}, "index 5"), ({"channel": 0.5}, "channel = 0.5")):
        with pytest.raises(gp.InputError, match=message):
            gp.read_zarr(path, **wrong)


def test_plain_arrays_need_a_spacing(tmp_path, ball):
    array = zarr.create_array(tmp_path / "plain.zarr", shape=ball.shape, dtype=">u2", chunks=(5, 20, 20))
    array[...] = ball
    volume = gp.read_zarr(tmp_path / "plain.zarr", spacing=(0.2, 0.3, 0.3))
    assert len(gp.Job(volume, **SETTINGS).plan().layers) == 12
    with pytest.raises(gp.InputError, match="spacing|size|distance"):
        gp.Job(gp.read_zarr(tmp_path / "plain.zarr"), **SETTINGS).plan()


def test_a_damaged_chunk_is_told_with_its_planes(tmp_path, ball):
    path = ome(tmp_path / "scan.zarr", ball, "0.4")
    chunks = [f for f in sorted((path / "0").rglob("*")) if f.is_file() and not f.name.startswith(".")]
    chunks[len(chunks) // 2].write_bytes(b"\x28\xb5\x2f\xfd broken")
    with pytest.raises(gp.InputError, match=r"scan\.zarr: planes \d+ to \d+ cannot be read"):
        gp.Job(gp.read_zarr(path), **SETTINGS).plan()


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda m: m["axes"][-1].update(unit="parsec"), "the unit parsec"),
        (lambda m: m["axes"][-1].pop("unit"), "the axis x has no unit"),
        (lambda m: m["axes"].reverse(), "the last should be z, y and x"),
        (lambda m: m["datasets"][0]["coordinateTransformations"][0].update(scale=[1, 1]), "a scale of 2 numbers"),
        (lambda m: m["datasets"][0]["coordinateTransformations"][0].update(scale=[0, 1, 1]), "all should be above 0"),
        (lambda m: m["datasets"][0]["coordinateTransformations"][0].pop("scale"), "scale has the type"),
        (lambda m: m["datasets"][0].pop("coordinateTransformations"), "the level has no scale"),
        (lambda m: m["datasets"][0].update(coordinateTransformations="x"), "no list of coordinateTransformations"),
        (lambda m: m["datasets"][0].update(path="nope"), "there is no array 'nope'"),
        (lambda m: m["datasets"][0].update(path="../other"), "there is no array '../other'"),
        (lambda m: m["datasets"][0].pop("path"), "a level of the image has no path"),
        (lambda m: m.update(datasets="abc"), "no list of datasets"),
        (lambda m: m.pop("axes"), "no list of axes"),
        (lambda m: m["axes"][-1].update(unit=5), "the unit 5"),
    ],
)
def test_descriptions_that_say_too_little(tmp_path, ball, change, message):
    path = ome(tmp_path / "scan.zarr", ball, "0.4")
    file = path / ".zattrs"
    attributes = json.loads(file.read_text())
    change(attributes["multiscales"][0])
    file.write_text(json.dumps(attributes))
    with pytest.raises(gp.InputError, match=message):
        gp.read_zarr(path)


def test_what_is_no_zarr(tmp_path):
    with pytest.raises(gp.InputError, match="no such file"):
        gp.read_zarr(tmp_path / "none.zarr")
    (tmp_path / "empty.zarr").mkdir()
    with pytest.raises(gp.InputError, match="no Zarr|without OME"):
        gp.read_zarr(tmp_path / "empty.zarr")
    zarr.open_group(tmp_path / "group.zarr", mode="w")
    with pytest.raises(gp.InputError, match="without OME-Zarr's multiscales"):
        gp.read_zarr(tmp_path / "group.zarr")


@pytest.mark.parametrize("zarr_format", [2, 3])
def test_chunks_that_an_array_misses_are_warned_of(tmp_path, ball, zarr_format):
    """Of an array that the user opened, as of one that is read by its path."""
    array = zarr.create_array(
        tmp_path / "scan.zarr", shape=ball.shape, dtype="u1", chunks=(3, 40, 40), zarr_format=zarr_format
    )
    array[3:] = ball[3:]
    plan = gp.Job(gp.Volume(array, spacing=0.3), **SETTINGS).plan()
    assert [(w.id, w.text.split()[0]) for w in plan.warnings] == [("scan-chunks-missing", "1")]
    array[:3] = ball[:3]
    assert not gp.Job(gp.Volume(array, spacing=0.3), **SETTINGS).plan().warnings


def test_a_scan_is_found_from_another_folder(tmp_path, ball, monkeypatch):
    ome(tmp_path / "scan.zarr", ball, "0.5")
    monkeypatch.chdir(tmp_path)
    volume = gp.read_zarr("scan.zarr")
    packed = pickle.dumps(volume)
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    assert np.array_equal(pickle.loads(packed).array[0:12], ball)
    # Nothing is opened before it is read: a worker that cannot unpack a task ends.
    (tmp_path / "scan.zarr").rename(tmp_path / "gone.zarr")
    with pytest.raises(gp.InputError, match=r"scan\.zarr: no such file"):
        pickle.loads(packed).array[0:1]
    ome(tmp_path / "scan.zarr", ball[:6], "0.5")
    with pytest.raises(gp.InputError, match="the path has to lead to the same scan everywhere"):
        pickle.loads(packed).array[0:1]


def test_a_scan_of_many_chunks_is_told_at_once(tmp_path, ball):
    """Names of billions of chunks were made, one by one, to look for them."""
    zarr.create_array(tmp_path / "wide.zarr", shape=(4, 2**33, 2**33), dtype="u1", chunks=(1, 64, 64))
    with pytest.raises(gp.InputError, match="at most 67108864 voxels a plane"):
        gp.read_zarr(tmp_path / "wide.zarr", spacing=0.2)
    array = zarr.create_array(tmp_path / "deep.zarr", shape=(2**20, 8192, 8192), dtype="u1", chunks=(1, 1, 64))
    array[7, 5, :128] = 1
    assert gp.Volume(array, spacing=0.2)._missing(lambda: None) == 2**20 * 8192 * 128 - 2
    assert gp.Volume(array, spacing=0.2)._missing(lambda: [7, 7]) == 8192 * 128 - 2
