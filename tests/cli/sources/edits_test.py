#!/usr/bin/env python3
"""Edits of voxels: a scene .json with `edits` bakes exactly the voxels that the edits select, whatever the cells.

The reference applies the edits to the voxels of a bake without edits, with Python's whole numbers (edit_cases.py).

Usage: edits_test.py GIGABAKE SOURCE_DIR [--rounds N]
"""
import json
import math
import random
import re
import sys
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import earth
import harness
from edit_cases import VOXEL_M, apply, in_rings, random_edit, scene_file, write_ground

OPTIONS = ("--threads", 2)
LATITUDE, LONGITUDE = 47.0, 8.0


# Triangles of a box whose corner i has the higher x, y and z for bits 0, 1 and 2 of i.
BOX_FACES = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
             [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]


def write_box(path, corners):
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in BOX_FACES]
    path.write_text("\n".join(lines) + "\n")


def hashes(folder):
    return harness.lod_hashes(PROGRAM.info(Path(folder) / "scene.xml"))


class Edits(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_ground(cls.root / "ground.glb")
        plain = scene_file(cls.root / "plain.json", [])
        PROGRAM.bake(plain, cls.root / "plain", VOXEL_M, "--cell-voxels", 16, *OPTIONS)
        cls.plain = cls.voxels("plain")

    @classmethod
    def voxels(cls, name):
        PROGRAM.succeed("export", cls.root / name, "-o", cls.root / f"{name}.ply", "--lod", 0)
        found = harness.read_ply(cls.root / f"{name}.ply")
        return {tuple(v["ijk"].tolist()): (tuple(v["rgba"].tolist()), v["n"]) for v in found}

    def bake(self, name, edits, *options, **more):
        source = scene_file(self.root / f"{name}.json", edits)
        PROGRAM.bake(source, self.root / name, VOXEL_M, *(options or ("--cell-voxels", 16)), *OPTIONS, **more)

    def fail_with(self, edits, *expected):
        source = scene_file(self.root / "bad.json", edits)
        result = PROGRAM.run("bake", source, "-o", self.root / "bad", "--voxel-size", VOXEL_M, *OPTIONS)
        self.assertEqual(result.returncode, 2, result)
        lines = [line for line in result.stderr.splitlines() if "bad.json: edits" in line]
        self.assertEqual(len(lines), 1, result.stderr)
        for text in expected:
            self.assertIn(text, lines[0])
        self.assertFalse((self.root / "bad" / "scene.xml").exists())

    def expect_equal(self, found, expected):
        self.assertEqual(set(found), set(expected))
        for voxel, (rgba, normal) in expected.items():
            self.assertEqual(found[voxel][0], rgba, voxel)
            if normal is not None:
                self.assertLess(numpy.abs(found[voxel][1] - normal).max(), 1e-6, voxel)

    def test_random_edits_equal_the_reference_in_whole_numbers(self):
        for seed in range(ROUNDS):
            with self.subTest(seed=seed):
                rng = random.Random(seed)
                edits = [random_edit(rng) for _ in range(rng.randrange(1, 7))]
                self.bake(f"random{seed}", edits)
                self.expect_equal(self.voxels(f"random{seed}"), apply(self.plain, edits))

    def test_cells_ranks_and_order_of_bakes_change_no_voxel(self):
        rng = random.Random(77)
        edits = [random_edit(rng) for _ in range(8)]
        self.bake("whole", edits)
        expected = hashes(self.root / "whole")
        for ranks, edge in ((1, 32), (2, 8), (3, 64)):
            self.bake(f"ranks{ranks}", edits, "--cell-voxels", edge, ranks=ranks)
            self.assertEqual(hashes(self.root / f"ranks{ranks}")[:2], expected[:2], (ranks, edge))
        for count in (3, 0, 6, 8, 2):
            self.bake("steps", edits[:count])
            self.bake("once", edits[:count])
            self.assertEqual(hashes(self.root / "steps"), hashes(self.root / "once"))
            self.assertEqual(harness.cells_of(self.root / "steps"), harness.cells_of(self.root / "once"))
        PROGRAM.succeed("verify", self.root / "steps")

    def test_only_cells_that_an_edit_selects_voxels_of_change(self):
        edit = {"type": "paint", "sphere": {"position_m": [3, 3, 0], "radius_m": 2}, "rgb": [1, 2, 3]}
        touching = {"type": "carve", "box": {"min_m": [3, 3, -4], "max_m": [8, 8, 4]}}
        self.bake("one", [edit])
        before, after = harness.cells_of(self.root / "plain"), harness.cells_of(self.root / "one")
        self.assertEqual(set(before), set(after))
        changed = {name for name in before if before[name] != after[name]}
        self.assertEqual({tuple(name.split("_")[1:3]) for name in changed}, {("0", "0")})
        self.bake("face", [touching])
        changed = {name for name, print_ in before.items() if harness.cells_of(self.root / "face").get(name) != print_}
        self.assertEqual({tuple(name.split("_")[1:3]) for name in changed}, {("0", "0")})

    def test_fill_adds_cells_and_carve_removes_them(self):
        tower = {"type": "fill", "box": {"min_m": [30, 1, 40], "max_m": [31, 2, 41.5]}, "rgb": [9, 8, 7]}
        above = {"type": "fill", "box": {"min_m": [1, 1, 20], "max_m": [2, 2, 21]}, "rgb": [9, 8, 7]}
        hole = {"type": "carve", "box": {"min_m": [0, 0, -20], "max_m": [8, 8, 20]}}
        before = harness.cells_of(self.root / "plain")
        self.bake("towers", [tower, above])
        after = harness.cells_of(self.root / "towers")
        self.assertEqual({name: after.get(name) for name in before}, before)
        self.assertEqual(len(after), len(before) + 2)
        self.expect_equal(self.voxels("towers"), apply(self.plain, [tower, above]))
        self.bake("hole", [hole])
        gone = set(before) - set(harness.cells_of(self.root / "hole"))
        self.assertTrue(gone and all(name.startswith("c_0_0_") for name in gone), gone)
        self.bake("hole", [])
        self.assertEqual(harness.cells_of(self.root / "hole"), before)
        self.assertEqual(hashes(self.root / "hole"), hashes(self.root / "plain"))

    def test_shapes_in_degrees_select_by_the_place_of_a_voxel(self):
        place = {"lon_lat_height": [LONGITUDE, LATITUDE, 100]}
        at = lambda x, y: list(earth.degrees_of(numpy.array([[x, y, 0.0]]), LONGITUDE, LATITUDE, 100)[0, :2])
        low, high = at(-6.1, -5.3), at(4.4, 7.9)
        ring = [at(*p) for p in ((-7.1, -6.3), (8.2, -5.9), (1.7, 9.3))]
        edits = [{"type": "paint", "box": {"min_lon_lat_height": [*low, 98.3], "max_lon_lat_height": [*high, 101.1]},
                  "rgb": [1, 2, 3]},
                 {"type": "carve", "prism": {"rings_lon_lat": [ring], "low_m": 99.9, "high_m": 102}},
                 {"type": "fill", "sphere": {"lon_lat_height": [*at(-8.3, 3.1), 103.7], "radius_m": 1.9},
                  "rgb": [4, 5, 6]},
                 {"type": "fill", "cylinder": {"lon_lat_height": [*at(7.7, -8.4), 99.2], "radius_m": 1.3,
                                               "height_m": 4}, "rgb": [7, 8, 9]}]
        PROGRAM.bake(scene_file(self.root / "earth0.json", [], place), self.root / "earth0", VOXEL_M, *OPTIONS)
        PROGRAM.bake(scene_file(self.root / "earth.json", edits, place), self.root / "earth", VOXEL_M, *OPTIONS)
        before = self.voxels("earth0")
        self.assertEqual(set(before), set(self.plain))
        ijk = numpy.array(list(before))
        degrees = earth.degrees_of((ijk + 0.5) * VOXEL_M, LONGITUDE, LATITUDE, 100)
        expected = dict(before)
        unit = 2.0 ** 30
        fixed = lambda ring: [tuple(math.floor(v * unit + 0.5) for v in p) for p in ring]
        for voxel, (x, y, z) in zip(map(tuple, ijk.tolist()), degrees):
            if low[0] <= x < high[0] and low[1] <= y < high[1] and 98.3 <= z < 101.1:
                expected[voxel] = (1, 2, 3, expected[voxel][0][3]), expected[voxel][1]
            if 99.9 <= z < 102 and in_rings([fixed(ring)], *fixed([(x, y)])[0]):
                del expected[voxel]
        upright = [{"type": "fill", "sphere": {"position_m": [-8.3, 3.1, 3.7], "radius_m": 1.9}, "rgb": [4, 5, 6]},
                   {"type": "fill", "cylinder": {"position_m": [7.7, -8.4, -0.8], "radius_m": 1.3, "height_m": 4},
                    "rgb": [7, 8, 9]}]
        self.expect_equal(self.voxels("earth"), apply(expected, upright))

    def test_edits_apply_before_an_area_of_interest(self):
        edits = [{"type": "fill", "box": {"min_m": [-3, -3, 3], "max_m": [3, 3, 6]}, "rgb": [5, 6, 7]}]
        bounds = ("--bounds", "-2,-2,20,20", "--crs", "scene", "--cell-voxels", 16)
        self.bake("area", edits, *bounds)
        inside = {v: value for v, value in apply(self.plain, edits).items() if -4 <= v[0] < 40 and -4 <= v[1] < 40}
        self.expect_equal(self.voxels("area"), inside)

    def test_a_mesh_of_a_box_has_the_effect_of_the_box(self):
        low, high = [-4.25, -5.5, -3], [3.5, 2.75, 4.25]
        corners = [[(low, high)[i >> c & 1][c] for c in range(3)] for i in range(8)]
        write_box(self.root / "box.obj", corners)
        box = {"type": "carve", "box": {"min_m": low, "max_m": high}}
        self.bake("box", [box])
        for name, mesh in (("inline", {"positions_m": corners, "triangles": BOX_FACES}),
                           ("file", {"path": "box.obj", "up": "z", "position_m": [0, 0, 0]})):
            self.bake(name, [{"type": "carve", "mesh": mesh}])
            self.assertEqual(hashes(self.root / name), hashes(self.root / "box"))
        write_box(self.root / "moved.obj", [[x - 1, y, z + 0.5] for x, y, z in corners])
        PROGRAM.bake(scene_file(self.root / "edited.json", []), self.root / "edited", VOXEL_M, "--cell-voxels", 16)
        shape = f"mesh:{self.root / 'moved.obj'},1,0,-0.5"
        PROGRAM.succeed("edit", self.root / "edited", f"--carve={shape}", "--up=z", "-q")
        self.assertEqual(hashes(self.root / "edited"), hashes(self.root / "box"))

    def test_a_filled_mesh_equals_the_reference_in_whole_numbers(self):
        top, bottom = [0.3, 0.2, 9.7], [0.1, -0.4, 2.3]
        turns = numpy.linspace(0, 6.2, 9)[:8]
        rim = [[4.1 * math.cos(t) + 1, 3.7 * math.sin(t) - 1, 6.1 + 0.3 * (t > 3)] for t in turns]
        faces = [f for i in range(8) for f in ([i, (i + 1) % 8, 8], [(i + 1) % 8, i, 9])]
        mesh = {"positions_m": [*rim, top, bottom], "triangles": faces}
        edit = {"type": "fill", "mesh": mesh, "rgb": [1, 2, 3]}
        self.bake("mesh", [edit])
        self.expect_equal(self.voxels("mesh"), apply(self.plain, [edit]))

    def test_bad_edits_are_one_line_each(self):
        tetrahedron = {"positions_m": [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]],
                       "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3]]}
        ball = {"position_m": [0, 0, 0], "radius_m": 2}
        good = {"type": "carve", "sphere": ball}
        bow = {"rings_m": [[[0, 0], [4, 4], [4, 0], [0, 4]]], "low_m": 0, "high_m": 1}
        for edit, *expected in (
                ({"type": "dig", "sphere": ball}, "type", "carve, fill, paint", "dig"),
                ({"sphere": ball}, "type", "is missing"),
                ({"type": "carve"}, "exactly one shape"),
                ({"type": "carve", "sphere": ball, "box": {}}, "exactly one shape"),
                ({"type": "fill", "sphere": ball}, "rgb", "is missing"),
                ({"type": "carve", "sphere": ball, "rgb": [1, 2, 3]}, "rgb", "no colour"),
                ({"type": "fill", "sphere": ball, "rgb": [1, 2, 256]}, "rgb", "from 0 to 255"),
                ({"type": "fill", "sphere": ball, "rgb": [1, 2, 0.5]}, "rgb", "whole"),
                ({"type": "fill", "sphere": ball, "rgb": [1, 2, 3], "alpha": 3}, "alpha", "only paint"),
                ({"type": "paint", "sphere": ball, "rgb": [1, 2, 3], "alpha": 0}, "alpha", "from 1 to 255"),
                ({"type": "carve", "sphere": {"position_m": [0, 0, 0]}}, "radius_m", "positive"),
                ({"type": "carve", "sphere": {"radius_m": 1}}, "position_m or lon_lat_height"),
                ({"type": "carve", "sphere": {**ball, "colour": 1}}, "unknown member"),
                ({"type": "carve", "box": {"min_m": [0, 0, 0], "max_m": [1, 0, 1]}}, "max_m", "along y"),
                ({"type": "carve", "mesh": tetrahedron}, "is not closed: 3 of 6 edges"),
                ({"type": "carve", "mesh": {**tetrahedron, "triangles": [[0, 1, 4]]}}, "triangles[0]", "indices"),
                ({"type": "carve", "mesh": {"path": "nowhere.obj", "position_m": [0, 0, 0]}}, "nowhere.obj"),
                ({"type": "carve", "prism": bow}, "rings_m", "crosses or touches itself"),
                ({"type": "carve", "prism": {**bow, "rings_m": [[[0, 0], [1, 1]]]}}, "at least three"),
                ({"type": "carve", "sphere": {"lon_lat_height": [8, 47, 0], "radius_m": 2}}, "no place on the earth"),
                ({"type": "carve", "sphere": {"position_m": [900, 0, 0], "radius_m": 2}}, "selects no voxel"),
                ({"type": "carve", "sphere": {"position_m": [0, 0, 0], "radius_m": 1e7}}, "wider than"),
                ({"type": "fill", "box": {"min_m": [0, 0, 0], "max_m": [9e5, 9e5, 9e5]}, "rgb": [0, 0, 0]},
                 "needs more than")):
            with self.subTest(edit=edit):
                self.fail_with([good, edit], "edits[1]", *expected)

    def test_a_hundred_thousand_edits_are_one_bake(self):
        rng = random.Random(5)
        dots = [{"type": "paint", "sphere": {"position_m": [rng.uniform(-12, 12), rng.uniform(-12, 12), 0],
                                             "radius_m": 4}, "rgb": [rng.randrange(256), 0, 0]} for _ in range(100000)]
        cover = {"type": "paint", "box": {"min_m": [-20, -20, -20], "max_m": [20, 20, 20]}, "rgb": [0, 200, 0]}
        self.bake("many", [*dots, cover])
        self.bake("cover", [cover])
        self.assertEqual(hashes(self.root / "many"), hashes(self.root / "cover"))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    ROUNDS = int(sys.argv[sys.argv.index("--rounds") + 1]) if "--rounds" in sys.argv else 12
    harness.main(argv=sys.argv[:1], verbosity=2)
