"""Bakes many mesh sources at once and compares voxels, counts, warnings and losses with the expected ones."""
import json
import re
import shutil
import sys
from pathlib import Path

import numpy

from odd import BLOCK, VOXEL

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness  # noqa: E402

MAX_SHOWN = 4
WARNING = re.compile(r"(?P<first>.*?)(?: and (?P<more>\d+) more)?: (?P<text>.*)", re.DOTALL)


class Program(harness.Gigabake):
    """The program under test. The names of its files need not be UTF-8."""

    def run(self, *arguments, **options):
        return super().run(*arguments, errors="replace", **options)


def write_scene(root, cases):
    """Writes a scene with the cases in a row."""
    sources = []
    for i, case in enumerate(cases):
        if case.place is None:
            sources.append({"path": f"{case.folder.name}/{case.source}"})
            continue
        place = [BLOCK * VOXEL * i - case.place[0], -case.place[1], -case.place[2]]
        sources.append({"path": f"{case.folder.name}/{case.source}", "place": {"position_m": place}})
    path = root / "scene.json"
    path.write_text(json.dumps({"gigabake": 1, "sources": sources}))
    return path


def bake(program, root, cases, arguments):
    """Returns the exit status, the report, the voxels, and the messages."""
    out = root / "out"
    shutil.rmtree(out, ignore_errors=True)
    result = program.run("bake", write_scene(root, cases), "-o", out, "--voxel-size", VOXEL, "--json", "-q",
                         "--threads", 1, *arguments)
    if result.returncode not in (0, 3):
        return result.returncode, {}, None, result.stdout + result.stderr
    report = json.loads(result.stdout)
    ply = root / "out.ply"
    exported = program.run("export", out, "-o", ply, "-q")
    if exported.returncode not in (0, 3):
        return exported.returncode, report, None, exported.stderr
    return result.returncode, report, harness.read_ply(ply), result.stderr


def shown(items):
    return ", ".join(map(str, items[:MAX_SHOWN])) + (f" and {len(items) - MAX_SHOWN} more" if len(items) > 4 else "")


def is_colour(seen, colour, tolerance):
    return colour is None or max(abs(a - b) for a, b in zip(seen, colour)) <= tolerance


def voxel_differences(case, index, voxels):
    """Compares the voxels of one case, whose first voxel along x is BLOCK × index."""
    inside = voxels[voxels["ijk"][:, 0] // BLOCK == index]
    seen = {(i - BLOCK * index, j, k): (tuple(rgba[:3]), rgba[3])
            for (i, j, k), rgba in zip(inside["ijk"].tolist(), inside["rgba"].tolist())}
    out = []
    missing, extra = sorted(case.voxels.keys() - seen.keys()), sorted(seen.keys() - case.voxels.keys())
    if missing:
        out.append(f"{len(missing)} of {len(case.voxels)} expected voxels are missing: {shown(missing)}")
    if extra:
        out.append(f"{len(extra)} voxels are not expected: {shown(extra)}")
    common = sorted(case.voxels.keys() & seen.keys())
    wrong = [c for c in common if not is_colour(seen[c][0], case.voxels[c][0], case.colour_tolerance)]
    if wrong:
        out.append(f"{len(wrong)} of {len(common)} colours differ: " +
                   shown([f"{c}: expected {case.voxels[c][0]}, got {seen[c][0]}" for c in wrong]))
    wrong = [c for c in common if abs(seen[c][1] - case.voxels[c][1]) > 1]
    if wrong:
        out.append(f"{len(wrong)} alpha values differ: " +
                   shown([f"{c}: expected {case.voxels[c][1]}, got {seen[c][1]}" for c in wrong]))
    return out


def warnings_of(report):
    """Returns (text, count, files) of each warning."""
    out = []
    for line in report.get("warnings", []):
        found = WARNING.fullmatch(line)
        text, count = found["text"], 1
        numbers = re.search(r": (\d+)(?: of \d+)?(?:, e\.g\. .*)?$", text, re.DOTALL)
        if numbers:
            text, count = text[:numbers.start()], int(numbers[1])
        out.append((text, count, 1 + int(found["more"] or 0)))
    return sorted(out)


def expected_warnings(cases):
    sums = {}
    for case in cases:
        for text, count, files in case.warnings:
            known = sums.get(text, (0, 0))
            sums[text] = (known[0] + count, known[1] + files)
    return sorted((text, count, files) for text, (count, files) in sums.items())


def total_differences(cases, status, report):
    """Compares the report's totals of all cases."""
    out = []
    losses = [words for case in cases for words in case.losses]
    if status != (3 if losses else 0):
        out.append(f"exit status: expected {3 if losses else 0}, got {status}")
    listed = [f"{loss['name']}: {loss['reason']}" for loss in report.get("losses", [])]
    if len(listed) != len(losses) or not all(any(words in line for line in listed) for words in losses):
        out.append(f"losses: expected {losses}, got {listed}")
    counts = {"triangles": report.get("triangles", 0) + report.get("skipped", {}).get("zero_area", 0)}
    counts.update({k: report.get("skipped", {}).get(k, 0) for k in ("points", "lines", "non_finite")})
    expected = {"triangles": sum(c.triangles for c in cases), "points": sum(c.skipped_points for c in cases),
                "lines": sum(c.skipped_lines for c in cases), "non_finite": 0}
    if counts != expected:
        out.append(f"counts: expected {expected}, got {counts}")
    wanted, seen = expected_warnings(cases), warnings_of(report)
    if wanted != seen:
        out.append(f"warnings: expected {wanted}, got {seen}")
    return out


def compare(program, root, cases, arguments):
    """Returns the differences per case: a list of (case, list of texts)."""
    status, report, voxels, messages = bake(program, root, cases, arguments)
    if voxels is None:
        if len(cases) == 1:
            return [(cases[0], [f"exit status {status}: {messages.strip()}"])]
        return [d for case in cases for d in compare(program, root, [case], arguments)]
    slots = [i if case.slot is None else case.slot for i, case in enumerate(cases)]
    found = [(case, voxel_differences(case, slot, voxels)) for case, slot in zip(cases, slots)]
    outside = numpy.count_nonzero(~numpy.isin(voxels["ijk"][:, 0] // BLOCK, slots))
    total = total_differences(cases, status, report)
    if outside:
        total.append(f"{outside} voxels are at no place of any file")
    if total and len(cases) == 1:
        found[0][1].extend(total)
    elif total:
        singles = [d for case in cases for d in compare(program, root, [case], arguments)]
        if not singles:
            return [(cases[0], [f"only together with {len(cases) - 1} other files: {text}" for text in total])]
        return singles
    return [(case, texts) for case, texts in found if texts]
