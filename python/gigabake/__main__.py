"""Prints the levels of scenes and the time that reading them takes: python3 -m gigabake SCENE"""
from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

from .errors import GigabakeError
from .scene import Level, open as open_scene


def measured(level: Level) -> dict[str, Any]:
    """Reads a level and decodes all its arrays. Returns the time of both."""
    start, cpu = time.perf_counter(), time.process_time()
    voxels = level.region()
    read = time.perf_counter()
    arrays = (voxels.normal, voxels.plane_offset_m, voxels.plane_thirds, voxels.directional_coverage, voxels.classes)
    decoded = time.perf_counter()
    return {"lod": level.lod, "edge_m": level.edge_m, "voxels": len(voxels), "read_s": read - start,
            "decode_s": decoded - read, "cpu_s": time.process_time() - cpu, "decoded": sum(array is not None for array in arrays)}


def main() -> int:
    """Reads the levels of the scenes on the command line."""
    parser = argparse.ArgumentParser(prog="python3 -m gigabake", description=__doc__)
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="folder of a bake, or its scene.xml")
    parser.add_argument("--lod", type=int, help="only this level")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers to a file")
    options = parser.parse_args()
    rows = []
    try:
        for path in options.scenes:
            scene = open_scene(path)
            for lod in range(scene.level_count) if options.lod is None else [options.lod]:
                row = {"scene": path, **measured(scene.level(lod))}
                rows.append(row)
                print("{scene}: level {lod}, {voxels:,} voxels of {edge_m:g} m, {read_s:.2f} s to read, {decode_s:.2f} s "
                      "to decode".format(**row))
    except GigabakeError as error:
        print(f"gigabake: {error}", file=sys.stderr)
        return 1
    if options.json:
        options.json.write_text(json.dumps({"rows": rows}, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
