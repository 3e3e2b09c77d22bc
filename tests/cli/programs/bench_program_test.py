#!/usr/bin/env python3
"""`gigabake bench` starts gigabake-bench: where it is found, what passes through, and what holds without it.

Usage: bench_program_test.py GIGABAKE SOURCE_DIR
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

PROGRAM = Path(sys.argv[1]).resolve()
BENCH = PROGRAM.with_name("gigabake-bench")
COMMANDS = ["kernels", "bake", "schedule", "pack", "query", "render", "edit", "accuracy"]
SCHEDULE = ("bench", "schedule", "--cells", "20")


class BenchProgram(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.prefix = Path(folder.name)
        (self.prefix / "bin").mkdir()
        self.program = self.prefix / "bin/gigabake"
        shutil.copy(PROGRAM, self.program)

    def run_copy(self, *words):
        return harness.run((self.program, *words), 60)

    def script(self, text):
        """Writes a shell script in place of gigabake-bench."""
        file = self.prefix / "bin/gigabake-bench"
        file.write_text("#!/bin/bash\n" + text)
        file.chmod(0o755)

    def test_the_product_links_neither_embree_nor_gmp(self):
        def needed(program):
            text = subprocess.run(["readelf", "-d", program], capture_output=True, text=True, check=True).stdout
            return " ".join(re.findall(r"\(NEEDED\).*\[(.+?)\]", text))
        self.assertIn("libc.so", needed(PROGRAM))
        self.assertNotRegex(needed(PROGRAM), "embree|gmp")
        self.assertRegex(needed(BENCH), "gmp")

    def test_it_is_found_next_to_the_program_and_where_it_is_installed(self):
        for folder in ("bin", "libexec/gigabake"):
            (self.prefix / folder).mkdir(parents=True, exist_ok=True)
            copy = self.prefix / folder / "gigabake-bench"
            shutil.copy(BENCH, copy)
            result = self.run_copy(*SCHEDULE)
            self.assertEqual((result.returncode, result.stderr), (0, ""), folder)
            self.assertIn("dispatches/s", result.stdout)
            copy.unlink()

    def test_without_it_one_line_states_the_remedy(self):
        for words in (SCHEDULE, ("bench", "render", "--help")):
            result = self.run_copy(*words)
            self.assertEqual((result.returncode, result.stdout, result.stderr.count("\n")), (1, "", 1), result.stderr)
            for part in ("gigabake: bench: ", str(self.prefix / "bin"), str(self.prefix / "libexec/gigabake"),
                         "install the package gigabake-bench", "-DGIGABAKE_BENCH=ON"):
                self.assertIn(part, result.stderr)

    def test_without_it_help_manual_and_completion_list_its_commands(self):
        text = self.run_copy("bench", "--help").stdout
        listed = text.partition("Subcommands:\n")[2].partition("\n\n")[0]
        self.assertEqual(re.findall(r"(?m)^  (\w+)  ", listed), COMMANDS)
        self.assertEqual(text, harness.run((PROGRAM, "bench", "--help"), 60).stdout.replace(str(PROGRAM),
                                                                                            str(self.program)))
        result = self.run_copy("bench", "acuracy")
        self.assertEqual(result.returncode, 2)
        self.assertIn("did you mean accuracy?", result.stderr)
        result = self.run_copy("man", "bench", "render")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("along a flight", result.stdout)
        result = self.run_copy("completion", "bash")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("gigabake bench accuracy", result.stdout)

    def test_arguments_streams_and_exit_status_pass_through(self):
        self.script("shift; printf '%s\\n' \"$@\"; cat; echo to-stderr >&2; exit 42\n")
        words = ["pack", "--json", "a b", "", "--", "--help", "bench", "pack", "-x", "++", "--repeats=2"]
        result = subprocess.run([self.program, "bench", *words], input="to-stdin\n", capture_output=True, text=True,
                                timeout=60, check=False)
        self.assertEqual(result.stdout.splitlines(), [*words, "to-stdin"])
        self.assertEqual((result.returncode, result.stderr), (42, "to-stderr\n"))
        result = subprocess.run([self.program, "bench", "pack", "--", "-x"], input="", capture_output=True, text=True,
                                timeout=60, check=False)
        self.assertEqual(result.stdout.splitlines(), ["pack", "--", "-x"])

    def test_signals_reach_the_benchmark_and_its_death_is_seen(self):
        self.script("trap 'exit 7' INT; echo ready; while :; do sleep 0.05; done\n")
        for sent, code in ((signal.SIGINT, 7), (signal.SIGTERM, -signal.SIGTERM)):
            with subprocess.Popen([self.program, *SCHEDULE], stdout=subprocess.PIPE, text=True) as process:
                process.stdout.readline()
                os.kill(process.pid, sent)
                self.assertEqual(process.wait(60), code)

    def test_another_version_is_refused(self):
        version = harness.run((PROGRAM, "--version"), 60).stdout
        self.assertEqual(harness.run((BENCH, "--version"), 60).stdout, version)
        result = harness.run((BENCH, "--caller=0.0.1", *SCHEDULE[1:]), 60)
        self.assertEqual((result.returncode, result.stdout, result.stderr.count("\n")), (1, "", 1), result.stderr)
        for part in ("0.0.1", version.splitlines()[0].removeprefix("gigabake "), "build or install both together"):
            self.assertIn(part, result.stderr)


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
