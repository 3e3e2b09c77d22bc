#!/usr/bin/env python3
"""A shard in Python: h5py reads it, numpy unpacks it, matplotlib draws a slice and two histograms.

    python3 examples/shard_in_python.py SCENE/shards/CELL.h5 [LOD] [IMAGE.png]

The cells below (`# %%`) also run one by one in Jupyter, VS Code or Spyder. On Debian 12 and Ubuntu 24.04:
apt install python3-h5py python3-matplotlib hdf5-filter-plugin. Elsewhere: pip install h5py hdf5plugin matplotlib.
The columns are described in docs/format.md.
"""
# %% The file
import sys

import h5py
import matplotlib
import numpy

matplotlib.use("Agg")  # writes an image, opens no window
from matplotlib import pyplot

path = sys.argv[1]
lod = int(sys.argv[2]) if len(sys.argv) > 2 else 0
picture = sys.argv[3] if len(sys.argv) > 3 else "shard.png"

shard = h5py.File(path)
voxel_m = shard.attrs["voxel_size_m"] * 2**lod
corner_m = shard.attrs["lattice_origin_m"] + shard.attrs["lattice_min"] * shard.attrs["voxel_size_m"]
print(f"{shard.attrs['cell'].decode()}: {shard.attrs['lods']} levels, voxels of lod {lod} are {voxel_m} m")

# %% Masks of the occupied voxels: 512 bits per brick
level = shard[f"lod_{lod}"]
mask = level["mask"][:]
bits = numpy.unpackbits(mask.view("u1").reshape(len(mask), 8, 8, 1), axis=3, bitorder="little")  # [brick][z][y][x]
brick, z, y, x = numpy.nonzero(bits)  # in the order of the columns below

# %% Positions of the bricks: Morton codes in the nodes of the octree
nodes = shard["nodes"]
is_brick = (nodes["lod"][:] == lod) & (nodes["kind"][:] == 0)
key = nodes["key"][:][is_brick]
place = numpy.zeros((len(key), 3), int)
for bit in range(21):
    for axis in range(3):
        place[:, axis] |= ((key >> numpy.uint64(3 * bit + axis)) & numpy.uint64(1)).astype(int) << bit

# %% Voxels: index in the cell, position, colour, normal. Constant nodes (solid blocks) are left out here.
index = 8 * place[brick] + numpy.stack([x, y, z], axis=1)
position_m = corner_m + (index + 0.5) * voxel_m



def values(name):
    """Returns a channel with one row per voxel. Equal neighbours share one row on disk (docs/format.md)."""
    stored = level[name][:].reshape(len(level[name]), -1)
    if name + "_share" not in level:
        return stored if len(stored) == len(index) else numpy.repeat(stored, len(index), axis=0)
    first, share, starts = level["first"][:], level[name + "_share"][:], level[name + "_first"][:]
    octant = (z >> 2) * 4 + (y >> 2) * 2 + (x >> 2)
    group = (z >> 1 & 1) * 4 + (y >> 1 & 1) * 2 + (x >> 1 & 1)
    rows = numpy.zeros(len(index), int)
    for b in range(len(mask)):
        number = {}
        for voxel in range(int(first[b]), int(first[b + 1])):
            o, g = int(octant[voxel]), int(group[voxel])
            key = 0 if share[b, 9] else (o,) if share[b, 8] >> o & 1 else (o, g) if share[b, o] >> g & 1 else voxel + 1
            rows[voxel] = int(starts[b]) + number.setdefault(key, len(number))
    return stored[rows]


rgb = values("rgb")
assert len(rgb) == len(index)
if "normal" in level:
    u, v = values("normal").astype(float).T / 127
    w = 1 - abs(u) - abs(v)
    fold = w < 0
    u, v = (numpy.where(fold, (1 - abs(v)) * numpy.where(u < 0, -1, 1), u),
            numpy.where(fold, (1 - abs(u)) * numpy.where(v < 0, -1, 1), v))
    slope_deg = numpy.degrees(numpy.arccos(w / numpy.sqrt(u * u + v * v + w * w)))
if "plane" in level:  # distance of the surface from the centre of the voxel along the normal, in metres
    plane = values("plane")[:, 0].astype(int)
    unit = numpy.sqrt(u * u + v * v + w * w)  # of the normal with |x| + |y| + |z| = 1
    sheet_m = numpy.where(plane == 0, numpy.nan, ((plane >> 2) - 8) / 7 * voxel_m / 2 / unit)
print(f"{len(rgb)} voxels in {len(mask)} bricks, {len(rgb) / len(mask):.0f} a brick")
print(f"heights from {position_m[:, 2].min():.2f} to {position_m[:, 2].max():.2f} m")

# %% A slice from south to north, where the cell is fullest, and two histograms
slice_x = numpy.bincount(index[:, 0]).argmax()
cut = index[:, 0] == slice_x
edge = int(shard.attrs["cell_voxels"]) >> lod
image = numpy.full((edge, edge, 3), 255, "u1")
image[index[cut, 2], index[cut, 1]] = rgb[cut]

figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(15, 5))
low, high = corner_m, corner_m + edge * voxel_m
left.imshow(image, origin="lower", extent=(low[1], high[1], low[2], high[2]), interpolation="nearest")
left.set(title=f"slice at x = {low[0] + (slice_x + 0.5) * voxel_m:.2f} m", xlabel="north, m", ylabel="up, m")
left.set_ylim(position_m[:, 2].min() - 5 * voxel_m, position_m[:, 2].max() + 5 * voxel_m)
middle.hist(position_m[:, 2], bins=60, color="tab:brown")
middle.set(title="voxels by height", xlabel="up, m")
if "normal" in level:
    right.hist(slope_deg, bins=60, range=(0, 180), color="tab:green")
    right.set(title="voxels by slope", xlabel="degrees from level")
figure.tight_layout()
figure.savefig(picture)
print(f"the image is {picture}")
