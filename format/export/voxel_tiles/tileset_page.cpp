#include "format/export/voxel_tiles/tileset_page.h"

namespace gigabake {

/// The page. Tiles are gzip files. The browser unpacks them if the server sends Content-Encoding; otherwise the page's
/// script unpacks them. The shader divides interpolated colours by normal.a, which is 1 in existing voxels and 0
/// elsewhere before interpolation.
const char* const tileset_page = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>gigabake</title>
<style>
html, body, #scene { margin: 0; width: 100%; height: 100%; overflow: hidden; background: #89a; }
.cesium-widget, .cesium-widget canvas { display: block; width: 100%; height: 100%; }
#state { position: absolute; left: 8px; top: 8px; font: 13px sans-serif; color: #fff; }
</style>
</head>
<body>
<div id="scene"></div>
<div id="state">loading CesiumJS</div>
<script>
"use strict";
// ?cesium=/folder/ names another folder of this server that holds Cesium.js; ?error=4 is the size of a drawn voxel in
// pixels; ?nearest draws voxels as cubes.
const query = new URLSearchParams(location.search);
const own = query.has("cesium") ? new URL(query.get("cesium"), location.href) : null;
const cesium = own && own.origin === location.origin ? own.href
  : "https://cesium.com/downloads/cesiumjs/releases/1.145/Build/Cesium/";
window.CESIUM_BASE_URL = cesium;
const state = document.getElementById("state");

function unpackTiles() {
  const asStored = Cesium.Resource.prototype.fetchArrayBuffer;
  Cesium.Resource.prototype.fetchArrayBuffer = function (...args) {
    const request = asStored.apply(this, args);
    return request && request.then((buffer) => {
      const head = new Uint8Array(buffer, 0, Math.min(2, buffer.byteLength));
      if (head[0] !== 0x1f || head[1] !== 0x8b) return buffer;
      return new Response(new Blob([buffer]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
    });
  };
}

function nextFrame(scene) {
  return new Promise((resolve) => {
    const done = scene.postRender.addEventListener(() => { done(); resolve(); });
  });
}

async function show() {
  unpackTiles();
  const tileset = await (await fetch("tileset.json")).json();
  const provider = await Cesium.Cesium3DTilesVoxelProvider.fromUrl("tileset.json");
  const widget = new Cesium.CesiumWidget("scene", {
    globe: false, skyBox: false, baseLayer: false, skyAtmosphere: false,
    creditContainer: document.createElement("div"),
    contextOptions: { webgl: { preserveDrawingBuffer: true } } });
  const scene = widget.scene;
  scene.backgroundColor = Cesium.Color.fromCssColorString("#89a");
  scene.highDynamicRange = false;
  scene.renderError.addEventListener((_, error) => { state.textContent = String(error); });
  const customShader = new Cesium.CustomShader({ fragmentShaderText: `
    void fragmentMain(FragmentInput fsInput, inout czm_modelMaterial material) {
      float there = fsInput.metadata.normal.a;
      material.diffuse = fsInput.metadata.color.rgb / max(there, 0.001);
      material.alpha = fsInput.metadata.color.a;
    }` });
  const voxels = scene.primitives.add(new Cesium.VoxelPrimitive({ provider, customShader }));
  voxels.nearestSampling = query.has("nearest");
  voxels.screenSpaceError = Number(query.get("error") || 1);
  while (!voxels.ready) await nextFrame(scene);
  // The box that holds the scene; the oct-tree's cube is larger.
  const { lowest, highest } = tileset.metadata.properties;
  const centre = Cesium.Cartesian3.unpack(tileset.root.boundingVolume.box);
  const fromCentre = (p) => Cesium.Cartesian3.subtract(Cesium.Cartesian3.unpack(p), centre, new Cesium.Cartesian3());
  voxels.minClippingBounds = fromCentre(lowest);
  voxels.maxClippingBounds = fromCentre(highest);
  await nextFrame(scene);
  const sphere = voxels.boundingSphere;
  scene.camera.frustum.near = Math.max(0.1, sphere.radius / 5000);
  // The tileset's own east, north and up: a scene that is nowhere on the earth has no others.
  const axes = Cesium.Matrix4.getMatrix3(provider.globalTransform, new Cesium.Matrix3());
  const frame = Cesium.Matrix4.fromRotationTranslation(axes, sphere.center);
  const look = (heading, pitch, radii) =>
    scene.camera.lookAtTransform(frame, new Cesium.HeadingPitchRange(heading, pitch, radii * sphere.radius));
  look(0, -0.6, 2);
  state.textContent = "";
  window.shown = { scene, voxels, look };
}

const script = document.createElement("script");
script.src = new URL("Cesium.js", cesium).href;
script.onload = () => show().catch((error) => { state.textContent = String(error); });
script.onerror = () => { state.textContent = "cannot load " + script.src; };
document.head.append(script);
</script>
</body>
</html>
)html";

}  // namespace gigabake
