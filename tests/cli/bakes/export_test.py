#!/usr/bin/env python3
"""Exports read with nothing but what docs/format.md and the formats' specifications say: the same voxels as the PLY.

Usage: export_test.py GIGABAKE SOURCE_DIR
"""
import gzip
import hashlib
import json
import math
import shutil
import struct
import sys
import zipfile
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
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
    """An implicit octree, traversed by its subtrees as 3D Tiles specifies, without listing folders."""

    def __init__(self, folder):
        self.folder = folder
        self.document = json.loads((folder / "tileset.json").read_text())
        self.root = self.document["root"]
        self.tiling = self.root["implicitTiling"]

    def path(self, template, level, place):
        return self.folder / template.format(level=level, **dict(zip("xyz", place)))

    def tiles(self):
        """Yields (level, place) of each available tile. All tiles have content."""
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
        """Returns place in the level, colour and normal (bytes) of each voxel of a tile, without its padding."""
        data = gzip.decompress(self.path(self.root["content"]["uri"], level, place).read_bytes())
        magic, version, length, json_bytes, kind = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
        gltf, binary = json.loads(data[20:20 + json_bytes]), data[20 + json_bytes + 8:]
        primitive = gltf["meshes"][0]["primitives"][0]
        voxels = primitive["extensions"]["EXT_primitive_voxels"]
        of_all = self.root["content"]["extensions"]["3DTILES_content_voxels"]
        assert primitive["mode"] == 0x7FFFFFFF
        assert all(voxels[key] == of_all[key] for key in ("dimensions", "padding"))
        assert voxels["padding"] == {"before": [1, 1, 1], "after": [1, 1, 1]}
        shape = gltf["extensions"]["KHR_implicit_shapes"]["shapes"][voxels["shape"]]
        self.check_box(level, place, shape, gltf["nodes"][0]["translation"])
        edge, columns = voxels["dimensions"][0], {}
        for name, accessor in primitive["attributes"].items():
            accessor = gltf["accessors"][accessor]
            assert (accessor["type"], accessor["componentType"], accessor["normalized"]) == ("VEC4", 5121, True)
            view = gltf["bufferViews"][accessor["bufferView"]]
            column = numpy.frombuffer(binary, "u1", view["byteLength"], view["byteOffset"])
            column = column.reshape([edge + 2] * 3 + [4])
            # glTF: [z][y][x] with y up; tileset: x, y = −z, z = y.
            columns[name] = column[::-1].transpose(2, 0, 1, 3)[1:-1, 1:-1, 1:-1]
        assert ((columns["_color"][..., 3] > 0) == (columns["_normal"][..., 3] == 255)).all()
        there = numpy.argwhere(columns["_color"][..., 3] > 0)
        at = tuple(there.T)
        return there + edge * numpy.array(place), columns["_color"][at], columns["_normal"][at][:, :3]

    def check_box(self, level, place, shape, translation):
        box = self.root["boundingVolume"]["box"]
        edge = 2 * box[3] / 2**level
        x, y, z = (box[c] - box[3] + (place[c] + 0.5) * edge for c in range(3))
        assert shape == {"type": "box", "box": {"size": [edge] * 3}} and translation == [x, z, -y]


def glb_of(data):
    """Returns the document and the buffer of a binary glTF."""
    magic, _, length, json_bytes = struct.unpack_from("<4sIII", data)
    assert magic == b"glTF" and length == len(data)
    return json.loads(data[20:20 + json_bytes]), data[20 + json_bytes + 8:]


def gigavoxel_nodes(element, path, depth=0):
    children = list(element)
    yield element.attrib, depth, path
    assert len(children) in (0, 8)
    for i, child in enumerate(children):
        yield from gigavoxel_nodes(child, [2 * p + (i >> axis & 1) for axis, p in enumerate(path)], depth + 1)


def gigavoxel_bricks(file):
    """Yields the inner voxels of each brick: colours [n][z][y][x][4], gradients."""
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
        self.program.succeed("export", self.scene, "--to", "3dtiles", "--tile-voxels", "32", "-o", self.root / "tiles")
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
            direction = (normals[order].astype(float) - 128) / 127
            direction /= numpy.linalg.norm(direction, axis=1, keepdims=True)
            self.assertGreater((direction * ply["n"]).sum(1).min(), math.cos(math.radians(0.6)))
        origin = [float(x) for x in self.group.get("Origin").split()]
        transform = numpy.array(tileset.root["transform"]).reshape(4, 4).T
        self.assertLess(numpy.abs(transform[:3, 3] - ecef(*origin)).max(), 1e-6)
        up = numpy.subtract(ecef(origin[0], origin[1], origin[2] + 1), ecef(*origin))
        self.assertLess(numpy.abs(transform[:3, 2] - up).max(), 1e-6)
        self.assertLess(numpy.abs(transform[:3, :3].T @ transform[:3, :3] - numpy.eye(3)).max(), 1e-12)

    def files_of(self, folder):
        return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}

    def test_voxel_3d_tiles_say_what_they_hold(self):
        """Compares the statistics of all levels and the box of the finest level's bricks with the tiles."""
        out = self.root / "said"
        self.program.succeed("export", self.scene, "--to", "3dtiles", "-o", out)
        tileset = Tileset(out)
        voxels = [tileset.voxels(*tile) for tile in tileset.tiles()]
        statistics = tileset.document["statistics"]["classes"]["voxel"]
        self.assertEqual(statistics["count"], sum(len(places) for places, _, _ in voxels))
        colours = numpy.concatenate([rgba for _, rgba, _ in voxels])
        normals = (numpy.concatenate([n for _, _, n in voxels]).astype(float) - 128) / 127
        for name, values in (("color", colours / 255), ("normal", normals)):
            said = statistics["properties"][name]
            self.assertLess(numpy.abs(values.min(0) - said["min"][:values.shape[1]]).max(), 1e-12)
            self.assertLess(numpy.abs(values.max(0) - said["max"][:values.shape[1]]).max(), 1e-12)
        finest = tileset.tiling["availableLevels"] - 1
        places = numpy.concatenate([v[0] for v, tile in zip(voxels, tileset.tiles()) if tile[0] == finest])
        box = numpy.array(tileset.root["boundingVolume"]["box"])
        metres = box[:3] - box[3] + numpy.array([places.min(0), places.max(0) + 1]) * VOXEL_M
        said = tileset.document["metadata"]["properties"]
        self.assertTrue((said["lowest"] <= metres[0]).all() and (metres[0] - said["lowest"] < 8 * VOXEL_M).all())
        self.assertTrue((said["highest"] >= metres[1]).all() and (said["highest"] - metres[1] < 8 * VOXEL_M).all())
        self.assertIn("tileset.json", (out / "index.html").read_text())

    def test_voxel_3d_tiles_are_the_same_for_any_cells_ranks_and_threads(self):
        """Compares upper levels from overviews of one scene with upper levels from a single cell of the other scene."""
        source = self.root / "village/tileset.json"
        self.program.bake(source, self.root / "large", VOXEL_M, "--cell-voxels", "1024")
        wish = ("--to", "3dtiles", "--tile-voxels", "16")
        self.program.succeed("export", self.root / "large", *wish, "--threads", "1", "-o", self.root / "of_one_cell")
        expected = self.files_of(self.root / "of_one_cell")
        self.assertGreater(len(expected), 50)
        self.program.succeed("export", self.scene, *wish, "--threads", "3", "-o", self.root / "of_cells")
        self.program.succeed("export", self.scene, *wish, "-o", self.root / "of_ranks", ranks=3)
        of_cells = self.files_of(self.root / "of_cells")
        self.assertEqual(of_cells, self.files_of(self.root / "of_ranks"))
        of_cells.pop("export.json"), expected.pop("export.json")  # they list the shards of the tiles
        self.assertEqual(of_cells, expected)

    def test_a_3tz_archive_holds_the_same_files_and_finds_them_by_its_index(self):
        wish = ("export", self.scene, "--to", "3dtiles", "--tile-voxels", "16")
        self.program.succeed(*wish, "-o", self.root / "set")
        self.program.succeed("export", self.scene, "--tile-voxels", "16", "-o", self.root / "set.3tz")
        files = self.files_of(self.root / "set")
        files = {name: gzip.decompress(data) if name.endswith(".glb") else data for name, data in files.items()
                 if name not in ("export.json", "index.html")}
        with zipfile.ZipFile(self.root / "set.3tz") as archive:
            self.assertIsNone(archive.testzip())
            entries = archive.infolist()
            self.assertEqual(entries[-1].filename, "@3dtilesIndex1@")
            self.assertEqual({e.filename: archive.read(e) for e in entries[:-1]}, files)
            index = numpy.frombuffer(archive.read(entries[-1]), [("hash", "<u8", 2), ("at", "<u8")])
            self.assertEqual(entries[-1].compress_type, zipfile.ZIP_STORED)
        rows = [(int(h[0]), int(h[1])) for h in index["hash"]]
        self.assertEqual(rows, sorted(rows))
        for entry in entries[:-1]:
            row = rows.index(struct.unpack("<QQ", hashlib.md5(entry.filename.encode()).digest()))
            self.assertEqual(index["at"][row], entry.header_offset)
        self.assertEqual([p.name for p in self.root.iterdir() if p.name.endswith(".part")], [])

    def test_an_update_rewrites_the_tiles_that_changed_and_gives_what_a_new_export_gives(self):
        village = self.root / "changed"
        shutil.copytree(self.root / "village", village)
        bake, out = self.root / "bake_of_changed", self.root / "updated"
        wish = ("--to", "3dtiles", "--tile-voxels", "16", "-o")
        self.program.bake(village / "tileset.json", bake, VOXEL_M, "--cell-voxels", "64")
        self.program.succeed("export", bake, *wish, out)
        before = {p: p.stat().st_ino for p in out.rglob("*.glb")}
        tiles = sorted(village.rglob("*.glb"), key=lambda p: (p.stat().st_size, p))
        shutil.copyfile(tiles[0], next(p for p in tiles if p.read_bytes() != tiles[0].read_bytes()))
        self.program.bake(village / "tileset.json", bake, VOXEL_M, "--cell-voxels", "64")
        refused = self.program.run("export", bake, *wish, out)
        self.assertEqual((refused.returncode, len(lines_of(refused.stderr))), (1, 1), refused.stderr)
        self.assertIn("--update", refused.stderr)
        self.program.succeed("export", bake, *wish, out, "--update")
        self.program.succeed("export", bake, *wish, self.root / "anew")
        self.assertEqual(self.files_of(out), self.files_of(self.root / "anew"))
        kept = [p for p, inode in before.items() if p.exists() and p.stat().st_ino == inode]
        self.assertGreater(len(kept), 10)
        self.assertLess(len(kept), len(before))
        self.assertEqual([p.name for p in self.root.iterdir() if p.name.endswith(".part")], [])

    def test_an_update_of_what_is_no_export_is_refused_in_one_line(self):
        (self.root / "other").mkdir()
        (self.root / "other/file").write_text("x")
        (self.root / "damaged").mkdir()
        (self.root / "damaged/export.json").write_text('{"format":"gigabake voxel tileset","version":2,"tiles":[[0]]}')
        for name in ("other", "damaged", "absent"):
            result = self.program.run("export", self.scene, "--to", "3dtiles", "--update", "-o", self.root / name)
            self.assertEqual((result.returncode, len(lines_of(result.stderr))), (1, 1), result.stderr)
            self.assertIn(name, result.stderr)
        self.assertEqual([p.name for p in (self.root / "other").iterdir()], ["file"])

    # Regression of 2026-11-25: truncated and swapped tiles were kept, and other files were deleted without a message.
    def test_an_update_keeps_no_damaged_tile_and_deletes_no_other_file(self):
        wish, out = ("--to", "3dtiles", "--tile-voxels", "16", "-o"), self.root / "repaired"
        self.program.succeed("export", self.scene, *wish, out)
        before, tiles = self.files_of(out), sorted(out.rglob("*.glb"))
        tiles[0].write_bytes(tiles[0].read_bytes()[:-1])
        first, second = tiles[1].read_bytes(), tiles[2].read_bytes()
        tiles[1].write_bytes(second)
        tiles[2].write_bytes(first)
        tiles[3].unlink()
        self.program.succeed("export", self.scene, *wish, out, "--update")
        self.assertEqual(self.files_of(out), before)
        (out / "tiles/notes.txt").write_text("mine")
        refused = self.program.run("export", self.scene, *wish, out, "--update")
        self.assertEqual((refused.returncode, len(lines_of(refused.stderr))), (1, 1), refused.stderr)
        self.assertIn("notes.txt", refused.stderr)
        self.assertEqual((out / "tiles/notes.txt").read_text(), "mine")

    # Regression of 2026-11-25: levels above the cells' levels could not be exported.
    def test_every_format_takes_every_level_that_info_lists(self):
        levels = len(self.program.info(self.scene)["lods"])
        for form in ("ply", "las", "nvdb", "3dtiles", "3dtiles-gltf", "gigavoxel-xml", "gigavoxel-binary"):
            with self.subTest(form=form):
                wish = ("export", self.scene, "--to", form, "-o", self.root / f"level_{form}", "--lod")
                refused = self.program.run(*wish, levels)
                line = f"--lod: there is no lod {levels}; expected 0 to {levels - 1}"
                self.assertEqual((refused.returncode, line in refused.stderr), (1, True), refused.stderr)
                self.program.succeed(*wish, levels - 1)

    def test_the_form_of_gltf_2_1_holds_the_same_voxels(self):
        """EXT_voxels has x to the right, forward and up; the frame of glTF 2.1 has x to the left."""
        wish = ("--tile-voxels", "16", "-o")
        self.program.succeed("export", self.scene, "--to", "3dtiles", *wish, self.root / "form_1")
        self.program.succeed("export", self.scene, "--to", "3dtiles-gltf", *wish, self.root / "form_2")
        tileset = Tileset(self.root / "form_1")
        document = json.loads((self.root / "form_2/tileset.gltf").read_text())
        implicit = document["nodes"][0]["extensions"]["3DTILES_implicit_tiling"]
        self.assertEqual(document["extensions"]["3DTILES_tileset_voxels"]["dimensions"], [16, 16, 16])
        tiles = list(tileset.tiles())
        for level, (x, y, z) in tiles[::7]:
            path = self.root / "form_2" / implicit["contentUri"].format(level=level, right=x, forward=y, up=z)
            gltf, binary = glb_of(gzip.decompress(path.read_bytes()))
            node = gltf["nodes"][0]
            accessor = gltf["accessors"][node["extensions"]["EXT_voxels"]["attributes"]["_COLOR"]]
            view = gltf["bufferViews"][accessor["bufferView"]]
            grid = numpy.frombuffer(binary, "u1", view["byteLength"], view["byteOffset"]).reshape(18, 18, 18, 4)
            own = grid.transpose(2, 1, 0, 3)[1:-1, 1:-1, 1:-1]
            there = numpy.argwhere(own[..., 3] > 0)
            places, colours, _ = tileset.voxels(level, (x, y, z))
            self.assertTrue((there + 16 * numpy.array((x, y, z)) == places).all())
            self.assertTrue((own[tuple(there.T)] == colours).all())
        self.assertEqual(len(list((self.root / "form_2").rglob("tiles/**/*.glb"))), len(tiles))
        subtree, binary = glb_of((self.root / "form_2/subtrees/0/0/0/0.subtree.glb").read_bytes())
        said = subtree["extensions"]["3DTILES_subtree"]
        count = (8**implicit["subtreeLevels"] - 1) // 7
        self.assertEqual(bits(subtree, binary, said["tileAvailability"], count).sum(), len(tiles))

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
                    self.assertEqual(node["ColorA"], "0")  # no voxel of the village is solid
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
        kinds = ["ply", "las", "dsm", "ortho", "nvdb", "3dtiles", "3dtiles-gltf", "gigavoxel-xml", "gigavoxel-binary"]
        kinds += ["vdb"] * (not without_openvdb)
        for kind in kinds:
            for out in (self.root / "none/out", self.root / "full"):
                result = self.program.run("export", self.scene, "--to", kind, "-o", out)
                self.assertEqual(result.returncode, 1, (kind, out))
                self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
                self.assertIn(str(out), result.stderr)
        self.assertEqual([p.name for p in (self.root / "full").iterdir()], ["file"])
        self.assertEqual([p.name for p in self.root.iterdir() if p.name.endswith(".part")], [])

    def test_options_of_tilesets_are_refused_for_other_formats(self):
        for option in (["--update"], ["--threads", "2"], ["--tile-voxels", "64"]):
            result = self.program.run("export", self.scene, "-o", self.root / "options.ply", *option)
            self.assertEqual((result.returncode, len(lines_of(result.stderr))), (2, 1), result.stderr)
            self.assertIn(option[0], result.stderr)

    def test_an_unknown_format_is_named_with_those_there_are(self):
        result = self.program.run("export", self.scene, "--to", "obj", "-o", self.root / "x")
        self.assertEqual(result.returncode, 2)
        self.assertIn("3dtiles", result.stderr)


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
