"""Shared code of the command-line tests: runs the program, writes small scenes and reads PLY files."""
import json
import os
import re
import struct
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

from programs import Started, TRANSCRIPT, errors_of, main, run

MPI_ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_plm_rsh_agent": "/bin/false",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    # Open MPI probes any X screen for GPUs, and fails if the screen closes: for example the screen of another test.
    "HWLOC_COMPONENTS": "-gl,-opencl",
}


def shared_folder(source):
    """Returns the folder of the data sets and of the tools that emulate a cluster on one machine."""
    return Path(os.environ.get("GIGABAKE_SHARED") or Path(source) / "../shared").resolve()


class Gigabake:
    """The program under test."""

    def __init__(self, executable):
        self.executable = executable

    def run(self, *arguments, ranks=None, timeout=300, **options):
        command = [self.executable, *map(str, arguments)]
        if ranks is not None:
            command = ["mpirun", "-n", str(ranks)] + command
        return run(command, timeout, env=dict(os.environ, **MPI_ENVIRONMENT), **options)

    def succeed(self, *arguments, **options):
        result = self.run(*arguments, **options)
        assert result.returncode == 0, f"{arguments}: exit {result.returncode}\n{result.stdout}\n{result.stderr}"
        return result.stdout

    def bake(self, source, out, voxel_size, *arguments, **options):
        self.succeed("bake", source, "-o", out, "--voxel-size", voxel_size, *arguments, **options)
        return self.info(Path(out) / "scene.xml")

    def sample(self, folder, size=96, tiles=2):
        """Writes a small terrain. Returns the path of its tileset."""
        self.succeed("sample", folder, "--size", size, "--tiles", tiles)
        return Path(folder) / "tileset.json"

    def info(self, scene):
        result = self.run("info", scene, "--json")
        info = json.loads(result.stdout or "{}")
        assert result.returncode == (3 if info.get("losses") else 0), f"info {scene}: {result}"
        return info


class FolderTest(unittest.TestCase):
    """Tests that share the folder `root`, which is removed after the last test."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = Path(folder.name)


def squares_of_grid(edge):
    """Returns the corners of the triangles of a grid of edge × edge vertices, row by row."""
    corner = (numpy.arange(edge - 1)[:, None] * edge + numpy.arange(edge - 1)).reshape(-1)
    return numpy.stack([corner, corner + 1, corner + edge, corner + 1, corner + edge + 1, corner + edge], -1)


def skip_without(program, library, name):
    """Exits with code 77 (skipped) if the program was built without the library that reads files of this name."""
    with tempfile.TemporaryDirectory() as scratch:
        probe = Path(scratch) / name
        probe.write_bytes(b"")
        if f"built without {library}" in program.run("plan", probe, "--voxel-size", 1).stderr:
            print(f"skipped: this gigabake was built without {library}")
            sys.exit(77)


def lod_hashes(info, lods=None):
    return [lod["content_hash"] for lod in info["lods"]][:lods]


def cells_of(folder):
    """Returns the fingerprints of the scene's cells by their names, without overviews."""
    text = (Path(folder) / "scene.xml").read_text(encoding="utf-8")
    return dict(re.findall(r"shards/(c_[-\d_]+)-([0-9a-f]{32})\.h5", text))


def write_glb(path, positions, indices, colours=None, translation=(0, 0, 0), material=None):
    """Writes triangles in glTF's axes. positions: n × 3 floats; colours: n × 4 bytes, linear."""
    positions = numpy.asarray(positions, "<f4")
    indices = numpy.asarray(indices, "<u4").reshape(-1)
    columns = [(positions, 5126, "VEC3", {"min": positions.min(0).tolist(), "max": positions.max(0).tolist()}),
               (indices, 5125, "SCALAR", {})]
    attributes = {"POSITION": 0}
    if colours is not None:
        attributes["COLOR_0"] = 2
        columns.append((numpy.asarray(colours, "u1"), 5121, "VEC4", {"normalized": True}))
    binary, views, accessors = b"", [], []
    for data, component, kind, more in columns:
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": data.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(data),
                          "type": kind, **more})
        binary += data.tobytes()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": list(translation)}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 1}]}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}],
    }
    if material is not None:
        document["materials"] = [material]
        document["meshes"][0]["primitives"][0]["material"] = 0
    write_glb_document(path, document, binary)


def write_glb_document(path, document, binary=b""):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    Path(path).write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


PLY_VERTEX = numpy.dtype([("p", "<f8", 3), ("ijk", "<i4", 3), ("rgba", "u1", 4), ("n", "<f4", 3)])
PLY_VERTEX_WITH_CLASS = numpy.dtype(PLY_VERTEX.descr + [("class", "<u2")])


def read_ply(path):
    """Returns the vertices, sorted by lattice index."""
    content = Path(path).read_bytes()
    header, body = content.split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split(b"\n")[0])
    has_classes = b"property ushort class\n" in header
    vertices = numpy.frombuffer(body, PLY_VERTEX_WITH_CLASS if has_classes else PLY_VERTEX, count)
    assert vertices.nbytes == len(body)
    return vertices[numpy.lexsort(vertices["ijk"].T)]
