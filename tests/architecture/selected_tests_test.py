#!/usr/bin/env python3
"""Checks that each name in the test selections of ./check and similar scripts occurs in the name of a test.

ctest ignores an alternative of -R or -E that matches nothing, so a renamed suite would silently leave the sanitizers.

Usage: selected_tests_test.py SOURCE_DIR
"""
import re
import sys
from pathlib import Path

from verdict import verdict

SCRIPTS = ["check", "cluster/gpu-check", "tools/random-tests"]
SELECTION = re.compile(r"-[RE] +'([^']+)'")
TEST = re.compile(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", re.M)
CMAKE_TEST = re.compile(r"^\s*gb_\w*test\w*\(\s*([\w.]+)", re.M)


def names(root):
    """Returns the words of the names of all tests: suites, cases, and the tests of CMake lists and scripts."""
    words = set()
    for path in (root / "tests").rglob("*.c*"):
        if path.suffix in (".cpp", ".cu"):
            for suite, case in TEST.findall(path.read_text()):
                words |= {suite, case}
    for path in (root / "tests").rglob("CMakeLists.txt"):
        words |= set(re.findall(r"\w+", " ".join(CMAKE_TEST.findall(path.read_text()))))
    return words | {p.stem for p in (root / "tests").rglob("*.py")} | {p.name for p in (root / "tests").iterdir()}


def main():
    root = Path(sys.argv[1])
    known, problems = names(root), []
    for script in SCRIPTS:
        for number, line in enumerate((root / script).read_text().splitlines(), 1):
            for pattern in SELECTION.findall(line):
                for word in re.findall(r"[A-Za-z]\w+", pattern.replace("\\", " ")):
                    if not any(word in name for name in known):
                        problems.append(f"{script}:{number}: selects {word}, which no test's name contains")
    return verdict(problems, "selections of nothing")


if __name__ == "__main__":
    sys.exit(main())
