#!/usr/bin/env python3
"""cluster/scaling measures bakes on ranks of the CPU, and fails if the content hashes of a scene differ.

Usage: scaling_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness

TINY = ("--backend", "cpu", "--size", 64, "--voxel-sizes", "0.5", "--cell-voxels", 64)
# Prints another content hash each time.
OTHER_HASHES = """#!/bin/sh
[ "$1" = info ] || exec "{program}" "$@"
echo "{{\\"content_hash\\": \\"$(date +%N)\\"}}"
"""


class Scaling(harness.FolderTest):
    def measure(self, *options, program=None):
        """Returns the exit status, the printed text and the JSON file of a measurement."""
        report = self.root / "scaling.json"
        result = harness.run([SOURCE / "cluster/scaling", "--program", program or PROGRAM, *TINY, "--memory-folder",
                              self.root, "--disk-folder", self.root, "--json", report, *options])
        return result.returncode, result.stdout + result.stderr, json.loads(report.read_text(encoding="utf-8"))

    def test_ranks_with_a_thread_each_bake_equal_scenes(self):
        status, text, report = self.measure("--devices", "1,2", "--threads", 1)
        self.assertEqual(status, 0, text)
        rows = report["runs"]
        self.assertEqual([(row["scaling"], row["ranks"], row["storage"]) for row in rows],
                         [(*run, storage) for storage in ("memory", "disk")
                          for run in (("strong", 1), ("strong", 2), ("weak", 2))])
        self.assertEqual(len({row["content_hash"] for row in rows if row["size_m"] == 64}), 1)
        self.assertAlmostEqual(rows[2]["size_m"] ** 2, 2 * 64 ** 2)
        for row in rows:
            baked = row["run"]
            self.assertAlmostEqual(sum(baked["exclusive"].values()) + baked["several"] + baked["idle"], 1)
            for amount in ("seconds", "command_s", "cpu_s", "bytes_read", "bytes_written", "voxels_per_s"):
                self.assertGreater(row[amount], 0)
        self.assertEqual((rows[0]["efficiency"], report["not_run"], report["problems"]), (1, [], []))
        self.assertIn("one rank that drives several GPUs", text)
        self.assertEqual([path.name for path in self.root.iterdir()], ["scaling.json"])

    def test_ranks_share_the_cores(self):
        status, text, report = self.measure("--devices", "1,2", "--cores", 2, "--parts", "strong,weak", "--repeats", 2)
        self.assertEqual(status, 0, text)
        self.assertEqual([(row["ranks"], row["threads_per_rank"], len(row["all_seconds"])) for row in report["runs"]],
                         [(1, 2, 2), (2, 1, 2)])
        one, two = (row["voxels_per_s"] for row in report["runs"])
        self.assertAlmostEqual(report["runs"][1]["efficiency"], two / one)

    def test_the_time_limit_leaves_runs_out(self):
        status, text, report = self.measure("--devices", "1", "--time-limit", 0, "--largest", "--largest-size", 64)
        self.assertEqual((status, report["runs"], report["largest"]), (0, [], {}), text)
        self.assertEqual([entry["reason"] for entry in report["not_run"]], 3 * ["time limit"])
        self.assertEqual(text.count("Not run (time limit)"), 3)

    def test_other_hashes_are_a_failure(self):
        program = self.root / "other_hashes"
        program.write_text(OTHER_HASHES.format(program=PROGRAM), encoding="utf-8")
        program.chmod(0o755)
        status, text, report = self.measure("--devices", "1", "--parts", "strong,disk", program=program)
        program.unlink()
        self.assertEqual((status, len(report["runs"])), (1, 2), text)
        self.assertIn("FAILED: 64 m at 0.5 m: content hashes differ", text)

    def test_a_large_map_is_checked_and_rendered(self):
        image = self.root / "overview.png"
        status, text, report = self.measure(
            "--devices", "2", "--parts", "", "--largest", "--largest-size", 64, "--largest-voxel-size", "0.5",
            "--image", image, "--image-size", "160x90", "--flight-frames", 2)
        self.assertEqual(status, 0, text)
        steps = ["bake", "info", "verify", "render"] + ["flight"] * PROGRAM.with_name("gigabake-bench").exists()
        self.assertEqual((list(report["largest"]), report["runs"]), (steps, []))
        self.assertEqual(report["largest"]["verify"]["result"], "0 faults")
        self.assertTrue(image.read_bytes().startswith(b"\x89PNG"))
        image.unlink()


if __name__ == "__main__":
    PROGRAM, SOURCE = (Path(argument).resolve() for argument in sys.argv[1:3])
    harness.main(argv=sys.argv[:1])
