#!/usr/bin/env python3
"""Checks the architecture: allowed includes between folders, users of MPI and CUDA, length of files and lines.

Usage: architecture_test.py SOURCE_DIR
"""
import re
import sys
from pathlib import Path

from verdict import verdict

RAYS = ["kernels/pool", "kernels/marching", "kernels/light"]
# Modules that rendering an image of a scene needs.
SHOWN = ["core", "format/system", "format/shard", "format/scene", "kernels/body", "kernels/render", *RAYS]
# Each module with the other modules of gigabake that it may include. A module only includes modules listed before it.
MODULES = {
    "core": [],
    "format/system": ["core"],
    "format/area": ["core", "format/system"],
    "format/edit": ["core", "format/system", "format/area"],
    "format/source": ["core", "format/system", "format/area", "format/edit"],
    "format/shard": ["core", "format/system"],
    "format/scene": ["core", "format/system", "format/shard"],
    "format/job": ["core", "format/system", "format/area", "format/edit", "format/source", "format/shard",
                   "format/scene"],
    "format/export": ["core", "format/system", "format/shard", "format/scene"],
    "sample": ["core", "format/system"],
    "kernels/body": ["core"],
    "kernels/cpu": ["core", "kernels/body"],
    "kernels/cuda": ["core", "kernels/body", "kernels/cpu"],
    "kernels/pack": ["core", "kernels/body", "kernels/cpu", "kernels/cuda"],
    "kernels/pool": ["core", "kernels/body"],
    "kernels/marching": ["core", "kernels/body", "kernels/cuda", "kernels/pool"],
    "kernels/light": ["core", "kernels/body", "kernels/cuda", "kernels/pool", "kernels/marching"],
    "kernels/render": ["core", "kernels/body", "kernels/cuda", *RAYS],
    "worker": ["core", "format/system", "format/area", "format/edit", "format/source", "format/shard", "format/job",
               "kernels/body", "kernels/cpu", "kernels/cuda", "kernels/pack"],
    "scheduler": ["core", "format/system", "format/area", "format/edit", "format/source", "format/job"],
    "cluster": ["core", "format/system", "format/area", "format/edit", "format/source", "format/scene", "format/job",
                "format/export", "scheduler", "worker"],
    "viewer/light": SHOWN,
    "viewer/stream": [*SHOWN, "format/edit", "viewer/light"],
    "viewer/pictures": [*SHOWN, "format/edit", "viewer/light", "viewer/stream"],
    "viewer/live": [*SHOWN, "viewer/light", "viewer/stream", "viewer/pictures"],
    "viewer/window": [*SHOWN, "viewer/live", "viewer/pictures"],
    "viewer/web": [*SHOWN, "viewer/live", "viewer/pictures"],
    "query/first_hit": ["core", "kernels/body", "kernels/cuda", "kernels/marching"],
    "query": [*SHOWN, "format/area", "query/first_hit", "viewer/stream"],
}
# These may include all modules.
JOINTS = ["app", "bench", "examples", "tests"]

# Files that may contain CUDA code.
CUDA_FILES = r"kernels/(?!body/|cpu/)\w+/|query/first_hit/|tests/"
# Tuples of header, files that may include it, and the reason.
RESERVED = [
    (r"mpi\.h", r"cluster/|tests/cluster/", "only cluster/ talks MPI"),
    (r"cuda\w*\.h|cooperative_groups.*|cub/.*|thrust/.*", CUDA_FILES,
     "kernels/body and kernels/cpu, and all other folders, have no CUDA code"),
    (r"thread|future|mutex|condition_variable", r"(?!kernels/|query/first_hit/|core/)|core/base/thread_pool\.cpp",
     "kernels, first hits and core loop through core/base/thread_pool.h"),
    (r"fstream|filesystem|iostream|cstdio",
     r"(?!kernels/|query/first_hit/|core/)|core/(base/error|base/memory_limit|io/byte_cursor)\.(h|cpp)",
     "kernels and core know no files"),
    (r"tiny_gltf\.h|hdf5\.h|pugixml\.hpp|png\.h|jpeglib\.h|(OpenEXR|Imath)/.*", 
     r"format/|sample/|viewer/.*\.cpp|query/\w+\.cpp|app/manual/library_versions\.cpp|tests/",
     "format/ reads and writes files"),
    (r"openvdb/.*", r"format/export/openvdb/.*\.cpp|tests/", "a build without OpenVDB has the rest"),
    (r"nanovdb/.*", r"tests/", "format/export/nanovdb/nanovdb_layout.h declares the layout that the export needs"),
]

# Headers that a folder's headers must not include for the folders that include them.
HEAVY = r"nlohmann/json\.hpp|tiny_gltf\.h|hdf5\.h|pugixml\.hpp"

# Options of mpirun and srun, and the separator of images in a stream.
OPTIONS_OF_OTHERS = {"--bind-to", "--mpi", "--frame"}

SOURCE = {".h", ".cpp", ".cu", ".cuh"}
MAX_FILE_LINES = 400
MAX_LINE = 120


def module_of(name):
    """Returns the module of a path from the source root; None if it is in no module."""
    parts = name.split("/")
    if parts[0] in JOINTS:
        return parts[0]
    return next((module for module in ("/".join(parts[:n]) for n in (2, 1)) if module in MODULES), None)


def sources(root):
    for folder in sorted({module.split("/")[0] for module in MODULES} | set(JOINTS)):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SOURCE | {".py"}:
                yield path


def includes(text):
    """Returns pairs ("quoted", "") or ("", "bracketed")."""
    return re.findall(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)', text, re.M)


def carried_headers(root, header, seen):
    """Yields the library headers that `header` includes, directly or through other headers."""
    if header in seen or not (root / header).exists():
        return
    seen.add(header)
    for quoted, bracketed in includes((root / header).read_text(encoding="utf-8")):
        if bracketed:
            yield bracketed
        else:
            yield from carried_headers(root, quoted, seen)


def include_problems(root, name, text):
    module = module_of(name)
    if module is None:
        yield "belongs to no module: add its folder to the table of this test and to docs/architecture.md"
        return
    for quoted, bracketed in includes(text):
        if quoted and not (module == "tests" and (root / name).parent.joinpath(quoted).exists()):
            yield from quoted_problems(root, module, quoted)
        for header, allowed, why in RESERVED:
            if bracketed and re.fullmatch(header, bracketed) and not re.match(allowed, name):
                yield f"includes <{bracketed}>: {why}"


def quoted_problems(root, module, quoted):
    target = module_of(quoted)
    if not (root / quoted).exists():
        yield f'includes "{quoted}", which is not a path from the source root'
        return
    if target != module and module not in JOINTS and target not in MODULES[module]:
        yield f'includes "{quoted}": {module}/ may include {", ".join(MODULES[module]) or "nothing of ours"} only'
    if target.split("/")[0] != module.split("/")[0]:
        for carried in carried_headers(root, quoted, set()):
            if re.fullmatch(HEAVY, carried):
                yield f'includes "{quoted}", which includes <{carried}> outside its module'


def text_problems(name, text):
    lines = text.splitlines()
    if len(lines) > MAX_FILE_LINES:
        yield f"has {len(lines)} lines, more than {MAX_FILE_LINES}: it holds more than one idea"
    for number, line in enumerate(lines, 1):
        if len(line) > MAX_LINE:
            yield f"line {number} has {len(line)} characters, more than {MAX_LINE}"
        if re.search(r"\b(TODO|FIXME|XXX)\b", line) and not name.startswith("tests/architecture/"):
            yield f"line {number} leaves something to do"


def option_problems(text):
    """Libraries use the names of fields; only app/ maps them to options (app/options/flags.h)."""
    for literal in re.findall(r'"(?:[^"\\\n]|\\.)*"', text):
        for option in re.findall(r"(?<![\w-])--[a-z][a-z-]+", literal):
            if option not in OPTIONS_OF_OTHERS:
                yield f"names the option {option}: a library names the field (core/base/error.h, UsageError)"


def message_problems(name, text):
    """A message that cannot be written must not end the program, and each message may begin with the time."""
    if name.startswith(("bench/", "examples/", "tests/", "format/system/message.")):
        return
    for call in re.findall(r"(?:fmt::print|fprintf|fputs|std::cerr)\W{1,9}stderr|std::cerr", text):
        yield f"writes to standard error by {call}: format/system/message.h does, which drops what cannot be written"


def header_problems(name, text):
    if not text.startswith("///"):
        yield "does not begin with a description of its content (///)"
    if "#pragma once" not in text:
        yield "lacks #pragma once"
    if re.search(r"^using namespace", text, re.M):
        yield "opens a namespace in each file that includes it"


def problems(root):
    for path in sources(root):
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        found = list(text_problems(name, text))
        if path.suffix in SOURCE:
            found += include_problems(root, name, text)
            found += message_problems(name, text)
            if module_of(name) in MODULES:
                found += option_problems(text)
        if path.suffix in {".h", ".cuh"}:
            found += header_problems(name, text)
        if path.suffix in {".cu", ".cuh"} and not re.match(CUDA_FILES, name):
            found.append("only subfolders of kernels/, except body and cpu, and tests have CUDA files")
        for problem in found:
            yield f"{name}: {problem}"


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1])), "breaches of the architecture"))
