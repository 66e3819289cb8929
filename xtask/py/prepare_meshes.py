"""Writes the bench parts as binary STL in mm, standing on z = 0 with the middle at the origin.

usage: prepare_meshes.py SHARED_MESHES OUT_FOLDER
"""
import pathlib
import sys

import numpy as np
import trimesh

PARTS = [  # file, name, scale (None: longest side to 70 mm; negative: height in mm)
    ("3DBenchy.3mf", "benchy", 1.0),
    ("stanford_bunny_open_base.obj", "bunny", None),
    ("armadillo.stl", "armadillo", 1.0),
    ("skull_ct_924k.ply", "skull", 1.0),
    ("plate_holes.stl", "plate_holes", 1.0),
    ("featuretype_inch.stl", "featuretype", 25.4),
    ("hinge_ascii.stl", "hinge", 1.0),
    ("M3x10_screw.stl", "screw", 1.0),
    ("femur_400mm_ascii.stl", "bone", -130.0),
    ("armadillo.stl", "armadillo100", -100.0),
    ("20mmbox_nonstandard_ascii.stl", "box", 1.0),
    ("A_upsidedown_overhang.obj", "letter_a", 1.0),
    ("anchor_60mm.ply", "anchor", 1.0),
    ("bad_tardis.stl", "tardis", 1.0),
    ("bone_lattice.ply", "lattice", 1.0),
    ("cura_testModel.stl", "cura_test", 1.0),
    ("embossed_text.obj", "text", 1.0),
    ("extruder_idler_3_bodies.obj", "idler", 1.0),
    ("goblet_vase.stl", "goblet", 1.0),
    ("idler_riser_inch.stl", "idler_riser", 25.4),
    ("linked_knots_100mm.stl", "knots", 1.0),
    ("overhang.obj", "overhang", 1.0),
    ("part1_ascii.stl", "part1", 1.0),
    ("pinion_30mm_ascii.stl", "pinion", 1.0),
    ("rotor_80mm.stl", "rotor", 1.0),
    ("sloping_hole.obj", "sloping_hole", 1.0),
    ("spikey_top.stl", "spikey_top", 1.0),
    ("spot_cow.obj", "cow", -60.0),
    ("tray_bottom.stl", "flat_tray", 1.0),
    ("U_overhang.obj", "u_overhang", 1.0),
]


def sweep(rings):
    """The strips of triangles between each two neighbouring rings of points, the last and the first included."""
    n = len(rings[0])
    faces = []
    for low in range(len(rings)):
        a, b = low * n, (low + 1) % len(rings) * n
        for i in range(n):
            j = (i + 1) % n
            faces += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
    return trimesh.Trimesh(np.concatenate(rings), faces)


def star(n_tips, outer_mm, inner_mm, height_mm):
    """A star with straight sides, and a hole of 1 mm in its middle."""
    angles = np.arange(2 * n_tips) * np.pi / n_tips
    radii = np.where(np.arange(2 * n_tips) % 2 == 0, outer_mm, inner_mm)
    ring = lambda r, z: np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(len(angles), z)])
    return sweep([ring(radii, 0.0), ring(radii, height_mm), ring(0.5, height_mm), ring(0.5, 0.0)])


def twisted_pipes(wall_mm, length_mm=30.0, turn_deg=150.0):
    """Three pipes of 10 mm around one axis, turned about it on their way up."""
    angles = np.arange(64) * 2 * np.pi / 64
    around = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    pipes = []
    for k in range(3):
        turn = lambda t: np.radians(turn_deg) * t + k * 2 * np.pi / 3
        middle = lambda t: np.array([6 * np.cos(turn(t)), 6 * np.sin(turn(t)), length_mm * t])
        way = np.linspace(0.0, 1.0, 61)
        outside = [middle(t) + 5.0 * around for t in way]
        inside = [middle(t) + (5.0 - wall_mm) * around for t in way[::-1]]
        pipes.append(sweep(outside + inside))
    return trimesh.util.concatenate(pipes)


MADE = {  # parts of our own, for fills at flat angles and for walls that no whole number of beads fits
    "star": lambda: star(5, 15.0, 6.0, 5.0),
    "star_blunt": lambda: star(12, 15.0, 11.0, 5.0),
    "twisted_pipes": lambda: twisted_pipes(1.8),
    "thin_pipes": lambda: twisted_pipes(1.05),
}



def save(mesh, out):
    low, high = mesh.bounds
    mesh.apply_translation([-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]])
    mesh.export(out)


source, target = map(pathlib.Path, sys.argv[1:])
target.mkdir(parents=True, exist_ok=True)
for file, name, scale in PARTS:
    out = target / f"{name}.stl"
    if out.exists():
        continue
    mesh = trimesh.load(source / file, force="mesh")
    if not scale:
        scale = 70 / max(mesh.extents)
    mesh.apply_scale(scale if scale > 0 else -scale / mesh.extents[2])
    save(mesh, out)
for name, make in MADE.items():
    out = target / f"{name}.stl"
    if not out.exists():
        save(make(), out)
