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


def difference(stored):
    """Returns the differences of r, g and b from their predictions, modulo 256: the inverse of YCoCg-R."""
    y, co, cg = int(stored[0]), (int(stored[1]) + 128) % 256 - 128, (int(stored[2]) + 128) % 256 - 128
    t = y - (cg >> 1)
    blue = t - (co >> 1)
    return numpy.array([blue + co, t + cg, blue])


class Brick:
    """The voxels of a brick, by x, y, z."""

    def __init__(self):
        self.exists = numpy.zeros((8, 8, 8), bool)
        self.rgba = numpy.zeros((8, 8, 8, 4), "u1")
        self.normal = numpy.zeros((8, 8, 8, 2), "u1")

    def places(self):
        """Returns x, y, z of the voxels in the order of `alpha`."""
        return numpy.argwhere(self.exists.transpose(2, 1, 0))[:, ::-1]


def constant_brick(nodes, n):
    brick = Brick()
    brick.exists[:] = True
    brick.rgba[:] = nodes["value"][n:n + 1].view("u1")
    brick.normal[:] = nodes["normal"][n].view("u1")
    return brick


def bricks_of(shard, lod, forms=None):
    """Decodes the bricks of a level, by key, one voxel at a time. Constant nodes are decoded as bricks.

    Adds the forms of predictions that occur to `forms`.
    """
    forms = set() if forms is None else forms
    nodes = {name: column[:] for name, column in shard["nodes"].items()}
    level = {name: column[:] for name, column in shard[f"lod_{lod}"].items()}
    above = bricks_of(shard, lod + 1, forms) if lod + 1 < shard.attrs["lods"] else {}
    rows = numpy.flatnonzero(nodes["lod"] == lod)
    count = int((nodes["kind"][rows] == BRICK).sum())
    is_dense = len(level["children"]) == 64 * count
    bricks, number, voxel, group_row = {}, 0, 0, 0
    for n in rows:
        key = int(nodes["key"][n])
        if nodes["kind"][n] != BRICK:
            bricks[key] = constant_brick(nodes, n)
            continue
        if number % 64 == 0:
            assert level["first"][number // 64].tolist()[:2] == [voxel, group_row]
        brick, parent, first_voxel = Brick(), above.get(key >> 3), voxel
        for group in range(64):
            at = tuple(from_morton((key & 7) << 6 | group))
            forms.add("root" if parent is None else "predicted")
            if not is_dense and parent is not None and not parent.exists[at]:
                forms.add("no parent voxel")
                continue
            children, group_row = int(level["children"][group_row]), group_row + 1
            for child in range(8):
                if children >> child & 1:
                    place = tuple(from_morton(group << 3 | child))
                    brick.exists[place] = True
                    rgb, normal = (parent.rgba[at][:3], parent.normal[at]) if parent else (0, 0)
                    brick.rgba[place][:3] = (rgb + difference(level["rgb"][voxel])) % 256
                    brick.normal[place] = normal + level["normal"][voxel].view("u1")
                    voxel += 1
        x, y, z = brick.places().T
        brick.rgba[x, y, z, 3] = level["alpha"][first_voxel:voxel]
        bricks[key], number = brick, number + 1
    assert level["first"][-1].tolist()[:2] == [voxel, group_row] == [len(level["rgb"]), len(level["children"])]
    return bricks


def level_of(shard, lod, forms=None):
    """Returns lattice index, colour and normal of each voxel of a level; constant nodes are expanded."""
    nodes = {name: column[:] for name, column in shard["nodes"].items()}
    bricks = bricks_of(shard, lod, forms)
    corner = shard.attrs["lattice_min"] >> lod
    parts = []
    for n in numpy.flatnonzero(nodes["lod"] >= lod):
        down, key = int(nodes["lod"][n]) - lod, int(nodes["key"][n])
        if down == 0:
            places = bricks[key].places()
            rgba, normal = bricks[key].rgba[tuple(places.T)], bricks[key].normal[tuple(places.T)].view("i1")
        elif nodes["kind"][n] == LEAF_CONSTANT:
            places = numpy.indices([8 << down] * 3).reshape(3, -1).T
            rgba = numpy.tile(nodes["value"][n:n + 1].view("u1"), (len(places), 1))
            normal = numpy.tile(nodes["normal"][n], (len(places), 1))
        else:
            continue
        parts.append((corner + numpy.array(from_morton(key)) * (8 << down) + places, rgba, normal))
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

    def decoded(self, lod, forms):
        parts = []
        for path in self.shards:
            with h5py.File(path) as shard:
                parts.append(level_of(shard, lod, forms))
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
        forms = set()
        for lod in range(4):
            PROGRAM.succeed("export", self.scene, "--to", "ply", "--lod", lod, "-o", self.root / "v.ply")
            vertices = harness.read_ply(self.root / "v.ply")
            index, rgba, normal = self.decoded(lod, forms)
            with self.subTest(lod=lod):
                self.assertEqual(len(index), self.info["lods"][lod]["voxels"])
                numpy.testing.assert_array_equal(vertices["ijk"], index)
                numpy.testing.assert_array_equal(vertices["rgba"], rgba)
                numpy.testing.assert_allclose(vertices["n"], unit_vectors(normal), atol=1e-6)
                numpy.testing.assert_allclose(vertices["p"], (index + 0.5) * VOXEL_M * 2**lod, rtol=0, atol=1e-9)
        self.assertEqual(forms, {"root", "predicted", "no parent voxel"})

    def test_the_lines_of_the_page_decode_the_same_voxels(self):
        text = (SOURCE / "docs/format.md").read_text(encoding="utf-8")
        page = {"numpy": numpy}
        exec(text.split("<!-- decode -->\n```python\n")[1].split("```")[0], page)
        for path in self.shards:
            with h5py.File(path) as shard:
                self.expect_same_bricks(shard, page)

    def expect_same_bricks(self, shard, page):
        nodes = {name: column[:] for name, column in shard["nodes"].items()}
        for lod in reversed(range(shard.attrs["lods"])):
            level = {name: column[:] for name, column in shard[f"lod_{lod}"].items()}
            by_loops = bricks_of(shard, lod)
            above = bricks_of(shard, lod + 1) if lod + 1 < shard.attrs["lods"] else {}
            rows = numpy.flatnonzero((nodes["lod"] == lod) & (nodes["kind"] == BRICK))
            keys = nodes["key"][rows].astype(int)
            places = page["x"], page["y"], page["z"]
            root = Brick()
            root.exists[:] = True
            parents = [above.get(key >> 3, root) for key in keys]
            found = page["decode"](level, keys & 7, numpy.array([p.exists[places] for p in parents]),
                                   numpy.array([p.rgba[places][:, :3] for p in parents]),
                                   numpy.array([p.normal[places] for p in parents]))
            for b, key in enumerate(keys):
                exists, rgb, normal = (values[b] for values in found)
                brick = by_loops[key]
                numpy.testing.assert_array_equal(exists, brick.exists[places])
                numpy.testing.assert_array_equal(rgb[exists], brick.rgba[places][exists, :3])
                numpy.testing.assert_array_equal(normal[exists], brick.normal[places][exists])

    def test_attributes_say_what_the_shard_is(self):
        for path in self.shards:
            with h5py.File(path) as shard:
                self.assertEqual(shard.attrs["format"], b"gigabake-shard")
                self.assertEqual(shard.attrs["version"], 7)
                self.assertEqual(shard.attrs["voxel_size_m"], VOXEL_M)
                self.assertEqual(shard.attrs["cell_voxels"], 8 << (shard.attrs["lods"] - 1))
                self.assertEqual(len(shard.attrs["content_hash"].split()), shard.attrs["lods"])

    def test_lz4_holds_the_same_as_deflate(self):
        PROGRAM.bake(self.root / "scene.glb", self.root / "lz4", VOXEL_M, "--cell-voxels", 64, "--codec", "lz4")
        for path in self.shards:
            packed = next((self.root / "lz4/shards").glob(path.name.split("-")[0] + "-*.h5"))
            with h5py.File(path) as shard, h5py.File(packed) as other:
                self.assertIn("32004", other["lod_0/children"]._filters)
                self.assertEqual(set(shard), set(other))
                for group in set(shard) - {"chunks"}:  # the places of chunks depend on the codec
                    for name in shard[group]:
                        numpy.testing.assert_array_equal(shard[group][name][:], other[group][name][:])

    def test_columns_are_deflated_chunks_with_a_checksum(self):
        with h5py.File(self.shards[0]) as shard:
            for name in ("lod_0/children", "lod_0/first", "lod_0/rgb", "lod_0/alpha", "lod_0/normal", "nodes/key"):
                self.assertEqual(shard[name].compression, "gzip", name)
                self.assertTrue(shard[name].fletcher32, name)
            for name in ("lod_0/first", "lod_0/rgb", "nodes/key", "nodes/first_child", "nodes/value"):
                self.assertTrue(shard[name].shuffle, name)


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(sys.argv[1]), Path(sys.argv[2])
    harness.main(argv=sys.argv[:1], verbosity=2)
