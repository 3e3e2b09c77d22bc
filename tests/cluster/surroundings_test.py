#!/usr/bin/env python3
"""Bakes in a faulty environment print one line that names the fault, without a long delay.

The faults are locks of other processes, limits, variables, a hostfile from Windows, a name that is no text, and a host
without /proc. Also tests the log and the message after a second Ctrl-C.

Usage: surroundings_test.py GIGABAKE SOURCE_DIR
"""
import fcntl
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness

IS_ROOT = os.geteuid() == 0
F_OFD_SETLK = 37
TIME = re.compile(r"20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ rank 0: .")


def may_unshare():
    return IS_ROOT and shutil.which("unshare") and subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "true"], capture_output=True, check=False).returncode == 0


class Surroundings(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(Path(sys.argv[1]).resolve())
        cls.source = cls.root / "terrain.glb"
        edge = 17
        corners = [[x, (x * y) % 3, y] for y in range(edge) for x in range(edge)]
        harness.write_glb(cls.source, corners, harness.squares_of_grid(edge))
        os.chmod(cls.root, 0o755)

    def bake(self, out, *more):
        return ["bake", self.source, "-o", out, "--voxel-size", "0.5", "--cell-voxels", "8", "--threads", "2", *more]

    def new(self, name):
        return self.root / f"{self.id().rpartition('.')[2]}_{name}"

    def environment(self, **more):
        return {**os.environ, **harness.MPI_ENVIRONMENT, **more}

    def shell(self, script, *arguments, **variables):
        return harness.run(["bash", "-c", script, "bash", *map(str, arguments)], 100, env=self.environment(**variables))

    def refused_soon(self, command):
        start = time.monotonic()
        result = harness.run(command, 60, env=self.environment())
        self.assertLess(time.monotonic() - start, 8)  # a killed owner would get half a minute
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("is being baked into by", result.stderr)

    def held_lock(self, out, text):
        """Locks SCENE for this process. The lock file contains `text`."""
        out.mkdir()
        lock = open(out / ".lock", "w+")
        self.addCleanup(lock.close)
        lock.write(text)
        lock.flush()
        fcntl.fcntl(lock, F_OFD_SETLK, struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))

    def as_another_user(self, *arguments, before=()):
        program = self.root / "program"  # a copy that another user may run
        if not program.exists():
            shutil.copy(self.program.executable, program)
        return harness.run([*before, "setpriv", "--reuid", "12002", "--regid", "12345", "--clear-groups", program,
                            *arguments], 100, env=self.environment(HOME=str(self.root)))

    @unittest.skipUnless(IS_ROOT, "expected root, whom no limit of processes binds, to be another user")
    def test_a_limit_of_processes_is_named(self):
        for limit in (2, 6):
            out = self.new(f"out{limit}")
            out.mkdir()
            os.chown(out, 12002, 12345)
            result = self.as_another_user(*self.bake(out), before=["prlimit", f"--nproc={limit}"])
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn(f"ulimit -u, which is {limit}", result.stderr.splitlines()[-1])

    # Regression of 2026-11-25: a bake waited for a lock of a process that it cannot see.
    def test_a_holder_out_of_sight_is_not_waited_for(self):
        nobody = 2**22 + 1  # no process has that number
        for name, text in (("old", ""), ("elsewhere", "namespace pid:[1]\n")):
            out = self.new(name)
            self.held_lock(out, f"process {nobody} on {os.uname().nodename} since 2026-11-25T00:00:00Z\n{text}")
            self.refused_soon([self.program.executable, *self.bake(out)])

    @unittest.skipUnless(may_unshare(), "expected root and unshare")
    def test_a_live_holder_in_another_pid_namespace_is_refused_at_once(self):
        out = self.new("out")
        holder = harness.Started([self.program.executable, "bake", self.source, "-o", out, "--voxel-size", "0.02"],
                                 env=self.environment())
        self.addCleanup(holder.end)
        for _ in range(200):
            if (out / ".lock").exists() and (out / ".lock").stat().st_size:
                break
            time.sleep(0.05)
        os.kill(holder.pid, signal.SIGSTOP)
        self.refused_soon(["unshare", "--mount", "--pid", "--fork", "--mount-proc", self.program.executable,
                           *self.bake(out)])
        os.chmod(out / ".lock", 0o666)
        start = time.monotonic()
        hides = ["unshare", "--mount", "bash", "-c", 'mount -t proc -o hidepid=2 proc /proc && exec "$@"', "bash"]
        result = self.as_another_user(*self.bake(out), before=hides)
        self.assertLess(time.monotonic() - start, 8)
        self.assertIn("is being baked into by", result.stderr)

    @unittest.skipUnless(IS_ROOT, "expected root, to be another user")
    def test_a_lock_that_another_member_of_the_group_left_keeps_nobody_out(self):
        out = self.new("out")
        out.mkdir()
        os.chown(out, 12001, 12345)
        os.chmod(out, 0o2775)
        (out / ".lock").write_text("process 1 on elsewhere since 2026-11-25T00:00:00Z\n")
        os.chown(out / ".lock", 12001, 12345)
        os.chmod(out / ".lock", 0o644)
        result = self.as_another_user(*self.bake(out))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([p.name for p in out.glob(".lock*")], [])

    def test_metrics_are_utf8_for_any_name(self):
        out = Path(os.fsdecode(os.fsencode(str(self.new("out"))) + b"\xff\xe2\x82 \xc3\xa4"))
        metrics = self.new("metrics.prom")
        self.assertEqual(subprocess.run([self.program.executable, *self.bake(out, "--metrics", metrics)], check=False,
                                        capture_output=True, env=self.environment()).returncode, 0)
        self.assertIn("\ufffd\ufffd ä", metrics.read_text(encoding="utf-8"))

    def test_a_tmpdir_that_is_not_there_is_named(self):
        for folder in ("/no/such/folder", "/proc"):
            result = harness.run([self.program.executable, "plan", self.source, "--voxel-size", "0.5"], 60,
                                 env=self.environment(TMPDIR=folder))
            self.assertEqual(result.returncode, 1)
            errors = result.stderr.splitlines()
            self.assertIn("TMPDIR", errors[-1])
            self.assertIn(folder, errors[-1])

    def test_a_hostfile_from_windows_is_named(self):
        for name, content in (("crlf", b"localhost slots=1\r\n"), ("bom", b"\xef\xbb\xbflocalhost slots=1\n")):
            hosts = self.new(name)
            hosts.write_bytes(content)
            starter = Path(sys.argv[2]).resolve() / "cluster/gigabake-mpirun"
            result = harness.run([starter, hosts, *self.bake(self.new("out"))], 60,
                                 env=self.environment(GIGABAKE=str(self.program.executable)))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1)
            self.assertIn(str(hosts), result.stderr)

    # Regression of 2026-11-25: 16 tiles remained at 0 for 90 s, and no cause was printed.
    @unittest.skipUnless(may_unshare(), "expected root and unshare")
    def test_without_proc_the_cause_is_printed(self):
        start = time.monotonic()
        result = harness.run(["unshare", "--mount", "bash", "-c", 'mount -t tmpfs none /proc && exec "$@"', "bash",
                              self.program.executable, *self.bake(self.new("out"))], 100, env=self.environment())
        self.assertLess(time.monotonic() - start, 20)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("a bake needs /proc to be mounted", result.stderr.splitlines()[-1])

    # Regression of 2026-11-25: the death of a process that scans tiles was not reported.
    def test_a_process_that_dies_while_tiles_are_scanned_is_reported(self):
        large = self.new("large.glb")
        edge = 1000
        x, y = numpy.meshgrid(numpy.arange(edge), numpy.arange(edge))
        harness.write_glb(large, numpy.stack([x, x * y % 3, y], -1).reshape(-1, 3), harness.squares_of_grid(edge))
        plan = harness.Started([self.program.executable, "plan", large, "--voxel-size", "0.5", "--no-measure"],
                               env=self.environment())
        self.addCleanup(plan.end)
        children = Path(f"/proc/{plan.pid}/task/{plan.pid}/children")
        for _ in range(5000):
            if plan.poll() is None and (words := children.read_text().split()):
                os.kill(int(words[0]), signal.SIGKILL)
                break
            time.sleep(0.001)
        self.assertEqual(plan.wait(100), 0)
        self.assertIn("the bake process of rank 0 is started again: killed by signal 9 (SIGKILL)", plan.said())

    def test_lines_of_a_log_have_time_and_rank(self):
        result = self.program.run(*self.bake(self.new("log")))
        lines = [line for line in result.stderr.splitlines() if "triangles in" in line or "cells, " in line]
        self.assertGreaterEqual(len(lines), 2, result.stderr)
        for line in lines:
            self.assertRegex(line, TIME)
        result = self.program.run(*self.bake(self.new("plain"), "--no-log-time"))
        self.assertNotRegex(result.stderr, TIME)
        result = self.program.run(*self.bake(self.new("ranks")), ranks=2)
        self.assertRegex(result.stderr, TIME)

    # Regression of 2026-11-25: the second Ctrl-C printed no message.
    def test_a_second_interrupt_says_what_it_leaves(self):
        out = self.new("out")
        bake = harness.Started([self.program.executable, "bake", self.source, "-o", out, "--voxel-size", "0.01",
                                "--cell-voxels", "1024", "--threads", "1"], env=self.environment())
        self.addCleanup(bake.end)
        for seen in (lambda: list((out / "shards").glob(".c_*")) or list((out / "shards").glob("c_*")),
                     lambda: "cells in flight are finished" in bake.said()):
            until = time.monotonic() + 200
            while not seen() and time.monotonic() < until:
                time.sleep(0.02)
            bake.send_signal(signal.SIGINT)
        self.assertEqual(bake.wait(30), -signal.SIGINT)
        self.assertRegex(bake.said(), r"\ngigabake: stopped immediately, .*; the same command ")


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
