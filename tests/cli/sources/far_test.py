#!/usr/bin/env python3
"""A distant vertex or too small voxels cause one message per source before cells are baked.

All other parts of the scene are baked. Regression of 2026-11-22: a million cells failed, three times each, with 27 MB
of log.

Usage: far_test.py GIGABAKE SOURCE_DIR
"""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

VOXEL_M = 0.1
EDGE = 20  # vertices


def ground(far=None):
    """Returns positions and indices of a rough square. far: a position for a vertex in the middle, or None."""
    positions = [[x, 0.3 * ((7 * x + 3 * z) % 5), -z] for z in range(EDGE) for x in range(EDGE)]
    indices = []
    for z in range(EDGE - 1):
        for x in range(EDGE - 1):
            a = z * EDGE + x
            indices += [[a, a + 1, a + EDGE], [a + 1, a + EDGE + 1, a + EDGE]]
    if far is not None:
        positions[EDGE * EDGE // 2 + 3] = far
    return positions, indices


class Far(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.out = self.root / "out"

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, far=None, without_triangles_of=None):
        positions, indices = ground(far)
        if without_triangles_of is not None:
            indices = [t for t in indices if without_triangles_of not in t]
        harness.write_glb(self.root / name, positions, indices)
        return self.root / name

    def bake(self, source, voxel_size=VOXEL_M, out=None):
        result = PROGRAM.run("bake", source, "-o", out or self.out, "--voxel-size", voxel_size, "--threads", 1,
                             timeout=60)
        self.assertLess(len(result.stderr) + len(result.stdout), 4096, "a short log")
        for line in result.stderr.splitlines():
            self.assertLessEqual(len(line), 300)
        return result

    def test_one_far_vertex_costs_its_triangles_alone_and_is_said_once(self):
        vertex = EDGE * EDGE // 2 + 3
        rest = self.write("rest.glb", without_triangles_of=vertex)
        self.assertEqual(self.bake(rest, out=self.root / "expected").returncode, 0)
        expected = harness.lod_hashes(PROGRAM.info(self.root / "expected/scene.xml"))
        for far in ([1e6, 0, 0], [0, -3e8, 0], [1e9, 1e9, 1e9], [0, 0, 1e30]):
            with self.subTest(far=far):
                source = self.write("far.glb", far=far)
                plan = PROGRAM.run("plan", source, "--voxel-size", VOXEL_M, timeout=60)
                result = self.bake(source)
                for said in (plan, result):
                    self.assertEqual(said.returncode, 3, said.stderr)
                    self.assertEqual(said.stderr.count("6 triangles of tile far.glb: up to"), 1, said.stderr)
                    self.assertIn("set --voxel-size", said.stderr)
                    self.assertNotIn("tried", said.stderr)
                self.assertRegex(plan.stdout, r"^\d cells?")
                self.assertEqual(harness.lod_hashes(PROGRAM.info(self.out / "scene.xml")), expected)
                verify = PROGRAM.run("verify", self.out / "scene.xml")
                self.assertEqual(verify.returncode, 3, verify)
                self.assertIn("sound, but incomplete: 1 input is missing", verify.stdout)

    def test_where_a_triangle_that_is_left_out_lies_does_not_depend_on_the_cut_into_cells(self):
        source = self.write("far.glb", far=[1e6, 0, 0])
        self.assertEqual(self.bake(source).returncode, 3)
        whole = harness.lod_hashes(PROGRAM.info(self.out / "scene.xml"), 3)
        PROGRAM.run("bake", source, "-o", self.root / "small", "--voxel-size", VOXEL_M, "--cell-voxels", 32)
        self.assertEqual(harness.lod_hashes(PROGRAM.info(self.root / "small/scene.xml"), 3), whole)

    def test_a_far_vertex_within_reach_is_baked(self):
        result = self.bake(self.write("far.glb", far=[1e4, 0, 0]))
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_voxels_that_are_far_too_small_are_refused_at_once(self):
        for far in (None, [1e6, 0, 0]):
            with self.subTest(far=far):
                result = self.bake(self.write("small.glb", far=far), voxel_size="1e-6")
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("--voxel-size", result.stderr)
                self.assertFalse((self.out / "scene.xml").exists())

    def test_many_sources_with_one_reason_are_a_few_lines(self):
        tiles = self.root / "tiles"
        tiles.mkdir()
        for number in range(100):
            self.write(f"tiles/t{number}.glb", far=[1e6, 0, 0])
        result = self.bake(tiles)
        self.assertEqual(result.returncode, 3)
        self.assertIn("incomplete, 100 missing", result.stderr)
        self.assertIn("and 97 more like 6 triangles of tile", result.stderr)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    unittest.main(argv=sys.argv[:1])
