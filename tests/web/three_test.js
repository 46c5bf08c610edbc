// @occlod/three in headless Chromium, over a simulated link of 20 MB/s and 50 ms. OCCLOD_OHLOD: a file of a planet to measure
// in place of the one that is built here, such as one of ten million triangles.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import test, { after, before } from "node:test";
import zlib from "node:zlib";
import puppeteer from "puppeteer-core";

import { folder, fronts, run } from "./native.js";
import { serve } from "./range_server.js";
import { glb, largePngs, pngs } from "./textured_model.js";

const here = process.cwd();
const pictures = process.env.OCCLOD_PICTURES ?? folder;
const [width, height] = [800, 600];
const planet = path.join(folder, "planet.ply");
const ohlod = process.env.OCCLOD_OHLOD ? path.resolve(process.env.OCCLOD_OHLOD) : path.join(folder, "planet.ohlod");
const link = { bytesPerSecond: 20e6, latencyMs: 50 };
const memory = 256 * 2 ** 20;
let server;
let browser;
let page;
const complaints = [];

before(async () => {
  run("generate", "rough-planet", "level=8", "-o", planet);
  if (!process.env.OCCLOD_OHLOD) run("hlod", "build", planet, "-o", ohlod);
  // The packages come over the link, too; three.js and the page do not.
  const packages = path.join(here, "node_modules");
  server = await serve({ folders: { modules: packages, page: here }, slow: { data: path.dirname(ohlod), packages }, ...link });
  browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--force-device-scale-factor=1"],
    protocolTimeout: 1200000,
  });
});

after(async () => {
  await browser?.close();
  server?.close();
});

async function openPage() {
  await page?.close();
  page = await browser.newPage();
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => message.type() === "error" && !message.text().includes("Failed to load resource") && complaints.push(message.text()));
  await page.setViewport({ width, height });
  await page.goto(`${server.url}/page/three_page.html`);
  await page.waitForFunction(() => window.page);
}

const outside = (angle, distance) => ({ eye: [distance * Math.sin(angle), 0.4, distance * Math.cos(angle)], target: [0, 0, 0] });
const inside = (angle) => ({ eye: [0.5 * Math.sin(angle), 0, 0.5 * Math.cos(angle)], target: [0.2, 1, 0.4], fovY: 70 });
const openFile = (file, options, at) => page.evaluate((...given) => window.page.open(...given), `${server.url}/data/${path.basename(file)}`, { memory, ...options }, at);
const open = (options, at) => openFile(ohlod, options, at);
const look = (at) => page.evaluate((at) => window.page.look(at), at);
const fly = (cameras, options) => page.evaluate((...given) => window.page.fly(...given), cameras, options);
const faultless = () => (server.link.fault = () => undefined);

test("the first picture is there at once, and the fine one follows", async (context) => {
  await openPage();
  await open({ occlusion: false }, outside(0, 2.6));
  const ms = await page.evaluate(() => window.page.first());
  const early = await page.evaluate(() => window.page.stats());
  await page.screenshot({ path: path.join(pictures, "three_first.png") });
  const begin = Date.now();
  const at = { ...outside(0, 2.6), width, height };
  const seen = await look(at);
  await page.screenshot({ path: path.join(pictures, "three_fine.png") });
  context.diagnostic(`first picture ${ms.toFixed(0)} ms, ${early.bytesLoaded} bytes; ${seen.stats.triangles} triangles at 1 px after ${Date.now() - begin} ms more, ${seen.stats.bytesLoaded} bytes`);
  assert.ok(ms < 3000, `${ms} ms`); // less than 1,000 on a machine that does nothing else
  assert.ok(seen.stats.largestErrorPx <= 1 && seen.stats.missing === 0);
  assert.equal(seen.drawn, seen.stats.triangles);
  assert.equal(seen.holes, 0);
});

test("no pixel lacks surface where native's picture has it, along a path outside and inside", async () => {
  await openPage();
  await open({ occlusion: true, tolerancePx: 2 }, outside(0, 2.6));
  for (let i = 0; i < 12; ++i) {
    const seen = await look(outside(0.5 * i, 2.6 - 0.1 * i));
    assert.equal(seen.holes, 0, `frame ${i}`);
    assert.ok(seen.empty < 0.9 * seen.pixels);
  }
  for (let i = 0; i < 6; ++i) assert.equal((await look(inside(i))).empty, 0, `inside, frame ${i}`);
  // The count is one of cracks: a node that is left out is found, from both sides.
  assert.ok((await page.evaluate(() => window.page.hideEach())).empty > 0);
  await look(outside(0, 2));
  assert.ok((await page.evaluate(() => window.page.hideEach())).holes > 0);
});

test("while the camera moves and nodes come, no picture has a hole", async () => {
  await openPage();
  await open({ tolerancePx: 2 }, outside(0, 2.6));
  await page.evaluate(() => window.page.first());
  const near = await fly(Array.from({ length: 60 }, (_, i) => outside(0.01 * i, 2.6 - 0.02 * i)));
  assert.equal(near.holes, 0);
  const within = await fly(Array.from({ length: 30 }, (_, i) => inside(0.01 * i)));
  await look(inside(1));
  const slow = await fly(Array.from({ length: 60 }, (_, i) => inside(1 + 0.005 * i)));
  assert.equal(slow.empty, 0, JSON.stringify(slow.where));
  assert.ok(within.triangles > 0);
});

// Decodes a picture by the browser itself.
async function backgroundOf(file) {
  const base64 = fs.readFileSync(file).toString("base64");
  return page.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    // The sky of each row is that of its first pixel.
    return Array.from({ length: data.length / 4 }, (_, i) => {
      const first = 4 * (i - (i % image.width));
      return Number([0, 1, 2].every((k) => Math.abs(data[4 * i + k] - data[first + k]) <= 2));
    });
  }, base64);
}

test("the outline is native's, but for pixels at its border", async () => {
  await openPage();
  await open({ tolerancePx: 1, occlusion: true, slackPx: 0 }, outside(0, 2.6));
  const cameras = [outside(0, 3.2), outside(2, 2.8)];
  const native = fronts(ohlod, planet, cameras.map((camera) => ({ ...camera, width, height })), 1, path.join(folder, "native.png"));
  for (const [i, camera] of cameras.entries()) {
    await look(camera);
    const bits = Buffer.from(await page.evaluate(() => window.page.mask()), "base64");
    const sky = await backgroundOf(path.join(folder, `native_0000${i}.png`));
    const isWeb = (x, y) => (bits[(y * width + x) >> 3] >> (7 - ((y * width + x) & 7))) & 1;
    const around = (x, y, value) => [-2, -1, 0, 1, 2].every((dy) => [-2, -1, 0, 1, 2].every((dx) => sky[(y + dy) * width + x + dx] === value));
    let [lacking, extra, surface] = [0, 0, 0];
    for (let y = 2; y < height - 2; ++y)
      for (let x = 2; x < width - 2; ++x) {
        surface += !sky[y * width + x];
        lacking += isWeb(x, y) && around(x, y, 0);
        extra += !isWeb(x, y) && around(x, y, 1);
      }
    assert.ok(surface > 100000 && native[i].triangles > 0);
    assert.deepEqual([lacking, extra], [0, 0], `camera ${i}`);
  }
});

test("memory stays within its limit over 10,000 frames, and pictures stay whole", async (context) => {
  await openPage();
  const limit = 48 * 2 ** 20;
  await open({ memory: limit, tolerancePx: 1 }, outside(0, 2.6));
  await page.evaluate(() => window.page.first());
  const most = { memoryBytes: 0, triangles: 0 };
  const begin = Date.now();
  for (let part = 0; part < 10; ++part) {
    // Around, and a jump to the other side every hundred frames.
    const cameras = Array.from({ length: 1000 }, (_, i) => outside(0.01 * i + Math.PI * Math.floor(i / 100) + part, 1.25 + 0.9 * ((i * 7) % 100) / 100));
    const seen = await fly(cameras, { picture: false });
    for (const key of Object.keys(most)) most[key] = Math.max(most[key], seen[key]);
  }
  const stats = await page.evaluate(() => window.page.stats());
  context.diagnostic(`at most ${most.memoryBytes} of ${limit} bytes, ${most.triangles} triangles; ${stats.bytesLoaded} bytes loaded, ${stats.requests} requests, ${stats.cancelled} cancelled, in ${Date.now() - begin} ms`);
  assert.ok(most.memoryBytes <= limit && most.memoryBytes > 0.2 * limit, `${most.memoryBytes}`);
  assert.equal((await look(outside(1, 2.2))).holes, 0);
});

test("lost and slow answers are asked for again; a damaged file leaves a coarser picture and lines", async () => {
  await openPage();
  let asked = 0;
  server.link.fault = ({ file }) => (file === ohlod ? ["drop", undefined, "stall", undefined, 503, undefined][asked++ % 6] : undefined);
  await open({ stallMs: 500, occlusion: false }, outside(0, 2.4));
  const seen = await look(outside(0, 2.4));
  faultless();
  assert.ok(seen.stats.failed === 0 && seen.stats.largestErrorPx <= 1, JSON.stringify(seen.stats));
  assert.equal(seen.holes, 0);

  // A byte of each 64 KiB in the middle of the file, where meshes are.
  const bytes = fs.openSync(ohlod, "r");
  const [first, last] = [0.25, 0.75].map((share) => share * fs.fstatSync(bytes).size);
  server.link.fault = ({ file, begin, end }) => {
    if (file !== ohlod) return undefined;
    const part = Buffer.alloc(end - begin);
    fs.readSync(bytes, part, 0, part.length, begin);
    for (let at = 65536 * Math.ceil(Math.max(first, begin) / 65536); at < Math.min(last, end); at += 65536) part[at - begin] ^= 255;
    return part;
  };
  await openPage();
  await open({ occlusion: false }, outside(0, 2.4));
  const coarse = await look(outside(0, 2.4));
  const failures = await page.evaluate(() => window.page.failures);
  faultless();
  fs.closeSync(bytes);
  assert.equal(coarse.holes, 0);
  assert.ok(coarse.stats.triangles > 0 && coarse.stats.triangles < seen.stats.triangles && coarse.stats.failed > 0, JSON.stringify(coarse.stats));
  assert.ok(failures.length === coarse.stats.failed && failures.every((line) => /^.*\.ohlod: node \d+: is damaged: .*; /.test(line)), failures[0]);
});

test("a budget is kept, and geomorphs have no holes", async () => {
  await openPage();
  await open({ budget: 20000, tolerancePx: 0 }, outside(0, 2));
  const seen = await look(outside(0, 2));
  assert.ok(seen.drawn <= 20000 && seen.drawn > 10000, String(seen.drawn));
  await open({ geomorph: true, tolerancePx: 4 }, outside(0, 2.6));
  for (let i = 0; i < 6; ++i) assert.equal((await look(outside(0, 2.6 - 0.1 * i))).holes, 0);
  assert.deepEqual(complaints, []);
});

// A model with images, whole and in nodes; and the places of the nodes' images in the file.
function textured(name, images, mimeType) {
  const [model, file] = [".glb", ".ohlod"].map((ending) => path.join(path.dirname(ohlod), name + ending));
  fs.writeFileSync(model, glb(images, mimeType));
  run("hlod", "build", model, "-o", file);
  const bytes = fs.readFileSync(file);
  const places = [];
  const begin = mimeType === "image/png" ? Buffer.from("\x89PNG\r\n", "latin1") : Buffer.from([0xff, 0xd8, 0xff, 0xe0]);
  for (let at = 0; (at = bytes.indexOf(begin, at)) >= 0; ++at) places.push(at);
  return { model, file, bytes, places };
}
const load = ({ model }) => page.evaluate((url) => window.page.load(url), `${server.url}/data/${path.basename(model)}`);
const compare = (options) => page.evaluate((options) => window.page.compare(options), options);
const picture = (name) => page.screenshot({ path: path.join(pictures, `three_${name}.png`) });
const colors = { color: null, occlusion: false };

test("nodes show their own images as the whole model shows its images", async (context) => {
  const model = textured("textured", pngs(), "image/png");
  await openPage();
  await load(model);
  const facts = await openFile(model.file, colors, outside(0.6, 3.4));
  assert.ok(facts.hasImages && facts.hasColors);
  const views = { far: outside(0.6, 3.4), near: outside(1.9, 1.7), oblique: { eye: [0.2, 1.15, 0.6], target: [0, 0.9, 0] } };
  for (const [name, at] of Object.entries(views)) {
    const seen = await look(at);
    const { psnr, pixels, red, trueRed, textures } = await compare();
    await picture(`textured_${name}`);
    await compare({ isWhole: true });
    await picture(`textured_${name}_whole`);
    const { bytesLoaded, requests, memoryBytes } = seen.stats;
    context.diagnostic(`${name}: ${psnr.toFixed(1)} dB of ${pixels} pixels, ${textures} textures, ${bytesLoaded} of ${model.bytes.length} bytes in ${requests} requests, ${memoryBytes} bytes of memory`);
    assert.ok(psnr > 30, `${name}: ${psnr}`);
    assert.ok(Math.abs(red - trueRed) < 0.1 * trueRed + 1e-4, `${red}, ${trueRed}`);
    assert.equal(seen.holes, 0);
    if (name === "far") assert.ok(bytesLoaded < 0.6 * model.bytes.length, `${bytesLoaded}`); // images that nobody sees stay away
  }
  // Vertices that slide take their places in the image along.
  const coarse = [];
  for (const geomorph of [false, true]) {
    await openFile(model.file, { ...colors, geomorph, tolerancePx: 3 }, views.far);
    for (let i = 0; i < 3; ++i) {
      assert.equal((await look(outside(0.6, 3.4 - 0.3 * i))).holes, 0);
      coarse.push((await compare()).psnr);
    }
  }
  context.diagnostic(`3 px, and with geomorphs: ${coarse.map((psnr) => psnr.toFixed(1)).join(", ")} dB`);
  for (const psnr of coarse) assert.ok(psnr > 18, coarse.join()); // what slides is up to 3 px off, and its texels with it
});

test("JPEGs of nodes are shown, too, and lost and slow answers cost time alone", async (context) => {
  await openPage();
  const jpegs = [];
  for (const image of pngs()) jpegs.push(Buffer.from(await page.evaluate((...given) => window.page.encode(...given), image.toString("base64"), "image/jpeg"), "base64"));
  const model = textured("jpegs", jpegs, "image/jpeg");
  await load(model);
  let asked = 0;
  server.link.fault = ({ file }) => (file === model.file ? [undefined, "drop", undefined, "stall", 503, undefined][asked++ % 6] : undefined);
  await openFile(model.file, { ...colors, stallMs: 500 }, outside(2, 2.4));
  const { stats } = await look(outside(2, 2.4));
  faultless();
  const { psnr } = await compare();
  context.diagnostic(`${psnr.toFixed(1)} dB, ${stats.requests} requests, ${stats.lost} lost`);
  assert.ok(psnr > 30 && stats.lost > 2 && stats.failed === 0, JSON.stringify(stats));
});

test("images keep to the limit of memory and go with their nodes", async (context) => {
  const model = textured("large", largePngs(), "image/png");
  await openPage();
  await load(model);
  const shown = []; // texels, with each limit
  for (const [limit, options] of [[2 ** 29, {}], [48 * 2 ** 20, {}], [24 * 2 ** 20, { tolerancePx: 4 }]]) {
    await openFile(model.file, { ...colors, memory: limit, ...options }, outside(0, 2.6));
    await page.evaluate(() => window.page.first());
    const flown = await fly(Array.from({ length: 30 }, (_, i) => outside(0.5 * i, 3 - 0.04 * i)));
    const fast = await fly(Array.from({ length: 300 }, (_, i) => outside(0.1 * i, 1.4 + ((i * 7) % 100) / 100)), { picture: false });
    const most = Math.max(flown.memoryBytes, fast.memoryBytes);
    const { psnr, textures, texels } = await compare();
    context.diagnostic(`at most ${most} of ${limit} bytes, ${textures} textures, ${texels} texels, ${psnr.toFixed(1)} dB`);
    assert.equal(flown.holes, 0);
    assert.ok(most > 0.1 * limit && most <= limit, `${most}`);
    assert.ok(psnr > 30 && textures > 10, `${psnr}`);
    shown.push(texels);
  }
  assert.ok(shown[1] < 0.5 * shown[0] && shown[1] * (4 + 16 / 3) <= (48 * 2 ** 20) / 4, shown.join());
  await page.evaluate(() => window.page.close());
  assert.equal(await page.evaluate(() => window.page.textures()), 2); // those of the whole model
});

test("a damaged image leaves the colours of materials and a line; other nodes have theirs", async () => {
  const model = textured("textured", pngs(), "image/png");
  const spoil = (isSpoilt) => ({ file, begin, end }) => {
    if (file !== model.file) return undefined;
    const part = Buffer.from(model.bytes.subarray(begin, end));
    for (const [i, at] of model.places.entries()) if (isSpoilt(i) && at + 40 >= begin && at + 40 < end) part[at + 40 - begin] ^= 255;
    return part;
  };
  await openPage();
  await load(model);
  const at = outside(0.6, 2.4);
  const results = [];
  for (const isSpoilt of [() => false, (i) => i % 3 === 1, () => true]) {
    server.link.fault = spoil(isSpoilt);
    await openFile(model.file, colors, at);
    const seen = await look(at);
    const failures = await page.evaluate(() => window.page.failures);
    results.push({ seen, failures, ...(await compare()) });
    await picture(`damaged_${results.length}`);
  }
  faultless();
  const [good, some, none] = results;
  assert.deepEqual(good.failures, []);
  assert.ok(some.failures.length > 0 && none.failures.length > some.failures.length);
  for (const line of none.failures) assert.match(line, /^textured\.ohlod: image of node \d+: is damaged: its checksum is wrong; /);
  for (const { seen } of results) assert.deepEqual([seen.holes, seen.stats.failed, seen.stats.hash], [0, 0, good.seen.stats.hash]);
  assert.ok(good.psnr > some.psnr && some.psnr > none.psnr, JSON.stringify(results.map(({ psnr }) => psnr)));
});

test("TypeScript's compiler accepts the examples of @occlod/three", () => {
  execFileSync("node_modules/.bin/tsc", ["--noEmit", "--strict", "--skipLibCheck", "--target", "es2022", "--module", "nodenext", "--lib", "es2023,dom", "three_example.ts"], { stdio: "pipe", encoding: "utf8" });
});

test("the package is small", (context) => {
  const files = ["index.js", "stream.js", "worker.js", "node_images.js"];
  const bytes = files.map((file) => zlib.gzipSync(fs.readFileSync(path.join("node_modules/@occlod/three", file)), { level: 9 }).length).reduce((a, b) => a + b);
  context.diagnostic(`${bytes} bytes, compressed, beside three.js and occlod`);
  assert.ok(bytes < 20000);
  const streams = ["calls.js", "hlod.js", "wasm/hlod.js", "wasm/hlod.wasm"].map((file) => zlib.gzipSync(fs.readFileSync(path.join("node_modules/occlod", file)), { level: 9 }).length);
  const sum = streams.reduce((a, b) => a + b);
  context.diagnostic(`${sum} bytes of occlod`);
  assert.ok(sum <= 240000, `${sum} bytes`);
});
