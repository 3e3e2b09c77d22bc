#!/usr/bin/env python3
"""CesiumJS draws the voxel 3D Tiles that export writes.

Usage: cesium_test.py GIGABAKE SOURCE_DIR
CesiumJS is found in $GIGABAKE_CESIUM, the folder of the npm package (`npm install cesium` makes node_modules/cesium).
"""
import functools
import http.server
import os
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import numpy

import chromium
import harness
from png_file import read_png

CESIUM = os.environ.get("GIGABAKE_CESIUM", "")
EDGE = 256
PAGE = """<!DOCTYPE html><meta charset="utf-8">
<style>html, body, #scene { margin: 0; width: 100%; height: 100%; background: #00f; }</style>
<div id="scene"></div>
<script>window.CESIUM_BASE_URL = "/cesium/";</script>
<script src="/cesium/Cesium.js"></script>
<script>
async function show() {
  const widget = new Cesium.CesiumWidget("scene", { globe: false, skyBox: false, baseLayer: false, sun: false,
      skyAtmosphere: false, creditContainer: document.createElement("div"),
      contextOptions: { webgl: { preserveDrawingBuffer: true } } });
  const scene = widget.scene;
  scene.backgroundColor = new Cesium.Color(0, 0, 1, 1);
  scene.highDynamicRange = false;
  const provider = await Cesium.Cesium3DTilesVoxelProvider.fromUrl("/tiles/tileset.json");
  const customShader = new Cesium.CustomShader({ fragmentShaderText: `void fragmentMain(FragmentInput fsInput,
      inout czm_modelMaterial material) { vec4 color = fsInput.metadata.color; material.diffuse = color.rgb;
      material.alpha = color.a; }` });
  const voxels = scene.primitives.add(new Cesium.VoxelPrimitive({ provider, customShader }));
  voxels.nearestSampling = true;
  const frame = Cesium.Matrix4.fromTranslation(voxels.boundingSphere.center);
  window.look = () => scene.camera.lookAtTransform(frame,
      new Cesium.Cartesian3(0, -0.01, 1.6 * voxels.boundingSphere.radius));
  window.look();
  voxels.allTilesLoaded.addEventListener(() => { document.body.dataset.loaded = "yes"; });
  scene.renderError.addEventListener((s, error) => { document.body.dataset.error = String(error); });
}
show().catch((error) => { document.body.dataset.error = String(error); });
</script>"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def translate_path(self, path):
        if path.startswith("/cesium/"):
            return str(Path(CESIUM) / "Build/Cesium" / path.removeprefix("/cesium/").split("?")[0])
        return super().translate_path(path)


@unittest.skipUnless(chromium.find(), "no Chromium")
@unittest.skipUnless((Path(CESIUM) / "Build/Cesium/Cesium.js").is_file(),
                     "no CesiumJS: npm install cesium, then GIGABAKE_CESIUM=…/node_modules/cesium")
class CesiumTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def drawn(self):
        """What CesiumJS draws of /tiles from above, without alpha."""
        (self.path / "index.html").write_text(PAGE)
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0),
                                                 functools.partial(Quiet, directory=str(self.path)))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        page = chromium.Page(chromium.find(), f"http://127.0.0.1:{server.server_port}/", EDGE, EDGE, chromium.WEBGL)
        self.addCleanup(page.close)
        page.wait_for("document.body && (document.body.dataset.loaded || document.body.dataset.error)", 400)
        self.assertEqual(page.evaluate("document.body.dataset.error || ''"), "")
        (self.path / "page.png").write_bytes(page.screenshot())
        return read_png(self.path / "page.png")[..., :3].astype(int)

    def test_a_red_square_beside_a_green_one_is_drawn_where_it_lies(self):
        (self.path / "source").mkdir()
        for name, x, colour in (("red", -8, [1, 0, 0, 1]), ("green", 0, [0, 1, 0, 1])):
            corners = [[x, 0, 8], [x + 8, 0, 8], [x + 8, 0, -8], [x, 0, -8]]
            material = {"pbrMetallicRoughness": {"baseColorFactor": colour}}
            harness.write_glb(self.path / f"source/{name}.glb", corners, [0, 1, 2, 0, 2, 3], material=material)
        program = harness.Gigabake(sys.argv[1])
        program.bake(self.path / "source", self.path / "bake", 0.5, "--cell-voxels", 64)
        program.succeed("export", self.path / "bake/scene.xml", "--to", "3dtiles", "-o", self.path / "tiles")
        picture = self.drawn()
        red = (picture[..., 0] > 150) & (picture[..., 1] < 60)
        green = (picture[..., 1] > 150) & (picture[..., 0] < 60)
        self.assertGreater(red.sum(), 500)
        self.assertLess(abs(red.sum() / green.sum() - 1), 0.1)
        west, east = numpy.argwhere(red)[:, 1].mean(), numpy.argwhere(green)[:, 1].mean()
        self.assertLess(west + 20, east)
        self.assertLess(abs(numpy.argwhere(red)[:, 0].mean() - numpy.argwhere(green)[:, 0].mean()), 5)


if __name__ == "__main__":
    if not CESIUM or not chromium.find():
        print("skipped: no Chromium" if CESIUM else "skipped: GIGABAKE_CESIUM does not name the npm package cesium")
        sys.exit(77)
    harness.main(argv=sys.argv[:1], verbosity=2)
