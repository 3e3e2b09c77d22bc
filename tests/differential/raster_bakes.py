"""Bakes elevation rasters and compares heights and colours at places with the generator's values."""
import csv
import io
import json
import shutil

import mesh_bakes

VOXEL = 0.5


def entry_of(case):
    folder = case.folder.name
    entry = dict(case.entry, dem=f"{folder}/{case.source}")
    if "ortho" in entry:
        entry["ortho"] = f"{folder}/{entry['ortho']}"
    return entry


def bake(program, root, cases):
    """Returns the exit status, the report, the answers per case, and the messages."""
    out, scene, table = root / "out", root / "scene.json", root / "places.csv"
    shutil.rmtree(out, ignore_errors=True)
    scene.write_text(json.dumps({"gigabake": 1, "sources": [entry_of(c) for c in cases]}))
    result = program.run("bake", scene, "-o", out, "--voxel-size", VOXEL, "--json", "-q", "--threads", 1)
    if result.returncode not in (0, 3):
        return result.returncode, {}, None, result.stdout + result.stderr
    rows = [(lon, lat) for case in cases for lon, lat, _, _ in case.places]
    table.write_text("lon,lat\n" + "".join(f"{lon:.11f},{lat:.11f}\n" for lon, lat in rows))
    asked = program.run("query", out, "--coordinates", "lonlat", "--heights", table, "-q")
    if asked.returncode not in (0, 3):
        return asked.returncode, {}, None, asked.stderr
    answers = iter(csv.DictReader(io.StringIO(asked.stdout)))
    return (result.returncode, json.loads(result.stdout), [[next(answers) for _ in c.places] for c in cases],
            result.stderr)


def place_differences(case, answers):
    out = []
    for (lon, lat, height, colour), answer in zip(case.places, answers):
        where = f"at {lon:.7f},{lat:.7f}"
        if height is None:
            if answer["outcome"] == "hit":
                out.append(f"{where}: expected a hole, got {answer['height']} m")
            continue
        if answer["outcome"] != "hit":
            out.append(f"{where}: expected {height:.2f} m, got {answer['outcome']}")
            continue
        if abs(float(answer["height"]) - height) > case.tolerance:
            out.append(f"{where}: expected {height:.2f} m, got {answer['height']} m")
        seen = tuple(int(answer[c]) for c in ("red", "green", "blue"))
        if colour is not None and max(abs(a - b) for a, b in zip(seen, colour)) > case.colour_tolerance:
            out.append(f"{where}: expected the colour {colour}, got {seen}")
    return out


def total_differences(cases, status, report):
    out = []
    if status != 0 or report.get("losses"):
        out.append(f"exit status {status}, losses {report.get('losses')}")
    wanted, seen = mesh_bakes.expected_warnings(cases), mesh_bakes.warnings_of(report)
    if sorted((text, files) for text, _, files in wanted) != sorted((text, files) for text, _, files in seen):
        out.append(f"warnings: expected {wanted}, got {seen}")
    return out


def compare(program, root, cases):
    """Returns the differences per case: a list of (case, list of texts)."""
    status, report, answers, messages = bake(program, root, cases)
    if answers is None:
        if len(cases) == 1:
            return [(cases[0], [f"exit status {status}: {messages.strip()}"])]
        return [d for case in cases for d in compare(program, root, [case])]
    found = [(case, place_differences(case, one)) for case, one in zip(cases, answers)]
    total = total_differences(cases, status, report)
    if total and len(cases) == 1:
        found[0][1].extend(total)
    elif total:
        singles = [d for case in cases for d in compare(program, root, [case])]
        if not singles:
            return [(cases[0], [f"only together with {len(cases) - 1} other files: {text}" for text in total])]
        return singles
    return [(case, texts) for case, texts in found if texts]
