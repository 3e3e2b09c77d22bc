#!/usr/bin/env python3
"""Draws a vertical section of a scene and a map of its heights.

    python3 python/examples/section_and_heights.py SCENE [LEVEL] [IMAGE.png]

The cells below (`# %%`) also run one by one in Jupyter, VS Code or Spyder. The package is described in docs/python.md.
"""
# %% The scene and one of its levels
import sys

import gigabake
import matplotlib
import numpy

matplotlib.use("Agg")  # writes an image, opens no window
from matplotlib import pyplot

path = sys.argv[1]
lod = int(sys.argv[2]) if len(sys.argv) > 2 else 0
image = sys.argv[3] if len(sys.argv) > 3 else "section_and_heights.png"

scene = gigabake.open(path)
level = scene.level(lod)
print(f"level {lod}: {level.voxel_count} voxels of {level.edge_m:g} m")

# %% The section: a slab, one voxel thick, through the middle from west to east
low_m, high_m = scene.box_m
middle_m = (low_m[1] + high_m[1]) / 2
slab = level.region(([-numpy.inf, middle_m, -numpy.inf], [numpy.inf, middle_m + level.edge_m, numpy.inf]))
east = slab.index[:, 0] - slab.index[:, 0].min()
up = slab.index[:, 2] - slab.index[:, 2].min()
section = numpy.full((up.max() + 1, east.max() + 1, 3), 255, numpy.uint8)
section[up, east] = slab.rgb
print(f"the section at y = {middle_m:.2f} m has {len(slab)} voxels")

# %% The heights: the highest voxel of each column; its plane, if there is one, is more exact than its centre
voxels = level.region()
order = numpy.lexsort((voxels.index[:, 2], voxels.index[:, 0], voxels.index[:, 1]))  # columns, from below
columns = voxels.index[order, :2]
is_top = numpy.append((numpy.diff(columns, axis=0) != 0).any(axis=1), True)
top = voxels.where(order[is_top])
heights_m = top.centre_scene_m[:, 2].copy()
if top.plane_offset_m is not None and top.normal is not None:
    along = numpy.where(top.normal[:, 2] > 0.5, top.plane_offset_m / top.normal[:, 2].clip(0.5), 0)
    heights_m += numpy.nan_to_num(along)
corner = top.index[:, :2].min(axis=0)
x, y = (top.index[:, :2] - corner).T
heights = numpy.full((y.max() + 1, x.max() + 1), numpy.nan)
heights[y, x] = heights_m
print(f"heights from {numpy.nanmin(heights):.2f} to {numpy.nanmax(heights):.2f} m")

# %% The figure
figure, (above, below) = pyplot.subplots(2, 1, figsize=(9, 12), height_ratios=(1, 3))
west_m = slab.centre_scene_m[:, 0].min() - level.edge_m / 2
floor_m = slab.centre_scene_m[:, 2].min() - level.edge_m / 2
above.imshow(section, origin="lower", interpolation="nearest",
             extent=(west_m, west_m + section.shape[1] * level.edge_m,
                     floor_m, floor_m + section.shape[0] * level.edge_m))
above.set(title=f"section at y = {middle_m:.2f} m", xlabel="east, m", ylabel="up, m")
begin_m = top.centre_scene_m[:, :2].min(axis=0) - level.edge_m / 2
drawn = below.imshow(heights, origin="lower", interpolation="nearest", cmap="terrain",
                     extent=(begin_m[0], begin_m[0] + heights.shape[1] * level.edge_m,
                             begin_m[1], begin_m[1] + heights.shape[0] * level.edge_m))
below.set(title="height of the highest voxel", xlabel="east, m", ylabel="north, m")
figure.colorbar(drawn, label="m")
figure.tight_layout()
figure.savefig(image)
print(f"the image is {image}")
