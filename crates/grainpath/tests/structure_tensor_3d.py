"""The axis of a volume's texture in its layers by an independent way: eigenvectors of the structure tensor at every voxel.

Raw float32 in, (angle, clearness) float32 of the slices asked for out. Where the weakest axis stands out (fibres) it is
projected into the layer; where the strongest does (plates), their section is taken. Places with less than a tenth of
the slice's mean energy are solid or empty: what they show is noise, and counts as unclear."""
import sys

import numpy as np
from scipy.ndimage import gaussian_filter

source, target, width, height, depth, integration = sys.argv[1:7]
slices = [int(k) for k in sys.argv[7:]]
grey = np.fromfile(source, "<f4").reshape(int(depth), int(height), int(width)).astype(float)
g = [gaussian_filter(grey, 1.0, order=o) for o in ((0, 0, 1), (0, 1, 0), (1, 0, 0))]
tensor = np.empty((len(slices), int(height), int(width), 3, 3))
for i in range(3):
    for j in range(3):
        tensor[..., i, j] = gaussian_filter(g[i] * g[j], float(integration))[slices]
values, vectors = np.linalg.eigh(tensor)
line, plate = values[..., 1] - values[..., 0], values[..., 2] - values[..., 1]
v, n = vectors[..., :, 0], vectors[..., :, 2]
fibrous = line > plate
x = np.where(fibrous, v[..., 0], -n[..., 1])
y = np.where(fibrous, v[..., 1], n[..., 0])
clear = np.where(fibrous, line, plate) / np.maximum(values[..., 2], 1e-12) * (x * x + y * y)
energy = values.sum(axis=-1)
clear[energy < 0.1 * energy.mean(axis=(1, 2), keepdims=True)] = 0
np.stack([np.arctan2(y, x), clear]).astype("<f4").tofile(target)
