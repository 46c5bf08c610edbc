#include "tiles_page.h"

#include <string_view>

namespace occlod::tool {
namespace {

// @CESIUM@ is replaced. Tests use window.occlod.
constexpr std::string_view page = R"html(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>occlod: 3D Tiles</title>
<link rel="icon" href="data:,">
<style>
  html, body, #view { margin: 0; height: 100%; overflow: hidden; background: #20242a; font: 14px/1.4 system-ui, sans-serif }
  #panel { position: absolute; top: 8px; left: 8px; padding: 8px 12px; border-radius: 6px; background: #000a; color: #eee }
  #panel label { display: block }
  #panel input[type=range] { width: 12em; vertical-align: middle }
  #told { white-space: pre; font-variant-numeric: tabular-nums }
</style>
</head>
<body>
<div id="view"></div>
<div id="panel">
  <label>error, pixels <input id="error" type="range" min="-1" max="5" step="0.25"> <span id="pixels"></span></label>
  <label><input id="wires" type="checkbox"> wireframe</label>
  <label><input id="boxes" type="checkbox"> boxes</label>
  <div id="told">loading CesiumJS</div>
</div>
<script>
"use strict";
const cesium = "@CESIUM@";
const told = document.getElementById("told");
window.CESIUM_BASE_URL = cesium;
window.occlod = { failed: 0 };

const script = document.createElement("script");
script.src = cesium + "Cesium.js";
script.onerror = () => {
  told.textContent = "CesiumJS cannot be loaded from\n" + cesium +
    "\nWithout internet: occlod serve --cesium FOLDER,\nthe folder Build/Cesium of the package cesium.";
};
script.onload = () => show().catch((error) => { told.textContent = String(error); });
document.head.append(script);
const style = document.createElement("link");
style.rel = "stylesheet";
style.href = cesium + "Widgets/widgets.css";
document.head.append(style);

async function show() {
  Cesium.RequestScheduler.requestsByServer[location.hostname + ":" + (location.port || 80)] = 18;
  const viewer = new Cesium.Viewer("view", {
    animation: false, baseLayer: false, baseLayerPicker: false, fullscreenButton: false, geocoder: false, homeButton: false,
    infoBox: false, navigationHelpButton: false, sceneModePicker: false, selectionIndicator: false, timeline: false,
  });
  const scene = viewer.scene;
  const tileset = await Cesium.Cesium3DTileset.fromUrl("tileset/tileset.json", {
    maximumScreenSpaceError: Number(new URLSearchParams(location.search).get("error")) || 2,
    dynamicScreenSpaceError: false,
    enableDebugWireframe: true,
  });
  tileset.tileFailed.addEventListener((failure) => {
    window.occlod.failed += 1;
    console.error("tile failed: " + failure.url + ": " + failure.message);
  });
  // What is nowhere on Earth is shown where the equator meets the prime meridian, without the globe.
  const onEarth = Cesium.Cartesian3.magnitude(tileset.boundingSphere.center) > 6e6;
  if (!onEarth)
    tileset.modelMatrix = Cesium.Transforms.eastNorthUpToFixedFrame(new Cesium.Cartesian3(6378137, 0, 0));
  scene.globe.show = onEarth;
  scene.globe.baseColor = Cesium.Color.fromCssColorString("#3a4048");
  scene.backgroundColor = Cesium.Color.fromCssColorString("#dfe6ee");
  for (const part of ["skyBox", "sun", "moon", "skyAtmosphere"]) if (!onEarth && scene[part]) scene[part].show = false;
  scene.screenSpaceCameraController.enableCollisionDetection = onEarth;
  // The light is over the left shoulder.
  const light = scene.light = new Cesium.DirectionalLight({ direction: new Cesium.Cartesian3(1, 0, 0), intensity: 1.4 });
  scene.preRender.addEventListener(() => {
    const camera = scene.camera, direction = new Cesium.Cartesian3();
    Cesium.Cartesian3.multiplyByScalar(camera.rightWC, 0.4, direction);
    Cesium.Cartesian3.add(direction, camera.directionWC, direction);
    Cesium.Cartesian3.add(direction, Cesium.Cartesian3.multiplyByScalar(camera.upWC, -0.5, new Cesium.Cartesian3()), direction);
    light.direction = Cesium.Cartesian3.normalize(direction, direction);
  });
  scene.primitives.add(tileset);
  Object.assign(window.occlod, { viewer, tileset });
  controls(viewer, tileset);
  picks(viewer, tileset);
  await viewer.zoomTo(tileset);
}

// A click names the part of the input that is there, and shows all of it.
function picks(viewer, tileset) {
  new Cesium.ScreenSpaceEventHandler(viewer.scene.canvas).setInputAction(({ position }) => {
    const picked = viewer.scene.pick(position);
    const has = picked instanceof Cesium.Cesium3DTileFeature && picked.hasProperty("name");
    window.occlod.picked = has ? picked.getProperty("name") : undefined;
    tileset.style = has ? new Cesium.Cesium3DTileStyle({
      color: { conditions: [["${id} === " + picked.getProperty("id"), "color('#ffc040')"], ["true", "color('white')"]] },
    }) : undefined;
  }, Cesium.ScreenSpaceEventType.LEFT_CLICK);
}

function controls(viewer, tileset) {
  const error = document.getElementById("error"), pixels = document.getElementById("pixels");
  error.value = Math.log2(tileset.maximumScreenSpaceError);
  const set = () => {
    tileset.maximumScreenSpaceError = 2 ** Number(error.value);
    pixels.textContent = tileset.maximumScreenSpaceError.toFixed(1);
  };
  error.oninput = set;
  set();
  for (const [id, property] of [["wires", "debugWireframe"], ["boxes", "debugShowBoundingVolume"]])
    document.getElementById(id).onchange = (event) => { tileset[property] = event.target.checked; };
  viewer.scene.postRender.addEventListener(() => {
    const counts = tileset.statistics;
    told.textContent = counts.numberOfTrianglesSelected.toLocaleString("en") + " triangles\n" +
      counts.selected + " tiles, " + (counts.numberOfPendingRequests + counts.numberOfTilesProcessing) + " loading" +
      (window.occlod.failed ? "\n" + window.occlod.failed + " failed" : "") +
      (window.occlod.picked === undefined ? "" : "\n" + window.occlod.picked);
  });
}
</script>
</body>
</html>
)html";

}  // namespace

std::string tiles_page(const std::string& cesium) {
  constexpr std::string_view mark = "@CESIUM@";
  std::string html(page);
  return html.replace(html.find(mark), mark.size(), cesium);
}

}  // namespace occlod::tool
