"""Meshes: any array that holds the right numbers, and clear errors for all others."""

import copy
import json
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import grainpath as gp
from conftest import QUICK
from test_plan import command_line

VERTICES = [[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def test_arrays_come_back_and_cannot_be_written():
    mesh = gp.Mesh(VERTICES, FACES)
    assert mesh.vertices.dtype == np.float64 and mesh.faces.dtype == np.uint32
    assert np.array_equal(mesh.vertices, VERTICES) and np.array_equal(mesh.faces, FACES)
    for array in (mesh.vertices, mesh.faces):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
    assert mesh.volume_mm3 == pytest.approx(1000 / 6)


def test_the_callers_array_may_change_afterwards():
    vertices = np.array(VERTICES, dtype=float)
    mesh = gp.Mesh(vertices, FACES)
    vertices[:] = 7
    assert np.array_equal(mesh.vertices, VERTICES)


@pytest.mark.parametrize("unit, mm", [("um", 1e-3), ("mm", 1), ("cm", 10), ("inch", 25.4), ("ft", 304.8), ("m", 1e3)])
def test_units(unit, mm):
    mesh = gp.Mesh(VERTICES, FACES, unit=unit)
    assert mesh.unit_mm == mm
    assert np.allclose(mesh.bounds_mm[1], 10 * mm)


@settings(max_examples=40, deadline=None)
@given(
    dtype=st.sampled_from(["f8", "f4", "f2", "i8", "i4", "i2", "u1"]),
    order=st.sampled_from("<>"),
    layout=st.sampled_from(["C", "F", "reversed", "strided", "offset"]),
    index=st.sampled_from(["i8", "i4", "u4", "u2", "i2", "u1"]),
)
def test_any_type_byte_order_and_strides(dtype, order, layout, index):
    def laid(values, kind):
        array = np.array(values, dtype=order + kind)
        if layout == "F":
            return np.asfortranarray(array)
        if layout == "reversed":
            return np.ascontiguousarray(array[::-1])[::-1]
        if layout == "strided":
            wide = np.zeros((2 * len(array), 6), dtype=array.dtype)
            wide[::2, ::2] = array
            return wide[::2, ::2]
        if layout == "offset":
            raw = np.zeros(array.nbytes + 1, dtype="u1")
            raw[1:] = np.frombuffer(array.tobytes(), "u1")
            return raw[1:].view(array.dtype).reshape(array.shape)
        return array

    assert gp.Mesh(laid(VERTICES, dtype), laid(FACES, index)) == gp.Mesh(VERTICES, FACES)


@pytest.mark.parametrize(
    "vertices, faces, words",
    [
        (np.zeros((4, 2)), FACES, "vertices has the shape (4, 2); (n, 3) is needed"),
        (np.zeros(12), FACES, "vertices has the shape (12,)"),
        ([["a", "b", "c"]], FACES, "vertices has the type"),
        (np.zeros((4, 3), dtype=complex), FACES, "vertices has the type complex128"),
        (np.zeros((4, 3), dtype=object), FACES, "vertices has the type object"),
        ([[0, 0, 0], [1, 2]], FACES, "rows of equal length"),
        ([[0, 0, np.nan], *VERTICES[1:]], FACES, "vertices[0, 2] is nan"),
        ([*VERTICES[:3], [0, np.inf, 0]], FACES, "vertices[3, 1] is inf"),
        (VERTICES, np.zeros((0, 3), dtype=int), "faces is empty"),
        (VERTICES, [[0, 1, 4]], "faces[0, 2] is 4; vertices are counted from 0 to 3"),
        (VERTICES, [[0, 1, -1]], "faces[0, 2] is -1"),
        (VERTICES, [[0.0, 1.0, 2.0]], "faces has the type float64; integers"),
        (VERTICES, [[0, 1, 2, 3]], "faces has the shape (1, 4)"),
        (VERTICES, [0, 1, 2], "faces has the shape (3,)"),
        (VERTICES, [[True, False, True]], "faces has the type bool"),
        (np.zeros((0, 3)), [[0, 1, 2]], "vertices are counted from 0 to -1"),
    ],
)
def test_wrong_arrays_are_named(vertices, faces, words):
    with pytest.raises(gp.InputError) as error:
        gp.Mesh(vertices, faces)
    assert words in str(error.value) and "\n" not in str(error.value)
    assert isinstance(error.value, ValueError)


def test_unknown_units_are_named():
    with pytest.raises(gp.InputError, match="unit = 'yard' should be one of um, mm"):
        gp.Mesh(VERTICES, FACES, unit="yard")


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda m: pickle.loads(pickle.dumps(m))])
def test_copies_are_equal(again):
    mesh = gp.Mesh(VERTICES, FACES, unit="inch")
    assert again(mesh) == mesh and again(mesh) != gp.Mesh(VERTICES, FACES)


def test_files_and_arrays_are_one_mesh(stl, plate):
    read = gp.read(stl)
    assert read.unit_mm is None and read.bodies[0][2] == 12
    assert np.array_equal(np.sort(np.unique(read.vertices, axis=0), axis=0), np.sort(plate.vertices, axis=0))
    assert pickle.loads(pickle.dumps(read)) == read


@pytest.mark.parametrize("size", [(0, 1, 1), (1, -1, 1), (1, 1, np.nan)])
def test_boxes_have_sides(size):
    with pytest.raises(gp.InputError):
        gp.box(*size)


def test_shown_in_notebooks(plate):
    assert "30 x 20 x 1.2 mm" in plate._repr_html_() and "<script" not in plate._repr_html_()


def test_missing_and_wrong_files(tmp_path):
    with pytest.raises(gp.InputError, match="no.stl: no such file"):
        gp.read(tmp_path / "no.stl")
    (tmp_path / "empty.stl").write_bytes(b"")
    with pytest.raises(gp.InputError, match="the file is empty"):
        gp.read(tmp_path / "empty.stl")
    (tmp_path / "step.stl").write_text("ISO-10303-21;\n")
    with pytest.raises(gp.InputError, match="exact surfaces"):
        gp.read(tmp_path / "step.stl")


def test_named_faces_are_those_of_the_command(stl):
    theirs = json.loads(command_line("inspect", stl, "--faces", "--json").stdout)["faces"]
    ours = gp.read(stl).named_faces()
    assert ours == theirs and len(ours) == 6
    assert sum(face["area_mm2"] for face in ours) == pytest.approx(2 * (30 * 20 + 30 * 1.2 + 20 * 1.2))


def test_named_faces_keep_their_names_in_another_unit_and_place():
    here = {face["name"] for face in gp.box(30, 20, 5).named_faces()}
    box = gp.box(30, 20, 5)
    elsewhere = gp.Mesh((box.vertices + [7, -3, 11]) / 10, box.faces, unit="cm").named_faces()
    assert len(here) == 6 and {face["name"] for face in elsewhere} == here


def test_paint_modifiers_and_warnings_survive_pickling_and_copying(painted):
    mesh = painted("a.3mf", "4")
    again = pickle.loads(pickle.dumps(mesh))
    for other in (again, copy.copy(mesh), copy.deepcopy(mesh)):
        assert other == mesh and other.warnings == mesh.warnings
    assert [w.id for w in mesh.warnings] == ["threemf-volumes"]
    # Nothing hangs over, so supports and their regions show that the paint and the modifier are still there.
    job = {**QUICK, "support__style": "tree"}
    assert gp.Job(again, **job).plan().to_gcode() == gp.Job(mesh, **job).plan().to_gcode()
    plain = gp.Mesh(mesh.vertices, mesh.faces)
    assert plain != mesh and gp.Job(plain, **QUICK).plan().to_gcode() != gp.Job(mesh, **QUICK).plan().to_gcode()
    assert painted("b.3mf", "8") != mesh and painted("c.3mf", "4") == mesh


def test_faces_of_an_organic_mesh_are_the_largest_ones():
    """Such a mesh has a face for each facet or so, and each name was compared with all, which took minutes."""
    n = 90
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 60, n), np.linspace(0, 60, n), indexing="ij"))
    top = np.stack([x, y, 10 + np.random.default_rng(2).random(n * n)], axis=1)
    points = np.concatenate([top, top * [1, 1, 0]])
    k = np.arange(n * n).reshape(n, n)
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    up = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    rim = np.concatenate([k[0], k[1:, -1], k[-1, -2::-1], k[-2:0:-1, 0]])
    after = np.roll(rim, -1)
    walls = np.concatenate([np.stack([rim, after, after + n * n], 1), np.stack([rim, after + n * n, rim + n * n], 1)])
    mesh = gp.Mesh(points, np.concatenate([up, up[:, ::-1] + n * n, walls]))
    faces = mesh.named_faces()
    assert len(faces) == 200 and len({face["name"] for face in faces}) > 150
    areas = [face["area_mm2"] for face in faces]
    assert areas == sorted(areas, reverse=True) and areas[0] == pytest.approx(3600)
