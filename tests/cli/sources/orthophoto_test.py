#!/usr/bin/env python3
"""Tests orthophotos as surveying and GIS tools write them: bands, palettes, types, nodata, resolution, places.

Usage: orthophoto_test.py GIGABAKE SOURCE_DIR
"""
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal
from raster_places import LEFT, PIXEL, TOP, RasterTest, lon_lat, translate

COLOURS = {(8, 8): (200, 30, 20), (31, 8): (20, 180, 40), (8, 31): (30, 40, 210), (31, 31): (240, 240, 240)}
GREY = [127, 127, 127]


class OrthophotoTest(RasterTest):
    """Tests with four quarters of 80 × 80 pixels, each of one colour."""

    def setUp(self):
        super().setUp()
        self.write("dem.tif", self.height)
        self.index = numpy.kron(numpy.array([[1, 2], [3, 4]], "u1"), numpy.ones((40, 40), "u1"))
        self.rgb = numpy.array([(0, 0, 0), *COLOURS.values()], "u1")[self.index].transpose(2, 0, 1)

    def photo(self, bands, kind=gdal.GDT_Byte, name="photo.tif", **options):
        return self.write(name, bands, pixel=1, kind=kind, **options)

    def change(self, work, name="photo.tif"):
        raster = gdal.Open(str(self.folder / name), gdal.GA_Update)
        work(raster)
        raster = None

    def interpret(self, *interpretations):
        def work(raster):
            for band, interpretation in enumerate(interpretations, 1):
                raster.GetRasterBand(band).SetColorInterpretation(interpretation)
        self.change(work)

    def expect(self, changed=None, name="photo.tif", messages="", **entry):
        """Bakes and compares colours. changed: colours of quarters that differ from COLOURS."""
        said = self.bake(self.scene({"dem": "dem.tif", "ortho": name, **entry}))
        expected = [list(c) for c in {**COLOURS, **(changed or {})}.values()]
        self.assertEqual(self.colours(*COLOURS), expected)
        if messages:
            self.assertIn(messages, said)
        else:
            self.assertNotIn("warning", said)

    def refuse(self, *words, name="photo.tif"):
        self.refused(self.scene({"dem": "dem.tif", "ortho": name}), *words)

    # Regression of 2026-11-25: bands were used by number: infrared as opacity, palette indices as grey.
    def test_bands_are_taken_by_their_interpretation(self):
        infrared = numpy.array([0, 0, 255, 40, 128], "u1")[self.index]
        red, green, blue, undefined = gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_Undefined
        self.photo([*self.rgb, infrared])
        self.interpret(red, green, blue, undefined)
        self.expect(messages="not used: 4")
        self.photo([*self.rgb[::-1]])
        self.interpret(blue, green, red)
        self.expect()
        self.photo([infrared, *self.rgb])
        self.interpret(undefined, red, green, blue)
        self.expect(messages="not used: 1")
        self.photo([*self.rgb, infrared * 0 + 255])
        self.interpret(red, green, blue, gdal.GCI_AlphaBand)
        self.expect()

    # 2026-11-25: a band that states its colour was taken by its number if another did not state its own.
    def test_bands_that_state_their_colour_keep_it(self):
        red, green, blue, undefined = gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_Undefined
        r, g, b = self.rgb
        for bands, interpretations in (([g, r, b], (green, red, undefined)), ([b, g, r], (blue, undefined, red))):
            self.photo(bands)
            self.interpret(*interpretations)
            if interpretations[0] == green:
                self.expect(messages="taken as bands 2 (Red), 1 (Green), 3 (Undefined)")
            else:
                self.expect(messages="taken as bands 3 (Red), 2 (Undefined), 1 (Blue)")

    # 2026-11-25: an alpha band of 0 and 1, or of 0 and 255 in 16 bits, made the image invisible without a message.
    def test_alpha_bands_of_masks_are_opaque(self):
        bands = (gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_AlphaBand)
        valid = self.index != 3
        for scale, kind, greatest in ((1, gdal.GDT_Byte, 1), (1, gdal.GDT_Byte, 255), (257, gdal.GDT_UInt16, 1),
                                      (257, gdal.GDT_UInt16, 255), (257, gdal.GDT_UInt16, 65535)):
            self.photo([*(self.rgb.astype("u2") * scale), valid * greatest], kind)
            self.interpret(*bands)
            self.expect({(8, 31): GREY})

    def test_black_and_white_in_other_encodings(self):
        bits, white, black = (self.index % 2).astype("u1"), (255, 255, 255), (0, 0, 0)
        usual, inverted = (white, black, white, black), (black, white, black, white)
        for options, expected in (("-co COMPRESS=CCITTFAX4", usual), ("-co PHOTOMETRIC=MINISWHITE", inverted),
                                  ("-a_nodata 0", (white, GREY, white, GREY))):
            self.photo(bits)
            translate(self.folder / "photo.tif", self.folder / "bits.tif", "-co NBITS=1 " + options)
            self.expect(dict(zip(COLOURS, map(tuple, expected))), name="bits.tif")
        self.photo(self.rgb[0])
        translate(self.folder / "photo.tif", self.folder / "grey.tif", "-co PHOTOMETRIC=MINISWHITE")
        self.expect({place: (255 - c[0],) * 3 for place, c in COLOURS.items()}, name="grey.tif")

    def test_two_bands_without_an_alpha_are_grey_and_one_more(self):
        grey = numpy.array([0, 50, 100, 150, 200], "u1")[self.index]
        expected = {place: (v, v, v) for place, v in zip(COLOURS, (50, 100, 150, 200))}
        self.photo([grey, grey * 0])
        self.interpret(gdal.GCI_GrayIndex, gdal.GCI_Undefined)
        self.expect(expected, messages="not used: 2")
        self.photo(grey)
        self.expect(expected)

    def test_palettes(self):
        def colour(raster, alpha_of_blue=255):
            table = gdal.ColorTable()
            for i, c in enumerate(COLOURS.values(), 1):
                table.SetColorEntry(i, (*c, alpha_of_blue if i == 3 else 255))
            raster.GetRasterBand(1).SetColorTable(table)
        self.photo(self.index)
        self.change(colour)
        self.expect()
        translate(self.folder / "photo.tif", self.folder / "photo.png", "-of PNG -co WORLDFILE=YES")
        self.expect(name="photo.png")
        self.photo(self.index, nodata=3)
        self.change(colour)
        self.expect({(8, 31): GREY})
        bits = (self.index % 2).astype("u1")
        self.photo(bits)
        translate(self.folder / "photo.tif", self.folder / "bits.tif", "-co NBITS=1")
        white, black = (255, 255, 255), (0, 0, 0)
        self.expect(dict(zip(COLOURS, (white, black, white, black))), name="bits.tif")

    def test_16_bits_use_their_whole_range_or_that_of_nbits(self):
        self.photo(self.rgb.astype("u2") * 257, gdal.GDT_UInt16)
        self.interpret(gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand)
        self.expect()
        self.photo(numpy.round(self.rgb * (4095 / 255)).astype("u2"), gdal.GDT_UInt16, name="raw.tif")
        self.refuse("reach only", "gdal_translate -ot Byte -scale", name="raw.tif")
        translate(self.folder / "raw.tif", self.folder / "photo.tif", "-co NBITS=12 -colorinterp red,green,blue")
        self.expect()

    def test_numbers_without_a_range_of_colours_name_the_command(self):
        for kind in (gdal.GDT_Float32, gdal.GDT_Int16, gdal.GDT_UInt32):
            self.photo(self.rgb, kind)
            self.refuse(gdal.GetDataTypeName(kind), "gdal_translate -ot Byte -scale")
        self.photo([*self.rgb, self.rgb[0]])
        self.interpret(gdal.GCI_CyanBand, gdal.GCI_MagentaBand, gdal.GCI_YellowBand, gdal.GCI_BlackBand)
        self.refuse("not red, green and blue")

    # Regression of 2026-11-25: a nodata border was black.
    def test_pixels_without_a_value_are_grey(self):
        self.rgb[:, self.index == 3] = 0
        self.photo(self.rgb, nodata=0)
        self.expect({(8, 31): GREY})
        self.rgb[0, self.index == 1] = 0  # a single 0 component is no nodata
        self.photo(self.rgb, nodata=0)
        self.expect({(8, 31): GREY, (8, 8): (0, 30, 20)})
        self.rgb[0, self.index == 1] = 200
        self.photo(self.rgb, name="plain.tif")
        translate(self.folder / "plain.tif", self.folder / "aux.tif", "-co PROFILE=GeoTIFF -a_nodata 0")
        self.assertTrue((self.folder / "aux.tif.aux.xml").exists())
        self.expect({(8, 31): GREY}, name="aux.tif")
        gdal.Warp(str(self.folder / "photo.tif"), str(self.folder / "plain.tif"), options="-srcnodata 0 -dstalpha")
        self.expect({(8, 31): GREY})
        raster = gdal.Open(str(self.folder / "plain.tif"))
        raster.CreateMaskBand(gdal.GMF_PER_DATASET)
        raster.GetRasterBand(1).GetMaskBand().WriteArray((self.index != 3).astype("u1") * 255)
        raster = None
        self.assertTrue((self.folder / "plain.tif.msk").exists())
        self.expect({(8, 31): GREY}, name="plain.tif")

    def test_an_orthophoto_that_covers_nothing_is_named(self):
        self.photo(self.rgb, left=LEFT + 1e5)
        [warning] = self.plan(self.scene({"dem": "dem.tif", "ortho": "photo.tif"}))["warnings"]
        self.assertIn("'photo.tif' covers nothing", warning)
        self.photo(self.rgb * 0, nodata=0)
        [warning] = self.plan(self.scene({"dem": "dem.tif", "ortho": "photo.tif"}))["warnings"]
        self.assertIn("transparent", warning)

    def test_an_orthophoto_has_a_coordinate_system_of_its_own(self):
        lon, lat = lon_lat(LEFT, TOP)
        step = (lon_lat(LEFT + 80, TOP)[0] - lon) / 40
        self.write("dem.tif", self.height, left=lon, top=lat, pixel=step, epsg=4326)
        self.photo(self.rgb, epsg=None)
        [warning] = self.plan(self.scene({"dem": "dem.tif", "ortho": "photo.tif"}))["warnings"]
        self.assertIn("ortho_crs", warning)
        self.bake(self.scene({"dem": "dem.tif", "ortho": "photo.tif", "ortho_crs": "EPSG:32632"}))
        self.assertEqual(self.colours((8, 8), (31, 8)), [list(c) for c in list(COLOURS.values())[:2]])
        self.refused(self.scene({"dem": "dem.tif", "ortho": "photo.tif", "ortho_crs": "EPSG:x"}), "ortho_crs")

    # Regression of 2026-11-25: only 32 texels per raster pixel were kept, so stripes of 2 m became grey.
    def test_an_orthophoto_keeps_its_resolution(self):
        self.write("coarse.tif", self.height[:6, :6], pixel=90)
        stripes = numpy.zeros((3, 1080, 1080), "u1")
        stripes[:, :, (numpy.arange(1080) // 4) % 2 == 1] = 255
        self.write("stripes.tif", stripes, pixel=0.5, kind=gdal.GDT_Byte)
        scene = self.scene({"dem": "coarse.tif", "ortho": "stripes.tif"})
        plan = self.program.succeed("plan", scene, "--voxel-size", 0.5)
        self.assertIn("texels of the textures are about 0.5 m", plan)
        self.bake(scene, 0.5)
        places = [(100.75 + 2 * i, 200) for i in range(10)]  # the middle of stripes, in metres
        colours = self.colours(*places, pixel=1)
        self.assertEqual([c[0] > 127 for c in colours], [i % 2 == 1 for i in range(10)])
        self.assertEqual({min(c[0], 255 - c[0]) < 20 for c in colours}, {True})

    # Regression of 2026-11-26: a file of 286 bytes with pixels of 1e-300 m took minutes, because each tile got an image
    # of 4096 × 4096 texels.
    def test_pixels_that_are_too_small_to_be_meant_are_refused(self):
        for pixel, words in ((1e-300, "would be 0 m wide"), (1e-5, "e-05 m wide")):
            self.write("photo.tif", self.rgb[:, :2, :2], pixel=pixel, kind=gdal.GDT_Byte)
            self.refuse("photo.tif", "ortho_crs", words, "less than 0.0001 m", "coordinate system", "geotransform")
        self.write("small.tif", self.height[:3, :3])
        self.write("photo.tif", self.rgb[:, :2, :2], pixel=0.001, kind=gdal.GDT_Byte)
        self.plan(self.scene({"dem": "small.tif", "ortho": "photo.tif"}))

    def test_the_image_of_a_tile_counts_as_memory(self):
        self.write("coarse.tif", self.height[:6, :6], pixel=900)
        self.write("fine.tif", numpy.zeros((3, 8, 8), "u1"), pixel=1, kind=gdal.GDT_Byte)
        scene = self.scene({"dem": "coarse.tif", "ortho": "fine.tif"})
        self.refused(scene, "fine.tif", "tile's image", arguments=("--memory", "64M"))
        self.plan(scene)


if __name__ == "__main__":
    RasterTest.program = harness.Gigabake(sys.argv[1])
    harness.skip_without(RasterTest.program, "GDAL", "probe.tif")
    harness.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
