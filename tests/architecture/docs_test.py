#!/usr/bin/env python3
"""Checks that paths, links, headings and decisions that documents and comments name exist.

Usage: docs_test.py SOURCE_DIR
       docs_test.py SOURCE_DIR --write-index    rewrites docs/adr/README.md, the index of decisions
"""
import re
import sys
from pathlib import Path

from architecture_test import MODULES
from verdict import verdict

FOLDERS = ("app bench cluster cmake core docs examples format kernels packaging python query sample scheduler tests "
           "tools viewer worker").split()
PATH = re.compile(r"(?<![\w/.-])((?:%s)/[\w./-]*\w)" % "|".join(FOLDERS))
CODE = {".h", ".cpp", ".cu", ".cuh", ".py"}
# NAME is a placeholder for a name that the reader chooses.
NOT_PATHS = re.compile(r".*NAME")
# Pages about the past may name removed files.
PAST = ("docs/experiments/", "CHANGELOG.md")
INDEX_HEAD = """# Decisions

The decisions that shape the code, one per file: context, decision, alternatives and cost. Code and documents refer to
them as `decision 10`. The last column lists earlier decisions that a file also records. The earlier texts of all
decisions, with their dates, are at tag `docs-before-rewrite`.

A new decision takes the next free number. `python3 tests/architecture/docs_test.py . --write-index` writes this page.

| number | decision | also records |
| --- | --- | --- |
"""


def anchors(text):
    """Yields the anchors that code hosts derive from headings, and explicit anchors."""
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        yield re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
    yield from re.findall(r'<a id="([^"]+)">', text)


def exists(root, name):
    """Returns True if a file has this name. The suffix may be missing; a name that ends in _ is a prefix."""
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


def page_problems(root, page, decisions):
    text = page.read_text(encoding="utf-8")
    yield from link_problems(root, page, text)
    if page.name != "CHANGELOG.md":
        yield from (f"docs/adr does not record decision {number}" for number in set(decisions_in(text)) - decisions)
    if not page.relative_to(root).as_posix().startswith(PAST):
        for name in sorted(set(PATH.findall(text))):
            if not exists(root, name) and not NOT_PATHS.match(name):
                yield f"names {name}, which is not there"


def decision_files(root):
    """Returns a table from the number of a decision to the file that records it."""
    return {int(path.name[:4]): path for path in sorted((root / "docs/adr").glob("[0-9]*.md"))}


def decisions_in(text):
    """Returns the numbers of all decisions that a text refers to: `decision 10`, `decisions 280, 281`."""
    for numbers in re.findall(r"\bdecisions?\s+(\d+a?(?:(?:,|,? and)\s+\d+a?)*)", text):
        yield from re.findall(r"\d+a?", numbers)


def decision_index(root):
    """Returns the text of docs/adr/README.md: a row per file, with the other decisions that it records."""
    files = decision_files(root)
    rows = []
    for number, path in files.items():
        text = path.read_text(encoding="utf-8")
        title = re.match(rf"# {number}\. (.+)\n", text).group(1)
        others = sorted({n for n in decisions_in(text) if n.endswith("a") or int(n) not in files},
                        key=lambda n: (int(n.rstrip("a")), n))
        rows.append(f"| [{number}]({path.name}) | {title} | {', '.join(others)} |")
    return INDEX_HEAD + "\n".join(rows) + "\n"


def known_decisions(root):
    """Returns the numbers of all decisions that a file under docs/adr records."""
    return {str(number) for number in decision_files(root)} | {
        number for path in decision_files(root).values() for number in decisions_in(path.read_text(encoding="utf-8"))}


def index_problems(root):
    """The index is generated. A file has the form: number and title, four paragraphs, at most 150 words."""
    index = root / "docs/adr/README.md"
    if index.read_text(encoding="utf-8") != decision_index(root):
        yield "docs/adr/README.md is not up to date: run tests/architecture/docs_test.py . --write-index"
    for path in decision_files(root).values():
        text = path.read_text(encoding="utf-8")
        parts = re.findall(r"^\*\*(\w+)\.\*\* ", text, re.M)
        if parts != ["Context", "Decision", "Alternatives", "Cost"]:
            yield f"docs/adr/{path.name}: expected Context, Decision, Alternatives and Cost, not {parts}"
        if len(text.split()) > 150:
            yield f"docs/adr/{path.name}: {len(text.split())} words, at most 150 are allowed"


def code_problems(root, decisions):
    """Code names files by their whole path, and decisions by a number that docs/adr records."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in CODE and path.name != "docs_test.py":
                text = path.read_text(encoding="utf-8")
                for name in sorted(set(PATH.findall(text))):
                    if Path(name).suffix in CODE | {".md"} and not exists(root, name):
                        yield f"{path.relative_to(root)}: names {name}, which is not there"
                for number in set(decisions_in(text)) - decisions:
                    yield f"{path.relative_to(root)}: docs/adr does not record decision {number}"


def glossary_problems(root):
    """docs/glossary.md defines a term per row, once, with a link to the file that implements it."""
    text = (root / "docs/glossary.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.+) \| (.+) \| (.+) \|$", text, re.M)[2:]
    terms = [term for term, _, _ in rows]
    yield from (f"defines '{term}' twice" for term in set(terms) if terms.count(term) > 1)
    for term, _, implementation in rows:
        link = re.fullmatch(r"\[[\w.]+\]\(\.\./([\w/.-]+)\)", implementation)
        if not link or Path(link.group(1)).suffix not in CODE or not (root / link.group(1)).is_file():
            yield f"'{term}': expected a link to a source file, not {implementation}"
    if not 35 <= len(terms) <= 60:
        yield f"defines {len(terms)} terms; about 40 are expected"


def architecture_problems(root):
    """docs/architecture.md has a row per module, and its flow names structs that their headers declare."""
    text = (root / "docs/architecture.md").read_text(encoding="utf-8")
    yield from (f"has no row for the module {module}" for module in MODULES if f"`{module}`" not in text)
    flow = text.split("## The flow")[1].split("\n## ")[0]
    for row in re.findall(r"^\| [^|]*→[^|]*\|([^|]*)\|([^|]*)\|", flow, re.M):
        headers = [root / name for name in re.findall(r"`([\w/]+\.h)`", row[1])]
        declared = "".join(header.read_text(encoding="utf-8") for header in headers if header.exists())
        for name in re.findall(r"`([A-Z]\w+)`", row[0]) if headers else []:
            if not re.search(rf"(struct|class) {name}\b", declared):
                yield f"states that {name} is declared in {row[1].strip()}, which does not declare it"


def example_problems(root):
    """examples/README.md lists every example, README.md links an example per row, and a test names each example."""
    page = (root / "examples/README.md").read_text(encoding="utf-8")
    tests = "".join(path.read_text(encoding="utf-8") for path in sorted((root / "tests").glob("c*/**/*_test.py")))
    names = sorted(path.name for path in (root / "examples").iterdir() if path.name not in ("README.md", "__pycache__"))
    if (listed := sorted(re.findall(r"^\| \[[\w.]+\]\(([\w.]+)\) \|", page, re.M))) != names:
        yield f"examples/README.md lists {listed}, and there are {names}"
    yield from (f"examples/{name}: no test runs it" for name in names if name not in tests)
    rows = (root / "README.md").read_text(encoding="utf-8").split("| I have | I want |")[1].split("\n\n")[0]
    yield from (f"README.md: a row has no link to an example: {row}" for row in rows.split("\n")[2:]
                if not re.search(r"\]\(examples/[\w.]+\)", row))


def version_problems(root):
    """2026-11-25: all files name the version of CMakeLists.txt."""
    version = re.search(r"VERSION (\d+\.\d+)\.(\d+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"))
    minor, whole = version.group(1), f"{version.group(1)}.{version.group(2)}"
    for name, text in (("CITATION.cff", f"\nversion: {whole}\n"), ("packaging/changelog", f"gigabake ({whole})"),
                       ("docs/library.md", f"find_package(gigabake {minor} "), ("CHANGELOG.md", f"\n## {whole}, "),
                       ("python/pyproject.toml", f'\nversion = "{whole}"\n'),
                       ("python/gigabake/__init__.py", f'\n__version__ = "{whole}"\n')):
        if text not in (root / name).read_text(encoding="utf-8"):
            yield f"{name}: expected version {whole}, as in CMakeLists.txt"


def problems(root):
    yield from version_problems(root)
    decisions = known_decisions(root)
    for page in sorted([*root.glob("*.md"), *root.glob("*.cff"), *(root / "docs").rglob("*.md"),
                        *(root / "examples").glob("*.md")]):
        for problem in page_problems(root, page, decisions):
            yield f"{page.relative_to(root)}: {problem}"
    yield from (f"docs/architecture.md: {problem}" for problem in architecture_problems(root))
    yield from (f"docs/glossary.md: {problem}" for problem in glossary_problems(root))
    yield from index_problems(root)
    yield from example_problems(root)
    yield from code_problems(root, decisions)


if __name__ == "__main__":
    ROOT = Path(sys.argv[1]).resolve()
    if "--write-index" in sys.argv:
        (ROOT / "docs/adr/README.md").write_text(decision_index(ROOT), encoding="utf-8")
    sys.exit(verdict(problems(ROOT), "references to nothing"))
