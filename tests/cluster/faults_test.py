#!/usr/bin/env python3
"""What a night does to a bake: processes, ranks and mpirun are killed, stopped or told to drain at random moments,
shards are damaged between runs. The same command, given again, ends with the voxels of an undisturbed bake, every time.

Usage: faults_test.py GIGABAKE SOURCE_DIR [--faults N] [--seed N]
"""
import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli"))
import harness

OPTIONS = {"faults": 10, "seed": 20261120}
BAKE_PROCESS = "gigabake-bake"


def descendants(pid):
    """Every process below pid, as (pid, name)."""
    children = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            text = stat.read_text()
        except OSError:
            continue  # it ended meanwhile
        name, rest = text[text.index("(") + 1:text.rindex(")")], text[text.rindex(")") + 2:].split()
        children.setdefault(int(rest[1]), []).append((int(stat.parent.name), name))
    found, ask = [], [pid]
    while ask:
        below = children.get(ask.pop(), [])
        found += below
        ask += [child for child, _ in below]
    return found


def rank_of(pid):
    try:
        environment = Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return None
    for line in environment:
        if line.startswith(b"OMPI_COMM_WORLD_RANK="):
            return int(line.partition(b"=")[2])
    return None


class Launch:
    """One `mpirun gigabake bake` under way."""

    def __init__(self, program, arguments, ranks):
        command = ["mpirun", "-n", str(ranks), program.executable, *map(str, arguments)]
        self.log = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(command, stdout=self.log, stderr=subprocess.STDOUT, start_new_session=True,
                                        env=dict(os.environ, **harness.MPI_ENVIRONMENT))

    def pids(self, what):
        below = descendants(self.process.pid)
        if what == "bake process":
            return [pid for pid, name in below if name == BAKE_PROCESS]
        ranks = {rank_of(pid): pid for pid, name in below if name != BAKE_PROCESS and rank_of(pid) is not None}
        if what == "rank 0":
            return [ranks[0]] if 0 in ranks else []
        return [pid for rank, pid in ranks.items() if rank != 0]

    def wait(self, seconds=180):
        code = self.process.wait(seconds)
        self.log.seek(0)
        with self.log:
            return code, self.log.read()


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.program = harness.Gigabake(cls.executable)
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = Path(cls.folder.name)
        cls.program.succeed("sample", cls.work / "terrain", "--size", 256, "--seed", 5)
        start = time.monotonic()
        cls.undisturbed = harness.lod_hashes(cls.program.bake(*cls.arguments(cls.work / "whole"), ranks=2))
        cls.seconds = time.monotonic() - start

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def arguments(cls, out):
        return cls.work / "terrain/tileset.json", out, 0.25, "--cell-voxels", 64, "--stall", 2, "--threads", 1

    @classmethod
    def bake(cls, out):
        source, out, voxel_size, *more = cls.arguments(out)
        return ["bake", source, "-o", out, "--voxel-size", voxel_size, *more]

    def expect_whole(self, out, ranks, context):
        """The same command again, if it was not whole already, ends well and right."""
        code, log = Launch(self.program, self.bake(out), ranks).wait()
        self.assertEqual(code, 0, f"{context}\n{log}")
        scene = out / "scene.xml"
        self.assertEqual(harness.lod_hashes(self.program.info(scene)), self.undisturbed, f"{context}\n{log}")
        self.program.succeed("verify", scene)
        self.assertEqual([p for p in out.rglob("*.part")], [], context)

    def inflict(self, launch, fault, after_s):
        """False: the bake was over before, and so long is what a bake takes now: the first may have had less of the
        machine, and then faults would come too late for ever."""
        start = time.monotonic()
        try:
            launch.process.wait(after_s)
            type(self).seconds = time.monotonic() - start
            return False
        except subprocess.TimeoutExpired:
            pass
        what, number = fault
        pids = [launch.process.pid] if what == "mpirun" else launch.pids(what)
        if launch.process.poll() is not None or not pids:
            return False
        os.kill(self.random.choice(pids), number)
        return True

    def damage(self, out):
        """One shard, between runs."""
        shards = sorted((out / "shards").glob("*.h5"))
        if not shards:
            return "no shard to damage"
        shard = self.random.choice(shards)
        size = shard.stat().st_size
        how = self.random.choice(["truncated", "flipped", "removed", "emptied"])
        if how == "removed":
            shard.unlink()
        elif how == "emptied":
            shard.write_bytes(b"")
        elif how == "truncated":
            os.truncate(shard, self.random.randrange(size))
        else:
            at = self.random.randrange(size)
            with shard.open("r+b") as file:
                file.seek(at)
                old = file.read(1)
                file.seek(at)
                file.write(bytes([old[0] ^ (1 << self.random.randrange(8))]))
        return f"{shard.name} {how}"

    def test_every_fault_is_made_good_by_the_same_command(self):
        self.random = random.Random(OPTIONS["seed"])
        kinds = [("bake process", signal.SIGKILL), ("bake process", signal.SIGSEGV), ("bake process", signal.SIGSTOP),
                 ("worker rank", signal.SIGKILL), ("rank 0", signal.SIGKILL), ("mpirun", signal.SIGKILL),
                 ("mpirun", signal.SIGUSR1), ("mpirun", signal.SIGTERM)]
        counts = {}
        inflicted = 0
        while inflicted < OPTIONS["faults"]:
            out = self.work / f"out{inflicted}"
            fault, ranks = self.random.choice(kinds), self.random.choice([2, 3])
            launch = Launch(self.program, self.bake(out), ranks)
            happened = self.inflict(launch, fault, self.random.uniform(0.25, 1) * self.seconds)
            code, log = launch.wait()
            context = f"seed {OPTIONS['seed']}, fault {inflicted}: {fault[0]} {fault[1].name}, exit {code}"
            if happened and fault[0] == "bake process":
                self.assertEqual(code, 0, f"{context}: a bake goes on without one of its processes\n{log}")
            # A program that is still being loaded knows no signal yet.
            if happened and fault[1] == signal.SIGUSR1 and "content files" in log:
                self.assertIn(code, (0, 75), f"{context}\n{log}")
            if self.random.random() < 0.3:
                context += ", " + self.damage(out)
            self.expect_whole(out, self.random.choice([1, 2, 3]), context)
            if happened:
                inflicted += 1
                name = f"{fault[0]} {fault[1].name}"
                counts[name] = counts.get(name, 0) + 1
            subprocess.run(["rm", "-rf", out], check=True)
        print(f"seed {OPTIONS['seed']}, {inflicted} faults: {counts}")

    def test_a_rank_that_falls_silent_loses_its_cells(self):
        out = self.work / "silent"
        launch = Launch(self.program, [*self.bake(out), "--silence", 5], 3)
        while launch.process.poll() is None and len(list(out.glob("shards/c_*.h5"))) < 5:
            time.sleep(0.01)
        os.kill(launch.pids("worker rank")[-1], signal.SIGSTOP)
        code, log = launch.wait()
        self.assertEqual(code, 0, log)
        self.assertIn("nothing heard of rank", log)
        self.assertEqual(harness.lod_hashes(self.program.info(out / "scene.xml")), self.undisturbed)
        self.program.succeed("verify", out / "scene.xml")

    def test_ranks_that_fall_silent_before_cells_are_baked_end_the_launch(self):
        out = self.work / "silent_survey"
        launch = Launch(self.program, [*self.bake(out), "--silence", 5], 3)
        ranks = []
        while launch.process.poll() is None and len(ranks) < 2:
            ranks = [pid for pid in launch.pids("worker rank") if descendants(pid)]
        for pid in ranks:  # with its bake process: it surveys
            for child, _ in descendants(pid):
                os.kill(child, signal.SIGSTOP)
            os.kill(pid, signal.SIGSTOP)
        code, log = launch.wait()
        self.assertEqual(code, 1, log)
        self.assertRegex(log, "nothing heard of rank|not every rank answered")
        self.expect_whole(out, 2, "after a rank fell silent")

    def test_a_full_disk_costs_cells_and_no_more(self):
        out = self.work / "small_disk"
        out.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "gigabake-test", out]
        if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode != 0:
            self.skipTest("mounting a small disk needs root")
        try:
            code, log = Launch(self.program, self.bake(out), 2).wait()
            self.assertIn(code, (1, 3), log)
            self.assertIn("No space left on device", log)
            subprocess.run(["mount", "-o", "remount,size=400m", out], check=True)
            self.expect_whole(out, 2, "after the disk had room again")
        finally:
            subprocess.run(["umount", out], check=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("executable")
    parser.add_argument("source")
    parser.add_argument("--faults", type=int, default=OPTIONS["faults"])
    parser.add_argument("--seed", type=int, default=OPTIONS["seed"])
    options, rest = parser.parse_known_args()
    Faults.executable = options.executable
    OPTIONS.update(faults=options.faults, seed=options.seed)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
