#!/usr/bin/env python3
"""Renders the sample terrain: images are plausible and reproducible, and unusable options are refused.

Usage: render_test.py GIGABAKE SOURCE_DIR
"""
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import read_png
from programs import lines_of

SIZE = (240, 135)


class Render(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        GIGABAKE.bake(GIGABAKE.sample(cls.root / "sample"), cls.root / "out", 0.25, "--cell-voxels", 128)
        cls.scene = cls.root / "out" / "scene.xml"

    def render(self, name, *options, size=SIZE):
        path = self.root / name
        GIGABAKE.succeed("render", self.scene, "-o", path, "--size", f"{size[0]}x{size[1]}", *options)
        return path.read_bytes()

    def refuse(self, *options, scene=None, code=2, expect=""):
        path = self.root / "refused.png"
        result = GIGABAKE.run("render", scene or self.scene, "-o", path, *options)
        self.assertEqual(result.returncode, code, (options, result.stdout, result.stderr))
        self.assertIn(expect, result.stderr)
        self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
        self.assertFalse(path.exists())

    def test_the_default_picture_shows_the_whole_terrain_in_front_of_the_sky(self):
        self.render("default.png", "--background", "0,0,0,0")
        image = read_png(self.root / "default.png")
        self.assertEqual(image.shape, (SIZE[1], SIZE[0], 4))
        seen = image[..., 3] > 0
        self.assertTrue(0.25 < seen.mean() < 0.9, seen.mean())
        rows, columns = numpy.nonzero(seen)
        self.assertTrue(rows.min() > 0 and rows.max() < SIZE[1] - 1, (rows.min(), rows.max()))
        self.assertTrue(columns.min() > 0 and columns.max() < SIZE[0] - 1, (columns.min(), columns.max()))
        ground = image[seen & (image[..., 3] == 255)][:, :3]
        self.assertTrue(40 < ground.mean() < 200, ground.mean())
        self.assertGreater(ground.std(), 12)
        # No light passes through the ground: pixels well inside of the silhouette are opaque.
        inside = seen.copy()
        for _ in range(6):
            inside[1:-1, 1:-1] &= inside[:-2, 1:-1] & inside[2:, 1:-1] & inside[1:-1, :-2] & inside[1:-1, 2:]
        self.assertGreater(inside.sum(), 1000)
        self.assertGreater((image[inside][:, 3] == 255).mean(), 0.995)

    def test_equal_options_give_equal_files_for_any_threads_and_memory(self):
        expected = self.render("first.png")
        self.assertEqual(self.render("again.png"), expected)
        self.assertEqual(self.render("one.png", "--threads", 1), expected)
        self.assertEqual(self.render("two.png", "--threads", 2), expected)
        self.assertEqual(self.render("little.png", "--memory", "1M"), expected)

    def test_albedo_light_and_level_show(self):
        lit = self.render("lit.png", "--background", "9,9,9")
        self.assertNotEqual(self.render("albedo.png", "--background", "9,9,9", "--mode", "albedo"), lit)
        self.assertNotEqual(self.render("coarse.png", "--background", "9,9,9", "--pixel-error", 4), lit)
        coarse, fine = read_png(self.root / "coarse.png"), read_png(self.root / "lit.png")
        self.assertEqual(fine.shape[2], 3)
        self.assertLess(numpy.abs(coarse - fine).mean(), 12)  # the same terrain, less sharp

    def test_levels_are_blended_where_that_is_asked(self):
        far = ("--background", "9,9,9", "--eye", "150,-180,90", "--target", "0,0,0", "--pixel-error", 1.5)
        plain = self.render("plain.png", *far)
        self.assertEqual(self.render("off.png", *far, "--level-blend", "off"), plain)
        self.assertNotEqual(self.render("blended.png", *far, "--level-blend", "on"), plain)
        self.assertLess(numpy.abs(read_png(self.root / "blended.png") - read_png(self.root / "plain.png")).mean(), 4)

    def test_a_mesh_stands_among_the_voxels(self):
        # A red square of 20 m, 40 m above the middle of the scene, seen from above. glTF: y is up.
        square = [(-10, 40, -10), (10, 40, -10), (10, 40, 10), (-10, 40, 10)]
        harness.write_glb(self.root / "square.glb", square, [0, 1, 2, 0, 2, 3], [(255, 0, 0, 255)] * 4)
        above = ("--eye", "0,0,150", "--target", "0,0,0", "--mode", "albedo")
        self.render("alone.png", *above, size=(160, 90))
        self.render("among.png", *above, "--polygons", self.root / "square.glb", size=(160, 90))
        alone, among = read_png(self.root / "alone.png"), read_png(self.root / "among.png")
        self.assertEqual(among[45, 80, :3].tolist(), [255, 0, 0])
        differs = (among != alone).any(-1)
        expected = 90 / (2 * 110 * numpy.tan(numpy.radians(20))) * 20
        self.assertAlmostEqual(differs.any(0).sum(), expected, delta=2)
        self.assertAlmostEqual(differs.any(1).sum(), expected, delta=2)
        self.refuse("--polygons", self.root / "missing.glb", expect="missing.glb", code=1)

    def test_cells_do_not_show(self):
        out = self.root / "other"
        GIGABAKE.succeed("bake", self.root / "sample" / "tileset.json", "-o", out, "--voxel-size", 0.25,
                         "--cell-voxels", 512)
        camera = ("--eye", "40,-45,25", "--target", "0,0,0", "--size", "160x90", "--background", "0,0,0")
        GIGABAKE.succeed("render", out / "scene.xml", "-o", self.root / "large.png", *camera)
        GIGABAKE.succeed("render", self.scene, "-o", self.root / "small.png", *camera)
        self.assertEqual((self.root / "large.png").read_bytes(), (self.root / "small.png").read_bytes())

    def test_options_that_make_no_picture_are_named(self):
        self.refuse("--eye", "nan,0,0", expect="--eye")
        self.refuse("--eye", "1,2", expect="--eye")
        self.refuse("--eye", "1,2,3", "--target", "1,2,3", expect="--target")
        self.refuse("--eye", "0,0,9", "--target", "0,0,0", "--up", "0,0,1", expect="--up")
        self.refuse("--up", "0,0,0", expect="--up")
        self.refuse("--size", "0x9", expect="--size")
        self.refuse("--size", "99999x99999", expect="--size")
        self.refuse("--size", "wide", expect="--size")
        self.refuse("--fovy", "180", expect="--fovy")
        self.refuse("--fovy", "nan", expect="--fovy")
        self.refuse("--background", "blue", expect="--background")
        self.refuse("--background", "1,2,256", expect="--background")
        self.refuse("--threads", "-1", expect="--threads")
        self.refuse("--level-blend", "much", expect="--level-blend")

    def test_a_scene_that_is_not_there_is_named(self):
        self.refuse(scene=self.root / "missing.xml", code=1, expect="missing.xml")

    def test_a_cell_that_cannot_be_read_is_left_out_and_named_and_the_exit_code_says_so(self):
        broken = self.root / "broken"
        GIGABAKE.succeed("bake", self.root / "sample" / "tileset.json", "-o", broken, "--voxel-size", 1,
                         "--cell-voxels", 32)
        camera = ("--eye", "60,-70,50", "--target", "0,0,0", "--size", "120x80")
        whole = self.root / "whole.png"
        GIGABAKE.succeed("render", broken / "scene.xml", "-o", whole, *camera)
        # Cells contain levels that overviews duplicate.
        for kind, minimum, maximum in (("p*.h5", 1, 1), ("c_*.h5", .5, .999)):
            shard = max((broken / "shards").glob(kind), key=lambda path: path.stat().st_size)
            bytes_of_shard = shard.read_bytes()
            shard.write_bytes(bytes_of_shard[:5000])
            for damage in ("truncated", "missing"):
                picture = self.root / f"{damage}.png"
                result = GIGABAKE.run("render", broken / "scene.xml", "-o", picture, *camera)
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
                self.assertIn(shard.name, result.stderr)
                same = (read_png(picture) == read_png(whole)).all(axis=2).mean()
                self.assertTrue(minimum <= same <= maximum, (kind, same))
                shard.unlink(missing_ok=True)
            shard.write_bytes(bytes_of_shard)

    # Regression of 2026-11-26: the default camera moved when a shard was missing.
    def test_the_default_camera_is_the_same_without_a_shard(self):
        scene, size = self.root / "corners", ("--size", "120x80", "--background", "0,0,0,0")
        GIGABAKE.succeed("bake", self.root / "sample" / "tileset.json", "-o", scene, "--voxel-size", 1,
                         "--cell-voxels", 64, "--no-overviews")
        GIGABAKE.succeed("render", scene, "-o", self.root / "all.png", *size)
        whole = read_png(self.root / "all.png")
        for shard in sorted((scene / "shards").glob("c_*.h5")):
            with self.subTest(shard=shard.name):
                hidden = shard.rename(self.root / shard.name)
                result = GIGABAKE.run("render", scene, "-o", self.root / "part.png", *size)
                self.assertEqual(result.returncode, 3, result.stderr)
                hidden.rename(shard)
                part = read_png(self.root / "part.png")
                shown = part[..., 3] == 255
                # The gap is filled from coarser levels. No pixel was equal when the camera moved.
                self.assertGreater((part == whole).all(axis=2)[shown].mean(), .25)


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
