#!/usr/bin/env python3
"""Areas of interest: a bake or plan with --bounds or --clip opens, bakes and keeps only the part inside.

The scene is a tileset of glTF tiles on the earth, whose places the test computes itself. A bake of the whole scene
is the reference: voxels inside must be equal, and no other voxel may exist.

Usage: area_test.py GIGABAKE SOURCE_DIR [--tiles N]
"""
import itertools
import json
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import earth
import harness

LATITUDE, LONGITUDE = 47.0, 8.0
TILE_M = 8.0
# A tile has vertices at 0 to TILE_M, so that neighbours share vertices.
VERTICES = 5
VOXEL_M = 0.5
OPTIONS = ("--cell-voxels", 16, "--threads", 2, "--no-overviews")


def degrees_of(points, longitude=LONGITUDE, latitude=LATITUDE):
    """Returns longitude, latitude and height of points in the scene's frame."""
    return earth.degrees_of(points, longitude, latitude)


def write_tileset(folder, edge, longitude=LONGITUDE, latitude=LATITUDE):
    """Writes edge × edge tiles, each with its own file, around the place. Returns the path of the tileset."""
    folder.mkdir(parents=True)
    rotation, origin = earth.frame(longitude, latitude)
    grid = numpy.linspace(0, TILE_M, VERTICES)
    tiles = []
    for row in range(edge):
        for column in range(edge):
            low = numpy.array([column, row]) * TILE_M - edge * TILE_M / 2
            x, y = numpy.meshgrid(grid + low[0], grid + low[1])
            z = 0.4 * numpy.sin(x) + 0.3 * numpy.cos(y)
            positions = numpy.stack([x, z, -y], -1).reshape(-1, 3)
            colours = numpy.full((len(positions), 4), 255)
            colours[:, 0], colours[:, 1] = 8 * column % 256, 8 * row % 256
            name = f"{column}_{row}.glb"
            harness.write_glb(folder / name, positions, harness.squares_of_grid(VERTICES), colours)
            centre, half = [*(low + TILE_M / 2), 0], TILE_M / 2
            box = [*centre, half, 0, 0, 0, half, 0, 0, 0, 1]
            tiles.append({"boundingVolume": {"box": box}, "geometricError": 0, "content": {"uri": name}})
    half = edge * TILE_M / 2
    matrix = [*rotation[:, 0], 0, *rotation[:, 1], 0, *rotation[:, 2], 0, *origin, 1]
    root = {"transform": matrix, "boundingVolume": {"box": [0, 0, 0, half, 0, 0, 0, half, 0, 0, 0, 1]},
            "geometricError": 100, "refine": "ADD", "children": tiles}
    path = folder / "tileset.json"
    path.write_text(json.dumps({"asset": {"version": "1.0"}, "geometricError": 100, "root": root}))
    return path


def bounds_around(low_m, high_m, longitude=LONGITUDE, latitude=LATITUDE):
    """Returns W, S, E, N around a rectangle of the scene, given in metres from the place."""
    low, high = degrees_of(numpy.array([[*low_m, 0], [*high_m, 0]], float), longitude, latitude)
    return [low[0], low[1], high[0], high[1]]


def text_of(numbers):
    return ",".join(f"{n:.12f}" for n in numbers)


def polygon_file(path, *polygons):
    path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": polygons}))
    return path


def voxels(scene, out):
    """Returns the voxels of lod 0 as a structured array, by lattice index."""
    PROGRAM.succeed("export", scene, "-o", out, "--lod", 0)
    return harness.read_ply(out)


class Area(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.tileset = write_tileset(cls.root / "tiles", 12)
        PROGRAM.bake(cls.tileset, cls.root / "whole", VOXEL_M, *OPTIONS)
        cls.whole = voxels(cls.root / "whole", cls.root / "whole.ply")
        cls.degrees = degrees_of(cls.whole["p"])

    def bake(self, name, *options):
        out = self.root / name
        PROGRAM.bake(self.tileset, out, VOXEL_M, *OPTIONS, *options)
        return out, voxels(out, self.root / f"{name}.ply")

    def expect_equal(self, found, is_inside):
        """Compares voxels with the voxels of the whole bake for which `is_inside` is true."""
        self.assertGreater(is_inside.sum(), 0)
        self.assertLess(is_inside.sum(), len(self.whole))
        expected = self.whole[is_inside]
        self.assertEqual(len(found), len(expected))
        self.assertTrue((found == expected).all())

    def is_within(self, bounds):
        west, south, east, north = bounds[:4]
        x, y = self.degrees[:, 0], self.degrees[:, 1]
        return (west <= x) & (x < east) & (south <= y) & (y < north)

    def test_voxels_within_bounds_equal_the_whole_bake(self):
        bounds = bounds_around((-21.3, -17.9), (14.2, 23.7))
        _, found = self.bake("bounds", "--bounds", text_of(bounds))
        self.expect_equal(found, self.is_within(bounds))

    def test_heights_are_bounds_too(self):
        bounds = bounds_around((-30, -30), (30, 30))
        _, found = self.bake("heights", "--bounds", f"{text_of(bounds)},-0.05,0.3")
        height = self.degrees[:, 2]
        self.expect_equal(found, self.is_within(bounds) & (height >= -0.05) & (height < 0.3))

    def test_cells_inside_keep_their_fingerprints(self):
        low, high = (-21.3, -17.9), (14.2, 23.7)
        out, _ = self.bake("kept", "--bounds", text_of(bounds_around(low, high)))
        whole, part = harness.cells_of(self.root / "whole"), harness.cells_of(out)
        self.assertTrue(set(part) < set(whole))
        edge = 16 * VOXEL_M
        inside = [name for name in whole
                  if all(low[c] < int(name.split("_")[1 + c]) * edge and
                         (int(name.split("_")[1 + c]) + 1) * edge < high[c] for c in range(2))]
        self.assertGreater(len(inside), 4)
        for name in inside:
            self.assertEqual(part[name], whole[name], name)
        self.assertNotEqual([n for n in part if part[n] != whole[n]], [], "cells on the border have other fingerprints")

    def test_a_polygon_with_a_hole_is_cut_by_the_centres_of_voxels(self):
        corner = lambda x, y: list(degrees_of(numpy.array([[x, y, 0.0]]))[0, :2])
        ring = [corner(*p) for p in ((-25.13, -20.37), (27.41, -24.11), (18.3, 30.17), (0.6, 5.29), (-30.7, 22.43))]
        hole = [corner(*p) for p in ((-10.31, -10.77), (9.17, -12.49), (3.71, 1.13))]
        file = polygon_file(self.root / "area.geojson", [[*ring, ring[0]], [*hole, hole[0]]])
        _, found = self.bake("polygon", "--clip", file)
        inside = numpy.zeros(len(self.whole), bool)
        for line in (ring, hole):
            for (x0, y0), (x1, y1) in zip(line, line[1:] + line[:1]):
                x, y = self.degrees[:, 0], self.degrees[:, 1]
                crosses = (y0 > y) != (y1 > y)
                with numpy.errstate(divide="ignore"):
                    inside ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
        self.expect_equal(found, inside)

    def test_bounds_in_metres(self):
        try:
            from osgeo import osr
        except ImportError:
            self.skipTest("python3-gdal is not installed")
        systems = [osr.SpatialReference(), osr.SpatialReference()]
        for system, code in zip(systems, (4326, 25832)):
            system.ImportFromEPSG(code)
            system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        utm = osr.CoordinateTransformation(*systems)
        x, y = numpy.array(utm.TransformPoints(self.degrees[:, :2].tolist()))[:, :2].T
        middle = utm.TransformPoint(LONGITUDE, LATITUDE)
        low, high = (middle[0] - 20.3, middle[1] - 11.4), (middle[0] + 9.1, middle[1] + 25.2)
        bounds = f"{low[0]:.9f},{low[1]:.9f},{high[0]:.9f},{high[1]:.9f}"
        _, found = self.bake("metres", "--bounds", bounds, "--crs", "EPSG:25832")
        self.expect_equal(found, (low[0] <= x) & (x < high[0]) & (low[1] <= y) & (y < high[1]))

    def test_ties_belong_to_the_south_west(self):
        """Bounds through centres of voxels keep the centres on the western and southern bound."""
        p = self.whole["p"]
        west, south = numpy.sort(numpy.unique(p[:, 0]))[30], numpy.sort(numpy.unique(p[:, 1]))[40]
        east, north = west + 20 * VOXEL_M, south + 30 * VOXEL_M
        _, found = self.bake("ties", "--bounds", f"{west},{south},{east},{north}", "--crs", "scene")
        self.expect_equal(found, (west <= p[:, 0]) & (p[:, 0] < east) & (south <= p[:, 1]) & (p[:, 1] < north))

    def test_a_larger_area_bakes_only_new_cells(self):
        small, large = bounds_around((-21, -18), (14, 23)), bounds_around((-21, -18), (33, 23))
        out = self.root / "grown"
        command = ("bake", self.tileset, "-o", out, "--voxel-size", VOXEL_M, "--cell-voxels", 16, "--json")
        PROGRAM.succeed(*command, "--bounds", text_of(small))
        first = harness.cells_of(out)
        report = json.loads(PROGRAM.succeed(*command, "--bounds", text_of(large)))
        second = harness.cells_of(out)
        kept = [n for n in first if second.get(n) == first[n]]
        self.assertGreater(len(kept), len(first) / 2)
        self.assertGreaterEqual(report["cells_taken_over"], len(kept))
        self.assertLess(report["cells_taken_over"], len(second), "new cells are baked")
        PROGRAM.bake(self.tileset, self.root / "large", VOXEL_M, "--cell-voxels", 16, "--bounds", text_of(large))
        PROGRAM.succeed("diff", out, self.root / "large")
        PROGRAM.succeed("verify", out)

    def test_commands_that_read_a_scene_use_the_part_inside(self):
        """A part of the whole scene has the voxels, hits and images of a bake of this part."""
        low, high = (-21.3, -17.9), (14.2, 23.7)
        bounds = ("--bounds", text_of(bounds_around(low, high)))
        voxel = ("--voxel-size", VOXEL_M, "--cell-voxels", 16)
        whole, part = self.root / "read_whole", self.root / "read_part"
        PROGRAM.succeed("bake", self.tileset, "-o", whole, *voxel)
        PROGRAM.succeed("bake", self.tileset, "-o", part, *voxel, *bounds)
        for lod in (0, 1, 2, 4):
            files = [self.root / f"read_{lod}_{name}.ply" for name in ("of_whole", "of_part")]
            PROGRAM.succeed("export", whole, "-o", files[0], "--lod", lod, *bounds)
            PROGRAM.succeed("export", part, "-o", files[1], "--lod", lod)
            found, expected = map(harness.read_ply, files)
            self.assertGreater(len(expected), 0)
            self.assertEqual(len(found), len(expected))
            self.assertTrue((found == expected).all())
        grid = ("--grid", "-30,-30,30,30", "--step", 1.7)
        answers = PROGRAM.succeed("query", whole, *grid, *bounds)
        self.assertEqual(answers, PROGRAM.succeed("query", part, *grid))
        self.assertNotEqual(answers, PROGRAM.succeed("query", whole, *grid))
        images = [self.root / name for name in ("of_whole.png", "of_part.png")]
        view = ("--eye", "5,-70,40", "--target", "0,0,0", "--size", "160x120", "--shadows", "off")
        PROGRAM.succeed("render", whole, "-o", images[0], *view, *bounds)
        PROGRAM.succeed("render", part, "-o", images[1], *view)
        self.assertEqual(images[0].read_bytes(), images[1].read_bytes())

    def test_a_scene_without_a_cell_in_the_area_is_refused(self):
        for command in (("export", "-o", self.root / "none.ply"), ("query", "--at", "0,0"),
                        ("render", "-o", self.root / "none.png")):
            result = PROGRAM.run(command[0], self.root / "whole", *command[1:], "--bounds", "10,10,11,11")
            self.assertEqual(result.returncode, 2, result)
            self.assertIn("no cell of the scene intersects the area", result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1, result)
        # This area lies above the surface, inside the cells.
        low, high = (1.3, 1.3), (1.4, 1.4)
        result = PROGRAM.run("render", self.root / "whole", "-o", self.root / "none.png", "--bounds",
                             f"{text_of(bounds_around(low, high))},3,3.1")
        self.assertEqual(result.returncode, 2, result)
        self.assertIn("no voxel of the scene is inside the area", result.stderr)
        self.assertEqual(list(self.root.glob("none.*")), [])

    def test_an_area_across_the_antimeridian(self):
        tileset = write_tileset(self.root / "pacific", 6, 180.0, -17.0)
        PROGRAM.bake(tileset, self.root / "pacific_whole", VOXEL_M, *OPTIONS)
        whole = voxels(self.root / "pacific_whole", self.root / "pacific_whole.ply")
        degrees = degrees_of(whole["p"], 180.0, -17.0)
        west, south, east, north = bounds_around((-13.1, -9.2), (8.4, 12.3), 180.0, -17.0)
        self.assertGreater(west, east)
        x, y = degrees[:, 0], degrees[:, 1]
        expected = whole[((x >= west) | (x < east)) & (y >= south) & (y < north)]
        ring = [[west, south], [east, south], [east, north], [west, north], [west, south]]
        halves = [[[[west, south], [180, south], [180, north], [west, north], [west, south]]],
                  [[[-180, south], [east, south], [east, north], [-180, north], [-180, south]]]]
        areas = {"bounds": ("--bounds", text_of([west, south, east + 360, north])),
                 "ring": ("--clip", polygon_file(self.root / "ring.geojson", [ring])),
                 "halves": ("--clip", polygon_file(self.root / "halves.geojson", *halves))}
        for name, options in areas.items():
            with self.subTest(name):
                out = self.root / f"pacific_{name}"
                PROGRAM.bake(tileset, out, VOXEL_M, *OPTIONS, *options)
                found = voxels(out, self.root / "found.ply")
                self.assertEqual(len(found), len(expected))
                self.assertTrue((found == expected).all())

    def test_bad_areas(self):
        good = text_of(bounds_around((-9, -9), (9, 9)))
        bad_files = itertools.count()
        ring = lambda *p: polygon_file(self.root / f"bad_{next(bad_files)}.geojson", [list(map(list, p))])
        text = self.root / "text.geojson"
        text.write_text('{"type": "Polygon", "coordinates": [[[0, 0], [1')
        point = self.root / "point.geojson"
        point.write_text('{"type": "Point", "coordinates": [0, 0]}')
        crs = self.root / "crs.geojson"
        crs.write_text('{"type": "Polygon", "crs": {"type": "name", "properties": {"name": "EPSG:25832"}}, '
                       '"coordinates": []}')
        for words, *options in (
                ("--bounds: west 9 is greater than east 8", "--bounds", "9,46,8,48"),
                ("--bounds: south 48 is greater than north 46", "--bounds", "7,48,9,46"),
                ("--bounds: west 8 is equal to east 8", "--bounds", "8,46,8,48"),
                ("--bounds: LOW 5 is equal to HIGH 5", "--bounds", "7,46,9,48,5,5"),
                ("latitudes within ±90", "--bounds", "400000,5200000,410000,5300000"),
                ("--bounds: expected W,S,E,N", "--bounds", "7,46,9"),
                ("--bounds: expected a number", "--bounds", "7,46,9,x"),
                ("crs: is unknown", "--bounds", good, "--crs", "EPSG:999999"),
                ("no place on the earth in --crs EPSG:25832", "--bounds", "1e8,1e8,2e8,2e8", "--crs", "EPSG:25832"),
                ("--crs: is the coordinate system of --bounds", "--crs", "EPSG:25832"),
                ("no tile intersects the area", "--bounds", "10,10,11,11"),
                ("no such file", "--clip", self.root / "missing.geojson"),
                ("not valid JSON", "--clip", text),
                ("type: expected Polygon or MultiPolygon", "--clip", point),
                ("crs: expected longitude and latitude", "--clip", crs),
                ("is not closed", "--clip", ring((0, 0), (1, 0), (1, 1), (0, 1))),
                ("crosses or touches itself", "--clip", ring((0, 0), (1, 1), (1, 0), (0, 1), (0, 0))),
                ("encloses a pole", "--clip", ring((0, 80), (120, 80), (-120, 80), (0, 80))),
                ("expected longitude and latitude in degrees", "--clip", ring((0, 0), (400, 0), (400, 1), (0, 0)))):
            out = self.root / "bad"
            for command in (("plan",), ("bake", "-o", out)):
                with self.subTest(words, command=command[0]):
                    result = PROGRAM.run(*command, self.tileset, "--voxel-size", VOXEL_M, *options)
                    self.assertEqual(result.returncode, 2, result)
                    self.assertEqual(len(result.stderr.splitlines()), 1, result)
                    self.assertIn(words, result.stderr)
                    self.assertFalse(out.exists() and list(out.rglob("*.h5")))
                    self.assertFalse((out / "scene.xml").exists())

    def test_a_local_scene_needs_bounds_in_its_own_metres(self):
        glb = self.root / "tiles/3_3.glb"
        result = PROGRAM.run("plan", glb, "--voxel-size", VOXEL_M, "--bounds", "7,46,9,48")
        self.assertEqual(result.returncode, 2, result)
        self.assertIn("no place on the earth", result.stderr)
        PROGRAM.bake(glb, self.root / "local", VOXEL_M, "--bounds", "-20,-20,-18,-18", "--crs", "scene")
        p = voxels(self.root / "local", self.root / "local.ply")["p"]
        self.assertGreater(len(p), 0)
        self.assertTrue(((p[:, :2] >= -20) & (p[:, :2] < -18)).all())


class Opened(harness.FolderTest):
    """The files that a bake with bounds opens, as the kernel of the system counts them."""

    def test_only_tiles_that_intersect_the_bounds_are_opened(self):
        if shutil.which("strace") is None:
            self.skipTest("strace is not installed")
        edge = TILES
        tileset = write_tileset(self.root / "many", edge)
        # 1 % of the area, and inside the tiles at its border
        half = edge * TILE_M / 20 - 1
        bounds = text_of(bounds_around((-half, -half), (half, half)))
        trace = self.root / "trace"
        command = [PROGRAM.executable, "bake", tileset, "-o", self.root / "out", "--voxel-size", 2,
                   "--cell-voxels", 16, "--bounds", bounds, "--no-overviews", "--json"]
        traced = ["strace", "-f", "-qq", "-e", "trace=openat,open", "-o", trace, *map(str, command)]
        done = subprocess.run(traced, capture_output=True, text=True, timeout=600, check=False)
        if "ptrace" in done.stderr.lower() or "not permitted" in done.stderr.lower():
            self.skipTest("this host does not permit strace")
        self.assertEqual(done.returncode, 0, done.stderr)
        opened = {tuple(map(int, m)) for m in re.findall(r'/(\d+)_(\d+)\.glb"', trace.read_text())}
        first, end = edge * 9 // 20, edge * 11 // 20
        expected = {(c, r) for c in range(first, end) for r in range(first, end)}
        self.assertEqual(opened, expected)
        self.assertIn(f"{edge * edge - len(expected)} tiles are outside", done.stderr)
        counted = json.loads(done.stdout)["run"]["work"]["files_opened"]
        self.assertGreaterEqual(counted, len(expected))
        self.assertLess(counted, 10 * len(expected), "the reader's own count")


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    TILES = int(sys.argv[sys.argv.index("--tiles") + 1]) if "--tiles" in sys.argv else 100
    harness.main(argv=sys.argv[:1], verbosity=2)
