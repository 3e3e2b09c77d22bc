#!/usr/bin/env python3
"""`bake --ranks N` starts N ranks of this host, and ends with their exit code. Stop requests reach the ranks.

Usage: local_ranks_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import re
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

DRAINED = 75
BOUND_S = 60
# Only the program's own settings of Open MPI, as for a user without any.
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith(("OMPI_", "PMIX_", "SLURM_"))}


class LocalRanks(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        PROGRAM.sample(cls.root / "sample", size=128, tiles=4)
        cls.source = cls.root / "sample/tileset.json"
        cls.expected = cls.bake_json("expected", "--ranks", 1)

    @classmethod
    def command(cls, out, *options, voxel_m=0.5):
        return [PROGRAM.executable, "bake", cls.source, "-o", cls.root / out, "--voxel-size", voxel_m,
                "--cell-voxels", 64, "--backend", "cpu", *options]

    @classmethod
    def run_bake(cls, out, *options, **environment):
        return subprocess.run([str(word) for word in cls.command(out, *options)], env={**ENVIRONMENT, **environment},
                              capture_output=True, text=True, check=False, timeout=300)

    @classmethod
    def bake_json(cls, out, *options):
        result = cls.run_bake(out, *options, "--json")
        assert result.returncode == 0, result.stderr
        return json.loads(result.stdout)

    def start(self, out):
        """Starts a long bake on two ranks and waits for its first cell."""
        process = subprocess.Popen([str(word) for word in self.command(out, "--ranks", 2, voxel_m=0.03)],
                                   env=ENVIRONMENT, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + BOUND_S
        while not list((self.root / out).glob("shards/c_*")):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        return process

    def processes_of(self, out):
        return [path.parent.name for path in Path("/proc").glob("[0-9]*/cmdline")
                if str(self.root / out).encode() in self.bytes_of(path)]

    @staticmethod
    def bytes_of(path):
        try:
            return path.read_bytes()
        except OSError:  # the process has ended
            return b""

    def test_ranks_write_the_same_scene(self):
        for ranks in (2, 3):
            report = self.bake_json(f"on{ranks}", "--ranks", ranks)
            self.assertEqual((report["ranks"], report["voxels"]), (ranks, self.expected["voxels"]))
            hashes = [PROGRAM.info(self.root / out)["content_hash"] for out in ("expected", f"on{ranks}")]
            self.assertEqual(*hashes)

    def test_errors_of_ranks_are_one_line_and_their_exit_code(self):
        result = self.run_bake("bad", "--ranks=2", "--quiet", "--memory", "1M")
        self.assertEqual((result.returncode, result.stderr),
                         (2, "gigabake: --memory: expected at least 64M, or 0 for no bound\n"))

    def test_numbers_and_starts_that_are_impossible_are_refused(self):
        for option, environment, reason in (
                ("0", {}, "expected 1 to 1024, got 0"), ("1025", {}, "expected 1 to 1024, got 1025"),
                ("2", {"PATH": str(self.root)}, "mpirun is not in PATH"),
                ("2", {"PMI_RANK": "0", "PMI_SIZE": "1"}, "another launcher started this process")):
            result = self.run_bake("refused", "--ranks", option, **environment)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertIn(reason, result.stderr)
        self.assertFalse((self.root / "refused").exists())

    def test_ctrl_c_drains_all_ranks(self):
        process = self.start("drained")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(BOUND_S), DRAINED, process.stderr.read())
        self.assertEqual(self.processes_of("drained"), [])

    def test_ranks_end_with_the_process_that_started_them(self):
        process = self.start("killed")
        process.kill()
        process.wait()
        deadline = time.monotonic() + BOUND_S
        while self.processes_of("killed"):
            self.assertLess(time.monotonic(), deadline, self.processes_of("killed"))
            time.sleep(0.1)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    if re.search("^MPI +not built in", PROGRAM.run("--version").stdout, re.M):
        print("skipped: this gigabake was built without MPI")
        sys.exit(77)
    harness.main(argv=sys.argv[:1], verbosity=2)
