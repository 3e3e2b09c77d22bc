#!/usr/bin/env python3
"""Wrong classes and ids, and damaged columns of classes: each ends a command with one line.

Usage: class_errors_test.py GIGABAKE SOURCE_DIR
"""
import json
import shutil
import sys
from pathlib import Path

import h5py
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from class_scene import mosaic, tile, write_gltf


class ClassErrors(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        random = numpy.random.default_rng(7)
        points, ids, _ = mosaic(random, 4.5, 5)
        write_gltf(cls.root / "low.glb", [{"points": points, "ids": {"_BATCHID": ids}}])
        write_gltf(cls.root / "high.glb", [{"points": tile(0, 0, 4, 4, 9), "material": 0}], ("roof",))
        cls.scene = cls.scene_file("scene", [
            {"path": "low.glb", "class_from_ids": {"attribute": "_BATCHID", "add": 1}},
            {"path": "high.glb", "class": 9, "class_of_material": {"roof": 6}}])
        PROGRAM.succeed("bake", cls.scene, "-o", cls.root / "whole", "--voxel-size", 1, "--cell-voxels", 64, "-q")

    @classmethod
    def scene_file(cls, name, sources, **members):
        path = cls.root / f"{name}.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": sources, **members}))
        return path

    def test_wrong_classes_are_refused_with_one_line(self):
        low, high = {"path": "low.glb"}, {"path": "high.glb"}
        write_gltf(self.root / "some.glb", [{"points": tile(0, 0, 1, 1, 0), "ids": {"_BATCHID": [1] * 6}},
                                            {"points": tile(2, 0, 1, 1, 0)}])
        write_gltf(self.root / "few.glb", [{"points": tile(0, 0, 1, 1, 0), "ids": {"_BATCHID": [1] * 5}}])
        write_gltf(self.root / "odd.glb", [{"points": tile(0, 0, 1, 1, 0), "ids": {"_BATCHID": [1.5] * 6}}])
        features = {"featureIds": [{"featureCount": 1, "attribute": 0}]}
        write_gltf(self.root / "features.glb", [{"points": tile(0, 0, 1, 1, 0), "ids": {"_FEATURE_ID_0": [1] * 6},
                                                 "extensions": {"EXT_mesh_features": features}}])
        write_gltf(self.root / "sparse.glb", [{"points": tile(0, 0, 1, 1, 0), "ids": {"_FEATURE_ID_0": [1] * 6},
                                               "extensions": {"EXT_mesh_features": {"featureIds": [None, *features[
                                                   "featureIds"]]}}}])
        (self.root / "plain.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                             "property float y\nproperty float z\nelement face 1\n"
                                             "property list uchar int vertex_indices\nend_header\n"
                                             "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        batch = {"attribute": "_BATCHID"}
        for source, key, expected in (
                ({**low, "class": 65536}, "class", "expected a whole number from 0 to 65535"),
                ({**low, "class": -1}, "class", "expected a whole number"),
                ({**low, "class": 1.5}, "class", "expected a whole number"),
                ({**low, "class": "roof"}, "class", "expected a whole number"),
                ({**high, "class_of_material": {"rof": 3}}, "class_of_material",
                 "no material of the source has the name"),
                ({**high, "class_of_material": {"roof": 70000}}, "class_of_material.roof", "expected a whole number"),
                ({**high, "class_of_material": {"roof": None}}, "class_of_material.roof", "expected a class"),
                ({**low, "class_from_ids": {"add": 1}}, "class_from_ids.attribute", "expected one of"),
                ({**low, "class_from_ids": {**batch, "add": 99999999}}, "class_from_ids.add",
                 "expected a whole number"),
                ({**low, "class_from_ids": {**batch, "add": 65533}}, "class_from_ids", "is not a class"),
                ({**low, "class_from_ids": {**batch, "add": -3}}, "class_from_ids", "is not a class"),
                ({**low, "class_from_ids": {**batch, "plus": 1}}, "class_from_ids", "plus"),
                ({**high, "class_from_ids": batch}, "class_from_ids", "has no attribute _BATCHID"),
                ({"path": "some.glb", "class_from_ids": batch}, "class_from_ids",
                 "primitives[1]: has no attribute _BATCHID"),
                ({"path": "few.glb", "class_from_ids": batch}, "class_from_ids", "has 5 ids for 6 vertices"),
                ({"path": "odd.glb", "class_from_ids": batch}, "class_from_ids", "the id 1.5 is not a whole number"),
                ({"path": "sparse.glb", "class_from_ids": {"feature_ids": 0}}, "class_from_ids", "has no set 0"),
                ({"path": "features.glb", "class_from_ids": {"feature_ids": 3}}, "class_from_ids", "has no set 3"),
                ({**low, "class_from_ids": {"feature_ids": 0}}, "class_from_ids", "has no EXT_mesh_features"),
                ({"path": "plain.ply", "class_from_ids": batch}, "class_from_ids", "has no ids")):
            for command in ("bake", "plan"):
                options = ("-q", "-o", self.root / "wrong") if command == "bake" else ("--no-measure",)
                done = PROGRAM.run(command, self.scene_file("wrong", [source]), *options, "--voxel-size", 1)
                self.assertEqual(done.returncode, 2, (source, done.stderr))
                self.assertEqual(done.stderr.count("gigabake: "), 1, done.stderr)
                self.assertTrue(done.stderr.strip().splitlines()[-1].startswith("gigabake: "), done.stderr)
                self.assertIn(f"wrong.json: sources[0].{key}", done.stderr)
                self.assertIn(expected, done.stderr)
            self.assertFalse((self.root / "wrong/scene.xml").exists())
        done = PROGRAM.run("bake", self.scene, "-o", self.root / "wrong", "--voxel-size", 1, "--mip", "thesis")
        self.assertEqual(done.returncode, 2)
        self.assertIn("mip", done.stderr)
        ranks = PROGRAM.run("bake", self.scene_file("wrong", [{**low, "class_from_ids": {**batch, "add": -3}}]), "-o",
                            self.root / "wrong", "--voxel-size", 1, "-q", ranks=2)
        self.assertEqual(ranks.stderr.count("is not a class"), 1, ranks.stderr)
        for edit in ({"class": 3}, {"class": 3, "alpha": 4}):
            box = {"min_m": [0, 0, 0], "max_m": [1, 1, 1]}
            scene = self.scene_file("wrong", [low], edits=[{"type": "carve", "box": box, **edit}])
            done = PROGRAM.run("bake", scene, "-o", self.root / "wrong", "--voxel-size", 1)
            self.assertEqual(done.returncode, 2)
            self.assertIn("edits[0].class", done.stderr)

    def test_damaged_columns_are_found(self):
        def rewritten(shard, name, rows, kind="u2"):
            del shard[name]
            shard.create_dataset(name, data=numpy.asarray(rows, kind), chunks=(len(rows),), fletcher32=True,
                                 shuffle=True, compression=1)

        def missing(shard):
            del shard["lod_0/class"]

        def short(shard):
            rewritten(shard, "lod_0/class", shard["lod_0/class"][:-1])

        def long_nodes(shard):
            rewritten(shard, "nodes/class", [*shard["nodes/class"][:], 0])

        def wide(shard):
            rewritten(shard, "lod_0/class", shard["lod_0/class"][:], "u4")

        def other(shard):
            rewritten(shard, "lod_0/class", shard["lod_0/class"][:] + 1)

        def of_a_brick(shard):
            rewritten(shard, "nodes/class", shard["nodes/class"][:] + 1)

        def above(shard):
            rewritten(shard, "above/class", shard["above/class"][:] + 1)

        def unlisted(shard):
            shard.attrs["channels"] = numpy.bytes_("rgba normal facing")

        def older(shard):
            shard.attrs["version"] = numpy.int32(7)

        for number, damage in enumerate((missing, short, long_nodes, wide, other, of_a_brick, above, unlisted, older)):
            folder = self.root / f"damaged{number}"
            shutil.copytree(self.root / "whole", folder)
            with h5py.File(next((folder / "shards").glob("c_*")), "r+") as shard:
                damage(shard)
            done = PROGRAM.run("verify", folder)
            self.assertEqual(done.returncode, 1, damage.__name__)
            self.assertIn("c_", done.stdout + done.stderr)
            if damage not in (other, above):
                done = PROGRAM.run("export", folder, "-o", self.root / "d.ply")
                self.assertEqual(done.returncode, 1, damage.__name__)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
