"""Parts and jobs that several tests share."""

import numpy as np
import pytest

import grainpath as gp

#: A job that plans in milliseconds.
QUICK = {"process__layer_height_mm": 0.3, "process__first_layer_height_mm": 0.3}


@pytest.fixture(scope="session")
def plate():
    return gp.box(30, 20, 1.2)


@pytest.fixture(scope="session")
def plan(plate):
    return gp.Job(plate, **QUICK).plan()


@pytest.fixture
def stl(tmp_path, plate):
    """The plate as an ASCII STL, whose coordinates are exact in float32."""
    path = tmp_path / "plate.stl"
    rows = ["solid plate"]
    for face in plate.vertices[plate.faces]:
        rows.append("facet normal 0 0 0\nouter loop")
        rows += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in face.tolist()]
        rows.append("endloop\nendfacet")
    path.write_text("\n".join([*rows, "endsolid plate\n"]))
    return path


@pytest.fixture(scope="session")
def ball():
    z, y, x = np.mgrid[:12, :40, :40]
    return (200 * ((x - 20) ** 2 + (y - 20) ** 2 < 200)).astype(np.uint8)
