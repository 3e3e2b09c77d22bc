#!/usr/bin/env python3
"""Checks that tables of measured values are not much older than the code that they measure.

The age of a table is the number of commits, after the key `commit` of its data, that change MEASURED_CODE. A table that
exceeds MAX_AGE must be measured again (tools/figures --measure). Exceptions are in old_tables.txt: tables that were
measured before their data had the key, or that could not be measured again. The list may only shrink: a name that was
not in an earlier version of the list is an error, and so is a name whose table is new enough.

MAX_AGE is two days of the project at the rate of November 2026, about 50 such commits per day. Tables are measured on
machines that a continuous integration does not have, so a smaller number would only fill the list.

Usage: figures_age_test.py SOURCE_DIR
"""
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from verdict import verdict

MEASURED_CODE = ["kernels", "worker", "format/shard", "viewer/stream"]
MAX_AGE = 100
LIST = "tests/architecture/old_tables.txt"


class Repository:
    """The history of a source folder."""

    def __init__(self, root):
        self.root = root

    def git(self, *arguments):
        """Returns the output of git, or None if it fails."""
        done = subprocess.run(["git", "-C", self.root, *arguments], capture_output=True, text=True, check=False)
        return done.stdout.strip() if done.returncode == 0 else None

    def is_complete(self):
        return (self.git("rev-parse", "--is-shallow-repository") == "false"
                and Path(self.git("rev-parse", "--show-toplevel")).resolve() == self.root)

    def age(self, commit, file):
        """Returns the number of commits after `commit` that change the measured code.

        A rebase may have replaced `commit`: then the commit counts that stored its name in the file. The age is 0 if
        none has stored it yet.
        """
        if self.git("merge-base", "--is-ancestor", commit, "HEAD") is None:
            stored = self.git("log", "--format=%H", f"-S{commit}", "--", file)
            if not stored:
                return 0
            commit = stored.splitlines()[-1]
        return int(self.git("rev-list", "--count", f"{commit}..HEAD", "--", *MEASURED_CODE))

    def earlier_lists(self):
        """Yields the names in each committed version of the list."""
        for commit in (self.git("rev-list", "HEAD", "--", LIST) or "").split():
            text = self.git("show", f"{commit}:{LIST}")
            if text is not None:
                yield names_in(text)


def names_in(text):
    return {line for line in text.splitlines() if line and not line.startswith("#")}


def fault(repository, name):
    """Returns why the table is too old, or None."""
    file = f"docs/data/{name}.json"
    commit = json.loads((repository.root / file).read_text(encoding="utf-8")).get("commit")
    if commit is None:
        return "has no key `commit`"
    if not re.fullmatch("[0-9a-f]{12,40}", commit):
        return f"has `{commit}` as its commit, expected 12 hexadecimal digits"
    age = repository.age(commit, file)
    return f"is {age} commits older than the measured code, {MAX_AGE} are allowed" if age > MAX_AGE else None


def problems(repository):
    listed = names_in((repository.root / LIST).read_text(encoding="utf-8"))
    tables = {path.stem for path in (repository.root / "docs/data").glob("*.json")}
    yield from (f"{LIST}: there is no docs/data/{name}.json" for name in sorted(listed - tables))
    for name in sorted(tables):
        why = fault(repository, name)
        if why and name not in listed:
            yield f"docs/data/{name}.json {why}: measure it again with tools/figures --measure"
        if not why and name in listed:
            yield f"{LIST}: {name} is new enough, remove it from the list"
    for earlier in repository.earlier_lists():
        yield from (f"{LIST}: {name} was added, but the list may only shrink" for name in sorted(listed - earlier))


def unnoticed():
    """Yields a line for each fault that this test does not notice in a temporary repository."""
    with tempfile.TemporaryDirectory() as folder:
        made = Repository(Path(folder).resolve())
        for name in ("docs/data", "tests/architecture", "kernels"):
            (made.root / name).mkdir(parents=True)

        def commit(**files):
            for name, text in files.items():
                (made.root / name.replace("__", "/").replace("_json", ".json").replace("_txt", ".txt")).write_text(text)
            made.git("add", "-A")
            made.git("-c", "user.name=a", "-c", "user.email=a@example.org", "commit", "-q", "--allow-empty", "-m", "a")
            return made.git("rev-parse", "HEAD")

        made.git("init", "-q")
        first = commit(tests__architecture__old_tables_txt="# names\nlisted\n", docs__data__listed_json="{}")
        commit(docs__data__new_json=json.dumps({"commit": first}),
               docs__data__rebased_json=json.dumps({"commit": "0123456789ab"}))
        if list(problems(made)):
            yield f"a new and a listed table are not accepted: {list(problems(made))}"
        for change in range(MAX_AGE + 1):
            commit(kernels__code=str(change))
        commit(tests__architecture__old_tables_txt="listed\nadded\nabsent\n", docs__data__added_json="{}",
               docs__data__named_json=json.dumps({"commit": "some commit"}))
        found = "\n".join(problems(made))
        for expected in (f"new.json is {MAX_AGE + 1} commits older", "added was added", "no docs/data/absent.json",
                         f"rebased.json is {MAX_AGE + 1} commits older", "named.json has `some commit` as its commit"):
            if expected not in found:
                yield f"this test does not report `{expected}`: {found}"


if __name__ == "__main__":
    source = Repository(Path(sys.argv[1]).resolve())
    if not source.is_complete():
        print("skipped: the source folder has no complete git history")
        sys.exit(77)
    sys.exit(verdict([*problems(source), *unnoticed()], "tables older than the code that they measure"))
