#!/usr/bin/env python3
"""Tests `--max-error` and `--channels`: each voxel stays within the bound, and flat ground costs few bytes.

Usage: depth_test.py GIGABAKE SOURCE_DIR
"""
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

VOXEL_M, GROUND_M, LODS = 0.25, 16, 4


def ground_and_trees():
    """Returns level ground whose colour varies by one or two codes, and balls of small leaves in all directions."""
    random = numpy.random.default_rng(11)
    x, z = numpy.meshgrid(numpy.arange(GROUND_M * 4 + 1) * VOXEL_M, numpy.arange(GROUND_M * 4 + 1) * VOXEL_M)
    ground = numpy.stack([x, numpy.full_like(x, 0.125), -z], -1).reshape(-1, 3)
    squares = harness.squares_of_grid(x.shape[0])
    middles = random.normal(0, 1, (4000, 1, 3)) + numpy.array([8, 8, -8])
    leaves = middles + random.normal(0, 0.15, (4000, 3, 3))
    positions = numpy.concatenate([ground, leaves.reshape(-1, 3)])
    indices = numpy.concatenate([squares.reshape(-1), len(ground) + numpy.arange(12000)])
    colours = numpy.concatenate([random.integers(100, 102, (len(ground), 4)),
                                 numpy.repeat(random.integers(20, 200, (4000, 4)), 3, axis=0)])
    colours[:, 3] = 255
    return positions, indices, colours


class Depth(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        harness.write_glb(cls.root / "scene.glb", *ground_and_trees())
        cls.exact = cls.bake("exact")
        cls.exact_voxels = [cls.voxels("exact", lod) for lod in range(LODS)]

    @classmethod
    def bake(cls, name, *arguments):
        return PROGRAM.bake(cls.root / "scene.glb", cls.root / name, VOXEL_M, "--cell-voxels", 64, "--local",
                            "--backend", "cpu", *arguments)

    @classmethod
    def voxels(cls, name, lod):
        PROGRAM.succeed("export", cls.root / name / "scene.xml", "--to", "ply", "--lod", lod, "-o", cls.root / "v.ply")
        return harness.read_ply(cls.root / "v.ply").copy()

    def test_every_voxel_of_every_level_stays_within_the_bound(self):
        before = sum(lod["bytes"] for lod in self.exact["lods"])
        for codes in (1, 3, 8, 32):
            info = self.bake(f"within-{codes}", "--max-error", codes)
            PROGRAM.succeed("verify", self.root / f"within-{codes}/scene.xml")
            now = sum(lod["bytes"] for lod in info["lods"])
            self.assertLess(now, 1.01 * before)
            before = now
            for lod in range(LODS):
                exact, off = self.exact_voxels[lod], self.voxels(f"within-{codes}", lod)
                with self.subTest(codes=codes, lod=lod):
                    numpy.testing.assert_array_equal(exact["ijk"], off["ijk"])
                    codes_off = numpy.abs(exact["rgba"].astype(int) - off["rgba"])
                    self.assertLessEqual(codes_off.max(), codes)
                    half_chord = numpy.linalg.norm(exact["n"].astype(float) - off["n"], axis=1) / 2
                    self.assertLessEqual(half_chord.max(), codes / 255 + 1e-4)
                    if lod == 0:
                        self.assertGreater(codes_off.max(), 0)

    def test_threads_and_ranks_do_not_show(self):
        hashes = [[lod["content_hash"] for lod in self.bake(f"threads-{threads}", "--max-error", 4, "--threads",
                                                            threads)["lods"]] for threads in (1, 3)]
        self.assertEqual(*hashes)

    def test_flat_ground_costs_a_fraction_of_fine_trees(self):
        try:
            import h5py
        except ImportError as error:
            self.skipTest(str(error))
        positions, indices, colours = ground_and_trees()
        ground = len(positions) - 12000
        parts = {"ground": (positions[:ground], indices[:-12000], colours[:ground]),
                 "trees": (positions[ground:], indices[-12000:] - ground, colours[ground:])}
        bytes_per_voxel = {}
        for name, codes in (("ground", 0), ("ground", 4), ("trees", 4)):
            harness.write_glb(self.root / f"{name}.glb", *parts[name])
            folder = self.root / f"{name}-{codes}"
            PROGRAM.bake(self.root / f"{name}.glb", folder, VOXEL_M, "--cell-voxels", 64, "--local", "--backend", "cpu",
                         "--max-error", codes)
            colour_bytes = voxels = 0
            for path in (folder / "shards").glob("c_*.h5"):
                with h5py.File(path) as shard:
                    colour_bytes += shard["lod_0/rgb"].id.get_storage_size()
                    voxels += len(shard["lod_0/rgb"])
            bytes_per_voxel[name, codes] = colour_bytes / voxels
        print(f"bytes of colours per voxel, by part and --max-error: {bytes_per_voxel}")
        self.assertLess(bytes_per_voxel["ground", 4], 0.05)
        self.assertGreater(bytes_per_voxel["ground", 0], 4 * bytes_per_voxel["ground", 4])
        self.assertGreater(bytes_per_voxel["trees", 4], 1)

    def test_channels_are_those_that_were_asked_for(self):
        for channels, normals, facing in (("rgba", False, False), ("rgba,facing", False, True),
                                          ("rgba,normal", True, False), ("rgba,normal,facing", True, True)):
            with self.subTest(channels=channels):
                info = self.bake(channels, "--channels", channels)
                PROGRAM.succeed("verify", self.root / channels / "scene.xml")
                self.assertEqual((info["normals"], info["facing"]), (normals, facing))
                for lod in range(LODS):
                    numpy.testing.assert_array_equal(self.voxels(channels, lod)["ijk"], self.exact_voxels[lod]["ijk"])
                    numpy.testing.assert_array_equal(self.voxels(channels, lod)["rgba"],
                                                     self.exact_voxels[lod]["rgba"])
        plain = self.voxels("rgba", 0)
        numpy.testing.assert_array_equal(plain["rgba"], self.exact_voxels[0]["rgba"])
        self.assertEqual(numpy.abs(plain["n"]).max(), 0)

    def test_odd_values_are_refused(self):
        for option, value in (("--max-error", 128), ("--max-error", -1), ("--max-error", 0.5), ("--channels", "normal"),
                              ("--channels", "rgba normal"), ("--channels", "rgba,facing,normal"), ("--codec", "zip")):
            result = PROGRAM.run("bake", self.root / "scene.glb", "-o", self.root / "no", "--voxel-size", 1, option,
                                 value)
            self.assertEqual(result.returncode, 2, (option, value, result))
            self.assertIn(option, result.stderr)
            self.assertFalse((self.root / "no").exists())


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
