#!/usr/bin/env python3
"""Compares the accuracy numbers of `bake --report` with the results of an independent reader of the shards.

Usage: report_test.py GIGABAKE SOURCE_DIR
"""
import json
import math
import sys
from pathlib import Path

import h5py_test  # skips if h5py or its filter is missing
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from h5py_test import h5py, numpy

VOXEL_M = 0.25
BINS = (1, 64, 128, 192, 255, 256)


def by_h5py(out):
    """Returns voxels, bytes on disk, mean alpha and counts of alphas per lod, over all shards of the scene."""
    levels = [{"alphas": [], "bytes": 0} for _ in range(6)]
    for path in sorted((out / "shards").glob("*.h5")):
        with h5py.File(path) as shard:
            for lod in range(shard.attrs["copied_lods"], shard.attrs["lods"]):
                level = levels[shard.attrs["first_lod"] + lod]
                if len(shard[f"lod_{lod}/rgb"]) or any(shard["nodes/kind"][:] != h5py_test.BRICK):
                    try:
                        level["alphas"].append(h5py_test.level_of(shard, lod)[1][:, 3])
                    except ValueError:  # no voxels
                        pass
                level["bytes"] += sum(column.id.get_storage_size() for column in shard[f"lod_{lod}"].values())
    for level in levels:
        level["alphas"] = numpy.concatenate(level["alphas"])
    return levels


class Report(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        positions, indices, colours = h5py_test.slab_and_hills()
        random = numpy.random.default_rng(11)
        ground = len(positions) - 4 * 33
        colours[:ground, 3] = random.integers(0, 256, ground)
        bad = len(positions)
        positions = numpy.concatenate([positions, [[0, numpy.nan, 0]]])
        colours = numpy.concatenate([colours, [[0, 0, 0, 255]]])
        indices = numpy.concatenate([indices, [0, 1, bad, 5, 5, 6, 7, 8, 7]])
        with numpy.errstate(invalid="ignore"):
            harness.write_glb(cls.root / "scene.glb", numpy.nan_to_num(positions), indices, colours,
                              material={"alphaMode": "BLEND"})
        cls.spoil(cls.root / "scene.glb", numpy.asarray(positions, "<f4"))
        cls.first = cls.bake("out")

    @staticmethod
    def spoil(path, positions):
        """Writes NaN into the positions: JSON cannot express NaN in an accessor's bounds."""
        content = path.read_bytes()
        clean = numpy.nan_to_num(positions).tobytes()
        assert content.count(clean) == 1
        path.write_bytes(content.replace(clean, positions.tobytes()))

    @classmethod
    def bake(cls, out, **options):
        report = cls.root / "report.json"
        PROGRAM.bake(cls.root / "scene.glb", cls.root / out, VOXEL_M, "--cell-voxels", 64, "--report", report,
                     **options)
        return json.loads(report.read_text())

    def test_levels_are_those_in_the_shards(self):
        levels = by_h5py(self.root / "out")
        self.assertEqual(len(self.first["levels"]), len(levels))
        self.assertEqual(len(levels), 6)
        for lod, (said, read) in enumerate(zip(self.first["levels"], levels)):
            with self.subTest(lod=lod):
                alphas = read["alphas"].astype(numpy.int64)
                self.assertEqual(said["lod"], lod)
                self.assertEqual(said["voxel_size_m"], VOXEL_M * 2**lod)
                self.assertEqual(said["voxels"], len(alphas))
                self.assertEqual(said["bytes"], read["bytes"])
                self.assertEqual(said["bytes_per_voxel"], read["bytes"] / len(alphas))
                self.assertAlmostEqual(said["mean_coverage"], alphas.mean() / 255, delta=1e-12)
                self.assertEqual(said["coverage"], numpy.histogram(alphas, BINS)[0].tolist())
                if lod == 0:
                    self.assertGreater(min(said["coverage"]), 0, "every bin is tried")

    def test_levels_add_up_to_the_totals(self):
        self.assertEqual(sum(level["voxels"] for level in self.first["levels"]), self.first["voxels"])
        self.assertEqual(self.first["levels"][0]["voxels"], self.first["voxels_lod0"])

    def test_dropped_triangles_have_their_reasons(self):
        self.assertEqual(self.first["dropped"], {"non_finite": 1, "zero_area": 2})
        self.assertEqual(self.first["losses"], [])

    def test_the_snap_moves_a_vertex_by_half_a_sub_voxel(self):
        bound = self.first["snap_error_bound_m"]
        self.assertEqual(bound["axis"], VOXEL_M / 512)
        self.assertAlmostEqual(bound["distance"], math.sqrt(3) * VOXEL_M / 512, delta=1e-15)

    def figures(self, report):
        return {key: report[key] for key in ("levels", "snap_error_bound_m", "source_precision", "dropped", "voxels")}

    def test_figures_are_the_same_on_two_ranks(self):
        self.assertEqual(self.figures(self.bake("two", ranks=2)), self.figures(self.first))

    def test_figures_are_the_same_where_nothing_is_baked_again(self):
        again = self.bake("out")
        self.assertEqual(again["cells_taken_over"], again["cells_planned"])
        self.assertEqual(self.figures(again), self.figures(self.first))

    def test_figures_are_the_same_where_shards_are_read_back(self):
        self.bake("read-back")
        (self.root / "read-back/journal").unlink()
        again = self.bake("read-back")
        self.assertEqual(again["cells_taken_over"], 0)
        self.assertEqual(self.figures(again), self.figures(self.first))

    def test_it_is_what_json_prints(self):
        report = self.root / "same.json"
        printed = PROGRAM.succeed("bake", self.root / "scene.glb", "-o", self.root / "json", "--voxel-size", VOXEL_M,
                                  "--json", "--report", report)
        self.assertEqual(printed, report.read_text())

    # Regression of 2026-11-25: a missing folder was only reported after the bake.
    def test_the_folder_of_a_report_is_checked_before_the_bake(self):
        result = PROGRAM.run("bake", self.root / "scene.glb", "-o", self.root / "never", "--voxel-size", VOXEL_M,
                             "--report", self.root / "absent/report.json")
        self.assertEqual(result.returncode, 1)
        self.assertIn("absent", result.stderr.splitlines()[-1])
        self.assertFalse((self.root / "never").exists())
        PROGRAM.succeed("bake", self.root / "scene.glb", "-o", self.root / "inside", "--voxel-size", VOXEL_M,
                        "--report", self.root / "inside/report.json")
        self.assertTrue((self.root / "inside/report.json").exists())

    def test_a_report_that_cannot_be_written_is_an_error_after_the_bake(self):
        result = PROGRAM.run("bake", self.root / "scene.glb", "-o", self.root / "no", "--voxel-size", VOXEL_M,
                             "--report", self.root / ("r" * 300))
        self.assertEqual(result.returncode, 1)
        self.assertIn("rrr", result.stderr.splitlines()[-1])
        self.assertTrue((self.root / "no/scene.xml").exists())


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
