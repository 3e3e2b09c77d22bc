#!/usr/bin/env python3
"""GeoTIFF exports (dsm, ortho, classes), read by GDAL: each pixel equals the answer of `query` at its centre.

Usage: export_map_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import resource
import shutil
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import coordinate_system, gdal, ogr, osr
from programs import lines_of

VOXEL_M = 0.5
MISSING = 3


class Map:
    """A GeoTIFF: its pixels from north to south, and its place."""

    def __init__(self, path):
        self.data = gdal.Open(str(path))
        self.pixels = self.data.ReadAsArray()
        self.west, self.step, turn_x, self.north, turn_y, down = self.data.GetGeoTransform()
        assert (turn_x, turn_y, down) == (0, 0, -self.step)
        self.columns, self.rows = self.data.RasterXSize, self.data.RasterYSize
        self.south = self.north - self.rows * self.step

    def centres(self):
        """Returns x and y of the pixels' centres, row by row from the north."""
        x = self.west + (numpy.arange(self.columns) + 0.5) * self.step
        y = self.north - (numpy.arange(self.rows) + 0.5) * self.step
        return numpy.stack(numpy.meshgrid(x, y), -1).reshape(-1, 2)

    def epsg(self):
        return self.data.GetSpatialRef().GetAuthorityCode(None)


def to_degrees_from(epsg):
    return osr.CoordinateTransformation(coordinate_system(f"EPSG:{epsg}"), coordinate_system("EPSG:4326"))


class ExportMap(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(sys.argv[1])
        cls.program.succeed("sample", cls.root / "village", "--size", "96", "--seed", "3")
        cls.scene = cls.root / "bake"
        cls.program.bake(cls.root / "village/tileset.json", cls.scene, VOXEL_M, "--cell-voxels", "64")

    def map(self, *options, code=0, scene=None, name="map.tif"):
        result = self.program.run("export", scene or self.scene, *options, "-o", self.root / name, "-q")
        self.assertEqual(result.returncode, code, result.stderr)
        return Map(self.root / name)

    def answers(self, raster, *options, scene=None, code=0):
        """Returns the answers of query at the pixels of a map, in the order of its rows."""
        description = raster.data.GetMetadataItem("TIFFTAG_IMAGEDESCRIPTION")
        grid = re.search(r"(--grid=\S+) (--step) (\S+)", description).groups()
        west, south = (float(v) for v in grid[0][7:].split(",")[:2])
        self.assertAlmostEqual(west, raster.west + raster.step / 2, delta=1e-6 * raster.step)
        self.assertAlmostEqual(south, raster.south + raster.step / 2, delta=1e-6 * raster.step)
        out = self.root / "answers.npy"
        result = self.program.run("query", scene or self.scene, *grid, "--format", "npy", "-o", out, "-q", *options)
        self.assertEqual(result.returncode, code, result.stderr)
        return numpy.load(out).reshape(raster.rows, raster.columns)[::-1]

    def expect_heights(self, raster, answers):
        expected = answers[answers.dtype.names[0]].astype("f4")  # height_m, or height with --crs
        self.assertTrue(numpy.array_equal(raster.pixels, expected, equal_nan=True),
                        numpy.nanmax(numpy.abs(raster.pixels - expected)))

    def test_a_dsm_in_degrees_has_the_heights_of_query(self):
        raster = self.map("--to", "dsm", "--crs", "EPSG:4326", "--step", "1e-6", "--memory", "64M")
        self.assertEqual(raster.epsg(), "4326")
        self.assertGreater(min(raster.columns, raster.rows), 600)  # several blocks
        self.assertGreater(numpy.isfinite(raster.pixels).sum(), raster.pixels.size // 2)
        self.expect_heights(raster, self.answers(raster, "--coordinates", "lonlat"))

    def test_maps_in_the_frame_of_the_scene_have_the_heights_and_colours_of_query(self):
        raster = self.map("--to", "dsm", "--crs", "scene", "--step", "0.3")
        self.assertTrue(raster.data.GetSpatialRef().IsLocal())
        answers = self.answers(raster)
        self.expect_heights(raster, answers)
        colours = self.map("--to", "ortho", "--crs", "scene", "--step", "0.3")
        self.assertEqual(colours.pixels.shape, (4,) + answers.shape)
        there = numpy.isfinite(answers["height_m"])
        expected = numpy.where(there[..., None], answers["rgba"], 0)
        self.assertTrue((numpy.moveaxis(colours.pixels, 0, -1) == expected).all())
        self.assertTrue(((colours.pixels[3] == 0) == ~there).all())

    def test_coarser_levels_have_the_heights_of_query(self):
        raster = self.map("--to", "dsm", "--crs", "scene", "--lod", 3)
        self.assertEqual(raster.step, 8 * VOXEL_M)
        self.expect_heights(raster, self.answers(raster, "--lod", 3))

    def test_the_default_is_the_zone_of_utm_and_voxels(self):
        raster = self.map("--to", "dsm")
        longitude, latitude = (self.program.info(self.scene)["origin"][k] for k in ("longitude_deg", "latitude_deg"))
        zone = int((longitude + 180) // 6) + 1
        self.assertEqual(raster.epsg(), str((32600 if latitude >= 0 else 32700) + zone))
        self.assertEqual(raster.step, VOXEL_M)
        self.assertEqual((raster.west / VOXEL_M) % 1, 0)
        to_degrees = to_degrees_from(raster.epsg())
        places = numpy.array(to_degrees.TransformPoints(raster.centres().tolist()))[:, :2]
        numpy.save(self.root / "places.npy", places)
        self.program.succeed("query", self.scene, "--coordinates", "lonlat", "--heights", self.root / "places.npy",
                             "--format", "npy", "-o", self.root / "heights.npy", "-q")
        expected = numpy.load(self.root / "heights.npy")["height_m"].reshape(raster.rows, raster.columns)
        # A pixel on the border of two voxels can fall into either one.
        differs = ~numpy.isclose(raster.pixels, expected, rtol=0, atol=1e-3, equal_nan=True)
        self.assertLess(differs.mean(), 1e-3)

    def test_a_dsm_in_a_projection_has_the_heights_of_query(self):
        raster = self.map("--to", "dsm", "--crs", "EPSG:25832", "--step", "0.5")
        low = raster.west + 0.25, raster.south + 0.25  # exact: edges are multiples of 0.5
        high = low[0] + (raster.columns - 0.75) * 0.5, low[1] + (raster.rows - 0.75) * 0.5
        grid = "--grid=" + ",".join(repr(v) for v in low + high)
        self.program.succeed("query", self.scene, "--crs", "EPSG:25832", grid, "--step", "0.5", "--format", "npy", "-o",
                             self.root / "answers.npy", "-q")
        answers = numpy.load(self.root / "answers.npy").reshape(raster.rows, raster.columns)[::-1]
        self.assertGreater(numpy.isfinite(raster.pixels).sum(), 1000)
        self.expect_heights(raster, answers)

    def test_a_vertical_system_changes_heights(self):
        plain = self.map("--to", "dsm", "--crs", "EPSG:32632", "--step", "4")
        wkt = (coordinate_system("EPSG:32632").ExportToWkt(),
               'VERT_CS["feet",VERT_DATUM["ellipsoid",2002],UNIT["foot",0.3048]]')
        crs = f'COMPD_CS["both",{wkt[0]},{wkt[1]}]'
        result = self.program.run("export", self.scene, "--to", "dsm", "--crs", crs, "--step", "4", "-q", "-o",
                                  self.root / "feet.tif")
        if result.returncode == 2:
            self.skipTest("PROJ has no transformation to ellipsoidal heights in feet")
        feet = Map(self.root / "feet.tif")
        self.assertEqual(feet.data.GetRasterBand(1).GetUnitType(), "ft")
        self.assertLess(numpy.nanmax(numpy.abs(feet.pixels * 0.3048 - plain.pixels)), 1e-3)

    def test_files_are_cloud_optimized_with_overviews_and_no_data(self):
        for kind, bands in (("dsm", 1), ("ortho", 4)):
            raster = self.map("--to", kind, "--step", "0.1")
            data = raster.data
            self.assertEqual(data.GetMetadata("IMAGE_STRUCTURE")["LAYOUT"], "COG")
            self.assertEqual(data.RasterCount, bands)
            band = data.GetRasterBand(1)
            self.assertEqual(band.GetBlockSize(), [512, 512])
            self.assertGreaterEqual(band.GetOverviewCount(), 1)
            coarsest = band.GetOverview(band.GetOverviewCount() - 1)
            self.assertLessEqual(max(coarsest.XSize, coarsest.YSize), 512)
            if kind == "dsm":
                self.assertTrue(numpy.isnan(band.GetNoDataValue()))
                self.assertEqual(band.GetUnitType(), "m")
                mean = numpy.nanmean(raster.pixels)
                self.assertAlmostEqual(numpy.nanmean(coarsest.ReadAsArray()), mean, delta=0.2)
            else:
                self.assertEqual(data.GetRasterBand(4).GetColorInterpretation(), gdal.GCI_AlphaBand)

    def test_the_bytes_do_not_depend_on_ranks_threads_and_memory(self):
        self.map("--to", "dsm", "--step", "0.2", "--threads", 1, "--memory", "64M", name="one.tif")
        self.map("--to", "dsm", "--step", "0.2", "--threads", 3, name="three.tif")
        one = (self.root / "one.tif").read_bytes()
        self.assertEqual(one, (self.root / "three.tif").read_bytes())
        self.program.succeed("export", self.scene, "--to", "dsm", "--step", "0.2", "-q", "-o", self.root / "ranks.tif",
                             ranks=3)
        self.assertEqual(one, (self.root / "ranks.tif").read_bytes())

    def test_bounds_in_the_system_of_the_map_are_its_bounds_and_adjacent_maps_join(self):
        whole = self.map("--to", "dsm", "--crs", "EPSG:32632", "--step", "0.5")
        middle = [round(whole.west + whole.columns // 2 * 0.5, 1), round(whole.south + whole.rows // 2 * 0.5, 1)]
        low, high = [v - 20 for v in middle], [v + 20 for v in middle]
        parts = []
        for west, east in ((low[0], middle[0]), (middle[0], high[0])):
            part = self.map("--to", "dsm", "--crs", "EPSG:32632", "--step", "0.5", "--bounds",
                            f"{west},{low[1]},{east},{high[1]}", name="part.tif")
            self.assertEqual((part.west, part.south, part.columns, part.rows), (west, low[1], 40, 80))
            parts.append(part.pixels)
        column, row = int((low[0] - whole.west) / 0.5), int((whole.north - high[1]) / 0.5)
        expected = whole.pixels[row:row + 80, column:column + 80]
        self.assertTrue(numpy.array_equal(numpy.concatenate(parts, 1), expected, equal_nan=True))

    def test_a_polygon_and_degrees_keep_the_pixels_whose_places_are_inside(self):
        whole = self.map("--to", "dsm", "--step", "0.5")
        to_degrees = to_degrees_from(whole.epsg())
        x, y = whole.west + whole.columns * 0.25, whole.south + whole.rows * 0.25
        corners = [to_degrees.TransformPoint(x + dx, y + dy)[:2] for dx, dy in ((-15, -10), (17, -12), (3, 19))]
        west, south = numpy.min(corners, 0)
        east, north = numpy.max(corners, 0)
        triangle = self.root / "triangle.geojson"
        triangle.write_text(json.dumps({"type": "Polygon", "coordinates": [corners + corners[:1]]}))
        for options, rings in ((("--clip", triangle), corners),
                               (("--bounds", f"{west},{south},{east},{north}"),
                                [(west, south), (east, south), (east, north), (west, north)])):
            part = self.map("--to", "dsm", "--step", "0.5", *options, name="part.tif")
            ring = ogr.Geometry(ogr.wkbLinearRing)
            for p in list(rings) + [rings[0]]:
                ring.AddPoint_2D(*p)
            area = ogr.Geometry(ogr.wkbPolygon)
            area.AddGeometry(ring)
            places = numpy.array(to_degrees.TransformPoints(part.centres().tolist()))[:, :2]
            inside = []
            for p in places:
                point = ogr.Geometry(ogr.wkbPoint)
                point.AddPoint_2D(*p)
                inside.append(area.Contains(point))
            inside = numpy.array(inside).reshape(part.rows, part.columns)
            column, row = round((part.west - whole.west) / 0.5), round((whole.north - part.north) / 0.5)
            of_whole = whole.pixels[row:row + part.rows, column:column + part.columns]
            self.assertGreater(inside.sum(), 500)
            self.assertTrue(numpy.array_equal(part.pixels, numpy.where(inside, of_whole, numpy.nan), equal_nan=True))

    def test_a_missing_cell_has_no_data_and_the_exit_status_tells(self):
        broken = self.root / "broken"
        shutil.copytree(self.scene, broken)
        whole = self.map("--to", "dsm", "--crs", "scene")
        cell = self.program.succeed("query", self.scene, "--at", "0.1,0.1").splitlines()[1].split(",")[-1]
        for shard in (broken / "shards").glob(cell + "-*.h5"):
            shard.unlink()
        result = self.program.run("export", broken, "--to", "dsm", "--crs", "scene", "-o", self.root / "part.tif")
        self.assertEqual(result.returncode, MISSING, result.stderr)
        self.assertIn(cell, result.stderr)
        part = Map(self.root / "part.tif")
        lost = numpy.isnan(part.pixels) & numpy.isfinite(whole.pixels)
        self.assertGreater(lost.sum(), 100)
        self.assertTrue((numpy.isnan(part.pixels) | (part.pixels == whole.pixels)).all())
        self.expect_heights(part, self.answers(part, scene=broken, code=MISSING))
        of_ranks = self.program.run("export", broken, "--to", "dsm", "--crs", "scene", "-q", "-o",
                                    self.root / "ranks.tif", ranks=2)
        self.assertEqual(of_ranks.returncode, MISSING, of_ranks.stderr)
        self.assertEqual(of_ranks.stderr.count(cell), 1, of_ranks.stderr)

    def test_a_map_of_classes_has_the_classes_of_query(self):
        sources = [{"path": "village/tileset.json", "class": 2,
                    "class_of_material": {name: number for number, name in enumerate(self.materials(), 300)}}]
        (self.root / "classes.json").write_text(json.dumps({"gigabake": 1, "sources": sources}))
        scene = self.root / "with_classes"
        self.program.bake(self.root / "classes.json", scene, VOXEL_M, "--cell-voxels", "64")
        raster = self.map("--to", "classes", "--crs", "scene", "--step", "0.07", scene=scene, name="classes.tif")
        answers = self.answers(raster, scene=scene)
        has_surface = numpy.isfinite(answers["height_m"])
        self.assertTrue(numpy.array_equal(raster.pixels, numpy.where(has_surface, answers["class"].astype("i4"), -1)))
        self.assertGreater(len(numpy.unique(raster.pixels)), 3)
        band = raster.data.GetRasterBand(1)
        self.assertEqual((band.DataType, band.GetNoDataValue()), (gdal.GDT_Int32, -1))
        self.assertGreater(band.GetOverviewCount(), 0)
        coarse = numpy.unique(band.GetOverview(band.GetOverviewCount() - 1).ReadAsArray())
        self.assertLessEqual(set(coarse), set(numpy.unique(raster.pixels)))
        of_ranks = self.program.run("export", scene, "--to", "classes", "--crs", "scene", "--step", "0.07", "-q", "-o",
                                    self.root / "ranks.tif", ranks=2)
        self.assertEqual(of_ranks.returncode, 0, of_ranks.stderr)
        self.assertEqual((self.root / "ranks.tif").read_bytes(), (self.root / "classes.tif").read_bytes())

    def materials(self):
        """Returns the names of the materials of the village."""
        names = set()
        for tile in (self.root / "village").rglob("*.glb"):
            data = tile.read_bytes()
            length = int.from_bytes(data[12:16], "little")
            names |= {m.get("name", "") for m in json.loads(data[20:20 + length]).get("materials", [])}
        return sorted(names - {""})

    def test_bad_input_is_one_line_and_leaves_no_file(self):
        before = sorted(self.root.iterdir())
        for expected, *options in (
                ("--step", "--to", "dsm", "--crs", "EPSG:4326"), ("--step", "--to", "dsm", "--step", "-1"),
                ("--step", "--to", "dsm", "--step", "1e-9"), ("--lod", "--to", "dsm", "--lod", "40"),
                ("EPSG:99999", "--to", "ortho", "--crs", "EPSG:99999"),
                ("--bounds", "--to", "dsm", "--bounds", "100,40,101,41"),
                ("--to classes", "--to", "classes"), ("--memory", "--to", "dsm", "--memory", "1K"),
                ("--step", "--to", "ply", "--step", "1"),
                ("--tile-voxels", "--to", "dsm", "--tile-voxels", "32")):
            result = self.program.run("export", self.scene, "-o", self.root / "none.tif", *options)
            self.assertEqual((result.returncode, len(lines_of(result.stderr))), (2, 1), (options, result.stderr))
            self.assertIn(expected, result.stderr)
        result = self.program.run("export", self.scene, "--to", "dsm", "-o", self.scene / "scene.xml")
        self.assertEqual((result.returncode, len(lines_of(result.stderr))), (1, 1), result.stderr)
        self.assertEqual(sorted(self.root.iterdir()), before)

    def test_a_full_disk_is_one_line_and_leaves_no_file(self):
        """The limit of a file's size simulates a full disk: once for the blocks, once for the finished file."""
        before = sorted(self.root.iterdir())
        for limit in (20_000, 200_000):
            result = self.program.run(
                "export", self.scene, "--to", "dsm", "--step", "0.1", "-q", "-o", self.root / "none.tif",
                restore_signals=False,  # SIGXFSZ stays ignored
                preexec_fn=lambda size=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
            self.assertEqual((result.returncode, len(lines_of(result.stderr))), (1, 1), result.stderr)
            self.assertIn("none.tif", result.stderr)
            self.assertEqual(sorted(self.root.iterdir()), before)


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
