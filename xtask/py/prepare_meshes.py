"""Writes the bench parts as binary STL in mm, standing on z = 0 with the middle at the origin.

usage: prepare_meshes.py SHARED_MESHES OUT_FOLDER
"""
import pathlib
import sys

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
]

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
    low, high = mesh.bounds
    mesh.apply_translation([-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]])
    mesh.export(out)
