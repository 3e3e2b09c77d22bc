#!/usr/bin/env python3
"""Edits of a source: `inside`, `outside` and `flatten` cut its triangles along polygons before they become voxels.

The reference is the bake without edits: voxels wholly on one side of a border are equal or missing, and both sides
together have the voxels of the whole. Borders on borders of voxels leave no other voxel.

Usage: source_edits_test.py GIGABAKE SOURCE_DIR [--rounds N]
"""
import json
import math
import random
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import earth
import harness
from edit_cases import EDGE_M, VOXEL_M, in_rings, write_ground

OPTIONS = ("--threads", 2, "-q")
LATITUDE, LONGITUDE = 47.0, 8.0
# A polygon with a hole whose corners are on borders of voxels.
ALIGNED = [[[-6, -5], [7, -5], [7, 4.5], [1, 4.5], [1, 8], [-6, 8]], [[-3, -2], [0, -2], [0, 1.5], [-3, 1.5]]]


def scene_file(path, edits, place=None):
    entry = {"path": "ground.glb", "place": place or {"position_m": [0, 0, 0]}, "edits": edits}
    path.write_text(json.dumps({"gigabake": 1, "sources": [entry]}))
    return path


def random_rings(rng):
    count, x, y = rng.randrange(3, 9), rng.uniform(-5, 5), rng.uniform(-5, 5)
    turns = [2 * math.pi * (i + rng.uniform(0, 0.7)) / count for i in range(count)]
    return [[[x + (r := rng.uniform(2, 8)) * math.cos(t), y + r * math.sin(t)] for t in turns]]


def side_of_voxel(rings, voxel):
    """Returns whether a voxel is inside the polygon, None if the border may cross it."""
    x, y = ((v + 0.5) * VOXEL_M for v in voxel[:2])
    near = any(distance_to_edge(a, b, x, y) < 0.45 for ring in rings for a, b in zip(ring, ring[1:] + ring[:1]))
    return None if near else in_rings(rings, x, y)


def distance_to_edge(a, b, x, y):
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = max(0, min(1, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)))
    return math.hypot(a[0] + t * dx - x, a[1] + t * dy - y)


class SourceEdits(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_ground(cls.root / "ground.glb")
        cls.plain = cls.bake("plain", [])

    @classmethod
    def bake(cls, name, edits, *options, place=None, **more):
        source = scene_file(cls.root / f"{name}.json", edits, place)
        PROGRAM.succeed("bake", source, "-o", cls.root / name, "--voxel-size", VOXEL_M,
                        *(options or ("--cell-voxels", 16)), *OPTIONS, **more)
        PROGRAM.succeed("export", cls.root / name, "-o", cls.root / f"{name}.ply", "--lod", 0)
        found = harness.read_ply(cls.root / f"{name}.ply")
        return {tuple(v["ijk"].tolist()): (tuple(v["rgba"].tolist()), tuple(v["n"].tolist())) for v in found}

    def expect_close(self, found, expected):
        """Compares voxels whose triangles may have been cut: colours at cuts are rounded to the codes of vertices."""
        self.assertLessEqual(numpy.abs(numpy.subtract(found[0], expected[0], dtype=int)).max(), 1)
        self.assertLess(numpy.abs(numpy.subtract(found[1], expected[1])).max(), 0.03)

    def hashes(self, name):
        return harness.lod_hashes(PROGRAM.info(self.root / name / "scene.xml"))

    def test_a_border_on_borders_of_voxels_selects_by_their_centres(self):
        is_inside = lambda v: in_rings(ALIGNED, (v[0] + 0.5) * VOXEL_M, (v[1] + 0.5) * VOXEL_M)
        inside = self.bake("aligned_in", [{"type": "inside", "rings_m": ALIGNED}])
        outside = self.bake("aligned_out", [{"type": "outside", "rings_m": ALIGNED}])
        self.assertEqual(set(inside), {v for v in self.plain if is_inside(v)})
        self.assertEqual(set(outside), {v for v in self.plain if not is_inside(v)})
        for voxel, value in {**inside, **outside}.items():
            self.expect_close(value, self.plain[voxel])

    def test_both_sides_of_random_borders_are_the_whole(self):
        for seed in range(ROUNDS):
            with self.subTest(seed=seed):
                rings = random_rings(random.Random(seed))
                inside = self.bake("in", [{"type": "inside", "rings_m": rings}])
                outside = self.bake("out", [{"type": "outside", "rings_m": rings}])
                self.assertEqual(set(inside) | set(outside), set(self.plain))
                for voxel, value in self.plain.items():
                    side = side_of_voxel(rings, voxel)
                    if side is not None:
                        kept, other = (inside, outside) if side else (outside, inside)
                        self.assertNotIn(voxel, other)
                        self.expect_close(kept[voxel], value)

    def test_flatten_moves_the_part_inside_to_one_height(self):
        for seed in range(ROUNDS):
            with self.subTest(seed=seed):
                rng = random.Random(100 + seed)
                rings, height = random_rings(rng), rng.uniform(-30, 30)
                found = self.bake("flat", [{"type": "flatten", "rings_m": rings, "height_m": height}])
                level = math.floor(height / VOXEL_M)
                columns = {v[:2] for v in self.plain}
                for x, y in columns:
                    side = side_of_voxel(rings, (x, y))
                    heights = {v[2] for v in found if v[:2] == (x, y)} if side is not None else None
                    if side:
                        self.assertEqual(heights, {level})
                        self.assertGreater(found[(x, y, level)][1][2], 0.99)
                for voxel, value in self.plain.items():
                    if side_of_voxel(rings, voxel) is False:
                        self.expect_close(found[voxel], value)
                self.assertLessEqual({v[:2] for v in found}, columns)

    def test_flatten_moves_the_part_inside_to_a_plane(self):
        corners = [[-6, -6, 1.26], [6, -6, 4.26], [-6, 6, 7.26]]
        height = lambda x, y: 1.26 + 3 * (x + 6) / 12 + 6 * (y + 6) / 12
        ring = [[-6, -6], [6, -6], [6, 6], [-6, 6]]
        found = self.bake("plane", [{"type": "flatten", "rings_m": [ring], "through_m": corners}])
        normal = numpy.array([-0.25, -0.5, 1]) / math.hypot(0.25, 0.5, 1)
        inside = {v: value for v, value in found.items() if all(-11 <= c < 11 for c in v[:2])}
        self.assertEqual({v[:2] for v in inside}, {(x, y) for x in range(-11, 11) for y in range(-11, 11)})
        for (x, y, z), (_, n) in inside.items():
            steps = [height((x + dx) * VOXEL_M, (y + dy) * VOXEL_M) / VOXEL_M for dx in (0, 1) for dy in (0, 1)]
            self.assertTrue(math.floor(min(steps) - 0.01) <= z <= math.floor(max(steps) + 0.01), (x, y, z))
            self.assertLess(numpy.abs(normal - n).max(), 0.03)

    def test_raise_moves_the_part_inside_up_or_down(self):
        for voxels in (9, -40):
            found = self.bake("raised", [{"type": "raise", "rings_m": ALIGNED, "by_m": voxels * VOXEL_M}])
            is_inside = lambda v: in_rings(ALIGNED, (v[0] + 0.5) * VOXEL_M, (v[1] + 0.5) * VOXEL_M)
            expected = {(*v[:2], v[2] + voxels * is_inside(v)): value for v, value in self.plain.items()}
            self.assertEqual(set(found), set(expected))
            for voxel, value in expected.items():
                self.expect_close(found[voxel], value)

    def test_edits_apply_in_their_order(self):
        flat = {"type": "flatten", "rings_m": [[[-4, -4], [4, -4], [4, 4], [-4, 4]]], "height_m": 12.1}
        hole = {"type": "outside", "rings_m": [[[-2, -2], [2, -2], [2, 2], [-2, 2]]]}
        found = self.bake("order", [flat, hole])
        self.assertEqual({v[:2] for v in self.plain} - {v[:2] for v in found},
                         {(x, y) for x in range(-4, 4) for y in range(-4, 4)})
        self.assertEqual({v[2] for v in found if -8 <= v[0] < 8 and -8 <= v[1] < 8}, {24})

    def test_cells_and_ranks_change_no_voxel(self):
        edits = [{"type": "outside", "rings_m": random_rings(random.Random(5))},
                 {"type": "flatten", "rings_m": random_rings(random.Random(6)), "height_m": 7.3}]
        whole = self.bake("cells", edits)
        expected = self.hashes("cells")[:2]
        for ranks, edge in ((1, 64), (2, 8), (3, 32)):
            self.assertEqual(self.bake(f"cells{edge}", edits, "--cell-voxels", edge, ranks=ranks), whole)
            self.assertEqual(self.hashes(f"cells{edge}")[:2], expected)
        self.bake("cells", [])
        self.assertEqual(self.hashes("cells"), self.hashes("plain"))
        self.assertEqual(harness.cells_of(self.root / "cells"), harness.cells_of(self.root / "plain"))

    def test_only_cells_near_a_border_have_other_fingerprints(self):
        self.bake("near", [{"type": "outside", "rings_m": [[[2, 2], [5, 2], [5, 5]]]}])
        before, after = harness.cells_of(self.root / "plain"), harness.cells_of(self.root / "near")
        changed = {name for name in before if before[name] != after.get(name)}
        self.assertTrue(changed and all(name.startswith("c_0_0_") for name in changed), changed)

    def test_polygons_in_degrees_have_the_same_effect(self):
        place = {"lon_lat_height": [LONGITUDE, LATITUDE, 100]}
        at = lambda p: list(earth.degrees_of(numpy.array([[*p, 0.0]]), LONGITUDE, LATITUDE, 100)[0, :2])
        rings = random_rings(random.Random(9))
        edit = {"type": "flatten", "rings_m": rings, "height_m": 5.1}
        metres = self.bake("metres", [edit], place=place)
        degrees = self.bake("degrees", [{"type": "flatten", "rings_lon_lat": [[at(p) for p in rings[0]]],
                                         "height_m": 105.1}], place=place)
        differing = [v for v in set(metres) | set(degrees) if metres.get(v) != degrees.get(v)]
        self.assertTrue(all(side_of_voxel(rings, v) is None for v in differing), differing)

    def test_bad_edits_are_one_line_each(self):
        good = {"type": "inside", "rings_m": ALIGNED}
        for edit, *expected in (
                ({**good, "type": "invert"}, "type", "inside, outside, flatten, raise"),
                ({"type": "inside"}, "rings_m or rings_lon_lat"),
                ({**good, "height_m": 3}, "height_m", "only flatten has"),
                ({**good, "type": "flatten"}, "height_m", "is missing"),
                ({**good, "type": "raise", "height_m": 2}, "height_m", "only flatten has"),
                ({**good, "type": "flatten", "through_m": [[0, 0, 1], [1, 1, 2], [2, 2, 3]]}, "on one line"),
                ({**good, "type": "flatten", "through_lon_lat_height": [[0, 0, 1]]}, "through_m", "same frame"),
                ({**good, "through_m": [[0, 0, 1], [1, 1, 2], [2, 0, 3]]}, "through_m", "only flatten has"),
                ({**good, "type": "raise", "by_m": "2"}, "by_m", "expected a number"),
                ({"type": "inside", "rings_m": [[[0, 0], [4, 4], [4, 0], [0, 4]]]}, "crosses or touches itself"),
                ({"type": "inside", "rings_m": [ALIGNED[0], [[90, 90], [91, 90], [91, 91]]]}, "lies outside"),
                ({"type": "inside", "rings_lon_lat": [[[8, 47], [9, 47], [9, 48]]]}, "no place on the earth")):
            with self.subTest(edit=edit):
                source = scene_file(self.root / "bad.json", [good, edit])
                result = PROGRAM.run("bake", source, "-o", self.root / "bad", "--voxel-size", VOXEL_M)
                self.assertEqual(result.returncode, 2, result)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                for text in ("bad.json: sources[0].edits[1]", *expected):
                    self.assertIn(text, result.stderr)
                self.assertFalse((self.root / "bad").exists())


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    ROUNDS = int(sys.argv[sys.argv.index("--rounds") + 1]) if "--rounds" in sys.argv else 5
    harness.main(argv=sys.argv[:1], verbosity=2)
