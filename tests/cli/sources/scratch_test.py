#!/usr/bin/env python3
"""A tile that is larger than the memory is baked from its clusters on scratch, to the same voxels, and leaves nothing.

Usage: scratch_test.py GIGABAKE SOURCE_DIR
"""
import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

# A tile may use 1/128 of the memory; this tile needs twenty times as much.
MEMORY = "64M"
VOXEL = 1 / 512
CELLS = ("--local", "--cell-voxels", "128")


class Scratch(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.tile = cls.root / "terrain.glb"
        fractal = Path(GIGABAKE.executable).with_name("gigabake_fractal")
        harness.run([fractal, "--quads", "512", cls.tile], 300)
        info = GIGABAKE.bake(cls.tile, cls.root / "held", VOXEL, *CELLS, "--memory", "0")
        cls.hashes = harness.lod_hashes(info)

    def bake(self, name, *options, memory=MEMORY, **more):
        return GIGABAKE.run("bake", self.tile, "-o", self.root / name, "--voxel-size", VOXEL, *CELLS,
                            "--memory", memory, *options, **more)

    def expect_whole(self, result, name):
        self.assertEqual(result.returncode, 0, result)
        info = GIGABAKE.info(self.root / name / "scene.xml")
        self.assertEqual(harness.lod_hashes(info), self.hashes)
        self.assertFalse((self.root / name / "scratch").exists())

    def test_any_number_of_ranks_has_the_voxels_of_a_bake_in_memory(self):
        for ranks in (None, 2, 3):
            name = f"ranks{ranks}"
            result = self.bake(name, ranks=ranks)
            self.expect_whole(result, name)
            self.assertIn("of scratch for 1 large tile", result.stderr)
        self.assertNotIn("scratch", self.bake("much", memory="4G").stderr)

    # Regression of 2026-11-23: a quiet bake reported the scratch that it would write.
    def test_quiet_is_quiet(self):
        for _ in range(2):  # the second bake finds all cells complete
            result = self.bake("quiet", "--quiet")
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def plan(self, *options, memory=MEMORY):
        """Returns the output of a plan, and the maximum memory of its processes in bytes."""
        command = [GIGABAKE.executable, "plan", self.tile, "--voxel-size", VOXEL, *CELLS, "--memory", memory, *options]
        with subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                              env=dict(os.environ, **harness.MPI_ENVIRONMENT)) as process:
            said = process.stdout.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0, said)
        return said, usage.ru_maxrss * 1024

    # Regression of 2026-11-23: plan held the positions of the whole tile in memory and did not report the scratch.
    def test_a_plan_says_the_scratch_and_has_the_cells_of_one_in_memory(self):
        for measure in ("--no-measure", "--measure"):
            mine = self.root / f"plan{measure}"
            few, much = (json.loads(self.plan(measure, "--json", "--scratch", mine, memory=memory)[0])
                         for memory in (MEMORY, "4G"))
            self.assertEqual(few["jobs"], much["jobs"])
            size = self.tile.stat().st_size
            self.assertEqual(few["scratch"], {"folder": str(mine), "large_tiles": 1, "tile_bytes": size,
                                              "texture_bytes": None if measure == "--no-measure" else 0, "bytes": size})
            self.assertEqual(much["scratch"]["bytes"], 0)
            self.assertEqual(list(mine.glob("*")), [])
        self.assertGreater(few["sizes"][1]["pieces"], 0, few)
        self.assertRegex(self.plan("--no-measure")[0],
                         r"about \S+ MB of scratch for 1 large tile in SCENE/scratch while")
        self.assertNotIn("scratch", self.plan("--no-measure", memory="4G")[0])

    def test_a_folder_of_ones_own_is_used_and_left_as_it_was(self):
        scratch = self.root / "of mine"
        scratch.mkdir()
        (scratch / "t_notes.txt").write_text("mine")
        result = self.bake("elsewhere", "--scratch", scratch)
        self.expect_whole(result, "elsewhere")
        self.assertIn(str(scratch), result.stderr)
        self.assertEqual([path.name for path in scratch.iterdir()], ["t_notes.txt"])

    def test_what_a_killed_bake_has_on_scratch_is_used_by_the_next_and_goes_with_it(self):
        for number, how in ((1, signal.SIGKILL), (2, signal.SIGTERM)):
            name = f"killed{number}"
            bake = harness.Started([GIGABAKE.executable, "bake", self.tile, "-o", self.root / name, "--voxel-size",
                                    VOXEL / 4, "--local", "--cell-voxels", 256, "--memory", MEMORY, "--threads", 1],
                                   env=dict(os.environ, **harness.MPI_ENVIRONMENT))
            self.addCleanup(bake.end)
            scratch = self.root / name / "scratch"
            while bake.poll() is None and not list(scratch.glob("t_*.clusters")):
                time.sleep(0.01)
            bake.send_signal(how)
            bake.wait()
            kept = list(scratch.glob("t_*.clusters"))
            self.assertEqual(len(kept), 1, bake.said())
            files = {kept[0].stat().st_ino}
            self.assertNotEqual(bake.returncode, 0)
            again = harness.Started([GIGABAKE.executable, "bake", self.tile, "-o", self.root / name, "--voxel-size",
                                     VOXEL, *CELLS, "--memory", MEMORY],
                                    env=dict(os.environ, **harness.MPI_ENVIRONMENT))
            self.addCleanup(again.end)
            with contextlib.suppress(FileNotFoundError):
                while True:
                    files.add(kept[0].stat().st_ino)
            again.wait()
            self.assertEqual(len(files), 1, "the file was written again")
            self.assertEqual(again.returncode, 0, again.said())
            info = GIGABAKE.info(self.root / name / "scene.xml")
            self.assertEqual(harness.lod_hashes(info), self.hashes)
            self.assertFalse(scratch.exists())

    def test_a_folder_that_cannot_be_written_is_named_in_one_line(self):
        file = self.root / "file"
        file.write_text("no folder")
        result = self.bake("nowhere", "--scratch", file)
        self.assertEqual(result.returncode, 1, result)
        self.assertIn("cannot make the scratch folder", result.stderr)
        self.assertEqual(sum("gigabake: " in line for line in result.stderr.splitlines()), 1, result.stderr)


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
