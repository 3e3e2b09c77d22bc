#!/usr/bin/env python3
"""`voxel_size_m` of sources: coarse ground and fine trees in one scene.

References are bakes of one voxel size: coarse voxels equal voxels of the ground, baked at its size, and the expanded
scene contains all voxels of full depth.

Usage: source_levels_test.py GIGABAKE SOURCE_DIR
"""
import csv
import json
import shutil
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import read_png

VOXEL_M, GROUND_M, EDGE_M = 0.125, 1.0, 32


def ground():
    """Returns rolling ground."""
    along = numpy.arange(0, EDGE_M + 1, 2.0)
    x, z = numpy.meshgrid(along, along)
    height = 2 * numpy.sin(x / 5) + numpy.cos(z / 7)
    return numpy.stack([x, height, -z], -1).reshape(-1, 3), harness.squares_of_grid(len(along)).reshape(-1)


def trees():
    """Returns trunks that begin below the ground, with small leaves above them."""
    random = numpy.random.default_rng(4)
    corners = []
    for x, z in random.uniform(3, EDGE_M - 3, (9, 2)):
        trunk = numpy.array([[0, -3, 0], [0.3, -3, 0], [0, 5, 0]])
        leaves = random.normal(0, 0.7, (60, 1, 3)) + [0, 5, 0] + random.normal(0, 0.15, (60, 3, 3))
        corners.append(numpy.concatenate([trunk, leaves.reshape(-1, 3)]) + [x, 0, -z])
    positions = numpy.concatenate(corners)
    return positions, numpy.arange(len(positions))


class SourceLevels(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        harness.write_glb(cls.root / "ground.glb", *ground())
        harness.write_glb(cls.root / "trees.glb", *trees())
        cls.mixed = cls.bake("mixed")

    @classmethod
    def scene(cls, name, ground_m=GROUND_M, trees_m=None, **members):
        sources = [{"path": "ground.glb", "voxel_size_m": ground_m}, {"path": "trees.glb", "voxel_size_m": trees_m}]
        sources = [{key: value for key, value in source.items() if value is not None} for source in sources]
        path = cls.root / f"{name}.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": sources, **members}))
        return path

    @classmethod
    def bake(cls, name, *options, source=None, voxel_m=VOXEL_M, ranks=None):
        PROGRAM.succeed("bake", source or cls.scene(name), "-o", cls.root / name, "--voxel-size", voxel_m,
                        *(options or ("--cell-voxels", 128)), "--backend", "cpu", "-q", ranks=ranks)
        PROGRAM.succeed("verify", cls.root / name)
        return PROGRAM.info(cls.root / name / "scene.xml")

    def voxels(self, name, lod):
        PROGRAM.succeed("export", self.root / name, "--lod", lod, "-o", self.root / "v.ply")
        return {tuple(v["ijk"].tolist()): tuple(v["rgba"].tolist()) for v in harness.read_ply(self.root / "v.ply")}

    def expect_same(self, name):
        PROGRAM.succeed("diff", self.root / "mixed", self.root / name)
        self.assertEqual(harness.lod_hashes(PROGRAM.info(self.root / name / "scene.xml"), 7),
                         harness.lod_hashes(self.mixed, 7))

    def test_coarse_voxels_equal_those_of_the_coarse_source(self):
        alone = self.bake("ground", "--cell-voxels", 16, source=self.root / "ground.glb", voxel_m=GROUND_M)
        level = self.voxels("mixed", 3)
        equal = sum(level.get(at) == rgba for at, rgba in self.voxels("ground", 0).items())
        self.assertGreater(equal, 0.7 * alone["lods"][0]["voxels"])

    def test_the_expanded_scene_has_no_hole(self):
        self.bake("full", source=self.scene("full", ground_m=None))
        self.assertLess(self.mixed["lods"][0]["voxels"], 0.5 * PROGRAM.info(self.root / "full")["lods"][0]["voxels"])
        for lod in range(5):
            full, expanded = self.voxels("full", lod), self.voxels("mixed", lod)
            # Vertices of coarse sources are snapped to 1/256 of their voxels, so a few voxels differ.
            self.assertLess(len(set(full) - set(expanded)), 0.002 * len(full), lod)
            if lod == 0:
                self.assertEqual(len(expanded), self.mixed["described_voxels"])
            if lod >= 3:
                self.assertEqual(len(expanded), self.mixed["lods"][lod]["voxels"])

    def test_nothing_depends_on_cells_ranks_and_interruptions(self):
        for edge in (64, 256):
            self.bake(f"cells{edge}", "--cell-voxels", edge, source=self.root / "mixed.json")
            self.expect_same(f"cells{edge}")
        self.bake("ranks", source=self.root / "mixed.json", ranks=2)
        self.expect_same("ranks")
        shutil.copytree(self.root / "mixed", self.root / "again")
        shards = sorted((self.root / "again/shards").glob("c_*"))
        shards[0].unlink()
        self.bake("again", source=self.root / "mixed.json")
        self.expect_same("again")
        self.assertEqual([p.name for p in shards], [p.name for p in sorted((self.root / "again/shards").glob("c_*"))])

    def test_a_finer_source_makes_the_scene_s_level_0(self):
        self.bake("finer", source=self.scene("finer", ground_m=None, trees_m=VOXEL_M), voxel_m=GROUND_M)
        self.expect_same("finer")

    def test_edits_refine_what_they_select(self):
        boxes = {"min_m": [8, 8, -8], "max_m": [16, 16, 8]}
        for edge in (64, 128):
            name = f"edited{edge}"
            self.bake(name, "--cell-voxels", edge,
                      source=self.scene(name, edits=[{"type": "carve", "box": boxes}]))
        PROGRAM.succeed("diff", self.root / "edited64", self.root / "edited128")
        voxels = self.voxels("edited64", 0)
        low, high = [int(v / VOXEL_M) for v in (8, 16)]
        inside = [at for at in voxels if all(low <= c < high for c in at[:2]) and abs(at[2]) < 8 / VOXEL_M]
        self.assertEqual(inside, [])
        self.assertLess(len(set(voxels) - set(self.voxels("mixed", 0))), 1)

    def test_areas_cut_leaves_by_their_centres(self):
        for edge in (64, 256):
            self.bake(f"area{edge}", "--cell-voxels", edge, "--bounds", "5.3,4.2,20.4,27.7", "--crs", "scene",
                      source=self.root / "mixed.json")
        PROGRAM.succeed("diff", self.root / "area64", self.root / "area256")
        kept = self.voxels("area64", 3)
        expected = {at for at in self.voxels("mixed", 3)
                    if 5.3 <= at[0] + 0.5 <= 20.4 and 4.2 <= at[1] + 0.5 <= 27.7}
        self.assertGreater(len(expected & set(kept)), 0.9 * len(expected))

    def test_queries_hit_leaves(self):
        PROGRAM.succeed("query", self.root / "mixed", "--grid", "4.3,4.3,28.3,28.3", "--step", 1.5, "-o",
                        self.root / "heights.csv")
        rows = list(csv.DictReader((self.root / "heights.csv").open()))
        coarse = [row for row in rows if row["lod"] == "3"]
        self.assertGreater(len(coarse), 100)
        for row in coarse:
            height = 2 * numpy.sin(float(row["x"]) / 5) + numpy.cos(float(row["y"]) / 7)
            self.assertLess(abs(float(row["z"]) - height), 0.35, row)

    def test_python_marks_leaves(self):
        sys.path.insert(0, str(SOURCE / "python"))
        import gigabake  # pylint: disable=import-outside-toplevel

        scene = gigabake.open(self.root / "mixed")
        described = 0
        for lod in range(4):
            voxels = scene.level(lod).region()
            leaves = int(voxels.is_leaf.sum())
            described += leaves * 8**lod if lod else len(voxels)
            self.assertEqual(leaves > 0, lod > 0)
        self.assertEqual(described, self.mixed["described_voxels"])

    def test_other_exports_have_the_same_voxels(self):
        count = self.mixed["described_voxels"]
        for name in ("v.las", "v.nvdb", "tiles"):
            kind = ["--to", "3dtiles"] if name == "tiles" else []
            done = PROGRAM.succeed("export", self.root / "mixed", *kind, "-o", self.root / name)
            self.assertIn(str(count), done)
        refused = PROGRAM.run("export", self.root / "mixed", "--to", "gigavoxel-xml", "-o", self.root / "gv")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("LeafLod: lod 0 has leaves", refused.stderr)
        PROGRAM.succeed("export", self.root / "mixed", "--to", "gigavoxel-xml", "--lod", 3, "-o", self.root / "gv")

    def test_images_have_no_holes(self):
        for eye in ("16,16,40", "6,6,12", "27,9,9", "16,10,1.5"):
            PROGRAM.succeed("render", self.root / "mixed", "-o", self.root / "i.png", "--size", "160x120", "--eye", eye,
                            "--target", "16,17,-3", "--fovy", 20, "--background", "255,0,255", "-q")
            image = read_png(self.root / "i.png")[..., :3].astype(int)
            self.assertLess((image[..., [0, 2]].min(axis=-1) - image[..., 1]).max(), 20, eye)

    def test_wrong_sizes_are_refused_with_one_line(self):
        for size, expected in ((0.3, "times a power of two"), (64, "coarser than the coarsest level"),
                               (-1, "expected 1e-6 to 1e6 metres"), ("a", "voxel_size_m"), (1e9, "expected 1e-6")):
            done = PROGRAM.run("bake", self.scene("wrong", ground_m=size), "-o", self.root / "wrong", "--voxel-size",
                               VOXEL_M, "--cell-voxels", 128)
            self.assertNotEqual(done.returncode, 0)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn("wrong.json: sources[0].voxel_size_m", done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertFalse((self.root / "wrong/scene.xml").exists())
        done = PROGRAM.run("bake", self.scene("wrong"), "-o", self.root / "wrong", "--voxel-size", VOXEL_M, "--mip",
                           "thesis")
        self.assertIn("mip", done.stderr)

    def test_a_plan_knows_the_levels(self):
        mixed, full = (json.loads(PROGRAM.succeed("plan", self.scene(name, ground_m=size), "--voxel-size", VOXEL_M,
                                                  "--no-measure", "--json"))
                       for name, size in (("a", GROUND_M), ("b", None)))
        self.assertLess(mixed["sizes"][1]["voxels"], 0.7 * full["sizes"][1]["voxels"])


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
