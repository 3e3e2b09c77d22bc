#!/usr/bin/env python3
"""Tests queries in coordinate systems (--crs): places in, results out. The reference is PROJ by the bindings of GDAL.

Usage: query_crs_test.py GIGABAKE SOURCE_DIR
"""
import csv
import io
import json
import os
import random
import struct
import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(HERE / "support"), str(HERE / "sources")]
import harness
from gdal_there import coordinate_system, gdal, osr, write_raster

LEFT, TOP, PIXEL, EDGE = 500000, 5400000, 2, 60
UTM = "EPSG:25832+5773"
FEET = "+proj=utm +zone=32 +ellps=GRS80 +towgs84=0,0,0 +units=us-ft +vunits=us-ft +type=crs"
US_FOOT_M = 1200 / 3937


def convert(source, target, points):
    options = osr.CoordinateTransformationOptions()
    options.SetBallparkAllowed(False)
    systems = [coordinate_system(text) for text in (source, target)]
    return numpy.array(osr.CoordinateTransformation(*systems, options).TransformPoints(points))


class QueryCrsTest(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        rows, columns = numpy.mgrid[0:EDGE, 0:EDGE]
        cls.height = (300 + 6 * numpy.sin(columns / 9) + 5 * numpy.cos(rows / 7)).astype("f4")
        write_raster(cls.root / "dem.tif", cls.height, LEFT, TOP, PIXEL, epsg=25832)
        cls.scene = cls.root / "out"
        PROGRAM.bake(cls.root / "dem.tif", cls.scene, 0.5, "--dem-crs", UTM)

    def query(self, *arguments):
        return list(csv.DictReader(io.StringIO(PROGRAM.succeed("query", self.scene, *arguments))))

    def table(self, header, rows, name="table.csv"):
        path = self.root / name
        path.write_text(header + "\n" + "".join(",".join("%.10f" % v for v in row) + "\n" for row in rows))
        return path

    def places(self, count=60):
        """Returns columns and rows of random pixels, and their coordinates in UTM."""
        odd = random.Random(7)
        pixels = [(odd.randrange(4, EDGE - 4), odd.randrange(4, EDGE - 4)) for _ in range(count)]
        return pixels, [(LEFT + (c + 0.5) * PIXEL, TOP - (r + 0.5) * PIXEL) for c, r in pixels]

    def test_heights_are_those_of_the_raster_in_its_system(self):
        pixels, places = self.places()
        answers = self.query("--crs", UTM, "--heights", self.table("x,y", places))
        for (c, r), (x, y), answer in zip(pixels, places, answers):
            self.assertEqual(answer["outcome"], "hit")
            self.assertAlmostEqual(float(answer["x"]), x, delta=2e-3)
            self.assertAlmostEqual(float(answer["y"]), y, delta=2e-3)
            self.assertAlmostEqual(float(answer["z"]), self.height[r, c], delta=0.26)

    def test_answers_equal_those_in_degrees(self):
        """The same places in degrees, converted by PROJ, have the same answers: within the printed decimals."""
        _, places = self.places()
        for crs in (UTM, "EPSG:25832", "EPSG:31467", "EPSG:4258+5773", "EPSG:3857", FEET):
            there = convert("EPSG:25832", crs, [(x, y, 0) for x, y in places])
            lon_lat = convert(crs, "EPSG:4979", [tuple(p) for p in there])
            by_degrees = self.query("--coordinates", "lonlat", "--heights", self.table("lon,lat", lon_lat[:, :2]))
            expected = convert("EPSG:4979", crs, [[float(a[k]) for k in ("lon", "lat", "height")] for a in by_degrees])
            answers = self.query("--crs", crs, "--heights", self.table("x,y", there[:, :2]))
            got = numpy.array([[float(a[k]) for k in "xyz"] for a in answers])
            is_degrees = crs.startswith("EPSG:4258")
            self.assertLess(numpy.abs(got - expected)[:, :2].max(), 1e-7 if is_degrees else 0.01, crs)
            self.assertLess(numpy.abs(got - expected)[:, 2].max(), 0.011 / (US_FOOT_M if crs == FEET else 1), crs)

    def test_a_system_without_heights_has_heights_above_the_ellipsoid(self):
        at = ("--at", f"{LEFT + 61},{TOP - 61}")
        [plain], [geoid] = self.query("--crs", "EPSG:25832", *at), self.query("--crs", UTM, *at)
        [undulation] = convert("EPSG:4326+5773", "EPSG:4979", [(9, 48.74, 0)])[:, 2]
        self.assertAlmostEqual(float(plain["z"]) - float(geoid["z"]), undulation, delta=0.1)

    def test_rays_and_lines_of_sight(self):
        """A ray down from 50 m above; rays to the north by azimuth, which is that of the ellipsoid, as in degrees."""
        x, y = LEFT + 61, TOP - 61
        ground = self.height[30, 30]
        [hit] = self.query("--crs", UTM, f"--ray={x},{y},{ground + 50},0,-90")
        self.assertAlmostEqual(float(hit["z"]), ground, delta=0.6)
        self.assertAlmostEqual(float(hit["distance_m"]), 50, delta=0.6)
        [(lon, lat, height)] = convert(UTM, "EPSG:4979", [(x, y, float(ground) + 3)])
        for azimuth in (0, 77, 200):
            [a] = self.query("--crs", UTM, f"--ray={x},{y},{ground + 3},{azimuth},-9")
            [b] = self.query("--coordinates", "lonlat", f"--ray={lon:.10f},{lat:.10f},{height:.4f},{azimuth},-9")
            self.assertEqual((a["outcome"], a["cell"]), (b["outcome"], b["cell"]))
            self.assertAlmostEqual(float(a["distance_m"]), float(b["distance_m"]), delta=0.01)
        above = self.height.max() + 1
        for end, outcome in ((above, "visible"), (self.height.min() - 5, "blocked")):
            [sight] = self.query("--crs", UTM, f"--sight={x - 40},{y},{above},{x + 40},{y},{end}")
            self.assertEqual(sight["outcome"], outcome)
        rays = self.table("x,y,z,to_x,to_y,to_z", [(x, y, above, x + 5, y, ground)], "rays.csv")
        self.assertEqual(self.query("--crs", UTM, "--rays", rays)[0]["outcome"], "hit")

    def test_grids_and_formats(self):
        grid = (f"--grid={LEFT + 20},{TOP - 80},{LEFT + 40},{TOP - 60}", "--step", 10)
        answers = self.query("--crs", UTM, *grid)
        self.assertEqual([float(a["x"]) for a in answers[:3]], [LEFT + 20, LEFT + 30, LEFT + 40])
        items = json.loads(PROGRAM.succeed("query", self.scene, "--crs", UTM, *grid, "--format", "json"))
        self.assertEqual([item["position"][2] for item in items], [float(a["z"]) for a in answers])
        features = json.loads(PROGRAM.succeed("query", self.scene, "--crs", UTM, *grid, "--format", "geojson"))
        lon, lat, height = features["features"][0]["geometry"]["coordinates"]
        [expected] = convert(UTM, "EPSG:4979", [[float(answers[0][k]) for k in "xyz"]])
        self.assertLess(numpy.abs(expected[:2] - (lon, lat)).max(), 1e-7)  # RFC 7946: always degrees
        self.assertAlmostEqual(height, expected[2], delta=0.02)
        PROGRAM.succeed("query", self.scene, "--crs", UTM, *grid, "--format", "npy", "-o", self.root / "a.npy")
        numbers = numpy.load(self.root / "a.npy")
        self.assertLess(numpy.abs(numbers["height"] - [float(a["z"]) for a in answers]).max(), 0.06)

    def test_exports_have_the_same_heights(self):
        """Pixels of a dsm equal answers at their centres, and points of a LAS file lie in the raster's heights."""
        bounds = f"--bounds={LEFT + 20},{TOP - 80},{LEFT + 60},{TOP - 40}"
        PROGRAM.succeed("export", self.scene, "--to", "dsm", "--crs", UTM, bounds, "--step", 4, "-o",
                        self.root / "dsm.tif")
        raster = gdal.Open(str(self.root / "dsm.tif"))
        self.assertIn("EGM96", raster.GetSpatialRef().ExportToWkt())
        pixels = raster.ReadAsArray()
        west, step, _, north, _, down = raster.GetGeoTransform()
        rows, columns = numpy.mgrid[0:pixels.shape[0], 0:pixels.shape[1]]
        places = numpy.stack([west + (columns + 0.5) * step, north + (rows + 0.5) * down], -1).reshape(-1, 2)
        answers = self.query("--crs", UTM, "--heights", self.table("x,y", places, "centres.csv"))
        got = numpy.array([float(a["z"]) for a in answers])
        self.assertEqual(len(got), 100)
        self.assertLess(numpy.abs(got - pixels.reshape(-1)).max(), 0.011)
        PROGRAM.succeed("export", self.scene, "--to", "las", "--crs", UTM, "-o", self.root / "p.las")
        with open(self.root / "p.las", "rb") as file:
            head = file.read(375)
        high, low = struct.unpack_from("<dd", head, 211)
        self.assertAlmostEqual(high, self.height.max(), delta=0.6)
        self.assertAlmostEqual(low, self.height.min(), delta=0.6)

    def test_bounds_and_questions_share_the_system(self):
        bounds = f"--bounds={LEFT + 20},{TOP - 80},{LEFT + 40},{TOP - 60}"
        inside, outside = f"--at={LEFT + 30},{TOP - 70}", f"--at={LEFT + 90},{TOP - 70}"
        self.assertEqual(self.query("--crs", "EPSG:25832", bounds, inside)[0]["outcome"], "hit")
        self.assertNotEqual(self.query("--crs", "EPSG:25832", bounds, outside)[0]["outcome"], "hit")
        [here] = self.query("--crs", "EPSG:25832", bounds, inside)
        [scene] = self.query("--crs", "EPSG:25832", "--coordinates", "lonlat", bounds, "--at",
                             ",".join("%.9f" % v for v in convert(
                                 "EPSG:25832", "EPSG:4979", [(LEFT + 30, TOP - 70, 0)])[0][:2]))
        self.assertAlmostEqual(float(here["z"]), float(scene["height"]), delta=0.02)

    def refused(self, code, *words, arguments):
        out = self.root / "never.csv"
        result = PROGRAM.run("query", self.scene, *arguments, "-o", out)
        self.assertEqual(result.returncode, code, result.stderr)
        [line] = result.stderr.strip().splitlines()
        for word in words:
            self.assertIn(word, line)
        self.assertFalse(out.exists())
        self.assertEqual([p.name for p in self.root.iterdir() if "never" in p.name], [])

    def test_bad_systems_and_places(self):
        at = ("--at", f"{LEFT + 61},{TOP - 61}")
        self.refused(2, "--crs", "is unknown", "EPSG:999999", arguments=("--crs", "EPSG:999999", *at))
        self.refused(2, "EPSG:25832+7837", "needs the grid", arguments=("--crs", "EPSG:25832+7837", *at))
        self.refused(2, "--coordinates", "--crs", arguments=("--coordinates", "crs", *at))
        self.refused(2, "no place on the earth", arguments=("--crs", "EPSG:25832", "--at", "1e9,1e9"))
        self.refused(2, "--ray", arguments=("--crs", UTM, "--ray=1,2,3,0,0,-1"))
        self.refused(1, "dx", "line 1", arguments=("--crs", UTM, "--rays", self.table("x,y,z,dx,dy,dz", [], "d.csv")))
        bad = self.table("x,y", [(LEFT + 61, TOP - 61), (1e9, 1e9)], "bad.csv")
        self.refused(1, "bad.csv", "line 3", arguments=("--crs", "EPSG:25832", "--heights", bad))
        harness.write_glb(self.root / "local.glb", [[0, 9, 0], [4, 9, 0], [4, 9, -4]], [0, 1, 2])
        PROGRAM.bake(self.root / "local.glb", self.root / "local", 1)
        result = PROGRAM.run("query", self.root / "local", "--crs", "EPSG:25832", *at)
        self.assertEqual(result.returncode, 2)
        self.assertIn("no position on the earth", result.stderr)

    def test_the_order_of_answers_is_the_same_with_threads(self):
        _, places = self.places(3000)
        table = self.table("x,y", places, "many.csv")
        one, many = (PROGRAM.succeed("query", self.scene, "--crs", UTM, "--heights", table, "--threads", n)
                     for n in (1, 4))
        self.assertEqual(one, many)


if __name__ == "__main__":
    os.environ.pop("PROJ_LIB", None)
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.skip_without(PROGRAM, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1], verbosity=2)
