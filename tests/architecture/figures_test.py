#!/usr/bin/env python3
"""Checks that tools/figures wrote all tables of measured values, and that it notices a changed number. Also checks that
each measured number in the text of README.md is in the data of its table.

Usage: figures_test.py SOURCE_DIR
"""
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
# Measured numbers that the text of a page may have: settings, bounds and goals count, too. Lower these when possible.
MAX_IN_PROSE = {"README.md": 0, "docs/performance.md": 6, "docs/accuracy.md": 1, "docs/accuracy-images.md": 3,
                "docs/accuracy-rendering.md": 10, "docs/accuracy-suite.md": 1, "docs/accuracy-hard-cases.md": 0}
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
    """Yields the measured numbers in the text of README.md that its table does not contain."""
    text = (root / "README.md").read_text(encoding="utf-8")
    cells = " ".join(TABLE.findall(text))
    for found in IN_TEXT.findall(re.sub(r"```.*?```|`[^`]*`", "", TABLE.sub("", text), flags=re.S)):
        number = re.match(r"[\d.,]*\d", found)[0]
        if not re.search(rf"(?<![\d.]){re.escape(number)}(?![\d.])", cells):
            yield f"README.md: `{found}` looks measured, but its table does not contain it"


def numbers_in_prose(text):
    """Returns the number of measured numbers in the text of a page, outside its blocks, tables and code."""
    prose = re.sub(r"```.*?```|`[^`]*`|^    [^\n]*$", "", TABLE.sub("", MARKED.sub("", text)), flags=re.S | re.M)
    return len(IN_TEXT.findall(prose))


def prose_problems(root):
    """Yields a line per page whose text has more measured numbers than MAX_IN_PROSE allows."""
    for page, limit in MAX_IN_PROSE.items():
        found = numbers_in_prose((root / page).read_text(encoding="utf-8"))
        if found > limit:
            yield f"{page}: {found} measured numbers in the text, {limit} are allowed: put them into a table"


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
    run = subprocess.run([sys.executable, root / "tools/figures", "--measure", "settings", "--machine", "one-gpu",
                          "--program", program], capture_output=True, text=True, check=False)
    return run.returncode != 1 or "without changes of" not in run.stdout


def copied(root, copy):
    """Copies the program, the data and the pages with tables."""
    for name in ("tools/figures", "tools/figures_lib", "docs/data", *PAGES):
        for path in root.glob(name):
            aim = copy / path.relative_to(root)
            aim.parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if path.is_dir() else shutil.copy)(path, aim)


def unnoticed_changes(copy):
    """Yields each error in a page or in the data that the check does not report."""
    page, data = copy / "docs/performance.md", copy / "docs/data/two-cores.json"
    text, stored = page.read_text(encoding="utf-8"), data.read_text(encoding="utf-8")
    name = re.search(r"<!-- data/(\w+/.*?)\.json -->", text)[1]
    differs = "docs/performance.md: the table"
    changes = [(f"{differs} {name} differs", page, re.sub(r"(<!-- data/\w+/[^|]*\n)\|[^|]*", r"\1| no", text, count=1)),
               (f"{differs} {name} differs", page, re.sub(r"(\n\| --- .*\n\|.*?)(\d)", r"\g<1>7\2", text, count=1)),
               (f"{differs} two-cores differs", page, re.sub(r"commit [0-9a-f]", "commit z", text, count=1)),
               ("differs from docs/data", data, re.sub(r"(\], |\[\[)([^\[\]]*)(\d)", r"\1\g<2>7\3", stored, count=1)),
               ("docs/performance.md: expected `<!-- end -->`", page, text.replace("<!-- end -->", "", 1)),
               ("no-such-table", page, text.replace(f"{name}.json", "performance/no-such-table.json", 1))]
    for expected, path, changed in changes:
        before = path.read_text(encoding="utf-8")
        path.write_text(changed, encoding="utf-8")
        code, output = checked(copy)
        if code != 1 or expected not in output:
            yield f"tools/figures --check does not report `{expected}` in {path.name}: {code}, {output}"
        path.write_text(before, encoding="utf-8")


def unnoticed(root):
    """Tests the check and this test with changed numbers, a table without data and a table outside the markers."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        copied(root, copy)
        if measures_uncommitted_sources(copy, copy):
            yield "tools/figures --measure accepts a program whose sources have changes"
        yield from unnoticed_changes(copy)
        page = copy / "docs/performance.md"
        text = page.read_text(encoding="utf-8")
        page.write_text(text + "A bake takes 4.1 s. " * (MAX_IN_PROSE["docs/performance.md"] + 1), encoding="utf-8")
        if len(list(prose_problems(copy))) != 1:
            yield "this test does not find measured numbers in the text of docs/performance.md"
        (copy / "README.md").write_text("A bake takes 4.1 s, later 4.7 s, of `--threads 7 s`.\n\n"
                                        "| time, s |\n| --- |\n| 4.1 |\n", encoding="utf-8")
        if len(list(loose_numbers(copy))) != 1:
            yield f"this test finds {list(loose_numbers(copy))} in the text of a README.md with one number without data"
        page.write_text(re.sub(r"<!-- .* -->\n", "", text), encoding="utf-8")
        tables = [block for block in MARKED.findall(text) if TABLE.search(block)]
        found = [one for one in tables_by_hand(copy) if one.startswith("docs/performance.md")]
        if len(found) != len(tables):
            yield f"this test finds {len(found)} of {len(tables)} tables without markers"


def problems(root):
    code, output = checked(root)
    if code != 0:
        yield output
    yield from tables_by_hand(root)
    yield from loose_numbers(root)
    yield from prose_problems(root)
    yield from unnoticed(root)


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1]).resolve()), "tables that differ from docs/data"))
