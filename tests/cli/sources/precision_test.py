#!/usr/bin/env python3
"""Sources that cannot say where their vertices are as finely as voxels are small: `plan` and `bake` say so.

Usage: precision_test.py GIGABAKE SOURCE_DIR
"""
import json
import struct
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake, write_glb, write_glb_document

# A place on the equator, 6,378,137 m from the Earth's centre: floats have a spacing of half a metre there.
EARTH_M = 6378137.0
TRIANGLE = ((0, 0, 0), (0, 8, 0), (0, 0, 8))


def write_tileset(folder, uris, transform=None):
    folder.mkdir(exist_ok=True)
    box = [EARTH_M, 0, 0, 100, 0, 0, 0, 100, 0, 0, 0, 100]
    children = [{"boundingVolume": {"box": box}, "geometricError": 0, "content": {"uri": uri}} for uri in uris]
    for child in children:
        if transform:
            child["transform"] = transform
    (folder / "tileset.json").write_text(json.dumps({
        "asset": {"version": "1.0", "gltfUpAxis": "Z"}, "geometricError": 1,
        "root": {"boundingVolume": {"box": box}, "geometricError": 1, "refine": "ADD", "children": children}}))
    return folder / "tileset.json"


def absolute_floats(work, tiles):
    """Writes tiles whose vertex buffers have absolute ECEF coordinates in single precision."""
    folder = work / f"absolute{tiles}"
    folder.mkdir()
    names = [f"tile{i}.glb" for i in range(tiles)]
    for i, name in enumerate(names):
        write_glb(folder / name, [(EARTH_M + x, y + 20 * i, z) for x, y, z in TRIANGLE], [0, 1, 2])
    return write_tileset(folder, names)


def warnings_of(result):
    return [line for line in result.stderr.splitlines() if line.startswith("warning: ")]


def plan_and_bake_warn(gigabake, work):
    scene = absolute_floats(work, 1)
    for command in (("plan", scene), ("bake", scene, "-o", work / "out")):
        for more in ((), ("--json",)):
            result = gigabake.run(*command, "--voxel-size", 0.25, *more)
            assert result.returncode == 0, result
            (line,) = warnings_of(result)
            assert "tile0.glb stores positions in steps of up to 0.5 m, but voxels are 0.25 m;" in line, line
            if more:
                precision = json.loads(result.stdout)["source_precision"]
                assert precision == {"wanted_m": 0.0625, "largest_spacing_m": 0.5, "coarse_sources": 1,
                                     "coarse": [{"name": "tile0.glb", "spacing_m": 0.5}]}, precision


def a_bake_that_reads_nothing_warns_too(gigabake, work):
    """The bake reuses the scans and shards of the bake before."""
    result = gigabake.run("bake", work / "absolute1/tileset.json", "-o", work / "out", "--voxel-size", 0.25, "--json")
    assert json.loads(result.stdout)["cells_taken_over"] > 0 and len(warnings_of(result)) == 1, result


def many_sources_are_one_line(gigabake, work):
    result = gigabake.run("plan", absolute_floats(work, 30), "--voxel-size", 0.25)
    (line,) = warnings_of(result)
    assert "tile0.glb" in line and "; and 29 more sources;" in line, line


def voxels_that_are_large_enough_need_no_warning(gigabake, work):
    result = gigabake.run("plan", work / "absolute1/tileset.json", "--voxel-size", 2)
    assert result.returncode == 0 and not warnings_of(result), result


def a_centre_in_double_needs_none(gigabake, work):
    folder = work / "relative"
    folder.mkdir()
    write_glb(folder / "tile.glb", TRIANGLE, [0, 1, 2])
    scene = write_tileset(folder, ["tile.glb"], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, EARTH_M, 0, 0, 1])
    result = gigabake.run("plan", scene, "--voxel-size", 0.001, "--json")
    assert result.returncode == 0 and not warnings_of(result), result
    assert json.loads(result.stdout)["source_precision"]["largest_spacing_m"] == 2.0**-20, result


def quantized_positions_have_their_own_step(gigabake, work):
    """Tests 16 bits over a kilometre: 30.5 mm."""
    document = {
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"], "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [1000, 1000, 1000]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5122, "normalized": True, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 24, "byteStride": 8}], "buffers": [{"byteLength": 24}],
    }
    binary = b"".join(struct.pack("<4h", *p, 0) for p in ((0, 0, 0), (99, 0, 0), (0, 0, 99)))
    write_glb_document(work / "quantized.glb", document, binary)
    for voxel_size, warns in ((0.1, True), (0.2, False)):
        result = gigabake.run("plan", work / "quantized.glb", "--voxel-size", voxel_size, "--json")
        assert result.returncode == 0 and bool(warnings_of(result)) == warns, result
        spacing = json.loads(result.stdout)["source_precision"]["largest_spacing_m"]
        assert abs(spacing - 1000 / 32767) < 1e-6, spacing


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        for test in (plan_and_bake_warn, a_bake_that_reads_nothing_warns_too, many_sources_are_one_line,
                     voxels_that_are_large_enough_need_no_warning, a_centre_in_double_needs_none,
                     quantized_positions_have_their_own_step):
            print(test.__name__, flush=True)
            test(gigabake, Path(folder))


if __name__ == "__main__":
    main()
