#!/usr/bin/env python3
"""Checks that device files of kernels/ and query/ (*.cu, *.cuh) contain no rules about voxels: kernels/body has them.

A rule in a device file would not be tested on a machine without a GPU, and could differ from the CPU's. Device files
may not
  - name a value of a rule's enum (core/base/rules.h, core/octree/octree.h): they pass it, or call a function of
    kernels/body, such as filters_by_view() or Surface::look();
  - use the scale of a channel (65535, 32767, 255, 127): packing, scaling and opacity are defined in kernels/body;
  - round, or compute a root or a power: kernels/body and core/math/rounding.h do;
  - compare a channel, a weight or a rule with anything but null.
They may compare counts, indices, pointers, and decisions of kernels/body or of a template parameter (`Fate`, `Look`,
`CellMaterials`, `by_view`). Comments and strings are ignored.

Usage: one_body_test.py SOURCE_DIR
"""
import re
import sys
from pathlib import Path

from verdict import verdict

ENUM_HEADERS = ["core/base/rules.h", "core/octree/octree.h"]

SCALES = re.compile(r"(?<![\w.])(65535|32767|255|127)u?(?![\w.])")
ROUNDING = re.compile(r"\b(floor|ceil|round|lround|llround|trunc|rint|nearbyint|sqrt|rsqrt|cbrt|pow|exp|log)f?\s*\("
                      r"|\b__(double|float)2\w+\s*\(")
CHANNEL = (r"(alpha|alpha_mode|coverage|cutoff|weight|facing|rgba|base_rgba|vertex_rgba|normal|clear|wrap_s|wrap_t|mip"
           r"|filter|rule|surface_rule)")
# A channel, or an element, a member or a call without arguments of it. COMPARED has it on either side of a comparison.
OF_CHANNEL = rf"\b{CHANNEL}(\[[^\]]*\]|\.\w+|\(\))*"
COMPARISON = r"(==|!=|<=|>=|<(?!<)|>(?!>))"
COMPARED = re.compile(rf"{OF_CHANNEL}\s*(?<![<>-]){COMPARISON}\s*(?!nullptr)[\w(-]"
                      rf"|(?<!nullptr)\s(?<![<>-]){COMPARISON}\s+([\w:]+\.)*{OF_CHANNEL}")


def without_comments(text):
    """Returns the lines without comments and contents of strings."""
    text = re.sub(r'"(\\.|[^"\\\n])*"', '""', text)
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), text, flags=re.S)
    return re.sub(r"//[^\n]*", "", text)


def rule_enums(root):
    names = []
    for header in ENUM_HEADERS:
        names += re.findall(r"enum class (\w+)", (root / header).read_text(encoding="utf-8"))
    return names


def decisions(text, enums):
    """Yields a line number and the decision for each line that decides something."""
    enum_value = re.compile(rf"\b({'|'.join(enums)})::")
    for number, line in enumerate(without_comments(text).splitlines(), 1):
        if found := enum_value.search(line):
            yield number, f"names a value of {found.group(1)}"
        if found := SCALES.search(line):
            yield number, f"writes the scale of a channel, {found.group(1)}"
        if found := ROUNDING.search(line):
            yield number, f"rounds or takes a root: {found.group().strip()}"
        if found := COMPARED.search(line):
            yield number, f"compares what kernels/body should: {found.group().strip()}"


DECIDING = [
    "const auto kernel = level.filter == MipFilter::coverage ? a : b;",
    "if (s.material.alpha_mode != mode) return;",
    "if (filter == wanted) run();",
    "if (alpha < 1) alpha = 1;",
    "if (0 < sums.weight) add();",
    "if (seen.weight[0] == 0) w = 1;",
    "if (in.rgba[i] >= cut) ++n;",
    "r.c[3] = 65535;",
    "const int mean = (sum + 127) / 255;",
    "x = std::floor(y + 0.5);",
    "const int row = __double2int_rd(v);",
]
SPREADING = [
    "if (normal != nullptr) normal[at] = view.normal[from + i];",
    "const bool there = below.normal != nullptr && facing == nullptr;",
    "for (int c = 0; c < 8; ++c) w = weights_of<2>(seen, children);",
    "rule<<<grid_of(n, threads), threads, 0, heap.stream()>>>(view);",
    "DeviceArray<std::uint32_t> rgba(heap, n); // alpha == 255",
    "fate = fate_of(window, part, v, t.p);",
    "std::uint32_t coverage[2] = {};",
    "coverage[c / 4] |= byte_of(word, 3) << 8 * c;",
    "if (item.look == Look::linear) return linear_fragment(item.colour, item.normal);",
    "constexpr unsigned threads = 256;",
    'throw DeviceFull("more than 65535");',
]


def wrong_about_samples(enums):
    """Tests this test: with lines that decide, and with lines that do not."""
    for line in DECIDING:
        if not list(decisions(line, enums)):
            yield f"this test does not notice that it decides: {line}"
    for line in SPREADING:
        for _, why in decisions(line, enums):
            yield f"this test takes it for a decision ({why}): {line}"


def problems(root):
    enums = rule_enums(root)
    if not {"SurfaceRule", "MipFilter", "AlphaMode", "Wrap", "NodeKind"} <= set(enums):
        yield f"the rules' enums are not where this test looks for them: {', '.join(ENUM_HEADERS)} have {enums}"
    yield from wrong_about_samples(enums)
    everything = [path for folder in ("kernels", "query") for path in (root / folder).rglob("*")]
    files = sorted(path for path in everything if path.suffix in {".cu", ".cuh"})
    if not files:
        yield "kernels/ has no device files"
    for path in files:
        for number, why in decisions(path.read_text(encoding="utf-8"), enums):
            yield f"{path.relative_to(root).as_posix()}:{number}: {why}"


if __name__ == "__main__":
    sys.exit(verdict(problems(Path(sys.argv[1])), "decisions in device files"))
