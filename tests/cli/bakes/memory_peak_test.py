#!/usr/bin/env python3
"""--memory bounds what a bake's processes hold, of meshes and images that are much larger than it.

Usage: memory_peak_test.py GIGABAKE SOURCE_DIR
"""
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "fuzz"))
import made_seeds as made

MEGABYTE = 1 << 20
LIMIT_MB = 64
# The memory that docs/cluster.md states for program and libraries plus a cell of this size.
PROGRAM = 64 * MEGABYTE


# The points are computed one at a time: memory of this process at the start of a bake counts in the bake's maximum.
def point(edge, i):
    """Returns point i of the (edge + 1)² points of a wavy ground."""
    x, y = divmod(i, edge + 1)
    return 0.02 * x, 0.02 * y, 0.1 * ((x ^ y) % 5)


def squares(edge):
    return (x * (edge + 1) + y for x in range(edge) for y in range(edge))


def stl_of_grid(edge):
    yield bytes(80) + struct.pack("<I", 2 * edge * edge)
    row = edge + 1
    for i in squares(edge):
        for corners in ((i, i + row, i + row + 1), (i, i + row + 1, i + 1)):
            yield struct.pack("<12fH", 0, 0, 1, *(v for c in corners for v in point(edge, c)), 0)


def ply_of_grid(edge):
    row = edge + 1
    yield (f"ply\nformat binary_little_endian 1.0\nelement vertex {row * row}\n"
           "property float x\nproperty float y\nproperty float z\n"
           f"element face {2 * edge * edge}\nproperty list uchar int vertex_indices\nend_header\n").encode()
    for i in range(row * row):
        yield struct.pack("<3f", *point(edge, i))
    for i in squares(edge):
        yield struct.pack("<B3iB3i", 3, i, i + row, i + row + 1, 3, i, i + row + 1, i + 1)


def obj_of_grid(edge):
    row = edge + 1
    for i in range(row * row):
        x, y, z = point(edge, i)
        yield f"v {x:.2f} {y:.2f} {z:.1f}\n".encode()
    for i in squares(edge):
        yield f"f {i + 1} {i + row + 1} {i + row + 2} {i + 2}\n".encode()


def grey_jpeg(edge):
    """Returns a baseline JPEG of one component with equal blocks: two bits per block."""
    def segment(marker, content):
        return bytes([0xff, marker]) + struct.pack(">H", len(content) + 2) + content
    one_code = b"\1" + bytes(15) + b"\0"
    return (b"\xff\xd8" + segment(0xdb, b"\0" + b"\1" * 64) +
            segment(0xc0, struct.pack(">BHHB", 8, edge, edge, 1) + b"\1\x11\0") + segment(0xc4, b"\0" + one_code) +
            segment(0xc4, b"\x10" + one_code) + segment(0xda, b"\1\1\0\0\x3f\0") + bytes((edge // 8) ** 2 // 4) +
            b"\xff\xd9")


def write_square_with_image(path, image):
    """Writes a square whose texture coordinates cover the whole image."""
    (path.parent / "image").write_bytes(image)
    content = made.POSITIONS + made.INDICES
    document = made.square(images=[{"uri": "image"}], textures=[{"source": 0}],
                           materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])
    primitive = document["meshes"][0]["primitives"][0]
    primitive["material"] = 0
    primitive["attributes"]["TEXCOORD_0"] = len(document["accessors"])
    document["bufferViews"].append({"buffer": 0, "byteOffset": len(content), "byteLength": 32})
    document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "componentType": 5126, "count": 4,
                                  "type": "VEC2"})
    document["buffers"] = [{"byteLength": len(content) + 32}]
    harness.write_glb_document(path, document, content + struct.pack("<8f", 0, 0, 1, 0, 1, 1, 0, 1))


# Regression (2026-11-25): an STL of 225 MB took 907 MB under 256M, a PLY 297 MB under 128M, a JPEG 1,453 MB under 512M.
class MemoryPeak(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def bake(self, source, voxel_size):
        """Returns exit code, errors, and the maximum memory of the processes."""
        command = [PROGRAM_PATH, "bake", source, "-o", self.root / "out", "--voxel-size", voxel_size, "--local",
                   "--memory", f"{LIMIT_MB}M", "--threads", 2, "--backend", "cpu", "--cell-voxels", 64]
        with subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                              env={**os.environ, **harness.MPI_ENVIRONMENT}) as process:
            errors = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        print(f"{self.id().rpartition('.')[2]}: {usage.ru_maxrss / 1024:.0f} MB", flush=True)
        return process.returncode, errors, usage.ru_maxrss << 10

    def expect_bounded(self, name, content, voxel_size=0.04):
        with open(self.root / name, "wb") as file:
            file.writelines(content)
        code, errors, held = self.bake(self.root / name, voxel_size)
        self.assertEqual(code, 0, errors)
        self.assertLess(held, LIMIT_MB * MEGABYTE + PROGRAM)

    def test_an_stl_that_is_nearly_as_large_as_the_limit(self):
        self.expect_bounded("a.stl", stl_of_grid(630))

    def test_a_ply_that_is_nearly_as_large_as_the_limit(self):
        self.expect_bounded("a.ply", ply_of_grid(1000))

    def test_an_obj_that_is_half_as_large_as_the_limit(self):
        self.expect_bounded("a.obj", obj_of_grid(800))

    def test_a_jpeg_of_which_all_texels_are_read(self):
        write_square_with_image(self.root / "a.glb", grey_jpeg(6144))
        code, errors, held = self.bake(self.root / "a.glb", 0.002)
        self.assertEqual(code, 0, errors)
        self.assertLess(held, LIMIT_MB * MEGABYTE + PROGRAM)

    def test_a_ply_whose_vertices_alone_are_too_many_is_refused_in_one_line(self):
        head = ("ply\nformat binary_little_endian 1.0\nelement vertex 3000000\n"
                "property uchar x\nproperty uchar y\nproperty uchar z\nelement face 0\n"
                "property list uchar int vertex_indices\nend_header\n")
        (self.root / "a.ply").write_bytes(head.encode() + bytes(9000000))
        code, errors, held = self.bake(self.root / "a.ply", 0.5)
        self.assertNotEqual(code, 0)
        for word in ("a.ply", "vertices would take 68.7 MB", "--memory allows 64.0 MB", "raise it, or split the file"):
            self.assertIn(word, errors)
        self.assertLess(held, LIMIT_MB * MEGABYTE + PROGRAM)


if __name__ == "__main__":
    PROGRAM_PATH = sys.argv[1]
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:], verbosity=2)
