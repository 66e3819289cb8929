"""Scans planned on Dask: the same bytes for any workers, chunks and slabs; lost workers; what is refused."""

import os
import signal
import threading

import numpy as np
import pytest

import grainpath as gp
from grainpath import _grainpath, cluster, sweeps
from grainpath.omezarr import ZarrPlanes
from test_plan import command_line

zarr = pytest.importorskip("zarr")
distributed = pytest.importorskip("distributed")

# What Dask itself warns of is no error of ours.
pytestmark = pytest.mark.filterwarnings("default")

#: Distances of the voxels, mm: planes, rows, columns.
SPACING = (0.25, 0.3, 0.3)
#: Shapes of chunks: a plane each, rows of chunks that no slab divides, and one chunk for all.
CHUNKINGS = {"planes": (1, 60, 70), "bricks": (7, 32, 32), "whole": (44, 60, 70)}
SETTINGS = {"process__layer_height_mm": 0.2, "process__first_layer_height_mm": 0.3, "fill__density": 0.3}


def bone(noise=9):
    """A leaning tube with two arms and an arch, which begins above the lowest plane: islands that merge and divide."""
    z, y, x = np.mgrid[:44, :60, :70].astype("f4")
    tube = np.hypot(x - 30 - 0.2 * z, y - 30) < 16
    hollow = np.hypot(x - 30 - 0.2 * z, y - 30) < 7
    arm = np.hypot(x - 60 + 0.2 * z, y - 44) < 5
    arch = (np.abs(z - 34) < 3) & (np.abs(y - 40) < 6) & (x > 30) & (x < 62)
    inside = ((tube & ~hollow) | arm | arch) & (z > 4)
    grey = 40 + 160 * inside + np.random.default_rng(7).normal(0, noise, inside.shape)
    return np.clip(grey, 0, 255).astype("u1")


def store(path, scan, chunks):
    array = zarr.create_array(path, shape=scan.shape, dtype=scan.dtype, chunks=chunks)
    array[...] = scan
    return path


@pytest.fixture(scope="module")
def scan():
    return bone()


@pytest.fixture(scope="module")
def stores(tmp_path_factory, scan):
    folder = tmp_path_factory.mktemp("stores")
    return {name: store(folder / f"{name}.zarr", scan, chunks) for name, chunks in CHUNKINGS.items()}


@pytest.fixture(scope="module")
def client():
    client = cluster.connect("local", 2)
    yield client
    cluster.close(client)


@pytest.fixture(scope="module", params=[1, 2, 4])
def clients(request):
    client = cluster.connect("local", request.param)
    yield client, request.param
    cluster.close(client)


@pytest.fixture(scope="module")
def expected(scan):
    return gp.Job(gp.Volume(scan, spacing=SPACING), **SETTINGS).plan().to_gcode()


@pytest.mark.parametrize("chunking", CHUNKINGS)
def test_bytes_are_those_of_one_process(clients, stores, expected, chunking):
    client, workers = clients
    assert len(cluster.workers_of(client)) == workers
    plan = gp.dask.plan_zarr(
        stores[chunking], gp.Job(**SETTINGS), client=client, spacing=SPACING, slab_planes=5 + workers, window_layers=7
    )
    assert len(plan.layers) > 40 and plan.to_gcode() == expected


@pytest.mark.parametrize("chunking", CHUNKINGS)
def test_bytes_are_those_of_the_command_line(stores, scan, expected, chunking, tmp_path):
    """In one process every chunking gives what the command line makes of the same voxels."""
    assert gp.Job(gp.read_zarr(stores[chunking], spacing=SPACING), **SETTINGS).plan().to_gcode() == expected
    planes, rows, columns = scan.shape
    header = (
        f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {columns} {rows} {planes}\nencoding: raw\n"
        f"spacings: {SPACING[2]} {SPACING[1]} {SPACING[0]}\n\n"
    )
    (tmp_path / "scan.nrrd").write_bytes(header.encode() + scan.tobytes())
    sets = [f"--set={key.replace('__', '.')}={value}" for key, value in SETTINGS.items()]
    (tmp_path / "job.toml").write_text('[shape]\nct = "scan.nrrd"\n')
    ran = command_line("run", tmp_path / "job.toml", *sets)
    assert ran.returncode == 0, ran.stderr
    assert (tmp_path / "scan.gcode").read_bytes() == expected


@pytest.mark.parametrize(
    "settings",
    [
        {"shape__ct__flip": "z"},
        {"shape__ct__interpolate": "matched", "shape__ct__contours": "canny"},
        {"shape__ct__interpolate": "distance", "shape__ct__window": [3, 40]},
        {"fill__pattern": "stripes", "guide__kind": "angle", "guide__angle_deg": 37},
        {"fill__pattern": "gyroid", "process__seam": "aligned", "process__brim_width_mm": 2},
        # Filled here, since a mass is that of the whole part.
        {"fill__mass_g": 0.79, "fill__density": None},
    ],
    ids=["flipped", "canny", "distance", "stripes", "gyroid", "mass"],
)
def test_every_way_of_cutting_and_filling(client, stores, scan, settings):
    kept = {k: v for k, v in {**SETTINGS, **settings}.items() if v is not None}
    job = gp.Job(**kept)
    whole = job.with_(gp.Volume(scan, spacing=SPACING)).plan()
    plan = gp.dask.plan_zarr(stores["bricks"], job, client=client, spacing=SPACING, window_layers=9)
    assert plan.to_gcode() == whole.to_gcode()
    assert {w.id for w in plan.warnings} == {w.id for w in whole.warnings}
    ours, theirs = plan.report, whole.report
    assert ours["scan"] == theirs["scan"] and ours["mass_g"] == theirs["mass_g"]


def test_loose_pieces_and_nan_are_counted_over_borders_of_slabs(client, scan, tmp_path):
    holes = scan.astype("f4")
    holes[::5, 3, 3] = np.nan
    path = store(tmp_path / "a.zarr", holes, (7, 60, 70))
    job = gp.Job(shape__ct__min_piece_mm3=400.0, **SETTINGS)
    whole = job.with_(gp.Volume(holes, spacing=SPACING)).plan()
    plan = gp.dask.plan_zarr(path, job, client=client, spacing=SPACING)
    assert plan.to_gcode() == whole.to_gcode()
    assert [w.text for w in plan.warnings] == [w.text for w in whole.warnings]
    assert plan.report["scan"]["dropped_pieces"] == whole.report["scan"]["dropped_pieces"]


def test_each_chunk_is_read_once_in_one_process(stores, scan):
    planes = ZarrPlanes(str(stores["bricks"]), "", ())
    read = []
    inner = planes._read
    planes._read = lambda asked: read.append(asked.start) or inner(asked)
    got = np.concatenate([planes[k : k + 2] for k in range(0, 44, 2)])
    assert np.array_equal(got, scan) and read == list(range(0, 44, 7))
    assert np.array_equal(planes[-3:], scan[-3:]) and np.array_equal(planes[0:44:3], scan[::3])


def test_few_slabs_are_under_way_and_progress_is_told(client, stores, monkeypatch):
    asked, told = [], []
    real = sweeps.in_order_of_end

    def watched(numbers, submit, in_flight, look=None):
        asked.append(in_flight)
        return real(numbers, submit, in_flight, look)

    monkeypatch.setattr(gp.dask, "in_order_of_end", watched)
    gp.dask.plan_zarr(
        stores["planes"],
        gp.Job(**SETTINGS),
        client=client,
        spacing=SPACING,
        slab_planes=11,
        progress=lambda stage, done, total: told.append((stage, done, total)),
    )
    n = len(cluster.workers_of(client))
    assert set(asked) == {2 * n}
    assert [row for row in told if row[0] == "slice"] == [("slice", k, 4) for k in (1, 2, 3, 4)]


def test_a_worker_that_is_killed_changes_no_byte(stores, expected):
    client = cluster.connect("local", 2)
    try:
        first = next(iter(client.run(os.getpid).values()))
        killed = threading.Event()

        def progress(stage, done, total):
            if stage == "slice" and done == total // 2 and not killed.is_set():
                killed.set()
                os.kill(first, signal.SIGKILL)

        plan = gp.dask.plan_zarr(
            stores["planes"], gp.Job(**SETTINGS), client=client, spacing=SPACING, slab_planes=1, progress=progress
        )
        assert killed.is_set() and plan.to_gcode() == expected
    finally:
        cluster.close(client)


def test_a_scheduler_that_goes_is_told(stores):
    client = cluster.connect("local", 1)

    def progress(stage, done, total):
        if stage == "slice" and done == 3:
            client._grainpath_cluster.close()

    try:
        with pytest.raises(gp.InputError, match="the scheduler (is gone|does not answer).*nothing was written"):
            gp.dask.plan_zarr(
                stores["planes"], gp.Job(**SETTINGS), client=client, spacing=SPACING, slab_planes=1, progress=progress
            )
    finally:
        client.close()


def test_a_plan_is_cancelled(client, stores):
    token = threading.Event()

    def progress(stage, done, total):
        token.set()

    with pytest.raises(gp.Cancelled):
        gp.dask.plan_zarr(
            stores["planes"], gp.Job(**SETTINGS), client=client, spacing=SPACING, progress=progress, cancel=token
        )


def test_a_corrupt_chunk_is_one_error_and_workers_live_on(client, scan, tmp_path, stores, expected):
    path = store(tmp_path / "b.zarr", scan, (7, 60, 70))
    chunks = sorted(f for f in path.rglob("*") if f.is_file() and f.name != "zarr.json")
    chunks[3].write_bytes(b"\x28\xb5\x2f\xfd broken")
    with pytest.raises(gp.InputError, match=r"b\.zarr: planes \d+ to \d+ cannot be read"):
        gp.dask.plan_zarr(path, gp.Job(**SETTINGS), client=client, spacing=SPACING)
    again = gp.dask.plan_zarr(stores["bricks"], gp.Job(**SETTINGS), client=client, spacing=SPACING)
    assert again.to_gcode() == expected


@pytest.mark.parametrize("packed", ["chunks", "shards"])
def test_a_chunk_that_is_missing_has_the_fill_value_and_is_warned_of(client, scan, tmp_path, packed):
    path = tmp_path / "c.zarr"
    shape = {"chunks": (7, 30, 70)} if packed == "chunks" else {"chunks": (7, 15, 35), "shards": (7, 30, 70)}
    array = zarr.create_array(path, shape=scan.shape, dtype=scan.dtype, **shape)
    array[...] = scan
    chunks = sorted((f for f in path.rglob("*") if f.is_file() and f.name != "zarr.json"), key=str)
    assert len(chunks) == 14
    for chunk in chunks[-3:]:
        chunk.unlink()
    gone = zarr.open(path, mode="r")[...]
    assert not np.array_equal(gone, scan)
    expected = gp.Job(gp.Volume(gone, spacing=SPACING), **SETTINGS).plan()
    dask = gp.dask.plan_zarr(path, gp.Job(**SETTINGS), client=client, spacing=SPACING)
    read = gp.Job(gp.read_zarr(path, spacing=SPACING), **SETTINGS).plan()
    for plan in (dask, read):
        assert plan.to_gcode() == expected.to_gcode()
        (warning,) = [w for w in plan.warnings if w.id == "scan-chunks-missing"]
        assert isinstance(warning, gp.Warning) and warning.text.startswith("3 chunks of the scan are not there")
        assert "scan-chunks-missing" in [w["id"] for w in plan.report["warnings"]]
    assert "scan-chunks-missing" not in [w.id for w in expected.warnings]
    # Planes 0 to 27 are in the first eight chunks, which are all there.
    window = {"shape__ct__window": [0, 27]}
    for plan in (
        gp.dask.plan_zarr(path, gp.Job(**SETTINGS, **window), client=client, spacing=SPACING),
        gp.Job(gp.read_zarr(path, spacing=SPACING), **SETTINGS, **window).plan(),
    ):
        assert "scan-chunks-missing" not in [w.id for w in plan.warnings]


def test_the_only_worker_is_killed_while_it_fills(stores, expected):
    client = cluster.connect("local", 1)
    try:
        (worker,) = client.run(os.getpid).values()
        killed = threading.Event()

        def progress(stage, done, total):
            if stage == "fill" and done == total // 2 and not killed.is_set():
                killed.set()
                os.kill(worker, signal.SIGKILL)

        plan = gp.dask.plan_zarr(
            stores["planes"], gp.Job(**SETTINGS), client=client, spacing=SPACING, window_layers=3, progress=progress
        )
        assert killed.is_set() and plan.to_gcode() == expected
    finally:
        cluster.close(client)


def empty():
    """A cluster without workers, as one that was told to grow is at first, and its client."""
    local = distributed.LocalCluster(n_workers=0, threads_per_worker=1, processes=True, dashboard_address=":0")
    return local, distributed.Client(local)


def test_workers_may_come_after_the_call(stores, expected):
    local, client = empty()
    try:
        local.scale(2)
        plan = gp.dask.plan_zarr(stores["bricks"], gp.Job(**SETTINGS), client=client, spacing=SPACING)
        assert plan.to_gcode() == expected
    finally:
        client.close()
        local.close()


def test_workers_that_do_not_come_are_told_with_the_time(stores):
    local, client = empty()
    try:
        with pytest.raises(gp.InputError, match=r"the scheduler has no workers after 0\.2 s.*wait_s"):
            gp.dask.plan_zarr(stores["bricks"], gp.Job(**SETTINGS), client=client, spacing=SPACING, wait_s=0.2)
        token = threading.Event()
        token.set()
        with pytest.raises(gp.Cancelled):
            gp.dask.plan_zarr(
                stores["bricks"], gp.Job(**SETTINGS), client=client, spacing=SPACING, wait_s=600, cancel=token
            )
    finally:
        client.close()
        local.close()


def test_a_worker_of_another_version_that_comes_later_refuses(client, stores, monkeypatch):
    # What is asked of all workers at first says nothing of those that come later.
    monkeypatch.setattr(gp.dask, "same_version", lambda client: None)
    monkeypatch.setattr(cluster._grainpath, "__version__", "9.9.9")
    with pytest.raises(gp.InputError, match=r"here is grainpath 9\.9\.9, but tcp://127\.0\.0\.1:\d+ has "):
        gp.dask.plan_zarr(stores["planes"], gp.Job(**SETTINGS), client=client, spacing=SPACING)


def test_workers_of_another_version_are_refused_by_name(client, stores, monkeypatch):
    monkeypatch.setattr(cluster._grainpath, "__version__", "9.9.9")
    with pytest.raises(gp.InputError, match=r"here is grainpath 9\.9\.9, but tcp://127\.0\.0\.1:\d+ has "):
        gp.dask.plan_zarr(stores["planes"], gp.Job(**SETTINGS), client=client, spacing=SPACING)


@pytest.mark.parametrize(
    "settings, arguments, error, message",
    [
        ({"shape__rotate_deg": [0, 0, 30]}, {}, gp.JobError, "shape.rotate_deg: a scan that is turned"),
        ({"guide__kind": "grain", "guide__volume__path": "a.nrrd"}, {}, gp.JobError, "the texture of a scan is not found in slabs"),
        ({}, {"slab_planes": 0}, gp.JobError, "slab_planes = 0"),
        ({}, {"window_layers": -1}, gp.JobError, "window_layers = -1"),
        ({}, {"spacing": 0}, gp.InputError, "all three should be above 0"),
        ({}, {"spacing": None}, gp.InputError, "states no size of pixels|states no distance"),
        ({"shape__ct__threshold": 250.0}, {}, gp.InputError, "threshold of 250"),
    ],
    ids=["turned", "texture", "slab", "window", "spacing", "no spacing", "nothing left"],
)
def test_what_is_refused(client, stores, settings, arguments, error, message):
    given = {"spacing": SPACING, **arguments}
    with pytest.raises(error, match=message):
        gp.dask.plan_zarr(stores["planes"], gp.Job(**SETTINGS, **settings), client=client, **given)


@pytest.mark.parametrize("dtype", ["c8", "c16"])
def test_wrong_types_are_refused_before_any_work(client, tmp_path, dtype):
    path = tmp_path / "d.zarr"
    zarr.create_array(path, shape=(4, 9, 9), dtype=dtype, chunks=(4, 9, 9))
    with pytest.raises(gp.InputError, match="has the type"):
        gp.dask.plan_zarr(path, gp.Job(**SETTINGS), client=client, spacing=SPACING)


def test_wrong_shapes_are_refused_before_any_work(client, tmp_path):
    zarr.create_array(tmp_path / "e.zarr", shape=(9, 9), dtype="u1", chunks=(9, 9))
    with pytest.raises(gp.InputError, match="2 axes; planes, rows and columns are needed"):
        gp.dask.plan_zarr(tmp_path / "e.zarr", gp.Job(**SETTINGS), client=client, spacing=SPACING)


def test_workers_keep_their_memory_between_slices(client):
    # The environment with which the process began, which is the one that the C library reads.
    if not os.path.exists("/proc/self/environ"):
        pytest.skip("this system does not tell it")
    began = client.run(lambda: open("/proc/self/environ", "rb").read().split(b"\0"))
    assert all(f"MALLOC_TRIM_THRESHOLD_={256 << 20}".encode() in environ for environ in began.values())


def test_parts_have_to_be_all(scan):
    """The module itself refuses parts that leave slices out, or are no parts."""
    job = gp.Job(gp.Volume(scan, spacing=SPACING), **SETTINGS)
    spec, array = job._given()[0], job.shape._given()
    found, _ = _grainpath.scan_survey(spec, array, (None, None, None))
    part = _grainpath.scan_part(spec, array, found, (0, 20, 0), (None, None, None))
    for parts, message in (([part], "slice 20"), ([part, part], "slice 20"), ([part[:40]], "not a layer stack")):
        with pytest.raises(gp.InputError, match=message):
            _grainpath.scan_join(spec, array[:3], found, parts, (None, None, None))
    with pytest.raises(gp.InputError, match="20 to 99"):
        _grainpath.scan_part(spec, array, found, (20, 99, 0), (None, None, None))


def test_a_scan_that_a_worker_does_not_find_is_told(client, tmp_path, scan):
    """The worker ended where it unpacked the task, and with the only one gone the plan waited for ever."""
    path = store(tmp_path / "scan.zarr", scan, (7, 32, 32))
    workers, seen = set(client.nthreads()), []

    def hide(stage, done, total):
        if not seen:
            path.rename(tmp_path / "gone.zarr")
        seen.append(stage)

    with pytest.raises(gp.InputError, match=r"scan\.zarr: no such file"):
        gp.dask.plan_zarr(path, gp.Job(**SETTINGS), client=client, spacing=SPACING, progress=hide)
    assert seen[0] == "read" and set(client.nthreads()) == workers


@pytest.mark.parametrize(
    "given, error, words",
    [
        ({"client": "tcp://127.0.0.1:8786"}, gp.JobError, "client is a str"),
        ({"job": "job.toml"}, gp.JobError, "job is a str; a grainpath.Job is needed"),
        ({"slab_planes": 7.5}, gp.InputError, "slab_planes = 7.5; a whole number"),
        ({"workers": 0}, gp.JobError, "workers = 0 should be 1 or more"),
        ({"wait_s": "a"}, gp.InputError, "wait_s has the type"),
        ({"cancel": True}, gp.JobError, "cancel is a bool; a token"),
    ],
)
def test_wrong_arguments_are_told_before_a_worker_starts(stores, given, error, words):
    with pytest.raises(error, match=words):
        gp.dask.plan_zarr(stores["planes"], **{"job": gp.Job(**SETTINGS), "spacing": SPACING, **given})


def test_a_client_that_is_closed_is_told(client, stores):
    own = distributed.Client(client.scheduler.address, set_as_default=False)
    own.close()
    with pytest.raises(gp.InputError, match="the client is closed"):
        gp.dask.plan_zarr(stores["planes"], gp.Job(**SETTINGS), client=own, spacing=SPACING)


def test_what_fails_is_not_tried_again(client, stores, tmp_path, monkeypatch):
    """A corrupt chunk is corrupt each time; only tasks whose worker was lost are run again, by Dask itself."""
    tries = tmp_path / "tries"

    def broken(job, found, planes, first):
        with open(job._name, "a") as file:
            file.write(f"{planes}\n")
        raise gp.InputError("a chunk is corrupt")

    monkeypatch.setattr(gp.dask, "cut", broken)
    with pytest.raises(gp.InputError, match="a chunk is corrupt"):
        gp.dask.plan_zarr(stores["planes"], gp.Job(name=str(tries), **SETTINGS), client=client, spacing=SPACING)
    told = tries.read_text().splitlines()
    assert told and len(told) == len(set(told))
