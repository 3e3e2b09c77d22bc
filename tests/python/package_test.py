#!/usr/bin/env python3
"""The Python package agrees with the program's sources: version, versions of the formats; and its types are consistent.

Usage: package_test.py GIGABAKE SOURCE_DIR
"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from package_imports import gigabake, numpy
from gigabake import bricks, columns, scene_xml, shard

SOURCE = Path(sys.argv[2]).resolve()


def number_in(file, pattern):
    return int(re.search(pattern, (SOURCE / file).read_text(encoding="utf-8")).group(1))


class Package(unittest.TestCase):
    def test_versions_of_the_formats_are_those_of_the_program(self):
        layout = "format/shard/shard_layout.h"
        self.assertEqual(shard.NEWEST_SHARD_VERSION, number_in(layout, r" shard_version = (\d+);"))
        self.assertEqual(shard.OLDEST_SHARD_VERSION, number_in(layout, r"oldest_shard_version = (\d+);"))
        newest = max(int(found) for path in (SOURCE / "format/scene/xml").glob("*.h")
                     for found in re.findall(r"newest_scene_version = (\d+);", path.read_text(encoding="utf-8")))
        self.assertEqual(scene_xml.NEWEST_SCENE_VERSION, newest)

    @unittest.skipIf(shutil.which("mypy") is None, "mypy is not installed")
    def test_types_are_consistent(self):
        with tempfile.TemporaryDirectory() as cache:
            result = subprocess.run(["mypy", "--config-file", SOURCE / "python/pyproject.toml", "--cache-dir", cache,
                                     SOURCE / "python/gigabake"], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_modules_need_only_the_dependencies_that_pyproject_states(self):
        text = "".join(path.read_text(encoding="utf-8") for path in (SOURCE / "python/gigabake").glob("*.py"))
        imported = set(re.findall(r"^ *(?:import|from) ([a-z]\w*)", text, re.M)) - set(sys.stdlib_module_names)
        project = (SOURCE / "python/pyproject.toml").read_text(encoding="utf-8")
        stated = re.search(r"^dependencies = \[(.*)\]", project, re.M).group(1)
        self.assertEqual(imported, set(re.findall(r'"(\w+)>', stated)))

    def test_fletcher32_is_that_of_hdf5(self):
        self.assertEqual(columns.fletcher32(b""), 0)
        self.assertEqual(columns.fletcher32(b"\xff\xff" * 5), 0xFFFFFFFF)
        data = numpy.random.default_rng(1).integers(0, 256, 1_000_001, numpy.uint8).tobytes()
        each = running = 0
        for at in range(0, len(data), 2):
            each += int.from_bytes(data[at:at + 2].ljust(2, b"\0"), "big")
            running += each
        self.assertEqual(columns.fletcher32(data), (running % 65535 or 65535) << 16 | (each % 65535 or 65535))

    def test_followers_are_the_later_voxels_of_a_cube(self):
        random = numpy.random.default_rng(2)
        exists = random.random((50, 512)) < numpy.linspace(0, 1, 50)[:, None]
        masks = bricks.words_of(exists.view(numpy.uint8))
        place = numpy.arange(512)
        for edge in (2, 4, 8):
            cube = (place & 7) // edge + 8 * ((place >> 3 & 7) // edge) + 64 * ((place >> 6) // edge)
            expected = numpy.zeros_like(exists)
            for of_cube in numpy.unique(cube):
                places = numpy.flatnonzero(cube == of_cube)
                earlier = numpy.cumsum(exists[:, places], axis=1) - exists[:, places]
                expected[:, places] = earlier > 0
            found = bricks.unpacked(bricks.followers(masks, edge))
            numpy.testing.assert_array_equal(found, expected)

    def test_a_missing_program_and_a_failed_command_are_errors(self):
        with self.assertRaisesRegex(gigabake.GigabakeError, "no-such-program: is not an executable"):
            gigabake.plan("x.glb", 1, program="no-such-program")
        with self.assertRaises(gigabake.GigabakeError) as caught:
            gigabake.plan("no-such-file.glb", 1, program=sys.argv[1])
        self.assertEqual((str(caught.exception.file), caught.exception.key), ("no-such-file.glb", "gigabake plan"))
        self.assertIn("no-such-file.glb", caught.exception.cause)
        with self.assertRaisesRegex(ValueError, "expected one of rays, heights and sights"):
            gigabake.query("SCENE", rays=[[0] * 6], heights=[[0, 0]])
        with self.assertRaisesRegex(ValueError, "expected one of above_m and against"):
            gigabake.volume("SCENE", "area.geojson")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
