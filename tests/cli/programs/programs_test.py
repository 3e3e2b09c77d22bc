#!/usr/bin/env python3
"""The output of programs is shown and kept if a test fails, and removed if all tests pass.

Regression of 2026-11-22: a window closed in a test on a loaded machine, and no output explained it.

Usage: programs_test.py GIGABAKE SOURCE_DIR
"""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import programs

SUPPORT = Path(__file__).resolve().parents[1] / "support"
SCRIPT = """
import subprocess, sys, time, unittest
sys.path.insert(0, {here!r})
import programs

def say(text, then=""):
    return [sys.executable, "-c", f"import sys, time; print({{text!r}}, file=sys.stderr, flush=True); {{then}}"]

class Some(unittest.TestCase):
    def test_that_passes(self):
        self.assertEqual(programs.run(say("well")).returncode, 0)

    {more}

programs.main(argv=sys.argv[:1])
"""
FAILS = """
    def test_that_fails(self):
        self.assertEqual(programs.run(say("because of this", "sys.exit(3)")).returncode, 0)
"""
HANGS = """
    def test_that_waits_in_vain(self):
        programs.run(say("hanging here", "time.sleep(60)"), timeout=2)
"""
STARTED = """
    def test_of_a_program_that_runs(self):
        process = programs.Started(say("running", "time.sleep(60)"))
        self.addCleanup(process.end)
        while "running" not in process.said():
            time.sleep(0.01)
        with self.subTest("a part"):
            self.fail("the window has closed")
"""


class Programs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def run_script(self, more):
        script = self.root / "made_test.py"
        script.write_text(SCRIPT.format(here=str(SUPPORT), more=more.strip()))
        return subprocess.run([sys.executable, script, self.root / "gigabake"], capture_output=True, text=True,
                              timeout=120, check=False)

    def kept(self):
        return [path.read_text() for path in sorted((self.root / "Testing/programs").glob("made_test-*.txt"))]

    def test_nothing_stays_of_tests_that_pass(self):
        result = self.run_script("")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("well", result.stderr)
        self.assertEqual(self.kept(), [])

    def test_what_was_said_is_shown_and_kept_beside_a_failure(self):
        for more, said in ((FAILS, "[exit code 3]\nbecause of this"), (HANGS, "[no end within 2 s]\nhanging here"),
                           (STARTED, "running")):
            result = self.run_script(more)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn(said, result.stderr)
            self.assertIn(str(self.root / "Testing/programs/made_test-"), result.stderr)
            self.assertNotIn("well", result.stderr.replace("test_that_passes", ""))
            self.assertTrue(any(said in text for text in self.kept()), self.kept())

    def test_of_much_the_end_is_shown_and_all_is_kept(self):
        self.run_script(FAILS.replace('"because of this"', '"much " * 10000 + "end"'))
        self.assertTrue(any(text.count("much") == 10000 for text in self.kept()))

    def test_how_far_a_program_was_is_no_line_of_what_it_said(self):
        # Regression of 2026-11-23: on a slow machine a progress line preceded the error.
        said = ("reading the tileset: 30 %\nplanning: 3 of 17 tiles\nwriting the image: 0 s\n"
                "sharing: 2 min 5 s\ngigabake: p.exr: cannot write: 5 shards\n")
        self.assertEqual(programs.lines_of(said), ["gigabake: p.exr: cannot write: 5 shards"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
