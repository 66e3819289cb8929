"""Sections of test meshes as plates of three layers, each island held at its low end and pulled at its high end in x.

sections.py write MESHES FOLDER       NAME.svg and NAME.toml into FOLDER; prints each name with its islands
sections.py turns FOLDER NAME         the mean angle, degrees, that ways across the field alone give any closed path
                                      that covers the section: with square and with round turns
"""
import math
import re
import sys

import numpy as np
import shapely
import trimesh

BEAD_MM, HEIGHT_MM = 0.45, 0.2
SPACING_MM = BEAD_MM - HEIGHT_MM * (1 - math.pi / 4)
# File and scale, larger sections first.
PARTS = {
    "plate_holes": ("plate_holes.stl", 1),
    "tardis": ("bad_tardis.stl", 1),
    "part1": ("part1_ascii.stl", 10),
    "bracket": ("featuretype_inch.stl", 25.4),
    "idler_riser": ("idler_riser_inch.stl", 25.4),
    "hinge": ("hinge_ascii.stl", 1),
    "rotor": ("rotor_80mm.stl", 1),
    "extruder_idler": ("extruder_idler_3_bodies.obj", 1),
    "pinion": ("pinion_30mm_ascii.stl", 1),
    "frog_legs": ("frog_legs_thin_open.obj", 1),
}


def write(meshes, folder):
    for name, (file, scale) in PARTS.items():
        mesh = trimesh.load(f"{meshes}/{file}", force="mesh")
        mesh.apply_scale(scale)
        mesh.merge_vertices()
        z = mesh.bounds[:, 2].mean() + 1e-4
        plan, _ = mesh.section(plane_origin=[0, 0, z], plane_normal=[0, 0, 1]).to_2D(to_2D=np.eye(4))
        islands = [p for p in plan.polygons_full if p.area > 4]
        section = shapely.MultiPolygon(islands)
        low, high = np.reshape(section.bounds, (2, 2))
        size = high - low
        # Into a page from its corner, and the part around zero: y runs down in SVG.
        page = shapely.transform(section, lambda p: (p - low) * [1, -1] + [0, size[1]])
        path = " ".join(
            "M" + " L".join(f"{x:.5f},{y:.5f}" for x, y in ring.coords[:-1]) + " Z"
            for p in page.geoms
            for ring in [p.exterior, *p.interiors]
        )
        with open(f"{folder}/{name}.svg", "w") as drawing:
            drawing.write(
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]}mm" height="{size[1]}mm" '
                f'viewBox="0 0 {size[0]} {size[1]}"><path fill-rule="evenodd" d="{path}"/></svg>'
            )
        loads = ""
        for island in islands:
            x0, y0, x1, y1 = np.asarray(island.bounds) - [*low, *low]
            end, e = 0.12 * (x1 - x0), 0.001
            loads += f"""[[guide.fixture]]
on = {{ box_mm = [[{x0 - e}, {y0 - e}, -1], [{x0 + end}, {y1 + e}, 9]] }}
fix = "xyz"
[[guide.load]]
on = {{ box_mm = [[{x1 - end}, {y0 - e}, -1], [{x1 + e}, {y1 + e}, 9]] }}
force_n = [100, -30, 0]
"""
        with open(f"{folder}/{name}.toml", "w") as job:
            job.write(f"""[shape]
outline = "{name}.svg"
thickness_mm = {3 * HEIGHT_MM}
[printer]
bed_mm = [{size[0] + 60}, {size[1] + 60}, 100]
[process]
walls = 0
skirt_loops = 0
layer_height_mm = {HEIGHT_MM}
first_layer_height_mm = {HEIGHT_MM}
bead_width_mm = {BEAD_MM}
[fill]
pattern = "continuous"
density = 1.0
[output]
gcode = "{name}.gcode"
stress = "{name}.vtu"
[guide]
kind = "stress"
element_mm = {max(size[0] / 80, 0.4)}
{loads}""")
        print(name, len(islands))


def turns(folder, name):
    import meshio
    from scipy.spatial import cKDTree

    from principal_field import strongest

    result = meshio.read(f"{folder}/{name}.vtu")
    direction, weight = strongest(np.asarray(result.point_data["S"], float)[:, [0, 1, 3]])
    near = cKDTree(result.points[:, :2])
    height, path = re.search(r'height="(.*?)mm".* d="(.*?)"', open(f"{folder}/{name}.svg").read()).groups()
    ring = lambda text: [(float(x), float(height) - float(y)) for x, y in re.findall(r"([\d.-]+),([\d.-]+)", text)]
    rings = [shapely.Polygon(ring(text)) for text in path.split("Z")[:-1]]
    section = rings[0]
    for other in rings[1:]:
        section = section.symmetric_difference(other)
    across = area = 0.0
    for island in getattr(section, "geoms", [section]):
        rooms = island.buffer(-0.5 * SPACING_MM, join_style=2)
        for room in getattr(rooms, "geoms", [rooms]):
            for ring in [room.exterior, *room.interiors]:
                points = shapely.line_interpolate_point(ring, np.arange(0, ring.length, 0.05))
                points = shapely.get_coordinates(points)
                along = np.roll(points, -1, 0) - points
                _, i = near.query(points + along / 2)
                normal = np.stack([along[:, 1], -along[:, 0]], 1)
                across += (weight[i] * abs((normal * direction[i]).sum(1))).sum()
        x0, y0, x1, y1 = island.bounds
        grid = np.stack(np.meshgrid(np.arange(x0, x1, 0.15), np.arange(y0, y1, 0.15)), -1).reshape(-1, 2)
        _, i = near.query(grid[shapely.contains_xy(island, grid[:, 0], grid[:, 1])])
        area += weight[i].sum() * 0.15**2
    share = SPACING_MM * across / area
    # Half a circle is pi/2 as long as wide, at 45 degrees in the mean.
    print(f"{90 * share:.1f} {45 * math.pi / 2 * share:.1f}")


if __name__ == "__main__":
    {"write": write, "turns": turns}[sys.argv[1]](*sys.argv[2:])
