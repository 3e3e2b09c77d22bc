"""Output of the programs that a test script starts: shown if a test fails, and kept until the script has passed.

A line and an exit code do not explain a failure that happens once, on another machine, under load.
"""
import atexit
import re
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

MAX_SHOWN = 20000


def folder():
    """Returns the folder Testing/programs next to the program under test, or a temporary folder."""
    beside = Path(sys.argv[1]).resolve().parent if len(sys.argv) > 1 else Path("/nowhere")
    try:
        kept = beside / "Testing" / "programs"
        kept.mkdir(parents=True, exist_ok=True)
    except OSError:  # the folder of an installed program
        kept = Path(tempfile.gettempdir())
    return kept


class Transcript:
    """The output files of programs, one per program in the order of their starts."""

    def __init__(self):
        self.files = []
        self.failed = False
        atexit.register(self.forget)

    def file(self, command):
        """Returns an open file for the output of a command."""
        name = f"{Path(sys.argv[0]).stem}-{time.time_ns()}-{len(self.files)}.txt"
        kept = open(folder() / name, "w+", encoding="utf-8", errors="replace")
        self.files.append((" ".join(map(str, command)), Path(kept.name)))
        return kept

    def add(self, command, end, *said):
        with self.file(command) as kept:
            kept.write(f"[{end}]\n" + "\n".join(as_text(part) for part in said if part))

    def show(self, first):
        """Prints the output of the programs from number `first` on."""
        self.failed = True
        for command, path in self.files[first:]:
            said = path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""
            cut = f"... {len(said) - MAX_SHOWN} characters more in the file\n" if len(said) > MAX_SHOWN else ""
            print(f"--- {command}\n--- output, also in {path}:\n{cut}{said[-MAX_SHOWN:]}", file=sys.stderr, flush=True)

    def forget(self):
        if not self.failed:
            for _, path in self.files:
                path.unlink(missing_ok=True)


TRANSCRIPT = Transcript()


def as_text(said):
    return said.decode(errors="replace") if isinstance(said, bytes) else said


def run(command, timeout=300, **options):
    """Calls subprocess.run() with text output, and records the output."""
    command = list(map(str, command))
    try:
        result = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False, **options)
    except subprocess.TimeoutExpired as late:
        TRANSCRIPT.add(command, f"no end within {timeout} s", late.stdout, late.stderr)
        raise
    TRANSCRIPT.add(command, f"exit code {result.returncode}", result.stdout, result.stderr)
    return result


TIME = r"(20[0-9T:-]+Z rank [0-9]+: )?"  # timestamps of log lines
PROGRESS = re.compile(TIME + r"[a-z][a-z ]*: (\d+ %|\d+ of \d+|\d+ (s|min)\b)")


def lines_of(stderr):
    """Returns the output lines of a program without progress lines, which it prints only on a slow machine."""
    return [line for line in stderr.strip().splitlines() if not PROGRESS.match(line)]


def errors_of(process, timeout):
    """Waits for a process with two pipes. Returns its standard error."""
    try:
        out, errors = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        process.kill()
        TRANSCRIPT.add(process.args, f"no end within {timeout} s", *process.communicate())
        raise
    TRANSCRIPT.add(process.args, f"exit code {process.returncode}", out, errors)
    return errors


class Started(subprocess.Popen):
    """A running program whose standard output and standard error go to a file."""

    def __init__(self, command, **options):
        command = list(map(str, command))
        with TRANSCRIPT.file(command) as kept:
            self.path = Path(kept.name)
            super().__init__(command, stdout=kept, stderr=subprocess.STDOUT, **options)

    def said(self):
        """Returns the output up to now."""
        return self.path.read_text(encoding="utf-8", errors="replace")

    def end(self):
        """Kills the process if it still runs."""
        if self.poll() is None:
            self.kill()
        self.wait()


class Result(unittest.TextTestResult):
    """Test results that also show the output of the programs of a failed test."""

    first = 0

    def startTest(self, test):
        self.first = len(TRANSCRIPT.files)
        super().startTest(test)

    def addFailure(self, test, err):
        super().addFailure(test, err)
        TRANSCRIPT.show(self.first)

    def addError(self, test, err):
        super().addError(test, err)
        TRANSCRIPT.show(self.first)

    def addSubTest(self, test, subtest, err):
        super().addSubTest(test, subtest, err)
        if err is not None:
            TRANSCRIPT.show(self.first)


def main(**options):
    """Runs unittest.main() for scripts that start programs."""
    unittest.main(testRunner=unittest.TextTestRunner(resultclass=Result, verbosity=options.pop("verbosity", 1)),
                  **options)
