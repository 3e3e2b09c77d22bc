#!/usr/bin/env python3
"""Exports read with nothing but what docs/format.md and the formats' specifications say: the same voxels as the PLY.

Usage: export_test.py GIGABAKE SOURCE_DIR
"""
import json
import math
import struct
import sys
import xml.etree.ElementTree as xml

import numpy

import harness
from programs import lines_of

VOXEL_M = 0.5


def bits(subtree, binary, availability, count):
    if "constant" in availability:
        return numpy.full(count, availability["constant"], bool)
    view = subtree["bufferViews"][availability["bitstream"]]
    data = numpy.frombuffer(binary, "u1", view["byteLength"], view["byteOffset"])
    row = numpy.unpackbits(data, bitorder="little")[:count].astype(bool)
    assert row.sum() == availability["availableCount"]
    return row


def from_morton(code):
    return [sum((code >> (3 * bit + axis) & 1) << bit for bit in range(21)) for axis in range(3)]


class Tileset:
    """Walks the implicit oct-tree by its subtrees, as the specification says; never by listing folders."""

    def __init__(self, folder):
        self.folder = folder
        self.document = json.loads((folder / "tileset.json").read_text())
        self.root = self.document["root"]
        self.tiling = self.root["implicitTiling"]

    def path(self, template, level, place):
        x, y, z = place
        return self.folder / template.format(level=level, x=x, y=y, z=z)

    def tiles(self):
        """(level, place) of each available tile, all with content."""
        levels = self.tiling["subtreeLevels"]
        todo = [(0, (0, 0, 0))]
        while todo:
            level, root = todo.pop()
            data = self.path(self.tiling["subtrees"]["uri"], level, root).read_bytes()
            magic, version, json_bytes, binary_bytes = struct.unpack_from("<4sIQQ", data)
            assert (magic, version) == (b"subt", 1) and len(data) == 24 + json_bytes + binary_bytes
            assert json_bytes % 8 == 0 and binary_bytes % 8 == 0
            subtree, binary = json.loads(data[24:24 + json_bytes]), data[24 + json_bytes:]
            assert subtree["buffers"] == [{"byteLength": binary_bytes}]
            count = (8**levels - 1) // 7
            available = bits(subtree, binary, subtree["tileAvailability"], count)
            assert (available == bits(subtree, binary, subtree["contentAvailability"][0], count)).all()
            first = 0
            for down in range(levels):
                for code in numpy.flatnonzero(available[first:first + 8**down]):
                    place = tuple((r << down) + m for r, m in zip(root, from_morton(int(code))))
                    assert level + down < self.tiling["availableLevels"]
                    yield level + down, place
                first += 8**down
            for code in numpy.flatnonzero(bits(subtree, binary, subtree["childSubtreeAvailability"], 8**levels)):
                todo.append((level + levels, tuple((r << levels) + m for r, m in zip(root, from_morton(int(code))))))

    def voxels(self, level, place):
        """Place in the level, colour, normal of each voxel of a tile."""
        data = self.path(self.root["content"]["uri"], level, place).read_bytes()
        magic, version, length, json_bytes, kind = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
        gltf, binary = json.loads(data[20:20 + json_bytes]), data[20 + json_bytes + 8:]
        primitive = gltf["meshes"][0]["primitives"][0]
        voxels = primitive["extensions"]["EXT_primitive_voxels"]
        assert primitive["mode"] == 0x7FFFFFFF and voxels["dimensions"] == [8, 8, 8]
        shape = gltf["extensions"]["KHR_implicit_shapes"]["shapes"][voxels["shape"]]
        self.check_box(level, place, shape, gltf["nodes"][0]["translation"])
        columns = {}
        for name, accessor in primitive["attributes"].items():
            accessor = gltf["accessors"][accessor]
            view = gltf["bufferViews"][accessor["bufferView"]]
            width, dtype = int(accessor["type"][3]), {5121: "u1", 5126: "<f4"}[accessor["componentType"]]
            column = numpy.frombuffer(binary, dtype, 512 * width, view["byteOffset"]).reshape(8, 8, 8, width)
            # glTF: [z][y][x] with y up; tileset: x, y = −z, z = y.
            columns[name] = column[::-1].transpose(2, 0, 1, 3)
        there = numpy.argwhere(columns["_color"][..., 3] > 0)
        at = tuple(there.T)
        return there + 8 * numpy.array(place), columns["_color"][at], columns["_normal"][at]

    def check_box(self, level, place, shape, translation):
        box = self.root["boundingVolume"]["box"]
        edge = 2 * box[3] / 2**level
        x, y, z = (box[c] - box[3] + (place[c] + 0.5) * edge for c in range(3))
        assert shape == {"type": "box", "box": {"size": [edge] * 3}} and translation == [x, z, -y]


def gigavoxel_nodes(element, path, depth=0):
    children = list(element)
    yield element.attrib, depth, path
    assert len(children) in (0, 8)
    for i, child in enumerate(children):
        yield from gigavoxel_nodes(child, [2 * p + (i >> axis & 1) for axis, p in enumerate(path)], depth + 1)


def gigavoxel_bricks(file):
    """Own voxels of each brick: colours [n][z][y][x][4], gradients."""
    brick = numpy.dtype([("size", "<u8", 3), ("border", "<u4", 3), ("c1", "<i4"), ("n1", "<u4"),
                         ("rgba", "u1", (10, 10, 10, 4)), ("c2", "<i4"), ("n2", "<u4"), ("n", "u1", (10, 10, 10, 3))])
    data = file.read_bytes()
    assert data[:4] == b"\0\0\0\0"
    bricks = numpy.frombuffer(data, brick, offset=4)
    assert (bricks["size"] == 10).all() and (bricks["border"] == 1).all()
    assert (bricks["n1"] == 4000).all() and (bricks["n2"] == 3000).all()
    own = numpy.s_[:, 1:9, 1:9, 1:9]
    return bricks["rgba"][own], bricks["n"][own]


def ecef(latitude, longitude, height):
    a, f = 6378137.0, 1 / 298.257223563
    e2, p, q = f * (2 - f), math.radians(latitude), math.radians(longitude)
    n = a / math.sqrt(1 - e2 * math.sin(p)**2)
    return [(n + height) * math.cos(p) * math.cos(q), (n + height) * math.cos(p) * math.sin(q),
            (n * (1 - e2) + height) * math.sin(p)]


class Export(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(sys.argv[1])
        cls.program.succeed("sample", cls.root / "village", "--size", "96", "--seed", "3")
        cls.program.bake(cls.root / "village/tileset.json", cls.root / "bake", VOXEL_M, "--cell-voxels", "64")
        cls.scene = cls.root / "bake/scene.xml"
        cls.group = xml.parse(cls.scene).getroot()

    def ply(self, lod):
        file = self.root / f"{lod}.ply"
        self.program.succeed("export", self.scene, "--to", "ply", "--lod", lod, "-o", file)
        return harness.read_ply(file)

    def expect_same(self, ply, places, rgba):
        order = numpy.lexsort(places.T)
        self.assertTrue((places[order] == ply["ijk"]).all())
        self.assertTrue((rgba[order] == ply["rgba"]).all())
        return order

    def test_voxel_3d_tiles_hold_every_level_and_stand_on_the_earth(self):
        self.program.succeed("export", self.scene, "--to", "3dtiles", "-o", self.root / "tiles")
        tileset = Tileset(self.root / "tiles")
        levels, box = tileset.tiling["availableLevels"], tileset.root["boundingVolume"]["box"]
        tiles = list(tileset.tiles())
        self.assertEqual(len(tiles), len(list((self.root / "tiles").rglob("*.glb"))))
        self.assertEqual(len(tiles), tileset.document["metadata"]["properties"]["tileCount"])
        known = set(tiles)
        self.assertTrue(all(level == 0 or (level - 1, tuple(p >> 1 for p in place)) in known for level, place in tiles))
        lattice = numpy.array([float(x) for x in self.group.get("LatticeOrigin").split()])
        for lod in (0, 1, 3):
            parts = [tileset.voxels(*tile) for tile in tiles if tile[0] == levels - 1 - lod]
            places, rgba, normals = (numpy.concatenate(column) for column in zip(*parts))
            lowest = (numpy.array(box[:3]) - box[3] - lattice) / (VOXEL_M * 2**lod)
            ply = self.ply(lod)
            order = self.expect_same(ply, places + numpy.rint(lowest).astype(int), rgba)
            self.assertTrue((normals[order] == ply["n"]).all())
        origin = [float(x) for x in self.group.get("Origin").split()]
        transform = numpy.array(tileset.root["transform"]).reshape(4, 4).T
        self.assertLess(numpy.abs(transform[:3, 3] - ecef(*origin)).max(), 1e-6)
        up = numpy.subtract(ecef(origin[0], origin[1], origin[2] + 1), ecef(*origin))
        self.assertLess(numpy.abs(transform[:3, 2] - up).max(), 1e-6)
        self.assertLess(numpy.abs(transform[:3, :3].T @ transform[:3, :3] - numpy.eye(3)).max(), 1e-12)

    def test_gigavoxel_xml_holds_the_voxels(self):
        out = self.root / "gigavoxel"
        self.program.succeed("export", self.scene, "--to", "gigavoxel-xml", "-o", out)
        places, colours, gradients = [], [], []
        for cell, tree in zip(self.group.findall("PagedOctTree"), xml.parse(out / "scene.gvp").getroot()):
            self.assertEqual(tree.get("CenterX"), cell.get("CenterX"))
            lowest = [int(x) for x in cell.get("LatticeMin").split()]
            root = xml.parse(out / tree.get("TreeFile")).getroot()
            depth = int(root.get("MaxDepth")) - 1
            rgba, normals = gigavoxel_bricks((out / tree.get("TreeFile")).parent / f"voxels_{depth}.gvb")
            for node, level, path in gigavoxel_nodes(root[0], [0, 0, 0]):
                self.assertEqual([int(node["MipMap" + axis]) for axis in "XYZ"], [8 * p for p in path])
                if node["Type"] != "NON-CONST":
                    self.assertEqual(node["ColorA"], "0")  # nothing in the village is solid
                elif level == depth:
                    brick = rgba[int(node["Brick"])]
                    there = tuple(numpy.argwhere(brick[..., 3] > 0).T)
                    places.append(numpy.stack(there[::-1], -1) + 8 * numpy.array(path) + lowest)
                    colours.append(brick[there])
                    gradients.append(normals[int(node["Brick"])][there])
        ply = self.ply(0)
        order = self.expect_same(ply, numpy.concatenate(places), numpy.concatenate(colours))
        error = numpy.abs(numpy.concatenate(gradients)[order] / 127.5 - 1 - ply["n"])
        self.assertLess(error.max(), 0.5 / 127.5 + 1e-6)

    def test_a_path_that_cannot_be_written_is_one_line(self):
        (self.root / "full").mkdir(exist_ok=True)
        (self.root / "full/file").write_text("x")
        without_openvdb = self.program.run("export", self.scene, "--to", "vdb", "-o", self.root / "x").returncode == 2
        kinds = ["ply", "nvdb", "3dtiles", "gigavoxel-xml", "gigavoxel-binary"] + ["vdb"] * (not without_openvdb)
        for kind in kinds:
            for out in (self.root / "none/out", self.root / "full"):
                result = self.program.run("export", self.scene, "--to", kind, "-o", out)
                self.assertEqual(result.returncode, 1, (kind, out))
                self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
                self.assertIn(str(out), result.stderr)
        self.assertEqual([p.name for p in (self.root / "full").iterdir()], ["file"])
        self.assertEqual([p.name for p in self.root.iterdir() if p.name.endswith(".part")], [])

    def test_an_unknown_format_is_named_with_those_there_are(self):
        result = self.program.run("export", self.scene, "--to", "obj", "-o", self.root / "x")
        self.assertEqual(result.returncode, 2)
        self.assertIn("3dtiles", result.stderr)


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
