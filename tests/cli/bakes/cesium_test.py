#!/usr/bin/env python3
"""CesiumJS draws the voxel 3D Tiles that export writes, by the page that export writes with them.

Usage: cesium_test.py GIGABAKE SOURCE_DIR
CesiumJS is found in $GIGABAKE_CESIUM, the folder of the npm package: export GIGABAKE_CESIUM=$(tools/fetch-cesium).
"""
import functools
import http.server
import json
import os
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import chromium
import harness
from png_file import read_png

CESIUM = os.environ.get("GIGABAKE_CESIUM", "")
EDGE = 192
BACKGROUND = (0x88, 0x99, 0xaa)


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A server that sends no Content-Encoding, like a server without support for compressed tiles."""

    def log_message(self, *_):
        pass

    def translate_path(self, path):
        if path.startswith("/cesium/"):
            return str(Path(CESIUM) / "Build/Cesium" / path.removeprefix("/cesium/").split("?")[0])
        return super().translate_path(path)


class Shown:
    """The page of an exported folder in a browser."""

    def __init__(self, test, folder, wishes=""):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(folder)))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        test.addCleanup(server.server_close)
        test.addCleanup(server.shutdown)
        url = f"http://127.0.0.1:{server.server_port}/index.html?cesium=/cesium/{wishes}"
        self.page = chromium.Page(chromium.find(), url, EDGE, EDGE, chromium.WEBGL)
        test.addCleanup(self.page.close)
        self.page.wait_for("!!window.shown", 400)
        self.page.evaluate("""(() => {
          const { scene, voxels } = window.shown;
          window.error = voxels.screenSpaceError;
          voxels.loadProgress.addEventListener(() => {});
          scene.postRender.addEventListener(() => {
            const { numberOfPendingRequests, numberOfTilesProcessing } = voxels.statistics;
            const busy = numberOfPendingRequests + numberOfTilesProcessing > 0 || scene.canvas.width !== window.edge;
            window.quiet = busy ? 0 : window.quiet + 1;
          });
          scene.maximumRenderTimeChange = Infinity;
        })(); 0""")
        self.draw(False)

    def draw(self, is_drawing):
        """Starts or stops the rendering of this page: without a GPU, one page uses all cores."""
        self.page.evaluate(f"window.shown.scene.requestRenderMode = {'false' if is_drawing else 'true'}; 0")

    def wait_for_tiles(self, edge, frames):
        """Waits until `frames` images of this edge length arrived without another tile.

        The screen-space error is scaled with the edge, so that each edge length needs the same tiles.
        """
        self.page.command("Emulation.setDeviceMetricsOverride", width=edge, height=edge, deviceScaleFactor=1,
                          mobile=False)
        self.page.evaluate(f"""(() => {{
          window.edge = {edge};
          window.quiet = 0;
          window.shown.voxels.screenSpaceError = window.error * {edge / EDGE};
        }})(); 0""")
        self.page.wait_for(f"window.quiet > {frames}", 400)

    def from_distance(self, radii, heading=0.3, pitch=-0.7):
        """Returns the image from `radii` scene radii away after all tiles are loaded, and the number of tiles."""
        self.page.evaluate(f"window.shown.look({heading}, {pitch}, {radii}); 0")
        self.draw(True)
        # A large image takes a second, and the tiles arrive over dozens of images: load them with small images first.
        self.wait_for_tiles(EDGE // 8, 12)
        self.wait_for_tiles(EDGE, 3)
        time.sleep(0.5)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "page.png").write_bytes(self.page.screenshot())
            picture = read_png(Path(folder) / "page.png")[..., :3].astype(int)
        self.draw(False)
        return picture, self.page.evaluate("window.shown.voxels.statistics.numberOfTilesWithContentReady")


@unittest.skipUnless(chromium.find(), "no Chromium")
@unittest.skipUnless((Path(CESIUM) / "Build/Cesium/Cesium.js").is_file(),
                     "no CesiumJS: export GIGABAKE_CESIUM=$(tools/fetch-cesium)")
class CesiumTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)
        self.program = harness.Gigabake(sys.argv[1])

    def export(self, bake, name, *wishes):
        self.program.succeed("export", bake, "--to", "3dtiles", *wishes, "-o", self.path / name)
        return self.path / name

    def write_squares(self, *squares):
        """Writes two adjacent squares, by name and colour."""
        (self.path / "source").mkdir()
        for x, (name, colour) in zip((-8, 0), squares):
            corners = [[x, 0, 8], [x + 8, 0, 8], [x + 8, 0, -8], [x, 0, -8]]
            material = {"pbrMetallicRoughness": {"baseColorFactor": colour}}
            harness.write_glb(self.path / f"source/{name}.glb", corners, [0, 1, 2, 0, 2, 3], material=material)

    def test_a_red_square_beside_a_green_one_is_drawn_where_it_lies(self):
        self.write_squares(("red", [1, 0, 0, 1]), ("green", [0, 1, 0, 1]))
        self.program.bake(self.path / "source", self.path / "bake", 0.5, "--cell-voxels", 64)
        shown = Shown(self, self.export(self.path / "bake", "tiles"), "&nearest")
        self.expect_red_beside_green(shown)

    def test_classes_are_drawn_by_a_shader(self):
        self.write_squares(("west", [0, 0, 1, 1]), ("east", [0, 0, 1, 1]))
        sources = [{"path": "west.glb", "class": 7}, {"path": "east.glb", "class": 300}]
        (self.path / "source/scene.json").write_text(json.dumps({"gigabake": 1, "sources": sources}))
        self.program.bake(self.path / "source/scene.json", self.path / "bake", 0.5, "--cell-voxels", 64)
        shown = Shown(self, self.export(self.path / "bake", "tiles"), "&nearest")
        shown.page.evaluate("""window.shown.voxels.customShader = new Cesium.CustomShader({fragmentShaderText: `
          void fragmentMain(FragmentInput fsInput, inout czm_modelMaterial material) {
            int voxelClass = int(fsInput.metadata.voxel_class + 0.5);
            material.diffuse = vec3(voxelClass == 7, voxelClass == 300, 0);
            material.alpha = fsInput.metadata.color.a;
          }`}); 0""")
        self.expect_red_beside_green(shown)

    def expect_red_beside_green(self, shown):
        picture, _ = shown.from_distance(2, 0, -1.57)
        red = (picture[..., 0] > 150) & (picture[..., 1] < 60)
        green = (picture[..., 1] > 150) & (picture[..., 0] < 60)
        self.assertGreater(red.sum(), 500)
        self.assertLess(abs(red.sum() / green.sum() - 1), 0.1)
        west, east = numpy.argwhere(red)[:, 1].mean(), numpy.argwhere(green)[:, 1].mean()
        self.assertLess(west + 20, east)
        self.assertLess(abs(numpy.argwhere(red)[:, 0].mean() - numpy.argwhere(green)[:, 0].mean()), 5)

    def test_a_thousand_cells_are_drawn_from_far_to_near_without_steps_at_tile_borders(self):
        """Tiles of 32³ and of 126³ voxels, whose borders differ, give the same images."""
        self.program.succeed("sample", self.path / "village", "--size", "128")
        bake = self.path / "bake"
        info = self.program.bake(self.path / "village/tileset.json", bake, 0.5, "--cell-voxels", 8)
        self.assertGreaterEqual(info["cells"], 1000)
        # At most one voxel per pixel, so that both exports draw their finest level.
        small = Shown(self, self.export(bake, "small", "--tile-voxels", "32"), "&error=0.05")
        large = Shown(self, self.export(bake, "large", "--tile-voxels", "126"), "&error=0.05")
        pixels = []
        for radii in (8, 2.5, 0.8):
            first, tiles = small.from_distance(radii)
            second, _ = large.from_distance(radii)
            there = (second != BACKGROUND).any(-1)
            pixels.append(there.sum())
            difference = numpy.abs(first - second).max(-1)
            print(f"{radii} radii: {there.sum()} pixels, {tiles} tiles; {(difference > 1).sum()} differ by more than "
                  f"one code, at most {difference.max()}")
            # A tile border without padding would be a line of steps. A ray through a voxel corner may round either way.
            self.assertLessEqual((difference > 1).sum(), there.sum() / 1000)
            self.assertLessEqual(difference.max(), 3)
        coarse = Shown(self, self.path / "small", "&error=8")
        tiles = [coarse.from_distance(radii)[1] for radii in (8, 2.5, 0.8)]
        print(f"tiles with an error of 8 pixels: {tiles}")
        self.assertLess(tiles[0], tiles[1])
        self.assertLess(tiles[1], tiles[2])
        self.assertGreater(pixels[0], 50)
        self.assertGreater(pixels[1], 4 * pixels[0])
        self.assertGreater(pixels[2], pixels[1])


if __name__ == "__main__":
    if not CESIUM or not chromium.find():
        print("skipped:", "no Chromium" if CESIUM else "no CesiumJS (tools/fetch-cesium installs it with npm)")
        sys.exit(77)
    harness.main(argv=sys.argv[:1], verbosity=2)
