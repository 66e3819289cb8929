"""Layers as a picture with a slider, for notebooks: one piece of HTML that needs no network and no other package."""

from __future__ import annotations

import html
import json
import uuid
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .gcode import ROLES

if TYPE_CHECKING:
    from .plan import Layer, Plan

#: Colours of roles by number, as the studio has them (`web/src/colours.ts`).
COLOURS = (
    "#d65d20", "#f0a34a", "#c53c67", "#9c4fa0", "#2a74b2", "#1b4f8a", "#56b2ab",
    "#1e1e1e", "#6e9632", "#969696", "#7d7d7d", "#b9b996", "#a0a06e", "#102c54",
)
#: Width and height of the picture, pixels.
SIZE = 480
#: Steps along the longer side of the picture: two a pixel, which also a screen of twice the dots shows.
STEPS = 2 * SIZE
#: Most points that a picture holds. A point takes up to 8 bytes, so that a notebook grows by 2 MB; only
#: a single layer, which is always there, may have more.
MAX_POINTS = 240_000
#: How often every second point may be left out where the path is straight: each time moves the path by one step at most.
THINNED = 3
#: Coarsest steps, in half pixels: two pixels.
COARSEST = 4
#: Layers whose points are counted before all are drawn.
SAMPLED = 8
#: Most layers that a picture holds: more are nearer to each other than a slider of :data:`SIZE` pixels tells apart.
MAX_LAYERS = 240

#: Draws the layer that the slider names. `__ID__` and `__DATA__` are filled in.
_SCRIPT = """
(() => {
  const data = __DATA__;
  const box = document.getElementById("__ID__");
  const canvas = box.querySelector("canvas"), slider = box.querySelector("input"), told = box.querySelector("output");
  const pen = canvas.getContext("2d");
  const draw = () => {
    const layer = data.layers[Number(slider.value)];
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.lineCap = pen.lineJoin = "round";
    for (const [role, closed, width, points] of layer.paths) {
      pen.strokeStyle = data.colours[role];
      pen.lineWidth = Math.max(width, 1);
      pen.beginPath();
      for (let i = 0; i < points.length; i += 2) pen.lineTo(points[i], points[i + 1]);
      if (closed) pen.closePath();
      pen.stroke();
    }
    told.textContent = layer.text;
  };
  slider.addEventListener("input", draw);
  draw();
})();
"""


def slider(plan: Plan) -> str:
    """The layers of a plan with a slider; nothing for a plan without paths.

    Points that fall on the same half pixel are drawn once. Where the layers are too many for :data:`MAX_POINTS`, steps
    become coarser, up to :data:`COARSEST`, and then layers are left out evenly: the text beside the slider names those
    that are there.
    """
    n = len(plan.layers)
    frame = _frame(plan)
    if frame is None:
        return ""
    most = -(-n // MAX_LAYERS)
    coarse = 1
    while True:
        # A few layers tell how many points all have, so that all are read once.
        asked = range(0, n, max(n // SAMPLED, 1))
        mean = sum(_count(_drawn(plan.layers[k], frame, coarse)) for k in asked) / len(asked)
        if coarse == COARSEST or mean * n / most <= MAX_POINTS:
            break
        coarse *= 2
    every = max(most, int(-(-mean * n // MAX_POINTS)))
    shown = {k: _drawn(plan.layers[k], frame, coarse) for k in range(0, n, every)}
    while sum(map(_count, shown.values())) > MAX_POINTS and len(shown) > 1:
        shown = dict(list(shown.items())[::2])
    layers = [
        {"text": f"layer {k + 1} of {n}, {plan._heights[k, 0]:.4g} mm", "paths": paths} for k, paths in shown.items()
    ]
    # A page may show the same plan twice, and outputs of an earlier session.
    name = f"grainpath-{uuid.uuid4().hex}"
    # Inside of a script `</` would end it; no text here has one, and no number can.
    data = json.dumps({"colours": COLOURS, "layers": layers}, separators=(",", ":"))
    roles = {role for paths in shown.values() for role, *_ in paths}
    legend = "".join(
        f'<span style="margin-right:1em"><span style="color:{COLOURS[k]}">&#9632;</span> {html.escape(ROLES[k])}</span>'
        for k in sorted(roles)
    )
    middle = len(layers) // 2
    width, height = (max(round(side * SIZE / STEPS), 1) for side in frame[2])
    return (
        f'<div id="{name}"><canvas width="{2 * width}" height="{2 * height}" style="width:{width}px;height:{height}px">'
        f'</canvas><div><input type="range" min="0" max="{len(layers) - 1}" value="{middle}" aria-label="layer" '
        f'style="width:{SIZE}px"> <output></output></div><div>{legend}</div>'
        f"<script>{_SCRIPT.replace('__ID__', name).replace('__DATA__', data)}</script></div>"
    )


def _frame(plan: Plan) -> tuple[npt.NDArray[np.float64], float, tuple[float, float]] | None:
    """The upper left corner of all layers, mm, steps a mm, and the size of the picture in steps."""
    lows, highs = [], []
    for layer in plan.layers:
        if len(layer.points):
            half = layer.widths_mm[:, None] / 2
            lows.append((layer.points - half).min(axis=0))
            highs.append((layer.points + half).max(axis=0))
    if not lows:
        return None
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    size = np.maximum(high - low, 1e-6)
    scale = STEPS / float(size.max())
    return np.array([low[0], high[1]]), scale, (float(size[0] * scale), float(size[1] * scale))


def _drawn(layer: Layer, frame: tuple[npt.NDArray[np.float64], float, Any], coarse: int) -> list[list[Any]]:
    """Role, whether it is closed, width and points of each path of a layer, in steps of the picture."""
    corner, scale, _ = frame
    places = np.rint((layer.points - corner) * [scale / coarse, -scale / coarse]).astype(np.int64) * coarse
    paths = []
    for row in layer.paths:
        every = slice(int(row["first"]), int(row["first"]) + int(row["count"]))
        points = places[every]
        if len(points) == 0:
            continue
        new = np.ones(len(points), bool)
        new[1:] = (points[1:] != points[:-1]).any(axis=1)
        kept = _thinned(points[new], coarse)
        # A bead that falls on one place is a dot: a line has two ends.
        kept = np.repeat(kept, 2, axis=0) if len(kept) == 1 else kept
        width = round(float(layer.widths_mm[every].mean()) * scale, 1)
        paths.append([int(row["role"]), int(row["closed"]), width, kept.reshape(-1).tolist()])
    return paths


def _thinned(points: npt.NDArray[np.int64], coarse: int) -> npt.NDArray[np.int64]:
    """The points without those that are at most one step off the line from the one before to the one after."""
    for _ in range(THINNED):
        before, middle, after = points[:-2:2], points[1:-1:2], points[2::2]
        along, off = after - before, middle - before
        cross = np.abs(along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0])
        # Where a path turns back there is no line, and the point beyond the turn stays.
        share = (along * off).sum(axis=1)
        lost = (share >= 0) & (share <= (along * along).sum(axis=1)) & (cross <= coarse * np.hypot(*along.T))
        kept = np.ones(len(points), bool)
        kept[1 : 2 * len(middle) : 2] = ~lost
        points = points[kept]
    return points


def _count(paths: list[list[Any]]) -> int:
    return sum(len(points) // 2 for *_, points in paths)
