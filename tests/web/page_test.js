// The page in headless Chromium: a mesh is dropped, built in a worker with progress and refined in every frame; its
// triangles are native's. OCCLOD_PAGE: the folder that is served; OCCLOD_PICTURES: where pictures are left.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import fs from "node:fs";
import path from "node:path";
import test, { after, before } from "node:test";
import puppeteer from "puppeteer-core";

import { folder, realMesh, run, updates } from "./native.js";

const pictures = process.env.OCCLOD_PICTURES ?? folder;
const budget = 10000;
let server;
let browser;
let page;
const complaints = [];

before(async () => {
  server = spawn("python3", ["-u", "-m", "http.server", "--bind", "127.0.0.1", "--directory", process.env.OCCLOD_PAGE, "0"]);
  const port = /port (\d+)/.exec(String((await once(server.stdout, "data"))[0]))[1];
  browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
  page = await browser.newPage();
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  await page.setViewport({ width: 1000, height: 700 });
  await page.goto(`http://127.0.0.1:${port}/`);
});

after(async () => {
  await browser?.close();
  server?.kill();
});

// As a person would, but for the hand: the events of a drop, with the files.
async function drop(name, bytes) {
  await page.evaluate(
    async (name, base64) => {
      const data = new DataTransfer();
      data.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name));
      window.occlod.told = new Set();
      new MutationObserver(() => window.occlod.told.add(document.getElementById("told").textContent)).observe(document.getElementById("told"), { childList: true });
      document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
    },
    name,
    bytes.toString("base64"),
  );
}

const refined = () => page.evaluate(() => window.occlod.refined);
const settle = () => new Promise((done) => setTimeout(done, 1500));
const click = (id) => page.evaluate((id) => document.getElementById(id).click(), id);
const isDrawn = async (name) => {
  await page.screenshot({ path: path.join(pictures, name) });
  // Of the canvas: how many pixels are no background.
  return page.evaluate(() => {
    const canvas = document.getElementById("canvas");
    const flat = document.createElement("canvas");
    [flat.width, flat.height] = [canvas.width, canvas.height];
    const context = flat.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, flat.width, flat.height);
    let drawn = 0;
    for (let i = 0; i < data.length; i += 4) drawn += Math.abs(data[i] - 196) + Math.abs(data[i + 1] - 204) > 12;
    return drawn / (data.length / 4);
  });
};

test("a scan that is dropped is built with progress and refined in every frame as native refines it", async () => {
  let file = realMesh("scans/dragon_vrip_res2.ply");
  if (!file) run("generate", "rough-planet", "level=7", "-o", (file = path.join(folder, "planet.ply")));
  await drop(path.basename(file), fs.readFileSync(file));
  await page.waitForFunction(() => window.occlod.refined.length > 0 || window.occlod.failure, { timeout: 120000 });
  assert.equal(await page.evaluate(() => window.occlod.failure), undefined);
  const told = await page.evaluate(() => [...window.occlod.told]);
  assert.ok(told.filter((line) => /^building: \d+ %$/.test(line)).length >= 5, told.join("|"));

  await page.mouse.move(600, 350);
  await page.mouse.down();
  for (let i = 1; i <= 30; ++i) {
    await page.mouse.move(600 - 4 * i, 350 + i);
    await new Promise((done) => setTimeout(done, 30));
  }
  await page.mouse.up();
  await settle();
  const frames = await refined();
  assert.ok(frames.length >= 10, `${frames.length} frames`);
  const native = updates(file, frames.map(({ camera }) => camera), budget, true);
  assert.deepEqual(frames.map(({ hash }) => hash), native.map(({ hash }) => hash));
  assert.ok((await isDrawn("page.png")) > 0.05);
  assert.equal(await page.$eval("#invitation", (shown) => getComputedStyle(shown).display), "none");
});

test("the colours by visibility, freezing, occlusion and the budget do what they say", async () => {
  await click("why");
  await settle();
  const counts = await page.$$eval("#legend li", (items) => items.map((item) => Number(item.textContent.replace(/\D/g, ""))));
  const before = (await refined()).at(-1);
  assert.equal(counts.reduce((a, b) => a + b), before.stats.triangles);
  assert.ok(counts[0] > 0.4 * before.stats.triangles, counts.join(" "));

  await click("freeze");
  const { length } = await refined();
  await page.mouse.move(600, 350);
  await page.mouse.down();
  await page.mouse.move(900, 350, { steps: 5 });
  await page.mouse.up();
  await settle();
  assert.equal((await refined()).length, length, "a frozen view is not refined");
  assert.ok((await isDrawn("page_frozen.png")) > 0.05);

  await click("freeze");
  await click("occlusion");
  await settle();
  assert.equal((await refined()).at(-1).stats.queries, 0);
  await page.evaluate(() => {
    const slider = document.getElementById("budget");
    slider.value = 3.5;
    slider.dispatchEvent(new Event("input"));
  });
  await settle();
  const after = (await refined()).at(-1);
  assert.ok(after.stats.triangles <= 3162 && after.stats.triangles > 3000, String(after.stats.triangles));
});

test("a damaged file is answered by one line, and the page goes on", async () => {
  await drop("broken.ply", Buffer.from("ply\nformat ascii 1.0\nelement vertex 3\n"));
  await page.waitForFunction(() => window.occlod.failure);
  const line = await page.evaluate(() => window.occlod.failure);
  assert.match(line, /broken\.ply.*: .*; /);
  assert.doesNotMatch(line, /\n/);
  await drop("small.obj", Buffer.from("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"));
  await page.waitForFunction(() => window.occlod.refined.length > 0);
  assert.equal((await refined()).at(-1).stats.triangles, 4);
  assert.deepEqual(complaints, []);
});
