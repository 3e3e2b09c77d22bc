#!/usr/bin/env python3
"""Classes from ids of instances: EXT_instance_features of glTF and BATCH_ID of i3dm.

The reference is computed here: two instances of a square share each voxel, and the one with the larger area decides.

Usage: instance_ids_test.py GIGABAKE SOURCE_DIR
"""
import json
import struct
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from class_scene import ClassTest, tile, write_gltf

EDGE = 16  # voxels
NULL_ID = 3


def padded(data, fill):
    return data + fill * (-len(data) % 8)


class InstanceIds(ClassTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        random = numpy.random.default_rng(11)
        cls.ids = random.integers(0, 6, 2 * EDGE * EDGE)
        wide = random.integers(0, 2, EDGE * EDGE)  # the instance with three quarters of a voxel
        cls.places, cls.scales, cls.decides = [], [], {}
        for x in range(EDGE):
            for y in range(EDGE):
                at = x * EDGE + y
                first = 0.75 if wide[at] == 0 else 0.25
                cls.places += [(x, 0, -y), (x + first, 0, -y)]
                cls.scales += [(first, 1, 1), (1 - first, 1, 1)]
                cls.decides[(x, y, 5)] = 2 * at + int(wide[at])
        cls.square = tile(0, 0, 1, 1, 5.5)

    def write_glb(self, name, features, **ids):
        """Writes the instances with sets of EXT_instance_features. `ids` has further attributes."""
        write_gltf(self.root / name, [{"points": self.square}], features=features,
                   instances={"TRANSLATION": self.places, "SCALE": self.scales, **ids})

    def write_i3dm(self, name, batch_ids=None, kind="<u2", type_name=None):
        write_gltf(self.root / "square.glb", [{"points": self.square}])
        model = (self.root / "square.glb").read_bytes()
        # The tile's z is up: y of the tile is -z of glTF.
        places = numpy.array([(x, -z, y) for x, y, z in self.places], "<f4").tobytes()
        scales = numpy.array([(x, z, y) for x, y, z in self.scales], "<f4").tobytes()
        table = {"INSTANCES_LENGTH": len(self.places), "POSITION": {"byteOffset": 0},
                 "SCALE_NON_UNIFORM": {"byteOffset": len(places)}}
        columns = places + scales
        if batch_ids is not None:
            table["BATCH_ID"] = {"byteOffset": len(columns), **({"componentType": type_name} if type_name else {})}
            columns += numpy.asarray(batch_ids).astype(kind).tobytes()
        text, columns = padded(json.dumps(table).encode(), b" "), padded(columns, b"\0")
        (self.root / name).write_bytes(
            struct.pack("<4s7I", b"i3dm", 1, 32 + len(text + columns + model), len(text), len(columns), 0, 0, 1) +
            text + columns + model)

    def scene_of(self, name, **ids):
        return self.scene_file("scene", [{"path": name, "class": 40, "class_from_ids": {"instance_ids": 0, **ids}}])

    def expect_classes(self, of_instance):
        self.expect_equal(self.classes("baked"), {at: int(of_instance[i]) for at, i in self.decides.items()})

    def test_voxels_have_the_class_of_the_instance_with_the_max_area(self):
        self.write_glb("ids.glb", [{"featureCount": 6, "attribute": 2, "nullFeatureId": NULL_ID}],
                       _FEATURE_ID_2=self.ids)
        expected = numpy.where(self.ids == NULL_ID, 0, self.ids + 7)
        self.assertEqual(len(set(expected)), 6)
        for options, ranks in (((), None), (("--cell-voxels", 16), 2),
                               (("--cell-voxels", 8, "--memory", "256M"), None)):
            self.bake("baked", self.scene_of("ids.glb", add=7), *options, ranks=ranks)
            self.expect_classes(expected)

    def test_a_set_without_an_attribute_numbers_the_instances(self):
        self.write_glb("ids.glb", [{"featureCount": len(self.ids)}])
        self.bake("baked", self.scene_of("ids.glb"))
        self.expect_classes(numpy.arange(len(self.ids)))

    def test_i3dm_has_ids_of_8_16_or_32_bits(self):
        for kind, name in (("<u2", None), ("<u2", "UNSIGNED_SHORT"), ("u1", "UNSIGNED_BYTE"), ("<u4", "UNSIGNED_INT")):
            self.write_i3dm("ids.i3dm", self.ids, kind, name)
            self.bake("baked", self.scene_of("ids.i3dm", add=1))
            self.expect_classes(self.ids + 1)

    def test_an_i3dm_without_ids_numbers_its_instances(self):
        self.write_i3dm("ids.i3dm")
        self.bake("baked", self.scene_of("ids.i3dm"))
        self.expect_classes(numpy.arange(len(self.ids)))

    def test_an_id_that_changed_bakes_again(self):
        for shift in (0, 1):
            ids = numpy.roll(self.ids, shift)
            self.write_i3dm("ids.i3dm", ids)
            self.bake("baked", self.scene_of("ids.i3dm"))
            self.expect_classes(ids)

    def test_instances_without_transforms_are_baked(self):  # 2026-11-28: they were dropped without a message
        write_gltf(self.root / "plain.glb", [{"points": self.square}], features=[], instances={"_FEATURE_ID_0": [7]})
        PROGRAM.succeed("bake", self.root / "plain.glb", "-o", self.root / "plain", "--voxel-size", 1)
        self.assertEqual(PROGRAM.info(self.root / "plain")["lods"][0]["voxels"], 1)

    def test_ids_that_are_not_used_are_reported_once(self):
        self.write_glb("unused.glb", [{"featureCount": 6}])
        self.write_i3dm("unused.i3dm", self.ids)
        for name in ("unused.glb", "unused.i3dm"):
            done = PROGRAM.run("bake", self.root / name, "-o", self.root / "unused", "--voxel-size", 1)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr.count("whose instances have ids that are not used"), 1, done.stderr)

    def test_wrong_ids_are_refused_with_one_line(self):
        right, attribute = [{"featureCount": 6, "attribute": 2}], {"_FEATURE_ID_2": self.ids}
        write_gltf(self.root / "none.glb", [{"points": self.square}])
        self.write_i3dm("large.i3dm", self.ids + 65535, "<u4", "UNSIGNED_INT")
        self.write_i3dm("right.i3dm", self.ids)
        for name, options, ids, expected in (
                ("none.glb", None, {}, "nodes[0]: has no EXT_instance_features"),
                ("a.glb", {"features": []}, {}, "EXT_instance_features has no set 0"),
                ("a.glb", {"features": 7}, {}, "EXT_instance_features has no set 0"),
                ("a.glb", {"features": right, **attribute}, {"instance_ids": 1}, "EXT_instance_features has no set 1"),
                ("a.glb", {"features": [{"attribute": 1}]}, {}, "has no attribute _FEATURE_ID_1"),
                ("a.glb", {"features": [{"attribute": "x"}]}, {}, "expected the number of an attribute"),
                ("a.glb", {"features": right, "_FEATURE_ID_2": self.ids[:9]}, {}, "has 9 ids for 512 instances"),
                ("a.glb", {"features": right, "_FEATURE_ID_2": [(1, 2)] * 512}, {}, "several numbers per instance"),
                ("a.glb", {"features": right, "_FEATURE_ID_2": self.ids + 0.5}, {}, "is not a whole number"),
                ("a.glb", {"features": right, **attribute}, {"add": -1}, "the id 0 + -1 is not a class"),
                ("a.glb", {"features": right, **attribute}, {"feature_ids": 0}, "expected one of"),
                ("a.glb", {"features": right, **attribute}, {"instance_ids": -1}, "expected a whole number from 0"),
                ("large.i3dm", None, {}, "+ 0 is not a class"),
                ("right.i3dm", None, {"instance_ids": 1}, "an i3dm has set 0 only")):
            if options:
                self.write_glb(name, **options)
            scene = self.scene_of(name, **ids)
            for command in (("bake", "-o", self.root / "wrong", "-q"), ("plan", "--no-measure")):
                done = PROGRAM.run(*command, scene, "--voxel-size", 1)
                self.assertEqual(done.returncode, 2, (name, done.stderr))
                self.assertEqual(done.stderr.count("gigabake: "), 1, done.stderr)
                self.assertIn(expected, done.stderr)
            self.assertFalse((self.root / "wrong/scene.xml").exists())

    def test_damaged_ids_of_an_i3dm_are_reported(self):
        self.write_i3dm("float.i3dm", self.ids, "<u2", "FLOAT")
        self.write_i3dm("outside.i3dm", self.ids)
        at = b'"BATCH_ID": {"byteOffset":'
        outside = (self.root / "outside.i3dm").read_bytes().replace(at + b" ", at + b"9")
        (self.root / "outside.i3dm").write_bytes(outside)
        for name, expected in (("float.i3dm", "expected componentType UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT"),
                               ("outside.i3dm", "bytes inside the table's")):
            done = PROGRAM.run("bake", self.scene_of(name), "-o", self.root / "damaged", "--voxel-size", 1, "-q")
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("feature table.BATCH_ID: ", done.stderr)
            self.assertIn(expected, done.stderr)


if __name__ == "__main__":
    PROGRAM = ClassTest.PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    harness.main(argv=sys.argv[:1], verbosity=2)
