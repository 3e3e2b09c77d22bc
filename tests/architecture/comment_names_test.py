#!/usr/bin/env python3
"""Checks that comments and documents name only identifiers and files that exist.

A name is a word in snake case or CamelCase, a call such as size(), a qualified name or a file name. It must occur in
some file outside comments, or be the name of a file. EXTERNAL lists names of other programs and libraries.

Usage: comment_names_test.py SOURCE_DIR
"""
import re
import sys
from pathlib import Path

from language_test import files
from prose import CMAKE_NOISE, CPP, CPP_NOISE, LINK, PYTHON_NOISE, SCRIPT_NOISE
from verdict import verdict

FILE = r"[\w/-]+\.(?:h|cpp|cuh?|py|sh|sbatch|js|html|cmake)\b"
CAMEL_CASE = r"[A-Z][a-z0-9]+(?:[A-Z][a-z0-9]*)+\b"
NAME = re.compile(rf"(?<![\w/])(?:-D)?({FILE}|\w+\(\)|[A-Za-z]\w*_\w*|\w+(?:::\w+)+|{CAMEL_CASE})", re.A)
URL_OR_LINK = re.compile(rf"https?://\S+|{LINK.pattern}")
WORD = re.compile(r"[A-Za-z_]\w*", re.A)
INCLUDED = re.compile(r'#\s*include [<"]([^>"]+)')
# NAME, or a part of one capital letter, represents text that differs from case to case: c_X_Y_Z. A name with a number
# as a part is a value: c_3_2_0. A name that ends in _ is a prefix, and one that begins with _ a suffix.
NOT_NAMES = re.compile(r"(?:[\w/]*[_/])?(?:NAME|[A-Z]|\d+)(?:[_.]\w*)?|\w+_|_[\w.]+")
# Names of other programs, libraries, formats, data sets and formulas, and files that CMake generates.
EXTERNAL = set("""
    B3dmParser FLIP.h FindOpenVDB GeoTIFFs GradientX GradientY GradientZ HDF5_LZ4 HyAB IsMember KhronosGroup MPI_Init
    MeshLab NanoVDB0 OpenCL ReadWriteMany SOURCE_DIR SO_REUSEPORT TextureTransformTest WebGL X_UP_TO_Z_UP gdal_rasterize
    gigabakeConfig.cmake google_like n_a sm_90 xxhash_spec""".split())
# Names of the past, data of fuzzers, and files whose comments are samples of a test.
EXEMPT = re.compile(r"docs/(?:adr|experiments)/|CHANGELOG\.md|tests/fuzz/corpus/|LICENSE|packaging/copyright|"
                    r"tests/architecture/")
DATA = {".json", ".html", ".css", ".xml", ".cff"}


def noise_of(path):
    """Returns the pattern of comments and literals of a file; None if the file has no comments that are checked."""
    if path.suffix in CPP:
        return CPP_NOISE
    if path.suffix == ".py":
        return PYTHON_NOISE
    if path.suffix == ".cmake" or path.name == "CMakeLists.txt":
        return CMAKE_NOISE
    is_script = path.suffix in (".sh", ".sbatch", ".yml", ".yaml", ".in") or not path.suffix
    return SCRIPT_NOISE if is_script else None


def split(text, noise):
    """Returns the comments and docstrings as pairs (offset, text), and the rest of a file with its literals."""
    comments, code, end = [], [], 0
    for match in noise.finditer(text):
        is_docstring = match.group().startswith('"""') and not text[text.rfind("\n", 0, match.start()) + 1:
                                                                  match.start()].strip()
        if match.group("comment") or is_docstring:
            comments.append((match.start(), match.group()))
            code.append(text[end:match.start()])
            end = match.end()
    return comments, " ".join([*code, text[end:]])


class Names:
    """The words of all code, and the names of all files."""

    def __init__(self):
        self.words, self.included, self.files = set(), set(), set()

    def add_code(self, code):
        self.words.update(WORD.findall(code))
        self.included.update(INCLUDED.findall(code))

    def add_file(self, name):
        """Adds a path with all its endings: a comment may name a file without its folders."""
        self.files.update(name[match.end():] for match in re.finditer(r"^|/", name))
        self.words.add(Path(name).stem)

    def has(self, name):
        if NOT_NAMES.fullmatch(name) or name in EXTERNAL or name in self.files or name in self.included:
            return True
        return "." not in name and all(word in self.words or word in EXTERNAL
                                       for word in name.removesuffix("()").split("::") if word != "std")


def unknown(names, texts):
    """Yields a pair (offset, name) per name in a text that does not exist. texts: pairs (offset, text)."""
    for offset, text in texts:
        for match in NAME.finditer(URL_OR_LINK.sub(lambda url: " " * len(url.group()), text)):
            if not names.has(match.group(1)):
                yield offset + match.start(), match.group(1)


def read(root):
    """Returns all names, and triples (file name, its text, its comments) of the files that are checked."""
    names, checked = Names(), []
    for path in files(root):
        name = path.relative_to(root).as_posix()
        names.add_file(name)
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        noise, comments = noise_of(path), []
        if path.suffix == ".md":
            comments = [(0, text)]
        elif noise:
            comments, code = split(text, noise)
            if not EXEMPT.match(name):
                names.add_code(code)
        elif path.suffix in DATA:
            names.add_code(text)
        if not EXEMPT.match(name):
            checked.append((name, text, comments))
    return names, checked


def wrong_about_samples():
    """Tests this test."""
    names = Names()
    names.add_file("kernels/body/voxel.h")
    names.add_code('#include <mpi.h>\nint size_of(Brick b, BrickLevel c) { f("key_name"); }')
    text = ("// size_of() of a BrickLevel, level.key_name, Brick::size_of, std::size_of\n"
            "// body/voxel.h, mpi.h, lod_K, -Dkey_name\n"
            'g("no_comment");  // old_name, OldName, old(), Brick::old, old.h, body/old.h\n')
    found = {name for _, name in unknown(names, split(text, CPP_NOISE)[0])}
    if found != {"old_name", "OldName", "old()", "Brick::old", "old.h", "body/old.h"}:
        yield f"this test finds {sorted(found)} in its sample"


def problems(root):
    yield from wrong_about_samples()
    names, checked = read(root)
    prose = " ".join(text for _, _, comments in checked for _, text in comments)
    yield from (f"no comment names {name}: remove it from EXTERNAL" for name in sorted(EXTERNAL) if name not in prose)
    for name, text, comments in checked:
        for offset, unknown_name in unknown(names, comments):
            yield f"{name}:{text.count(chr(10), 0, offset) + 1}: names {unknown_name}, which does not exist"


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1]).resolve()), "names of nothing"))
