#!/usr/bin/env python3
"""Tests that the three lines of Python in docs/library.md read a real shard.

Usage: readme_test.py GIGABAKE SOURCE_DIR
"""
import base64
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77


def write_square(path):
    """Writes two triangles, 6 m wide, level at height 0.25 m, y up; red rises with x, green with z."""
    positions = struct.pack("<12f", 0, 0.25, 0, 6, 0.25, 0, 6, 0.25, -6, 0, 0.25, -6)
    colours = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    data = positions + struct.pack("<6H", 0, 1, 2, 0, 2, 3) + colours
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    path.write_text(json.dumps({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}], "scene": 0, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 2}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [0, 0.25, -6], "max": [6, 0.25, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 12},
                        {"buffer": 0, "byteOffset": 60, "byteLength": 48}],
        "buffers": [{"byteLength": len(data), "uri": uri}],
    }))


def library_lines(source_dir):
    text = (source_dir / "docs/library.md").read_text(encoding="utf-8")
    block = re.search(r"<!-- h5py -->\s*```python\n(.*?)```\s*<!-- /h5py -->", text, re.S)
    assert block, "docs/library.md has no <!-- h5py --> block"
    lines = block.group(1).strip().splitlines()
    assert len(lines) == 3, f"docs/library.md promises three lines and has {len(lines)}"
    return lines


def main():
    gigabake, source_dir = sys.argv[1], Path(sys.argv[2])
    lines = library_lines(source_dir)
    try:
        import h5py
    except ImportError:
        print("skipped: python3-h5py is not installed")
        return SKIPPED
    environment = dict(os.environ, OMPI_MCA_plm_rsh_agent="/bin/false")
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder) / "square.gltf", Path(folder) / "out"
        write_square(source)
        command = [gigabake, "bake", source, "-o", out, "--local", "--voxel-size", "0.5"]
        subprocess.run(command, check=True, env=environment)
        shard = next((out / "shards").glob("*.h5"))
        names = {}
        exec("\n".join(lines).replace("SHARD.h5", str(shard)), names)  # as a reader would type the lines
        alpha, first, children = names["alpha"], names["first"], names["children"]
        assert len(alpha) == first[-1, 0] == 144, f"{len(alpha)} voxels, 12 x 12 were baked"
        assert sum(bin(int(byte)).count("1") for byte in children) == 144
        names["shard"].close()
    print("The three lines of docs/library.md read", len(alpha), "voxels")
    return 0


if __name__ == "__main__":
    sys.exit(main())
