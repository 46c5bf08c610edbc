// The plugin for 3DTilesRendererJS in headless Chromium: along paths the pictures are those without it, of fewer tiles.
import assert from "node:assert/strict";
import fs from "node:fs";
import http from "node:http";
import path from "node:path";
import test, { after, before as first } from "node:test";
import puppeteer from "puppeteer-core";

import { above, before, behind, writeTileset } from "./hand_made_tiles.js";
import { folder, median, realMesh, run } from "./native.js";

const held = new Map(); // names of files that are answered later, and what then happens
let server;
let browser;
let page;
const complaints = [];

function answer(request, response) {
  const { pathname } = new URL(request.url, "http://localhost");
  const file = pathname.startsWith("/modules/") ? path.join("node_modules", pathname.slice(9)) : pathname.startsWith("/tilesets/") ? path.join(folder, pathname) : path.join(".", pathname);
  if (!fs.existsSync(file)) return response.writeHead(404).end();
  const send = () => {
    const types = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".wasm": "application/wasm" };
    response.writeHead(200, { "Content-Type": types[path.extname(file)] ?? "application/octet-stream" });
    fs.createReadStream(file).pipe(response);
  };
  if (held.has(path.basename(file))) held.get(path.basename(file)).push(send);
  else send();
}

first(async () => {
  server = http.createServer(answer).listen(0, "127.0.0.1");
  await new Promise((done) => server.once("listening", done));
  browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--force-device-scale-factor=1"],
    protocolTimeout: 600000,
  });
  page = await browser.newPage();
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  await page.setViewport({ width: 640, height: 480 });
  await page.goto(`http://127.0.0.1:${server.address().port}/tiles.html`);
  await page.waitForFunction("window.tiles", { timeout: 60000 });
});

after(async () => {
  await browser?.close();
  server?.close();
});

const open = (name, options) => page.evaluate((url, options) => window.tiles.open(url, options), `/tilesets/${name}/tileset.json`, options);
const settle = (...places) => page.evaluate((places) => window.tiles.now.settle(...places), places);
const steps = (count, ...places) =>
  page.evaluate(async (count, places) => {
    let last;
    for (let i = 0; i < count; ++i) {
      last = window.tiles.now.step(...places);
      await new Promise((done) => setTimeout(done, 30));
    }
    return last;
  }, count, places);
const drawn = (name) => page.evaluate((uri) => window.tiles.now.isDrawn(uri), `${name}.glb`);
const screenshot = (name) => process.env.OCCLOD_PICTURES && page.screenshot({ path: path.join(process.env.OCCLOD_PICTURES, name) });

function handMade(name, wall) {
  writeTileset(path.join(folder, "tilesets", name), wall);
  return name;
}

test("what a wall hides is not drawn, however it refines, and the picture is the same", async () => {
  await open(handMade("wall"));
  const { different, all, culled } = await settle(before);
  await screenshot("tiles_wall.png");
  assert.equal(different, 0);
  for (const name of ["wall", "tower", "added", "added_seen", "around", "front"]) assert.deepEqual(await drawn(name), [true, true], name);
  for (const name of ["hidden", "external", "added_hidden"]) assert.deepEqual(await drawn(name), [true, false], name);
  assert.equal(all.drawn - culled.drawn, 3);
  // Seen from above nothing is hidden.
  assert.equal((await settle(above)).different, 0);
  for (const name of ["hidden", "external", "added_hidden"]) assert.deepEqual(await drawn(name), [true, true], name);
});

test("what a second camera sees is drawn", async () => {
  await open("wall", { cameras: 2 });
  assert.equal((await settle(before, behind)).different, 0);
  for (const name of ["hidden", "external", "added_hidden"]) assert.deepEqual(await drawn(name), [true, true], name);
});

test("sides and materials that are not drawn whole hide nothing", async () => {
  await open(handMade("quad", { open: true }));
  assert.equal((await settle(before)).different, 0);
  assert.deepEqual(await drawn("hidden"), [true, false]);
  assert.equal((await settle(behind)).different, 0); // sees the back of the quad, which is not drawn
  assert.deepEqual(await drawn("front"), [true, true]);
  for (const alphaMode of ["BLEND", "MASK"]) {
    await open(handMade(alphaMode, { alphaMode }));
    assert.equal((await settle(before)).different, 0);
    assert.deepEqual(await drawn("hidden"), [true, true], alphaMode);
  }
});

test("siblings replace their parent without waiting for a hidden tile", async () => {
  held.set("hidden.glb", []);
  await open("wall");
  await steps(60, before);
  assert.deepEqual(await drawn("parent"), [true, false]);
  assert.deepEqual(await drawn("tower"), [false, true]);
  const late = held.get("hidden.glb");
  held.clear();
  late.forEach((send) => send());
  assert.equal((await settle(before)).different, 0);
});

// Cameras between the keys of a path of a scene, `count` in all.
function cameras({ keys }, count) {
  const mix = (a, b, t) => a.map((value, k) => value + t * (b[k] - value));
  return Array.from({ length: count }, (_, i) => {
    const at = (i / (count - 1)) * (keys.length - 1);
    const [from, to] = [keys[Math.floor(at)], keys[Math.ceil(at)]];
    return { ...from, eye: mix(from.eye, to.eye, at % 1), target: mix(from.target, to.target, at % 1) };
  });
}

const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
const percentile = (values, share) => [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];

// Walks a path twice: first it waits for tiles at every tenth camera; then all have been loaded, it goes on from frame to
// frame, and what differs is late.
async function walk(context, name, path, options) {
  await open(name, options);
  const places = cameras(path, 61);
  const settled = [], moving = [], again = [];
  for (const [i, place] of places.entries())
    if (i % 10 === 0) settled.push(await settle(place));
    else moving.push(await steps(1, place));
  await screenshot(`tiles_${name}.png`);
  const { all, culled } = settled.at(-1);
  for (const place of places) await settle(place);
  for (const place of places) again.push(await steps(1, place));
  const ms = again.map(({ culled }) => culled.stats.drawMs + culled.stats.testMs);
  const both = (key) => `${key} ${mean(settled.map(({ all }) => all[key])).toFixed(0)} -> ${mean(settled.map(({ culled }) => culled[key])).toFixed(0)}`;
  const late = again.map(({ different }) => different).filter(Boolean);
  context.diagnostic(
    `${name}: ${both("drawn")}, ${both("triangles")}, loaded ${all.loaded} -> ${culled.loaded}; settled ${settled.map(({ different }) => different)} pixels differ; ` +
      `then ${late.length} of ${again.length} frames, by ${late} pixels; ${Math.max(...moving.map(({ holes }) => holes))} pixels of holes while loading; ` +
      `${median(ms).toFixed(2)} ms a frame, 95 %: ${percentile(ms, 0.95).toFixed(2)}; ${median(again.map(({ culled }) => culled.stats.occluderTriangles))} triangles, ` +
      `${median(again.map(({ culled }) => culled.stats.tested))} tests in ${median(again.map(({ culled }) => culled.stats.testMs)).toFixed(2)} ms`,
  );
  return { settled, moving, again };
}

// A city, rooms with pipes, and where there are meshes, an atrium and a church.
for (const [name, file, along] of [
  ["city", "meshes/scenes/city.json", "walk"],
  ["plant", "bench/scenes/plant_rooms.json", "run"],
  ["sponza", "meshes/scenes/sponza.json", "walk"],
  ["sibenik", "meshes/scenes/sibenik.json", "walk"],
])
  test(`along a path through ${name} tiles are fewer and pictures are the same`, async (context) => {
    const scene = path.join(process.env.OCCLOD_ROOT, file);
    const { paths, objects } = JSON.parse(fs.readFileSync(scene));
    if (objects[0].mesh && !realMesh(objects[0].mesh)) return context.skip(`OCCLOD_MESHES has no ${objects[0].mesh}`);
    run("tiles", scene, "-o", path.join(folder, "tilesets", name), "--quantise", "14");
    const { settled, moving, again } = await walk(context, name, paths[along]);
    const last = settled.at(-1);
    assert.deepEqual(settled.map(({ different }) => different), settled.map(() => 0));
    assert.equal(last.all.failed + last.culled.failed, 0);
    assert.ok(moving.every(({ holes }) => holes === 0) && again.every(({ holes }) => holes === 0), "holes");
  });
