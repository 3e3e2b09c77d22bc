#!/usr/bin/env python3
"""`bake --depth-error`: leaves in place of finer voxels, within a bound that is checked for each voxel.

The reference is a bake of full depth, compared by tests/cli/support/branch_bound.py.

Usage: depth_error_test.py GIGABAKE SOURCE_DIR
"""
import csv
import itertools
import json
import shutil
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from branch_bound import expect_depth_error
from png_file import read_png

VOXEL_M, CODES = 0.125, 4


class Mesh:
    """Triangles in the scene's axes, z up, with a colour per corner."""

    def __init__(self):
        self.corners, self.colours = [], []

    def add(self, corners, colours):
        self.corners.append(numpy.asarray(corners, float).reshape(-1, 3))
        self.colours.append(numpy.broadcast_to(colours, (len(self.corners[-1]), 4)))

    def add_quad(self, a, b, c, d, colours):
        self.add([a, b, c, a, c, d], colours)

    def add_grid(self, height, colour, low, high, step=1.0):
        """Adds a surface z = height(x, y) whose colours are colour(x, y)."""
        along = numpy.arange(low, high + step / 2, step)
        x, y = numpy.meshgrid(along, along)
        points = numpy.stack([x, y, height(x, y)], -1).reshape(-1, 3)
        index = harness.squares_of_grid(len(along)).reshape(-1)
        self.add(points[index], colour(*points[index].T[:2]))

    def write(self, path):
        points, colours = numpy.concatenate(self.corners), numpy.concatenate(self.colours)
        harness.write_glb(path, points[:, [0, 2, 1]] * [1, 1, -1], numpy.arange(len(points)), colours)


def rgba(*values):
    return numpy.stack([*numpy.broadcast_arrays(*values), numpy.full(numpy.broadcast(*values).shape, 255)], -1)


def landscape():
    """Returns ground with slow and fast changes of height and colour, walls, planes through corners of the lattice, and
    small things on a flat floor."""
    mesh = Mesh()
    mesh.add_grid(lambda x, y: 1.5 * numpy.sin(x / 9) + numpy.cos(y / 11),
                  lambda x, y: rgba(60 + 2 * x, 120 + 40 * (numpy.sin(3 * y) > 0.9), 60 + y), 0, 32)
    grey = (90, 90, 90, 255)
    mesh.add_quad([34, 0, 0], [50, 0, 0], [50, 32, 0], [34, 32, 0], grey)  # in a plane of the lattice
    mesh.add_quad([34, 0, 5.3], [50, 0, 5.3], [50, 32, 5.3], [34, 32, 5.3], grey)
    mesh.add([[36, 4, 0], [36.2, 4, 0], [36.1, 4, 0.3]], (255, 0, 0, 255))  # one voxel wide
    mesh.add_quad([40.2, 8.2, 0.01], [41.3, 8.2, 0.01], [41.3, 9.3, 0.01], [40.2, 9.3, 0.01], (200, 30, 30, 255))
    mesh.add_quad([52, 0, 0], [60, 8, 0], [60, 8, 16], [52, 0, 16], grey)  # through edges of the lattice
    mesh.add([[52, 16, 0], [68, 16, 0], [52, 32, 16]], grey)
    mesh.add([[64, 0, 16], [64, 16, 0], [80, 0, 0]], grey)  # through corners of the lattice
    mesh.add_quad([52, 20, 20], [68, 20.7, 20], [68, 32, 21], [52, 31, 21], (180, 160, 40, 255))
    return mesh


def near(mask, pixels=2):
    """Returns the pixels within a distance of pixels of `mask`: an outline may move by a pixel."""
    padded = numpy.pad(mask, pixels)
    height, width = mask.shape
    return numpy.any([padded[y:y + height, x:x + width] for y in range(2 * pixels + 1) for x in range(2 * pixels + 1)],
                     axis=0)


class DepthError(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        landscape().write(cls.root / "scene.glb")
        cls.full = cls.bake("full")
        cls.ended = cls.bake("ended", "--depth-error", CODES)

    @classmethod
    def bake(cls, name, *options, cell_voxels=256, source="scene.glb", ranks=None):
        PROGRAM.succeed("bake", cls.root / source, "-o", cls.root / name, "--voxel-size", VOXEL_M, "--local",
                        "--cell-voxels", cell_voxels, "--backend", "cpu", "-q", *options, ranks=ranks)
        PROGRAM.succeed("verify", cls.root / name)
        return PROGRAM.info(cls.root / name / "scene.xml")

    def open(self, name):
        return gigabake.open(self.root / name)

    def test_each_ended_voxel_is_within_the_bound(self):
        before = 1.0
        for codes in (1, 2, CODES, 16, 127):
            self.bake(f"e{codes}", "--depth-error", codes)
            leaves = expect_depth_error(self.open("full"), self.open(f"e{codes}"), codes)
            info = PROGRAM.info(self.root / f"e{codes}")
            fraction = info["lods"][0]["voxels"] / self.full["lods"][0]["voxels"]
            self.assertLessEqual(fraction, before, codes)
            if codes >= CODES:
                self.assertTrue(all(leaves[1:3]), leaves)
                self.assertLess(fraction, 0.6, codes)
            before = fraction

    def test_random_triangles_are_within_the_bound(self):
        random = numpy.random.default_rng(586)
        for number in range(3):
            mesh = Mesh()
            for _ in range(30):
                corners = random.uniform(0, 24, 3) + random.normal(0, 6, (3, 3))
                mesh.add(corners, (*random.integers(0, 256, 3), 255))
            mesh.add_grid(lambda x, y: x / 8 + y / 16, lambda x, y: rgba(x * 3, y * 3, 90), 0, 24, 4)
            mesh.write(self.root / "random.glb")
            codes = int(random.integers(2, 40))
            for name, options in (("r_full", ()), ("r_ended", ("--depth-error", codes))):
                self.bake(name, *options, cell_voxels=64 << number, source="random.glb")
            leaves = expect_depth_error(self.open("r_full"), self.open("r_ended"), codes)
            self.assertGreater(sum(leaves), 100)

    def test_small_things_keep_their_voxels(self):
        for part in ([35.5, 3.5, -0.2], [37, 4.5, 0.5]), ([39.9, 7.9, -0.2], [41.5, 9.5, 0.5]):
            full, ended = (self.open(name).level(0).region(part) for name in ("full", "ended"))
            red = {tuple(i) for i, c in zip(full.index.tolist(), full.rgb.tolist()) if c[0] > c[1] + CODES}
            self.assertTrue(red)
            self.assertLessEqual(red, {tuple(i) for i in ended.index.tolist()})

    def test_zero_changes_nothing(self):
        self.assertNotIn("described_voxels", self.full)
        zero = self.bake("zero", "--depth-error", 0)
        self.assertEqual(harness.lod_hashes(zero), harness.lod_hashes(self.full))
        self.assertEqual(harness.cells_of(self.root / "zero"), harness.cells_of(self.root / "full"))

    def test_nothing_depends_on_cells_ranks_memory_and_threads(self):
        variants = {"ranks": {"ranks": 2}, **{f"c{edge}": {"cell_voxels": edge} for edge in (32, 64, 1024)}}
        options = {"small": ("--memory", "64M", "--threads", 1), "threads": ("--threads", 3)}
        for name in (*variants, *options):
            info = self.bake(name, "--depth-error", CODES, *options.get(name, ()), **variants.get(name, {}))
            self.assertEqual(harness.lod_hashes(info, 3), harness.lod_hashes(self.ended, 3), name)
            PROGRAM.succeed("diff", self.root / "ended", self.root / name)

    def test_origins_of_the_lattice_keep_octants_aligned(self):
        # Stacks of cells begin elsewhere, octants do not.
        info = self.bake("tall", "--depth-error", CODES, "--bounds", "0,0,70,30,-3,21", "--crs", "scene")
        again = self.bake("tall64", "--depth-error", CODES, "--bounds", "0,0,70,30,-3,21", "--crs", "scene",
                          cell_voxels=64)
        self.assertEqual(harness.lod_hashes(info, 4), harness.lod_hashes(again, 4))

    def test_coarser_levels_and_overviews_are_those_of_full_depth(self):
        self.assertEqual(harness.lod_hashes(self.ended)[3:], harness.lod_hashes(self.full)[3:])
        self.assertGreater(len(self.full["lods"]), 5)

    def test_exports_have_thin_surfaces(self):
        PROGRAM.succeed("export", self.root / "ended", "-o", self.root / "v.ply")
        expanded = {tuple(v) for v in harness.read_ply(self.root / "v.ply")["ijk"].tolist()}
        full = {tuple(v) for v in self.open("full").level(0).region().index.tolist()}
        self.assertEqual(len(expanded), self.ended["described_voxels"])
        self.assertLess(abs(len(expanded) / len(full) - 1.05), 0.15)
        steps = sorted(itertools.product((-1, 0, 1), repeat=3), key=numpy.count_nonzero)
        for some, others in ((full, expanded), (expanded, full)):
            far = [v for v in some if not any((v[0] + x, v[1] + y, v[2] + z) in others for x, y, z in steps)]
            self.assertEqual(far, [])

    def test_parts_of_the_scene_are_as_opaque_as_parts_of_full_depth(self):
        for lod in (3, 4, 5):
            alpha = []
            for name in ("full", "ended"):
                PROGRAM.succeed("export", self.root / name, "--lod", lod, "--bounds", "3.3,3.3,78,29", "--crs", "scene",
                                "-o", self.root / "v.ply")
                voxels = harness.read_ply(self.root / "v.ply")
                alpha.append({tuple(v["ijk"].tolist()): int(v["rgba"][3]) for v in voxels})
            full, ended = alpha
            self.assertLess(len(set(full) ^ set(ended)), 0.03 * len(full), lod)
            apart = [ended[at] - full[at] for at in full if at in ended]
            self.assertLess(abs(numpy.mean(apart)), 5, lod)
            self.assertLess(numpy.mean(numpy.abs(apart)), 8, lod)

    def test_queries_hit_planes(self):
        rows = {}
        for name in ("full", "ended"):
            PROGRAM.succeed("query", self.root / name, "--grid", "0.7,0.7,79,31", "--step", 0.71, "-o",
                            self.root / "heights.csv")
            rows[name] = list(csv.DictReader((self.root / "heights.csv").open()))
        self.assertEqual({row["lod"] for row in rows["ended"]}, {row["lod"] for row in rows["full"]})
        both = [(a["z"], b["z"]) for a, b in zip(rows["full"], rows["ended"])]
        apart = [abs(float(a) - float(b)) for a, b in both if a and b]
        self.assertGreater(len(apart), 3000)
        self.assertEqual(sum(bool(a) and not b for a, b in both), 0)
        self.assertLess(sum(bool(b) and not a for a, b in both), 0.005 * len(both))  # at borders
        self.assertLess(numpy.quantile(apart, 0.995), (CODES / 8 + 0.25) * VOXEL_M)

    def test_images_are_as_opaque_as_full_depth(self):
        views = (("20,16,60", "20,17,0"), ("16,-20,9", "16,16,0"), ("41,16,9", "43,14,0"), ("75,5,25", "58,14,8"),
                 ("44,2,1.5", "43,30,1"))
        for number, (eye, target) in enumerate(views):
            images = []
            for name in ("full", "ended"):
                PROGRAM.succeed("render", self.root / name, "-o", self.root / "i.png", "--size", "200x150", "--eye",
                                eye, "--target", target, "--fovy", 40, "--background", "255,0,255", "-q")
                images.append(read_png(self.root / "i.png")[..., :3].astype(float))
            apart = abs(images[1] - images[0]).max(axis=-1)
            # Pixels of colour steps and borders differ, where a coarse voxel reaches into its neighbour.
            self.assertLess(numpy.mean(apart), 4, number)
            shows_background = [image[..., [0, 2]].min(axis=-1) - image[..., 1] > 60 for image in images]
            self.assertFalse((shows_background[1] & ~near(shows_background[0])).any(), f"{number}: a hole")
            self.assertFalse((~shows_background[1] & ~near(~shows_background[0])).any(), f"{number}: an extra surface")

    def test_edits_bake_cells_again(self):
        carve = [{"type": "carve", "box": {"min_m": [36, 10, -1], "max_m": [44, 20, 1]}}]
        for name in ("full", "ended"):
            path = self.root / f"{name}.json"
            path.write_text(json.dumps({"gigabake": 1, "sources": [{"path": "scene.glb"}], "edits": carve}))
            shutil.copytree(self.root / name, self.root / f"{name}_edited")
            self.bake(f"{name}_edited", *(["--depth-error", CODES] if name == "ended" else []), source=path.name)
        expect_depth_error(self.open("full_edited"), self.open("ended_edited"), CODES)

    def test_both_errors_add_up(self):
        self.bake("both", "--depth-error", CODES, "--max-error", 3)
        both, ended = (self.open(name).level(2).region() for name in ("both", "ended"))
        self.assertEqual(len(both), len(ended))
        self.assertLessEqual(abs(both.rgb.astype(int) - ended.rgb).max(), 3)

    def test_sources_of_several_sizes_end_too(self):
        path = self.root / "sizes.json"
        coarse = Mesh()
        coarse.add_grid(lambda x, y: x / 7, lambda x, y: rgba(x, y, x), 90, 122, 32)
        coarse.write(self.root / "coarse.glb")
        path.write_text(json.dumps({"gigabake": 1, "sources": [
            {"path": "scene.glb"}, {"path": "coarse.glb", "voxel_size_m": 8 * VOXEL_M}]}))
        full, ended = self.bake("sizes", source=path.name), self.bake("sizes_ended", "--depth-error", CODES,
                                                                      source=path.name)
        self.assertEqual(harness.lod_hashes(full)[3:], harness.lod_hashes(ended)[3:])
        self.assertLess(ended["lods"][0]["voxels"], 0.6 * full["lods"][0]["voxels"])

    def test_wrong_bounds_are_refused_with_one_line(self):
        for options, expected in ((("--depth-error", -1), "--depth-error"), (("--depth-error", "nan"), "--depth-error"),
                                  (("--depth-error", 1.5), "--depth-error"),
                                  (("--depth-error", 128), "expected 0 to 127 codes of 255, got 128"),
                                  (("--depth-error", 4, "--cell-voxels", 16), "needs cells of at least 32 voxels"),
                                  (("--depth-error", 4, "--channels", "rgba"), "compares planes"),
                                  (("--depth-error", 4, "--channels", "rgba,normal"), "compares planes"),
                                  (("--depth-error", 4, "--mip", "box"), "compares planes")):
            done = PROGRAM.run("bake", self.root / "scene.glb", "-o", self.root / "wrong", "--voxel-size", VOXEL_M,
                               *options)
            self.assertNotEqual(done.returncode, 0)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertFalse((self.root / "wrong").exists())


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    sys.path.insert(0, str(SOURCE / "python"))
    import gigabake

    harness.main(argv=sys.argv[:1], verbosity=2)
