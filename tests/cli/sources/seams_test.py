#!/usr/bin/env python3
"""A scene of one cell and the same scene of 4 × 4 cells give the same images, with any amount of memory.

Usage: seams_test.py GIGABAKE SOURCE_DIR
"""
import itertools
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import read_png

# Camera and pixel error. They select levels that cells of both sizes have (decision 10).
VIEWS = {
    "near": (("--eye=10,-15,25", "--target=0,0,5"), 1),
    "near and coarse": (("--eye=10,-15,25", "--target=0,0,5"), 4),
    "near and coarser": (("--eye=10,-15,25", "--target=0,0,5"), 16),
    "far": (("--eye=100,-110,70", "--target=0,0,0"), 1),
    "far and coarse": (("--eye=100,-110,70", "--target=0,0,0"), 4),
}


def covered(picture):
    """Returns the fraction of pixels that show the scene; an image without alpha is fully covered."""
    return (picture[..., 3] > 0).mean() if picture.shape[2] == 4 else 1


class Seams(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        source = GIGABAKE.sample(cls.root / "sample")
        cls.scenes = {}
        for name, cell_voxels in (("one", 512), ("sixteen", 128)):
            GIGABAKE.bake(source, cls.root / name, 0.25, "--cell-voxels", cell_voxels, "--lattice-origin=-64,-64,0")
            cls.scenes[name] = cls.root / name / "scene.xml"

    def render(self, scene, *options, size="320x180"):
        picture = self.root / "p.png"
        GIGABAKE.succeed("render", self.scenes[scene], "-o", picture, "--size", size, "--background", "0,0,0,0",
                         *options)
        return picture

    def test_one_cell_and_sixteen_are_what_was_baked(self):
        cells = {name: GIGABAKE.info(scene)["cells"] for name, scene in self.scenes.items()}
        self.assertEqual(cells, {"one": 1, "sixteen": 16})

    def test_every_level_that_both_have_holds_the_same_voxels(self):
        one, sixteen = (harness.lod_hashes(GIGABAKE.info(self.scenes[name]), 5) for name in ("one", "sixteen"))
        self.assertEqual(len(sixteen), 5)
        self.assertEqual(one, sixteen)

    def test_no_seam_is_seen_between_cells_in_any_mode_from_near_and_far(self):
        for name, (camera, pixel_error) in VIEWS.items():
            for mode in ("lit", "normal", "coverage", "lod", "albedo"):
                options = (*camera, "--pixel-error", pixel_error, "--mode", mode)
                one = read_png(self.render("one", *options))
                sixteen = read_png(self.render("sixteen", *options))
                self.assertEqual(one.shape, sixteen.shape)
                # Two empty images are equal too: more than an eighth of each must show the scene in several colours.
                for picture in (one, sixteen):
                    self.assertGreater(covered(picture), 1 / 8, f"{name}, {mode}")
                    self.assertGreater(picture.std(), 5, f"{name}, {mode}")
                self.assertLessEqual(numpy.abs(one - sixteen).max(), 2, f"{name}, {mode}")

    def test_the_memory_does_not_show_and_too_little_is_refused_in_one_line(self):
        for scene in self.scenes:
            # Regression: with fewer nodes than one ray uses at a time, the smaller image was never completed.
            for (camera, pixel_error), size in itertools.product((VIEWS["near"], VIEWS["far and coarse"]),
                                                                 ("160x90", "80x45")):
                options = (*camera, "--pixel-error", pixel_error)
                expected = self.render(scene, *options, size=size).read_bytes()
                for memory in ("300K", "1M", "3M", "20M", "0"):
                    picture = self.render(scene, *options, "--memory", memory, size=size)
                    self.assertEqual(picture.read_bytes(), expected, f"{scene}, {memory}, {size}")
            for memory in ("1", "1000", "20K"):
                result = GIGABAKE.run("render", self.scenes[scene], "-o", self.root / "refused.png", "--memory", memory)
                self.assertEqual(result.returncode, 2, result)
                self.assertRegex(result.stderr, r"^gigabake: --memory: the roots of \d+ trees? need at least \d+K\n$")
                self.assertFalse((self.root / "refused.png").exists())


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
