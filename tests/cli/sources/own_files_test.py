#!/usr/bin/env python3
"""A command never writes over its inputs, over another bake or over a file of another program.

Usage: own_files_test.py GIGABAKE SOURCE_DIR
"""
import contextlib
import json
import os
import shutil
import signal
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness


class OwnFilesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.mesh = self.root / "source" / "square.obj"
        self.mesh.parent.mkdir()
        self.mesh.write_text("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4\n")
        self.out = self.root / "out"

    def bake(self, *arguments, source=None, out=None):
        return PROGRAM.run("bake", source or self.mesh, "-o", out or self.out, "--voxel-size", 1, *arguments)

    def contents(self):
        return {path: path.read_bytes() for path in self.root.rglob("*") if path.is_file()}

    def refused(self, *words, run=None, **options):
        before = self.contents()
        result = run() if run else self.bake(*options.pop("arguments", ()), **options)
        self.assertEqual(result.returncode, 1, result)
        lines = result.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, lines)
        for word in words:
            self.assertIn(word, lines[0])
        self.assertEqual(self.contents(), before)

    # Regression of 2026-11-25: --report and --metrics replaced the source.
    def test_reports_replace_nothing_but_reports(self):
        link, hard = self.root / "link.json", self.root / "hard.json"
        link.symlink_to(self.mesh)
        os.link(self.mesh, hard)
        notes = self.root / "notes.json"
        notes.write_text("mine")
        for option in ("--report", "--metrics"):
            for name in (self.mesh, link, hard, notes, self.out / "scene.xml", self.out / "journal",
                         self.out / "shards" / "r.json", "/dev/null"):
                self.refused(option, arguments=(option, name))
        self.refused("belongs to", arguments=("--report", self.mesh.parent / "r.json"), source=self.mesh.parent)
        report = self.root / "r.json"
        self.refused("--metrics", arguments=("--report", report, "--metrics", report))
        for _ in range(2):  # the second run replaces the command's own files
            result = self.bake("--report", report, "--metrics", self.root / "m.prom")
            self.assertEqual(result.returncode, 0, result)
        self.assertIn("scene", json.loads(report.read_text()))
        self.refused("belongs to", arguments=("--report", next((self.out / "shards").iterdir())))

    def test_answers_are_not_written_over_questions_or_the_scene(self):
        self.assertEqual(self.bake().returncode, 0)
        places = self.root / "places.csv"
        places.write_text("x,y\n1,1\n")
        for name in (places, self.out / "scene.xml"):
            self.refused("-o", run=lambda name=name: PROGRAM.run("query", self.out, "--heights", places, "-o", name))

    # Regression of 2026-11-25: a folder of sources, and the shards of another bake, were accepted as SCENE.
    def test_a_bake_goes_into_no_folder_of_sources_or_shards(self):
        self.refused("holds sources", "square.obj", out=self.mesh.parent)
        other = self.root / "other"
        self.assertEqual(self.bake(out=other).returncode, 0)
        for inner in (other / "shards", other / "shards" / "new"):
            inner.mkdir(exist_ok=True)
            self.refused("belongs to the bake in", out=inner)
        self.out.mkdir()
        (self.out / "notes.json").write_text("{}")
        self.assertEqual(self.bake().returncode, 0)
        self.assertEqual(self.bake().returncode, 0)

    def test_a_link_under_a_name_of_the_bake_is_refused(self):
        thesis = self.root / "thesis.tex"
        thesis.write_text("mine")
        for name in ("journal", ".lock"):
            (self.out / name).unlink(missing_ok=True)
            self.out.mkdir(exist_ok=True)
            (self.out / name).symlink_to(thesis)
            result = self.bake()
            self.assertEqual(result.returncode, 1, result)
            self.assertIn("is a link to another file", result.stderr)
            self.assertEqual(thesis.read_text(), "mine")
            (self.out / name).unlink()

    # Regression of 2026-11-25: the temporary folder of a killed plan was never removed.
    def test_a_killed_plan_leaves_nothing_for_long(self):
        temporary = self.root / "tmp"
        temporary.mkdir()
        source = PROGRAM.sample(self.root / "sample", size=192, tiles=3)
        environment = dict(os.environ, TMPDIR=str(temporary), **harness.MPI_ENVIRONMENT)
        def folders():
            return [path for path in temporary.iterdir() if path.name.startswith("gigabake-")]
        plan = harness.Started([PROGRAM.executable, "plan", source, "--voxel-size", "0.05", "--threads", "1"],
                               env=environment)
        # A folder gets its final name once it is locked; a plan that is stopped before cannot be cleaned up after.
        for _ in range(3000):
            if any(path.name.startswith("gigabake-plan-") for path in folders()):
                break
            time.sleep(0.01)
        self.assertEqual(len(folders()), 1)
        os.kill(plan.pid, signal.SIGSTOP)
        small = [PROGRAM.executable, "plan", self.mesh, "--voxel-size", "1"]
        self.assertEqual(harness.run(small, env=environment).returncode, 0)
        self.assertEqual(len(folders()), 1)  # the folder of a running plan stays
        self.assertIsNone(plan.poll())
        os.kill(plan.pid, signal.SIGKILL)
        plan.wait()
        self.assertEqual(len(folders()), 1)
        self.assertEqual(harness.run(small, env=environment).returncode, 0)
        self.assertEqual(folders(), [])

    # Regression of 2026-11-26: each killed export left its temporary file or folder for good.
    def test_a_killed_export_leaves_nothing_after_the_next(self):
        source = PROGRAM.sample(self.root / "sample", size=256)
        PROGRAM.succeed("bake", source, "-o", self.out, "--voxel-size", 0.5, "-q")
        exports = self.root / "exports"
        exports.mkdir()
        for name, again in (("tiles", ["--update"]), ("points.ply", []), ("tiles.3tz", [])):
            command = ["export", self.out, "-o", exports / name, "-q"] + ["--to", "3dtiles"] * (name == "tiles")
            def temporaries():
                return [path.name for path in exports.iterdir() if path.name.endswith(".part")]
            # An unlocked temporary has no owner: another export may remove it, and its owner makes another.
            export = stopped_while(command, lambda: any(is_locked(exports / path) for path in temporaries()),
                                   lambda: remove(exports / name))
            self.assertEqual(len(temporaries()), 1, name)
            PROGRAM.succeed(*command)
            self.assertEqual(len(temporaries()), 1, "that of a living export stays")
            os.kill(export.pid, signal.SIGKILL)
            export.wait()
            self.assertEqual(len(temporaries()), 1, name)
            if name == "tiles.3tz":
                (exports / name).unlink()  # an archive is not replaced
            PROGRAM.succeed(*command, *again)
            self.assertEqual(temporaries(), [], name)


def remove(path):
    shutil.rmtree(path) if path.is_dir() else path.unlink()


def is_locked(path):
    """Returns true if a process holds a lock on the file or folder `path`."""
    try:
        inode = str(path.stat().st_ino)
    except FileNotFoundError:
        return False
    locks = Path("/proc/locks").read_text().splitlines()
    return any(words[1] == "FLOCK" and words[5].split(":")[2] == inode for words in map(str.split, locks))


def has_stopped(process):
    """Returns true if all threads of `process` have stopped, or false if it ended before."""
    while process.poll() is None:
        states = set()
        for stat in Path(f"/proc/{process.pid}/task").glob("*/stat"):
            with contextlib.suppress(FileNotFoundError, ProcessLookupError):  # the thread ended
                states.add(stat.read_text().rpartition(")")[2].split()[0])
        if states == {"T"}:
            return True
        time.sleep(0.001)
    return False


def stopped_while(command, holds, remove_output):
    """Returns the program with arguments `command`, stopped while `holds()` is true.

    A signal arrives late, so `holds` is called again after the stop. A program that ended before is run again.
    """
    for _ in range(20):
        process = harness.Started([PROGRAM.executable, *command])
        while process.poll() is None:
            if holds():
                os.kill(process.pid, signal.SIGSTOP)
                if has_stopped(process) and holds():
                    return process
                os.kill(process.pid, signal.SIGCONT)
            time.sleep(0.0005)
        remove_output()
    raise AssertionError("always ended before it could be stopped: " + process.said())


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
