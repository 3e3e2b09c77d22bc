#!/usr/bin/env python3
"""The inputs of bug-reports, rebuilt from public reports about other programs, give the results that its README.md and
EXPECT.txt files state. All cases date from 2026-11-25. Usage: bug_reports_test.py GIGABAKE SOURCE_DIR
"""
import csv
import io
import json
import re
import sys
import unittest
import xml.etree.ElementTree
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

try:
    from osgeo import gdal, osr
    gdal.UseExceptions()
except ImportError:
    gdal = None

BROWN, GREEN, WHITE, RED, GREY = (200, 100, 50), (10, 200, 30), (255, 255, 255), (255, 0, 0), (127, 127, 127)
BLACK = (0, 0, 0)
PLACE = "47.37,8.54,430"


class BugReports(harness.FolderTest):
    def bake(self, source, *arguments, voxel_size=0.5):
        out = self.root / "out"
        result = PROGRAM.run("bake", source, "-o", out, "--voxel-size", voxel_size, *arguments)
        return out, result

    def voxels(self, name, *arguments, status=0, words=()):
        """Bakes a mesh. Returns its voxels; none if the bake failed."""
        source = MESHES / name
        if source.suffix in (".obj", ".ply", ".stl"):
            arguments = ("--up", "z", *arguments)
        out, result = self.bake(source, *arguments)
        self.assertEqual(result.returncode, status, f"{name}: {result}")
        for word in words:
            self.assertIn(word, result.stdout + result.stderr, name)
        if status == 1:
            return None
        PROGRAM.run("export", out, "-o", self.root / "out.ply", "--lod", 0)
        return harness.read_ply(self.root / "out.ply")

    def expect(self, name, colours, *arguments, **options):
        voxels = self.voxels(name, *arguments, **options)
        found, counts = numpy.unique(voxels["rgba"][:, :3], axis=0, return_counts=True)
        self.assertEqual({tuple(map(int, c)): int(n) for c, n in zip(found, counts)}, colours, name)
        return voxels


class MeshTest(BugReports):
    def test_obj(self):
        for name in ("obj_tr_one/tr1.obj", "obj_tr_one/plain.obj", "obj_bom/mtllib_first.obj", "obj_misc/abs.obj"):
            self.expect(name, {BROWN: 64})
        self.expect("obj_misc/face_comment.obj", {WHITE: 64})
        self.expect("obj_mixed_vt/mixed.obj", {BROWN: 64, WHITE: 64})
        self.expect("obj_misc/colours255.obj", {WHITE: 64}, words=["warning: ", "colours255.obj"])
        for name, count in (("comb128", 1280), ("comb127", 1270), ("L", 112)):
            self.assertEqual(len(self.voxels(f"obj_polygons/{name}.obj")), count, name)

    def test_a_scaled_map_is_repeated(self):
        voxels = self.voxels("obj_map_scale_offset/s2.obj")
        row = voxels[voxels["ijk"][:, 1] == voxels["ijk"][:, 1].min()]
        row = row[numpy.argsort(row["ijk"][:, 0])]["rgba"]
        self.assertEqual("".join("R" if v[0] > v[2] else "B" for v in row), "RRBBRRBB")

    def test_ply_and_stl(self):
        voxels = self.voxels("ply_face_colours/a.ply")  # one square: voxels of its diagonal have both colours
        self.assertEqual(len(voxels), 64)
        for colour in (BROWN, GREEN):
            self.assertEqual((voxels["rgba"][:, :3] == colour).all(1).sum(), 28)
        self.expect("stl_count_zero/one_of_two.stl", {WHITE: 64}, words=["the header states fewer triangles"])
        self.expect("stl_count_zero/trailing.stl", {WHITE: 64})

    def test_gltf(self):
        for name in ("gltf_png_gama/linear100000.glb", "gltf_png_gama/none.glb", "gltf_png_gama/srgb45455.glb",
                     "png_16_bit/a.glb", "png_16_bit/srgb.glb", "gltf_emissive_only/a.glb",
                     "gltf_data_uri_types/image_jpg.gltf", "gltf_data_uri_types/image_png.gltf",
                     "uri_backslash/image_bs.glb", "gltf_techniques_webgl/used.json"):
            self.expect(name, {BROWN: 64})
        for name in ("gltf_data_uri_types/buffer_charset.gltf", "gltf_data_uri_types/buffer_text.gltf",
                     "gltf_node_visibility/a.glb"):
            self.expect(name, {RED: 64})
        self.voxels("gltf_techniques_webgl/required.json", status=1, words=["KHR_techniques_webgl"])
        self.expect("gltf_sampler_gl_clamp/wrap10496.glb", {BROWN: 64}, words=["warning: ", "10496"])
        self.expect("uri_backslash/image_case.glb", {GREY: 64}, status=3, words=["Textures"])

    def test_webp_images_in_data_uris(self):
        """Tests that the only texel is black, as GDAL reads it."""
        probe = PROGRAM.run("plan", MESHES / "gltf_webp_data_uri/webp.gltf", "--voxel-size", 0.5)
        if "built without" in probe.stderr:
            self.skipTest("built without libwebp")
        for name in ("webp", "octet"):
            self.expect(f"gltf_webp_data_uri/{name}.gltf", {BLACK: 64})

    def test_what_is_invisible_fails_and_changes_nothing(self):
        self.voxels("obj_tr_one/plain.obj")
        out = self.root / "out"
        before = {p: p.read_bytes() for p in out.rglob("*") if p.is_file() and p.suffix in (".xml", ".h5")}
        self.assertGreater(len(before), 1)
        self.voxels("gltf_alpha_zero/a.glb", "--prune", status=1, words=["material", "alpha 0"])
        self.assertEqual({p: p.read_bytes() for p in before}, before)
        plan = PROGRAM.run("plan", MESHES / "gltf_alpha_zero/a.glb", "--voxel-size", 0.5)
        self.assertEqual(plan.returncode, 1, plan)
        self.assertIn("material", plan.stderr)

    def test_the_place_of_a_tileset_is_that_of_its_content(self):
        # google_like.json names an rtc.b3dm that is missing in the data; exporter_files_test.py makes such a tileset.
        for name in ("global_region", "local_box"):
            for origin in ([], ["--origin", PLACE]):
                voxels = self.expect(f"tileset_root_box_earth_centre/{name}.json", {RED: 64}, *origin)
                self.assertLess(abs(voxels["p"]).max(), 4.1, name)
                self.assertEqual(len(set(voxels["ijk"][:, 2].tolist())), 1, name)

    def test_tilesets(self):
        for name in ("empty_uri", "http", "missing"):
            self.assertEqual(len(self.voxels(f"tileset_empty_uri/{name}.json", status=3)), 128, name)
        self.expect("uri_backslash/tileset_bs.json", {RED: 64})
        voxels = self.expect("folder_tileset_other_name", {RED: 64})
        self.assertEqual((voxels["p"][:, 0].min(), voxels["p"][:, 0].max()), (100.25, 103.75))
        self.assertEqual(len(self.voxels("cmpt_unaligned/tileset.json")), 128)
        for name in ("exact", "padded16", "longview"):
            self.assertEqual(len(self.voxels(f"implicit_padded_buffer/{name}.json")), 64, name)

    def test_a_tileset_across_the_antimeridian_has_its_origin_there(self):
        self.assertEqual(len(self.voxels("tileset_antimeridian/west_gt_east.json")), 72)  # off the lattice by 1.07 m
        origin = PROGRAM.info(self.root / "out")["origin"]
        self.assertAlmostEqual(abs(origin["longitude_deg"]), 180, 3)

    def test_names_leave_scene_xml_well_formed(self):
        for name in ("amp", "fffe"):
            self.assertEqual(len(self.voxels(f"loss_names_xml/{name}.json", status=3)), 64, name)
            xml.etree.ElementTree.parse(self.root / "out" / "scene.xml")


class RasterReports(BugReports):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        harness.skip_without(PROGRAM, "GDAL", "probe.tif")

    def source(self, name):
        folder = RASTERS / name
        return folder / ("scene.json" if (folder / "scene.json").exists() else "dem.tif")

    def at(self, places):
        table = self.root / "places.csv"
        table.write_text("lon,lat\n" + "".join(f"{lon:.10f},{lat:.10f}\n" for lon, lat in places))
        text = PROGRAM.succeed("query", self.root / "out", "--coordinates", "lonlat", "--heights", table)
        return list(csv.DictReader(io.StringIO(text)))

    def compare(self, name, answer, right):
        """Compares an answer with the expected values (`right`) of EXPECT.txt."""
        if right == "nothing hit":
            self.assertEqual(answer["outcome"], right, name)
            return
        self.assertEqual(answer["outcome"], "hit", name)
        if heights := re.match(r"hit, (?:about )?([\d.]+)(?: to ([\d.]+))?", right):
            low, high = float(heights[1]), float(heights[2] or heights[1])
            off = 0.5 if heights[2] else 5  # "about" means within a voxel of 5 m
            self.assertTrue(low - off <= float(answer["height"]) <= high + off, (name, answer, right))
        else:
            colour = [int(c) for c in re.search(r"(\d+),(\d+),(\d+)", right).groups()]
            for key, value in zip(("red", "green", "blue"), colour):
                self.assertAlmostEqual(int(answer[key]), value, delta=3, msg=(name, answer, right))

    def test_what_the_expect_files_state(self):
        compared = 0
        for path in sorted(RASTERS.glob("*/EXPECT.txt")):
            name, text = path.parent.name, path.read_text()
            questions = re.findall(r"--at=([\d.]+),([\d.]+)\n +right: (.*)", text)
            if not questions:
                continue
            size = re.search(r"--voxel-size ([\d.]+)", text)[1]
            _, result = self.bake(self.source(name), voxel_size=size)
            if "or a refusal" in text and result.returncode == 1:
                self.assertIn("NODATA_value", result.stderr, name)  # GDAL before 3.9
                continue
            self.assertEqual(result.returncode, 0, f"{name}: {result}")
            if "or a warning" in text:
                self.assertIn("ortho_crs", result.stderr, name)
                continue
            answers = self.at([(float(lon), float(lat)) for lon, lat, _ in questions])
            for answer, (_, _, right) in zip(answers, questions):
                self.compare(name, answer, right)
                compared += 1
        self.assertGreater(compared, 20)

    def expect_raster(self, name, file, unit_m=1, epsg=None):
        """Compares heights between pixels with bilinear heights by GDAL, at 36 places per file."""
        raster = gdal.Open(str(RASTERS / name / file))
        band, g = raster.GetRasterBand(1), raster.GetGeoTransform()
        z = band.ReadAsArray().astype("f8")
        z = numpy.where(z == -999900, numpy.nan, z) * (band.GetScale() or 1) * unit_m
        crs, earth = raster.GetSpatialRef(), osr.SpatialReference()
        if crs.IsCompound():
            crs.StripVertical()
        earth.ImportFromEPSG(4326)
        for c in (crs, earth):
            c.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        to_earth = osr.CoordinateTransformation(crs, earth)
        steps = [(c + 1, r + 1) for r in range(3, z.shape[0] - 4, z.shape[0] // 7)
                 for c in range(3, z.shape[1] - 4, z.shape[1] // 7)]
        places = [to_earth.TransformPoint(g[0] + c * g[1] + r * g[2], g[3] + c * g[4] + r * g[5])[:2]
                  for c, r in steps]
        around = [z[r - 1:r + 1, c - 1:c + 1] for c, r in steps]
        hits = 0
        for (c, r), answer, four in zip(steps, self.at(places), around):
            if numpy.isnan(z[r - 2:r + 2, c - 2:c + 2]).any():
                continue
            self.assertEqual(answer["outcome"], "hit", (name, c, r))
            self.assertAlmostEqual(float(answer["height"]), four.mean(), delta=0.75 + numpy.ptp(four) / 2,
                                   msg=(name, c, r))
            hits += 1
        self.assertGreater(hits, 20, name)

    @unittest.skipIf(gdal is None, "expected python3-gdal to be installed")
    def test_heights_of_right_rasters_stay(self):
        for name, files, unit_m in (("antimeridian_o2", ["dem.tif"], 1), ("crs_2180", ["dem.tif"], 1),
                                    ("point", ["dem.tif"], 1), ("rotated", ["dem.tif"], 1),
                                    ("scale_cm", ["dem.tif"], 1), ("v_ftus_compound", ["dem.tif"], 1200 / 3937),
                                    ("utm_border", ["w.tif", "e.tif"], 1)):
            options = ["--geoid-offset", 0] if name == "v_ftus_compound" else []
            _, result = self.bake(self.source(name), *options)
            self.assertEqual(result.returncode, 0, f"{name}: {result}")
            for file in files:
                self.expect_raster(name, file, unit_m)

    @unittest.skipIf(gdal is None, "expected python3-gdal to be installed")
    def test_stripes_of_an_orthophoto_stay(self):
        _, result = self.bake(self.source("coarse"))
        self.assertEqual(result.returncode, 0, result)
        utm, earth = osr.SpatialReference(), osr.SpatialReference()
        utm.ImportFromEPSG(25832), earth.ImportFromEPSG(4326)
        for c in (utm, earth):
            c.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        turn = osr.CoordinateTransformation(utm, earth)
        places = [turn.TransformPoint(500500 + k / 2 + 0.25, 5399500)[:2] for k in range(32)]
        red = [int(row["red"]) for row in self.at(places)]
        for k in range(0, 32, 8):  # the inner voxels of each stripe of four
            self.assertTrue(min(red[k + 1:k + 3]) > 240 and max(red[k + 5:k + 7]) < 15, red)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    DATA = harness.shared_folder(sys.argv[2]) / "data" / "bug-reports"
    if not DATA.is_dir():
        print(f"skipped: expected the inputs in {DATA}")
        sys.exit(77)
    MESHES, RASTERS = DATA / "meshes", DATA / "rasters"
    harness.main(argv=sys.argv[:1], verbosity=2)
