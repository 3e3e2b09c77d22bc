#!/usr/bin/env python3
"""Checks the part of a bake's report about the run: amounts, rates, and which stage bounds the run.

The scenes differ in the work of their stages by a factor of ten and more, so load does not change which one dominates.

Usage: stages_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import write_png

STAGES = ("reading", "kernels", "packing", "writing")


class Stages(harness.FolderTest):
    def square(self, name, texels, size_m):
        """Writes a horizontal square with a texture of random colours. Returns its path."""
        colours = numpy.random.default_rng(7).integers(0, 256, (texels, texels, 3), dtype="u1")
        write_png(self.root / f"{name}.png", colours)
        (self.root / f"{name}.mtl").write_text(f"newmtl m\nmap_Kd {name}.png\n")
        path = self.root / f"{name}.obj"
        corners = ((0, 0), (size_m, 0), (size_m, -size_m), (0, -size_m))
        path.write_text(f"mtllib {name}.mtl\nusemtl m\n" + "".join(f"v {x} 0 {z}\n" for x, z in corners) +
                        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
        return path

    def bake(self, source, voxel_m, cell_voxels, out, *options):
        """Returns the text that a bake prints, and its report about the run."""
        report = self.root / "report.json"
        text = PROGRAM.succeed("bake", source, "-o", self.root / out, "--local", "--voxel-size", voxel_m,
                               "--cell-voxels", cell_voxels, "--threads", 1, "--backend", "cpu", "--report", report,
                               *options)
        run = json.loads(report.read_text(encoding="utf-8"))["run"]
        shares = [run["exclusive"][stage] for stage in STAGES] + [run["several"], run["idle"]]
        self.assertGreaterEqual(min(shares), 0)
        self.assertLessEqual(sum(run["exclusive"].values()), 1 + 1e-9)
        self.assertAlmostEqual(sum(shares), 1 if run["bound"] else 0, delta=1e-9)
        return text, run

    def test_a_source_that_is_slow_to_read_bounds_the_run(self):
        text, run = self.bake(self.square("slow", 3000, 8), 1, 64, "slow")
        self.assertEqual(run["bound"], "reading", run)
        self.assertIn("; the run is bound by reading\n", text)
        self.assertGreater(run["exclusive"]["reading"], 0.5)

    def test_kernels_bound_a_run_of_many_voxels_from_a_small_file(self):
        _, run = self.bake(self.square("large", 64, 500), 0.5, 1024, "large", "--codec", "deflate")
        self.assertEqual(run["bound"], "kernels", run)
        self.assertTrue(all(run["exclusive"][stage] > 0 for stage in STAGES), run)

    def test_rates_are_amounts_by_time(self):
        source = self.square("small", 8, 8)
        _, run = self.bake(source, 1, 64, "small")
        self.assertEqual((run["triangles"], run["voxels"]), (2, 64 + 16 + 4 + 1))
        self.assertAlmostEqual(run["square_km"], 64e-6, delta=1e-12)
        self.assertGreater(run["cpu_s"], 0)
        for amount in ("square_km", "triangles", "voxels", "bytes"):
            self.assertAlmostEqual(run[f"{amount}_per_s"] * run["seconds"], run[amount], delta=1e-6 * run[amount])

    def test_a_run_that_reuses_all_cells_has_baked_nothing(self):
        source = self.square("again", 8, 8)
        self.bake(source, 1, 64, "again")
        text, run = self.bake(source, 1, 64, "again")
        self.assertEqual([run[amount] for amount in ("square_km", "triangles", "voxels", "bytes")], [0, 0, 0, 0])
        self.assertIsNone(run["bound"])
        self.assertNotIn("km²/s", text)

    def test_the_work_of_all_ranks_is_summed(self):
        PROGRAM.sample(self.root / "sample")
        options = ("--cell-voxels", 64, "--threads", 1, "--backend", "cpu")
        runs = []
        for ranks in (None, 2):
            report = self.root / f"ranks{ranks}.json"
            PROGRAM.bake(self.root / "sample/tileset.json", self.root / f"ranks{ranks}", 0.5, *options, "--report",
                         report, ranks=ranks)
            runs.append(json.loads(report.read_text(encoding="utf-8"))["run"])
        for name in ("overview_children", "overview_rows", "shard_bytes_written"):
            self.assertEqual(runs[0]["work"][name], runs[1]["work"][name], name)
        self.assertEqual(runs[0]["bytes"], runs[1]["bytes"])


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
