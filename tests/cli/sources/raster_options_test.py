#!/usr/bin/env python3
"""Tests rasters on the command line (--ortho, --dem-crs, --nodata, --geoid-offset), mosaics, and false headers.

Usage: raster_options_test.py GIGABAKE SOURCE_DIR
"""
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal
from raster_places import LEFT, PIXEL, TOP, RasterTest

RED, BLUE = (200, 30, 20), (20, 40, 180)
CRS_KEY = {"crs": "EPSG:32632"}


class RasterOptionsTest(RasterTest):
    def photo(self, name, colour, columns=(0, 40)):
        image = numpy.ones((3, 80, 2 * (columns[1] - columns[0])), "u1") * numpy.array(colour, "u1")[:, None, None]
        return self.write(name, image, left=LEFT + columns[0] * PIXEL, pixel=1, kind=gdal.GDT_Byte)

    def hashes(self, source, *arguments, ranks=None):
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        self.program.succeed("bake", source, "-o", self.folder / "out", "--voxel-size", 1, *arguments, ranks=ranks)
        return harness.lod_hashes(self.program.info(self.folder / "out"))

    def misused(self, source, *words, arguments):
        result = self.program.run("plan", source, "--voxel-size", 2, "--no-measure", *arguments)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        for word in words:
            self.assertIn(word, result.stderr.strip().splitlines()[-1])

    def test_options_equal_the_keys_of_a_scene(self):
        self.height[10:20, 10:20] = -9999
        self.height[20:25, 10:20] = -32768
        self.write("dem.tif", self.height, epsg=None)
        photo = self.photo("photo.tif", RED)
        (self.folder / "elsewhere").mkdir()
        photo = photo.rename(self.folder / "elsewhere/photo.tif")
        arguments = ("--ortho", photo, "--dem-crs", "EPSG:32632", "--nodata=-9999,-32768", "--geoid-offset", 47)
        by_options = self.hashes(self.folder / "dem.tif", *arguments)
        voxels = self.program.info(self.folder / "out")["lods"][0]["voxels"]
        self.assertEqual(self.colours((30, 30)), [list(RED)])
        self.assertAlmostEqual(float(self.at((30, 30))[0]["height"]), self.height[30, 30] + 47, delta=0.6)
        scene = self.scene({"dem": "dem.tif", "ortho": "elsewhere/photo.tif", "nodata": [-9999, -32768],
                            "geoid_offset_m": 47, **CRS_KEY})
        self.hashes(scene)  # the place of a source in a scene is rounded again
        self.assertAlmostEqual(self.program.info(self.folder / "out")["lods"][0]["voxels"], voxels, delta=voxels / 200)
        self.assertEqual(self.colours((30, 30)), [list(RED)])
        self.assertEqual(self.hashes(self.folder / "dem.tif", *arguments, ranks=2), by_options)

    def test_a_single_negative_number_is_a_value(self):
        self.height[10:20, 10:20] = -9999
        path = self.write("dem.tif", self.height)
        self.refused(path, "nodata: ", "-9999", "--nodata")
        self.bake(path, 1, "--nodata", -9999)
        self.assertEqual(self.at((15, 15))[0]["outcome"], "nothing hit")

    def test_dem_crs_states_heights(self):
        path = self.write("dem.tif", self.height)
        self.bake(path, 1, "--dem-crs", "EPSG:32632+5773")
        self.assertGreater(float(self.at((20, 20))[0]["height"]), self.height[20, 20] + 40)
        self.misused(path, "--dem-crs", "is unknown", "EPSG:999999", arguments=("--dem-crs", "EPSG:999999"))

    def test_a_folder_of_rasters_has_one_photo_which_may_lie_in_it(self):
        tiles = self.folder / "tiles"
        tiles.mkdir()
        self.write("tiles/w.tif", self.height[:, :20])
        self.write("tiles/e.tif", self.height[:, 20:], left=LEFT + 20 * PIXEL)
        self.photo("tiles/photo.tif", BLUE)
        self.bake(tiles, 1, "--ortho", tiles / "photo.tif")
        self.assertEqual(self.colours((5, 20), (35, 20)), [list(BLUE)] * 2)

    def test_mosaics_of_photos_and_of_rasters_are_vrts(self):
        self.write("w.tif", self.height[:, :20])
        self.write("e.tif", self.height[:, 20:], left=LEFT + 20 * PIXEL)
        self.photo("red.tif", RED, (0, 20)), self.photo("blue.tif", BLUE, (20, 40))
        for name, parts in (("dem.vrt", ("w.tif", "e.tif")), ("photo.vrt", ("red.tif", "blue.tif"))):
            vrt = gdal.BuildVRT(str(self.folder / name), [str(self.folder / part) for part in parts])
            vrt = None
        self.bake(self.folder / "dem.vrt", 1, "--ortho", self.folder / "photo.vrt")
        self.expect_heights(self.height)
        self.assertEqual(self.colours((5, 20), (35, 20)), [list(RED), list(BLUE)])

    def test_the_last_raster_with_a_value_applies(self):
        high = self.height + 50
        high[10:20, 10:20] = -1
        self.write("b.tif", high, nodata=-1)
        self.write("a.tif", self.height)

        def expect(source, hole, around):
            self.bake(source)
            for place, expected in (((15, 15), hole), ((30, 30), around), ((5, 30), around)):
                height = float(self.at(place)[0]["height"])
                self.assertAlmostEqual(height, self.height[place[1], place[0]] + expected, delta=1)

        expect(self.scene({"dem": "a.tif"}, {"dem": "b.tif"}), 0, 50)
        expect(self.scene({"dem": "b.tif"}, {"dem": "a.tif"}), 0, 0)
        vrt = gdal.BuildVRT(str(self.folder / "both.vrt"), [str(self.folder / name) for name in ("a.tif", "b.tif")],
                            srcNodata="-1", VRTNodata="-1")
        vrt = None
        expect(self.folder / "both.vrt", 0, 50)

    def test_other_sources_refuse_options_of_rasters(self):
        path = self.write("dem.tif", self.height)
        mesh = self.folder / "mesh.obj"
        mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        photo = self.photo("photo.tif", RED)
        for option, value in (("--ortho", photo), ("--nodata", 0), ("--dem-crs", "EPSG:4326"), ("--geoid-offset", 1)):
            self.misused(mesh, option, "no elevation raster", arguments=(option, value))
            self.misused(self.scene({"dem": "dem.tif"}), option, ".json", arguments=(option, value))
        self.misused(path, "--ortho", "no such file", "gone.tif", arguments=("--ortho", "gone.tif"))
        self.misused(path, "--nodata", arguments=("--nodata", "none"))
        mixed = self.folder / "mixed"
        mixed.mkdir()
        shutil.copy(mesh, mixed)
        shutil.copy(path, mixed)
        self.misused(mixed, "--ortho", arguments=("--ortho", photo))

    def false_header(self, name, tags, **options):
        """Writes a small GeoTIFF and changes tags of its header. tags: values by number of the tag."""
        raster = gdal.GetDriverByName("GTiff").Create(str(self.folder / name), 100, 100, 1, gdal.GDT_Float32,
                                                      [f"{key}={value}" for key, value in options.items()])
        raster.SetGeoTransform([LEFT, 0.1, 0, TOP, 0, -0.1])
        raster = None
        content = bytearray((self.folder / name).read_bytes())
        directory, = struct.unpack_from("<I", content, 4)
        for i in range(struct.unpack_from("<H", content, directory)[0]):
            at = directory + 2 + 12 * i
            tag, = struct.unpack_from("<H", content, at)
            if tag in tags:
                struct.pack_into("<HHII", content, at, tag, 4, 1, tags[tag])
        (self.folder / name).write_bytes(content)
        return self.folder / name

    def test_false_headers_take_no_memory(self):
        width, height, rows_per_strip, tile_width, tile_height = 256, 257, 278, 322, 323
        edge = 100000
        cases = (("strips", {rows_per_strip: 1}, {}), ("thick", {}, {"BLOCKYSIZE": 100}),
                 ("strip", {rows_per_strip: edge}, {}), ("tiles", {}, {"TILED": "YES"}),
                 ("packed", {}, {"TILED": "YES", "COMPRESS": "DEFLATE"}),
                 ("tile", {tile_width: 99968, tile_height: 99968}, {"TILED": "YES"}))
        for name, tags, options in cases:
            path = self.false_header(f"{name}.tif", {width: edge, height: edge, **tags}, **options)
            limited = ["sh", "-c", 'ulimit -v 4000000; exec "$@"', "sh", str(self.program.executable)]
            result = subprocess.run([*limited, "bake", str(path), "-o", str(self.folder / "out"), "--voxel-size", "1",
                                     "--dem-crs", "EPSG:32632", "-q"], capture_output=True, text=True, timeout=100)
            self.assertEqual(result.returncode, 1, name + result.stderr)
            [line] = result.stderr.strip().splitlines()
            self.assertIn(f"{name}.tif: dem: ", line)
            self.assertFalse((self.folder / "out").exists(), name)


if __name__ == "__main__":
    RasterTest.program = harness.Gigabake(sys.argv[1])
    harness.skip_without(RasterTest.program, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1], verbosity=2)
