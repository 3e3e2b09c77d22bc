#!/usr/bin/env python3
"""Renders the cases of docs/voxels.md and tests what their images show.

Usage: voxel_cases_test.py GIGABAKE SOURCE_DIR
"""
import json
import subprocess
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import read_png
from tool_module import tool_module

MAGENTA = (255, 0, 255)


def inner(mask, pixels=3):
    """Returns the pixels of a mask that are at least `pixels` away from its edge."""
    for _ in range(pixels):
        shrunk = mask.copy()
        shrunk[1:] &= mask[:-1]
        shrunk[:-1] &= mask[1:]
        shrunk[:, 1:] &= mask[:, :-1]
        shrunk[:, :-1] &= mask[:, 1:]
        mask = shrunk
    return mask


class VoxelCases(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cases = cls.root / "cases"
        subprocess.run([sys.executable, SOURCE / "tools/voxel-cases", cls.cases, "--program", PROGRAM.executable],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def image(self, name):
        return read_png(self.cases / f"{name}.png")[..., :3].astype(int)

    def shown(self, name):
        return (self.image(name) != MAGENTA).any(axis=2)

    def test_ground_below_grass_is_opaque(self):
        # The same scene without its first primitive shows where the ground is.
        scene = json.loads((self.cases / "grass.gltf").read_text())
        del scene["meshes"][0]["primitives"][0]
        bare = self.root / "bare"
        bare.mkdir()
        (bare / "grass.gltf").write_text(json.dumps(scene))
        CASES.bake_and_render(PROGRAM.executable, bare / "grass.gltf")
        ground = inner((read_png(bare / "grass.png")[..., :3] != MAGENTA).any(axis=2), 10)
        self.assertGreater(ground.sum(), 8000)
        image = self.image("grass")
        magenta = numpy.minimum(image[..., 0], image[..., 2]) - image[..., 1]
        self.assertLess((magenta[ground] > 30).mean(), .001, numpy.sort(magenta[ground])[-20:])

    def test_light_does_not_depend_on_winding(self):
        both = inner(self.shown("smooth") & self.shown("inside_out"), 6)
        self.assertGreater(both.sum(), 15000)
        difference = abs(self.image("smooth") - self.image("inside_out")).max(axis=2)[both]
        self.assertLess(difference.mean(), 3)
        hill = inner(self.shown("winding"), 6)
        steps = abs(numpy.diff(self.image("winding")[..., 1], axis=1))[hill[:, 1:]]
        self.assertLess((steps > 40).mean(), .02)

    # Regression of 2026-11-27: dashes lit from the other side at the horizon of spheres, 37 and 82 pixels.
    def test_horizons_have_the_light_of_the_seen_side(self):
        both = self.shown("smooth") & self.shown("inside_out")
        difference = abs(self.image("smooth") - self.image("inside_out")).max(axis=2)[both]
        self.assertLess((difference > 40).sum(), 5)
        sphere = self.shown("smooth")
        steps = abs(numpy.diff(self.image("smooth")[..., 1], axis=1))[sphere[:, 1:] & sphere[:, :-1]]
        self.assertLess((steps > 40).sum(), 5)

    def test_vertex_normals_hide_facets(self):
        sphere = inner(self.shown("smooth"), 8)
        steps = abs(numpy.diff(self.image("smooth")[..., 1], axis=1))[sphere[:, 1:]]
        self.assertLess(steps.max(), 10)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    SOURCE = Path(sys.argv[2])
    CASES = tool_module(SOURCE, "voxel-cases")
    harness.main(argv=sys.argv[:1])
