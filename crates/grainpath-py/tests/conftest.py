"""Parts and jobs that several tests share."""

import zipfile

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


#: The parts of a 3MF project beside its model, as PrusaSlicer writes them.
PROJECT = {
    "[Content_Types].xml": '<Types><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
    "_rels/.rels": '<Relationships><Relationship Target="/3D/m.model" Id="r" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
    "Metadata/Slic3r_PE_model.config": '<config><object id="1"><volume firstid="0" lastid="11">'
    '<metadata type="volume" key="volume_type" value="ModelPart"/></volume><volume firstid="12" lastid="23">'
    '<metadata type="volume" key="name" value="block"/><metadata type="volume" key="volume_type" value="ParameterModifier"/>'
    '<metadata type="volume" key="perimeters" value="4"/><metadata type="volume" key="infill_speed" value="35"/>'
    '</volume><volume firstid="24" lastid="35"><metadata type="volume" key="name" value="cut"/>'
    '<metadata type="volume" key="volume_type" value="NegativeVolume"/></volume></object></config>',
}


@pytest.fixture
def painted(tmp_path):
    """Reads a 3MF project of a box, whose second triangle is painted (4 enforces supports, 8 blocks them), with a modifier
    volume, and with a negative volume, which is not read and warned of."""

    def make(name, paint):
        box = gp.box(10, 10, 5)
        points = np.concatenate([box.vertices, box.vertices * [0.4, 2, 2] - [0, 5, 1], 0.2 * box.vertices + 2])
        vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in points)
        rows = [f'<triangle v1="{a}" v2="{b}" v3="{c}"' for a, b, c in np.concatenate([box.faces, box.faces + 8, box.faces + 16])]
        rows[1] += f' paint_supports="{paint}"'
        triangles = "".join(f"{row}/>" for row in rows)
        mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
        model = (
            '<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
            f'<object id="1" type="model">{mesh}</object></resources><build><item objectid="1"/></build></model>'
        )
        with zipfile.ZipFile(tmp_path / name, "w") as archive:
            for part, text in {**PROJECT, "3D/m.model": model}.items():
                archive.writestr(part, text)
        return gp.read(tmp_path / name)

    return make
