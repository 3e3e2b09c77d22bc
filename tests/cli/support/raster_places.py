"""Rasters of UTM zone 32 north, and what a bake of them has at their pixels."""
import csv
import ctypes
import io
import json
import os
import shutil
import struct
import subprocess

import numpy

import harness
from gdal_there import coordinate_system, gdal, osr, write_raster

LEFT, TOP, PIXEL = 500000, 5400000, 2


def lon_lat(x, y, epsg=32632):
    source, target = coordinate_system(f"EPSG:{epsg}"), coordinate_system("EPSG:4326")
    lon, lat, _ = osr.CoordinateTransformation(source, target).TransformPoint(x, y)
    return lon, lat


class RasterTest(harness.FolderTest):
    """Tests of a hill of 40 × 40 pixels, without values in `void`."""

    program = None
    void = (slice(10, 16), slice(20, 28))

    def setUp(self):
        self.folder = self.root / self.id().rsplit(".", 1)[-1]
        self.folder.mkdir()
        rows, columns = numpy.mgrid[0:40, 0:40]
        self.height = (100 + 0.4 * columns + 0.2 * rows).astype("f4")
        self.valid = numpy.ones(self.height.shape, bool)
        self.valid[self.void] = False

    def write(self, name, values, left=LEFT, top=TOP, pixel=PIXEL, **options):
        write_raster(self.folder / name, values, left, top, pixel, **{"epsg": 32632, **options})
        return self.folder / name

    def scene(self, *entries, name="scene.json"):
        (self.folder / name).write_text(json.dumps({"gigabake": 1, "sources": list(entries)}))
        return self.folder / name

    def bake(self, source, voxel_size=1, *arguments, code=0):
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        result = self.program.run("bake", source, "-o", self.folder / "out", "--voxel-size", voxel_size, "-q",
                                  *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        return result.stderr

    def plan(self, source, *arguments):
        result = self.program.run("plan", source, "--voxel-size", 2, "--no-measure", "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def refused(self, source, *words, arguments=()):
        result = self.program.run("plan", source, "--voxel-size", 2, "--no-measure", *arguments)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        for word in words:
            self.assertIn(word, result.stderr.strip().splitlines()[-1])

    def at(self, *places, pixel=PIXEL, left=LEFT, top=TOP):
        """Returns the answers at (column, row) of pixel centres, also between them."""
        table = self.folder / "places.csv"
        rows = [lon_lat(left + (c + 0.5) * pixel, top - (r + 0.5) * pixel) for c, r in places]
        table.write_text("lon,lat\n" + "".join(f"{lon:.10f},{lat:.10f}\n" for lon, lat in rows))
        text = self.program.succeed("query", self.folder / "out", "--coordinates", "lonlat", "--heights", table)
        return list(csv.DictReader(io.StringIO(text)))

    def expect_heights(self, heights, step=5, tolerance=1):
        """Compares heights at pixels. heights: the raster's pixels; NaN: no surface is expected."""
        inner = [(c, r) for r in range(2, heights.shape[0] - 2, step) for c in range(2, heights.shape[1] - 2, step)]
        near = {(c, r): heights[r - 1:r + 2, c - 1:c + 2] for c, r in inner}
        sure = [p for p in inner if numpy.isnan(near[p]).all() or not numpy.isnan(near[p]).any()]
        self.assertGreater(len(sure), 4)
        for (c, r), answer in zip(sure, self.at(*sure)):
            where = f"column {c}, row {r}"
            if numpy.isnan(heights[r, c]):
                self.assertEqual(answer["outcome"], "nothing hit", where)
            else:
                self.assertEqual(answer["outcome"], "hit", where)
                self.assertAlmostEqual(float(answer["height"]), heights[r, c], delta=tolerance, msg=where)

    def colours(self, *places, **options):
        return [[int(row[c]) for c in ("red", "green", "blue")] for row in self.at(*places, **options)]


def translate(source, target, *options, **keys):
    gdal.Translate(str(target), str(source), options=" ".join(options), **keys)


def reads_of(program, *arguments):
    """Returns the number of bytes that a command and its ended children read: the kernel adds up their counts."""
    shell = '"$@" >/dev/null 2>&1; code=$?; cat /proc/$$/io; exit $code'
    result = subprocess.run(["sh", "-c", shell, "sh", str(program.executable), *map(str, arguments)],
                            capture_output=True, text=True, timeout=100, check=True)
    return int(result.stdout.split("rchar: ")[1].split()[0])


def opens_of(program, file, *arguments):
    """Returns the number of times that a command or its children open a file."""
    libc = ctypes.CDLL(None, use_errno=True)
    descriptor = libc.inotify_init1(os.O_NONBLOCK)
    is_opened = 0x20
    libc.inotify_add_watch(descriptor, str(file).encode(), is_opened)
    try:
        program.succeed(*arguments)
        events = 0
        while True:
            try:
                data = os.read(descriptor, 65536)
            except BlockingIOError:
                return events
            while data:
                name_bytes = struct.unpack_from("iIII", data)[3]
                data = data[16 + name_bytes:]
                events += 1
    finally:
        os.close(descriptor)
