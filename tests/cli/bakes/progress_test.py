#!/usr/bin/env python3
"""Long commands report their progress on standard error only. SIGTERM and Ctrl-C stop them.

Usage: progress_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from programs import lines_of

SQUARE = [[0, 0, 0], [40, 0, 0], [40, 0, -40], [0, 0, -40]]
TWO = [0, 1, 2, 0, 2, 3]
DRAINED = 75
LOG_TIME = re.compile(r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ rank 0: (.*)$", re.M)
LOG_LINE = re.compile(r"[\d,]+ triangles in ")
# A stopped command ends after a second, or after ten on a busy machine; a hanging command never ends.
BOUND_S = 60


def tileset(root):
    return json.dumps({"asset": {"version": "1.0"}, "geometricError": 1, "root": root})


def tile(**members):
    return {"boundingVolume": {"sphere": [0, 0, 0, 100]}, "geometricError": 1, "refine": "ADD", **members}


class Progress(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.square = cls.root / "square.glb"
        harness.write_glb(cls.square, SQUARE, TWO)
        # All tiles use the same file: the tileset is slow to read and quick to write.
        child = json.dumps(tile(content={"uri": "square.glb"}))
        text = tileset(tile(children=["CHILD"])).replace('"CHILD"', ",".join([child] * 600000))
        cls.long = cls.root / "tileset.json"
        cls.long.write_text(text)

    def start(self, *arguments, **options):
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options}
        process = subprocess.Popen([PROGRAM.executable, *map(str, arguments)],
                                   env=dict(os.environ, **harness.MPI_ENVIRONMENT), **options)
        self.addCleanup(process.kill)
        return process

    def half_written(self):
        return [p for p in self.root.rglob("*") if ".part" in p.name and "killed" not in p.parts]

    def expect_stopped(self, process, signal_number, code, *told):
        """Expects one line, an empty standard output and no partial files. Returns the standard error."""
        begin = time.monotonic()
        process.send_signal(signal_number)
        out, err = process.communicate(timeout=BOUND_S)
        self.assertEqual((process.returncode, out), (code, ""), err)
        self.assertLess(time.monotonic() - begin, 20, "seconds until the end")
        last = err.splitlines()[-1]
        for text in told:
            self.assertIn(text, last)
        self.assertEqual(self.half_written(), [])
        return err

    def wait_for(self, condition, process):
        end = time.monotonic() + BOUND_S
        while not condition():
            self.assertIsNone(process.poll(), "it ended before it could be stopped")
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def test_a_long_tileset_is_stopped_while_it_is_read(self):
        """Fixed 2026-11-22: a million tiles of one file gave no output for a minute."""
        plan = self.start("plan", self.long, "--voxel-size", 1, "--json", "--local")
        first = plan.stderr.readline()
        self.assertRegex(first, r"^[a-z' .]+(: [0-9]+ tiles, [0-9]+ s|: [0-9]+ of 600000 tiles.*|: [0-9]+ s)$")
        self.expect_stopped(plan, signal.SIGTERM, 128 + signal.SIGTERM, "stopped by SIGTERM")

    def test_a_bake_is_asked_to_end_before_its_first_cell(self):
        out = self.root / "never"
        bake = self.start("bake", self.long, "-o", out, "--voxel-size", 1, "--local")
        bake.stderr.readline()
        self.expect_stopped(bake, signal.SIGTERM, DRAINED, "before the first cell", "same command again")
        self.assertFalse((out / "scene.xml").exists())

    def test_a_terminal_has_one_line_that_is_rewritten_and_ctrl_c_stops(self):
        master, slave = pty.openpty()

        def take_terminal():
            os.setsid()
            import fcntl
            import termios
            fcntl.ioctl(0, termios.TIOCSCTTY, 0)

        plan = self.start("plan", self.long, "--voxel-size", 1, "--local", stdin=slave, stderr=slave,
                          preexec_fn=take_terminal)
        os.close(slave)
        shown, begin = b"", time.monotonic()
        while shown.count(b"\r\x1b[K") < 5:
            self.assertTrue(select.select([master], [], [], BOUND_S)[0], shown)
            shown += os.read(master, 65536)
            if len(shown) and time.monotonic() - begin < 1:
                self.fail(f"printed within a second: {shown}")
        os.write(master, b"\x03")
        plan.wait(timeout=BOUND_S)
        self.assertEqual(plan.returncode, 128 + signal.SIGINT)
        os.set_blocking(master, False)
        try:
            while part := os.read(master, 65536):
                shown += part
        except OSError:
            pass
        os.close(master)
        self.assertIn(b"stopped by SIGINT", shown.splitlines()[-1])
        self.assertNotIn(b"\n", shown[:shown.index(b"stopped by")].replace(b"^C", b"").strip())

    def log_on_terminal(self, *arguments):
        """Returns the lines that remain on the terminal, a pty, of a command that ends with 0."""
        master, slave = pty.openpty()
        process = self.start(*arguments, stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        shown = b""
        with open(master, "rb", buffering=0) as terminal:
            try:
                while part := terminal.read(65536):
                    shown += part
            except OSError:  # the other end is closed
                pass
        self.assertEqual(process.wait(timeout=BOUND_S), 0, shown)
        return re.sub(r"[^\n]*\r\x1b\[K", "", shown.decode().replace("\r\n", "\n"))

    def test_log_lines_have_times_where_no_terminal_shows_them(self):
        bake = ("bake", self.square, "--voxel-size", 1, "-o")
        logs = {name: self.log_on_terminal(*bake, self.root / name, *more)
                for name, more in (("terminal", ()), ("terminal_time", ("--log-time",)),
                                   ("terminal_plain", ("--no-log-time",)))}
        for name, more in (("pipe", ()), ("pipe_time", ("--log-time",)), ("pipe_plain", ("--no-log-time",))):
            logs[name] = PROGRAM.run(*bake, self.root / name, *more).stderr
        for name, log in logs.items():
            with self.subTest(name):
                self.assertRegex(log, LOG_LINE)
                with_time = "\n".join(LOG_TIME.findall(log))
                self.assertEqual(bool(LOG_LINE.search(with_time)), name in ("terminal_time", "pipe", "pipe_time"), log)
                if name not in ("terminal_time", "pipe", "pipe_time"):
                    self.assertEqual(with_time, "", log)

    def test_an_export_that_is_stopped_leaves_nothing(self):
        out = self.root / "out"
        PROGRAM.succeed("bake", self.square, "-o", out, "--voxel-size", 0.02, "--cell-voxels", 2048)
        for form, target in (("ply", "all.ply"), ("3dtiles", "tiles"), ("nvdb", "all.nvdb")):
            with self.subTest(form):
                export = self.start("export", out / "scene.xml", "--to", form, "-o", self.root / target)
                self.wait_for(lambda: self.half_written() != [], export)
                self.expect_stopped(export, signal.SIGTERM, 128 + signal.SIGTERM, "stopped by SIGTERM")
                self.assertFalse((self.root / target).exists())

    # Regression of 2026-11-22: `status` was wrong after Ctrl-C.
    def test_a_bake_that_drains_says_what_a_second_ctrl_c_does_and_status_says_how_it_ended(self):
        out = self.root / "killed"
        bake = self.start("bake", self.square, "-o", out, "--voxel-size", 0.05, "--cell-voxels", 16)
        self.wait_for(lambda: any(out.glob("shards/*.h5")), bake)
        bake.send_signal(signal.SIGINT)
        _, err = bake.communicate(timeout=BOUND_S)
        self.assertEqual(bake.returncode, DRAINED, err)
        self.assertIn("press Ctrl-C again to stop immediately", err)
        self.assertIn("drained", PROGRAM.run("status", out).stdout)
        bake = self.start("bake", self.square, "-o", out, "--voxel-size", 0.05, "--cell-voxels", 16)
        shards = len(list(out.glob("shards/*.h5")))
        self.wait_for(lambda: len(list(out.glob("shards/*.h5"))) > shards, bake)
        bake.kill()
        bake.communicate(timeout=BOUND_S)
        self.assertIn("interrupted", PROGRAM.run("status", out).stdout)

    def test_tilesets_that_name_each_other_twice_are_refused_at_once(self):
        """Fixed 2026-11-22: 31 of them were refused after a minute."""
        folder = self.root / "doubling"
        folder.mkdir()
        harness.write_glb(folder / "square.glb", SQUARE, TWO)
        for i in range(31):
            both = [tile(content={"uri": f"t{i + 1}.json"})] * 2 if i < 30 else [tile(content={"uri": "square.glb"})]
            (folder / f"t{i}.json").write_text(tileset(tile(children=both)))
        begin = time.monotonic()
        result = PROGRAM.run("plan", folder / "t0.json", "--voxel-size", 1)
        self.assertEqual((result.returncode, len(lines_of(result.stderr))), (1, 1), result)
        self.assertIn("too often", result.stderr)
        self.assertLess(time.monotonic() - begin, 20)

    def test_what_is_quick_says_nothing_of_its_steps(self):
        result = PROGRAM.run("plan", self.square, "--voxel-size", 1, "--json")
        self.assertEqual(result.returncode, 0)
        json.loads(result.stdout)
        self.assertNotRegex(result.stderr, "planning|reading|inspecting")


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    sys.argv[1:] = sys.argv[3:]
    unittest.main(verbosity=2)
