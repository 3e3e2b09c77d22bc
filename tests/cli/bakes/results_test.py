#!/usr/bin/env python3
"""info, verify, diff and export: their answers, exit codes and single-line errors on whole and on damaged scenes.

Usage: results_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import resource
import shutil
import signal
import sys
import unittest
import unittest.mock
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

VOXEL_M = 0.25


def bumpy_ground(quads=40):
    grid = numpy.arange(quads + 1) * 0.4
    x, z = numpy.meshgrid(grid, grid)
    positions = numpy.stack([x, numpy.sin(x) * numpy.cos(z), -z], -1).reshape(-1, 3)
    indices = harness.squares_of_grid(quads + 1)
    colours = numpy.random.default_rng(3).integers(0, 256, (len(positions), 4))
    colours[:, 3] = 255
    return positions, indices, colours


class Results(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.source = cls.root / "ground.glb"
        harness.write_glb(cls.source, *bumpy_ground())
        cls.info = PROGRAM.bake(cls.source, cls.root / "a", VOXEL_M, "--cell-voxels", 32)
        PROGRAM.bake(cls.source, cls.root / "b", VOXEL_M, "--cell-voxels", 64)
        cls.a, cls.b = cls.root / "a/scene.xml", cls.root / "b/scene.xml"

    def damaged_copy(self):
        copy = self.root / "damaged"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(self.root / "a", copy)
        return copy / "scene.xml", sorted((copy / "shards").glob("*.h5"))

    def expect_one_line(self, result, *told, code=1):
        self.assertEqual(result.returncode, code, result)
        lines = result.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        for text in told:
            self.assertIn(text, lines[0])

    # info

    def test_info_adds_up(self):
        info = self.info
        self.assertEqual(info["triangles"], 3200)
        self.assertEqual(info["cells"], len(list((self.root / "a/shards").glob("c_*.h5"))))
        self.assertEqual(info["bytes"], sum(p.stat().st_size for p in (self.root / "a/shards").glob("*.h5")))
        self.assertEqual(info["voxels"], sum(lod["voxels"] for lod in info["lods"]))
        total = sum(int(lod["content_hash"], 16) for lod in info["lods"]) % 2**128
        self.assertEqual(info["content_hash"], f"{total:032x}")
        self.assertLess(sum(lod["bytes"] for lod in info["lods"]) + info["node_bytes"], info["bytes"])
        self.assertEqual(info["losses"], [])

    def test_info_tells_a_person_the_same(self):
        text = PROGRAM.succeed("info", self.a)
        self.assertIn(self.info["content_hash"], text)
        for lod in self.info["lods"]:
            self.assertIn(lod["content_hash"], text)

    def test_info_of_something_else_is_one_line(self):
        self.expect_one_line(PROGRAM.run("info", self.source), "ground.glb", "not a scene")
        self.expect_one_line(PROGRAM.run("info", self.root / "absent.xml"), "absent.xml")

    # verify

    def test_verify_finds_a_whole_scene_whole(self):
        self.assertIn("whole", PROGRAM.succeed("verify", self.a))
        answer = json.loads(PROGRAM.succeed("verify", self.a, "--json"))
        self.assertEqual((answer["faults"], answer["voxels"]), ([], self.info["voxels"]))

    def test_shards_are_written_and_read_without_hdf5_plugins(self):
        with unittest.mock.patch.dict(os.environ, HDF5_PLUGIN_PRELOAD="::", HDF5_PLUGIN_PATH=str(self.root)):
            info = PROGRAM.bake(self.source, self.root / "plain", VOXEL_M, "--cell-voxels", 32)
            PROGRAM.succeed("verify", self.root / "plain/scene.xml")
        self.assertEqual(info["content_hash"], self.info["content_hash"])
        for shard in (self.root / "a/shards").glob("*.h5"):
            self.assertEqual(shard.read_bytes(), (self.root / "plain/shards" / shard.name).read_bytes())

    def test_verify_names_file_and_dataset_of_every_fault(self):
        scene, shards = self.damaged_copy()
        damaged = bytearray(shards[0].read_bytes())
        for at in range(len(damaged) // 2, len(damaged) // 2 + 64):
            damaged[at] ^= 0x55
        shards[0].write_bytes(damaged)
        shards[1].unlink()
        result = PROGRAM.run("verify", scene)
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"{shards[1].name}: no such file", result.stdout)
        self.assertIn(f"{shards[0].name}: /", result.stdout)
        answer = json.loads(PROGRAM.run("verify", scene, "--json").stdout)
        self.assertGreaterEqual(len(answer["faults"]), 2)

    def test_verify_sees_that_a_shard_was_replaced_by_another(self):
        scene, shards = self.damaged_copy()
        shutil.copyfile(shards[1], shards[0])
        result = PROGRAM.run("verify", scene)
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"{shards[0].name}: fingerprint", result.stdout)

    def test_any_flipped_byte_is_seen_or_does_no_harm(self):
        scene, shards = self.damaged_copy()
        whole = shards[0].read_bytes()
        random = numpy.random.default_rng(11)
        for at in random.integers(0, len(whole), 25):
            damaged = bytearray(whole)
            damaged[at] ^= 1 << int(random.integers(8))
            shards[0].write_bytes(damaged)
            result = PROGRAM.run("verify", scene)
            self.assertIn(result.returncode, (0, 1), f"byte {at}: {result}")
            self.assertEqual(result.returncode == 0, "whole" in result.stdout, f"byte {at}")

    # diff

    def test_diff_of_the_same_scene_is_zero(self):
        self.assertIn("the same voxels", PROGRAM.succeed("diff", self.a, self.a))

    def test_diff_compares_by_voxel_where_cells_are_cut_differently(self):
        answer = json.loads(PROGRAM.succeed("diff", self.a, self.b, "--json"))
        self.assertTrue(answer["same"])
        self.assertEqual(answer["lods_compared"], [0, 1, 2, 3], "a level of a cell and a level of its overview")

    def test_diff_says_where_and_by_how_much(self):
        positions, indices, colours = bumpy_ground()
        changed = colours.copy()
        changed[0] = 255 - changed[0]
        changed[0, 3] = 255
        harness.write_glb(self.root / "changed.glb", positions, indices, changed)
        PROGRAM.bake(self.root / "changed.glb", self.root / "c", VOXEL_M, "--cell-voxels", 64)
        result = PROGRAM.run("diff", self.a, self.root / "c/scene.xml", "--json")
        self.assertEqual(result.returncode, 1)
        places = json.loads(result.stdout)["cells"]
        self.assertEqual(len(places), 2, "one vertex changed, in one cell and the overview above it")
        self.assertEqual([place["cell_in_a"][0] for place in places], ["c", "p"])
        finest = places[0]["lods"][0]
        self.assertEqual((finest["lod"], finest["only_in_a"], finest["only_in_b"], finest["turned"]), (0, 0, 0, 0))
        self.assertGreater(finest["recoloured"], 0)
        self.assertLess(finest["recoloured"], 16)
        self.assertEqual(finest["largest_rgba"][3], 0)

    def test_diff_agrees_with_two_exports(self):
        PROGRAM.bake(self.source, self.root / "d", VOXEL_M, "--cell-voxels", 32, "--surface", "thin")
        answer = json.loads(PROGRAM.run("diff", self.a, self.root / "d/scene.xml", "--json").stdout)
        vertices = []
        for name in "ad":
            PROGRAM.succeed("export", self.root / name / "scene.xml", "--to", "ply", "-o", self.root / "v.ply")
            vertices.append({tuple(v["ijk"]): tuple(v["rgba"]) for v in harness.read_ply(self.root / "v.ply")})
        a, d = vertices
        finest = [lod for cell in answer["cells"] for lod in cell["lods"] if lod["lod"] == 0]
        self.assertEqual(sum(lod["only_in_a"] for lod in finest), len(a.keys() - d.keys()))
        self.assertEqual(sum(lod["only_in_b"] for lod in finest), len(d.keys() - a.keys()))
        self.assertEqual(sum(lod["recoloured"] for lod in finest), sum(a[p] != d[p] for p in a.keys() & d.keys()))

    def test_diff_of_different_lattices_is_one_line(self):
        PROGRAM.bake(self.source, self.root / "coarse", 2 * VOXEL_M)
        self.expect_one_line(PROGRAM.run("diff", self.a, self.root / "coarse/scene.xml"), "VoxelSize", code=2)

    # export

    def test_export_holds_every_voxel_of_a_level(self):
        for lod in (0, 2):
            PROGRAM.succeed("export", self.a, "--to", "ply", "--lod", lod, "-o", self.root / "v.ply")
            vertices = harness.read_ply(self.root / "v.ply")
            self.assertEqual(len(vertices), self.info["lods"][lod]["voxels"])
            self.assertEqual(len(numpy.unique(vertices["ijk"], axis=0)), len(vertices))
            numpy.testing.assert_allclose(vertices["p"], (vertices["ijk"] + 0.5) * VOXEL_M * 2**lod, atol=1e-12)

    def test_export_of_a_level_or_format_that_is_not_there_writes_nothing(self):
        out = self.root / "none.ply"
        self.expect_one_line(PROGRAM.run("export", self.a, "--to", "ply", "--lod", 9, "-o", out), "lod 9")
        self.assertEqual(PROGRAM.run("export", self.a, "--to", "obj", "-o", out).returncode, 2)
        self.assertFalse(out.exists())

    def test_export_to_a_full_disk_leaves_what_was_there(self):
        folder = self.root / "full"
        folder.mkdir()
        (folder / "v.ply").write_text("before")

        def small_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

        result = PROGRAM.run("export", self.a, "--to", "ply", "-o", folder / "v.ply", preexec_fn=small_disk)
        self.expect_one_line(result, "v.ply", "File too large")
        self.assertEqual((folder / "v.ply").read_text(), "before")
        self.assertEqual(os.listdir(folder), ["v.ply"])

    @unittest.skipIf(os.geteuid() == 0, "the superuser may write anywhere")
    def test_export_into_a_read_only_folder_is_one_line(self):
        folder = self.root / "read-only"
        folder.mkdir(mode=0o555)
        self.expect_one_line(PROGRAM.run("export", self.a, "--to", "ply", "-o", folder / "v.ply"), "v.ply")


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
