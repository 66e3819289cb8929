"""Makes the files of this folder with the programs whose formats they are: gmsh, vtk (Python packages) and ccx.

Every file holds the same field: S_k = 10 (k + 1) + (k + 1) x + 2 y - 3 z, components xx, yy, zz, xy, yz, zx, and
U = (0.1 x, 0.2 y, 0.3 z) - or, from ccx, the constant stress of a linear displacement.
"""

import pathlib
import subprocess
import sys
import tempfile

import gmsh
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

HERE = pathlib.Path(__file__).parent


def stress(p):
    return [10 * (k + 1) + (k + 1) * p[0] + 2 * p[1] - 3 * p[2] for k in range(6)]


# One element of each kind, apart from each other; natural corners, then middles of edges.
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
HEX = [(x, y, 0) for x, y in SQUARE] + [(x, y, 1) for x, y in SQUARE]
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
PYRAMID = [(x, y, 0) for x, y in SQUARE] + [(0.5, 0.5, 1)]
HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]


def quadratic(corners, edges):
    return corners + [tuple(0.5 * (a + b) for a, b in zip(corners[i], corners[j])) for i, j in edges]


CELLS = [  # VTK type, Abaqus name, nodes
    (12, "C3D8", HEX),
    (25, "C3D20", quadratic(HEX, HEX_EDGES)),
    (13, "C3D6", WEDGE),
    (26, "C3D15", quadratic(WEDGE, WEDGE_EDGES)),
    (10, "C3D4", TET),
    (24, "C3D10", quadratic(TET, TET_EDGES)),
    (14, None, PYRAMID),
]


def grid(cells, shift=0.0):
    points, out = [], vtk.vtkUnstructuredGrid()
    out.Allocate(len(cells))
    for i, (kind, _, nodes) in enumerate(cells):
        ids = vtk.vtkIdList()
        for x, y, z in nodes:
            ids.InsertNextId(len(points))
            points.append((x + 2 * i + shift, y, z))
        out.InsertNextCell(kind, ids)
    points = np.array(points, dtype=np.float64)
    vp = vtk.vtkPoints()
    vp.SetDataTypeToDouble()
    for p in points:
        vp.InsertNextPoint(*p)
    out.SetPoints(vp)
    return out, points


def filled(cells, shift=0.0, dtype=np.float64, components=6):
    out, points = grid(cells, shift)
    s = np.array([stress(p) for p in points], dtype=dtype)
    if components == 9:
        s = s[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]]
    array = numpy_to_vtk(np.ascontiguousarray(s), deep=True)
    array.SetName("S")
    out.GetPointData().AddArray(array)
    u = numpy_to_vtk(np.ascontiguousarray(points * [0.1, 0.2, 0.3]), deep=True)
    u.SetName("U")
    out.GetPointData().AddArray(u)
    middle = []
    for i in range(out.GetNumberOfCells()):
        ids = out.GetCell(i).GetPointIds()
        middle.append(stress(np.mean([points[ids.GetId(k)] for k in range(ids.GetNumberOfIds())], axis=0)))
    c = numpy_to_vtk(np.array(middle), deep=True)
    c.SetName("S_cell")
    out.GetCellData().AddArray(c)
    return out


def write_vtu(name, mode, big=False, packed=None, wide=False, encode=False, **kwargs):
    w = vtk.vtkXMLUnstructuredGridWriter()
    w.SetFileName(str(HERE / name))
    w.SetInputData(filled(CELLS, **kwargs))
    {"ascii": w.SetDataModeToAscii, "binary": w.SetDataModeToBinary, "appended": w.SetDataModeToAppended}[mode]()
    w.SetEncodeAppendedData(encode)
    (w.SetByteOrderToBigEndian if big else w.SetByteOrderToLittleEndian)()
    (w.SetHeaderTypeToUInt64 if wide else w.SetHeaderTypeToUInt32)()
    if packed:
        {"zlib": w.SetCompressorTypeToZLib, "lzma": w.SetCompressorTypeToLZMA, "lz4": w.SetCompressorTypeToLZ4}[packed]()
        w.SetBlockSize(1024)
    else:
        w.SetCompressorTypeToNone()
    w.Write()


def vtus():
    write_vtu("ascii.vtu", "ascii")
    write_vtu("base64.vtu", "binary", wide=True)
    write_vtu("base64_zlib.vtu", "binary", packed="zlib", dtype=np.float32)
    write_vtu("raw_big.vtu", "appended", big=True)
    write_vtu("raw_zlib_blocks.vtu", "appended", packed="zlib", wide=True)
    write_vtu("appended_base64_zlib_big.vtu", "appended", packed="zlib", encode=True, big=True, components=9)
    write_vtu("raw_lzma_blocks.vtu", "appended", packed="lzma", wide=True)
    write_vtu("base64_lzma.vtu", "binary", packed="lzma", dtype=np.float32)
    write_vtu("base64_lz4.vtu", "binary", packed="lz4", dtype=np.float32)
    write_vtu("appended_base64.vtu", "appended", encode=True, wide=True)
    # Two pieces in one file: a multi-block set appended by hand from two ASCII files.
    pieces = []
    for i, shift in enumerate([0.0, 40.0]):
        with tempfile.NamedTemporaryFile(suffix=".vtu") as f:
            w = vtk.vtkXMLUnstructuredGridWriter()
            w.SetFileName(f.name)
            w.SetInputData(filled(CELLS[i : i + 3], shift=shift))
            w.SetDataModeToBinary()
            w.SetCompressorTypeToNone()
            w.Write()
            text = pathlib.Path(f.name).read_text()
        start, end = text.index("<Piece"), text.index("</Piece>") + len("</Piece>")
        head, tail = text[:start], text[end:]
        pieces.append(text[start:end])
    (HERE / "pieces.vtu").write_text(head + "\n".join(pieces) + tail)
    for name, version, binary in [("v51_binary.vtk", 51, True), ("v42_ascii.vtk", 42, False), ("v42_binary.vtk", 42, True)]:
        w = vtk.vtkUnstructuredGridWriter()
        w.SetFileName(str(HERE / name))
        w.SetInputData(filled(CELLS, dtype=np.float32))
        w.SetFileVersion(version)
        (w.SetFileTypeToBinary if binary else w.SetFileTypeToASCII)()
        w.Write()


def msh(name, version, binary):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("kinds")
    # Gmsh's own numbering of middles of edges.
    edges = {
        5: [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)],
        6: [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)],
        4: [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)],
    }
    kinds = [(5, HEX), (17, quadratic(HEX, edges[5])), (6, WEDGE), (18, quadratic(WEDGE, edges[6])), (4, TET),
             (11, quadratic(TET, edges[4])), (7, PYRAMID)]
    tag, points = 1, {}
    for i, (kind, nodes) in enumerate(kinds):
        entity = gmsh.model.addDiscreteEntity(3, i + 1)
        tags = list(range(tag, tag + len(nodes)))
        tag += len(nodes)
        at = [(x + 2 * i, y, z) for x, y, z in nodes]
        points.update(zip(tags, at))
        gmsh.model.mesh.addNodes(3, entity, tags, [c for p in at for c in p])
        gmsh.model.mesh.addElements(3, entity, [kind], [[100 + i]], [tags])
        gmsh.model.addPhysicalGroup(3, [entity], tag=i + 1, name=f"part {i + 1}")
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", int(binary))
    gmsh.write(str(HERE / name))
    nine = [0, 3, 5, 3, 1, 4, 5, 4, 2]
    for view, kind in [("S", "NodeData"), ("S_cell", "ElementData")]:
        v = gmsh.view.add(view)
        if kind == "NodeData":
            data = {t: np.array(stress(p))[nine] for t, p in points.items()}
        else:
            data = {}
            t = 1
            for i, (_, nodes) in enumerate(kinds):
                data[100 + i] = np.mean([stress(points[t + k]) for k in range(len(nodes))], axis=0)[nine]
                t += len(nodes)
        gmsh.view.addModelData(v, 0, "kinds", kind, list(data), [list(d) for d in data.values()], numComponents=9)
        gmsh.view.write(v, str(HERE / name), append=True)
    gmsh.finalize()


def frd(name, binary):
    g = np.array([[1e-3, 2e-4, -3e-4], [4e-4, -2e-3, 5e-4], [1e-4, 7e-4, 3e-3]])
    deck, node, element = ["*NODE, NSET=ALL"], 1, 1
    elements, fixed = [], []
    for i, (_, kind, nodes) in enumerate([c for c in CELLS if c[1]]):
        tags = []
        for x, y, z in nodes:
            p = np.array([x + 2 * i, y, z])
            deck.append(f"{node}, {p[0]}, {p[1]}, {p[2]}")
            fixed += [f"{node}, {k + 1}, {k + 1}, {(g @ p)[k]:.12g}" for k in range(3)]
            tags.append(str(node))
            node += 1
        elements.append(f"*ELEMENT, TYPE={kind}, ELSET=EALL")
        row = [str(element)] + tags
        while row:
            elements.append(", ".join(row[:10]) + ("," if len(row) > 10 else ""))
            row = row[10:]
        element += 1
    out = "OUTPUT" if binary else "FILE"
    deck += elements + ["*MATERIAL, NAME=M", "*ELASTIC", "2100, 0.3", "*SOLID SECTION, ELSET=EALL, MATERIAL=M", "*STEP",
                        "*STATIC", "*BOUNDARY"] + fixed + [f"*NODE {out}", "U", f"*ELEMENT {out}" if binary else "*EL FILE",
                        "S", "*END STEP", ""]
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "patch.inp").write_text("\n".join(deck))
        subprocess.run(["ccx", "patch"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        bytes_ = (pathlib.Path(folder) / "patch.frd").read_bytes()
    # The day and the machine are nobody's business.
    lines = [l for l in bytes_.split(b"\n") if not l.startswith((b"    1UDATE", b"    1UTIME", b"    1UHOST", b"    1UDIR"))]
    (HERE / name).write_bytes(b"\n".join(lines))


def main():
    vtus()
    for name, version, binary in [("v22_ascii.msh", 2.2, 0), ("v22_binary.msh", 2.2, 1), ("v41_ascii.msh", 4.1, 0),
                                  ("v41_binary.msh", 4.1, 1)]:
        msh(name, version, binary)
    frd("patch_ascii.frd", False)
    frd("patch_binary.frd", True)


if __name__ == "__main__":
    sys.exit(main())
