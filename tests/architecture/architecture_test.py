#!/usr/bin/env python3
"""The tree is the architecture: which folder may include which, who may know MPI and CUDA, how long a file may be.

Usage: architecture_test.py SOURCE_DIR
"""
import re
import sys
from pathlib import Path

# folder: the folders of ours that it may include.
MAY_INCLUDE = {
    "format": {"format"},
    "kernels": {"kernels"},
    "worker": {"worker", "format", "kernels"},
    "scheduler": {"scheduler", "format"},
    "viewer": {"viewer", "format", "kernels"},
    "cluster": {"cluster", "scheduler", "worker", "format"},
}
EVERYTHING = set(MAY_INCLUDE) | {"app", "bench", "tests"}
FOLDERS = {**MAY_INCLUDE, "app": EVERYTHING, "bench": EVERYTHING, "tests": EVERYTHING}

# (header, where it may stand, why)
RESERVED = [
    (r"mpi\.h", r"cluster/|tests/cluster/", "only cluster/ talks MPI"),
    (r"cuda\w*\.h|cooperative_groups.*|cub/.*|thrust/.*", r"kernels/|tests/kernels/", "only kernels/ talks CUDA"),
    (r"thread|future|mutex|condition_variable", r"(?!kernels/)|kernels/policy\.cpp",
     "of kernels/, only the policy has threads"),
    (r"fstream|filesystem|iostream|cstdio", r"(?!kernels/)", "kernels/ knows no files"),
    (r"tiny_gltf\.h|hdf5\.h|pugixml\.hpp|png\.h|jpeglib\.h|(OpenEXR|Imath)/.*", r"format/|viewer/.*\.cpp|tests/",
     "files are format's business"),
    (r"openvdb/.*", r"format/openvdb/.*\.cpp|tests/", "a build without OpenVDB has the rest"),
    (r"nanovdb/.*", r"tests/", "format/nanovdb_layout.h says what is needed of it"),
]

# What a folder's headers must not carry into the folders above it.
HEAVY = r"nlohmann/json\.hpp|tiny_gltf\.h|hdf5\.h|pugixml\.hpp"

SOURCE = {".h", ".cpp", ".cu", ".cuh"}
LONGEST_FILE = 400
LONGEST_LINE = 120


def sources(root):
    for folder in sorted(FOLDERS):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SOURCE | {".py"}:
                yield path


def includes(text):
    """Pairs of ("quoted", "") or ("", "bracketed")."""
    return re.findall(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)', text, re.M)


def carried_headers(root, header, seen):
    """Library headers that including `header` brings along."""
    if header in seen or not (root / header).exists():
        return
    seen.add(header)
    for quoted, bracketed in includes((root / header).read_text(encoding="utf-8")):
        if bracketed:
            yield bracketed
        else:
            yield from carried_headers(root, quoted, seen)


def include_problems(root, name, text):
    folder = name.split("/")[0]
    for quoted, bracketed in includes(text):
        if quoted and quoted.split("/")[0] != folder:
            for carried in carried_headers(root, quoted, set()):
                if re.fullmatch(HEAVY, carried):
                    yield f'includes "{quoted}", which carries <{carried}> out of its folder'
        if quoted and not (folder == "tests" and (root / name).parent.joinpath(quoted).exists()):
            target = quoted.split("/")[0]
            if not (root / quoted).exists():
                yield f'includes "{quoted}", which is not a path from the source root'
            elif target not in FOLDERS[folder]:
                yield f'includes "{quoted}": {folder}/ may include {", ".join(sorted(FOLDERS[folder]))} only'
        for header, allowed, why in RESERVED:
            if bracketed and re.fullmatch(header, bracketed) and not re.match(allowed, name):
                yield f"includes <{bracketed}>: {why}"


def text_problems(name, text):
    lines = text.splitlines()
    if len(lines) > LONGEST_FILE:
        yield f"has {len(lines)} lines, more than {LONGEST_FILE}: it holds more than one idea"
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            yield f"line {number} has {len(line)} characters, more than {LONGEST_LINE}"
        if re.search(r"\b(TODO|FIXME|XXX)\b", line) and not name.startswith("tests/architecture/"):
            yield f"line {number} leaves something to do"


def header_problems(name, text):
    if not text.startswith("///"):
        yield "does not open with what it is (///)"
    if "#pragma once" not in text:
        yield "lacks #pragma once"
    if re.search(r"^using namespace", text, re.M):
        yield "opens a namespace for everyone who includes it"


def problems(root):
    for path in sources(root):
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        found = list(text_problems(name, text))
        if path.suffix in SOURCE:
            found += include_problems(root, name, text)
        if path.suffix in {".h", ".cuh"}:
            found += header_problems(name, text)
        if path.suffix in {".cu", ".cuh"} and not name.startswith(("kernels/", "tests/")):
            found.append("only kernels/ and tests have CUDA files")
        for problem in found:
            yield f"{name}: {problem}"


def main():
    found = list(problems(Path(sys.argv[1])))
    for line in found:
        print(line)
    print(f"{len(found)} breaches of the architecture")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
