"""Rules for the tree: how many files a folder holds, how many headers are installed, how long a page is."""
import re

from language_rules import Violation

MAX_FOLDER_FILES = 30
MAX_INSTALLED_HEADERS = 60
MAX_LINE = 120
MAX_WORDS = {"README.md": 700, "docs/format.md": 6000}
MAX_PAGE_WORDS = 2500
# One decision per file, and one file per input that a fuzzer found.
DATA_FOLDERS = ("docs/adr", "tests/fuzz/corpus")


def folder_problems(paths):
    counts = {}
    for path in paths:
        folder = path.rpartition("/")[0]
        counts[folder] = counts.get(folder, 0) + 1
    for folder, count in sorted(counts.items()):
        if count > MAX_FOLDER_FILES and not folder.startswith(DATA_FOLDERS):
            yield Violation("folders", folder + "/", 1, f"holds {count} files, more than {MAX_FOLDER_FILES}",
                            count - MAX_FOLDER_FILES)


def header_problems(root):
    name = "cmake/public_headers.cmake"
    listed = re.findall(r"[\w/]+\.(?:h|cuh)\b", re.sub(r"#[^\n]*", "", (root / name).read_text(encoding="utf-8")))
    for header in listed:
        for number, line in enumerate((root / header).read_text(encoding="utf-8").split("\n"), 1):
            included = re.match(r'#include "(.*)"', line)
            if included and included[1] not in listed:
                yield Violation("headers", header, number, f"is installed and includes {included[1]}, which is not", 1)
    count = sum(header.endswith(".h") for header in listed)
    if count > MAX_INSTALLED_HEADERS:
        yield Violation("headers", name, 1, f"installs {count} headers, more than {MAX_INSTALLED_HEADERS}",
                        count - MAX_INSTALLED_HEADERS)


def page_problems(path, text):
    """Length of a document without its comments. The changelog grows with each release."""
    limit, count = MAX_WORDS.get(path, MAX_PAGE_WORDS), len(re.sub(r"<!--.*?-->", "", text, flags=re.S).split())
    if count > limit and path != "CHANGELOG.md":
        yield Violation("pages", path, 1, f"has {count} words, more than {limit}", count - limit)
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > MAX_LINE and not line.lstrip().startswith("|"):
            yield Violation("lines", path, number, f"has {len(line)} characters, more than {MAX_LINE}")
