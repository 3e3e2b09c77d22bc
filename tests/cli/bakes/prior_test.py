#!/usr/bin/env python3
"""Tests the results that a bake leaves for the next bake: `plan -o`, the lock of SCENE, `--prune`.

Usage: prior_test.py GIGABAKE SOURCE_DIR
"""
import fcntl
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

SQUARE = ([(0, 0, 0), (3, 0, 0), (0, 0, -3), (3, 0, -3)], [(0, 1, 2), (1, 3, 2)])


class Prior(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.source, self.out = self.root / "square.glb", self.root / "out"
        harness.write_glb(self.source, *SQUARE)

    def bake(self, *arguments, voxel_size=0.25):
        return json.loads(PROGRAM.succeed("bake", self.source, "-o", self.out, "--voxel-size", voxel_size,
                                          "--cell-voxels", 8, "--json", *arguments))

    def plan(self, *arguments):
        return PROGRAM.succeed("plan", self.source, "-o", self.out, "--voxel-size", 0.25, "--cell-voxels", 8,
                               *arguments)

    def files(self):
        return {p.relative_to(self.root): p.stat().st_mtime_ns for p in self.root.rglob("*")}

    def test_a_plan_says_that_all_is_new_and_makes_no_folder(self):
        said = self.plan()
        self.assertIn("4 of 4 cells to bake: 4 new; 0 to check, 0 unchanged", said)
        # Regression of 2026-11-25: every cell was listed, and the remaining work was not reported.
        self.assertIn("remaining: 4 cells, 100 % of the work", said)
        self.assertNotIn("c_0_0_0", said)
        self.assertIn("c_0_0_0", self.plan("--cells"))
        self.assertFalse(self.out.exists())

    def test_a_plan_names_the_reason_of_each_cell_and_writes_nothing(self):
        self.bake()
        next((self.out / "shards").glob("c_0_0_*.h5")).unlink()
        before = self.files()
        plan = json.loads(self.plan("--json"))
        self.assertEqual(self.files(), before)
        self.assertEqual(sum(plan["prior"].values()), 4)
        reasons = {job["name"]: job["prior"] for job in plan["jobs"]}
        self.assertIn(reasons["c_0_0_0"], ("new cell", "shard missing"))
        self.assertIn(reasons["c_1_1_0"], ("shard to be checked", "unchanged"))

    def test_shards_of_earlier_settings_stay_until_they_are_pruned(self):
        first = self.bake()
        self.assertEqual(first["orphans"], {"shards": 0, "bytes": 0})
        second = self.bake(voxel_size=0.5)
        self.assertEqual(second["orphans"], {"shards": 5, "bytes": first["bytes"]})
        self.assertEqual(self.bake()["orphans"]["shards"], 1)
        third = self.bake("--prune")
        self.assertEqual((third["orphans"]["shards"], third["pruned"]["shards"]), (0, 1))
        self.assertEqual(len(list((self.out / "shards").glob("*.h5"))), 5, "four cells and their overview")
        PROGRAM.succeed("verify", self.out / "scene.xml")

    # Regression of 2026-11-26: .status.json.PID-N.part of a killed rank stayed after complete bakes, as did that of
    # --metrics. The test takes the names from the folder, so that it includes files that bakes will write in future.
    def test_a_bake_removes_the_temporary_files_of_killed_bakes(self):
        texts = self.root / "texts"
        texts.mkdir()
        options = ("--metrics", texts / "bake.prom", "--report", texts / "report.json")
        self.bake(*options)
        published = [path for folder in (self.out, texts) for path in folder.rglob("*") if path.is_file()]
        self.assertEqual({path.name for path in published if "shards" not in path.parts},
                         {"scene.xml", "source.json", "status.json", "journal", "survey.cache", "bake.prom",
                          "report.json"})
        dead = self.pid_of_a_process_that_ended()
        for path in published:
            (path.parent / f".{path.name}.{dead}-0.part").write_bytes(b"half of a file")
        notes = self.out / ".notes.txt.1-1.part"
        notes.write_text("of another program")
        self.bake(*options)
        self.assertEqual([path for path in self.root.rglob("*.part")], [notes])
        PROGRAM.succeed("verify", self.out / "scene.xml")

    @staticmethod
    def pid_of_a_process_that_ended():
        with subprocess.Popen(["true"]) as process:
            pass
        return process.pid

    def test_a_second_bake_into_the_same_folder_ends_with_one_line_and_touches_nothing(self):
        self.bake()
        with open(self.out / ".lock", "w", encoding="utf-8") as lock:
            fcntl.lockf(lock, fcntl.LOCK_EX)
            lock.write("process 7 on elsewhere since noon\n")
            lock.flush()
            before = self.files()
            result = PROGRAM.run("bake", self.source, "-o", self.out, "--voxel-size", 1)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr.strip().splitlines()[-1],
                             f"gigabake: {self.out}: is being baked into by process 7 on elsewhere since noon")
            self.assertEqual(self.files(), before)
        self.bake()
        self.assertFalse((self.out / ".lock").exists())


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
