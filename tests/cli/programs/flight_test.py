#!/usr/bin/env python3
"""Tests `bench accuracy --flight` on a tiny scene: flights, still images of voxels and of a mesh, bad options.

Usage: flight_test.py GIGABAKE SOURCE_DIR
"""
import json
import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake

STEPS, RATES = (20, 5), (60, 120)
STILLS = [(at, mode) for at in (0, 0.25, 0.5, 0.75) for mode in ("albedo", "lit")]


def flight(gigabake, work, *options, out="out"):
    return gigabake.run("bench", "accuracy", work / "sample/tileset.json", "--flight", "--voxel-size", 1, "--samples",
                        4, "--size", "32x24", "--backend", "cpu", "-o", work / out, *options)


def measure(gigabake, work):
    result = flight(gigabake, work, "--steps", ",".join(map(str, STEPS)), "--json", work / "flight.json")
    if "without Embree" in result.stderr or "without meshoptimizer" in result.stderr:
        print(f"skipped: {result.stderr.strip()}")
        sys.exit(77)
    assert result.returncode == 0, result
    return json.loads((work / "flight.json").read_text()), result.stdout


def every_speed_is_flown_at_every_rate(bench):
    flights = bench["flights"]
    assert [(row["step_m"], row["frames_per_s"]) for row in flights] == [(s, r) for s in STEPS for r in RATES], flights
    for row in flights:
        assert row["frames"] == math.ceil(bench["orbit_m"] / row["step_m"]), row
        assert 0 < row["median_s"] <= row["p99_s"] <= row["worst_s"], row
        assert 0 < row["worst_psnr_db"] <= row["mean_psnr_db"] <= 100, row
        assert 0 < row["compared_frames"] <= row["frames"] and row["surface_pixels"] > 0, row
        assert 0 <= row["late"] <= 1, row
        assert row["uploaded_bytes"] > 8 * row["uploads"] > 0 and row["peak_bytes"] > 0, row


def stills_compare_voxels_and_mesh(bench):
    stills = bench["stills"]
    assert [(row["at"], row["mode"]) for row in stills] == STILLS, stills
    for row in stills:
        for images in ("voxels", "mesh"):
            assert 0 <= row[images]["flip"] < 1 and 5 < row[images]["psnr_db"] <= 100, row
            assert row[images]["bytes"] > 0, row
        assert 0 < row["mesh"]["triangles"] <= bench["source_triangles"], row
        assert 0 < row["compared_pixels"] <= 32 * 24, row


def tables_show_each_row(bench, text):
    rows = [line for line in text.splitlines() if line.startswith("| ") and "---" not in line]
    assert len(rows) == 2 + len(bench["flights"]) + len(bench["stills"]), text
    assert "without textures" in text, text


def bad_options_are_refused(gigabake, work):
    for words, part in ((("--steps", "0"), "--steps"), (("--steps", "x"), "--steps"), (("--hard",), "--hard"),
                        (("--size", "4x4"), "--size")):
        result = flight(gigabake, work, *words, out="refused")
        assert result.returncode == 2 and part in result.stderr, (words, result)
        assert not (work / "refused").exists(), words
    result = gigabake.run("bench", "accuracy", work / "sample/tileset.json", "--voxel-size", 1, "-o", work / "refused",
                          "--steps", "5")
    assert result.returncode == 2 and "--flight" in result.stderr, result


def an_orbit_of_few_frames_is_refused(gigabake, work):
    result = flight(gigabake, work, "--steps", "5,1000")
    assert result.returncode == 2 and "--steps" in result.stderr and "expected 4 to" in result.stderr, result


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        gigabake.succeed("sample", work / "sample", "--size", 64, "--seed", 7)
        bench, text = measure(gigabake, work)
        every_speed_is_flown_at_every_rate(bench)
        stills_compare_voxels_and_mesh(bench)
        tables_show_each_row(bench, text)
        bad_options_are_refused(gigabake, work)
        an_orbit_of_few_frames_is_refused(gigabake, work)


if __name__ == "__main__":
    main()
