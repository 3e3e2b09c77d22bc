"""Shared code of the mutant scripts: runs a program with limits on time and memory, and keeps faulty mutants."""
import argparse
import os
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness

SECONDS = 30
MEMORY_BYTES = 6 << 30
MAX_LINE = 1200  # a message of 1,000 bytes (core/base/quote.h), and a command's prefix
EXIT_CODES = {0, 1, 2, 3, 75}


class Ended:
    """The end of one run of the program."""

    def __init__(self, command, returncode, stdout, stderr, is_late):
        self.command, self.returncode, self.is_late = command, returncode, is_late
        self.stdout, self.stderr = stdout, stderr

    def faults(self):
        """Returns a line per fault that no input may cause."""
        name = " ".join(map(str, self.command))
        if self.is_late:
            return [f"{name}: still runs after {SECONDS} s"]
        found = []
        if self.returncode not in EXIT_CODES:
            found.append(f"{name}: exit {self.returncode}\n{self.stderr[-2000:]}")
        if self.returncode != 0 and not (self.stdout + self.stderr).strip():
            found.append(f"{name}: exit {self.returncode} without a word")
        for line in (self.stdout + self.stderr).splitlines():
            if len(line) > MAX_LINE:
                found.append(f"{name}: a line of {len(line)} characters: {line[:MAX_LINE]}…")
            if line.endswith("…"):
                found.append(f"{name}: a line without its end: {line}")
        return found


class LimitedProgram:
    """Runs one executable with constant limits."""

    def __init__(self, executable):
        self.executable = str(Path(executable).resolve())
        # A sanitizer reserves address space, so that it cannot be limited.
        self.is_sanitized = b"__asan_init" in Path(executable).read_bytes()

    def _bound(self):
        if not self.is_sanitized:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    def run(self, *arguments, cwd=None, seconds=SECONDS):
        command = [self.executable, *map(str, arguments)]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   cwd=cwd, env=dict(os.environ, **harness.MPI_ENVIRONMENT), start_new_session=True,
                                   preexec_fn=self._bound)
        is_late = False
        try:
            out, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            is_late = True
            os.killpg(process.pid, signal.SIGKILL)
            out, err = process.communicate()
        return Ended(["gigabake", *arguments], process.returncode, out.decode(errors="replace"),
                     err.decode(errors="replace"), is_late)


class Kept:
    """Faulty mutants with their faults, under `folder`, which is created for the first mutant."""

    def __init__(self, folder):
        self.folder, self.count = Path(folder), 0

    def keep(self, name, files, faults):
        """Copies the mutant and writes its faults. files: a file or folder."""
        self.count += 1
        target = self.folder / name
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir(parents=True)
        if Path(files).is_dir():
            shutil.copytree(files, target / Path(files).name, symlinks=True)
        else:
            shutil.copy(files, target)
        (target / "faults.txt").write_text("\n".join(faults) + "\n", encoding="utf-8")
        print(f"{name}: kept in {target}")
        for fault in faults:
            print(f"  {fault}")
        sys.stdout.flush()


def arguments(description, default_count, default_seed):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("gigabake")
    parser.add_argument("source_dir")
    parser.add_argument("--count", type=int, default=default_count, help="mutants to make")
    parser.add_argument("--seed", type=int, default=default_seed, help="of the first; each next one has the next")
    parser.add_argument("--keep", default="mutants", help="folder for those that go wrong")
    return parser.parse_args()
