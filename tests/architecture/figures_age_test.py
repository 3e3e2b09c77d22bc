#!/usr/bin/env python3
"""Checks that tables of measured values are not much older than the code that they measure.

The age of a table is the number of commits, after the commit of its rows, that change MEASURED_CODE. The commit is that
of the run in docs/data/MACHINE.json, or the key `commit` of a table by hand. A table that exceeds MAX_AGE must be
measured again (tools/figures --measure). Exceptions are in old_tables.txt: tables that were measured before their data
had a commit, or that could not be measured again. The list may only shrink: a name that was not in an earlier version
of the list is an error, and so is a name whose table is new enough. `NEW was OLD` renames a table of the list.

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

    def age(self, commit):
        """Returns the number of commits after `commit` that change the measured code.

        A rebase may have replaced `commit`: then the commit counts that first stored its name in docs/data. The age is
        0 if none has stored it yet.
        """
        if self.git("merge-base", "--is-ancestor", commit, "HEAD") is None:
            stored = self.git("log", "--format=%H", f"-S{commit}", "--", "docs/data")
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
    """Returns a table from each name of a list to its former name, which is mostly the same."""
    lines = [line.split(" was ") for line in text.splitlines() if line and not line.startswith("#")]
    return {line[0]: line[-1] for line in lines}


def commits_of_tables(root):
    """Returns a table from each name to the commits of its rows. Tables that copy rows of others have none."""
    commits = {}
    for path in (root / "docs/data").glob("*/*.json"):
        table = json.loads(path.read_text(encoding="utf-8"))
        if "copies" not in table.get("measured", {}):
            commits[path.stem] = [table.get("commit")] if "rows" in table else []
    for path in (root / "docs/data").glob("*.json"):
        for run in json.loads(path.read_text(encoding="utf-8"))["runs"]:
            for name in run["tables"]:
                commits.setdefault(name, []).append(run["commit"])
    return commits


def fault(repository, commits):
    """Returns why the rows of a table are too old, or None."""
    if None in commits or not commits:
        return "has no commit"
    for commit in commits:
        if not re.fullmatch("[0-9a-f]{12,40}", commit):
            return f"has `{commit}` as its commit, expected 12 hexadecimal digits"
        age = repository.age(commit)
        if age > MAX_AGE:
            return f"is {age} commits older than the measured code, {MAX_AGE} are allowed"
    return None


def problems(repository):
    listed = names_in((repository.root / LIST).read_text(encoding="utf-8"))
    tables = commits_of_tables(repository.root)
    yield from (f"{LIST}: there is no table {name}" for name in sorted(set(listed) - set(tables)))
    for name, commits in sorted(tables.items()):
        why = fault(repository, commits)
        if why and name not in listed:
            yield f"the table {name} {why}: measure it again with tools/figures --measure"
        if not why and name in listed:
            yield f"{LIST}: {name} is new enough, remove it from the list"
    for earlier in repository.earlier_lists():
        yield from (f"{LIST}: {name} was added, but the list may only shrink" for name, former in sorted(listed.items())
                    if name not in earlier and (former not in earlier or former in tables))


class MadeRepository(Repository):
    """A temporary repository with tables."""

    def commit(self, **files):
        """Writes files, whose names have __ for each slash, and commits them. Returns the commit."""
        for name, text in files.items():
            path = self.root / name.replace("__", "/").replace("_json", ".json").replace("_txt", ".txt")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        self.git("add", "-A")
        self.git("-c", "user.name=a", "-c", "user.email=a@example.org", "commit", "-q", "--allow-empty", "-m", "a")
        return self.git("rev-parse", "HEAD")


def rows(commit):
    """Returns the definition of a table by hand."""
    return json.dumps({"measured": "by hand", "commit": commit, "rows": []})


def machine(commit, *tables):
    """Returns the data of a machine."""
    return json.dumps({"machine": "m", "runs": [{"commit": commit, "tables": {name: [] for name in tables}}]})


def unnoticed():
    """Yields a line for each fault that this test does not notice in a temporary repository."""
    with tempfile.TemporaryDirectory() as folder:
        made = MadeRepository(Path(folder).resolve())
        made.git("init", "-q")
        first = made.commit(tests__architecture__old_tables_txt="# names\nlisted\nold\n", docs__data__a__run_json="{}",
                            docs__data__a__old_json=rows(None), docs__data__a__listed_json=rows(None))
        (made.root / "docs/data/a/old.json").unlink()
        made.commit(docs__data__m_json=machine(first, "run"), docs__data__a__rebased_json=rows("0123456789ab"),
                    docs__data__a__copied_json=json.dumps({"measured": {"copies": {}}}),
                    docs__data__a__renamed_json=rows(None),
                    tests__architecture__old_tables_txt="listed\nrenamed was old\n")
        if list(problems(made)):
            yield f"new, listed and renamed tables are not accepted: {list(problems(made))}"
        for change in range(MAX_AGE + 1):
            made.commit(kernels__code=str(change))
        made.commit(tests__architecture__old_tables_txt="listed\nadded\nabsent\nother was listed\n",
                    docs__data__a__added_json=rows(None), docs__data__a__other_json=rows(None),
                    docs__data__a__named_json=rows("some commit"))
        found = "\n".join(problems(made))
        for expected in (f"run is {MAX_AGE + 1} commits older", "added was added", "no table absent", "other was added",
                         f"rebased is {MAX_AGE + 1} commits older", "named has `some commit` as its commit"):
            if expected not in found:
                yield f"this test does not report `{expected}`: {found}"


if __name__ == "__main__":
    source = Repository(Path(sys.argv[1]).resolve())
    if not source.is_complete():
        print("skipped: the source folder has no complete git history")
        sys.exit(77)
    sys.exit(verdict([*problems(source), *unnoticed()], "tables older than the code that they measure"))
