#!/usr/bin/env python3
"""Counts the work of fixed small bakes and compares the counts with counts.json. Times are not compared.

Counts do not depend on the load of a machine, except that of `render`, so a change that makes the program do more work
fails here. A change that does so on purpose, or that saves work, stores the new counts in the same commit:

    counts_test.py GIGABAKE SOURCE_DIR --record

`instructions` counts whole programs under callgrind, per compiler. It is skipped without valgrind, for builds that are
not optimized, and for compilers without recorded counts. Counts of devices are compared on hosts with a GPU.

Usage: counts_test.py GIGABAKE SOURCE_DIR [--record]
"""
import json
import re
import shutil
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

RECORDED = Path(__file__).with_name("counts.json")
TOLERANCE = 0.05
# A bake reads a file again if it changed less than two seconds before the previous bake (format/system/file_stamp.h).
SETTLED_S = 2.5
VOXEL_M = 0.25
OPTIONS = ("--cell-voxels", 64, "--threads", 2)
# Device counts are zero without a device, and are recorded apart.
DEVICE = "device_"
# Rays that wait more than 50 ms for pages are cast again (viewer/pictures/render.cpp), as on a loaded machine. The min
# of several runs counts.
MAX_RUNS = {"render": 4}


def differences(measured, recorded):
    """Yields a line per count that differs from the recorded count by more than the tolerance."""
    for name in sorted({*measured, *recorded}):
        now, before = measured.get(name), recorded.get(name)
        if now is None or before is None:
            yield f"{name}: measured {now}, recorded {before}"
        elif abs(now - before) > TOLERANCE * before:
            yield f"{name}: {now}, recorded {before} ({now / before - 1:+.1%})" if before else f"{name}: {now}, was 0"


def optimized(program):
    """Returns whether the program's build folder states an optimized build without sanitizers."""
    cache = Path(program).resolve().parent / "CMakeCache.txt"
    text = cache.read_text(encoding="utf-8") if cache.exists() else ""
    sanitizer = re.search(r"^GIGABAKE_SANITIZE:\w+=(?!OFF$).+$", text, re.M)
    return bool(re.search(r"^CMAKE_BUILD_TYPE:\w+=Release$", text, re.M)) and not sanitizer


class Counts(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        PROGRAM.sample(cls.root / "sample", size=96, tiles=2)
        cls.tileset = cls.root / "sample/tileset.json"
        time.sleep(SETTLED_S)
        cls.recorded = json.loads(RECORDED.read_text(encoding="utf-8"))
        cls.new = {}

    @classmethod
    def tearDownClass(cls):
        if RECORD:
            for name, counts in cls.new.items():
                place = cls.recorded
                for key in name[:-1]:
                    place = place.setdefault(key, {})
                place[name[-1]] = counts
            RECORDED.write_text(json.dumps(cls.recorded, indent=1, sort_keys=True) + "\n", encoding="utf-8")
            print(f"wrote {RECORDED}")

    def compare(self, measured, *name):
        """Compares the counts with the recorded counts of this name, or stores them with --record."""
        self.new[name] = measured
        if RECORD:
            return
        recorded = self.recorded
        for key in name:
            recorded = recorded.get(key, {})
        found = list(differences(measured, recorded))
        self.assertFalse(found, "\n" + "\n".join(found) + "\n--record stores the new counts, if they are intended")

    def work(self, name, out, *options):
        """Bakes into `out` and compares the run's counts. Returns the report."""
        report = self.root / f"{name}.json"
        PROGRAM.bake(self.tileset, self.root / out, VOXEL_M, *OPTIONS, *options, "--report", report)
        report = json.loads(report.read_text(encoding="utf-8"))
        work = report["run"]["work"]
        host = {key: count for key, count in work.items() if not key.startswith(DEVICE)}
        if report["ranks_with_device"] == 0:
            self.assertEqual(sum(work.values()), sum(host.values()), "no work on a device without a device")
            self.compare({"cells": report["cells"], **host}, "bakes", name)
        elif RECORD or "devices" in self.recorded:
            self.compare({key: count for key, count in work.items() if key.startswith(DEVICE)}, "devices", name)
        else:
            self.skipTest("no counts of a device are recorded")
        return report

    # Regression of 2026-11-24: one thread read all node rows of each child for each overview.
    def test_a_bake_takes_the_rows_of_its_overviews_from_memory(self):
        report = self.work("bake", "bake", "--backend", "cpu")
        work = report["run"]["work"]
        self.assertGreater(work["overview_children"], 10, "the scene has overviews")
        self.assertEqual(work["overview_children_read"], 0)
        self.assertEqual(work["shard_rows_read"], 0, "a bake reads no shard that it wrote")

    # 2026-11-28: an overview read the children of other ranks from shards; near the end, all ranks waited for it.
    def test_ranks_send_each_other_the_rows_of_overviews(self):
        report = self.root / "ranks.json"
        PROGRAM.bake(self.tileset, self.root / "ranks", VOXEL_M, *OPTIONS, "--backend", "cpu", "--report", report,
                     ranks=3)
        work = json.loads(report.read_text(encoding="utf-8"))["run"]["work"]
        self.assertGreater(work["overview_children"], 10)
        self.assertLess(work["overview_children_read"], work["overview_children"] / 10)

    def test_an_overview_of_a_touched_tile_reads_only_the_rows_that_it_duplicates(self):
        out = self.root / "touched"
        PROGRAM.bake(self.tileset, out, VOXEL_M, *OPTIONS, "--backend", "cpu")
        shards = sorted((out / "shards").glob("c_*.h5"))
        shards[len(shards) // 2].unlink()
        for overview in (out / "shards").glob("p*.h5"):
            overview.unlink()
        report = self.work("touched", "touched", "--backend", "cpu")
        self.assertGreater(report["run"]["work"]["overview_children_read"], 10)

    def test_a_bake_in_little_memory(self):
        self.work("little_memory", "little", "--backend", "cpu", "--memory", "64M")

    def test_a_bake_on_a_device(self):
        result = PROGRAM.run("bake", self.tileset, "-o", self.root / "probe", "--voxel-size", 4, "--backend", "cuda")
        if result.returncode != 0:
            self.skipTest("there is no CUDA device")
        self.work("bake", "device", "--backend", "cuda")

    def instructions(self, name, *arguments):
        """Compares the instructions of the program and of the benchmark program that it starts, without their start."""
        compiler = re.search(r"^compiler +(.+)$", PROGRAM.succeed("--version"), re.M)[1]
        valgrind = shutil.which("valgrind")
        if valgrind is None:
            self.skipTest("valgrind is not installed (tools/install-packages test)")
        if not optimized(PROGRAM.executable):
            self.skipTest("the instructions of builds that are not optimized are not counted")
        if not RECORD and name not in self.recorded.get("instructions", {}).get(compiler, {}):
            self.skipTest(f"no instructions of {compiler} are recorded")
        recorded = self.recorded.get("instructions", {}).get(compiler, {}).get(name, {})
        counts = [self.instructions_of(valgrind, name, *arguments)]
        while len(counts) < MAX_RUNS.get(name, 1) and list(differences({"instructions": min(counts)}, recorded)):
            counts.append(self.instructions_of(valgrind, f"{name}-{len(counts)}", *arguments))
        self.compare({"instructions": min(counts)}, "instructions", compiler, name)

    def instructions_of(self, valgrind, name, *arguments):
        counts = self.callgrind(valgrind, name, *arguments)
        start = self.callgrind(valgrind, f"{name}-start", "--version")[0]  # depends on the libraries that are linked
        return sum(counts) - len(counts) * start

    def callgrind(self, valgrind, name, *arguments):
        """Runs the program. Returns the instructions of each of its processes."""
        files = self.root / f"{name}.%p.callgrind"
        result = subprocess.run([valgrind, "--tool=callgrind", "--trace-children=yes", f"--callgrind-out-file={files}",
                                 PROGRAM.executable, *map(str, arguments)],
                                capture_output=True, text=True, timeout=900, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        return [int(re.search(r"^(?:summary|totals): (\d+)", file.read_text(encoding="utf-8"), re.M)[1])
                for file in self.root.glob(f"{name}.*.callgrind")]

    def test_instructions_of_cells_from_files_to_shards(self):
        if not (Path(PROGRAM.executable).parent / "gigabake-bench").exists():
            self.skipTest("gigabake-bench is not built")
        self.instructions("cells", "bench", "bake", self.tileset, "-o", self.root / "cells", "--voxel-size", 0.5,
                          "--cell-voxels", 128, "--threads", 1, "--backend", "cpu", "--json")

    def test_instructions_of_readers(self):
        PROGRAM.bake(self.tileset, self.root / "read", VOXEL_M, *OPTIONS)
        scene = self.root / "read/scene.xml"
        self.instructions("render", "render", scene, "--size", "64x48", "--backend", "cpu", "-o", self.root / "i.png")
        self.instructions("export", "export", scene, "--to", "ply", "--lod", 1, "-o", self.root / "points.ply")
        self.instructions("verify", "verify", scene)


if __name__ == "__main__":
    RECORD = "--record" in sys.argv
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
