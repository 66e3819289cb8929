"""Jobs: settings from Python, text and files, with errors that name the line."""

import copy
import pathlib
import pickle

import numpy as np
import pytest

import grainpath as gp


@pytest.mark.parametrize(
    "key, value, shown",
    [
        ("fill__density", 0.4, 0.4),
        ("fill__density", np.float64(0.5), 0.5),
        ("fill__density", np.float32(0.25), 0.25),
        ("process__walls", 3, 3),
        ("process__walls", np.int64(4), 4),
        ("fill__pattern", "gyroid", "gyroid"),
        ("fill__angles_deg", [0, 90], [0, 90]),
        ("fill__angles_deg", (0.0, 45.5), [0, 45.5]),
        ("fill__angles_deg", np.array([30.0, 60.0]), [30, 60]),
        ("support__interface_lines", False, False),
        ("fill__mass_g", 5.5, 5.5),
    ],
)
def test_values_of_python_are_values_of_jobs(plate, key, value, shown):
    assert gp.Job(plate, **{key: value})[key.replace("__", ".")] == shown


def test_a_profile_brings_its_settings(plate):
    assert gp.Job(plate, material__profile="petg")["material.nozzle_temp_c"] != gp.Job(plate)["material.nozzle_temp_c"]
    assert gp.Job(plate)["fill.mass_g"] is None


@pytest.mark.parametrize(
    "key, value, words",
    [
        ("fill__densty", 0.4, "did you mean `density`"),
        ("fil__density", 0.4, "did you mean [fill]"),
        ("fill__density", -0.5, "fill.density"),
        ("fill__density", float("nan"), "a finite number is needed"),
        ("fill__density", "much", "fill.density"),
        ("fill__density", None, "is a NoneType"),
        ("fill__density", object(), "a number, a text"),
        ("fill__pattern", "gyrod", "gyroid"),
        ("process__walls", -1, "process.walls"),
        ("process__walls", 1.5, "process.walls"),
        ("density", 0.4, "density: a setting is its section, two underscores and its name"),
        ("material__profile", "plaa", "pla"),
    ],
)
def test_wrong_settings_are_refused_at_once(plate, key, value, words):
    with pytest.raises(gp.JobError) as error:
        gp.Job(plate, **{key: value})
    assert words in str(error.value)
    assert isinstance(error.value, ValueError) and isinstance(error.value, gp.GrainpathError)


@pytest.mark.parametrize(
    "text, line, words",
    [
        ("[process]\nwals = 3", 2, "did you mean `walls`"),
        ("[process]\n\n\nwalls = -1", 4, "walls"),
        ("fill = 3", 1, "should be a section"),
        ("[fill\n", 1, ""),
        ("format = 99", 1, "newer"),
    ],
)
def test_errors_have_file_and_line(text, line, words):
    with pytest.raises(gp.JobError) as error:
        gp.Job.from_text(text)
    assert error.value.file == "job" and error.value.line == line and words in str(error.value)
    again = pickle.loads(pickle.dumps(error.value))
    assert type(again) is gp.JobError and (again.file, again.line, str(again)) == ("job", line, str(error.value))


def test_jobs_do_not_change(plate):
    job = gp.Job(plate, fill__density=0.3)
    other = job.with_(fill__density=0.5, process__walls=1)
    assert (job["fill.density"], other["fill.density"]) == (0.3, 0.5)
    assert other.shape is plate and job["process.walls"] != other["process.walls"]


def test_settings_overrule_the_text(plate):
    job = gp.Job(plate, text="[fill]\ndensity = 0.3", fill__density=0.6)
    assert job["fill.density"] == 0.6
    with pytest.raises(KeyError):
        job["fill.no"]


def test_a_shape_takes_the_place_of_the_one_in_the_text(plate):
    job = gp.Job(plate, text='[shape]\noutline = "x.svg"\nthickness_mm = 2')
    assert len(job.plan().layers) == 6


@pytest.mark.parametrize("text", ["tab\there", 'quote"d', "back\\slash", "new\nline", "ümläut", "\x7f", "a=b"])
def test_texts_are_escaped(plate, text):
    assert gp.Job(plate, printer__start_gcode=text)["printer.start_gcode"] == text


def test_paths_are_texts(plate):
    assert gp.Job(plate, output__report=pathlib.Path("x.html"))["output.report"] == "x.html"


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda j: pickle.loads(pickle.dumps(j))])
def test_copies_plan_the_same(plate, again):
    job = gp.Job(plate, fill__density=0.3, process__layer_height_mm=0.3)
    assert again(job).plan().to_gcode() == job.plan().to_gcode()


@pytest.mark.parametrize("wrong", ["part.stl", 3, np.zeros((3, 3))])
def test_shapes_are_shapes(wrong):
    with pytest.raises(gp.JobError, match="a Mesh, a Volume, a LayerStack or Images are needed"):
        gp.Job(wrong)


def test_a_job_without_a_shape_says_so():
    with pytest.raises(gp.JobError, match=r"\[shape\] needs mesh"):
        gp.Job().plan()


def test_missing_files_are_named(tmp_path):
    with pytest.raises(gp.JobError, match="no.toml: no such file"):
        gp.Job.from_toml(tmp_path / "no.toml")
    (tmp_path / "job.toml").write_text('[shape]\nmesh = "no.stl"\n')
    with pytest.raises(gp.InputError, match="no.stl"):
        gp.Job.from_toml(tmp_path / "job.toml").plan()
    (tmp_path / "latin.toml").write_bytes(b'[shape]\nmesh = "\xe4"\n')
    with pytest.raises(gp.JobError, match="UTF-8"):
        gp.Job.from_toml(tmp_path / "latin.toml")


def test_schema_and_profiles():
    assert "fill" in gp.schema()["properties"]
    assert "pla" in gp.profiles()["material"] and "density_g_cm3" in gp.profiles("pla")
    with pytest.raises(gp.JobError, match="no profile 'x'"):
        gp.profiles("x")


#: Wrong files: the setting that names each, its name, its content, and the line that is wrong; `None` where it has none.
WRONG = {
    "mesh as text": ("shape.mesh", "a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", 4),
    "mesh": ("shape.mesh", "a.ply", "ply\nformat ascii 1.0\nelement vertex", 3),
    "mesh without faces": ("shape.mesh", "a.obj", "v 0 0 0\n", None),
    "drawing": ("shape.outline", "a.svg", "<svg", None),
    "scan": ("shape.ct.path", "a.nrrd", "NRRD0004\ntype: uint8\n\n", None),
    "stress": ("guide.import", "a.vtu", "<VTKFile", None),
    "directions": ("guide.field.path", "a.csv", "x,y,angle\n0,0,1\n1,2\n", 3),
    "densities": ("fill.density", "a.csv", "x,y,z,density\n0,0,0,0.2\n1,1,1\n", 3),
    "picture": ("shape.photo.files", "a.png", "\x89PNG", None),
}


@pytest.mark.parametrize("what", WRONG)
@pytest.mark.parametrize("there", [True, False], ids=["wrong", "missing"])
def test_errors_of_files_name_the_file_and_the_line(tmp_path, plate, what, there):
    setting, name, said, line = WRONG[what]
    if there:
        (tmp_path / name).write_bytes(said.encode("latin-1"))
    path = str(tmp_path / name)
    value = {
        "shape.photo.files": [path],
        "fill.density": {"min": 0.1, "max": 1.0, "by": "file", "file": path, "array": "density"},
    }
    settings = {setting: value.get(setting, path)}
    if setting == "guide.field.path":
        settings["guide.kind"] = "field"
    if setting == "shape.outline":
        settings["shape.thickness_mm"] = 2.0
    if setting == "shape.photo.files":
        settings |= {"guide.kind": "grain", "shape.photo.size_mm": [60, 30], "shape.photo.thickness_mm": 3}
    shape = None if setting.startswith("shape.") else plate
    with pytest.raises(gp.InputError) as error:
        gp.Job(shape, **{key.replace(".", "__"): value for key, value in settings.items()}).plan()
    assert error.value.file == path and path in str(error.value)
    assert error.value.line == (line if there else None), str(error.value)


def test_errors_of_arrays_name_no_file(ball):
    flat = gp.Volume(np.zeros_like(ball), spacing=(0.2, 0.3, 0.3))
    with pytest.raises(gp.InputError) as error:
        gp.Job(flat).plan()
    assert error.value.file is None and error.value.line is None
    with pytest.raises(gp.GrainpathError) as error:
        gp.gcode.loads(b"\0\0")
    assert error.value.file is None
    text = "[process]\nwals = 3\n"
    with pytest.raises(gp.JobError) as error:
        gp.Job.from_text(text)
    assert (error.value.file, error.value.line) == ("job", 2)


def test_errors_of_other_files_name_them(tmp_path):
    for name, call in (("a.gcode", gp.gcode.read), ("b.stl", gp.read), ("c.bin", gp.inspect)):
        path = tmp_path / name
        path.write_bytes(b"\0\1")
        with pytest.raises(gp.GrainpathError) as error:
            call(path)
        assert error.value.file == str(path)


ACROSS = gp.Field(([0.0, 15.0, 30.0], [0.0, 15.0, 30.0]), np.full((3, 3), np.pi / 2))
PULL = gp.Stress([[0, 0, 0], [30, 20, 1]], np.tile([10.0, 0, 0, 0, 0, 0], (2, 1)))


@pytest.mark.parametrize(
    "before, arrays, kind",
    [
        ({"guide__kind": "angle"}, {"field": ACROSS}, "field"),
        ({"guide__field__path": "x.npz", "guide__field__cell_mm": 3.0, "guide__kind": "field"}, {"field": ACROSS}, "field"),
        ({"guide__field": "x.npz", "guide__kind": "field"}, {"stress": PULL}, "stress"),
        ({"guide__kind": "field", "field": ACROSS}, {"stress": PULL}, "stress"),
    ],
)
def test_a_guide_that_is_an_array_takes_the_place_of_what_was_named(plate, before, arrays, kind):
    """It was ignored without a word where a setting of the job before named another kind."""
    fill = {"fill__pattern": "stripes", "fill__density": 0.4, "process__walls": 1}
    job = gp.Job(plate, **before, **fill).with_(**arrays)
    assert job["guide.kind"] == kind
    assert job.plan().to_gcode() == gp.Job(plate, **arrays, **fill).plan().to_gcode()


def test_a_kind_that_is_named_later_takes_the_place_of_an_array(plate):
    job = gp.Job(plate, field=ACROSS, fill__pattern="stripes", fill__density=0.4)
    assert job.with_(guide__kind="field").plan().to_gcode() == job.plan().to_gcode()
    turned = job.with_(guide__kind="angle", guide__angle_deg=30)
    plain = gp.Job(plate, guide__kind="angle", guide__angle_deg=30, fill__pattern="stripes", fill__density=0.4)
    assert turned.plan().to_gcode() == plain.plan().to_gcode()
    table = gp.sweep(job, {"guide.kind": ["angle", "field"]})
    assert not table.failed and table[0]["printed_mm"] != table[1]["printed_mm"]


@pytest.mark.parametrize(
    "named", [{"shape__mesh": "a.stl"}, {"shape__ct__path": "scan/"}, {"shape__ct": "scan/"}]
)
def test_an_array_takes_the_place_of_the_file_that_was_named(plate, named):
    job = gp.Job(**named, fill__density=0.4)
    assert job.with_(plate).plan().to_gcode() == gp.Job(plate, fill__density=0.4).plan().to_gcode()
    with pytest.raises(gp.GrainpathError, match=r"a\.stl|scan/"):
        gp.Job(plate).with_(**named).plan()


@pytest.mark.parametrize(
    "arrays, named, words",
    [
        ({}, {"shape__mesh": "a.stl"}, "shape.mesh = 'a.stl'"),
        ({}, {"shape__ct": "scan/"}, "shape.ct.path = 'scan/'"),
        ({"field": ACROSS}, {"guide__kind": "angle"}, "guide.kind = 'angle'"),
        ({"field": ACROSS}, {"guide__field__cell_mm": 2.0}, "guide.field.cell_mm = 2.0"),
        ({"stress": PULL}, {"guide__import": "a.frd"}, "guide.import = 'a.frd'"),
    ],
)
def test_an_array_and_a_file_for_one_thing_are_refused(plate, arrays, named, words):
    with pytest.raises(gp.JobError) as error:
        gp.Job(plate, **arrays, **named)
    assert str(error.value) == f"{words}: the job has an array for it; leave one of the two out"


def test_settings_are_no_arguments_of_a_command(plate):
    with pytest.raises(gp.JobError) as error:
        gp.Job(plate, fill__densty=0.4)
    assert str(error.value) == "unknown key `densty` in [fill]; did you mean `density`?" and error.value.file is None


def test_a_job_that_was_unpacked_finds_its_files_from_another_folder(plate, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.toml").write_text("density_g_cm3 = 1.5\n")
    job = pickle.dumps(gp.Job(plate, material__profile="own.toml"))
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    assert pickle.loads(job)["material.density_g_cm3"] == 1.5
    # Unpacking reads nothing, so that a worker that misses a file can say so.
    (tmp_path / "own.toml").unlink()
    again = pickle.loads(job)
    with pytest.raises(gp.JobError, match=r"own\.toml"):
        again.plan()


@pytest.mark.parametrize("threads", [0, 1.5, "2", 2000, 10**30])
def test_threads_are_a_whole_number(plate, threads):
    with pytest.raises((gp.JobError, gp.InputError), match="threads = "):
        gp.Job(plate).plan(threads=threads)


def test_ends_of_lines_stay_as_they_are(stl, tmp_path):
    """The program of a job with CRLF was not that of the command line, which takes the text as it is."""
    text = f'[shape]\nmesh = "{stl.name}"\n[printer]\nstart_gcode = """\nG28\nG1 Z5\n"""\n'
    path = tmp_path / "job.toml"
    path.write_bytes(text.replace("\n", "\r\n").encode())
    job = gp.Job.from_toml(path)
    assert job["printer.start_gcode"] == "G28\r\nG1 Z5\r\n"
    assert b"G28\r\nG1 Z5" in job.plan().to_gcode()


def test_a_job_of_a_file_is_planned_from_another_folder(stl, tmp_path, monkeypatch):
    (tmp_path / "job.toml").write_text(f'[shape]\nmesh = "{stl.name}"\n')
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path)
    job = gp.Job.from_toml("job.toml")
    monkeypatch.chdir(tmp_path / "other")
    assert len(job.plan().layers) == len(job.with_(process__walls=1).plan().layers) > 0


def test_settings_are_looked_up_by_name(plate):
    job = gp.Job(plate)
    assert "fill.density" in job and "fill.densty" not in job and 3 not in job
    assert "fill.density" in list(job) and set(job) == set(job.settings)
    with pytest.raises(KeyError, match="did you mean 'fill.density'"):
        job["fill.densty"]


#: What is no argument of a call, and what its exception says.
NO_ARGUMENTS = {
    "NUL in the path of a job": (lambda plan: gp.Job.from_toml("a\0b"), "NUL"),
    "NUL in the path of a program": (lambda plan: gp.gcode.read("a\0b"), "NUL"),
    "no path": (lambda plan: gp.read(None), "path is a NoneType"),
    "a path in bytes": (lambda plan: gp.read(b"a.stl"), "path is bytes"),
    "a file number": (lambda plan: gp.read(0), "path is a int"),
    "half of a character": (lambda plan: plan.job.with_(printer__start_gcode="G28 \ud800"), "half of a character"),
    "half of a character in a text": (lambda plan: gp.Job.from_text("a = '\ud800'"), "half of a character"),
    "half of a character in a program": (lambda plan: gp.gcode.loads("G1 X\udc80"), "half of a character"),
    "units": (lambda plan: gp.Mesh(plan.job.shape.vertices, plan.job.shape.faces, unit=["mm"]), "unit = "),
    "a width that is a word": (lambda plan: gp.markers("a", 30), "a x 30 mm: the rectangle"),
    "a diameter that is a word": (lambda plan: gp.gcode.loads(plan.to_gcode(), filament_mm="1.75"), "filament_mm has the type"),
    "half a layer": (lambda plan: gp.gcode.loads(plan.to_gcode()).render(1.5), "layer = 1.5"),
    "a size that is a word": (lambda plan: gp.gcode.loads(plan.to_gcode()).render(size="a"), "size = 'a'"),
    "progress": (lambda plan: plan.job.plan(progress=3), "progress is a int; a function"),
    "a token": (lambda plan: plan.job.plan(cancel=True), "cancel is a bool; a token"),
    "progress of a report": (lambda plan: plan.measure(progress=3), "progress is a int; a function"),
    "a wait": (lambda plan: gp.cluster.run_folder(".", wait_s="a"), "wait_s has the type"),
}


@pytest.mark.parametrize("what", NO_ARGUMENTS)
def test_what_is_no_argument_is_told(plan, tmp_path, monkeypatch, what):
    (tmp_path / "job.toml").write_text("")
    monkeypatch.chdir(tmp_path)
    call, words = NO_ARGUMENTS[what]
    with pytest.raises((gp.InputError, gp.JobError), match=words):
        call(plan)
