#!/usr/bin/env python3
"""Sizes that files claim are bounded by --memory. If memory runs out nevertheless, the program reports it and exits.

Usage: memory_limit_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import resource
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "fuzz"))
import made_seeds as made

MEGABYTE = 1 << 20


# First column and row of each pass of an interlaced PNG, and the distances of its texels.
ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))


def png_of_one_colour(edge, is_interlaced):
    """Returns a PNG with one bit per texel: a few kilobytes at any size."""
    size = 0
    for x, y, columns, rows in ADAM7 if is_interlaced else ((0, 0, 1, 1),):
        width, height = -(-(edge - x) // columns), -(-(edge - y) // rows)
        size += ((width + 7) // 8 + 1) * height
    return made.png_of_rows(edge, 1, 0, zlib.compress(b"\0" * size, 9), int(is_interlaced))


def write_square(path, document):
    """Writes a GLB whose buffer is its binary chunk."""
    document["buffers"] = [{"byteLength": 60}]
    harness.write_glb_document(path, document, made.POSITIONS + made.INDICES)


# Regressions of 2026-11-22, found by attacks on 0.1.0.
class MemoryLimitTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def run_limited(self, max_bytes, *command):
        """Returns exit code, lines of errors, and the maximum memory of the processes."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (max_bytes, max_bytes))
        with subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                              env={**os.environ, **harness.MPI_ENVIRONMENT}, preexec_fn=limit) as process:
            errors = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        for word in ("terminate called", "bad_alloc", "exception"):
            self.assertNotIn(word, errors)
        for line in errors.splitlines():
            self.assertLessEqual(len(line), 300)
        return process.returncode, errors, usage.ru_maxrss << 10

    def bake(self, source, memory_mb):
        """Bakes within the memory limit, with any result."""
        code, errors, held = self.run_limited(8 << 30, PROGRAM.executable, "bake", source, "-o", self.root / "out",
                                              "--voxel-size", 0.1, "--memory", f"{memory_mb}M", "--threads", 2)
        self.assertLess(held, (memory_mb + 200) * MEGABYTE)
        return code, errors

    def refuse(self, source, memory_mb, *words):
        code, errors = self.bake(source, memory_mb)
        self.assertIn(code, (1, 3), errors)
        for word in ("--memory allows", "raise it", *words):
            self.assertIn(word, errors)

    def write_square_with_image_of_a_gigabyte(self, is_interlaced):
        (self.root / "p.png").write_bytes(png_of_one_colour(12000, is_interlaced))
        self.assertLess((self.root / "p.png").stat().st_size, 100_000)
        document = made.square(images=[{"uri": "p.png"}], textures=[{"source": 0}],
                               materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])
        document["meshes"][0]["primitives"][0]["material"] = 0
        document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2
        document["accessors"].append({"componentType": 5126, "count": 4, "type": "VEC2"})
        write_square(self.root / "a.glb", document)

    # Regression of 2026-11-22: a PNG of 800 KB took 1.7 GB.
    def test_an_image_that_decodes_to_a_gigabyte(self):
        self.write_square_with_image_of_a_gigabyte(is_interlaced=True)
        self.refuse(self.root / "a.glb", 512, "texels")

    # Regression of 2026-11-23: it was refused. Now its rows are decoded one by one, and the pyramid is on scratch.
    def test_an_image_that_decodes_to_a_gigabyte_in_rows(self):
        self.write_square_with_image_of_a_gigabyte(is_interlaced=False)
        code, errors = self.bake(self.root / "a.glb", 512)
        self.assertEqual(code, 0, errors)

    # Regression of 2026-11-22: 844 bytes of instances took more than 5.6 GB.
    def test_instances_from_nowhere(self):
        document = made.square(nodes=[{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {
            "TRANSLATION": 2}}}}])
        document["accessors"].append({"componentType": 5126, "count": 1 << 24, "type": "VEC3"})
        write_square(self.root / "a.glb", document)
        self.refuse(self.root / "a.glb", 512, "placements")

    # Regression of 2026-11-22: a grid of 98 bytes occupied the program for a minute without a message.
    def test_a_grid_that_is_not_there(self):
        head = "ncols 100000\nnrows 100000\nxllcorner 8\nyllcorner 46\ncellsize 0.00001\n"
        (self.root / "d.asc").write_text(head + "1 2\n")
        source = self.root / "s.json"
        source.write_text(json.dumps({"gigabake": 1, "sources": [{"dem": "d.asc", "crs": "EPSG:4326"}]}))
        result = PROGRAM.run("plan", source, "--voxel-size", 1)
        if "built without GDAL" in result.stderr:
            self.skipTest("built without GDAL")
        self.assertEqual(result.returncode, 1)
        self.assertIn("can hold", result.stderr)

    def json_of_lists(self):
        source = self.root / "t.json"
        source.write_text('{"asset":{"version":"1.0"},"root":{},"extras":[' + "[]," * 12_000_000 + "0]}")
        return source

    # Regression of 2026-11-22: a tileset of 256 MB took 2.6 GB.
    def test_json_that_takes_more_than_is_allowed(self):
        code, errors, held = self.run_limited(8 << 30, PROGRAM.executable, "plan", self.json_of_lists(),
                                              "--voxel-size", 1, "--memory", "256M")
        self.assertEqual(code, 1)
        self.assertIn("--memory allows", errors)
        self.assertLess(held, 600 * MEGABYTE)

    # Regression of 2026-11-22: the program aborted, rank 0 too.
    def test_json_where_memory_ends(self):
        """Regression: a destructor of nlohmann::json allocates memory, so the program ended in std::terminate."""
        command = [PROGRAM.executable, "plan", self.json_of_lists(), "--voxel-size", 1, "--memory", 0]
        for start in ([], ["mpirun", "-n", 2]):
            code, errors, _ = self.run_limited(1 << 30, *start, *command)
            self.assertEqual(code, 1, errors)
            self.assertIn("not enough memory", errors)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:], verbosity=2)
