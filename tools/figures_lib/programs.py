"""Commands of a measurement, run in one folder: their JSON output, time, CPU time, peak memory and output files."""
import json
import os
import re
import shlex
import shutil
import string
import subprocess
import time
from pathlib import Path

from figures_lib.data import TOP, Problem


def words_of(command, program):
    """Returns the words of a command. Programs of gigabake are those next to `program`."""
    words = shlex.split(command, comments=True)
    at = 3 if words[:2] == ["mpirun", "-n"] else 0
    if words[0] == "python3":
        words[0] = "/usr/bin/python3"  # has numpy and h5py of the distribution
    elif words[at] == "gigabake":
        words[at] = str(program)
    elif re.fullmatch(r"gigabake[-_]\w+", words[at]):
        words[at] = str(program.with_name(words[at]))
    else:
        raise Problem(f"expected a command of gigabake, not {command}")
    return words


def word_after(words, options):
    """Returns the value of an option in a command, or None."""
    return next((value for option, value in zip(words, words[1:]) if option in options), None)


def filled(command, variables):
    """Returns a command with the values of its variables, such as $voxel_m."""
    try:
        return string.Template(command).substitute(variables)
    except (KeyError, ValueError) as error:
        raise Problem(f"{command}: no value of {error}") from error


def sizes(path):
    """Returns bytes and number of the files of a path."""
    files = [file for file in path.rglob("*") if file.is_file()] if path.is_dir() else [path]
    return {"bytes": sum(file.stat().st_size for file in files), "files": len(files)}


def remove(path):
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


# Lets mpirun start ranks on one host: as root, without ssh, in a container.
MPI_ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                   "OMPI_MCA_plm_rsh_agent": "/bin/false", "OMPI_MCA_rmaps_base_oversubscribe": "1",
                   "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "HWLOC_COMPONENTS": "-gl,-opencl"}


class Session:
    """A folder with the scenes and results of one run. Equal commands run once."""

    def __init__(self, program, folder):
        self.program, self.folder, self.prepared, self.results = program, Path(folder), set(), {}

    def run(self, words, command):
        """Runs a command. Returns its wall and CPU time and peak memory, including child processes."""
        environment = {**MPI_ENVIRONMENT, **os.environ, "PYTHONPATH": str(TOP / "python")}
        with (self.folder / "stdout").open("wb") as out, (self.folder / "stderr").open("wb") as errors:
            start = time.monotonic()
            child = subprocess.Popen(words, cwd=self.folder, stdout=out, stderr=errors, env=environment)
            _, status, usage = os.wait4(child.pid, 0)
            seconds = time.monotonic() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            text = (self.folder / "stderr").read_text(errors="replace")
            raise Problem(f"exit status {child.returncode} of {command}\n{text[-2000:]}")
        return {"seconds": seconds, "cpu_s": usage.ru_utime + usage.ru_stime, "peak_bytes": 1024 * usage.ru_maxrss}

    def prepare(self, command):
        """Runs a command unless it has run before."""
        if command not in self.prepared:
            self.run(words_of(command, self.program), command)
            self.prepared.add(command)

    def json_of(self, words):
        """Returns the JSON output of a command: a file after --json or --gtest_output, or standard output."""
        name = word_after([part for word in words for part in word.split("=json:")], ["--json", "--gtest_output"])
        path = self.folder / (name if name and name.endswith(".json") else "stdout")
        with path.open("rb") as file:
            starts_json = file.read(1) == b"{"
        return json.loads(path.read_text(encoding="utf-8")) if starts_json else {}

    def measured(self, command):
        """Runs a command. Returns its JSON output with `process` and `output`."""
        words = words_of(command, self.program)
        target = word_after(words, ["-o", "--out", "--output"])
        if target:
            remove(self.folder / target)
        process = self.run(words, command)
        result = {**self.json_of(words), "process": process}
        return {**result, "output": sizes(self.folder / target)} if target else result

    def scope_of(self, commands):
        """Runs commands. Returns the result of the last one, and the results of all by their number."""
        results = [self.measured(command) for command in commands]
        return {**results[-1], **{str(number): result for number, result in enumerate(results)}}

    def scopes_of(self, commands, repeats):
        """Returns the results of each repeat of commands. Equal commands share their results."""
        key = (*commands, repeats)
        if key not in self.results:
            self.results[key] = [self.scope_of(commands) for _ in range(repeats)]
            self.clean(commands)
        return self.results[key]

    def clean(self, commands):
        """Removes the outputs of measured commands."""
        for command in commands:
            target = word_after(words_of(command, self.program), ["-o", "--out", "--output"])
            if target:
                remove(self.folder / target)


def first_line(command):
    """Returns the first line that a command prints, or None if it cannot run."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError):
        return None
