#!/usr/bin/env python3
"""Tests elevation rasters as surveying and GIS tools write them: validity, units, neighbours, formats.

Usage: raster_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal, osr
from raster_places import LEFT, PIXEL, TOP, RasterTest, lon_lat, translate


def change(path, work):
    raster = gdal.Open(str(path), gdal.GA_Update)
    work(raster)
    raster = None


class ValidityTest(RasterTest):
    # Regression of 2026-11-25: masks, alpha bands and .aux.xml files were ignored; masked heights were 0 or -9999.
    def expect_void(self, source):
        before = {p.name for p in self.folder.iterdir()}
        messages = self.bake(source)
        self.assertEqual({p.name for p in self.folder.iterdir()} - {"out"}, before - {"out"})
        self.expect_heights(numpy.where(self.valid, self.height, numpy.nan), step=3)
        self.assertNotIn("taken as holes", messages)

    def hidden(self, value=0):
        return numpy.where(self.valid, self.height, value)

    def masked(self, name, internal):
        path = self.write(name, self.hidden())
        gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES" if internal else "NO")
        try:
            raster = gdal.Open(str(path), gdal.GA_Update if internal else gdal.GA_ReadOnly)
            raster.CreateMaskBand(gdal.GMF_PER_DATASET)
            raster.GetRasterBand(1).GetMaskBand().WriteArray(self.valid.astype("u1") * 255)
            raster = None
        finally:
            gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", None)
        return path

    def test_internal_and_external_masks(self):
        self.expect_void(self.masked("internal.tif", True))
        external = self.masked("external.tif", False)
        self.assertTrue((self.folder / "external.tif.msk").exists())
        self.expect_void(external)

    def test_alpha_bands(self):
        alpha = self.write("alpha.tif", [self.hidden(), self.valid * 255])
        change(alpha, lambda r: r.GetRasterBand(2).SetColorInterpretation(gdal.GCI_AlphaBand))
        self.expect_void(alpha)
        holed = self.write("holed.tif", self.hidden(-9999), nodata=-9999)
        gdal.Warp(str(self.folder / "warped.tif"), str(holed), options="-dstalpha -dstnodata None")
        self.assertEqual(gdal.Open(str(self.folder / "warped.tif")).RasterCount, 2)
        self.expect_void(self.folder / "warped.tif")

    def test_an_aux_xml_states_nodata_scale_and_unit(self):
        raw = self.write("raw.tif", self.hidden(-777), nodata=-777)
        translate(raw, self.folder / "aux.tif", "-co PROFILE=GeoTIFF")
        self.assertIn("NoDataValue", (self.folder / "aux.tif.aux.xml").read_text())
        self.expect_void(self.folder / "aux.tif")
        feet = self.write("raw.tif", self.hidden(-777) * 100, nodata=-77700)
        translate(feet, self.folder / "scaled.tif", "-co PROFILE=BASELINE -a_scale 0.01 -a_offset 0")
        change(raw, lambda r: None)
        self.assertIn("Scale", (self.folder / "scaled.tif.aux.xml").read_text())
        (self.folder / "scaled.tfw").write_text(f"{PIXEL}\n0\n0\n{-PIXEL}\n{LEFT + PIXEL / 2}\n{TOP - PIXEL / 2}\n")
        self.expect_void(self.scene({"dem": "scaled.tif", "crs": "EPSG:32632"}))

    def test_nodata_that_a_tag_rounds(self):
        for value, text in ((-3.4028234663852886e38, -3.40282e38), (-1.7976931348623157e38, -1.79769e38)):
            self.expect_void(self.write("rounded.tif", self.hidden(value), nodata=text))

    def test_a_damaged_aux_xml_is_reported(self):
        path = self.write("dem.tif", self.height)
        for text in ("<PAMDataset><PAMRasterBand band", "<metadata/>", ""):
            (self.folder / "dem.tif.aux.xml").write_text(text)
            [warning] = self.plan(path)["warnings"]
            self.assertIn("its side file 'dem.tif.aux.xml' is not read", warning)

    def test_masks_by_other_writers(self):
        """A mask per band, a mask of 0 and 1, 16-bit alpha of -dstalpha, and a VRT of each."""
        holed = self.write("holed.tif", self.hidden(-9999).astype("i2"), nodata=-9999, kind=gdal.GDT_Int16)
        gdal.Warp(str(self.folder / "alpha.tif"), str(holed), options="-dstalpha -dstnodata None -t_srs EPSG:25832")
        per_band = self.write("band.tif", self.hidden())
        raster = gdal.Open(str(per_band))
        raster.GetRasterBand(1).CreateMaskBand(0)
        raster.GetRasterBand(1).GetMaskBand().WriteArray(self.valid.astype("u1"))
        raster = None
        for name in ("alpha", "band"):
            translate(self.folder / f"{name}.tif", self.folder / f"{name}.vrt", "-of VRT")
            for suffix in (".tif", ".vrt"):
                self.expect_void(self.folder / (name + suffix))

    def test_side_files_lead_nowhere(self):
        path = self.write("dem.tif", self.height)
        translate(path, self.folder / "other.tif", "-outsize 50% 50%")
        for name, domain in (("OVERVIEW_FILE", "OVERVIEWS"), ("X_DATASET", "GEOLOCATION")):
            aside = self.folder / "dem.tif.aux.xml"
            aside.write_text(f'<PAMDataset><Metadata domain="{domain}"><MDI key="{name}">other.tif</MDI></Metadata>'
                             '</PAMDataset>')
            self.refused(path, "names other files", domain)
            aside.unlink()
        change(path, lambda r: r.SetMetadataItem("OVERVIEW_FILE", "other.tif", "OVERVIEWS"))
        self.refused(path, "names another file")

    def test_a_raster_without_values_is_named(self):
        void = self.write("void.tif", numpy.full((40, 40), -9999), left=LEFT + 1000, nodata=-9999)
        self.write("dem.tif", self.height)
        [warning] = self.plan(self.scene({"dem": "dem.tif"}, {"dem": void.name, "crs": "EPSG:25832"}))["warnings"]
        self.assertIn("void.tif: contributes nothing", warning)

    def test_signed_bytes(self):
        path = self.folder / "bytes.tif"
        values = numpy.round(self.height - 120).astype("i1")  # -20 to 4
        raster = gdal.GetDriverByName("GTiff").Create(str(path), 40, 40, 1, gdal.GDT_Byte, ["PIXELTYPE=SIGNEDBYTE"])
        raster.SetGeoTransform([LEFT, PIXEL, 0, TOP, 0, -PIXEL])
        crs = osr.SpatialReference()
        crs.ImportFromEPSG(32632)
        raster.SetProjection(crs.ExportToWkt())
        raster.GetRasterBand(1).WriteArray(values.view("u1"))
        raster = None
        self.bake(path)
        self.expect_heights(values.astype("f8"))


class SurfaceTest(RasterTest):
    def halves(self):
        """Writes two halves. Pixels are areas, so the halves share no column."""
        self.write("w.tif", self.height[:, :18])
        self.write("e.tif", self.height[:, 18:], left=LEFT + 18 * PIXEL)

    def expect_no_gap(self, source, *arguments):
        self.bake(source, 1, *arguments)
        places = [(c / 4, 20) for c in range(4, 150)]
        for place, answer in zip(places, self.at(*places)):
            self.assertEqual(answer["outcome"], "hit", place)
            self.assertAlmostEqual(float(answer["height"]), 100 + 0.4 * place[0] + 4, delta=1)

    # Regression of 2026-11-25: one pixel between the last column of a file and the first of the next was empty.
    def test_neighbours_of_one_grid_are_one_surface(self):
        self.halves()
        self.expect_no_gap(self.scene({"dem": "w.tif"}, {"dem": "e.tif"}))
        whole = self.program.info(self.folder / "out")["lods"][0]["voxels"]
        self.expect_no_gap(self.scene({"dem": "e.tif", "tile_cells": 16}, {"dem": "w.tif", "tile_cells": 16}))
        self.assertAlmostEqual(self.program.info(self.folder / "out")["lods"][0]["voxels"], whole, delta=whole / 50)
        self.expect_no_gap(self.scene({"dem": "."}))
        (self.folder / "scene.json").unlink()
        survey = self.folder / "survey"
        survey.mkdir()
        for name in ("w.tif", "e.tif"):
            (self.folder / name).rename(survey / name)
        self.expect_no_gap(survey)
        vrt = gdal.BuildVRT(str(survey / "mosaic.vrt"), [str(survey / "w.tif"), str(survey / "e.tif")])
        vrt = None
        self.expect_no_gap(survey / "mosaic.vrt")
        self.expect_no_gap(survey)

    def test_edits_cut_and_move_a_surface_in_degrees(self):
        self.halves()

        def ring(low, high):
            corners = ((low, low), (high, low), (high, high), (low, high))
            return [lon_lat(LEFT + (c + 0.5) * PIXEL, TOP - (r + 0.5) * PIXEL) for c, r in corners]
        edits = [{"type": "flatten", "rings_lon_lat": [ring(14.5, 26.5)], "height_m": 130},
                 {"type": "outside", "rings_lon_lat": [ring(17.5, 22.5)]},
                 {"type": "raise", "rings_lon_lat": [ring(30.5, 35.5)], "by_m": -12}]
        expected = self.height.copy()
        expected[15:27, 15:27] = 130
        expected[18:23, 18:23] = numpy.nan
        expected[31:36, 31:36] -= 12
        self.bake(self.scene({"dem": "w.tif", "edits": edits}, {"dem": "e.tif", "edits": edits}))
        self.expect_heights(expected, step=1)
        result = self.program.run("plan", self.scene({"dem": "w.tif", "edits": edits}, {"dem": "e.tif"}),
                                  "--voxel-size", 2, "--no-measure")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("sources[1].edits: differ from the edits of sources[0]", result.stderr)

    def test_a_raster_of_a_folder_that_cannot_be_read_costs_itself_alone(self):
        self.halves()
        self.write("photo.tif", numpy.zeros((3, 9, 9)), kind=gdal.GDT_Byte)
        result = self.program.run("plan", self.folder, "--voxel-size", 2, "--no-measure", "--json")
        self.assertIn(result.returncode, (0, 3))
        [loss] = json.loads(result.stdout)["losses"]
        self.assertIn("photo.tif", str(loss))
        self.assertIn("is an image", str(loss))

    def test_values_of_overlapping_neighbours_close_each_others_holes(self):
        left, right = self.height[:, :25].copy(), self.height[:, 15:].copy()
        left[:, 20:] = -9999
        right[:, :3] = -9999
        self.write("a.tif", left, nodata=-9999)
        self.write("b.tif", right, left=LEFT + 15 * PIXEL, nodata=-9999)
        self.expect_no_gap(self.scene({"dem": "a.tif"}, {"dem": "b.tif"}))

    def test_each_neighbour_has_its_orthophoto_and_options(self):
        self.halves()
        self.write("e.tif", self.height[:, 18:] * 10, left=LEFT + 18 * PIXEL)
        for name, colour, left in (("w", (200, 30, 20), LEFT), ("e", (20, 180, 40), LEFT + 18 * PIXEL)):
            image = numpy.ones((3, 80, 36 if name == "w" else 44), "u1") * numpy.array(colour, "u1")[:, None, None]
            self.write(f"{name}_photo.tif", image, left=left, pixel=1, kind=gdal.GDT_Byte)
        self.expect_no_gap(self.scene({"dem": "w.tif", "ortho": "w_photo.tif"},
                                      {"dem": "e.tif", "ortho": "e_photo.tif", "height_scale": 0.1}))
        self.assertEqual(self.colours((8, 20), (30, 20)), [[200, 30, 20], [20, 180, 40]])

    def test_rasters_of_other_grids_are_named(self):
        self.write("coarse.tif", self.height[:20, :20], pixel=4)
        self.write("inset.tif", self.height[:20, :20], left=LEFT + 10.5)
        self.write("far.tif", self.height[:20, :20], left=LEFT + 1000.5)
        [warning] = self.plan(self.scene(*({"dem": f"{name}.tif"} for name in ("coarse", "inset", "far"))))["warnings"]
        self.assertIn("inset.tif: touches or overlaps 'coarse.tif'", warning)

    def test_a_vrt_names_files_of_its_folder_only(self):
        self.halves()
        inner = self.folder / "inner"
        inner.mkdir()
        vrt = gdal.BuildVRT(str(inner / "out.vrt"), [str(self.folder / "w.tif")])
        vrt = None
        self.refused(inner / "out.vrt", "not in the folder of the VRT")
        vrt = gdal.BuildVRT(str(self.folder / "in.vrt"), [str(self.folder / "w.tif")])
        vrt = None
        text = (self.folder / "in.vrt").read_text()
        self.plan(self.folder / "in.vrt")
        for old, new, words in (('relativeToVRT="1">w.tif', f'relativeToVRT="0">{self.folder}/w.tif', "relative"),
                                ('relativeToVRT="1">w.tif', 'relativeToVRT="1">gone.tif', "no such file"),
                                ("w.tif<", "../w.tif<", "not in the folder"),
                                ("<VRTRasterBand ", '<VRTRasterBand subClass="VRTDerivedRasterBand" ', "subclass"),
                                ("<VRTRasterBand ", "<GDALWarpOptions/><VRTRasterBand ", "GDALWarpOptions")):
            self.assertIn(old, text)
            (self.folder / "in.vrt").write_text(text.replace(old, new))
            self.refused(self.folder / "in.vrt", words)
        (self.folder / "in.vrt").write_text(text)
        (self.folder / "w.tif.ovr").write_text(text)
        self.refused(self.folder / "in.vrt", "w.tif.ovr", "other files")


class UnitTest(RasterTest):
    def of_unit(self, unit, scale):
        path = self.write("unit.tif", self.height / scale)
        change(path, lambda r: r.GetRasterBand(1).SetUnitType(unit))
        return path

    def test_units_that_have_one_meaning_are_applied(self):
        for unit, scale in (("Metre", 1), ("METERS", 1), ("m.", 1), ("US survey foot", 1200 / 3937), ("cm", 0.01),
                            ("m a.s.l.", 1), ("ftUS", 1200 / 3937), ("foot_us", 1200 / 3937),
                            ("US Survey Feet", 1200 / 3937)):
            self.bake(self.of_unit(unit, scale))
            self.expect_heights(self.height, step=9)
        for unit in ("ft", "Feet", "fathom"):
            self.refused(self.of_unit(unit, 0.3048), "height_scale", unit)

    # Regression of 2026-11-25: gdalbuildvrt copies scale and offset, but no unit; feet were read as metres.
    def test_a_vrt_has_the_unit_of_its_sources(self):
        path = self.of_unit("US survey foot", 1200 / 3937)
        vrt = gdal.BuildVRT(str(self.folder / "mosaic.vrt"), [str(path)])
        vrt = None
        content = (self.folder / "mosaic.vrt").read_bytes()
        self.assertNotIn(b"UnitType", content)
        self.bake(self.folder / "mosaic.vrt")
        self.expect_heights(self.height, step=9)
        self.assertEqual((self.folder / "mosaic.vrt").read_bytes(), content)

    def test_the_unit_of_a_vertical_reference_system_is_applied(self):
        path = self.write("dem.tif", self.height / (1200 / 3937))
        scene = self.scene({"dem": "dem.tif", "crs": "EPSG:32632+6360", "geoid_offset_m": 0})
        self.assertEqual(self.plan(scene)["warnings"], [])
        self.bake(scene)
        self.expect_heights(self.height, step=9)
        change(path, lambda r: r.GetRasterBand(1).SetUnitType("ft"))
        self.bake(scene)
        self.expect_heights(self.height, step=9)

    # 2026-11-25: the unit of a third axis was not applied.
    def test_the_unit_of_a_third_axis_is_applied(self):
        for unit, scale in (("+vunits=us-ft", 1200 / 3937), ("+vto_meter=0.3048", 0.3048)):
            self.write("dem.tif", self.height / scale)
            scene = self.scene({"dem": "dem.tif", "crs": f"+proj=utm +zone=32 +datum=WGS84 +units=m {unit}"})
            self.assertEqual(self.bake(scene), "")
            self.expect_heights(self.height, step=9)
        self.write("local.tif", self.height, left=1000, top=2000, epsg=None)
        scene = self.scene({"dem": "local.tif", "crs": 'LOCAL_CS["site",UNIT["foot",0.3048]]'})
        self.assertIn("taken as metres", self.plan(scene, "--local")["warnings"][0])

    def test_other_bodies_and_local_systems_need_local(self):
        moon = "+proj=eqc +a=1737400 +b=1737400 +units=m +no_defs +type=crs"
        self.write("moon.tif", self.height, left=1000, top=2000, epsg=None)
        scene = self.scene({"dem": "moon.tif", "crs": moon})
        self.refused(scene, "another body", "--local")
        self.refused(self.folder / "moon.tif", "no coordinate system", "--local")
        local = 'LOCAL_CS["site",UNIT["metre",1]]'
        counts = set()
        for crs in (moon, local, None):
            entry = {"dem": "moon.tif", **({"crs": crs} if crs else {})}
            self.bake(self.scene(entry), 1, "--local")
            counts.add(self.program.info(self.folder / "out")["lods"][0]["voxels"])
        self.assertLess(max(counts) - min(counts), 0.1 * max(counts))

    def test_corners_beside_the_earth_are_no_reason_to_refuse(self):
        rows, columns = numpy.mgrid[0:120, 0:120]
        on_earth = (columns - 59.5) ** 2 + (rows - 59.5) ** 2 < 57 ** 2
        pixel = 2 * 6378137 / 120
        self.write("globe.tif", numpy.where(on_earth, 100, -9999), left=-6378137, top=6378137, pixel=pixel, epsg=None,
                   nodata=-9999)
        globe = self.scene({"dem": "globe.tif", "crs": "+proj=ortho +lat_0=40 +lon_0=10 +datum=WGS84 +type=crs"})
        result = self.program.succeed("plan", globe, "--voxel-size", 20000, "--no-measure")
        self.assertIn("triangles", result)

    # 2026-11-25: corners that hold zeros refused their tiles.
    def test_heights_beside_the_earth_are_holes(self):
        rows, columns = numpy.mgrid[0:180, 0:360]
        on_earth = ((columns - 179.5) / 180) ** 2 + ((rows - 89.5) / 90) ** 2 < 0.97
        pixel = 18040095.7 / 180
        self.write("globe.tif", numpy.where(on_earth, 100, 1), left=-180 * pixel, top=90 * pixel, pixel=pixel,
                   epsg=None)
        globe = self.scene({"dem": "globe.tif", "crs": "+proj=moll +datum=WGS84", "tile_cells": 16})
        messages = self.bake(globe, 40000)
        self.assertIn("not on the earth in its coordinate system (unknown), taken as holes", messages)

    def test_ascii_and_hgt_are_sources_and_others_name_the_command(self):
        path = self.write("dem.tif", self.height)
        translate(path, self.folder / "dem.asc", "-of AAIGrid")
        self.bake(self.folder / "dem.asc")
        self.expect_heights(self.height)
        heights = numpy.broadcast_to(numpy.arange(1201, dtype=">i2"), (1201, 1201))
        (self.folder / "N46E008.hgt").write_bytes(heights.tobytes())
        self.program.succeed("plan", self.folder / "N46E008.hgt", "--voxel-size", 100, "--no-measure")
        for name in ("dem.img", "dem.bil", "dem.jp2"):
            (self.folder / name).write_bytes(b"something")
            self.refused(self.folder / name, "gdal_translate IN OUT.tif")


if __name__ == "__main__":
    RasterTest.program = harness.Gigabake(sys.argv[1])
    harness.skip_without(RasterTest.program, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
