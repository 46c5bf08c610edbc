// cesium.js URL --cameras FILE [--error PX] [--size WxH] [--png FILE] [--frame N]: CesiumJS in headless Chromium on the page of `occlod serve`,
// along a path. FILE: JSON, {"cameras": [{eye, target, up, fov_y_deg}]}, in the tileset's coordinates. Waits at each camera until all tiles are loaded,
// drawing nothing meanwhile, since software takes long for that, and then draws one frame. Where a camera has a `click`, a point, a mouse is clicked
// there, and `picked` is what the page names.
// Prints one JSON object; exit 1 when a tile failed or the page complained. The picture is of camera N, without the panel.
import { readFileSync } from "node:fs";
import { option, open } from "./browser.js";

const [width, height] = option("--size", "1024x768").split("x").map(Number);
const { browser, page, complaints } = await open(process.argv[2] + "?error=" + option("--error", "2"), width, height);
const cameras = JSON.parse(readFileSync(option("--cameras"), "utf8")).cameras;
await page.waitForFunction("window.occlod.tileset", { timeout: 300000 });
const rows = [];
let bytes = 0, contents = 0, images = 0;
page.on("response", async (response) => {
  bytes += Number(response.headers()["content-length"] ?? 0) * response.url().includes(".glb");
  contents += response.url().includes(".glb");
  images += /\/tileset\/.*\.(png|jpg)/.test(response.url());
});
for (const [index, camera] of cameras.entries()) {
  rows.push(await page.evaluate(async (at) => {
    const { viewer, tileset } = window.occlod;
    const local = tileset.root.computedTransform;
    const point = (p) => Cesium.Matrix4.multiplyByPoint(local, new Cesium.Cartesian3(...p), new Cesium.Cartesian3());
    const vector = (p) => Cesium.Matrix4.multiplyByPointAsVector(local, new Cesium.Cartesian3(...p), new Cesium.Cartesian3());
    const ahead = at.target.map((x, k) => x - at.eye[k]);
    const canvas = viewer.scene.canvas, aspect = canvas.clientWidth / canvas.clientHeight;
    const half = Math.tan((at.fov_y_deg * Math.PI) / 360);
    viewer.camera.frustum.fov = 2 * Math.atan(half * Math.max(aspect, 1));  // of the wider side
    viewer.camera.setView({ destination: point(at.eye), orientation: {
      direction: Cesium.Cartesian3.normalize(vector(ahead), new Cesium.Cartesian3()),
      up: Cesium.Cartesian3.normalize(vector(at.up), new Cesium.Cartesian3()) } });
    const begin = performance.now();
    viewer.useDefaultRenderLoop = false;
    viewer.scene.debugCommandFilter = () => false;
    const frame = () => new Promise((resolve) => { viewer.scene.render(); requestAnimationFrame(resolve); });
    for (let calm = 0; calm < 3; calm = tileset.tilesLoaded ? calm + 1 : 0) {
      await frame();
      if (performance.now() - begin > 300000) throw new Error("tiles are not loaded after five minutes");
    }
    viewer.scene.debugCommandFilter = undefined;
    await frame();
    const counts = tileset.statistics;
    const texels = (length) => length / 4;  // it counts no smaller sizes; images in KTX2 have them, and fewer bytes a texel
    const clicked = at.click && Cesium.SceneTransforms.worldToWindowCoordinates(viewer.scene, point(at.click));
    // Texels of tiles that are drawn, of those above them, of others that the client needs to refine those, and of those that it keeps from before.
    const held = { drawn: 0, above: 0, beside: 0, before: 0 }, selected = new Set(tileset._selectedTiles);
    const hold = (tile) => {
      const isAbove = tile.children.map(hold).includes(true);  // of all
      const kind = selected.has(tile) ? "drawn" : isAbove ? "above" : tile._touchedFrame === viewer.scene.frameState.frameNumber ? "beside" : "before";
      held[kind] += texels(tile.content?.texturesByteLength ?? 0);
      return isAbove || kind === "drawn";
    };
    hold(tileset.root);
    return { clicked, texels: held.drawn, held, resident_texels: texels(counts.texturesByteLength), resident_bytes: counts.texturesByteLength, triangles: counts.numberOfTrianglesSelected, tiles: counts.selected, ms: performance.now() - begin };
  }, camera));
  const row = rows.at(-1);
  if (row.clicked) {
    await page.evaluate("document.getElementById('panel').style.display = 'none'");
    await page.mouse.click(row.clicked.x, row.clicked.y);
    row.picked = await page.evaluate("window.occlod.picked");
  }
  if (index === Number(option("--frame", "0")) && option("--png", "")) {
    await page.evaluate("document.getElementById('panel').style.display = document.querySelector('.cesium-viewer-bottom').style.display = 'none'");
    await page.screenshot({ path: option("--png") });
  }
}
const failed = await page.evaluate("window.occlod.failed");
const loaded = await page.evaluate("window.occlod.tileset.tilesLoaded");
const mean = (key) => rows.reduce((sum, row) => sum + row[key], 0) / rows.length;
console.log(JSON.stringify({ client: "cesium", cameras: rows.length, triangles: mean("triangles"), tiles: mean("tiles"), texels: mean("texels"), resident_texels: mean("resident_texels"),
                             resident_bytes: mean("resident_bytes"), bytes, contents, images, failed, loaded, complaints, rows }));
await browser.close();
process.exit(failed > 0 || !loaded || complaints.length > 0 ? 1 : 0);
