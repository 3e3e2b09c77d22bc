"""Measurements: the commands of tables, run on this machine, and what identifies the run."""
import datetime
import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

from figures_lib import data
from figures_lib.data import TOP, Problem
from figures_lib.markdown import cell_text, table_text
from figures_lib.programs import Session, filled, first_line
from figures_lib.readers import READERS
from figures_lib.values import mapped_rows

# Uncommitted changes of these folders would make the commit of a measurement meaningless.
MEASURED_CODE = ["kernels", "worker", "format/shard", "viewer/stream"]
GPU, CPU = "one-gpu", "two-cores"


def has_measured_changes():
    """Returns True unless git states that the measured code has no uncommitted changes."""
    try:
        changes = subprocess.run(["git", "-C", TOP, "status", "--porcelain", "--", *MEASURED_CODE], check=True,
                                 capture_output=True, text=True)
    except (OSError, subprocess.CalledProcessError):
        return True
    return changes.stdout != ""


def commit_of(program, stated):
    """Returns version and commit of a program. `stated` is the commit of a program that was built without git."""
    version, _, commit = (first_line([program, "--version"]) or "").partition(", commit ")
    is_changed = commit.endswith("with changes") and has_measured_changes()
    commit = commit or stated or ""
    if not re.match("[0-9a-f]{12}", commit) or is_changed:
        raise Problem(f"{program}: expected a program of a commit, without changes of {', '.join(MEASURED_CODE)}; "
                      f"found {commit or 'no commit'}: commit these folders and build again, or use --commit")
    return version, commit.split()[0]


def processor():
    """Returns the name of the CPU, or None."""
    try:
        found = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        return None
    return found[1] if found else None


def file_place(folder):
    """Returns `in memory` if a folder is in a file system in memory, otherwise `on disk`."""
    mounts = [line.split()[1:3] for line in Path("/proc/mounts").read_text(encoding="utf-8").splitlines()]
    under = [(point, kind) for point, kind in mounts if Path(folder).resolve().is_relative_to(point)]
    return "in memory" if max(under, key=lambda one: len(one[0]))[1] in ("tmpfs", "ramfs") else "on disk"


def gpu_of_host():
    """Returns name and driver of the first GPU, or two None."""
    line = first_line(["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"])
    return line.split(", ") if line else (None, None)


def provenance(program, stated, folder):
    """Returns what identifies a run: version and commit of the program, card, driver, processor, cores and date."""
    version, commit = commit_of(program, stated)
    card, driver = gpu_of_host()
    return {"commit": commit, "version": version, "card": card, "driver": driver, "processor": processor(),
            "cores": len(os.sched_getaffinity(0)), "files": file_place(folder),
            "date": datetime.date.today().isoformat()}


def kept(table, rows, is_quick):
    """Returns the rows whose first cells `measured` names, in this order; otherwise all rows."""
    names = table["measured"].get("keep")
    if not names:
        return rows
    found = {cell_text(table["columns"][0], row[0]): row for row in rows}
    absent = [name for name in names if name not in found]
    if len(absent) == len(names) or (absent and not is_quick):
        raise Problem(f"{table['title']}: the measurement lacks {absent}")
    return [found[name] for name in names if name in found]


def rows_of_result(table, scopes, is_quick=False):
    """Returns the rows of a table from the results of its commands."""
    reader = READERS.get(table["measured"].get("reader"))
    return kept(table, reader(table, scopes[0]) if reader else mapped_rows(table, scopes), is_quick)


def rows_of_run(table, session, variables, is_quick):
    """Runs the commands of a table with some values of their variables. Returns the rows."""
    for command in table.get("prepare", []):
        session.prepare(filled(command, variables))
    commands = [filled(command, variables) for command in table["commands"]]
    repeats = 1 if is_quick else variables.get("repeats", table.get("repeats", 1))
    named = {f"${name}": value for name, value in variables.items()}
    scopes = [{**scope, **named} for scope in session.scopes_of(commands, repeats)]
    return rows_of_result(table, scopes, is_quick)


def rows_of_table(name, machine, session, is_quick):
    """Measures a table on this machine. Returns its rows."""
    table = data.load(name)
    runs = table.get("quick", []) if is_quick else table["runs"][machine]
    start, rows = time.monotonic(), []
    for variables in runs:
        rows += rows_of_run(table, session, variables, is_quick)
    print(f"{name}: {len(rows)} rows in {time.monotonic() - start:.1f} s", flush=True)
    return rows


def tables_of(machine):
    """Returns the names of the tables that a machine measures."""
    tables = {name: data.load(name) for name in data.table_files()}
    return [name for name, table in tables.items() if machine in table.get("runs", {})]


def checked_names(names, machine):
    """Returns the tables to measure, or fails if a named table is not measured on this machine."""
    possible = tables_of(machine)
    for name in names:
        if name not in possible:
            raise Problem(f"{name}: not a table of {machine}; its tables: {', '.join(possible)}")
    return names or [name for name in possible if not data.load(name).get("by_name")]


def measure(names, options):
    """Measures tables and writes them to options.output after each one. Returns the problems."""
    machine = options.machine or (GPU if gpu_of_host()[0] else CPU)
    names, problems, tables = checked_names(names, machine), [], {}
    with tempfile.TemporaryDirectory(dir=options.work) as folder:
        found = provenance(options.program, options.commit, folder)
        session = Session(options.program, folder)
        for name in names:
            try:
                tables[name] = rows_of_table(name, machine, session, False)
            except Problem as problem:
                problems.append(f"{name}: {problem}")
            if tables:
                data.store(options.output, {"machine": machine, "runs": [{**found, "tables": tables}]})
    return problems


def try_all(names, options):
    """Runs each table with its small scene, and stores nothing. Returns the problems."""
    problems = []
    names = names or [name for name in data.table_files() if "runs" in data.load(name)]
    with tempfile.TemporaryDirectory(dir=options.work) as folder:
        session = Session(options.program, folder)
        for name in names:
            table = data.load(name)
            try:
                rows = rows_of_table(name, None, session, True)
                if not rows and table.get("quick") != []:
                    problems.append(f"{name}: no rows")
                if options.verbose:
                    print(table_text(table["columns"], rows))
            except Problem as problem:
                problems.append(f"{name}: {problem}")
    return problems
