"""Reads the same files with assimp and GDAL's command-line tools: counts, bounding boxes and values."""
import json
import re
import shutil
import subprocess



def assimp_info(path):
    """Returns the faces and bounds that assimp reads from a file, or a text if it refuses the file."""
    result = subprocess.run(["assimp", "info", str(path), "--raw"], capture_output=True, text=True, errors="replace",
                            timeout=60, check=False)
    if result.returncode != 0:
        error = re.search(r"ERROR: (.*)", result.stdout)
        return "refused: " + (error[1] if error else result.stdout[-200:] + f" (status {result.returncode})")
    faces = int(re.search(r"Faces:\s+(\d+)", result.stdout)[1])
    bounds = [[float(v) for v in re.search(name + r"\s+point\s+\(([^)]*)\)", result.stdout)[1].split()]
              for name in ("Minimum", "Maximum")]
    return faces, bounds


def missing():
    """Returns the programs that are not installed."""
    return [name for name in ("assimp", "gdalinfo", "gdallocationinfo") if shutil.which(name) is None]


def raster_differences(case):
    """Compares the corners from gdalinfo and the values from gdallocationinfo."""
    if "values" not in case.outside:
        return []
    path = str(case.folder / case.source)
    result = subprocess.run(["gdalinfo", "-json", path], capture_output=True, text=True, timeout=60, check=False)
    if result.returncode != 0:
        return [f"gdalinfo: {result.stderr.strip()}"]
    corners = json.loads(result.stdout)["cornerCoordinates"]
    wanted, seen = case.outside["corners"], [corners["upperLeft"], corners["lowerRight"]]
    out = []
    if max(abs(a - b) for x, y in zip(wanted, seen) for a, b in zip(x, y)) > 1e-6 * max(abs(v) for v in wanted[0]):
        out.append(f"gdalinfo: expected corners {wanted}, got {seen}")
    places = case.outside["values"]
    lines = "".join(f"{x!r} {y!r}\n" for x, y, _ in places)
    result = subprocess.run(["gdallocationinfo", "-valonly", "-b", "1", "-geoloc", path], input=lines, text=True,
                            capture_output=True, timeout=60, check=False)
    values = [float(word) for word in result.stdout.split()]
    expected = [value for _, _, value in places]
    if len(values) != len(expected) or any(abs(a - b) > 1e-5 * abs(b) for a, b in zip(values, expected)):
        out.append(f"gdallocationinfo: expected {expected}, got {values}")
    return out


def differences(case):
    """Returns a text per difference between other programs and the generator."""
    if case.kind == "raster":
        return raster_differences(case)
    if case.kind in ("tileset", "earth") or "unsupported" in case.outside:
        return []
    seen = assimp_info(case.folder / case.source)
    if isinstance(seen, str):
        return [f"assimp: {seen}"]
    faces, bounds = seen
    out = []
    if "faces" in case.outside and faces != case.outside["faces"]:
        out.append(f"assimp: expected {case.outside['faces']} faces, got {faces}")
    wanted = case.outside["bounds"]
    scale = max(abs(v) for side in wanted for v in side)
    if max(abs(a - b) for x, y in zip(bounds, wanted) for a, b in zip(x, y)) > 1e-4 + 1e-6 * scale:
        out.append(f"assimp: expected bounds {wanted}, got {bounds}")
    return out
