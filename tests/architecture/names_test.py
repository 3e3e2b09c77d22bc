#!/usr/bin/env python3
"""Checks that names are unique where the linker or a unity build requires it.

1. No two definitions of a class, struct, union or enum have the same qualified name. The one-definition rule requires
   it, and no compiler or linker checks it. Anonymous namespaces are exempt, and so are different test programs.
2. No two source files of one folder that has a CMakeLists.txt have equal local names: types, aliases, variables, and
   functions of the same parameters. Adding a file regroups the files of a unity build, so that a clash would appear
   in an unrelated change. Equal aliases may be repeated.
3. No local name (rule 2) is also declared, in the same namespace, by a header that the source file or another file of
   its folder may include. The name would be ambiguous.

Usage: names_test.py SOURCE_DIR
"""
import re
import sys
from collections import defaultdict
from pathlib import Path

from architecture_test import JOINTS, MODULES, module_of
from declarations import declarations
from verdict import verdict

FOLDERS = "app bench cluster core examples format kernels query sample scheduler tests viewer worker".split()
SOURCE = {".h", ".cpp", ".cu", ".cuh"}
# These replace another file if a library is missing.
STUB = re.compile(r"_stub\.cpp$")
# CMakeLists.txt exclude these from unity builds, or compile each into a separate program or module.
APART = re.compile(r"bench/|examples/|tests/bench/|tests/fuzz/read_|format/source/mesh/|format/export/openvdb/")


def declared_in(root):
    """Yields pairs (file name, its declarations)."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SOURCE and path.is_file():
                yield path.relative_to(root).as_posix(), declarations(path.read_text(encoding="utf-8"))


def program_of(name):
    """Returns the folder of the test or example that contains a file; empty for files linked into gigabake."""
    parts = name.split("/")
    return "/".join(parts[:2]) if parts[0] in ("examples", "tests") else ""


def twice_defined(files):
    """Yields types of the same qualified name that could be linked into one program."""
    types = defaultdict(list)
    for name, found in files:
        for d in found:
            if d.kind == "type" and "" not in d.scope and not STUB.search(name):
                types["::".join(d.scope + (d.name,))].append((name, d.line))
    for qualified, places in sorted(types.items()):
        for i, (name, line) in enumerate(places):
            for other, other_line in places[:i]:
                if "" in (program_of(name), program_of(other)) or program_of(name) == program_of(other):
                    yield f"{name}:{line}: {qualified} is also defined in {other}:{other_line}"


def compiled_together(root):
    """Returns a function from a file's name to the folder that a unity build may combine it with; None: no folder."""
    folders = [path.parent.relative_to(root).as_posix() for folder in FOLDERS
               for path in (root / folder).rglob("CMakeLists.txt")]

    def folder_of(name):
        if not name.endswith(".cpp") or APART.match(name):
            return None
        return program_of(name) or max((f for f in folders if name.startswith(f + "/")), key=len, default=None)
    return folder_of


def is_local(d):
    """Returns True if the declaration of a source file is local to the file."""
    return d.scope[-1:] == ("",) or (d.kind in ("alias", "variable") and "" not in d.scope)


def clash(one, other):
    if one.kind == other.kind == "function":
        return one.text == other.text
    return not (one.kind == other.kind == "alias" and one.text == other.text)


def clashes(files, folder_of):
    names = defaultdict(list)
    for name, found in files:
        folder = folder_of(name)
        for d in found:
            if folder is not None and is_local(d):
                names[folder, tuple(part for part in d.scope if part), d.name].append((name, d))
    for (_, _, _), uses in sorted(names.items()):
        for i, (name, d) in enumerate(uses):
            other = next((use for use in uses[:i] if use[0] != name and clash(use[1], d)), None)
            if other:
                yield (f"{name}:{d.line}: the {d.kind} `{d.name}` is also local to {other[0]}:{other[1].line}; rename "
                       "one, since a unity build may compile both files together")


def may_include(name, header, folder):
    """Returns True if a file, or a file that is compiled with it, may include a header of gigabake."""
    module, target = module_of(name), module_of(header)
    return module in JOINTS or header.startswith(folder + "/") or target in MODULES.get(module, [])


def hidden(files, folder_of):
    """Yields names that are local to a file and also declared by a header."""
    declared = defaultdict(list)
    for header, found in files:
        for d in found:
            if header.endswith(".h") and "" not in d.scope and "::" not in d.name:
                declared[d.scope, d.name].append((header, d))
    for name, found in files:
        folder = folder_of(name)
        for d in found:
            if folder is None or d.scope[-1:] != ("",):
                continue
            for header, other in declared[tuple(part for part in d.scope if part), d.name]:
                if may_include(name, header, folder) and clash(d, other):
                    yield (f"{name}:{d.line}: the {d.kind} `{d.name}` is also declared in {header}:{other.line}; "
                           "rename one")


def in_scene(**texts):
    """Returns files of one folder: `one__cpp` is its one.cpp."""
    return {"format/scene/" + name.replace("__", "."): text for name, text in texts.items()}


BAD = in_scene(
    one__h="namespace g {\nclass A final : public B {\n public:\n  struct Inner { int x; };\n};\n}\n",
    two__h="namespace g::detail {}\nnamespace g {\ntemplate <class T>\nstruct [[nodiscard]] A { T x; };\n"
           "struct A::Inner { int y; };\nenum class E { one };\n}\n",
    seen__h="namespace g { inline constexpr int small = 1; int area(double radius); }\n",
    three__cpp='#include "x"\nnamespace g { namespace {\nenum class E : int { "}", two };\n'
               "constexpr int small = 1'000, large{2};\nusing Map = std::map<int, int>;\n"
               "int area(const Box& box, int n = 3) { return [&] { return n; }(); }\n"
               "const std::vector<int> primes{2, 3};\nstruct Part { int n; };\n}}\n",
    four__cpp="namespace g {\nconstexpr double large = 3;\nnamespace {\nusing Map = std::set<int>;\n"
              "int area(const Box& b, int) { return 2; }\nstruct Part;\nauto primes = f();\n"
              "class Part : Base<int> { char c = '{'; };\n}\n}\n")
GOOD = in_scene(
    one__h="namespace g {\nclass A;\nstruct A { int x; };\n}\nstd::optional<struct A> f(struct A a);\n"
           "template <>\nstruct std::hash<g::A> {};\n",
    two__h="namespace h { struct A {}; struct B { struct A {}; }; }\nnamespace g { using h::B; }\n"
           "template <>\nstruct std::hash<h::A> {};\n#if X\nstruct C {\n#else\nstruct C : A {\n#endif\n};\n",
    zip_stub__cpp="namespace g { struct Z {}; }\n",
    zip__cpp="namespace g {\nstruct Z { int n; };\nint Z::f(int small) { return small; }\n}\n",
    three__cpp="namespace g { namespace {\nstruct B {};\nusing Map = std::map<int, int>;\n"
               "int area(Box box) { struct Local {}; return 1; }\nA make() { return {1, 2}; }\n"
               "constexpr int sizes[count] = {};\n}\nint Z::count = 3;\n}\n",
    four__cpp="namespace g { namespace {\nusing Map = std::map<int, int>;\nconst std::array<int, count> more{};\n"
              "int area(int box) { struct Local {}; return 2; }\n}\nint Y::count = 4;\n}\n")
GOOD.update({f"tests/{program}/one.cpp": "namespace g { struct T { int x; }; }\n" for program in ("app", "bench")})


def found_in(texts):
    files = [(name, declarations(text)) for name, text in texts.items()]

    def folder_of(name):
        return "format/scene" if name.endswith(".cpp") and name.startswith("format") else None
    return list(twice_defined(files)), [*clashes(files, folder_of), *hidden(files, folder_of)]


def wrong_about_samples():
    """Tests this test: with a tree that has every fault, and with a tree without faults."""
    types, local_names = found_in(BAD)
    if {(p.split()[1], int(p.split(":")[1])) for p in types} != {("g::A", 3), ("g::A::Inner", 5)}:
        yield f"this test does not find the types that are defined twice: {types}"
    if {p.split("`")[1] for p in local_names} != {"E", "Map", "Part", "area", "large", "primes", "small"}:
        yield f"this test does not find the names that clash: {local_names}"
    for problem in [p for found in found_in(GOOD) for p in found]:
        yield f"this test takes it for a fault: {problem}"


def problems(root):
    yield from wrong_about_samples()
    files = list(declared_in(root))
    types = sum(d.kind == "type" for _, found in files for d in found)
    if types < 1000:
        yield f"this test sees {types} types only"
    yield from twice_defined(files)
    yield from clashes(files, compiled_together(root))
    yield from hidden(files, compiled_together(root))


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1])), "names of two things"))
