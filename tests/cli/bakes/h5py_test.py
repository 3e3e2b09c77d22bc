#!/usr/bin/env python3
"""docs/format.md suffices to read a shard: voxels that this script decodes with h5py equal the exported voxels.

Usage: h5py_test.py GIGABAKE SOURCE_DIR
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from h5py_there import h5py, numpy

import harness

BRICK, CONSTANT, LEAF_CONSTANT = 0, 1, 2
VOXEL_M = 0.25


def slab_and_hills():
    """Returns bumpy ground, and a solid block of stacked squares, which gives constant nodes."""
    random = numpy.random.default_rng(7)
    grid = numpy.arange(33) * 0.5
    x, z = numpy.meshgrid(grid, grid)
    ground = numpy.stack([x, numpy.sin(x) + 0.2 * random.standard_normal(x.shape), -z], -1).reshape(-1, 3)
    squares = harness.squares_of_grid(33)
    layers = [[[0, y, 0], [8, y, 0], [8, y, -8], [0, y, -8]] for y in 8 + numpy.arange(33) * VOXEL_M]
    first = len(ground) + 4 * numpy.arange(33)[:, None]
    indices = numpy.concatenate([squares.reshape(-1), (first + [0, 1, 2, 0, 2, 3]).reshape(-1)])
    positions = numpy.concatenate([ground, numpy.reshape(layers, (-1, 3))])
    colours = random.integers(0, 256, (len(positions), 4))
    colours[len(ground):] = [200, 100, 50, 255]
    colours[:, 3] = 255
    return positions, indices, colours


def from_morton(key):
    """Decodes a Morton key. Bit 0 of each three belongs to x."""
    return [sum((int(key) >> (3 * bit + axis) & 1) << bit for bit in range(21)) for axis in range(3)]


def values_of(level, name, brick, places):
    """Returns the bytes of one channel of a brick's voxels, in their order."""
    value, begin, end = level[name], *level["first"][brick:brick + 2]
    if f"{name}_share" not in level:
        return value[begin:end] if len(value) == level["first"][-1] else numpy.repeat(value, end - begin, axis=0)
    share, mine, begin = level[f"{name}_share"][brick], {}, level[f"{name}_first"][brick]
    octant, group = (places // 4) @ [1, 2, 4], (places // 2 % 2) @ [1, 2, 4]
    for v, (o, g) in enumerate(zip(octant, group)):
        by = 0 if share[9] else (o,) if share[8] >> o & 1 else (o, g) if share[o] >> g & 1 else v + 1
        mine.setdefault(by, len(mine))
        places[v, 0] = begin + mine[by]
    return value[places[:, 0]]


def brick_voxels(level, brick):
    """Returns places inside the brick, colours and normals, in their stored order."""
    mask = level["mask"][brick].view("u1").reshape(8, 8)  # [z][y], one bit per x
    places = numpy.argwhere(numpy.unpackbits(mask[:, :, None], axis=2, bitorder="little"))[:, ::-1]
    begin, end = level["first"][brick:brick + 2]
    assert len(places) == end - begin
    rgb, alpha, normal = (values_of(level, name, brick, places.copy()) for name in ("rgb", "alpha", "normal"))
    return places, numpy.column_stack([rgb, alpha]), normal


def level_of(shard, lod):
    """Returns lattice index, colour and normal of each voxel of a level; constant nodes are expanded."""
    nodes = {name: column[:] for name, column in shard["nodes"].items()}
    level = {name: column[:] for name, column in shard[f"lod_{lod}"].items()}
    corner = shard.attrs["lattice_min"] >> lod
    parts = []
    for n in numpy.flatnonzero(nodes["lod"] >= lod):
        down, kind = int(nodes["lod"][n]) - lod, nodes["kind"][n]
        if kind == BRICK and down == 0:
            places, rgba, normal = brick_voxels(level, nodes["value"][n])
        elif kind == LEAF_CONSTANT or kind == CONSTANT and down == 0:
            places = numpy.indices([8 << down] * 3).reshape(3, -1).T
            rgba = numpy.tile(nodes["value"][n:n + 1].view("u1"), (len(places), 1))
            normal = numpy.tile(nodes["normal"][n], (len(places), 1))
        else:
            continue
        parts.append((corner + numpy.array(from_morton(nodes["key"][n])) * (8 << down) + places, rgba, normal))
    return [numpy.concatenate(column) for column in zip(*parts)]


def unit_vectors(octahedral):
    xy = octahedral / 127.0
    z = 1 - abs(xy).sum(1)
    folded = (1 - abs(xy[:, ::-1])) * numpy.where(xy < 0, -1, 1)
    vectors = numpy.column_stack([numpy.where(z[:, None] < 0, folded, xy), z])
    return vectors / numpy.linalg.norm(vectors, axis=1, keepdims=True)


class ShardsByH5py(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        harness.write_glb(cls.root / "scene.glb", *slab_and_hills())
        cls.info = PROGRAM.bake(cls.root / "scene.glb", cls.root / "out", VOXEL_M, "--cell-voxels", 64)
        cls.scene = cls.root / "out/scene.xml"
        cls.shards = sorted((cls.root / "out/shards").glob("c_*.h5"))

    def decoded(self, lod):
        parts = []
        for path in self.shards:
            with h5py.File(path) as shard:
                parts.append(level_of(shard, lod))
        index, rgba, normal = [numpy.concatenate(column) for column in zip(*parts)]
        order = numpy.lexsort(index.T)
        return index[order], rgba[order], normal[order]

    def test_scene_has_more_than_one_shard_and_constant_nodes(self):
        self.assertGreater(len(self.shards), 1)
        kinds = set()
        for path in self.shards:
            with h5py.File(path) as shard:
                kinds |= set(shard["nodes/kind"][:])
        self.assertIn(BRICK, kinds)
        self.assertTrue(kinds & {CONSTANT, LEAF_CONSTANT}, "the solid block has constant nodes")

    def test_decoded_voxels_are_those_that_export_writes(self):
        for lod in range(4):
            PROGRAM.succeed("export", self.scene, "--to", "ply", "--lod", lod, "-o", self.root / "v.ply")
            vertices = harness.read_ply(self.root / "v.ply")
            index, rgba, normal = self.decoded(lod)
            with self.subTest(lod=lod):
                self.assertEqual(len(index), self.info["lods"][lod]["voxels"])
                numpy.testing.assert_array_equal(vertices["ijk"], index)
                numpy.testing.assert_array_equal(vertices["rgba"], rgba)
                numpy.testing.assert_allclose(vertices["n"], unit_vectors(normal), atol=1e-6)
                numpy.testing.assert_allclose(vertices["p"], (index + 0.5) * VOXEL_M * 2**lod, rtol=0, atol=1e-9)

    def test_attributes_say_what_the_shard_is(self):
        for path in self.shards:
            with h5py.File(path) as shard:
                self.assertEqual(shard.attrs["format"], b"gigabake-shard")
                self.assertEqual(shard.attrs["version"], 6)
                self.assertEqual(shard.attrs["voxel_size_m"], VOXEL_M)
                self.assertEqual(shard.attrs["cell_voxels"], 8 << (shard.attrs["lods"] - 1))
                self.assertEqual(len(shard.attrs["content_hash"].split()), shard.attrs["lods"])

    def test_lz4_holds_the_same_as_deflate(self):
        PROGRAM.bake(self.root / "scene.glb", self.root / "lz4", VOXEL_M, "--cell-voxels", 64, "--codec", "lz4")
        for path in self.shards:
            packed = next((self.root / "lz4/shards").glob(path.name.split("-")[0] + "-*.h5"))
            with h5py.File(path) as shard, h5py.File(packed) as other:
                self.assertIn("32004", other["lod_0/mask"]._filters)
                self.assertEqual(set(shard), set(other))
                for group in shard:
                    for name in shard[group]:
                        numpy.testing.assert_array_equal(shard[group][name], other[group][name])

    def test_values_are_shared_somewhere_and_constant_somewhere(self):
        forms = set()
        for path in self.shards:
            with h5py.File(path) as shard:
                for lod in range(shard.attrs["lods"]):
                    level = shard[f"lod_{lod}"]
                    forms |= {"shared" for name in level if name.endswith("_share")}
                    forms |= {"constant" for name in ("rgb", "alpha", "normal")
                              if len(level[name]) == 1 < level["first"][-1]}
        self.assertEqual(forms, {"shared", "constant"})

    def test_columns_are_deflated_chunks_with_a_checksum(self):
        with h5py.File(self.shards[0]) as shard:
            for name in ("lod_0/mask", "lod_0/first", "lod_0/rgb", "lod_0/alpha", "lod_0/normal", "nodes/key"):
                self.assertEqual(shard[name].compression, "gzip", name)
                self.assertTrue(shard[name].fletcher32, name)
            for name in ("lod_0/first", "nodes/key", "nodes/first_child", "nodes/value"):
                self.assertTrue(shard[name].shuffle, name)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
