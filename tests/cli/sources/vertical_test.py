#!/usr/bin/env python3
"""Tests heights of rasters in vertical reference systems. The reference is PROJ's program cs2cs, or a grid of the test.

Usage: vertical_test.py GIGABAKE SOURCE_DIR
"""
import csv
import io
import json
import os
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal, osr
from raster_places import RasterTest, lon_lat

US_FOOT_M = 1200 / 3937
EGM96_IN_FEET = (
    'COMPD_CS["WGS 84 + EGM96 height (ftUS)",'
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]],'
    'VERT_CS["EGM96 height (ftUS)",VERT_DATUM["EGM96 geoid",2005,AUTHORITY["EPSG","5171"]],'
    'UNIT["ftUS",0.304800609601219],AXIS["Gravity-related height",UP]]]')


def cs2cs(source, target, points):
    """Converts (x, y, z) in the order of axes of the systems."""
    text = "".join("%.12f %.12f %.6f\n" % tuple(p) for p in points)
    out = subprocess.run(["cs2cs", "-f", "%.8f", source, target], input=text, capture_output=True, text=True,
                         check=True).stdout
    return [[float(v) for v in line.split()] for line in out.splitlines()]


def proj_folder():
    folders = [os.environ.get("PROJ_DATA", ""), "/usr/share/proj", "/usr/local/share/proj"]
    return next(Path(p) for p in folders if p and (Path(p) / "proj.db").exists())


class VerticalTest(RasterTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.environment = dict(os.environ)

    def tearDown(self):
        os.environ.clear()
        os.environ.update(self.environment)

    def own_proj(self, grid=None):
        """Lets PROJ find only its database, and optionally a grid of a constant undulation with the name of EGM96's.
        grid: west, south, columns, rows, undulation."""
        folder = self.folder / "proj"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        shutil.copy(proj_folder() / "proj.db", folder)
        if grid:
            west, south, columns, rows, undulation = grid
            head = struct.pack(">ddddii", south, west, 1, 1, rows, columns)
            (folder / "egm96_15.gtx").write_bytes(head + numpy.full(rows * columns, undulation, ">f4").tobytes())
        os.environ["PROJ_LIB"] = os.environ["PROJ_DATA"] = str(folder)

    def degrees(self, name, values, lon, lat, pixel=3e-6, system="EPSG:4326+5773"):
        """Writes a raster whose first pixel has its centre at lon, lat."""
        path = self.write(name, values, left=lon - pixel / 2, top=lat + pixel / 2, pixel=pixel, epsg=None)
        self.set_crs(path, system)
        return path

    def set_crs(self, path, system):
        crs = osr.SpatialReference()
        self.assertEqual(crs.SetFromUserInput(system), 0)
        raster = gdal.Open(str(path), gdal.GA_Update)
        raster.SetSpatialRef(crs)
        raster = None

    def height_at(self, *places):
        table = self.folder / "places.csv"
        table.write_text("lon,lat\n" + "".join("%.10f,%.10f\n" % p for p in places))
        text = self.program.succeed("query", self.folder / "out", "--coordinates", "lonlat", "--heights", table)
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual([row["outcome"] for row in rows], ["hit"] * len(places))
        return [float(row["height"]) for row in rows]

    def notes(self, source):
        result = self.program.run("plan", source, "--voxel-size", 2, "--no-measure")
        self.assertEqual(result.returncode, 0, result.stderr)
        return [line for line in result.stderr.splitlines()
                if "height" in line and ": " in line and "scene origin" not in line]

    def test_zero_of_egm96_is_the_geoid_at_100_places(self):
        """The worst error is printed; it must be below 1 cm, of which voxels of 1 cm contribute up to 5 mm."""
        if not shutil.which("cs2cs"):
            self.skipTest("cs2cs is not installed (proj-bin)")
        worst = 0
        for lon, lat in ((8.5, 47.3), (-118.2, 34), (86.9, 27.9), (151.2, -33.8), (-70, -50.4), (179.99, -16.5),
                         (0.001, 51.5), (20, 69), (37.1, -3.1), (139.7, 35.6)):
            path = self.degrees("zero.tif", numpy.zeros((12, 12), "f4"), lon, lat)
            self.bake(path, 0.01)
            places = [(lon + c * 3e-6, lat - r * 3e-6) for c, r in
                      ((1, 1), (5, 2), (9, 1), (2, 5), (5, 5), (8, 5), (1, 9), (4, 8), (9, 9), (6, 7))]
            expected = [p[2] for p in cs2cs("EPSG:4326+5773", "EPSG:4979", [(y, x, 0) for x, y in places])]
            for place, got, wanted in zip(places, self.height_at(*places), expected):
                worst = max(worst, abs(got - wanted))
                self.assertAlmostEqual(got, wanted, delta=0.01, msg=place)
        print(f"worst error at 100 places: {worst * 1000:.1f} mm")

    def test_crs_of_a_scene_states_the_vertical_system(self):
        self.write("dem.tif", self.height)
        scene = self.scene({"dem": "dem.tif", "crs": "EPSG:32632+5773"})
        self.bake(scene, 0.5)
        lon, lat = lon_lat(500041, 5399959)  # the centre of pixel 20, 20
        [undulation] = [p[2] for p in cs2cs("EPSG:4326+5773", "EPSG:4979", [(lat, lon, 0)])]
        self.assertGreater(undulation, 40)
        self.assertAlmostEqual(self.height_at((lon, lat))[0], self.height[20, 20] + undulation, delta=0.26)
        [note] = self.notes(scene)
        for word in ("dem.tif: ", "EGM96 height", "converted", "egm96_15.gtx"):
            self.assertIn(word, note)
        self.write("e.tif", self.height, left=500000 + 80)
        [note] = self.notes(self.scene({"dem": "dem.tif", "crs": "EPSG:32632+5773"},
                                       {"dem": "e.tif", "crs": "EPSG:32632+5773"}))
        self.assertIn("dem.tif and 1 more: ", note)

    def test_the_vertical_system_of_a_file_remains_if_crs_replaces_its_horizontal_one(self):
        path = self.write("dem.tif", self.height, epsg=None)
        self.set_crs(path, "EPSG:25833+5773")
        self.bake(self.scene({"dem": "dem.tif", "crs": "EPSG:32632"}), 0.5)
        self.assertGreater(self.height_at(lon_lat(500041, 5399959))[0], self.height[20, 20] + 40)

    def test_hgt_files_have_egm96_heights(self):
        values = numpy.full((1201, 1201), 100, ">i2")
        (self.folder / "N48E009.hgt").write_bytes(values.tobytes())
        [note] = self.notes(self.folder / "N48E009.hgt")
        self.assertIn("EGM96 height", note)
        self.own_proj()
        self.refused(self.folder / "N48E009.hgt", "egm96_15.gtx", "proj-data")

    def test_geoid_offset_replaces_the_vertical_system(self):
        self.own_proj()
        path = self.degrees("dem.tif", numpy.full((40, 40), 5, "f4"), 8, 47, 1e-5)
        scene = self.scene({"dem": path.name, "geoid_offset_m": 3})
        self.assertEqual(self.notes(scene), [])
        self.bake(scene, 0.5)
        self.assertAlmostEqual(self.height_at((8.0002, 46.9998))[0], 8, delta=0.26)

    def test_feet_above_the_geoid_are_feet_before_the_geoid_is_added(self):
        self.write("feet.tif", numpy.full((40, 40), 1000, "f4"), left=8, top=47, pixel=1e-5, epsg=None)
        scene = self.scene({"dem": "feet.tif", "crs": EGM96_IN_FEET})  # GDAL would write metres into a GeoTIFF
        [note] = self.notes(scene)
        self.assertIn("EGM96 height (ftUS)", note)
        self.bake(scene, 0.5)
        expected = cs2cs("EPSG:4326+5773", "EPSG:4979", [(46.9998, 8.0002, 1000 * US_FOOT_M)])[0][2]
        self.assertAlmostEqual(self.height_at((8.0002, 46.9998))[0], expected, delta=0.26)

    def test_ellipsoidal_heights_stay_and_are_reported(self):
        path = self.degrees("dem.tif", numpy.full((40, 40), 5, "f4"), 8, 47, 1e-5, "EPSG:4979")
        [note] = self.notes(path)
        self.assertIn("heights are ellipsoidal ('WGS 84')", note)
        self.bake(path, 0.5)
        self.assertAlmostEqual(self.height_at((8.0002, 46.9998))[0], 5, delta=0.26)
        feet = ('GEOGCRS["feet",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],'
                'CS[ellipsoidal,3],AXIS["latitude",north,ANGLEUNIT["degree",0.0174532925199433]],'
                'AXIS["longitude",east,ANGLEUNIT["degree",0.0174532925199433]],'
                'AXIS["ellipsoidal height",up,LENGTHUNIT["ftUS",0.304800609601219]]]')
        self.write("feet.tif", numpy.full((40, 40), 100, "f4"), left=8, top=47, pixel=1e-5, epsg=None)
        scene = self.scene({"dem": "feet.tif", "crs": feet})
        self.assertIn("heights are ellipsoidal", self.notes(scene)[0])
        self.bake(scene, 0.5)
        self.assertAlmostEqual(self.height_at((8.0002, 46.9998))[0], 100 * US_FOOT_M, delta=0.26)

    def test_a_system_without_heights_is_reported_once(self):
        self.write("dem.tif", self.height)
        [note] = self.notes(self.folder / "dem.tif")
        for word in ("no vertical reference system", "above the WGS84 ellipsoid", "geoid_offset_m"):
            self.assertIn(word, note)
        self.assertEqual(self.notes(self.scene({"dem": "dem.tif", "geoid_offset_m": 0})), [])

    def test_a_missing_grid_is_named_with_its_origin(self):
        path = self.degrees("dem.tif", self.height, 8, 47, 1e-5)
        self.own_proj()
        self.refused(path, "EGM96 height", "egm96_15.gtx", "Debian package proj-data", "geoid_offset_m")
        self.write("us.tif", self.height, left=6500000, top=1800000)
        self.refused(self.scene({"dem": "us.tif", "crs": "EPSG:2229+6360"}), "NAVD88 height (ftUS)", "us_noaa_",
                     "https://cdn.proj.org/us_noaa_", "projsync")
        self.write("dem.tif", self.height)
        self.refused(self.scene({"dem": "dem.tif", "crs": "EPSG:25832+7837"}), "DHHN2016 height", "needs the grid")
        self.refused(self.scene({"dem": "dem.tif", "crs": "EPSG:32632+5714"}), "MSL height", "geoid_offset_m")
        self.assertFalse((self.folder / "out").exists())

    def test_a_grid_that_does_not_cover_the_raster(self):
        path = self.degrees("dem.tif", numpy.full((40, 40), 5, "f4"), 8, 47, 1e-5)
        self.own_proj((0, 40, 5, 5, 30))
        self.refused(path, "dem.tif: crs: ", "egm96_15.gtx", "does not cover", "longitude 8")
        self.own_proj((6, 45, 5, 5, 30))
        self.bake(path, 0.5)
        self.assertAlmostEqual(self.height_at((8.0002, 46.9998))[0], 35, delta=0.26)

    def test_heights_outside_a_grid_are_lost_and_holes_are_not(self):
        """The grid ends at 8° within the raster. Without values to the east of it, nothing is missing."""
        values = numpy.full((40, 40), 5, "f4")
        path = self.degrees("dem.tif", values, 8 - 20.5e-5, 47, 1e-5)
        self.own_proj((4, 45, 5, 5, 30))
        scene = self.scene({"dem": "dem.tif", "tile_cells": 16})
        self.assertIn("does not cover", self.bake(scene, 0.5, code=3))
        values[:, 20:] = -9999
        path = self.degrees("dem.tif", values, 8 - 20.5e-5, 47, 1e-5)
        scene = self.scene({"dem": path.name, "tile_cells": 16, "nodata": -9999})
        self.bake(scene, 0.5)
        self.assertAlmostEqual(self.height_at((8 - 10.5e-5, 46.9998))[0], 35, delta=0.26)

    def test_another_grid_is_another_bake(self):
        path = self.degrees("dem.tif", numpy.full((40, 40), 5, "f4"), 8, 47, 1e-5)
        for undulation in (30, 50):
            self.own_proj((6, 45, 5, 5, undulation))
            self.program.succeed("bake", path, "-o", self.folder / "out", "--voxel-size", 0.5)
            self.assertAlmostEqual(self.height_at((8.0002, 46.9998))[0], 5 + undulation, delta=0.26)

    def test_neighbours_may_have_different_vertical_systems(self):
        self.write("w.tif", self.height[:, :20])
        self.write("e.tif", self.height[:, 20:] + 47, left=500040)
        self.own_proj((6, 45, 6, 6, 47))
        self.bake(self.scene({"dem": "w.tif", "crs": "EPSG:32632+5773"}, {"dem": "e.tif"}), 0.5)
        self.assertEqual(self.program.info(self.folder / "out")["losses"], [])
        self.expect_heights(self.height + 47, tolerance=0.3)

    def test_a_grid_of_another_format_may_have_the_name_of_the_message(self):
        """PROJ 9.1 names GCG2016.txt for EPSG:7837; a GeoTIFF of this name serves."""
        self.own_proj()
        self.write("dem.tif", self.height)
        scene = self.scene({"dem": "dem.tif", "crs": "EPSG:25832+7837"})
        message = self.program.run("plan", scene, "--voxel-size", 2, "--no-measure").stderr
        name = message.split("needs the grid '")[1].split("'")[0]
        path = Path(os.environ["PROJ_DATA"]) / name
        raster = gdal.GetDriverByName("GTiff").Create(str(path), 20, 20, 1, gdal.GDT_Float32)
        raster.SetGeoTransform([4.5, 1, 0, 60.5, 0, -1])
        crs = osr.SpatialReference()
        crs.ImportFromEPSG(4258)
        raster.SetSpatialRef(crs)
        raster.SetMetadataItem("TYPE", "VERTICAL_OFFSET_GEOGRAPHIC_TO_VERTICAL")
        raster.SetMetadataItem("AREA_OR_POINT", "Point")
        raster.GetRasterBand(1).SetDescription("geoid_undulation")
        raster.GetRasterBand(1).WriteArray(numpy.full((20, 20), 45.5, "f4"))
        raster = None
        self.bake(scene, 0.5)
        self.assertAlmostEqual(self.height_at(lon_lat(500041, 5399959))[0], self.height[20, 20] + 45.5, delta=0.26)
        [row] = csv.DictReader(io.StringIO(self.program.succeed("query", self.folder / "out", "--crs",
                                                                "EPSG:25832+7837", "--at", "500041,5399959")))
        self.assertAlmostEqual(float(row["z"]), self.height[20, 20], delta=0.26)

    def test_ranks_agree(self):
        path = self.degrees("dem.tif", numpy.full((40, 40), 5, "f4"), 8, 47, 1e-5)
        hashes = set()
        for ranks in (None, 2):
            out = self.folder / f"out{ranks}"
            self.program.succeed("bake", path, "-o", out, "--voxel-size", 0.5, ranks=ranks)
            hashes.add(json.dumps(harness.lod_hashes(self.program.info(out))))
        self.assertEqual(len(hashes), 1)


if __name__ == "__main__":
    RasterTest.program = harness.Gigabake(sys.argv[1])
    harness.skip_without(RasterTest.program, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1], verbosity=2)
