#!/usr/bin/env python3
"""Compares the numbers of voxels, bytes and seconds that `plan` predicts with the results of real bakes.

Usage: plan_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import re
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

VOXEL_M = 0.5
MAX_VOXELS_OFF, MAX_BYTES_OFF = 0.15, 0.30
MAX_S = 120  # a plan takes about five seconds


class Plan(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        GIGABAKE.succeed("sample", cls.root / "sample", "--size", 192, "--tiles", 3, "--texel", VOXEL_M)
        cls.tiles = cls.root / "sample" / "tileset.json"
        start = time.monotonic()
        cls.plan = json.loads(GIGABAKE.succeed("plan", cls.tiles, "--voxel-size", VOXEL_M, "--json"))
        cls.plan_s = time.monotonic() - start

    # Regressions of 2026-11-22.
    def test_voxels_and_bytes_are_those_of_real_bakes(self):
        sizes = self.plan["sizes"]
        self.assertEqual([size["voxel_size_m"] for size in sizes], [VOXEL_M / 2, VOXEL_M, VOXEL_M * 2])
        self.assertEqual([size["asked"] for size in sizes], [False, True, False])
        for number, size in enumerate(sizes):
            info = GIGABAKE.bake(self.tiles, self.root / f"out{number}", size["voxel_size_m"])
            voxels_off = size["voxels_lod0"] / info["lods"][0]["voxels"] - 1
            bytes_off = size["bytes"] / info["bytes"] - 1
            print(f"{size['voxel_size_m']} m: voxels {voxels_off:+.1%}, bytes {bytes_off:+.1%}, "
                  f"{size['pieces']} pieces, {size['surface_share']:.0%} of the surface")
            self.assertLess(abs(voxels_off), MAX_VOXELS_OFF, size)
            self.assertLess(abs(size["voxels"] / info["voxels"] - 1), MAX_VOXELS_OFF, size)
            self.assertLess(abs(bytes_off), MAX_BYTES_OFF, size)

    def test_seconds_are_measured_on_this_machine(self):
        asked = self.plan["sizes"][1]
        self.assertGreater(asked["pieces"], 0)
        self.assertGreater(asked["measured_s"], 0)
        seconds = [size["seconds"] for size in self.plan["sizes"]]
        self.assertTrue(all(s > 0 for s in seconds), seconds)
        self.assertGreater(seconds[0], seconds[2])
        self.assertLess(self.plan_s, MAX_S)

    def test_the_texels_of_the_textures_suggest_a_voxel_size(self):
        # The ground's texels have an edge of VOXEL_M; walls and leaves have finer texels.
        texel_m, suggested_m = self.plan["texel_m"], self.plan["suggested_voxel_size_m"]
        self.assertTrue(VOXEL_M / 20 < texel_m < 1.5 * VOXEL_M, texel_m)
        self.assertTrue(0.7 < suggested_m / texel_m < 1.4, (suggested_m, texel_m))
        triangle = self.root / "plain.glb"
        harness.write_glb(triangle, [[0, 0, 0], [40, 0, 0], [0, 0, -40]], [0, 1, 2])
        self.assertIsNone(json.loads(GIGABAKE.succeed("plan", triangle, "--voxel-size", 1, "--json"))["texel_m"])

    def test_the_text_has_the_answer_last(self):
        text = GIGABAKE.succeed("plan", self.tiles, "--voxel-size", VOXEL_M)
        rows = re.findall(r"^ +[\d.]+ m .* about .*$", text, re.M)
        self.assertEqual(len(rows), 3, text)
        self.assertIn("requested", rows[1])
        self.assertRegex(text, r"measured: \d+ pieces? of \d+ tiles? baked in \d")
        self.assertRegex(text.splitlines()[-1], r"texels of the textures are about 0\.\d+ m: voxels of 0\.\d+ m show")

    def test_nothing_is_measured_where_that_is_not_wanted_and_nothing_is_left_behind(self):
        temporary = self.root / "temporary"
        temporary.mkdir()
        environment = {"env": dict(os.environ, TMPDIR=str(temporary), **harness.MPI_ENVIRONMENT)}
        for options in (("--no-measure",), ()):
            result = subprocess.run(
                [GIGABAKE.executable, "plan", str(self.tiles), "--voxel-size", "2", "--json", *options],
                capture_output=True, text=True, timeout=MAX_S, check=True, **environment)
            plan = json.loads(result.stdout)
            self.assertEqual(list(temporary.glob("gigabake-plan*")), [])
            measured = not options
            self.assertEqual([size["seconds"] is not None for size in plan["sizes"]], [measured] * 3)
        real = GIGABAKE.bake(self.tiles, self.root / "rough", 2)["lods"][0]["voxels"]
        rough = json.loads(GIGABAKE.succeed("plan", self.tiles, "--voxel-size", 2, "--no-measure", "--json"))
        self.assertTrue(0.5 < rough["sizes"][1]["voxels_lod0"] / real < 2, (rough["sizes"][1], real))


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    unittest.main(argv=sys.argv[:1])
