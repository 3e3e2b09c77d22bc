#!/usr/bin/env python3
"""Edits of voxels: a scene .json with `edits` bakes exactly the voxels that the edits select, whatever the cells.

The reference applies the edits to the voxels of a bake without edits, with Python's whole numbers. Shapes are rounded
to 1/256 voxel once; a voxel is selected if its centre is inside.

Usage: edits_test.py GIGABAKE SOURCE_DIR [--rounds N]
"""
import itertools
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

VOXEL_M = 0.5
SUB = 256
EDGE_M = 24.0
OPTIONS = ("--threads", 2)
LATITUDE, LONGITUDE = 47.0, 8.0


def write_ground(path):
    """Writes a wavy square of EDGE_M metres around the origin, with vertex colours."""
    vertices = 25
    x, y = numpy.meshgrid(*[numpy.linspace(-EDGE_M / 2, EDGE_M / 2, vertices)] * 2)
    z = 1.5 * numpy.sin(x / 3) + 1.1 * numpy.cos(y / 4)
    colours = numpy.full((vertices * vertices, 4), 255)
    colours[:, 0] = numpy.arange(vertices * vertices) % 251
    harness.write_glb(path, numpy.stack([x, z, -y], -1).reshape(-1, 3), harness.squares_of_grid(vertices), colours)


def scene_file(path, edits, place=None):
    entry = {"path": "ground.glb", "place": place or {"position_m": [0, 0, 0]}}
    path.write_text(json.dumps({"gigabake": 1, "sources": [entry], "edits": edits}))
    return path


def sub_voxels(metres):
    return math.floor(metres / VOXEL_M * SUB + 0.5)


def in_box(shape):
    low, high = ([sub_voxels(v) for v in shape[key]] for key in ("min_m", "max_m"))
    return lambda p: all(low[c] <= p[c] < high[c] for c in range(3))


def in_sphere(shape):
    centre, radius = [sub_voxels(v) for v in shape["position_m"]], sub_voxels(shape["radius_m"])
    return lambda p: sum((p[c] - centre[c]) ** 2 for c in range(3)) <= radius ** 2


def in_cylinder(shape):
    base, radius = [sub_voxels(v) for v in shape["position_m"]], sub_voxels(shape["radius_m"])
    top = sub_voxels(shape["position_m"][2] + shape["height_m"])
    return lambda p: (base[2] <= p[2] < top and sum((p[c] - base[c]) ** 2 for c in range(2)) <= radius ** 2)


def in_rings(rings, x, y):
    """Counts crossings of a ray to the east, with whole numbers."""
    inside = False
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
            if (ay, ax) > (by, bx):
                ax, ay, bx, by = bx, by, ax, ay
            if ay <= y < by and (bx - ax) * (y - ay) > (by - ay) * (x - ax):
                inside = not inside
    return inside


def in_prism(shape):
    rings = [[(sub_voxels(x), sub_voxels(y)) for x, y in ring] for ring in shape["rings_m"]]
    low, high = sub_voxels(shape["low_m"]), sub_voxels(shape["high_m"])
    return lambda p: low <= p[2] < high and in_rings(rings, p[0], p[1])


SHAPES = {"box": in_box, "sphere": in_sphere, "cylinder": in_cylinder, "prism": in_prism}


def bounds_m(name, shape):
    """Returns a box in metres around a shape."""
    if name == "box":
        return shape["min_m"], shape["max_m"]
    if name == "prism":
        corners = numpy.array([p for ring in shape["rings_m"] for p in ring])
        return [*corners.min(0), shape["low_m"]], [*corners.max(0), shape["high_m"]]
    at, radius = numpy.array(shape["position_m"]), shape["radius_m"]
    return at - radius, at + max(radius, shape.get("height_m", 0))


def shape_of(edit):
    name = next(key for key in SHAPES if key in edit)
    return name, edit[name]


def centre(voxel):
    return [SUB * v + SUB // 2 for v in voxel]


def voxels_around(low, high):
    """Returns all voxels of a box in metres, with a margin."""
    ranges = [range(math.floor(low[c] / VOXEL_M) - 2, math.floor(high[c] / VOXEL_M) + 3) for c in range(3)]
    return itertools.product(*ranges)


def octahedral(n):
    """Returns the decoded unit normal of a direction."""
    x, y, z = n
    total = abs(x) + abs(y) + abs(z)
    u, v = x / total, y / total
    if z < 0:
        u, v = (1 - abs(v)) * (-1 if u < 0 else 1), (1 - abs(u)) * (-1 if v < 0 else 1)
    u, v = math.floor(u * 127 + 0.5) / 127, math.floor(v * 127 + 0.5) / 127
    z = 1 - abs(u) - abs(v)
    if z < 0:
        u, v = (1 - abs(v)) * (-1 if u < 0 else 1), (1 - abs(u)) * (-1 if v < 0 else 1)
    return numpy.array([u, v, z]) / math.sqrt(u * u + v * v + z * z)


def surface_normal(is_selected, voxel):
    """Returns the normal of a filled voxel on the surface of its shape; None of an inner voxel."""
    outside = [o for o in itertools.product((-1, 0, 1), repeat=3)
               if not is_selected(centre([voxel[c] + o[c] for c in range(3)]))]
    if not outside:
        return None
    total = numpy.sum(outside, 0)
    return octahedral(total if total.any() else (0, 0, 1))


def apply(voxels, edits):
    """Applies edits to a dictionary of (rgba, normal) by voxel."""
    voxels = dict(voxels)
    for edit in edits:
        name, shape = shape_of(edit)
        is_selected = SHAPES[name](shape)
        if edit["type"] == "fill":
            for voxel in voxels_around(*bounds_m(name, shape)):
                if is_selected(centre(voxel)):
                    voxels[voxel] = (*edit["rgb"], 255), surface_normal(is_selected, voxel)
            continue
        for voxel in [v for v in voxels if is_selected(centre(v))]:
            if edit["type"] == "carve":
                del voxels[voxel]
            else:
                rgba, normal = voxels[voxel]
                voxels[voxel] = (*edit["rgb"], edit.get("alpha", rgba[3])), normal
    return voxels


def random_edit(rng):
    """Returns an edit whose shape is near the ground. Half of all coordinates lie on centres or borders of voxels."""
    def metres(limit):
        value = rng.uniform(-limit, limit)
        return round(value / (VOXEL_M / 2)) * (VOXEL_M / 2) if rng.random() < 0.5 else value

    def length(limit):
        return abs(metres(limit)) + VOXEL_M
    type = rng.choice(("carve", "fill", "paint"))
    x, y, z = metres(EDGE_M / 2 - 2), metres(EDGE_M / 2 - 2), metres(3)
    name = rng.choice(list(SHAPES))
    if name == "box":
        shape = {"min_m": [x, y, z - 3], "max_m": [x + length(5), y + length(5), z + 3]}
    elif name == "sphere":
        shape = {"position_m": [x, y, z], "radius_m": length(3) + 1}
    elif name == "cylinder":
        shape = {"position_m": [x, y, z - 3], "radius_m": length(3), "height_m": length(3) + 3}
    else:
        turns = sorted(rng.uniform(0, 2 * math.pi) for _ in range(rng.randrange(3, 8)))
        far = [[x + (r := 3 + length(3)) * math.cos(t), y + r * math.sin(t)] for t in turns]
        rings = [far] if rng.random() < 0.5 else [
            [[x - 4, y - 4], [x + 4, y - 4], [x + 4, y + 4], [x - 4, y + 4]], [[x - 1, y - 1], [x, y + 1], [x + 1, y]]]
        shape = {"rings_m": rings, "low_m": z - 3, "high_m": z + 3}
    edit = {"type": type, name: shape}
    if type != "carve":
        edit["rgb"] = [rng.randrange(256) for _ in range(3)]
    if type == "paint" and rng.random() < 0.3:
        edit["alpha"] = rng.randrange(1, 256)
    return edit


def cells(folder):
    """Returns the fingerprints of the scene's cells by their names."""
    text = (Path(folder) / "scene.xml").read_text(encoding="utf-8")
    return dict(re.findall(r'shards/(c_[-\d_]+)-([0-9a-f]{32})\.h5', text))


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
            self.assertEqual(cells(self.root / "steps"), cells(self.root / "once"))
        PROGRAM.succeed("verify", self.root / "steps")

    def test_only_cells_that_an_edit_selects_voxels_of_change(self):
        edit = {"type": "paint", "sphere": {"position_m": [3, 3, 0], "radius_m": 2}, "rgb": [1, 2, 3]}
        touching = {"type": "carve", "box": {"min_m": [3, 3, -4], "max_m": [8, 8, 4]}}
        self.bake("one", [edit])
        before, after = cells(self.root / "plain"), cells(self.root / "one")
        self.assertEqual(set(before), set(after))
        changed = {name for name in before if before[name] != after[name]}
        self.assertEqual({tuple(name.split("_")[1:3]) for name in changed}, {("0", "0")})
        self.bake("face", [touching])
        changed = {name for name, print_ in before.items() if cells(self.root / "face").get(name) != print_}
        self.assertEqual({tuple(name.split("_")[1:3]) for name in changed}, {("0", "0")})

    def test_fill_adds_cells_and_carve_removes_them(self):
        tower = {"type": "fill", "box": {"min_m": [30, 1, 40], "max_m": [31, 2, 41.5]}, "rgb": [9, 8, 7]}
        above = {"type": "fill", "box": {"min_m": [1, 1, 20], "max_m": [2, 2, 21]}, "rgb": [9, 8, 7]}
        hole = {"type": "carve", "box": {"min_m": [0, 0, -20], "max_m": [8, 8, 20]}}
        before = cells(self.root / "plain")
        self.bake("towers", [tower, above])
        after = cells(self.root / "towers")
        self.assertEqual({name: after.get(name) for name in before}, before)
        self.assertEqual(len(after), len(before) + 2)
        self.expect_equal(self.voxels("towers"), apply(self.plain, [tower, above]))
        self.bake("hole", [hole])
        gone = set(before) - set(cells(self.root / "hole"))
        self.assertTrue(gone and all(name.startswith("c_0_0_") for name in gone), gone)
        self.bake("hole", [])
        self.assertEqual(cells(self.root / "hole"), before)
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

    def test_bad_edits_are_one_line_each(self):
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
