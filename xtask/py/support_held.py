"""Length of the part's beads that run over air, as one JSON object, for G-code of any of the slicers we compare.

usage: support_held.py FOLDER_OF_CHECKS FILE.gcode REACH_MM

The measuring is done by `support_check.py` of the outside checks. Two of its patterns are replaced here. Its pattern
for brims, `rim`, also matches PrusaSlicer's "Perimeter", so it leaves walls out of the part. Its pattern for supports,
`upport`, does not match CuraEngine's "SUPPORT", so it takes supports for the part.
"""
import json
import re
import sys

sys.path.insert(0, sys.argv[1])
import support_check  # noqa: E402  (found in the folder that is named above)


def is_support(role):
    return "support" in role.lower()


def is_part(role):
    return not is_support(role) and not re.search("skirt|brim|custom|wipe|prime", role.lower())


support_check.is_support = is_support
support_check.is_part = is_part
print(json.dumps(support_check.check(sys.argv[2], float(sys.argv[3]))))
