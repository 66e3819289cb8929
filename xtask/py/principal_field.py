"""An independent principal stress field for gcode_check.py, as NPZ (points, direction, weight).

principal_field.py vtu RESULT.vtu OUT.npz      from point data S (xx yy zz xy yz zx) of a result
principal_field.py bar FOLDER OUT.npz          gmsh meshes the tensile bar of `grainpath new stress-lines`,
                                               CalculiX solves it
"""
import math
import re
import subprocess
import sys

import numpy as np


def strongest(stress):
    """Direction of the in-plane principal stress greater in amount, and |s1 - s2|, of (xx, yy, xy)."""
    xx, yy, xy = stress.T
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    radius = np.hypot(half, xy)
    angle = 0.5 * np.arctan2(xy, half)
    angle = np.where(np.abs(mean - radius) > np.abs(mean + radius), angle + math.pi / 2, angle)
    return np.stack([np.cos(angle), np.sin(angle)], 1), 2 * radius


def write(points, stress, out):
    direction, weight = strongest(stress)
    np.savez(out, points=points, direction=direction, weight=weight)


def from_vtu(path, out):
    import meshio

    mesh = meshio.read(path)
    s = np.asarray(mesh.point_data["S"], float)
    write(mesh.points, s[:, [0, 1, 3]], out)


def bar(folder, out):
    run = math.sqrt(24.0**2 - 19.0**2)
    geo = f"""
SetFactory("OpenCASCADE");
Point(1) = {{0, -10, 0}}; Point(2) = {{{45 - run}, -10, 0}}; Point(3) = {{45, -5, 0}}; Point(4) = {{125, -5, 0}};
Point(5) = {{{125 + run}, -10, 0}}; Point(6) = {{170, -10, 0}}; Point(7) = {{170, 10, 0}};
Point(8) = {{{125 + run}, 10, 0}}; Point(9) = {{125, 5, 0}}; Point(10) = {{45, 5, 0}};
Point(11) = {{{45 - run}, 10, 0}}; Point(12) = {{0, 10, 0}};
Point(21) = {{45, -29, 0}}; Point(22) = {{125, -29, 0}}; Point(23) = {{125, 29, 0}}; Point(24) = {{45, 29, 0}};
Line(1) = {{1, 2}}; Circle(2) = {{2, 21, 3}}; Line(3) = {{3, 4}}; Circle(4) = {{4, 22, 5}}; Line(5) = {{5, 6}};
Line(6) = {{6, 7}}; Line(7) = {{7, 8}}; Circle(8) = {{8, 23, 9}}; Line(9) = {{9, 10}}; Circle(10) = {{10, 24, 11}};
Line(11) = {{11, 12}}; Line(12) = {{12, 1}};
Circle(13) = {{85, 0, 0, 1.5}};
Curve Loop(1) = {{1:12}}; Curve Loop(2) = {{13}}; Plane Surface(1) = {{1, 2}};
Mesh.ElementOrder = 2; Mesh.MeshSizeMax = 0.5; Mesh.MeshSizeFromCurvature = 120; Mesh.SaveAll = 1;
"""
    with open(f"{folder}/bar.geo", "w") as handle:
        handle.write(geo)
    subprocess.run(["gmsh", "-2", "-format", "inp", "-o", "bar_mesh.inp", "bar.geo"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    nodes, elements, section = {}, [], ""
    for line in open(f"{folder}/bar_mesh.inp"):
        if line.startswith("*"):
            section = line.upper()
        elif section.startswith("*NODE"):
            i, x, y, _ = (w.strip() for w in line.split(","))
            nodes[int(i)] = (float(x), float(y))
        elif "CPS6" in section:
            elements.append([int(w) for w in line.split(",") if w.strip()])
    used = {n for e in elements for n in e[1:]}
    with open(f"{folder}/bar.inp", "w") as deck:
        deck.write("*NODE,NSET=ALL\n")
        deck.writelines(f"{i},{nodes[i][0]:.12g},{nodes[i][1]:.12g},0\n" for i in sorted(used))
        deck.write("*ELEMENT,TYPE=CPS6,ELSET=E\n")
        deck.writelines(",".join(map(str, e)) + "\n" for e in elements)
        deck.write("*MATERIAL,NAME=M\n*ELASTIC\n2669,0.43\n*SOLID SECTION,ELSET=E,MATERIAL=M\n4.\n*BOUNDARY\n")
        deck.writelines(f"{i},1,2\n" for i in sorted(used) if nodes[i][0] <= 27.5 + 1e-6)
        # 500 N spread over the border of the right grip: consistent shares of quadratic sides.
        share = {}
        for e in elements:
            c = e[1:]
            for a, b, m in ((0, 1, 3), (1, 2, 4), (2, 0, 5)):
                p, q, r = (nodes[c[k]] for k in (a, b, m))
                on = lambda f: all(f(t) for t in (p, q, r))
                rim = on(lambda t: abs(t[0] - 170) < 1e-6) or on(lambda t: abs(abs(t[1]) - 10) < 1e-6)
                if rim and r[0] >= 142.5:
                    length = math.dist(p, q)
                    for k, w in ((a, 1 / 6), (b, 1 / 6), (m, 4 / 6)):
                        share[c[k]] = share.get(c[k], 0.0) + w * length
        total = sum(share.values())
        deck.write("*STEP\n*STATIC\n*CLOAD\n")
        deck.writelines(f"{i},1,{500 * s / total:.10g}\n" for i, s in sorted(share.items()))
        deck.write("*EL FILE\nS\n*END STEP\n")
    subprocess.run(["ccx", "bar"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    # CalculiX swells plane elements to solids and numbers their nodes anew: places and stresses go together.
    places, stress, block = {}, {}, ""
    number = re.compile(r"[-+ ]\d\.\d{5}E[-+]\d{2,3}")
    for line in open(f"{folder}/bar.frd"):
        if line.startswith("    2C"):
            block = "nodes"
        elif line.startswith(" -4"):
            block = "stress" if "STRESS" in line else ""
        elif line.startswith(" -3"):
            block = ""
        elif line.startswith(" -1") and block:
            values = [float(v) for v in number.findall(line[13:])]
            (places if block == "nodes" else stress)[int(line[3:13])] = values
    ids = sorted(stress)
    points = np.array([places[i][:2] for i in ids])
    tensors = np.array([[stress[i][0], stress[i][1], stress[i][3]] for i in ids])
    write(points, tensors, out)


if __name__ == "__main__":
    {"vtu": from_vtu, "bar": bar}[sys.argv[1]](*sys.argv[2:])
