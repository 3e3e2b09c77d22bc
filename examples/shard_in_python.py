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

# %% Bricks: Morton codes of their positions, in the nodes of the octree
nodes = {name: column[:] for name, column in shard["nodes"].items()}


def bits_of(keys, first, count):
    """Returns the numbers whose bits are every third bit of the keys, from bit `first` on."""
    return sum((keys.astype(int) >> 3 * bit + first & 1) << bit for bit in range(count))


# %% Voxels of a level, from the next coarser level (docs/format.md, "Differences")
code = numpy.arange(512)  # of each voxel of a brick: x, y, z, interleaved bit by bit
code_of_place = numpy.argsort(sum(bits_of(code, axis, 3) << 3 * axis for axis in range(3)))  # places are x + 8y + 64z


def decode(level, octant, exists, rgb, normal):
    """Returns which voxels of the bricks of a level exist, their colours and normals, all as [brick][code].

    `exists`, `rgb` and `normal` are the same of the parent node of each brick; `octant` is the brick's key & 7.
    """
    parent = numpy.arange(len(octant))[:, None], octant[:, None] * 64 + numpy.arange(64)
    there = exists[parent]
    children = numpy.zeros(there.shape, "u1")
    children[there | (len(level["children"]) == children.size)] = level["children"]
    exists = numpy.unpackbits(children, axis=1, bitorder="little").astype(bool)
    rgb, normal = ((v[parent] * there[..., None]).repeat(8, axis=1) for v in (rgb, normal))
    luma, (co, cg) = level["rgb"][:, 0], level["rgb"][:, 1:].view("i1").T
    t = luma - (cg >> 1).view("u1")
    b = t - (co >> 1).view("u1")
    rgb[exists] += numpy.stack([b + co.view("u1"), t + cg.view("u1"), b], axis=1)
    if "normal" in level:
        normal[exists] += level["normal"].view("u1")
    return exists, rgb, normal


def voxels_of_nodes(lod):
    """Returns the same for all nodes of a level: bricks, and constant nodes, which have 512 equal voxels."""
    here = nodes["lod"] == lod
    key, is_brick = nodes["key"][here], nodes["kind"][here] == 0
    exists = numpy.ones((len(key), 512), bool)
    rgb = nodes["value"][here].view("u1").reshape(-1, 1, 4)[..., :3].repeat(512, axis=1)
    normal = nodes["normal"][here].view("u1")[:, None].repeat(512, axis=1)
    if lod + 1 < shard.attrs["lods"]:
        parent = numpy.searchsorted(nodes["key"][nodes["lod"] == lod + 1], key[is_brick] >> numpy.uint64(3))
        above = [values[parent] for values in voxels_of_nodes(lod + 1)]
    else:
        above = numpy.ones((1, 512), bool), numpy.zeros((1, 512, 3), "u1"), numpy.zeros((1, 512, 2), "u1")
    level = {name: column[:] for name, column in shard[f"lod_{lod}"].items()}
    octant = (key[is_brick] & numpy.uint64(7)).astype(int)
    exists[is_brick], rgb[is_brick], normal[is_brick] = decode(level, octant, *above)
    return exists, rgb, normal


exists, rgb, normal = (values[:, code_of_place] for values in voxels_of_nodes(lod))
here = nodes["lod"] == lod
is_brick = nodes["kind"][here] == 0
exists, rgb, normal = exists[is_brick], rgb[is_brick], normal[is_brick].view("i1")
brick, place = numpy.nonzero(exists)  # in the order of the columns alpha and plane
rgb, normal = rgb[brick, place], normal[brick, place]

# %% Voxels: index in the cell, position, colour, normal. Constant nodes (solid blocks) are left out here.
level = shard[f"lod_{lod}"]
key = nodes["key"][here][is_brick]
corner = numpy.stack([bits_of(key, axis, 21) for axis in range(3)], axis=1)
index = 8 * corner[brick] + numpy.stack([place & 7, place >> 3 & 7, place >> 6], axis=1)
position_m = corner_m + (index + 0.5) * voxel_m
assert len(rgb) == len(index)
if "normal" in level:
    u, v = normal.astype(float).T / 127
    w = 1 - abs(u) - abs(v)
    fold = w < 0
    u, v = (numpy.where(fold, (1 - abs(v)) * numpy.where(u < 0, -1, 1), u),
            numpy.where(fold, (1 - abs(u)) * numpy.where(v < 0, -1, 1), v))
    slope_deg = numpy.degrees(numpy.arccos(w / numpy.sqrt(u * u + v * v + w * w)))
if "plane" in level:  # distance of the surface from the centre of the voxel along the normal, in metres
    plane = level["plane"][:].astype(int)
    unit = numpy.sqrt(u * u + v * v + w * w)  # of the normal with |x| + |y| + |z| = 1
    sheet_m = numpy.where(plane == 0, numpy.nan, ((plane >> 2) - 8) / 7 * voxel_m / 2 / unit)
print(f"{len(rgb)} voxels in {len(exists)} bricks, {len(rgb) / len(exists):.0f} a brick")
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
