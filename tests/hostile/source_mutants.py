#!/usr/bin/env python3
"""Plans and bakes mutants of sources: small scenes of every format, each with something changed.

Every run of the real program must end within limits of time and memory, with a documented exit code and short lines.

Usage: source_mutants.py GIGABAKE SOURCE_DIR [--count N] [--seed S] [--jobs J] [--keep FOLDER]

Without --seed, a random seed is taken and printed. Failing mutants are kept in a folder, together with the command.
"""
import argparse
import os
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fuzz"))
sys.path.insert(0, str(Path(__file__).resolve().parent))
import mutations  # noqa: E402
import source_seeds  # noqa: E402

OUR_EXIT_CODES = {0, 1, 2, 3}
ENDED_WHEN_ASKED = {75, 128 + signal.SIGTERM, -signal.SIGTERM}  # bake, other command, command before its start
# A message of up to 1,000 bytes (core/base/quote.h), and a command's prefix.
MAX_LINE, MAX_ERRORS = 1200, 50_000
MAX_BYTES = 3 << 30
# A mutant may be a scene of a million cells, which takes long. The test sends such a run SIGTERM, and it must end.
SECONDS_UNTIL_ASKED, SECONDS_TO_OBEY = 20, 10
FOREIGN = re.compile(r"json\.exception|bad_alloc|length_error|terminate called|std::|Assertion|AddressSanitizer|"
                     r"\(signal \d+|Segmentation")


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MAX_BYTES, MAX_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def faults_of(code, was_asked, output, errors):
    """Yields the faults in the end of a run."""
    if code is None:
        yield f"did not end within {SECONDS_TO_OBEY} s of SIGTERM"
    elif code not in OUR_EXIT_CODES | (ENDED_WHEN_ASKED if was_asked else set()):
        yield f"exit code {code}"
    if len(errors) > MAX_ERRORS:
        yield f"{len(errors)} characters of errors"
    for line in [*output.splitlines(), *errors.splitlines()]:
        if len(line) > MAX_LINE:
            yield f"a line of {len(line)} characters: {line[:100]}"
        if line.endswith("…"):
            yield f"a line without its end: {line}"
        if FOREIGN.search(line):
            yield f"a line that is not gigabake's: {line[:200]}"


def run(command, environment, folder):
    """Returns exit code (None: it was killed), whether the run got SIGTERM, output and errors."""
    logs = [folder / "output", folder / "errors"]
    with open(logs[0], "wb") as out, open(logs[1], "wb") as err, \
            subprocess.Popen(command, stdout=out, stderr=err, env=environment, preexec_fn=limit_memory,
                             start_new_session=True) as process:
        was_asked = False
        try:
            process.wait(SECONDS_UNTIL_ASKED)
        except subprocess.TimeoutExpired:
            was_asked = True
            process.terminate()
        try:
            code = process.wait(SECONDS_TO_OBEY)
        except subprocess.TimeoutExpired:
            code = None
            os.killpg(process.pid, signal.SIGKILL)
    return code, was_asked, *(log.read_bytes().decode("utf-8", "replace") for log in logs)


class Hunt:
    def __init__(self, options):
        self.options = options
        self.seeds = source_seeds.all_seeds()
        self.keep = Path(options.keep or Path(tempfile.gettempdir()) / f"gigabake-mutants-{options.seed}")
        self.environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                            "OMPI_MCA_plm_rsh_agent": "/bin/false", "OMPI_MCA_ess_singleton_isolated": "1"}

    def commands(self, source, out, voxel_size):
        common = ["--voxel-size", str(voxel_size), "--cell-voxels", "64", "--threads", "2", "--memory", "512M"]
        yield [self.options.gigabake, "plan", str(source), *common]
        yield [self.options.gigabake, "bake", str(source), "-o", str(out), *common]

    def try_mutant(self, number):
        """Returns the faults of one mutant, and its description."""
        rng = random.Random(f"{self.options.seed} {number}")
        seed = self.seeds[number % len(self.seeds)]
        files, story = mutations.mutant_of(seed, rng)
        with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
            source = Path(folder) / "source"
            for name, content in files.items():
                (source / name).parent.mkdir(parents=True, exist_ok=True)
                (source / name).write_bytes(content)
            out = Path(folder) / "out"
            command = rng.choice(list(self.commands(source / seed.main, out, seed.voxel_size)))
            code, was_asked, output, errors = run(command, self.environment, Path(folder))
            faults = list(faults_of(code, was_asked, output, errors))
            if faults:
                self.keep_mutant(number, source, [*command, *faults, story, errors, output])
            return number, f"{seed.name}: {story}", code, faults

    def keep_mutant(self, number, source, notes):
        kept = self.keep / str(number)
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(source, kept / "source")
        (kept / "notes.txt").write_text("\n".join(map(str, notes)))

    def run_all(self):
        codes, failures = {}, 0
        numbers = range(self.options.first, self.options.first + self.options.count)
        with ThreadPoolExecutor(self.options.jobs) as pool:
            for number, what, code, faults in pool.map(self.try_mutant, numbers):
                codes[code] = codes.get(code, 0) + 1
                failures += bool(faults)
                if faults:
                    print(f"mutant {number} ({what}): {'; '.join(faults[:3])}", flush=True)
        print(f"{self.options.count} mutants, seed {self.options.seed}: {failures} failed; exit codes "
              f"{dict(sorted(codes.items(), key=str))}")
        if failures:
            print(f"kept in {self.keep}; again: {shlex.join(sys.argv)} --seed {self.options.seed}")
        return 1 if failures else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("gigabake")
    parser.add_argument("source_dir")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant, to try one again")
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep")
    options = parser.parse_args()
    if options.seed is None:
        options.seed = random.SystemRandom().randrange(1 << 32)
        print(f"seed {options.seed}", flush=True)
    return Hunt(options).run_all()


if __name__ == "__main__":
    sys.exit(main())
