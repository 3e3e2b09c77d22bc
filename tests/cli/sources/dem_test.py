#!/usr/bin/env python3
"""Elevation rasters: where their vertices lie, holes, orthophotos, tiles, wrong coordinate systems.

Usage: dem_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal, osr, write_raster


class DemTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        rows, columns = numpy.mgrid[0:65, 0:81]
        self.height = (20 + 3 * numpy.sin(columns / 9) + 2 * numpy.cos(rows / 7)).astype("f4")
        write_raster(self.root / "dem.tif", self.height, 237000, 3813000, 2)

    def tearDown(self):
        self.folder.cleanup()

    def scene(self, **entry):
        path = self.root / "scene.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": [{"dem": "dem.tif", **entry}]}))
        return path

    def bake(self, out, *arguments, voxel_size=1, **entry):
        return PROGRAM.bake(self.scene(**entry), self.root / out, voxel_size, *arguments)

    def voxels(self, out):
        PROGRAM.succeed("export", self.root / out / "scene.xml", "--to", "ply", "--lod", 0, "-o", self.root / "v.ply")
        return harness.read_ply(self.root / "v.ply")

    def refuse(self, *words, **entry):
        result = PROGRAM.run("plan", self.scene(**entry), "--voxel-size", 1)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        line = result.stderr.strip().splitlines()[-1]
        for word in words:
            self.assertIn(word, line)

    def test_vertices_lie_at_pixel_centres_on_the_earth(self):
        self.bake("out", geoid_offset_m=-35)
        p = self.voxels("out")["p"]
        width, height = numpy.ptp(p[:, 0]), numpy.ptp(p[:, 1])
        self.assertAlmostEqual(width, 160, delta=6)  # 80 cells of 2 m, rotated by the grid's convergence
        self.assertAlmostEqual(height, 128, delta=6)
        self.assertAlmostEqual(p[:, 2].min(), self.height.min() - 35, delta=1)
        self.assertAlmostEqual(p[:, 2].max(), self.height.max() - 35, delta=1)

    def test_tiles_make_no_seam_and_no_difference(self):
        whole = self.bake("whole", tile_cells=256)
        tiles = self.bake("tiles", tile_cells=16)
        self.assertEqual(whole["lods"][0]["voxels"], tiles["lods"][0]["voxels"])
        a, b = self.voxels("whole"), self.voxels("tiles")
        self.assertTrue((a["ijk"] == b["ijk"]).all())

    def test_cells_without_a_value_are_holes(self):
        full = self.bake("full")["lods"][0]["voxels"]
        self.height[20:40, 30:60] = -9999
        write_raster(self.root / "dem.tif", self.height, 237000, 3813000, 2, nodata=-9999)
        holed = self.bake("holed")["lods"][0]["voxels"]
        self.assertAlmostEqual((full - holed) / full, 21 * 31 / (64 * 80), delta=0.03)
        write_raster(self.root / "dem.tif", self.height, 237000, 3813000, 2)
        self.assertEqual(self.bake("named", nodata=-9999)["lods"][0]["voxels"], holed)

    def test_an_orthophoto_lies_where_it_belongs(self):
        photo = numpy.zeros((3, 260, 324), "u1")
        photo[0, :, :162] = 250  # the west is red, the east is blue
        photo[2, :, 162:] = 250
        write_raster(self.root / "ortho.tif", photo, 237000, 3813000, 0.5, kind=gdal.GDT_Byte)
        self.bake("out", ortho="ortho.tif", tile_cells=32)
        v = self.voxels("out")
        west, east = v[v["p"][:, 0] < -8], v[v["p"][:, 0] > 8]
        self.assertGreater(numpy.median(west["rgba"][:, 0]), 240)
        self.assertLess(numpy.median(west["rgba"][:, 2]), 10)
        self.assertGreater(numpy.median(east["rgba"][:, 2]), 240)
        self.assertLess(numpy.median(east["rgba"][:, 0]), 10)

    def test_only_tiles_whose_pixels_changed_are_baked_again(self):
        self.bake("out", "--cell-voxels", 64, tile_cells=16)
        shards = {p.name: p.stat().st_mtime_ns for p in (self.root / "out").rglob("*.h5")}
        self.height[60, 75] += 1
        write_raster(self.root / "dem.tif", self.height, 237000, 3813000, 2)
        self.bake("out", "--cell-voxels", 64, tile_cells=16)
        again = {p.name: p.stat().st_mtime_ns for p in (self.root / "out").rglob("*.h5")}
        kept = [name for name in shards if again.get(name) == shards[name]]
        self.assertGreaterEqual(len(kept), len(shards) // 2)
        self.assertGreater(len(set(again) - set(shards)), 0)

    def test_a_coordinate_system_that_is_missing_or_wrong_names_the_key(self):
        write_raster(self.root / "dem.tif", self.height, 237000, 3813000, 2, epsg=None)
        self.refuse("crs", "has no coordinate system", "EPSG:25832")
        PROGRAM.succeed("plan", self.scene(crs="EPSG:32611"), "--voxel-size", 1)
        self.refuse("crs", "is unknown", crs="EPSG:nothing")
        self.refuse("crs", "set the right one", crs="EPSG:4326")  # metres read as degrees
        write_raster(self.root / "dem.tif", self.height, -119.8, 34.4, 2e-5)
        self.refuse("crs", "set the right one")  # degrees read as metres

    def test_what_else_is_wrong_is_said_in_one_line(self):
        self.refuse("ortho", "no such file", ortho="gone.tif")
        self.refuse("leaves the source folder", ortho="../../../etc/passwd")
        self.refuse("unknown member", orto="dem.tif")
        self.refuse("tile_cells", tile_cells=1)
        raster = gdal.Open(str(self.root / "dem.tif"), gdal.GA_Update)
        raster.GetRasterBand(1).SetUnitType("ft")
        raster = None
        self.refuse("height_scale", "0.3048")
        PROGRAM.succeed("plan", self.scene(height_scale=0.3048), "--voxel-size", 1)
        content = (self.root / "dem.tif").read_bytes()
        (self.root / "dem.tif").write_bytes(content[:100])
        self.refuse("dem.tif")


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.skip_without(PROGRAM, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1], verbosity=2)
