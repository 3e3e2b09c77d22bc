#!/usr/bin/env python3
"""Checks that tools/figures wrote all tables of measured values, and that it notices a changed number. Also checks that
each measured number in the text of README.md is in the data of its table.

Usage: figures_test.py SOURCE_DIR
"""
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from verdict import verdict

PAGES = ["README.md", "docs/performance.md", "docs/accuracy.md", "docs/accuracy-*.md"]
MARKED = re.compile(r"^<!-- data/.*?^<!-- end -->$", re.M | re.S)
TABLE = re.compile(r"^\|.*\n\| ---.*\n(?:\|.*\n)+", re.M)
MEASURED = re.compile(r"\b(?:m?s|[kKMG]i?B|bytes|seconds|memory|errors?|FLIP|PSNR|IoU|worst|missed)\b|ΔE")
NUMBER = re.compile(r"[+-]?[\d.][\d.,]*(?: \d{3})*(?: (?:m?s|%|[kKMG]i?B|[MG]))?")
# A number with a unit of time, bytes, rates, area or error in text.
IN_TEXT = re.compile(r"\d[\d.,]*\s?(?:ms|µs|ns|s|seconds?|minutes?|hours?|%|×|times|[kKMGT]i?B|dB|km²|fps)(?!\w)")
# Headings of tables with such words or numbers that are not measured.
EXEMPT = {"| claim | test | cases |": "numbers of test cases",
          "| case | expected (area; conservative; thin) | why |": "numbers of voxels that follow from the rules"}


def has_measurements(table):
    """Returns True if a heading names a unit or an error, or most cells of a later column are numbers."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    if any(MEASURED.search(head) for head in rows[0]):
        return True
    columns = list(zip(*rows[2:]))[1:]
    return any(2 * sum(bool(NUMBER.match(cell)) for cell in column) > len(column) for column in columns)


def tables_by_hand(root):
    """Yields page and heading of each table outside the markers that looks measured."""
    for path in sorted(path for pattern in PAGES for path in root.glob(pattern)):
        for found in TABLE.findall(MARKED.sub("", path.read_text(encoding="utf-8"))):
            if has_measurements(found) and found.split("\n")[0] not in EXEMPT:
                heading = found.split("\n")[0]
                yield f"{path.relative_to(root)}: `{heading}` looks measured, but has no markers of tools/figures"


def loose_numbers(root):
    """Yields the measured numbers in the text of README.md that the data of its table do not contain."""
    readme = root / "README.md"
    text = re.sub(r"```.*?```|`[^`]*`", "", TABLE.sub("", readme.read_text(encoding="utf-8")), flags=re.S)
    stored = json.loads((root / "docs/data/readme.json").read_text(encoding="utf-8"))
    cells = " ".join(str(cell) for row in stored["rows"] for cell in row)
    for found in IN_TEXT.findall(text):
        number = re.match(r"[\d.,]*\d", found)[0]
        if not re.search(rf"(?<![\d.]){re.escape(number)}(?![\d.])", cells):
            yield f"README.md: `{found}` looks measured, but docs/data/readme.json does not contain it"


def checked(root):
    """Returns exit code and output of tools/figures --check."""
    command = [sys.executable, root / "tools/figures", "--check"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    return run.returncode, run.stdout + run.stderr


def measures_uncommitted_sources(root, folder):
    """Returns whether tools/figures measures with a program whose sources have changes."""
    program = folder / "program"
    program.write_text("#!/bin/sh\necho gigabake 0.3.0, commit 0123456789ab with changes\n", encoding="utf-8")
    program.chmod(0o755)
    run = subprocess.run([sys.executable, root / "tools/figures", "--measure", "settings", "--machine", "none",
                          "--program", program], capture_output=True, text=True, check=False)
    return run.returncode != 1 or "without changes of" not in run.stdout


def unnoticed(root):
    """Tests the check and this test with a changed number, a table without data and a table outside the markers."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("tools/figures", "docs/data", "docs/performance.md"):
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if (root / name).is_dir() else shutil.copy)(root / name, copy / name)
        if measures_uncommitted_sources(copy, copy):
            yield "tools/figures --measure accepts a program whose sources have changes"
        page = copy / "docs/performance.md"
        text = page.read_text(encoding="utf-8")
        name = re.search(r"<!-- data/(.*?)\.json -->", text)[1]
        one = f"docs/performance.md: the table {name} differs"
        changes = {one: re.sub(r"(<!-- data/[^|]*\n)\|[^|]*", r"\1| no", text, count=1),
                   "docs/performance.md: expected `<!-- end -->`": text.replace("<!-- end -->", "", 1),
                   "no-such-table.json": text.replace(name, "no-such-table", 1)}
        for expected, changed in changes.items():
            page.write_text(changed, encoding="utf-8")
            code, output = checked(copy)
            if code != 1 or expected not in output:
                yield f"tools/figures --check does not report `{expected}`: {code}, {output}"
        (copy / "README.md").write_text("A bake takes 4.1 s, later 4.7 s, of `--threads 7 s`.\n", encoding="utf-8")
        if len(list(loose_numbers(copy))) != 1:
            yield f"this test finds {list(loose_numbers(copy))} in the text of a README.md with one number without data"
        page.write_text(re.sub(r"<!-- .* -->\n", "", text), encoding="utf-8")
        found, expected = len(list(tables_by_hand(copy))), len(MARKED.findall(text))
        if found != expected:
            yield f"this test finds {found} of {expected} tables without markers"


def problems(root):
    code, output = checked(root)
    if code != 0:
        yield output
    yield from tables_by_hand(root)
    yield from loose_numbers(root)
    yield from unnoticed(root)


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1]).resolve()), "tables that differ from docs/data"))
