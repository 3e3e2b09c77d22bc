#!/usr/bin/env python3
"""`bench accuracy --hard`: the suite of hard cases, as a user runs it.

Usage: hard_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake
from stored_tables import table_of


def every_bound_holds(gigabake, work, source):
    result = gigabake.run("bench", "accuracy", "--hard", "--backend", "cpu", "--million-triangles", 1,
                          "--json", work / "hard.json", "-o", work / "kept")
    if "without GMP" in result.stderr:
        print(f"skipped: {result.stderr.strip()}")
        sys.exit(77)
    assert result.returncode == 0, result
    assert "every bound holds" in result.stdout, result
    bench = json.loads((work / "hard.json").read_text())
    assert bench["holds"] and bench["backend"] == "cpu", bench
    for case in bench["cases"]:
        assert case["holds"] and "error" not in case, case
        for name, figure in case["figures"].items():
            assert figure.get("at_least", 0) <= figure["measured"] <= figure["bound"], (case["name"], name, figure)
    leaks = bench["leaks"]
    assert len(leaks["scenes"]) == 3 and all(scene["opaque"] and scene["rows"] for scene in leaks["scenes"]), leaks
    assert leaks["bounded"] or "not yet bounded" in result.stdout, result
    printed = set(result.stdout.replace("|  |", "| |").splitlines())
    for table in ("hard-cases", "surfaces"):
        assert set(table_of(source, table, bench)) <= printed, result.stdout
    return bench


def the_documents_list_every_case(bench, source):
    """Every case is in the table of a document; ties, leaves and classes have separate tables."""
    def listed(page, heading):
        section = (Path(source) / f"docs/{page}.md").read_text().split(f"## {heading}")[1].split("\n## ")[0]
        return re.findall(r"^\| `([^`]+)` \|", section, re.M)

    def names(are_surfaces):
        elsewhere = re.compile("ties.*|.*leaves|classes")
        return [case["name"] for case in bench["cases"]
                if not elsewhere.fullmatch(case["group"]) and (case["group"] == "surfaces") == are_surfaces]

    assert listed("accuracy-suite", "The suite") == names(False), listed("accuracy-suite", "The suite")
    assert listed("accuracy-rendering", "Surfaces of real scenes") == names(True), names(True)


def surfaces_of_real_scenes_have_goals(bench):
    """A value that meets its goal has the goal as its bound: it may not be lost again."""
    cases = [case for case in bench["cases"] if case["group"] == "surfaces"]
    assert len(cases) == 17, [case["name"] for case in cases]
    for case in cases:
        for figure in case["figures"].values():
            low, high = figure["goal"]
            assert figure["meets_goal"] == (low <= figure["measured"] <= high), (case, figure)
            assert figure["at_least"] <= low and figure["bound"] >= high, (case, figure)


def wrong_usage_is_refused(gigabake, work):
    for arguments, text in ((("--hard", work), "expected no SOURCE"),
                            ((), "expected SOURCE, -o and --voxel-size, or --hard, or --leaks"),
                            (("--hard", "--backend", "abacus"), "--backend: expected one of")):
        result = gigabake.run("bench", "accuracy", *arguments)
        assert result.returncode == 2 and text in result.stderr, result


def kept_scenes_can_be_baked(gigabake, work):
    """Option -o keeps the scenes, so that a user can bake and inspect each case."""
    gigabake.bake(work / "kept/ecef-antimeridian/tileset.json", work / "baked", 0.01, "--cell-voxels", 128)


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        bench = every_bound_holds(gigabake, work, sys.argv[2])
        the_documents_list_every_case(bench, sys.argv[2])
        surfaces_of_real_scenes_have_goals(bench)
        wrong_usage_is_refused(gigabake, work)
        kept_scenes_can_be_baked(gigabake, work)


if __name__ == "__main__":
    main()
