#!/usr/bin/env python3
"""Tests `bench accuracy --motion` on a tiny scene: pairs of frames along fixed paths, and the report about them.

Usage: motion_test.py GIGABAKE SOURCE_DIR
"""
import json
import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake
from stored_tables import table_of

PATHS = ("forward", "aside", "climb", "zoom")
PAIRS = 6  # per path
WAYS = ("plain", "blended")


def measure(gigabake, work):
    result = gigabake.run("bench", "accuracy", work / "sample/tileset.json", "--motion", "--voxel-size", 1, "--samples",
                          4, "--size", "32x24", "--backend", "cpu", "-o", work / "out", "--json", work / "motion.json")
    if "without Embree" in result.stderr:
        print(f"skipped: {result.stderr.strip()}")
        sys.exit(77)
    assert result.returncode == 0, result
    return json.loads((work / "motion.json").read_text()), result.stdout


def every_path_has_its_pairs(bench):
    pairs = [(pair["path"], round(pair["at"] * (PAIRS - 1))) for pair in bench["pairs"]]
    assert sorted(pairs) == sorted((path, i) for path in PATHS for i in range(PAIRS)), pairs
    for pair in bench["pairs"]:
        assert 0 < pair["reference"] < 1, pair
        for way in WAYS:
            assert all(math.isfinite(v) and 0 <= v <= 1 for v in pair[way].values()), pair


def what_is_said_of_all_follows_from_the_pairs(bench, text):
    for way, name in zip(WAYS, ("", "_blended")):
        ratios = [pair[way]["pair"] / pair["reference"] for pair in bench["pairs"]]
        stills = [pair[way]["still"] for pair in bench["pairs"]]
        assert math.isclose(bench["worst_ratio" + name], max(ratios)), (name, ratios)
        assert math.isclose(bench["mean_still" + name], sum(stills) / len(stills)), (name, stills)
    assert f"differs by {bench['worst_ratio']:.2f} times" in text, text


def levels_are_blended(bench):
    assert any(pair["plain"]["pair"] != pair["blended"]["pair"] for pair in bench["pairs"]), bench


def tables_of_the_document_can_be_stored(bench, source):
    assert len(table_of(source, "motion", bench)) == len(WAYS), bench
    rows = [row.split(" | ")[0] for row in table_of(source, "motion-pairs", bench)]
    assert len(rows) == len(set(rows)) == 14 and "| `aside 0.4`" in rows, rows


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        gigabake.succeed("sample", work / "sample", "--size", 64, "--seed", 7)
        bench, text = measure(gigabake, work)
        every_path_has_its_pairs(bench)
        what_is_said_of_all_follows_from_the_pairs(bench, text)
        levels_are_blended(bench)
        tables_of_the_document_can_be_stored(bench, sys.argv[2])


if __name__ == "__main__":
    main()
