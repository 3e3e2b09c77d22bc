#!/usr/bin/env python3
"""Classes from feature ids in textures: through cells, ranks, memory, edits of sources, changed images and bad input.

The reference is computed here: surfaces are flat, and texels are quarters of a voxel, so that areas count texels.

Usage: id_textures_test.py GIGABAKE SOURCE_DIR
"""
import json
import struct
import sys
import zlib
from pathlib import Path

import numpy

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "support"), str(Path(__file__).resolve().parents[2] / "fuzz")]
import harness
from class_scene import ClassTest, majority, tile, write_gltf
import packed_seeds
from png_file import chunk, write_png

EDGE, TEXELS = 32, 128  # voxels and texels along a side
NULL_ID = 259


def features(texture, **members):
    return {"extensions": {"EXT_mesh_features": {"featureIds": [{"featureCount": 9, "texture": texture, **members}]}}}


def image_of(ids):
    """Returns RGB with the ids in blue, then red; green is noise."""
    return numpy.stack([ids >> 8, ids * 37 & 255, ids & 255], -1).astype("u1")


class IdTextures(ClassTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        random = numpy.random.default_rng(3)
        cls.ids = random.integers(256, 261, (TEXELS, TEXELS))
        write_png(cls.root / "ids.png", image_of(cls.ids))
        cls.points = tile(0, 0, EDGE, EDGE, 5.5)
        uv = [(x / EDGE, -y / EDGE) for x, _, y in cls.points]
        cls.members = {"images": [{"uri": "ids.png"}], "textures": [{"source": 0}]}
        write_gltf(cls.root / "ids.glb", [{"points": cls.points, "ids": {"TEXCOORD_1": uv}, **features(
            {"index": 0, "texCoord": 1, "channels": [2, 0]}, nullFeatureId=NULL_ID)}], members=cls.members)
        cls.source = {"path": "ids.glb", "class_from_ids": {"feature_ids": 0, "add": -200}}
        cls.scene = cls.scene_file("scene", [cls.source])
        cls.bake("whole", cls.scene)

    @staticmethod
    def expected(ids):
        out = {}
        for x in range(EDGE):
            for y in range(EDGE):
                classes = [0 if i == NULL_ID else int(i) - 200
                           for i in ids[4 * y:4 * y + 4, 4 * x:4 * x + 4].reshape(-1)]
                out[(x, y, 5)] = majority({c: classes.count(c) for c in classes})
        return out

    def test_voxels_have_the_class_of_the_max_area_of_texels(self):
        expected = self.expected(self.ids)
        self.assertEqual(len(set(expected.values())), 5)
        self.expect_equal(self.classes("whole"), expected)

    def test_nothing_depends_on_cells_ranks_and_memory(self):
        for name, options, ranks in (("small", ("--cell-voxels", 16), None), ("ranks", ("--cell-voxels", 16), 2),
                                     ("memory", ("--cell-voxels", 32, "--memory", "256M"), None)):
            self.bake(name, self.scene, *options, ranks=ranks)
            PROGRAM.succeed("diff", self.root / "whole", self.root / name)

    def test_no_other_value_changes(self):
        self.bake("plain", self.scene_file("plain", [{"path": self.source["path"], "class": 3}]))
        answer = json.loads(PROGRAM.run("diff", self.root / "plain", self.root / "whole", "--json").stdout)
        lod = answer["cells"][0]["lods"][0]
        self.assertEqual([lod[key] for key in ("only_in_a", "only_in_b", "recoloured", "turned", "refaced")], [0] * 5)

    def test_edits_of_sources_cut_texture_coordinates(self):
        hole = {"type": "outside", "rings_m": [[[3, 5], [20, 5], [20, 21], [3, 21]]]}
        self.bake("cut", self.scene_file("cut", [{**self.source, "edits": [hole]}]))
        self.expect_equal(self.classes("cut"), {at: number for at, number in self.expected(self.ids).items()
                                                if not (3 <= at[0] < 20 and 5 <= at[1] < 21)})

    def test_a_changed_image_bakes_again(self):
        folder = self.root / "changing"
        folder.mkdir()
        (folder / "ids.glb").write_bytes((self.root / "ids.glb").read_bytes())
        write_png(folder / "ids.png", image_of(self.ids))
        (folder / "scene.json").write_text(self.scene.read_text())
        self.bake("changed", folder / "scene.json")
        ids = numpy.roll(self.ids, 9, 1)
        write_png(folder / "ids.png", image_of(ids))
        self.bake("changed", folder / "scene.json")
        self.expect_equal(self.classes("changed"), self.expected(ids))

    def test_wrong_textures_are_refused_with_one_line(self):
        uv = {"TEXCOORD_0": [(0, 0)] * 6}
        right, missing = {"index": 0, "channels": [2, 0]}, {**self.members, "images": [{"uri": "none.png"}]}
        (self.root / "cut.png").write_bytes((self.root / "ids.png").read_bytes()[:900])
        flat = numpy.zeros((1, 1, 3), "u1")
        write_png(self.root / "flat.png", flat + 255)
        damaged = bytearray((self.root / "ids.png").read_bytes())
        damaged[len(damaged) // 2] ^= 255
        (self.root / "damaged.png").write_bytes(damaged)
        for texture, members, ids, expected in (
                ({**right, "channels": []}, self.members, uv, "texture.channels: expected 1 to 3"),
                ({**right, "channels": [0, 1, 2, 3]}, self.members, uv, "texture.channels: expected 1 to 3"),
                ({**right, "channels": "r"}, self.members, uv, "texture.channels: expected 1 to 3"),
                ({**right, "channels": [4]}, self.members, uv, "texture.channels[0]: expected a channel from 0 to 3"),
                ({**right, "channels": [0, 0.5]}, self.members, uv, "texture.channels[1]: expected a channel"),
                ({**right, "index": 1}, self.members, uv, "texture.index: expected one of the 1 textures"),
                ({"channels": [0]}, self.members, uv, "texture.index: expected"),
                (7, self.members, uv, "texture.index: expected"),
                (right, {**self.members, "textures": [{"source": 3}]}, uv, "names no image of the file"),
                (right, {**self.members, "textures": [{}]}, uv, "cannot be used"),
                (right, missing, uv, "none.png"),
                (right, {**self.members, "images": [{"uri": "cut.png"}]}, uv, "cannot be used"),
                (right, {**self.members, "images": [{"uri": "damaged.png"}]}, uv, "cannot be used"),
                ({**right, "texCoord": 2}, self.members, uv, "has no attribute TEXCOORD_2"),
                ({**right, "texCoord": -1}, self.members, uv, "texture.texCoord: expected"),
                (right, self.members, {"TEXCOORD_0": [(0, 0)] * 5}, "expected one VEC2 for each of the 6 vertices"),
                (right, self.members, {"TEXCOORD_0": [0] * 6}, "expected one VEC2"),
                ({**right, "channels": [2]}, self.members, uv, "is not a class"),
                ({**right, "channels": [0, 1, 2]}, {**self.members, "images": [{"uri": "flat.png"}]}, uv,
                 "the id 16777215 + -200 of texel (0, 0)")):
            write_gltf(self.root / "wrong.glb", [{"points": self.points, "ids": ids, **features(texture)}],
                       members=members)
            scene = self.scene_file("wrong", [{**self.source, "path": "wrong.glb"}])
            for command in ("bake", "plan"):
                options = ("-q", "-o", self.root / "wrong") if command == "bake" else ("--no-measure",)
                done = PROGRAM.run(command, scene, *options, "--voxel-size", 1)
                self.assertEqual(done.returncode, 2, (texture, members, done.stderr))
                self.assertEqual(done.stderr.count("gigabake: "), 1, done.stderr)
                self.assertIn("wrong.json: sources[0].class_from_ids", done.stderr)
                self.assertIn(expected, done.stderr)
            self.assertFalse((self.root / "wrong/scene.xml").exists())

    def test_channel_0_is_the_default(self):
        write_png(self.root / "one.png", numpy.full((2, 2, 3), (9, 8, 7), "u1"))
        self.bake("one", self.scene_of_image("one.png"))
        self.assertEqual(set(self.classes("one").values()), {9})

    def scene_of_image(self, image, texture=None):
        """Returns a scene whose ids are the red bytes of a file; `texture` replaces its texture."""
        write_gltf(self.root / "one.glb", [{"points": self.points, "ids": {"TEXCOORD_0": [(0, 0)] * 6},
                                            **features({"index": 0})}],
                   members={"images": [{"uri": image}], "textures": [texture or {"source": 0}]})
        return self.scene_file("one", [{"path": "one.glb", "class_from_ids": {"feature_ids": 0}}])

    def test_lossy_compression_of_ids_is_reported_once(self):
        webp = {"extensions": {"EXT_texture_webp": {"source": 0}}}
        for name, data, texture, count in (("one.jpg", packed_seeds.JPEG, None, 1),
                                           ("lossy.webp", packed_seeds.WEBP, webp, 1),
                                           ("exact.webp", packed_seeds.WEBP_LOSSLESS, webp, 0)):
            (self.root / name).write_bytes(data)
            done = PROGRAM.run("bake", self.scene_of_image(name, texture), "-o", self.root / "lossy", "--voxel-size", 1)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr.count("images of ids with lossy compression"), count, (name, done.stderr))

    def test_more_than_8_bits_per_channel_are_refused(self):
        deep = numpy.arange(16 * 16 * 3 * 2).reshape(16, -1).astype("u1")
        rows = b"".join(b"\0" + row.tobytes() for row in deep)
        (self.root / "deep.png").write_bytes(
            b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 16, 16, 16, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
        done = PROGRAM.run("bake", self.scene_of_image("deep.png"), "-o", self.root / "deep", "--voxel-size", 1)
        self.assertEqual(done.returncode, 2)
        self.assertIn("images[0] has 16 bits per channel; expected 8", done.stderr)

    def test_textures_of_ids_that_are_not_used_are_reported_once(self):
        done = PROGRAM.run("bake", self.root / "ids.glb", "-o", self.root / "unused", "--voxel-size", 1)
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stderr.count("primitives with ids that are not used"), 1, done.stderr)


if __name__ == "__main__":
    PROGRAM = ClassTest.PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    harness.main(argv=sys.argv[:1], verbosity=2)
