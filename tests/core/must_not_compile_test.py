#!/usr/bin/env python3
"""Checks that invalid code does not compile: mixed frames, maps in the wrong order, a rule in place of another.

Each wrong line has a correct one that differs from it only in the mistake. The compiler reads all lines in one run. It
must refuse exactly the wrong ones, for the expected reason.

Usage: must_not_compile_test.py COMPILER SOURCE_DIR
"""
import os
import re
import subprocess
import sys

HEADERS = ["core/math/frames.h", "core/base/rules.h", "core/math/snap.h", "kernels/body/voxelize/brick_triangle.h"]
GIVEN = """
using namespace gigabake;
Point<Ecef> ecef;
Point<Scene> scene;
Point<Local> local;
Geodetic place;
Affine<Scene, World> scene_from_world;
Affine<World, Local> world_from_local;
Affine<Scene, Local> scene_from_local;
kernels::WindowTriangle window_triangle;
LatticePoint lattice_point;
SnapFrame frame;
const Vec3<std::int32_t> corner{0, 0, 0};
"""
NO_OPERATOR = r"no match for .operator|invalid operands to binary"
NO_CALL = r"no match for call|no matching function"
NO_CONVERSION = (r"cannot (?:convert|initialize)|could not convert|conversion from|no viable conversion|"
                 r"invalid conversion|no known conv")
NOT_IN_ORDER = NO_OPERATOR + "|no matching function"
# Triples of the correct line, the wrong line and the reason for the refusal.
PAIRS = [
    ("return scene == scene;", "return scene == ecef;", NO_OPERATOR),
    ("return (scene.x - scene.x) == 0;", "return (ecef - scene) == 0;", NO_OPERATOR),
    ("Point<Scene> p = scene;", "Point<Scene> p = ecef;", NO_CONVERSION),
    ("Point<Ecef> p = ecef;", "Point<Ecef> p = place;", NO_CONVERSION),
    ("auto p = scene_from_local(local);", "auto p = scene_from_local(scene);", NO_CALL),
    ("auto p = scene_from_local(local);", "auto p = scene_from_world(local);", NO_CALL),
    ("Point<Scene> p = scene_from_local(local);", "Point<World> p = scene_from_local(local);", NO_CONVERSION),
    ("auto m = scene_from_world * world_from_local;", "auto m = world_from_local * scene_from_world;", NOT_IN_ORDER),
    ("auto m = scene_from_world * world_from_local;", "auto m = scene_from_local * world_from_local;", NOT_IN_ORDER),
    ("Affine<Scene, Local> m = scene_from_world * world_from_local;",
     "Affine<Local, Scene> m = scene_from_world * world_from_local;", NO_CONVERSION),
    ("Affine<Scene, Local> m = scene_from_local;", "Affine<Scene, Local> m = scene_from_world;", NO_CONVERSION),
    ("SurfaceRule r = SurfaceRule::thin;", "SurfaceRule r = MipFilter::box;", NO_CONVERSION),
    ("MipFilter f = MipFilter(2);", "MipFilter f = 2;", NO_CONVERSION),
    ("bool is = SurfaceRule::area == SurfaceRule::thin;", "bool is = SurfaceRule::area == MipFilter::box;",
     NO_OPERATOR),
    ("auto t = kernels::make_brick_triangle<std::int64_t>(window_triangle, corner);",
     "auto t = kernels::make_brick_triangle<std::int64_t>(lattice_point, corner);", NO_CALL + "|" + NO_CONVERSION),
]


def compiled(compiler, source_dir, lines):
    """Returns {line of `lines`: its errors}; the key None has the errors in other places."""
    head = "".join(f'#include "{header}"\n' for header in HEADERS) + GIVEN
    body = "".join(f"inline auto line_{number}() {{\n#line {number} \"tried\"\n{line} (void)0; return true; }}\n"
                   for number, line in enumerate(lines, 1))
    command = [compiler, "-std=c++20", "-fsyntax-only", "-w", f"-I{source_dir}", "-x", "c++", "-"]
    command += ["-ferror-limit=0"] if "clang" in compiler else ["-fmax-errors=0"]
    # English messages, without the quotation marks of a language.
    run = subprocess.run(command, input=head + body, text=True, capture_output=True, env={**os.environ, "LC_ALL": "C"})
    errors = {}
    for message in run.stderr.splitlines():
        if "error: " in message:
            at = re.match(r"tried:(\d+):", message)
            errors.setdefault(int(at[1]) if at else None, []).append(message)
    assert run.returncode == (1 if errors else 0), run.stderr
    return errors


def main(compiler, source_dir):
    right, wrong = [pair[0] for pair in PAIRS], [pair[1] for pair in PAIRS]
    problems = [text for texts in compiled(compiler, source_dir, right).values() for text in texts]
    refused = compiled(compiler, source_dir, wrong)
    problems += refused.pop(None, [])
    for number, (_, line, reason) in enumerate(PAIRS, 1):
        told = refused.get(number, [])
        if not told:
            problems.append(f"this compiles, and must not: {line}")
        elif not re.search(reason, told[0]):
            problems.append(f"refused for another reason: {line}\n  {told[0]}\n  expected: {reason}")
    print("\n".join(problems) or f"{len(PAIRS)} lines compile, and as many are refused")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
