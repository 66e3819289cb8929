"""The axis of the grain by an independent structure tensor: raw float32 in, (angle, coherence) float32 out."""
import sys

import numpy as np
from scipy.ndimage import gaussian_filter

source, target, width, height, gradient, integration = sys.argv[1:7]
grey = np.fromfile(source, "<f4").reshape(int(height), int(width)).astype(float)
gx = gaussian_filter(grey, float(gradient), order=(0, 1))
gy = gaussian_filter(grey, float(gradient), order=(1, 0))
xx, xy, yy = (gaussian_filter(p, float(integration)) for p in (gx * gx, gx * gy, gy * gy))
angle = 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2
coherence = np.hypot(xx - yy, 2 * xy) / np.maximum(xx + yy, 1e-12)
np.stack([angle, coherence]).astype("<f4").tofile(target)
