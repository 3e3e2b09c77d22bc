#!/usr/bin/env python3
"""Fuzzes gigabake's readers with libFuzzer, or makes the corpora of the tests smaller.

  cmake --preset fuzz && cmake --build --preset fuzz
  cmake --preset release -DGIGABAKE_TESTS=OFF && cmake --build --preset release     the program that writes seeds
  tests/fuzz/run.py fuzz --seconds 600 --jobs 2 --data ../shared/data     every reader, from all seeds there are
  tests/fuzz/run.py fuzz obj shard                                        these readers
  tests/fuzz/run.py merge                                                 makes tests/fuzz/corpus again

Seeds are the files that made_seeds.py makes, the files that the program writes from them, and small files of --data.
Inputs that the fuzzers find are written to WORK/<reader>/ and WORK/faults/. `merge` fuzzes without --data, so that no
files of other people get into the project.
"""
import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import made_seeds

SOURCE = Path(__file__).resolve().parents[2]
MAX_SEED = 100_000
KINDS = {"gltf": {".gltf", ".glb"}, "tile": {".b3dm", ".i3dm", ".cmpt"}, "subtree": {".subtree"}, "archive": {".3tz"},
         "obj": {".obj"}, "ply": {".ply"}, "stl": {".stl"}, "image": {".png", ".jpg", ".webp"},
         "raster": {".tif", ".asc", ".hgt"},
         "orthophoto": {".tif", ".jpg"}, "tileset": {".json"}, "scene_json": {".json"}, "shard": {".h5"},
         "scene_xml": {".xml"}, "gigavoxel_list": {".gvp"}, "gigavoxel_tree": {".gvx", ".gvo"}}
READERS = sorted({*made_seeds.made(), *KINDS})
# Leak detection is off because of leaks in libraries (GDAL, HDF5); lasting leaks exceed the memory limit.
ENVIRONMENT = {**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1", "GDAL_PAM_ENABLED": "NO",
               "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=0"}
LIMITS = ["-rss_limit_mb=4000", "-malloc_limit_mb=3000", "-timeout=60", "-report_slow_units=30",
          "-print_final_stats=1"]


def with_parts(path):
    """Returns the parts of a seed of several files, as its reader takes them."""
    content = path.read_bytes()
    beside = []
    if path.suffix == ".gltf":
        uris = re.findall(rb'"uri"\s*:\s*"([^":]+\.bin)"', content)
        beside = [path.parent / uris[0].decode()] if len(uris) == 1 else []
        content = re.sub(rb'("uri"\s*:\s*)"[^":]+\.bin"', rb'\1"data.bin"', content)
    if path.suffix == ".obj":
        beside = sorted(path.parent.glob("*.mtl"))[:1]
        content = re.sub(rb"(?m)^mtllib.*$", b"mtllib material.mtl", content)
    if path.suffix in {".gvx", ".gvo"}:
        beside = sorted(path.parent.glob("*.gvb"))[:1]
    return made_seeds.PART.join([content, *(b.read_bytes() for b in beside if b.is_file())])


def from_folder(folder):
    """Returns seeds by reader: all small files below the folder."""
    seeds = {reader: [] for reader in READERS}
    for path in sorted(folder.rglob("*")):
        if not path.is_file() or path.stat().st_size > MAX_SEED:
            continue
        for reader, kinds in KINDS.items():
            if path.suffix in kinds and len(seed := with_parts(path)) <= MAX_SEED:
                seeds[reader].append(seed)
        named = {"journal": "journal", "survey.cache": "scan_cache"}
        if path.name in named:
            seeds[named[path.name]].append(path.read_bytes())
        if path.name == "status.json":  # independent of the machine
            status = json.loads(path.read_bytes())
            seeds["bake_status"].append(made_seeds.text({**status, "out": "out", "host": "host"}))
    return seeds


def from_program(program):
    """Returns seeds by reader: files that the program writes when it bakes and exports a small square."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "square.gltf"
        source.write_bytes(made_seeds.text(made_seeds.square()))

        def run(*arguments):
            subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)

        for codec in ("lz4", "deflate"):
            out = Path(folder) / codec
            run("bake", source, "-o", out, "--voxel-size", 0.1, "--cell-voxels", 16, "--codec", codec)
            for kind in ("gigavoxel-xml", "gigavoxel-binary"):
                run("export", out / "scene.xml", "--to", kind, "-o", out / kind)
        return from_folder(Path(folder))


def store(folder, contents):
    folder.mkdir(parents=True, exist_ok=True)
    for content in contents:
        (folder / hashlib.sha1(content).hexdigest()).write_bytes(content)


def gather(arguments, readers):
    sources = [{reader: [p.read_bytes() for p in (SOURCE / "tests/fuzz/corpus" / reader).glob("*")]
                for reader in readers}, made_seeds.made(), from_program(arguments.program)]
    if arguments.data:
        sources.append(from_folder(arguments.data))
    for seeds in sources:
        for reader in readers:
            store(arguments.work / reader, seeds.get(reader, []))


def fuzz(arguments, reader, seconds):
    """Runs one fuzzer. Returns its last statistics, and the files with faults."""
    faults = arguments.work / "faults"
    faults.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir="/dev/shm") as scratch:
        log = arguments.work / f"{reader}.log"
        with open(log, "w", encoding="utf-8") as out:
            code = subprocess.run(
                [arguments.build / f"gigabake_fuzz_{reader}", *LIMITS, f"-max_total_time={seconds}",
                 f"-artifact_prefix={faults}/{reader}-", arguments.work / reader],
                stdout=out, stderr=subprocess.STDOUT, check=False, env={**ENVIRONMENT, "TMPDIR": scratch}).returncode
    text = log.read_text(errors="replace")
    numbers = {key: value for key, value in re.findall(r"stat::(\w+):\s+(\d+)", text)}
    covered = re.findall(r"cov: (\d+)", text)
    result = {"reader": reader, "exit": code, "executions": int(numbers.get("number_of_executed_units", 0)),
              "per_s": int(numbers.get("average_exec_per_sec", 0)), "edges": int(covered[-1]) if covered else 0,
              "faults": sorted(p.name for p in faults.glob(f"{reader}-*"))}
    print(json.dumps(result), flush=True)
    return result


def merge(arguments, reader):
    """Stores faults, generated seeds, and the smallest files that together reach the same code."""
    fresh = arguments.work / "merged" / reader
    shutil.rmtree(fresh, ignore_errors=True)
    fresh.mkdir(parents=True)
    with tempfile.TemporaryDirectory(dir="/dev/shm") as scratch:
        program = arguments.build / f"gigabake_fuzz_{reader}"
        subprocess.run([program, *LIMITS, "-merge=1", fresh, arguments.work / reader], check=True,
                       capture_output=True, env={**ENVIRONMENT, "TMPDIR": scratch})
    corpus = SOURCE / "tests/fuzz/corpus" / reader
    kept = {p.name: p.read_bytes() for p in corpus.glob("fault-*")}
    kept.update({hashlib.sha1(s).hexdigest()[:12]: s for s in made_seeds.made().get(reader, [])})
    total = 0
    for path in sorted(fresh.iterdir(), key=lambda p: (p.stat().st_size, p.name)):
        total += path.stat().st_size
        if total > arguments.max_bytes and kept:
            break
        kept[path.name[:12]] = path.read_bytes()
    shutil.rmtree(corpus, ignore_errors=True)
    corpus.mkdir(parents=True)
    for name, content in kept.items():
        (corpus / name).write_bytes(content)
    print(f"{reader}: {len(kept)} files, {sum(map(len, kept.values()))} bytes", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["fuzz", "merge"])
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"of {', '.join(READERS)}; default: all")
    parser.add_argument("--seconds", type=int, default=600, help="of each fuzzer")
    parser.add_argument("--jobs", type=int, default=max(1, (os.cpu_count() or 2) // 2), help="fuzzers at a time")
    parser.add_argument("--build", type=Path, default=SOURCE / "build/fuzz")
    parser.add_argument("--program", type=Path, default=SOURCE / "build/release/gigabake")
    parser.add_argument("--data", type=Path, help="a folder of sources")
    parser.add_argument("--work", type=Path, default=SOURCE / "build/fuzz/work")
    parser.add_argument("--most-bytes", type=int, default=2_000, help="merge: max bytes without faults and seeds")
    arguments = parser.parse_args()
    readers = arguments.readers or READERS
    if unknown := set(readers) - set(READERS):
        parser.error(f"no such reader: {', '.join(sorted(unknown))}")
    if arguments.action == "merge":
        arguments.data, arguments.work = None, arguments.work / "own"
    arguments.work.mkdir(parents=True, exist_ok=True)
    gather(arguments, readers)
    with ThreadPoolExecutor(arguments.jobs) as pool:
        results = list(pool.map(lambda reader: fuzz(arguments, reader, arguments.seconds), readers))
        if arguments.action == "merge":
            list(pool.map(lambda reader: merge(arguments, reader), readers))
    return 1 if any(r["exit"] != 0 for r in results) else 0


if __name__ == "__main__":
    sys.exit(main())
