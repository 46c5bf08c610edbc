// The plugin for 3DTilesRendererJS in headless Chromium: along paths the pictures are those without it, of fewer tiles.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
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
    // Mesa: SwiftShader leaves out single pixels along edges of triangles that it clips, through which hidden tiles show.
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--force-device-scale-factor=1"],
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

// Goes along a path without waiting, but for every tenth camera, and says what that was like.
async function walk(context, name, path, options) {
  await open(name, options);
  const settled = [], moving = [];
  for (const [i, place] of cameras(path, 41).entries())
    if (i % 10 === 0) settled.push(await settle(place));
    else moving.push(await steps(1, place));
  await screenshot(`tiles_${name}.png`);
  const numbers = (pick) => moving.map(({ culled }) => pick(culled.stats));
  const both = (key) => `${key} ${mean(settled.map(({ all }) => all[key])).toFixed(0)} -> ${mean(settled.map(({ culled }) => culled[key])).toFixed(0)}`;
  const ms = numbers(({ drawMs, testMs }) => drawMs + testMs);
  context.diagnostic(
    `${name}: ${both("drawn")}, ${both("triangles")}, ${both("complete")}; loaded in all ${settled.at(-1).all.loaded} -> ${settled.at(-1).culled.loaded}; ` +
      `${median(ms).toFixed(2)} ms a frame, 95 %: ${percentile(ms, 0.95).toFixed(2)}; ${median(numbers(({ occluderTriangles }) => occluderTriangles))} triangles of occluders, ` +
      `${median(numbers(({ tested }) => tested))} tests in ${median(numbers(({ testMs }) => testMs)).toFixed(2)} ms; late ${moving.map(({ late }) => late)}`,
  );
  return { settled, moving };
}

// Two storeys of rooms behind walls, with pipes; a run along the aisle of the upper one.
const plant = {
  objects: [{ generator: "plant", options: { storeys: 2, bays: 4, pipes: 24, bends: 24, sides: 12, seed: 1 } }],
  cameras: { default: { eye: [1, 6.8, 7.2], target: [11, 6.8, 7.2], up: [0, 0, 1] } },
  paths: {
    run: {
      frames: 41,
      keys: [
        { eye: [1, 6.8, 7.2], target: [6, 6.8, 7.2], up: [0, 0, 1], near: 0.05, far: 200 },
        { eye: [16, 6.8, 7.2], target: [21, 6.8, 7.2], up: [0, 0, 1], near: 0.05, far: 200 },
      ],
    },
  },
};
const shipped = (name) => JSON.parse(fs.readFileSync(path.join(process.env.OCCLOD_ROOT, "meshes/scenes", `${name}.json`)));

// The largest share of tiles that may still be drawn; where there are meshes also an atrium and a church, of which everything is open.
for (const [name, along, most, ...options] of [
  ["city", "walk", 0.5],
  ["plant", "run", 0.7],
  ["sponza", "walk", 1, "--node-triangles", "250"],
  ["sibenik", "walk", 1, "--node-triangles", "250"],
])
  test(`along a path through ${name} tiles are fewer and pictures are the same`, async (context) => {
    const scene = name === "plant" ? plant : shipped(name);
    const { mesh } = scene.objects[0];
    if (mesh && !realMesh(mesh)) return context.skip(`OCCLOD_MESHES has no ${mesh}`);
    if (mesh) scene.objects[0].mesh = path.basename(mesh);
    fs.writeFileSync(path.join(folder, `${name}.json`), JSON.stringify(scene));
    run("tiles", `${name}.json`, "-o", path.join(folder, "tilesets", name), "--quantise", "14", ...options);
    const { settled, moving } = await walk(context, name, scene.paths[along]);
    assert.deepEqual(settled.map(({ different }) => different), settled.map(() => 0));
    assert.equal(settled.at(-1).all.failed + settled.at(-1).culled.failed, 0);
    const sum = (key, of) => settled.reduce((all, row) => all + row[of][key], 0);
    assert.ok(sum("drawn", "culled") <= most * sum("drawn", "all"), `${sum("drawn", "culled")} of ${sum("drawn", "all")} are drawn`);
    assert.ok(sum("complete", "culled") <= sum("complete", "all"), `${sum("complete", "culled")} of ${sum("complete", "all")} are waited for`);
    // A tile that others hid until they were refined may be late by a frame.
    const late = moving.map(({ late }) => late).filter(Boolean);
    assert.ok(late.length <= 4 && late.every((pixels) => pixels <= 50), String(late));
  });

test("the comparison notices a plugin that culls too much", async () => {
  await open("wall", { plugin: "too much" });
  assert.ok((await settle(before)).different > 0);
});

test("TypeScript's compiler accepts the example", () => {
  execFileSync("node_modules/.bin/tsc", ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--lib", "es2023,dom", "tiles_example.ts"], { stdio: "pipe", encoding: "utf8" });
  assert.deepEqual(complaints, []);
});
