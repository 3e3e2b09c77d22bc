#!/usr/bin/env python3
"""A bake over previous results bakes only the changed cells again and gives the voxels of a clean bake.

One of a thousand tiles is touched, moved, removed or added, or a texture or a parameter changes. One bake per folder.

Usage: incremental_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import re
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness

SEED = 20261122
ACROSS = 32  # tiles along an edge; 1024 in total
TILE_M = 8.0
VOXEL_M = 0.25
CELL_VOXELS = 32  # a cell is as wide as a tile
SETTLE_S = 2.1  # the bake does not trust files with younger time stamps


def tile(random_values, x, y):
    """Returns a rough surface slightly smaller than a tile, so that it overlaps the cells of only one column."""
    quads = 12
    grid = numpy.linspace(0.5, TILE_M - 0.5, quads + 1)
    across, along = numpy.meshgrid(grid + x * TILE_M, grid + y * TILE_M)
    height = 3 + random_values.uniform(-1, 1, across.shape)
    positions = numpy.stack([across, height, -along], -1).reshape(-1, 3)  # glTF: y up
    corner = numpy.arange(quads)[:, None] * (quads + 1) + numpy.arange(quads)
    below = corner + quads + 1
    indices = numpy.stack([corner, below, corner + 1, corner + 1, below, below + 1], -1).reshape(-1, 3)
    colours = random_values.integers(0, 256, (len(positions), 4))
    colours[:, 3] = 255
    return positions, indices, colours


class Incremental(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(cls.executable)
        cls.tiles = cls.root / "tiles"
        cls.tiles.mkdir()
        cls.random_values = numpy.random.default_rng(SEED)
        for y in range(ACROSS):
            for x in range(ACROSS):
                harness.write_glb(cls.tile(x, y), *tile(cls.random_values, x, y))
        time.sleep(SETTLE_S)
        cls.out = cls.root / "out"
        start = time.monotonic()
        cls.full = cls.bake(cls.out)
        cls.full_s = time.monotonic() - start

    @classmethod
    def tile(cls, x, y):
        return cls.tiles / f"t_{x}_{y}.glb"

    @classmethod
    def bake(cls, out, *more):
        return json.loads(cls.program.succeed("bake", cls.tiles, "-o", out, "--local", "--voxel-size", VOXEL_M,
                                              "--cell-voxels", CELL_VOXELS, "--json", *more, ranks=2))

    def expect_as_clean(self, *more):
        """Bakes over previous results and compares with a clean bake. Returns the report of the incremental bake."""
        report = self.bake(self.out, *more)
        clean = self.root / "clean"
        self.bake(clean, *more)
        same = self.program.run("diff", self.out / "scene.xml", clean / "scene.xml")
        self.assertEqual(same.returncode, 0, same.stdout)
        self.program.succeed("verify", self.out / "scene.xml")
        shutil.rmtree(clean)
        return report

    def parents(self):
        return {path.name for path in (self.out / "shards").glob("p*.h5")}

    def baked(self, report):
        return report["cells_planned"] - report["cells_taken_over"]

    def test_a_touched_tile_costs_its_cells(self):
        cells_of_a_tile = self.full["cells_planned"] / ACROSS**2
        harness.write_glb(self.tile(7, 9), *tile(self.random_values, 7, 9))
        before = self.parents()
        start = time.monotonic()
        report = self.bake(self.out)
        seconds = time.monotonic() - start
        ancestors = len(self.parents() - before)
        self.assertIn(ancestors, (2, 3), "one block, or two where its cell reaches into the next, and the root")
        self.assertLessEqual(self.baked(report), 2 * cells_of_a_tile)
        self.assertGreaterEqual(self.baked(report), 1)
        print(f"full {self.full_s:.2f} s of {self.full['cells_planned']} cells; one tile of {ACROSS**2}: "
              f"{seconds:.2f} s, {self.baked(report)} cells")
        again = self.expect_as_clean()
        self.assertEqual(self.baked(again), 0)

    def test_a_file_written_anew_with_the_same_content_costs_nothing(self):
        self.bake(self.out)
        path = self.tile(3, 3)
        path.write_bytes(path.read_bytes())
        self.assertEqual(self.baked(self.bake(self.out)), 0)

    def test_moved_removed_and_added_tiles_cost_the_cells_of_both_places(self):
        self.bake(self.out)
        moved = self.random_values
        harness.write_glb(self.tile(1, 2), *tile(moved, 40, 2))
        self.tile(5, 5).unlink()
        harness.write_glb(self.tile(50, 5), *tile(moved, 50, 5))
        report = self.expect_as_clean()
        self.assertGreaterEqual(self.baked(report), 2)
        self.assertLessEqual(self.baked(report), 8)

    def test_another_parameter_costs_everything_and_the_way_back_nothing(self):
        self.bake(self.out)
        other = self.bake(self.out, "--mip", "box")
        self.assertEqual(other["cells_taken_over"], 0)
        self.assertEqual(self.baked(self.bake(self.out)), 0)
        pruned = self.bake(self.out, "--prune")
        self.assertEqual(self.baked(pruned), 0)
        self.assertEqual(self.bake(self.out, "--mip", "box")["cells_taken_over"], 0)

    def test_the_plan_says_what_will_be_baked_and_why(self):
        self.bake(self.out)
        harness.write_glb(self.tile(11, 12), *tile(self.random_values, 11, 12))
        shard = random.Random(SEED).choice(sorted((self.out / "shards").glob("*.h5")))
        shard.unlink()
        said = self.program.succeed("plan", self.tiles, "-o", self.out, "--local", "--voxel-size", VOXEL_M,
                                    "--cell-voxels", CELL_VOXELS, "--cells")
        self.assertIn("inputs changed", said)
        self.bake(self.out)

    def test_a_second_bake_of_a_folder_is_refused_and_harms_nothing(self):
        out = self.root / "locked"
        command = ["bake", self.tiles, "-o", out, "--local", "--voxel-size", 0.05, "--cell-voxels", 128]
        log = harness.TRANSCRIPT.file(command)
        self.addCleanup(log.close)
        first = subprocess.Popen([self.executable, *map(str, command)], stdout=subprocess.DEVNULL, stderr=log,
                                 env=dict(os.environ, **harness.MPI_ENVIRONMENT))
        while not list(out.glob("shards/c_*.h5")):
            time.sleep(0.01)
            self.assertIsNone(first.poll())
        second = self.program.run(*command)
        self.assertEqual(second.returncode, 1, second.stderr)
        self.assertIn(f"process {first.pid}", second.stderr)
        self.assertEqual(len(second.stderr.strip().splitlines()), 2, second.stderr)
        first.send_signal(signal.SIGUSR1)
        self.assertEqual(first.wait(120), 75)
        self.assertEqual(json.loads(self.program.run("status", out, "--json").stdout)["state"], "drained")
        log.seek(0)
        told = log.read().partition("incomplete, ")[2].splitlines()
        missing, more = int(told[0].split()[0]), re.search(r"and (\d+) more like cell ", told[-1])
        self.assertEqual(len(told), 5, "of many cells with one reason three are named, and the others counted")
        self.assertEqual(3 + int(more[1]), missing)


if __name__ == "__main__":
    Incremental.executable = sys.argv[1]
    harness.main(argv=sys.argv[:1])
