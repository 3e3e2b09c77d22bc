#!/usr/bin/env python3
"""Bakes survive random faults: repeating the same command always ends with the voxels of an undisturbed bake.

Processes, ranks and mpirun are killed, stopped, starved of memory or drained at random moments, also in their first
second. Shards are damaged between runs. A source has a vertex a million kilometres away. No run may hang.

Usage: faults_test.py GIGABAKE SOURCE_DIR [--count N] [--seed N|random] [--size METRES]
"""
import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness

OPTIONS = {"count": 10, "seed": 20261120, "size": 192}
BAKE_PROCESS = "gigabake-bake"
# Time limits of the starter, for which no fault takes longer than MAX_S.
BOUNDS = {"GIGABAKE_END_S": "5", "GIGABAKE_QUIET_S": "12", "GIGABAKE_PAUSE_S": "0"}
# Seconds for the start of MPI. The starter's launches need a low limit: only there a rank is stopped in that time.
MPI_SECONDS_OF_STARTER, MPI_SECONDS = "8", "60"
MAX_S = 120  # ten times the duration on an idle machine
NO_MEMORY = "no memory"
RANK_LOST = 69

# (process, fault, moment): "start" is the first half second of the process.
KINDS = [("bake process", signal.SIGKILL, "later"), ("bake process", signal.SIGSEGV, "later"),
         ("bake process", signal.SIGSTOP, "later"), ("bake process", NO_MEMORY, "later"),
         ("worker rank", signal.SIGKILL, "later"), ("rank 0", signal.SIGKILL, "later"),
         ("rank 0", signal.SIGSTOP, "later"), ("mpirun", signal.SIGKILL, "later"), ("mpirun", signal.SIGUSR1, "later"),
         ("mpirun", signal.SIGTERM, "later"),
         ("worker rank", signal.SIGKILL, "start"), ("rank 0", signal.SIGKILL, "start"),
         ("worker rank", signal.SIGSTOP, "start"), ("rank 0", signal.SIGSTOP, "start"),
         ("bake process", signal.SIGKILL, "start"), ("mpirun", signal.SIGKILL, "start")]


def children(pid):
    """Returns the child processes of any thread of pid, as (pid, name)."""
    found = []
    try:
        files = list(Path("/proc").glob(f"{pid}/task/*/children"))
    except OSError:
        return found  # pid has just ended
    for path in files:
        try:
            for child in path.read_text().split():
                found.append((int(child), Path(f"/proc/{child}/comm").read_text().strip()))
        except OSError:
            continue  # the thread or the child has just ended
    return found


def descendants(pid):
    """Returns every process below pid, as (pid, name). It reads few files, since faults must hit short steps."""
    below = children(pid)
    return below + [process for child, _ in below for process in descendants(child)]


def rank_of(pid):
    try:
        environment = Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return None
    for line in environment:
        if line.startswith(b"OMPI_COMM_WORLD_RANK="):
            return int(line.partition(b"=")[2])
    return None


def scans(pid):
    """Returns whether a bake process has threads that scan tiles. Before MPI, it has a second thread for a moment."""
    try:
        for _ in range(3):
            if len(os.listdir(f"/proc/{pid}/task")) == 1:
                return False
            time.sleep(0.002)
        return True
    except FileNotFoundError:
        return False


class Launch:
    """A running `gigabake bake`, started by mpirun, or by the starter that repeats launches that died or hung."""

    def __init__(self, program, arguments, ranks, starter=None):
        command = ["mpirun", "-n", str(ranks)]
        if starter:
            self.hosts = tempfile.NamedTemporaryFile("w", prefix="hosts")
            self.hosts.write(f"localhost slots={ranks}\n")
            self.hosts.flush()
            command = [str(starter), self.hosts.name]
        command += ([] if starter else [program.executable]) + list(map(str, arguments))
        self.log = harness.TRANSCRIPT.file(command)
        self.start = time.monotonic()
        environment = dict(os.environ, **harness.MPI_ENVIRONMENT, **BOUNDS, GIGABAKE=str(program.executable),
                           GIGABAKE_MPI_SECONDS=MPI_SECONDS_OF_STARTER if starter else MPI_SECONDS)
        self.process = subprocess.Popen(command, stdout=self.log, stderr=subprocess.STDOUT, start_new_session=True,
                                        env=environment)

    def pids(self, what):
        below = descendants(self.process.pid)
        if what == "mpirun":
            return [self.process.pid]
        if what == "bake process":
            return [pid for pid, name in below if name == BAKE_PROCESS]
        ranks = {rank_of(pid): pid for pid, name in below if name != BAKE_PROCESS and rank_of(pid) is not None}
        if what == "rank 0":
            return [ranks[0]] if 0 in ranks else []
        return [pid for rank, pid in ranks.items() if rank != 0]

    def wait(self, seconds=MAX_S):
        try:
            code = self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            code = f"none after {seconds} s: it hangs"
            for pid, _ in descendants(self.process.pid) + [(self.process.pid, "")]:
                os.kill(pid, signal.SIGKILL)
        self.log.seek(0)
        with self.log:
            return code, self.log.read()


class Faults(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(cls.executable)
        cls.program.succeed("sample", cls.root / "terrain", "--size", OPTIONS["size"], "--seed", 5)
        start = time.monotonic()
        cls.undisturbed = harness.lod_hashes(cls.program.bake(*cls.arguments(cls.root / "whole"), ranks=2))
        cls.seconds = time.monotonic() - start
        cls.starter = Path(cls.source) / "cluster/gigabake-mpirun"

    @classmethod
    def arguments(cls, out):
        # The stall exceeds 2 s: a busy disk may delay the flush of a shard for seconds. After three such stalls the
        # cell would count as failed (2026-11-22).
        return (cls.root / "terrain/tileset.json", out, 0.25, "--cell-voxels", 64, "--stall", 10, "--silence", 5,
                "--threads", 1)

    @classmethod
    def bake(cls, out):
        source, out, voxel_size, *more = cls.arguments(out)
        return ["bake", source, "-o", out, "--voxel-size", voxel_size, *more]

    def expect_whole(self, out, ranks, context):
        """Repeats the command unless the bake is complete, and checks the result."""
        code, log = Launch(self.program, self.bake(out), ranks).wait()
        self.assertEqual(code, 0, f"{context}\n{log}")
        scene = out / "scene.xml"
        self.assertEqual(harness.lod_hashes(self.program.info(scene)), self.undisturbed, f"{context}\n{log}")
        self.program.succeed("verify", scene)
        self.assertEqual([p for p in out.rglob("*.part")], [], context)

    def inflict(self, launch, kind, after_s):
        """Returns False if the bake ended before the fault. Its duration then bounds the moments of later faults.

        The first bake may have been slow: without the new bound, all faults would come too late.
        """
        who, what, when = kind
        start = time.monotonic()
        while when == "start" and launch.process.poll() is None and not launch.pids(who):
            pass
        try:
            launch.process.wait(self.random.uniform(0, 0.5) if when == "start" else after_s)
            type(self).seconds = time.monotonic() - start
            return False
        except subprocess.TimeoutExpired:
            pass
        pids = launch.pids(who)
        if launch.process.poll() is not None or not pids:
            return False
        pid = self.random.choice(pids)
        try:
            if what == NO_MEMORY:  # little more than the process has
                size = 4096 * int(Path(f"/proc/{pid}/statm").read_text().split()[0])
                maximum = size + self.random.randrange(1, 1 << 22)
                resource.prlimit(pid, resource.RLIMIT_AS, (maximum, maximum))
            else:
                os.kill(pid, what)
        except (FileNotFoundError, ProcessLookupError):
            return False
        return True

    def damage(self, out):
        """Damages one shard between runs."""
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

    def expect_code(self, code, log, kind, context):
        """Checks the exit code of a launch after its fault."""
        who, what, _ = kind
        if who == "bake process" and what != NO_MEMORY:
            self.assertEqual(code, 0, f"{context}: a bake continues without one of its processes\n{log}")
        elif what == NO_MEMORY:
            self.assertIn(code, (0, 1, 3), f"{context}\n{log}")
        elif who != "mpirun":
            self.assertEqual(code, 0, f"{context}: the starter launches again\n{log}")
        # A program that is still being loaded does not handle signals yet.
        elif what == signal.SIGUSR1 and "content files" in log:
            self.assertIn(code, (0, 75), f"{context}\n{log}")

    def test_every_fault_is_made_good_by_the_same_command(self):
        self.random = random.Random(OPTIONS["seed"])
        counts, inflicted, slowest = {}, 0, 0.0
        while inflicted < OPTIONS["count"]:
            out = self.root / f"out{inflicted}"
            kind, ranks = self.random.choice(KINDS), self.random.choice([2, 3])
            name = f"{kind[0]} {getattr(kind[1], 'name', kind[1])} {kind[2]}"
            starter = self.starter if kind[0] in ("worker rank", "rank 0") else None
            launch = Launch(self.program, self.bake(out), ranks, starter)
            happened = self.inflict(launch, kind, self.random.uniform(0.25, 1) * self.seconds)
            code, log = launch.wait()
            seconds = time.monotonic() - launch.start
            context = f"seed {OPTIONS['seed']}, fault {inflicted}: {name}, exit {code}"
            self.assertIsInstance(code, int, f"{context}\n{log}")
            if happened:
                self.expect_code(code, log, kind, context)
            if self.random.random() < 0.3:
                context += ", " + self.damage(out)
            self.expect_whole(out, self.random.choice([1, 2, 3]), context)
            if happened:
                inflicted += 1
                counts[name] = counts.get(name, 0) + 1
                slowest = max(slowest, seconds)
                if OPTIONS["count"] > 10:
                    print(f"{inflicted} {name}: exit {code}, {seconds:.1f} s", flush=True)
            subprocess.run(["rm", "-rf", out], check=True)
        print(f"seed {OPTIONS['seed']}, {inflicted} faults, the longest took {slowest:.1f} s: {counts}")

    def test_bake_processes_that_die_before_they_begin_are_started_again(self):
        """Regression of 2026-11-22: bakes failed with code 1 if a process of a rank without a tile to scan died."""
        tile, out = self.root / "tile.glb", self.root / "newborn"
        harness.write_glb(tile, [(0, 0, 0), (8, 0, 0), (0, 0, -8)], [(0, 1, 2)], [(200, 100, 50, 255)] * 3)
        launch = Launch(self.program, ["bake", tile, "-o", out, "--voxel-size", 0.25, "--cell-voxels", 8], 3)
        killed = set()
        while launch.process.poll() is None and len(killed) < 2:  # a third death in one rank may end the bake
            for pid in sorted(set(launch.pids("bake process")) - killed)[:2 - len(killed)]:
                os.kill(pid, signal.SIGKILL)
                killed.add(pid)
        code, log = launch.wait()
        self.assertEqual((code, len(killed)), (0, 2), log)
        self.program.succeed("verify", out / "scene.xml")

    def test_a_rank_that_falls_silent_loses_its_cells(self):
        out = self.root / "silent"
        launch = Launch(self.program, self.bake(out), 3)
        while launch.process.poll() is None and len(list(out.glob("shards/c_*.h5"))) < 5:
            time.sleep(0.01)
        os.kill(launch.pids("worker rank")[-1], signal.SIGSTOP)
        code, log = launch.wait()
        self.assertEqual(code, 0, log)
        self.assertIn("no message from rank", log)
        self.assertEqual(harness.lod_hashes(self.program.info(out / "scene.xml")), self.undisturbed)
        self.program.succeed("verify", out / "scene.xml")

    def stop_scanning_ranks(self, launch, out):
        """Stops each rank, and its bake process, as soon as the bake process scans tiles.

        Rank 0 locks the scene's folder after the start of MPI. A rank that is stopped before would end that start.
        """
        while launch.process.poll() is None and not (out / ".lock").exists():
            time.sleep(0.001)
        waiting = {}
        while launch.process.poll() is None and len(waiting) < 2:
            waiting = {pid: below[0][0] for pid in launch.pids("worker rank") if (below := children(pid))}
        while launch.process.poll() is None and waiting:
            for rank in [rank for rank, process in waiting.items() if scans(process)]:
                for pid in (waiting.pop(rank), rank):
                    os.kill(pid, signal.SIGSTOP)

    @classmethod
    def bake_of_tiles(cls, out):
        """Returns a bake of 1,024 tiles, whose scan takes most of the time."""
        source = cls.root / "tiles"
        if not source.exists():
            cls.program.succeed("sample", source, "--size", 512, "--tiles", 32, "--ground-step", 0.5, "--texel", 4)
        return ["bake", source / "tileset.json", "-o", out, "--voxel-size", 4, "--cell-voxels", 64, "--stall", 10,
                "--silence", 5, "--threads", 1]

    def expect_whole_tiles(self, out):
        for folder in (out, self.root / "whole_tiles"):
            code, log = Launch(self.program, self.bake_of_tiles(folder), 2).wait()
            self.assertEqual(code, 0, log)
        whole = harness.lod_hashes(self.program.info(self.root / "whole_tiles/scene.xml"))
        self.assertEqual(harness.lod_hashes(self.program.info(out / "scene.xml")), whole)

    def silence_in_scan(self, name, happened, *launcher):
        """Returns the folder, exit code and log of a bake whose ranks are stopped while they scan tiles.

        If the scan ends before the ranks are stopped, the bake is repeated.
        """
        for attempt in range(5):
            out = self.root / f"{name}_{attempt}"
            launch = Launch(self.program, self.bake_of_tiles(out), 3, *launcher)
            self.stop_scanning_ranks(launch, out)
            code, log = launch.wait()
            if happened(code, log):
                break
            self.assertEqual(code, 0, log)
        return out, code, log

    def test_ranks_that_fall_silent_before_cells_are_baked_end_the_launch(self):
        out, code, log = self.silence_in_scan("silent_scan", lambda code, log: code != 0)
        self.assertEqual(code, RANK_LOST, log)
        self.assertRegex(log, "no message from rank|not every rank answered")
        self.expect_whole_tiles(out)

    def test_the_starter_launches_again_where_a_rank_fell_silent_in_the_scan(self):
        """Regression of 2026-11-22: the launch ended with code 1 and was not repeated, like a bake that must fail."""
        out, code, log = self.silence_in_scan("silent_scan_again", lambda code, log: "relaunch 1" in log,
                                                self.starter)
        self.assertEqual(code, 0, log)
        self.assertIn("relaunch 1", log)
        self.expect_whole_tiles(out)

    def test_a_full_disk_costs_cells_and_no_more(self):
        out = self.root / "small_disk"
        out.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "gigabake-test", out]
        if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode != 0:
            self.skipTest("mounting a small disk needs root")
        try:
            code, log = Launch(self.program, self.bake(out), 2).wait()
            self.assertIn(code, (1, 3), log)
            self.assertIn("No space left on device", log)
            subprocess.run(["mount", "-o", "remount,size=400m", out], check=True)
            self.expect_whole(out, 2, "after the disk had space again")
        finally:
            subprocess.run(["umount", out], check=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("executable")
    parser.add_argument("source")
    parser.add_argument("--count", "--faults", type=int, default=OPTIONS["count"])
    parser.add_argument("--seed", default=OPTIONS["seed"], help="a number, or random: another one each time, printed")
    parser.add_argument("--size", type=int, default=OPTIONS["size"], help="of the terrain: cells follow its square")
    options, rest = parser.parse_known_args()
    Faults.executable, Faults.source = options.executable, options.source
    seed = random.SystemRandom().randrange(1 << 32) if options.seed == "random" else int(options.seed)
    OPTIONS.update(count=options.count, seed=seed, size=options.size)
    print(f"seed {seed}", flush=True)
    harness.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
