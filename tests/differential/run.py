#!/usr/bin/env python3
"""Writes odd but valid sources and compares what gigabake, assimp and GDAL read with what the generator wrote.

Usage: run.py GIGABAKE [--files N] [--seed S] [--keep DIR] [--only NUMBER] [--kind FORMAT]

File NUMBER of seed S is always the same. A file with a difference is kept in DIR, with a text of its differences.
"""
import argparse
import concurrent.futures
import os
import random
import shutil
import sys
import tempfile
import traceback
from pathlib import Path

try:
    from osgeo import gdal
except ImportError:
    print("skipped: expected python3-gdal to be installed")
    sys.exit(77)

import earth_files
import gltf_files
import mesh_bakes
import obj_files
import other_programs
import ply_files
import raster_bakes
import raster_files
import stl_files
import tileset_files
from odd import Odd

gdal.UseExceptions()
gdal.PushErrorHandler("CPLQuietErrorHandler")  # its warnings about odd files are expected

WRITERS = {"obj": obj_files.write_obj, "ply": ply_files.write_ply, "stl": stl_files.write_stl,
           "gltf": gltf_files.write_gltf, "tileset": tileset_files.write_tileset, "raster": raster_files.write_raster,
           "earth": earth_files.write_earth}
SHARES = ["obj"] * 6 + ["ply"] * 5 + ["stl"] * 2 + ["gltf"] * 6 + ["tileset"] * 4
BATCH = 40
USUAL_SEED = 20261125  # a fixed seed, so that no merge depends on luck
PLAIN = 0.3  # fraction of files that assimp reads too


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gigabake")
    parser.add_argument("--files", type=int, default=2000)
    parser.add_argument("--seed", help="a number, or random (GIGABAKE_TEST_SEED, or the same in every run)")
    parser.add_argument("--keep", type=Path, help="folder for files with differences")
    parser.add_argument("--only", type=int, help="one file by its number, which is kept whatever its result")
    parser.add_argument("--kind", choices=WRITERS, metavar="FORMAT", help="files of one format only")
    parser.add_argument("--jobs", type=int, default=2)
    return parser.parse_args()


def up_of(seed, batch):
    """Returns the axis that points up in the sources of a batch, and its options."""
    up = Odd(f"{seed}/batch {batch}").choice(["default", "default", "z", "x"])
    if up == "default":
        return {"tileset": "z"}, "y", []
    return {}, up, ["--up", up]


def origin_of(seed, batch):
    """Returns a place on Earth: latitude and longitude in degrees, height in metres."""
    odd = Odd(f"{seed}/origin {batch}")
    return odd.choice([(47.37, 8.54, 430.0), (-33.9, 151.2, 20.0), (0.0, 180.0, 0.0), (89.5, -45.0, 10.0),
                       (37.4, -122.1, 5.0), (odd.uniform(-90, 90), odd.uniform(-180, 180), odd.uniform(-100, 4000))])


def write_case(options, root, number):
    """Writes a file by its number. In every eight batches, one has rasters and one has tilesets on Earth."""
    odd = Odd(f"{options.seed}/{number}")
    odd.is_plain = odd.maybe(PLAIN)
    batch = number // BATCH
    kind = options.kind or {6: "earth", 7: "raster"}.get(batch % 8) or odd.choice(SHARES)
    if kind == "raster":
        region = (Odd(f"{options.seed}/region {batch}").choice(list(raster_files.REGIONS)), number % BATCH)
        return written(odd, kind, root, number, region)
    if kind == "earth":
        return written(odd, kind, root, number, (origin_of(options.seed, batch), number % BATCH))
    ups, up, _ = up_of(options.seed, batch)
    return written(odd, kind, root, number, ups.get(kind, up))


def written(odd, kind, root, number, frame):
    folder = root / f"{number:06}"
    folder.mkdir()
    case = WRITERS[kind](odd, folder, frame)
    case.folder, case.index, case.is_plain = folder, number, odd.is_plain
    return case


def check_batch(options, program, root, numbers):
    """Returns the differences of some files: (case, texts)."""
    folder = root / f"batch{numbers[0]}"
    folder.mkdir(parents=True)
    cases = [write_case(options, folder, n) for n in numbers]
    batch = numbers[0] // BATCH
    surface = Odd(f"{options.seed}/surface {batch}").choice(["area", "thin"])
    words = up_of(options.seed, batch)[2]
    if cases[0].kind == "earth":
        words = ["--origin", ",".join(map(str, origin_of(options.seed, batch)))]
    words = [*words, "--surface", surface]
    if cases[0].kind == "raster":
        words = []
        found = raster_bakes.compare(program, folder, cases)
    else:
        found = mesh_bakes.compare(program, folder, cases, words)
    for case in cases:
        if case.is_plain:
            found += [(case, [text]) for text in other_programs.differences(case)]
    for case, texts in found:
        report(options, case, texts, words)
    if options.only is None:
        shutil.rmtree(folder)
    return found


def report(options, case, texts, words):
    """Prints the differences of a file, and keeps the file."""
    text = "\n".join([f"file {case.index} ({case.kind}, {'; '.join(case.notes)}): {case.folder.name}/{case.source}",
                      f"  again: run.py GIGABAKE --seed {options.seed} --only {case.index}"
                      + (f" --kind {options.kind}" if options.kind else "") + f"; options {' '.join(words)}",
                      *("  " + t for t in texts)])
    print(text, flush=True)
    if options.keep:
        kept = options.keep / str(options.seed) / case.folder.name
        shutil.copytree(case.folder, kept, dirs_exist_ok=True)
        with open(kept / "DIFFERENCES.txt", "a", encoding="utf-8", errors="replace") as out:
            out.write(text + "\n")


def check_all(options, program, root):
    """Returns the number of files with differences."""
    numbers = [options.only] if options.only is not None else list(range(options.files))
    batches = [numbers[i:i + BATCH] for i in range(0, len(numbers), BATCH)]
    wrong, faults = set(), 0
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        futures = [pool.submit(check_batch, options, program, root, batch) for batch in batches]
        for future in futures:
            try:
                wrong |= {case.index for case, _ in future.result()}
            except Exception:  # only this batch failed: the others still have results
                traceback.print_exc()
                faults += 1
    return len(wrong) + faults


def main():
    options = arguments()
    if missing := other_programs.missing():
        print(f"skipped: expected to be installed: {', '.join(missing)} (tools/install-packages test)")
        return 77
    seed = options.seed or os.environ.get("GIGABAKE_TEST_SEED") or USUAL_SEED
    options.seed = random.randrange(1 << 32) if seed == "random" else int(seed)
    print(f"seed {options.seed}, {options.files} files", flush=True)
    program = mesh_bakes.Program(options.gigabake)
    mesh_bakes.harness.skip_without(program, "GDAL", "probe.tif")
    with tempfile.TemporaryDirectory() as scratch:
        root = options.keep / "all" if options.keep and options.only is not None else Path(scratch)
        wrong = check_all(options, program, root)
    print(f"{wrong} of {options.files if options.only is None else 1} files with differences (seed {options.seed})")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
