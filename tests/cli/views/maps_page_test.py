#!/usr/bin/env python3
"""Runs every command of docs/maps.md in the order of the page, and opens what the commands write with GDAL.

Usage: maps_page_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import re
import shlex
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import gdal, write_raster

# The sample lies at 46.9312° N, 8.3017° E: the page's coordinates are around it, in degrees and in EPSG:25832.
LEFT_M, TOP_M, PIXEL_M, PIXELS = 446780, 5197815, 2, 60
DISTRICT = [(8.30150, 46.93105), (8.30185, 46.93105), (8.30185, 46.93135), (8.30150, 46.93135), (8.30150, 46.93105)]
LINE = [(8.30155, 46.9311), (8.3018, 46.9313)]


def write_geojson(path, kind, coordinates):
    path.write_text(json.dumps({"type": "Feature", "properties": {},
                                "geometry": {"type": kind, "coordinates": coordinates}}), encoding="utf-8")


def commands(source):
    """Returns the commands of the page's blocks, and of its text."""
    text = (source / "docs/maps.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```\w*\n(.*?)^```", text, re.M | re.S)
    lines = [line for block in blocks for line in block.splitlines() if line.startswith("gigabake ")]
    return lines + re.findall(r"`(gigabake [^`]*SCENE [^`]*)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))


class MapsPage(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        program = harness.Gigabake(sys.argv[1])
        program.succeed("sample", cls.root, "--size", 96, "--seed", 7)
        write_geojson(cls.root / "district.geojson", "Polygon", [DISTRICT])
        write_geojson(cls.root / "line.geojson", "LineString", LINE)
        x, y = numpy.meshgrid(numpy.arange(PIXELS), numpy.arange(PIXELS))
        cls.heights_m = (562 + 3 * numpy.sin(x / 9) + 2 * numpy.cos(y / 7)).astype("float32")
        write_raster(cls.root / "dem.tif", cls.heights_m, LEFT_M, TOP_M, PIXEL_M, 25832)
        photo = [(x * 4 % 256).astype("uint8"), (y * 4 % 256).astype("uint8"), (x + y).astype("uint8")]
        write_raster(cls.root / "photo.tif", photo, LEFT_M, TOP_M, PIXEL_M, 25832, kind=gdal.GDT_Byte)
        cls.printed = {}
        executable = Path(program.executable).resolve()
        for line in commands(Path(sys.argv[2])):
            result = harness.run([executable, *shlex.split(line)[1:]], 600, cwd=cls.root,
                                 env={**os.environ, **harness.MPI_ENVIRONMENT})
            assert result.returncode == 0, f"{line}\n{result.stdout}\n{result.stderr}"
            cls.printed[line] = result.stdout

    def answer(self, *words):
        """Returns what the only command with these words printed."""
        found = [text for line, text in self.printed.items() if all(word in line for word in words)]
        self.assertEqual(len(found), 1, words)
        return found[0]

    def test_the_page_has_commands_of_each_kind(self):
        for name in "plan", "bake", "export", "query", "render":
            self.assertTrue(any(line.startswith(f"gigabake {name} ") for line in self.printed), name)

    def test_a_question_answers_the_height_of_the_raster(self):
        header, row = self.answer("query", "--at").splitlines()
        height = float(row.split(",")[header.split(",").index("z" if ",z," in header else "height")])
        column, line = (446840 - LEFT_M) / PIXEL_M - .5, (TOP_M - 5197755) / PIXEL_M - .5
        expected = self.heights_m[int(line):int(line) + 2, int(column):int(column) + 2].mean()
        self.assertAlmostEqual(height, expected, delta=0.5)

    def test_gdal_opens_each_raster(self):
        rasters = [shlex.split(line) for line in self.printed if "--to dsm" in line or "--to ortho" in line]
        self.assertGreater(len(rasters), 2)
        for words in rasters:
            raster = gdal.Open(str(self.root / words[words.index("-o") + 1]))
            self.assertIn("25832" if "--crs" in words else "32632", raster.GetProjection(), words)
            values = raster.GetRasterBand(1).ReadAsArray()
            self.assertGreater(numpy.nanmax(values) - numpy.nanmin(values).astype(float), 0, words)

    def test_volumes_name_cut_and_fill(self):
        text = self.answer("--volume")
        self.assertIn("cut", text)
        self.assertIn("fill", text)


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
