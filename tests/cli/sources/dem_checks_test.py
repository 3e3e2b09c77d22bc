#!/usr/bin/env python3
"""Elevation rasters whose numbers are not heights in metres above the ellipsoid: each is reported or refused. Also the
cost of reading rasters, in opens and bytes.

Usage: dem_checks_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal, osr, write_raster
from raster_places import LEFT, PIXEL, TOP, RasterTest, opens_of, reads_of, translate


class DemChecksTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        rows, columns = numpy.mgrid[0:65, 0:81]
        self.height = (20 + 3 * numpy.sin(columns / 9) + 2 * numpy.cos(rows / 7)).astype("f4")

    def tearDown(self):
        self.folder.cleanup()

    def write(self, values=None, name="dem.tif", **options):
        write_raster(self.root / name, self.height if values is None else values, 237000, 3813000, 2, **options)

    def change(self, change, name="dem.tif"):
        raster = gdal.Open(str(self.root / name), gdal.GA_Update)
        change(raster)
        raster = None

    def scene(self, **entry):
        path = self.root / "scene.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": [{"dem": "dem.tif", **entry}]}))
        return path

    def plan(self, *arguments, source=None, **entry):
        return PROGRAM.run("plan", source or self.scene(**entry), "--voxel-size", 2, "--no-measure", "--json",
                           *arguments)

    def warnings(self, *arguments, **entry):
        result = self.plan(*arguments, **entry)
        self.assertEqual(result.returncode, 0, result.stderr)
        warnings = json.loads(result.stdout)["warnings"]
        for warning in warnings:
            self.assertIn("warning: " + warning, result.stderr.replace("--", ""))
        return warnings

    def refused(self, *words, **entry):
        result = self.plan(**entry)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        line = result.stderr.strip().splitlines()[-1]
        for word in words:
            self.assertIn(word, line)

    def voxels(self, **entry):
        PROGRAM.bake(self.scene(**entry), self.root / "out", 1)
        PROGRAM.succeed("export", self.root / "out", "--to", "ply", "-o", self.root / "v.ply")
        return harness.read_ply(self.root / "v.ply")["p"]

    def test_feet_and_depths_need_a_scale(self):
        self.write()
        self.refused("height_scale", "MSL depth", "-1", crs="EPSG:32611+5715")
        self.refused("MSL depth", "geoid_offset_m", crs="EPSG:32611+5715", height_scale=-1)
        self.assertEqual(self.warnings(crs="EPSG:32611+5715", height_scale=-1, geoid_offset_m=0), [])
        feet = self.warnings(crs="EPSG:2229", source=None)
        self.assertIn("US survey foot", feet[0])
        self.assertEqual(self.warnings(crs="EPSG:2229", height_scale=1), [])

    # Regression of 2026-11-25: an untagged -9999 was a pit of 10 km. Since 2026-11-27 the user decides.
    def test_undeclared_numbers_that_look_like_missing_heights_are_refused(self):
        holes = (slice(20, 40), slice(30, 60))
        expected = None
        for marker, kind in ((-9999, gdal.GDT_Float32), (-3.4028234663852886e38, gdal.GDT_Float32),
                             (-32768, gdal.GDT_Int16), (32767, gdal.GDT_Int16),
                             (65535, gdal.GDT_UInt16), (-99999, gdal.GDT_Int32), (123456, gdal.GDT_Float32),
                             (1e20, gdal.GDT_Float32), (1.79e308, gdal.GDT_Float64)):
            values = numpy.round(self.height).astype("f8")
            values[holes] = marker
            self.write(values, kind=kind)
            if marker == 123456:  # not a common marker
                self.refused("height_scale", "nodata")
                continue
            self.refused("dem.tif", "nodata: ", "%.3g" % marker if abs(marker) > 1e9 else str(marker), "--nodata")
            self.assertEqual(self.warnings(nodata=marker, tile_cells=16), [])
            p = self.voxels(nodata=marker)
            self.assertGreater(p[:, 2].min(), 0)
            expected = expected or len(p)
            self.assertEqual(len(p), expected)

    def test_a_refused_bake_writes_no_scene(self):
        self.height[20:40, 30:60] = -9999
        self.write()
        result = PROGRAM.run("bake", self.root / "dem.tif", "-o", self.root / "out", "--voxel-size", 1)
        self.assertNotEqual(result.returncode, 0)
        self.assertFalse((self.root / "out/scene.xml").exists())

    def test_several_numbers_may_mark_missing_heights(self):
        self.height[20:30, 30:60] = -9999
        self.height[30:40, 30:60] = -32768
        self.write(nodata=-9999)
        self.refused("nodata: pixels of -32768 ")
        p = self.voxels(nodata=[-9999, -32768])
        self.assertGreater(p[:, 2].min(), 0)
        self.write()
        self.refused("nodata: pixels of -32768, -9999 ")
        self.assertEqual(len(self.voxels(nodata=[-32768, -9999])), len(p))
        for bad in ([], ["a"], "-9999"):
            self.refused("nodata", nodata=bad)

    def test_a_chosen_nodata_makes_heights_of_other_numbers(self):
        self.height[20:40, 30:60] = -9999
        self.write()
        self.assertLess(self.voxels(nodata=-1)[:, 2].min(), -9990)
        self.assertEqual(self.warnings(nodata=-9999), [])

    def test_a_nodata_tag_is_text(self):
        self.height[20:40, 30:60] = -3.4028234663852886e38
        self.write(nodata=-3.40282e+38)
        self.assertEqual(self.warnings(), [])
        self.assertGreater(self.voxels()[:, 2].min(), 0)

    def test_a_lone_number_far_from_all_others_is_named(self):
        self.height += 1500
        for lone in (0, -999):
            self.height[20:40, 30:60] = lone
            self.write()
            [warning] = self.warnings()
            self.assertIn(f"lowest height, {lone} m", warning)
        self.height = numpy.where(self.height < 0, 0, self.height - 1500)
        self.write()  # sea level
        self.assertEqual(self.warnings(), [])

    def test_heights_in_another_unit_are_refused(self):
        self.write(self.height * 1000)
        self.refused("height_scale", "no place on earth")
        self.assertEqual(self.warnings(height_scale=0.001), [])

    def test_an_alpha_band_and_a_mask_say_where_there_is_nothing(self):
        self.height[20:40, 30:60] = 0
        alpha = numpy.full(self.height.shape, 255, "f4")
        alpha[20:40, 30:60] = 0
        self.write([self.height, alpha])
        self.change(lambda raster: raster.GetRasterBand(2).SetColorInterpretation(gdal.GCI_AlphaBand))
        self.assertEqual(self.warnings(), [])
        self.assertGreater(self.voxels()[:, 2].min(), 10)
        self.write()
        gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES")

        def mask(raster):
            raster.CreateMaskBand(gdal.GMF_PER_DATASET)
            raster.GetRasterBand(1).GetMaskBand().WriteArray(alpha.astype("u1"))
        self.change(mask)
        self.assertGreater(self.voxels()[:, 2].min(), 10)

    # Regression of 2026-11-25: an image of three bands was baked as elevation.
    def test_images_are_refused(self):
        image = numpy.zeros((3, 65, 81), "u1")
        image[0] = numpy.arange(81)
        self.write(image, kind=gdal.GDT_Byte)
        self.refused("is an image", "ortho")
        self.write(numpy.concatenate([image, image[:1]]), kind=gdal.GDT_Byte)
        self.refused("is an image", "ortho")
        code = ((self.height + 10000) * 10).astype("u4")
        self.write([code >> 16, code >> 8 & 255, code & 255], kind=gdal.GDT_Byte)
        self.refused("Mapbox Terrain-RGB", "decode")
        code = ((self.height + 32768) * 256).astype("u4")
        self.write([code >> 16, code >> 8 & 255, code & 255], kind=gdal.GDT_Byte)
        self.refused("Terrarium", "decode")
        self.write(image[0], kind=gdal.GDT_Byte)
        table = gdal.ColorTable()
        table.SetColorEntry(1, (10, 200, 30, 255))
        self.change(lambda raster: raster.GetRasterBand(1).SetColorTable(table))
        self.refused("palette", "ortho")
        self.write(self.height, kind=gdal.GDT_CFloat32)
        self.refused("complex numbers")

    def test_what_is_left_out_of_a_raster_is_named(self):
        self.write([self.height, self.height + 100])
        [warning] = self.warnings()
        self.assertIn("2 bands", warning)
        self.write(numpy.round(self.height), kind=gdal.GDT_Byte)
        [warning] = self.warnings()
        self.assertIn("8-bit", warning)
        self.assertEqual(self.warnings(height_scale=1), [])

    # Regression of 2026-11-25: swapped latitude and longitude were accepted without a message.
    def test_an_origin_far_from_the_source_asks_whether_it_is_swapped(self):
        self.write()
        place = PROGRAM.bake(self.root / "dem.tif", self.root / "out", 4)["origin"]
        lat, lon = place["latitude_deg"], place["longitude_deg"]
        quiet = ("--origin", f"{lat + 0.5},{lon},0"), ("--origin-lat-lon", f"{lat},{lon + 0.5},0")
        for arguments in quiet:
            self.assertNotIn("swapped", self.plan(*arguments).stderr)
        far = self.plan("--origin", f"{-lat},{lon + 180},0").stderr
        self.assertRegex(far, r"warning: --origin .* is 1\d,\d*\d km|warning: --origin .* is 1\d{4} km")
        self.assertIn("swapped?", far)
        refused = self.plan("--origin", f"{lon},{lat},0")  # -119.9 is not a valid latitude
        self.assertEqual(refused.returncode, 2)
        self.assertIn("swapped?", refused.stderr)
        self.write(epsg=25832)
        place = PROGRAM.bake(self.root / "dem.tif", self.root / "out", 4)["origin"]
        swapped = self.plan("--origin", f"{place['longitude_deg']},{place['latitude_deg']},0").stderr
        self.assertIn("Swapped, it would be 0 km away", swapped)


class CostTest(RasterTest):
    # Regression of 2026-11-25: each tile opened the file and read its lines from the first one on.
    def test_lines_are_read_once(self):
        rows, columns = numpy.mgrid[0:80, 0:2000]
        path = self.write("dem.tif", (columns + rows / 8).astype("f4") / 16)
        translate(path, self.folder / "dem.asc", "-of AAIGrid")
        read, opened = {}, {}
        for name in ("dem.tif", "dem.asc"):
            scene = self.scene({"dem": name, "crs": "EPSG:32632", "tile_cells": 16})
            plan = ("plan", scene, "--voxel-size", 8, "--no-measure", "--threads", 2)
            read[name] = reads_of(self.program, *plan)
            opened[name] = opens_of(self.program, self.folder / name, *plan)
        text = (self.folder / "dem.asc").stat().st_size
        # The grid has 625 tiles. GDAL reads a text once to know the type of its numbers, in each of two processes.
        self.assertLess(read["dem.asc"], read["dem.tif"] + 4 * text)
        self.assertLessEqual(opened["dem.asc"], 1.5 * opened["dem.tif"])
        self.assertLess(opened["dem.tif"], 20)

    def test_an_ascii_grid_that_gdal_cannot_read_says_why(self):
        head = f"ncols 40\nnrows 40\nxllcorner {LEFT}\nyllcorner {TOP - 80}\ncellsize 2\n"
        rows = [" ".join(["nan"] * 40)] * 2 + [" ".join(["1.5"] * 40)] * 38
        (self.folder / "nan.asc").write_text(head + "\n".join(rows) + "\n")
        scene = self.scene({"dem": "nan.asc", "crs": "EPSG:32632"})
        result = self.program.run("bake", scene, "-o", self.folder / "out", "--voxel-size", 1)
        if result.returncode != 0:  # GDAL before 3.9
            self.assertIn("NODATA_value", result.stderr)
        else:
            self.assertAlmostEqual(float(self.at((20, 20))[0]["height"]), 1.5, delta=0.5)

    def sparse(self, name, edge, nodata=None, left=0, top=0):
        """A raster of which one block of 256 × 256 pixels is filled."""
        path = self.folder / name
        options = ["TILED=YES", "SPARSE_OK=TRUE", "BLOCKXSIZE=256", "BLOCKYSIZE=256"]
        raster = gdal.GetDriverByName("GTiff").Create(str(path), edge, edge, 1, gdal.GDT_Float32, options)
        raster.SetGeoTransform([LEFT, PIXEL, 0, TOP, 0, -PIXEL])
        crs = osr.SpatialReference()
        crs.ImportFromEPSG(32632)
        raster.SetProjection(crs.ExportToWkt())
        if nodata is not None:
            raster.GetRasterBand(1).SetNoDataValue(nodata)
        raster.GetRasterBand(1).WriteArray(numpy.full((256, 256), 50, "f4"), left, top)
        raster = None
        return path

    def test_blocks_that_a_sparse_file_leaves_out_are_no_tiles(self):
        declared = self.sparse("sparse.tif", 8000, -9999, 2560, 5120)
        self.sparse("bare.tif", 8000, None, 2560, 5120)
        for source, file in ((declared, declared), (self.scene({"dem": "bare.tif", "nodata": 0}), "bare.tif")):
            result = self.plan(source)
            self.assertEqual(result["triangles"], 2 * 255 * 255)
            self.assertEqual(result["warnings"], [])
            plan = ("plan", source, "--voxel-size", 8, "--no-measure")
            self.assertLess(reads_of(self.program, *plan), 2e7)
            self.assertLess(opens_of(self.program, self.folder / file, *plan), 20)

    # 2026-11-25: a mosaic of sparse files took 60 times as long as the files: GDAL takes each source as filled.
    def test_a_mosaic_of_sparse_files_costs_as_these_do(self):
        one, two = self.sparse("one.tif", 8000, -9999, 2560, 5120), self.sparse("two.tif", 8000, -9999, 5120, 256)
        raster = gdal.Open(str(two), gdal.GA_Update)
        raster.SetGeoTransform([LEFT + 8000 * PIXEL, PIXEL, 0, TOP, 0, -PIXEL])
        raster = None
        for name, files, blocks in (("one", [one], 1), ("both", [one, two], 2)):
            vrt = gdal.BuildVRT(str(self.folder / f"{name}.vrt"), [str(file) for file in files])
            vrt = None
            source = self.folder / f"{name}.vrt"
            started = time.monotonic()
            self.assertEqual(self.plan(source)["triangles"], blocks * 2 * 255 * 255)
            self.assertLess(time.monotonic() - started, 20)
            self.assertLess(reads_of(self.program, "plan", source, "--voxel-size", 8, "--no-measure"), 2e7)

    def test_a_mosaic_shows_each_number_that_is_no_hole_of_it(self):
        """Blocks that the file leaves out are -9999: holes of the file, and heights of a VRT with another nodata."""
        self.sparse("part.tif", 512, -50, 256, 0)
        for options, blocks in (("", 1), ("-a_nodata -1", 4)):
            translate(self.folder / "part.tif", self.folder / "part.vrt", "-of VRT " + options)
            triangles = self.plan(self.folder / "part.vrt")["triangles"]
            self.assertEqual(triangles, 2 * 511 * 511 if blocks == 4 else 2 * 255 * 255)

    def test_left_out_blocks_are_zero_without_nodata(self):
        """GDAL leaves out blocks of zeros also without SPARSE_OK, so that they may be the sea."""
        for left, top in ((0, 0), (256, 256)):
            path = self.sparse("small.tif", 512, None, left, top)
            result = self.plan(path)
            self.assertIn("75 % of its blocks, which are taken as heights of 0", result["warnings"][0])
            self.assertEqual(result["triangles"], 2 * 511 * 511)
            scene = self.scene({"dem": "small.tif", "nodata": 0, "tile_cells": 100})
            self.assertEqual(self.plan(scene)["triangles"], 2 * 255 * 255)


if __name__ == "__main__":
    PROGRAM = RasterTest.program = harness.Gigabake(sys.argv[1])
    harness.skip_without(PROGRAM, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1], verbosity=2)
