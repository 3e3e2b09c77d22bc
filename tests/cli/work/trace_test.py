#!/usr/bin/env python3
"""Checks the time stamps that GIGABAKE_TRACE records: every cell passes through its stages, in order, on each rank.

Usage: trace_test.py GIGABAKE SOURCE_DIR
"""
import collections
import json
import os
import subprocess
import sys
import unittest
import unittest.mock
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

STAGES = ["read", "compute", "write", "publish"]


class Trace(harness.FolderTest):
    def spans(self):
        """Returns the time stamps of all processes. A file has no end, because processes may be killed."""
        for path in self.root.glob("trace.*.json"):
            lines = path.read_text(encoding="utf-8").splitlines()
            self.assertEqual(lines[0], "[")
            yield from (json.loads(line.rstrip(",")) for line in lines[1:] if line.endswith(","))

    def test_each_cell_is_read_computed_and_written_in_this_order(self):
        PROGRAM.sample(self.root / "sample", size=96, tiles=2)
        with unittest.mock.patch.dict(os.environ, {"GIGABAKE_TRACE": str(self.root / "trace")}):
            PROGRAM.succeed("bake", self.root / "sample/tileset.json", "-o", self.root / "scene", "--voxel-size", 0.5,
                            "--cell-voxels", 64, "--threads", 1, "--backend", "cpu", ranks=2)
        cells = collections.defaultdict(list)
        for span in self.spans():
            self.assertEqual(span["ph"], "X")
            self.assertGreaterEqual(span["dur"], 0)
            if span["name"] in STAGES and not span["args"]["of"].startswith("p"):
                cells[span["args"]["of"]].append((span["ts"], span["name"], span["pid"]))
        self.assertGreater(len(cells), 4)
        for name, stages in cells.items():
            stages.sort()
            self.assertEqual([stage for _, stage, _ in stages], STAGES[:len(stages)], name)
            self.assertEqual(len({process for _, _, process in stages}), 1, name)
        # A process may be killed before it records the end of its last cell.
        self.assertGreaterEqual(sum(len(stages) == len(STAGES) for stages in cells.values()), len(cells) - 2)

        files = sorted(self.root.glob("trace.*.json"))
        table = subprocess.run([sys.executable, Path(SOURCE) / "tools/trace-times", *files], check=True, text=True,
                               capture_output=True).stdout
        for stage in STAGES:
            numbers = [int(line.split("|")[3]) for line in table.splitlines() if f"| {stage} |" in line]
            self.assertGreaterEqual(sum(numbers), len(cells) - 2, table)

    def test_nothing_is_recorded_without_the_variable(self):
        before = set(self.root.glob("*.json"))
        PROGRAM.sample(self.root / "other", size=64, tiles=1)
        PROGRAM.bake(self.root / "other/tileset.json", self.root / "other_scene", 1)
        self.assertFalse(list((self.root / "other_scene").glob("trace*")))
        self.assertEqual(before, set(self.root.glob("*.json")))


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(sys.argv[1]), sys.argv[2]
    harness.main(argv=sys.argv[:1], verbosity=2)
