#!/usr/bin/env python3
"""Checks that comments, messages, documents and names use plain technical English (CONTRIBUTING.md).

The test is a ratchet: it fails if a rule has more violations in a top-level folder than language_counts.json records.
If a count is lower, it prints the command that records it.

Usage: language_test.py SOURCE_DIR              compares the counts with those recorded
       language_test.py SOURCE_DIR --strict     also fails if a count is lower than recorded
       language_test.py SOURCE_DIR --record     records lower counts, and counts of rules that are not recorded yet
       language_test.py SOURCE_DIR --list PATH  prints the violations below PATH, a folder or file in SOURCE_DIR
"""
import argparse
import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from language_rules import Violation, file_problems, sentences
from prose import source
from tree_rules import folder_problems, header_problems, page_problems

HERE = Path(__file__).parent
COUNTS = HERE / "language_counts.json"
FOLDERS = (".ci .github app bench cluster cmake docs core examples format kernels packaging query sample scheduler "
           "python tests tools viewer worker").split()
# These define, quote or test the old words, or are texts of others.
EXEMPT = re.compile(r"tests/fuzz/corpus/|tests/architecture/(language_\w+|prose)\.py|docs/glossary\.md|LICENSE|"
                    r"packaging/copyright")
# Terms that codespell takes for misspelled words.
TERMS = "deques,fo,inout,lod,lods,paeth"
# These pages may compare with earlier states.
PAST = re.compile(r"docs/(adr|experiments)/|CHANGELOG\.md")


def files(root):
    """Returns the paths of all files of the repository; build folders lie next to the folders that are searched."""
    found = [path for path in root.iterdir() if path.is_file()]
    for folder in FOLDERS:
        found += [path for path in (root / folder).rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    return sorted(path for path in found if path.name != ".git")


def prose_of(root, paths):
    """Yields triples (path in the repository, text, its prose)."""
    for path in paths:
        name = path.relative_to(root).as_posix()
        if EXEMPT.match(name):
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        found = source(path, text)
        if found:
            yield name, text, found


def word_problems(prose):
    """Runs codespell on one file that has all prose, a line of prose per line."""
    places = [(name, number, line) for name, _, found in prose for block in found.blocks
              for number, line in block.lines]
    with tempfile.TemporaryDirectory() as folder:
        # The first line shows that codespell works.
        lines = ["whoever", *(line for _, _, line in places)]
        Path(folder, "prose").write_text("\n".join(lines) + "\n", encoding="utf-8")
        command = ["codespell", "--disable-colors", "--builtin", "clear", "-L", TERMS, "-D", "-",
                   "-D", str(HERE / "old_words.txt"), "prose"]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8", check=False)
    hits = re.findall(r"^prose:(\d+): (.*?) ==> (.*)$", run.stdout, re.M)
    if not hits or hits[0][0] != "1":
        sys.exit(f"language_test.py: codespell failed: {run.stderr}")
    for number, word, better in hits[1:]:
        name, line, _ = places[int(number) - 2]
        yield Violation("words", name, line, f"`{word}`: {better}")


def violations(root):
    """Returns all violations of all rules, in the order of files and lines, and the number of sentences in comments."""
    paths = files(root)
    prose = list(prose_of(root, paths))
    found = [*word_problems(prose), *header_problems(root),
             *folder_problems([path.relative_to(root).as_posix() for path in paths])]
    count = 0
    for name, text, contents in prose:
        found += file_problems(name, contents, bool(PAST.match(name)))
        count += sum(1 for block in contents.blocks if block.kind in ("contract", "comment") for _ in sentences(block))
        if name.endswith(".md"):
            found += page_problems(name, text)
    return sorted(found, key=lambda v: (v.path, v.line, v.rule)), count


def top_folder(v):
    """Returns the folder that a violation is counted in: `.` for files of the root."""
    return v.path.split("/")[0] if "/" in v.path else "."


def counted(found):
    """Returns the weight of all violations by rule and top-level folder."""
    counts = {}
    for v in found:
        counts.setdefault(v.rule, Counter())[top_folder(v)] += v.weight
    return {rule: dict(sorted(folders.items())) for rule, folders in sorted(counts.items())}


def show(found):
    for v in found:
        print(f"{v.path}:{v.line}: {v.rule}: {v.text}")


def compare(found, recorded, is_strict):
    """Prints the differences to the recorded counts. Returns the exit code."""
    counts, more, less = counted(found), [], []
    for rule in sorted({*counts, *recorded}):
        for folder in sorted({*counts.get(rule, {}), *recorded.get(rule, {})}):
            now, before = counts.get(rule, {}).get(folder, 0), recorded.get(rule, {}).get(folder, 0)
            (more if now > before else less if now < before else []).append((rule, folder, now, before))
    for rule, folder, now, before in more:
        show(v for v in found if v.rule == rule and top_folder(v) == folder)
    for rule, folder, now, before in more:
        print(f"{rule} in {folder}: {now}, at most {before} are allowed")
    for rule, folder, now, before in less:
        print(f"{rule} in {folder}: {now}, less than the {before} recorded")
    if less:
        print("Record lower counts: python3 tests/architecture/language_test.py . --record")
    return 1 if more or (less and is_strict) else 0


def record(found, recorded):
    """Writes the counts. A count of a known rule never rises."""
    counts = counted(found)
    for rule, folders in counts.items():
        for folder in folders:
            if rule in recorded:
                folders[folder] = min(folders[folder], recorded[rule].get(folder, 0))
    kept = {rule: {folder: n for folder, n in folders.items() if n} for rule, folders in counts.items()}
    COUNTS.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def rules_of(name, text):
    """Returns the set of rules that a file of this name and text violates, except for words."""
    return {v.rule for v in file_problems(name, source(Path(name), text), False)}


def self_test():
    """Checks that each rule finds its violation and accepts plain English."""
    for name, text, expected in (
            ("a.h", "/// Returns the bits in ascending order. Two threads may call it.\nint f(int x);\n", set()),
            ("a.h", "/// Brick of `what is` voxels.\n/// Cost    One read.\nstruct A {};\n", set()),
            ("a.h", "/// Of some items.\nint f();\n", {"first words", "contracts"}),
            ("a.h", "/// Return the items.\nint f();\n", {"contracts"}),
            ("a.h", "/// Returns the items. Cost  One read.\nint f();\n", {"tags"}),
            ("a.h", "/// Returns " + "the items of " * 9 + "it.\nint f();\n", {"summaries"}),
            ("a.h", "int a;  // the brick is\n        // unchanged\n// and it goes\n// on here\n", {"phrases"}),
            ("a.cpp", 'f("prints what is missing\\n"\n  "and ends", least_bytes, at_least);', {"clauses", "names"}),
            ("a.cpp", 'f("what is");  // a key', set()),
            ("a.py", 'def f():\n    """Where the items are."""\n    return LONGEST_LINE', {"first words", "names"}),
            ("CMakeLists.txt", "# As above.\nset(a \"goes on and on\")\n", {"first words", "phrases"}),
            ("tool", "#!/bin/sh\necho 'nothing goes on here' # So be it\n", {"first words", "phrases"}),
            ("a.md", "Faster than on 2026-11-25.\n\n```\nit goes on here\n```\n", {"history"})):
        assert rules_of(name, text) == expected, (text, rules_of(name, text))


def main():
    self_test()
    parser = argparse.ArgumentParser(usage=__doc__.split("Usage: ")[1])
    parser.add_argument("root", type=lambda text: Path(text).resolve())
    parser.add_argument("--strict", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--list", metavar="PATH")
    options = parser.parse_args()
    found, sentence_count = violations(options.root)
    if options.list is not None:
        below = options.list.strip("/").removeprefix("./")
        found = [v for v in found if below in ("", ".") or v.path == below or v.path.startswith(below + "/")]
        show(found)
        print(f"{len(found)} violations")
        return 0
    recorded = json.loads(COUNTS.read_text(encoding="utf-8")) if COUNTS.exists() else {}
    for rule in ("first words", "phrases"):
        number = sum(1 for v in found if v.rule == rule)
        print(f"{rule}: {number}, {100 * number / sentence_count:.1f} per 100 sentences of comments ({sentence_count})")
    if options.record:
        record(found, recorded)
        return 0
    return compare(found, recorded, options.strict)


if __name__ == "__main__":
    sys.exit(main())
