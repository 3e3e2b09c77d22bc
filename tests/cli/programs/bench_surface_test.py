#!/usr/bin/env python3
"""Benches aim at the surface, wherever it is in its bounding box, and fail if they compared nothing.

Usage: bench_surface_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake
from stored_tables import table_of

MIN_PIXELS = 4


def l_shape(path):
    """Writes two arms along two sides of a box of 60 × 60 m; its middle is empty."""
    path.write_text("v 0 0 0\nv 60 0 0\nv 60 5 0\nv 5 5 0\nv 0 5 0\nv 0 60 0\nv 5 60 0\n"
                    "f 1 2 3 5\nf 5 4 7 6\n")
    return path


def bench(gigabake, source, work, *more):
    return gigabake.run("bench", "accuracy", source, "--local", "--up", "z", "--voxel-size", 0.25, "--size", "32x24",
                        "--samples", 4, "--backend", "cpu", "--json", work / "b.json", *more)


# Regression of 2026-11-25: 12 of 12 views were empty, and the bench printed "FLIP 0.000 ... meets 7 of 7 goals".
def every_view_shows_the_surface(gigabake, source, work):
    result = bench(gigabake, source, work, "-o", work / "out", "--settings", "area-coverage", "--repeats", 1,
                   "--voxels", 500)
    if "without Embree" in result.stderr:
        print(f"skipped: {result.stderr.strip()}")
        sys.exit(77)
    assert result.returncode == 0, result
    views = json.loads((work / "b.json").read_text())["settings"][0]["views"]
    assert len(views) == 12 and all(view["compared_pixels"] >= MIN_PIXELS for view in views), views
    assert any(view["flip"] > 0 for view in views), views
    assert "compared pixels" in result.stdout, result.stdout


def light_and_motion_show_the_surface_too(gigabake, source, work, root):
    for mode, rows in (("--light", "views"), ("--motion", "pairs")):
        result = bench(gigabake, source, work, "-o", work / "out", mode)
        assert result.returncode == 0, result
        found = json.loads((work / "b.json").read_text())[rows]
        assert found and all(row["compared_pixels"] >= MIN_PIXELS for row in found), (mode, found)
        if mode == "--light":
            table = table_of(root, "light", json.loads((work / "b.json").read_text()))
            assert len(table) == len(found) and set(table) <= set(result.stdout.splitlines()), result.stdout


# Regression of 2026-11-25: 0 inner pixels, and exit code 0.
def leaks_without_inner_pixels_fail(gigabake, work):
    tiny = work / "tiny.obj"
    tiny.write_text("v 0 0 0\nv 40 0 0\nv 0 40 0\nf 1 2 3\n")
    found = bench(gigabake, tiny, work, "--leaks")
    rows = json.loads((work / "b.json").read_text())["scenes"][0]["rows"]
    assert found.returncode == 0 and sum(row["inner_pixels"] for row in rows) >= 100, found
    wires = work / "wire.obj"
    wires.write_text("v 0 0 0\nv 40 0 0\nv 40 0.01 0\nv 0 40 0\nv 0 40 0.01\nf 1 2 3\nf 1 4 5\n")
    result = bench(gigabake, wires, work, "--leaks")
    assert result.returncode == 1 and "fewer than 100 inner pixels" in result.stderr, result
    assert len(result.stderr.strip().splitlines()[-1]) <= 300, result.stderr


def a_view_without_enough_pixels_fails_before_anything_is_baked(gigabake, work):
    speck = work / "speck.obj"
    speck.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for mode in ((), ("--light",)):
        result = bench(gigabake, speck, work, "-o", work / "speck", *mode)
        assert result.returncode == 1 and f"fewer than {MIN_PIXELS}" in result.stderr, result
        assert "smaller voxels" in result.stderr, result
    assert not (work / "speck/area-coverage").exists()


def an_invisible_surface_is_refused(gigabake, work):
    (work / "clear.mtl").write_text("newmtl clear\nd 0\n")
    clear = work / "clear.obj"
    clear.write_text("mtllib clear.mtl\nusemtl clear\nv 0 0 0\nv 60 0 0\nv 0 60 0\nf 1 2 3\n")
    for mode in ((), ("--light",), ("--motion",), ("--leaks",)):
        result = bench(gigabake, clear, work, "-o", work / "clear", *mode)
        assert result.returncode not in (0, 134), (mode, result)


def rays_that_hit_nothing_fail(gigabake, source, work):
    gigabake.bake(source, work / "rays", 1, "--local", "--up", "z")
    result = gigabake.run("bench", "query", work / "rays", "--rays", 1, "--seed", 5)
    hits = gigabake.run("bench", "query", work / "rays", "--rays", 20000, "--seed", 5)
    assert hits.returncode == 0, hits
    assert result.returncode == 1 and "nothing was compared" in result.stderr, result


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        source = l_shape(work / "l.obj")
        every_view_shows_the_surface(gigabake, source, work)
        light_and_motion_show_the_surface_too(gigabake, source, work, sys.argv[2])
        leaks_without_inner_pixels_fail(gigabake, work)
        a_view_without_enough_pixels_fails_before_anything_is_baked(gigabake, work)
        an_invisible_surface_is_refused(gigabake, work)
        rays_that_hit_nothing_fail(gigabake, source, work)


if __name__ == "__main__":
    main()
