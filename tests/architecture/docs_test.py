#!/usr/bin/env python3
"""What documents and comments name is there: paths of the tree, links, headings, and decisions.

Usage: docs_test.py SOURCE_DIR
"""
import re
import sys
from pathlib import Path

from architecture_test import ROOMS
from verdict import verdict

FOLDERS = "app bench cluster cmake docs format kernels lattice packaging scheduler tests tools viewer worker".split()
PATH = re.compile(r"(?<![\w/.-])((?:%s)/[\w./-]*\w)" % "|".join(FOLDERS))
CODE = {".h", ".cpp", ".cu", ".cuh", ".py"}
# NAME stands for a name that the reader chooses.
NOT_PATHS = re.compile(r".*NAME")
# Diaries and changes speak of what was.
PAST = ("docs/lab/", "CHANGELOG.md")


def anchors(text):
    """Of headings, as code hosts make them, and those that are written out."""
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        yield re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
    yield from re.findall(r'<a id="([^"]+)">', text)


def exists(root, name):
    """`name` may lack its suffix, and one that ends in _ is the beginning of several."""
    path = root / name
    rest = "*" if name.endswith("_") else ".*"
    return path.exists() or any(path.parent.glob(path.name + rest))


def link_problems(root, page, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        file, _, anchor = target.partition("#")
        if "://" in target or target.startswith("mailto:"):
            continue
        aim = (page.parent / file).resolve() if file else page
        if not aim.exists():
            yield f"links to {target}, which is not there"
        elif anchor and anchor not in set(anchors(aim.read_text(encoding="utf-8"))):
            yield f"links to {target}: no such heading"


def page_problems(root, page):
    text = page.read_text(encoding="utf-8")
    yield from link_problems(root, page, text)
    if not page.relative_to(root).as_posix().startswith(PAST):
        for name in sorted(set(PATH.findall(text))):
            if not exists(root, name) and not NOT_PATHS.match(name):
                yield f"names {name}, which is not there"


def index_problems(text):
    """The table of decisions has one row a heading, with the entries below it. Merges used to repeat rows."""
    table = re.findall(r"^\| \[(.+)\]\(#[\w-]+\) \| (.*) \|$", text, re.M)
    below = [part.split("\n", 1) for part in re.split(r"^## ", text, flags=re.M)[1:]]
    expected = [(name, " ".join(f"[{d}](#d{d})" for d in re.findall(r'<a id="d(\w+)"></a>', body)))
                for name, body in below]
    for row in sorted(set(expected) - set(table)):
        yield f"docs/decisions.md: the index lacks '{row[0]}' with the entries {row[1]}"
    for row in table:
        if table.count(row) > 1 or row not in expected:
            yield f"docs/decisions.md: the index repeats '{row[0]}' or lists other entries than its section"


def code_problems(root, decisions):
    """Code names files by their whole path, and decisions as (docs/decisions.md, 10)."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in CODE and path.name != "docs_test.py":
                text = path.read_text(encoding="utf-8")
                for name in sorted(set(PATH.findall(text))):
                    if Path(name).suffix in CODE | {".md"} and not exists(root, name):
                        yield f"{path.relative_to(root)}: names {name}, which is not there"
                for number in re.findall(r"docs/decisions\.md, (\d+a?)", text):
                    if f"d{number}" not in decisions:
                        yield f"{path.relative_to(root)}: docs/decisions.md has no entry {number}"


def architecture_problems(root):
    """docs/architecture.md has every room, and its flow names structs that their headers declare."""
    text = (root / "docs/architecture.md").read_text(encoding="utf-8")
    yield from (f"has no row for the room {room}" for room in ROOMS if f"`{room}`" not in text)
    flow = text.split("## The flow")[1].split("\n## ")[0]
    for row in re.findall(r"^\| [^|]*→[^|]*\|([^|]*)\|([^|]*)\|", flow, re.M):
        headers = [root / name for name in re.findall(r"`([\w/]+\.h)`", row[1])]
        declared = "".join(header.read_text(encoding="utf-8") for header in headers if header.exists())
        for name in re.findall(r"`([A-Z]\w+)`", row[0]) if headers else []:
            if not re.search(rf"(struct|class) {name}\b", declared):
                yield f"says that {name} is declared in {row[1].strip()}"


def version_problems(root):
    """2026-11-25: all files name the version of CMakeLists.txt."""
    version = re.search(r"VERSION (\d+\.\d+)\.(\d+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"))
    minor, whole = version.group(1), f"{version.group(1)}.{version.group(2)}"
    for name, text in (("CITATION.cff", f"\nversion: {whole}\n"), ("packaging/changelog", f"gigabake ({whole})"),
                       ("README.md", f"find_package(gigabake {minor} "), ("CHANGELOG.md", f"\n## {whole}, ")):
        if text not in (root / name).read_text(encoding="utf-8"):
            yield f"{name}: expected version {whole}, as in CMakeLists.txt"


def problems(root):
    yield from version_problems(root)
    for page in sorted([*root.glob("*.md"), *root.glob("*.cff"), *(root / "docs").rglob("*.md")]):
        for problem in page_problems(root, page):
            yield f"{page.relative_to(root)}: {problem}"
    yield from (f"docs/architecture.md: {problem}" for problem in architecture_problems(root))
    decisions = (root / "docs/decisions.md").read_text(encoding="utf-8")
    yield from index_problems(decisions)
    yield from code_problems(root, set(anchors(decisions)))


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1]).resolve()), "references to nothing"))
