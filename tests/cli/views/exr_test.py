#!/usr/bin/env python3
"""render -o P.exr and --depth: the light that the PNG shows, and distances as the geometry has them.

Usage: exr_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from exr_file import read_exr
from png_file import read_png
from programs import lines_of

SIZE = (150, 100)
VOXEL_M = 0.25


def srgb_codes(linear):
    """Returns sRGB codes from 0 to 255, not rounded (IEC 61966-2-1)."""
    linear = numpy.clip(linear, 0, 1)
    return 255 * numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def linear_light(code):
    """Returns the linear light of an sRGB code."""
    part = code / 255
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


def bent(light):
    over = numpy.maximum(light - 0.6, 0)
    return numpy.where(light <= 0.6, light, 0.6 + 0.4 * over / (over + 0.4))


class Exr(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        GIGABAKE.bake(GIGABAKE.sample(cls.root / "sample", size=64, tiles=1), cls.root / "out", VOXEL_M)
        cls.scene = cls.root / "out" / "scene.xml"

    def render(self, name, *options, scene=None):
        path = self.root / name
        GIGABAKE.succeed("render", scene or self.scene, "-o", path, "--size", f"{SIZE[0]}x{SIZE[1]}", *options)
        return path

    def test_its_light_is_what_the_png_shows(self):
        opaque = read_exr(self.render("alone.exr", "--background", "0,0,0,0"))["A"] == 1
        for colour in ((), (20, 180, 250, 77)):
            background = ("--background", ",".join(map(str, colour)) or "sky")
            image = read_exr(self.render("p.exr", *background))
            shown = read_png(self.render("p.png", *background))
            self.assertEqual(sorted(image), ["A", "B", "G", "R", "Z"])
            self.assertEqual({name: image[name].dtype.itemsize for name in "RGBAZ"},
                             {"R": 2, "G": 2, "B": 2, "A": 2, "Z": 4})
            alpha = image["A"].astype(float)
            for k, name in enumerate("RGB"):
                difference = numpy.abs(srgb_codes(self.shown(image[name], alpha, colour, k)) - shown[..., k])
                self.assertLess(difference[opaque].max(), 0.7, name)  # rounding, and the 11 bits of a half
                self.assertLess(difference.max(), 0.7 if colour else 1.2, name)  # a sky is dithered
            if colour:
                self.assertLess(numpy.abs(255 * alpha - shown[..., 3]).max(), 0.6)

    def shown(self, light, alpha, colour, channel):
        """Returns the displayed colour for straight alpha (docs/viewer.md).

        Values above 0.6 are compressed, except for the background colour.
        """
        light = light.astype(float)
        if not colour:
            return bent(light)
        behind_alpha = colour[3] / 255
        through = (1 - alpha) / (1 - behind_alpha)
        behind = through * behind_alpha * linear_light(colour[channel])
        surface = numpy.maximum(1 - through, 1e-9)
        return (surface * bent((light - behind) / surface) + behind) / alpha

    def test_equal_pictures_are_equal_files(self):
        expected = self.render("first.exr").read_bytes()
        for options in (), ("--threads", 1), ("--memory", "1M"):
            self.assertEqual(self.render("again.exr", *options).read_bytes(), expected)

    def test_depth_alone_stands_beside_a_picture(self):
        both = read_exr(self.render("both.exr"))
        self.render("beside.png", "--depth", self.root / "depth.exr")
        depth = read_exr(self.root / "depth.exr")
        self.assertEqual(list(depth), ["Z"])
        self.assertTrue((depth["Z"] == both["Z"]).all())
        self.assertTrue(numpy.isinf(depth["Z"]).any() and numpy.isfinite(depth["Z"]).any())
        self.assertEqual((self.root / "beside.png").read_bytes(), self.render("alone.png").read_bytes())

    def test_distances_to_a_plane_are_right_within_half_a_voxel(self):
        # The plane is 1/250 voxel below the upper face of its voxels, at the depth of half the transmittance.
        height, edge = 1.249, 20
        corners = [(x, height, z) for x in (-edge, edge) for z in (-edge, edge)]
        harness.write_glb(self.root / "plane.glb", corners, [0, 1, 2, 2, 1, 3], [(90, 90, 90, 255)] * 4)
        GIGABAKE.bake(self.root / "plane.glb", self.root / "plane", VOXEL_M, "--local")
        eye = numpy.array([0.1, 0.2, 17.3])
        self.render("plane.png", f"--eye={','.join(map(str, eye))}", "--target=0.1,0.2,0", "--fovy", 60,
                    "--depth", self.root / "plane.exr", scene=self.root / "plane" / "scene.xml")
        z = read_exr(self.root / "plane.exr")["Z"]
        scale = numpy.tan(numpy.radians(30)) * 2 / SIZE[1]
        right = (numpy.arange(SIZE[0]) + 0.5 - SIZE[0] / 2) * scale
        up = (SIZE[1] / 2 - numpy.arange(SIZE[1]) - 0.5) * scale
        stretch = numpy.sqrt(1 + right[None, :] ** 2 + up[:, None] ** 2)
        down = z / stretch - (eye[2] - height)
        self.assertLess(numpy.abs(down).max(), VOXEL_M / 2 + 1e-3, (down.min(), down.max()))

    def test_a_path_has_a_file_of_each_kind_for_each_frame(self):
        path = self.root / "path.json"
        path.write_text(json.dumps({"keyframes": [
            {"time_s": 0, "eye": [30, -35, 20], "target": [0, 0, 0]},
            {"time_s": 1, "eye": [35, 5, 15], "target": [0, 0, 0]}]}))
        frames = self.root / "frames"
        frames.mkdir()
        self.render("frames/%02d.exr", "--path", path, "--frames", 2, "--depth", frames / "z%02d.exr")
        self.assertEqual(sorted(p.name for p in frames.iterdir()), ["00.exr", "01.exr", "z00.exr", "z01.exr"])
        single = self.render("one.exr", "--eye=30,-35,20", "--target=0,0,0")
        self.assertEqual((frames / "00.exr").read_bytes(), single.read_bytes())
        self.assertTrue((read_exr(frames / "z01.exr")["Z"] == read_exr(frames / "01.exr")["Z"]).all())

    def test_what_is_wrong_is_named_and_nothing_is_left_behind(self):
        refused = self.root / "refused"
        refused.mkdir()
        path = self.root / "path.json"
        for code, expect, options in (
                (2, "--depth: expected a name that ends in .exr", ("-o", refused / "p.png",
                                                                   "--depth", refused / "d.png")),
                (2, "--depth: expected another file", ("-o", refused / "p.exr", "--depth", refused / "p.exr")),
                (2, "--depth: expected a name with one %d", ("-o", refused / "%d.png", "--depth", refused / "d.exr",
                                                             "--path", path, "--frames", 1)),
                (1, "missing", ("-o", refused / "missing" / "p.exr"))):
            result = GIGABAKE.run("render", self.scene, *options)
            self.assertEqual(result.returncode, code, result)
            self.assertIn(expect, result.stderr)
            self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
            self.assertEqual(list(refused.iterdir()), [])


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
