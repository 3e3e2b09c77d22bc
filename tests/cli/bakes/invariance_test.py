#!/usr/bin/env python3
"""The same scene gives the same voxels, however it is cut, ordered, scheduled or placed.

Usage: invariance_test.py GIGABAKE SOURCE_DIR
"""
import json
import math
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

SEED = 20260611
VOXEL_M = 0.25
SNAP = 1024  # vertices lie on multiples of 1/1024 m = 1/256 voxel


def hills(seed=SEED, quads=48, step=0.37):
    """Returns bumpy, coloured ground of 2·quads² triangles with a few large triangles through it."""
    random = numpy.random.default_rng(seed)
    grid = numpy.arange(quads + 1) * step - quads * step / 2
    x, z = numpy.meshgrid(grid, grid)
    y = 1.5 * numpy.sin(x) * numpy.cos(0.7 * z) + 0.1 * random.standard_normal(x.shape)
    positions = numpy.stack([x, y, z], -1).reshape(-1, 3)
    corner = numpy.arange(quads)[:, None] * (quads + 1) + numpy.arange(quads)
    below = corner + quads + 1
    squares = numpy.stack([corner, below, corner + 1, corner + 1, below, below + 1], -1)
    large = random.uniform(-8, 8, (30, 3))
    indices = numpy.concatenate([squares.reshape(-1, 3), len(positions) + numpy.arange(30).reshape(-1, 3)])
    positions = numpy.round(numpy.concatenate([positions, large]) * SNAP) / SNAP
    colours = random.integers(0, 256, (len(positions), 4))
    colours[:, 3] = 255
    return positions, indices, colours


def ecef_from_enu(latitude_deg, longitude_deg, height_m):
    """Returns the column-major 4 × 4 matrix, WGS84."""
    a, f = 6378137.0, 1 / 298.257223563
    e2 = f * (2 - f)
    lat, lon = math.radians(latitude_deg), math.radians(longitude_deg)
    sp, cp, sl, cl = math.sin(lat), math.cos(lat), math.sin(lon), math.cos(lon)
    n = a / math.sqrt(1 - e2 * sp * sp)
    centre = [(n + height_m) * cp * cl, (n + height_m) * cp * sl, (n * (1 - e2) + height_m) * sp]
    return [-sl, cl, 0, 0, -sp * cl, -sp * sl, cp, 0, cp * cl, cp * sl, sp, 0, *centre, 1]


class Invariance(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.count = 0
        cls.positions, cls.indices, cls.colours = hills()
        cls.one = cls.root / "one.glb"
        harness.write_glb(cls.one, cls.positions, cls.indices, cls.colours)
        cls.four = cls.root / "four"
        cls.four.mkdir()
        for k in range(4):
            harness.write_glb(cls.four / f"part{k}.glb", cls.positions, cls.indices[k::4], cls.colours)
        cls.reference = cls.bake(cls.one)

    @classmethod
    def bake(cls, source, *arguments, **options):
        cls.count += 1
        cls.out = cls.root / f"out{cls.count}"
        return PROGRAM.bake(source, cls.out, VOXEL_M, *arguments, **options)

    def expect_same(self, info, lods=None):
        self.assertEqual(harness.lod_hashes(info, lods), harness.lod_hashes(self.reference, lods), f"seed {SEED}")
        if lods is None:
            self.assertEqual(info["content_hash"], self.reference["content_hash"])

    def test_reference_has_voxels(self):
        self.assertGreater(self.reference["lods"][0]["voxels"], 5000)
        self.assertEqual(self.reference["losses"], [])

    def test_any_number_of_ranks(self):
        whole = self.bake(self.four, "--cell-voxels", 16)
        for ranks in (1, 2, 3, 5):
            info = self.bake(self.four, "--cell-voxels", 16, ranks=ranks)
            self.assertEqual(info["content_hash"], whole["content_hash"], f"{ranks} ranks")
            self.assertGreater(info["cells"], 8)

    def test_any_number_of_threads(self):
        for threads in (1, 2, 7):
            self.expect_same(self.bake(self.one, "--threads", threads))

    def test_any_memory(self):
        for memory in ("64M", "1G", "0"):
            self.expect_same(self.bake(self.one, "--memory", memory))

    def test_triangles_and_vertices_permuted(self):
        random = numpy.random.default_rng(SEED)
        order = random.permutation(len(self.positions))
        place = numpy.argsort(order)
        shuffled = random.permutation(place[self.indices])
        harness.write_glb(self.root / "shuffled.glb", self.positions[order], shuffled, self.colours[order])
        self.expect_same(self.bake(self.root / "shuffled.glb"))

    def test_one_file_or_four(self):
        self.expect_same(self.bake(self.four))

    def test_any_cell_size_on_the_levels_that_share_the_lattice(self):
        for cell_voxels in (8, 32, 64, 256, 2048):
            lods = min(4, cell_voxels.bit_length() - 3)
            self.expect_same(self.bake(self.one, "--cell-voxels", cell_voxels), lods)

    def test_every_surface_rule_and_filter(self):
        for surface in ("area", "conservative", "thin"):
            for mip in ("coverage", "thesis", "box"):
                options = ("--surface", surface, "--mip", mip)
                one = self.bake(self.one, *options, "--threads", 1)
                four = self.bake(self.four, *options, "--cell-voxels", 64, ranks=2)
                self.assertEqual(harness.lod_hashes(one, 4), harness.lod_hashes(four, 4), options)

    def test_moving_the_scene_by_whole_voxels_moves_the_voxels(self):
        shift = numpy.array([40, -24, 16])  # scene axes; multiples of 8, so that coarser levels are shifted too
        east, north, up = shift * VOXEL_M
        self.bake(self.one, "--cell-voxels", 64)
        PROGRAM.succeed("export", self.out / "scene.xml", "--to", "ply", "-o", self.root / "a.ply")
        harness.write_glb(self.root / "moved.glb", self.positions, self.indices, self.colours, (east, up, -north))
        self.bake(self.root / "moved.glb", "--cell-voxels", 64)
        PROGRAM.succeed("export", self.out / "scene.xml", "--to", "ply", "-o", self.root / "b.ply")
        a, b = harness.read_ply(self.root / "a.ply"), harness.read_ply(self.root / "b.ply")
        numpy.testing.assert_array_equal(a["ijk"] + shift, b["ijk"])
        numpy.testing.assert_array_equal(a["rgba"], b["rgba"])
        numpy.testing.assert_array_equal(a["n"], b["n"])

    def test_moving_scene_and_lattice_together_changes_no_voxel(self):
        harness.write_glb(self.root / "away.glb", self.positions, self.indices, self.colours, (512.5, -3.25, 96.75))
        moved = self.bake(self.root / "away.glb", "--lattice-origin", "512.5,-96.75,-3.25")
        self.expect_same(moved)

    def test_on_the_earth_as_in_its_own_frame(self):
        tileset = {"asset": {"version": "1.1"}, "geometricError": 10,
                   "root": {"transform": ecef_from_enu(46.5, 8.25, 1234.5), "geometricError": 0, "refine": "ADD",
                            "boundingVolume": {"box": [0, 0, 0, 20, 0, 0, 0, 20, 0, 0, 0, 20]},
                            "content": {"uri": "one.glb"}}}
        path = self.root / "tileset.json"
        path.write_text(json.dumps(tileset))
        info = self.bake(path)
        self.assertAlmostEqual(info["origin"]["latitude_deg"], 46.5, 8)
        self.assertAlmostEqual(info["origin"]["height_m"], 1234.5, 4)
        self.expect_same(info)

    def test_baking_again_takes_the_shards_over(self):
        first = self.bake(self.four, "--cell-voxels", 64)
        shards = {p.name: p.stat().st_mtime_ns for p in (self.out / "shards").iterdir()}
        again = PROGRAM.bake(self.four, self.out, VOXEL_M, "--cell-voxels", 64)
        self.assertEqual(again, first)
        self.assertEqual(shards, {p.name: p.stat().st_mtime_ns for p in (self.out / "shards").iterdir()})


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
