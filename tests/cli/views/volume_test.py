#!/usr/bin/env python3
"""`gigabake query --volume`: cut and fill of shapes whose volumes are known, and of real terrain.

References: closed forms, integrals of triangulated heights, and sums over heights of `query --grid`, with positions on
the ellipsoid and polygons of this test.

Usage: volume_test.py GIGABAKE SOURCE_DIR
"""
import csv
import io
import json
import math
import shutil
import struct
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import earth
import harness
from programs import lines_of

LONGITUDE, LATITUDE, HEIGHT_M = 8.3, 46.9, 612.0
NUMBERS = ("cut_m3", "cut_error_m3", "fill_m3", "fill_error_m3")


def cone(radius, height):
    return lambda x, y: numpy.clip(height * (1 - numpy.hypot(x, y) / radius), min(0, height), max(0, height))


def frustum(low, high, height):
    """A square frustum with edges of 2 low at its base and 2 high at its top."""
    return lambda x, y: numpy.clip(height * (low - numpy.maximum(abs(x), abs(y))) / (low - high), 0, height)


def flat(x, y):
    return 0 * x + 0 * y


# Heights above the ground, and the volume. The pit is a cone below the ground.
SHAPES = {"cone": (cone(12, 6), math.pi * 12 ** 2 * 6 / 3), "pit": (cone(10, -8), math.pi * 10 ** 2 * 8 / 3),
          "frustum": (frustum(12, 5, 4), 4 / 3 * (24 ** 2 + 10 ** 2 + 24 * 10))}


class VolumeTest(harness.FolderTest):
    def degrees_of(self, points_m):
        """Returns longitude and latitude of points x, y on the plane z = 0 of the scene."""
        points = numpy.array([[x, y, 0] for x, y in points_m], float)
        return earth.degrees_of(points, LONGITUDE, LATITUDE, HEIGHT_M)[:, :2].tolist()

    def area(self, name, *polygons):
        """Writes polygons, each a list of rings of x, y in metres."""
        rings = [[self.degrees_of([*ring, ring[0]]) for ring in polygon] for polygon in polygons]
        path = self.root / f"{name}.geojson"
        path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": rings}))
        return path

    def square(self, half):
        return self.area(f"square{half}", [[(-half, -half), (half, -half), (half, half), (-half, half)]])

    def bake(self, name, points, triangles, voxel_size, *options, origin=(LATITUDE, LONGITUDE, HEIGHT_M)):
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()]
        source = self.root / f"{name}.obj"
        source.write_text("\n".join(lines))
        out = self.root / name
        options = options or ("--cell-voxels", 64)
        PROGRAM.succeed("bake", source, "-o", out, "--up", "z", "--voxel-size", voxel_size, "-q", "--origin",
                        ",".join(map(repr, origin)), *options)
        return out

    def heights(self, height_of, half=20, step=0.25):
        axis = numpy.arange(-half, half + step / 2, step)
        x, y = (a.ravel() for a in numpy.meshgrid(axis, axis))
        return numpy.stack([x, y, height_of(x, y)], -1), harness.squares_of_grid(len(axis)).reshape(-1, 3)

    def shape(self, name, voxel_size, *options):
        return self.bake(f"{name}{voxel_size}", *self.heights(SHAPES[name][0] if name in SHAPES else flat), voxel_size,
                         *options)

    def volume(self, scene, area, *options):
        return json.loads(PROGRAM.succeed("query", scene, "--volume", area, "--format", "json", *options))

    def expect(self, answer, cut, fill, voxel, usual=0.02):
        footprint = answer["area_m2"]
        for name, exact in (("cut", cut), ("fill", fill)):
            difference = abs(answer[f"{name}_m3"] - exact)
            self.assertLess(difference, voxel * footprint)
            self.assertLessEqual(difference, answer[f"{name}_error_m3"])
            self.assertLess(difference, usual * voxel * footprint)  # heights follow planes (decision 563)
        self.assertLessEqual(answer["cut_error_m3"], 1.01 * voxel * footprint)

    def refused(self, *arguments, code=2):
        result = PROGRAM.run("query", *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
        return result.stderr


class ShapeTest(VolumeTest):
    def test_cones_pits_and_frusta_are_within_a_voxel_times_footprint(self):
        for name, (_, exact) in SHAPES.items():
            for voxel in 0.25, 0.5:
                with self.subTest(name=name, voxel=voxel):
                    answer = self.volume(self.shape(name, voxel), self.square(15), "--above", HEIGHT_M)
                    self.expect(answer, *((0, exact) if name == "pit" else (exact, 0)), voxel)
                    self.assertEqual(answer["above_m"], HEIGHT_M)
                    self.assertEqual(answer["columns_measured"], (30 / voxel) ** 2)
                    self.assertEqual(answer["area_m2"], 900)

    def test_a_height_within_the_shape_cuts_it(self):
        """A cone is above the height. The rest of a cylinder around the cone is below."""
        circle = [(11 * math.cos(a), 11 * math.sin(a)) for a in numpy.arange(0, 2 * math.pi, math.pi / 180)]
        answer = self.volume(self.shape("cone", 0.5), self.area("circle", [circle]), "--above", HEIGHT_M + 3)
        below = 2 * math.pi * ((11 ** 3 - 6 ** 3) / 6 - 3 * (11 ** 2 - 6 ** 2) / 2)  # 3 - 6 (1 - r / 12) over the ring
        self.expect(answer, math.pi * 6 ** 2 * 3 / 3, below, 0.5, usual=0.04)  # the outline has steps

    def test_cut_is_the_fill_of_the_other_way_around(self):
        ground, area = self.shape("ground", 0.5), self.square(15)
        for name, (_, exact) in SHAPES.items():
            with self.subTest(name=name):
                shape = self.shape(name, 0.5, "--cell-voxels", 32)
                there = self.volume(ground, area, "--against", shape)
                back = self.volume(shape, area, "--against", ground)
                self.expect(there, *((exact, 0) if name == "pit" else (0, exact)), 1)
                swapped = [back[n] for n in ("fill_m3", "fill_error_m3", "cut_m3", "cut_error_m3")]
                self.assertEqual([there[n] for n in NUMBERS], swapped)
                self.assertEqual(there["against"], str(shape / "scene.xml"))

    def test_a_scene_of_another_frame_and_voxel_size(self):
        """The same cone is baked in the frame of a place 3 km away, which is tilted by 0.03 degrees."""
        other = (LATITUDE + 0.02, LONGITUDE - 0.03, HEIGHT_M - 250)
        points, triangles = self.heights(SHAPES["cone"][0])
        rotation, origin = earth.frame(LONGITUDE, LATITUDE, HEIGHT_M)
        there, place = earth.frame(other[1], other[0], other[2])
        moved = ((points @ rotation.T + origin) - place) @ there
        far = self.bake("far", moved, triangles, 0.4, origin=other)
        near, ground, area = self.shape("cone", 0.5), self.shape("ground", 0.5), self.square(15)
        for scene, cut in (ground, 0), (near, 0):
            with self.subTest(scene=scene.name):
                ahead = self.volume(scene, area, "--against", far)
                back = self.volume(far, area, "--against", scene)
                self.assertEqual([ahead[n] for n in NUMBERS],
                                 [back[n] for n in ("fill_m3", "fill_error_m3", "cut_m3", "cut_error_m3")])
                self.assertEqual((ahead["column_m"], back["column_m"]), (0.4, 0.4))
                self.expect(ahead, cut, SHAPES["cone"][1] if scene == ground else 0, 0.9)
        self.assertEqual(self.volume(near, area, "--against", near)["cut_m3"], 0)

    def test_threads_memory_and_cells_do_not_change_a_byte(self):
        scene, ground, area = self.shape("cone", 0.25), self.shape("ground", 0.25), self.square(15)
        cells = self.bake("cells", *self.heights(SHAPES["cone"][0]), 0.25, "--cell-voxels", 32, "--threads", 1)
        for reference in ["--above", HEIGHT_M + 0.3], ["--against", ground]:
            texts = {PROGRAM.succeed("query", which, "--volume", area, *reference, *options)
                     for which in (scene, cells)
                     for options in ([], ["--threads", 1], ["--threads", 3, "--memory", "12M"])}
            self.assertEqual(len(texts), 1)
        row = next(csv.DictReader(io.StringIO(texts.pop())))
        answer = self.volume(scene, area, "--against", ground)
        self.assertEqual({name: float(value) for name, value in row.items()},
                         {name: value for name, value in answer.items() if name != "against"})
        coarse = self.volume(scene, area, "--above", HEIGHT_M, "--lod", 2)
        self.assertEqual(coarse["column_m"], 1)
        self.expect(coarse, SHAPES["cone"][1], 0, 1)

    def test_sums_agree_with_heights_of_a_grid_and_the_ellipsoid(self):
        """A slope of 6 km: the ellipsoid falls away by up to 1.4 m. The area has a hole and a second part."""
        axis = numpy.linspace(-4000, 4000, 9)
        x, y = (a.ravel() for a in numpy.meshgrid(axis, axis))
        scene = self.bake("slope", numpy.stack([x, y, 0.1 * x + 0.05 * y], -1),
                          harness.squares_of_grid(9).reshape(-1, 3), 16)
        rings = [[(-3000, -2500), (2900, -2000), (2500, 2100), (-2800, 3000)],
                 [(500, 0), (1500, 900), (0, 1100)], [(3000, 3000), (3900, 3100), (3200, 3900)]]
        answer = self.volume(scene, self.area("two", rings[:2], rings[2:]), "--above", HEIGHT_M + 50)
        file = self.root / "grid.npy"
        PROGRAM.succeed("query", scene, "--grid=-3992,-3992,3992,3992", "--step", 16, "--format", "npy", "-o", file)
        centres = numpy.arange(-3992, 3993, 16)
        x, y = (a.ravel() for a in numpy.meshgrid(centres, centres))
        z = numpy.load(file)["height_m"]
        inside = self.contains(rings[0], x, y) ^ self.contains(rings[1], x, y) | self.contains(rings[2], x, y)
        self.assertEqual(answer["columns_measured"], inside.sum())
        above = earth.degrees_of(numpy.stack([x, y, z], -1), LONGITUDE, LATITUDE, HEIGHT_M)[:, 2] - HEIGHT_M - 50
        self.assertGreater((above + 50 - z).max(), 1.4)
        for name, part in ("cut", above), ("fill", -above):
            exact = (part.clip(0) * inside).sum() * 16 ** 2
            self.assertAlmostEqual(answer[f"{name}_m3"] / exact, 1, delta=1e-6)

    def contains(self, ring, x, y):
        """Returns which points are in the ring, by the crossings of its edges, which are straight in degrees."""
        at = numpy.array(self.degrees_of(numpy.stack([x, y], -1)))
        edges = self.degrees_of(ring)
        inside = numpy.zeros(len(x), bool)
        for (x0, y0), (x1, y1) in zip(edges, [*edges[1:], edges[0]]):
            crosses = (y0 <= at[:, 1]) != (y1 <= at[:, 1])
            inside ^= crosses & (at[:, 0] < x0 + (at[:, 1] - y0) * (x1 - x0) / (y1 - y0))
        return inside

    def test_holes_and_places_outside_are_counted(self):
        points, triangles = self.heights(flat)
        corners = points[triangles]
        keep = (abs(corners[:, :, :2]).max((1, 2)) > 5)  # a hole of 10 m
        scene = self.bake("holed", points, triangles[keep], 0.5)
        result = PROGRAM.run("query", scene, "--volume", self.square(60), "--above", HEIGHT_M - 2, "--format", "json")
        self.assertEqual(result.returncode, 0, result.stderr)
        answer = json.loads(result.stdout)
        unmeasured = answer["columns_without_surface"] + answer["columns_outside"]
        self.assertEqual(answer["area_m2"] + 0.25 * unmeasured, 120 ** 2)
        self.assertAlmostEqual(answer["area_m2"], 40 ** 2 - 10 ** 2, delta=0.5 * (160 + 40))
        self.assertGreaterEqual(0.25 * answer["columns_without_surface"], 9 ** 2)
        self.assertEqual(len(result.stderr.splitlines()), 2, result.stderr)
        holes = f"{answer['columns_without_surface']} of 57600 columns of the area have no surface"
        self.assertIn(holes, result.stderr)
        quiet = PROGRAM.run("query", scene, "--volume", self.square(60), "--above", HEIGHT_M - 2, "-q")
        self.assertEqual(quiet.stderr, "")

    def test_a_missing_cell_gives_no_volume(self):
        broken, other = self.root / "broken", self.shape("ground", 0.5)
        shutil.copytree(self.shape("cone", 0.5), broken)
        row = next(csv.DictReader(io.StringIO(PROGRAM.succeed("query", broken, "--at", "3,3"))))
        for shard in (broken / "shards").glob(row["cell"] + "-*.h5"):
            shard.unlink()
        for scene, reference in ((broken, ["--above", HEIGHT_M]), (broken, ["--against", other]),
                                 (other, ["--against", broken])):
            arguments = ["query", scene, "--volume", self.square(15), *reference]
            result = PROGRAM.run(*arguments, "--format", "json")
            self.assertEqual(result.returncode, 3, result.stderr)
            answer = json.loads(result.stdout)
            self.assertEqual([answer[n] for n in NUMBERS], 4 * [None])
            self.assertGreater(answer["columns_missing"], 0)
            self.assertIn("the volume is unknown", result.stderr)
            self.assertIn(row["cell"], result.stderr)
            table = next(csv.DictReader(io.StringIO(PROGRAM.run(*arguments).stdout)))
            self.assertEqual([table[n] for n in NUMBERS], 4 * [""])
        corner = self.area("corner", [[(-15, -15), (-12, -15), (-12, -12)]])
        self.assertEqual(PROGRAM.run("query", broken, "--volume", corner, "--above", HEIGHT_M).returncode,
                         0 if "_-1_-1" not in row["cell"] else 3)

    def test_a_scene_without_an_input_exits_with_3(self):
        source = PROGRAM.sample(self.root / "village", size=64, tiles=2)
        next(path for path in sorted(source.parent.rglob("tile_*.glb")) if "local" not in path.parts).unlink()
        baked = PROGRAM.run("bake", source, "-o", self.root / "part", "--voxel-size", 1, "-q")
        self.assertEqual(baked.returncode, 3, baked.stderr)
        place = PROGRAM.info(self.root / "part")["origin"]
        points = numpy.array([[-20, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0], [-20, -20, 0]], float)
        ring = earth.degrees_of(points, place["longitude_deg"], place["latitude_deg"], place["height_m"])
        area = self.root / "village.geojson"
        area.write_text(json.dumps({"type": "Polygon", "coordinates": [ring[:, :2].tolist()]}))
        result = PROGRAM.run("query", self.root / "part", "--volume", area, "--above", 600, "--format", "json")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("1 input is missing", result.stderr)
        self.assertGreater(json.loads(result.stdout)["cut_m3"], 0)

    def test_says_what_is_wrong(self):
        scene, area, above = self.shape("ground", 0.5), self.square(15), ["--above", HEIGHT_M]
        bad = self.root / "bad.geojson"

        def message(geometry, *words, arguments=above):
            bad.write_text(geometry if isinstance(geometry, str) else json.dumps(geometry))
            line = self.refused(scene, "--volume", bad, *arguments)
            for word in words:
                self.assertIn(word, line)

        corners = self.degrees_of([(-5, -5), (5, -5), (5, 5), (-5, 5)])
        polygon = {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}
        crossed = [corners[0], corners[2], corners[1], corners[3], corners[0]]
        message({"type": "Polygon", "coordinates": [crossed]}, "bad.geojson", "coordinates", "crosses or touches")
        message({"type": "Polygon", "coordinates": [corners]}, "bad.geojson", "coordinates[0]", "is not closed")
        message({"type": "LineString", "coordinates": corners}, "type", "expected Polygon or MultiPolygon")
        message({"type": "FeatureCollection", "features": []}, "holds no polygon")
        message("{", "bad.geojson")
        message({"type": "Polygon", "coordinates": [[[446820, 5197740]] * 4]}, "degrees", "ogr2ogr")
        self.assertIn("none.geojson", self.refused(scene, "--volume", self.root / "none.geojson", *above))
        message(polygon, "expected either --above", "--against", arguments=[])
        message(polygon, "expected either --above", arguments=[*above, "--against", scene])
        message(polygon, "csv or json", arguments=[*above, "--format", "npy"])
        message(polygon, "--above", arguments=["--above", "nan"])
        message(polygon, "--against", "no such", arguments=["--against", self.root / "absent"])
        message(polygon, "--against", "is not a scene", arguments=["--against", self.root / "ground0.5.obj"])
        self.assertIn("--volume, which is missing", self.refused(scene, "--at", "0,0", *above))
        tiny = self.area("tiny", [[(0.1, 0.1), (0.2, 0.1), (0.2, 0.2)]])
        self.assertIn("no centre of a column", self.refused(scene, "--volume", tiny, *above))
        beside = self.area("beside", [[(900, 0), (950, 0), (900, 50)]])
        self.assertIn("lies outside", self.refused(scene, "--volume", beside, *above))
        country = self.area("country", [[(-9e4, -9e4), (9e4, -9e4), (9e4, 9e4)]])
        self.assertIn("beyond the scene", self.refused(scene, "--volume", country, *above))
        out = self.root / "none.json"
        self.refused(scene, "--volume", tiny, *above, "-o", out)
        self.assertFalse(out.exists())
        self.refused(scene, "--volume", area, *above, "-o", area, code=1)
        PROGRAM.succeed("bake", self.root / "ground0.5.obj", "-o", self.root / "local", "--up", "z", "--voxel-size", 1)
        self.assertIn("--origin", self.refused(self.root / "local", "--volume", area, *above))


class TerrainTest(VolumeTest):
    def setUp(self):
        folder = harness.shared_folder(sys.argv[2]) / "data/dem-derived-textured-terrain"
        self.file = next(folder.rglob("*.glb"), None) if folder.exists() else None
        if self.file is None:
            self.skipTest(f"no terrain in {folder}")

    def grid(self):
        """Returns east, north and height of the terrain's 512 × 512 vertices, row by row."""
        data = self.file.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        document, binary = json.loads(data[20:20 + length]), data[28 + length:]
        mesh = document["meshes"][0]["primitives"][0]
        accessor = document["accessors"][mesh["attributes"]["POSITION"]]
        view = document["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        self.assertEqual(view.get("byteStride", 12), 12)
        p = numpy.frombuffer(binary, "<f4", 3 * accessor["count"], start).reshape(-1, 3).astype(float)
        self.assertEqual(len(p), 512 ** 2)
        return numpy.stack([p[:, 0], -p[:, 2], p[:, 1]], -1).reshape(512, 512, 3)

    def test_an_edit_of_real_terrain(self):
        """A mound and a pit are added to a part of the terrain. The reference is the integral over its triangles."""
        before = self.grid()[180:330, 180:330].reshape(-1, 3)
        x, y = (before[:, :2] - before[:, :2].mean(0)).T
        edit = cone(60, 9)(x - 90, y) + cone(80, -7)(x + 90, y)
        after = before + numpy.stack([0 * x, 0 * x, edit], -1)
        triangles = harness.squares_of_grid(150).reshape(-1, 3)
        corners = before[triangles][:, :, :2]
        size = abs(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])) / 2
        change = edit[triangles].mean(1) * size
        cut, fill = -change[change < 0].sum(), change[change > 0].sum()
        self.assertGreater(min(cut, fill), 20000)
        scenes = [self.bake(name, points, triangles, 2) for name, points in (("before", before), ("after", after))]
        low, high = before[:, :2].min(0) + 8, before[:, :2].max(0) - 8
        area = self.area("terrain", [[(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]])
        answer = self.volume(scenes[0], area, "--against", scenes[1])
        self.expect(answer, cut, fill, 2)
        for found, exact in (answer["cut_m3"], cut), (answer["fill_m3"], fill):
            self.assertAlmostEqual(found / exact, 1, delta=0.005)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
