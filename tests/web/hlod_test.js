// HLODs in Node: whole and from afar, over a server that loses, stalls and damages; fronts equal to native's.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import test, { after, before } from "node:test";

import { Hlod, OcclodError, ready } from "occlod/hlod.js";
import { HlodStream } from "@occlod/three/stream.js";
import { folder, fronts, run } from "./native.js";
import { serve } from "./range_server.js";

const planet = path.join(folder, "planet.ply");
const ohlod = path.join(folder, "planet.ohlod");
const size = { width: 800, height: 600 };
const path0 = Array.from({ length: 12 }, (_, i) => ({ eye: [0, Math.sin(0.4 * i), 2.6 - 0.12 * i], target: [0, 0, 0], near: 0.001, far: 100, ...size }));
const memory = 6 * 2 ** 20;
let server;

before(async () => {
  await ready();
  run("generate", "rough-planet", "level=7", "-o", planet);
  run("hlod", "build", planet, "-o", ohlod);
  server = await serve({ slow: { data: folder } });
});
after(() => server.close());

const whole = () => Hlod.read("planet.ohlod", fs.readFileSync(ohlod));

test("without occlusion, what is selected is what native selects", () => {
  const hlod = whole();
  assert.equal(hlod.triangleCount, 131072);
  const web = path0.map((camera) => hlod.select(camera, { occlusion: false }));
  const native = fronts(ohlod, planet, path0, 1);
  assert.deepEqual(web.map(({ hash, triangles }) => ({ hash, triangles })), native);
  assert.ok(new Set(web.map(({ hash }) => hash)).size > path0.length / 2);
});

test("occlusion leaves out the far side; slack lets less be hidden; a budget is kept", () => {
  const hlod = whole();
  const select = (options) => {
    for (let i = 0; i < 4; ++i) hlod.select(path0[0], options); // until it knows what is hidden
    return hlod.select(path0[0], options);
  };
  const [all, seen, slack] = [{ occlusion: false }, {}, { slackPx: 60 }].map(select);
  assert.ok(seen.triangles < 0.95 * all.triangles, `${seen.triangles} of ${all.triangles}`);
  assert.ok(slack.triangles > seen.triangles && slack.triangles <= all.triangles, `${slack.triangles}`);
  const few = select({ budget: 9000, tolerancePx: 0 });
  assert.ok(few.triangles <= 9000 && few.triangles > 4000, String(few.triangles));
});

test("selected nodes have meshes whose ranges are the triangles that were told", () => {
  const hlod = whole();
  const { triangles } = hlod.select(path0[3], { geomorph: true, tolerancePx: 3 });
  let sum = 0;
  let moved = 0;
  for (const { node, ranges } of hlod.selected) {
    const { positions, indices, slides } = hlod.mesh(node, ["positions", "indices", "slides"]);
    assert.equal(slides.length / 4, positions.length / 3);
    const firsts = hlod.patches(node);
    for (const { first, count, morph } of ranges) {
      sum += count / 3;
      if (morph > 0) ++moved;
      assert.ok(first + count <= indices.length && [...firsts].includes(first));
      for (const v of indices.subarray(first, first + count)) assert.ok(v < positions.length / 3);
    }
  }
  assert.equal(sum, triangles);
  assert.ok(moved > 0);
});

// Frames at `cameras`, a few ms apart, until nothing is missing at the last of them.
async function draw(stream, cameras, options = { occlusion: false }) {
  let stats;
  for (let i = 0, calm = 0; calm < 3 && i < 4000; ++i) {
    const camera = cameras[Math.min(i, cameras.length - 1)];
    stats = stream.hlod.select(camera, options);
    stream.pump();
    const { residentBytes, loadingBytes, budgetBytes } = stream.hlod.store;
    assert.ok(residentBytes + loadingBytes <= budgetBytes);
    if (i >= cameras.length && stats.missing === 0) ++calm;
    else calm = 0;
    await new Promise((done) => setTimeout(done, 4));
  }
  return stats;
}

async function streamed(link = {}, options = {}) {
  Object.assign(server.link, { fault: () => undefined, latencyMs: 0, bytesPerSecond: Infinity }, link);
  const stream = new HlodStream(`${server.url}/data/planet.ohlod`, { memory, stallMs: 20000, ...options });
  await stream.open();
  return stream;
}

test("from afar, first the roots come, then what the view needs", async () => {
  const stream = await streamed({ latencyMs: 10, bytesPerSecond: 5e6 });
  const first = stream.hlod.select(path0[0], { occlusion: false });
  assert.ok(first.triangles > 0 && first.triangles < 3000 && first.missing > 0);
  assert.ok(stream.counts.bytes < 0.25 * fs.statSync(ohlod).size, `${stream.counts.bytes} bytes`);
  const last = await draw(stream, path0);
  const [, native] = fronts(ohlod, planet, [path0[0], path0.at(-1)], 1);
  assert.equal(last.hash, native.hash);
  assert.equal(stream.counts.lost, 0);
  stream.close();
});

test("lost, stalled and refused answers are asked for again, and the picture is the same", async () => {
  const stream = await streamed({ fault: ({ number }) => [undefined, "drop", undefined, "stall", 503, undefined, undefined][number % 7] }, { stallMs: 300 });
  const last = await draw(stream, path0);
  assert.equal(last.hash, fronts(ohlod, planet, [path0.at(-1)], 1)[0].hash);
  assert.ok(stream.counts.lost >= 3, `${stream.counts.lost} lost`);
  assert.equal(last.largestErrorPx <= 1, true);
  assert.equal(stream.hlod.store.failed, 0);
  stream.close();
});

test("what comes damaged once is asked for again; what is damaged for good leaves a coarser picture and a line", async () => {
  const bytes = fs.readFileSync(ohlod);
  const damaged = (begin, end) => {
    const part = Buffer.from(bytes.subarray(begin, end));
    part[part.length >> 1] ^= 1;
    return part;
  };
  let once = 0;
  const healed = await streamed();
  server.link.fault = ({ begin, end }) => (once++ < 1 ? damaged(begin, end) : undefined);
  const fine = await draw(healed, [path0[0]]);
  assert.ok(once >= 2);
  assert.equal(fine.hash, fronts(ohlod, planet, [path0[0]], 1)[0].hash);
  healed.close();

  const spoilt = await streamed();
  let answers = 0;
  server.link.fault = ({ begin, end }) => (answers++ > 1 ? damaged(begin, end) : undefined);
  const coarse = await draw(spoilt, [path0[0]]);
  const failures = spoilt.hlod.takeFailures();
  assert.ok(failures.length > 0 && failures.every((line) => /^planet\.ohlod: node \d+: is damaged: .*; /.test(line)), failures[0]);
  assert.ok(coarse.triangles > 0 && coarse.triangles < fine.triangles && coarse.largestErrorPx > 1);
  spoilt.close();
});

test("what is no longer wanted is cancelled", async () => {
  const stream = await streamed({ latencyMs: 40 });
  const near = [1, -1].map((side) => ({ ...path0[0], eye: [0, 0, 1.3 * side], target: [0, 0, 0] }));
  await draw(stream, Array.from({ length: 120 }, (_, i) => near[(i >> 2) & 1]));
  assert.ok(stream.counts.cancelled > 0);
  assert.ok(server.told.aborted > 0);
  stream.close();
});

test("a hard limit: the memory stays, and so does a whole picture, over a long path", async () => {
  const stream = await streamed({}, { memory: 2 * 2 ** 20 });
  const last = await draw(stream, Array.from({ length: 1500 }, (_, i) => path0[(i >> 4) % path0.length]));
  assert.ok(stream.hlod.store.evictions > 0 && last.triangles > 0);
  stream.close();
});

test("what is wrong with a file or a server is one line", async () => {
  const one = (promise, pattern) => assert.rejects(promise, (error) => pattern.test(error.message) && !error.message.includes("\n"));
  const open = (name, options) => new HlodStream(`${server.url}/data/${name}`, { memory, stallMs: 100, ...options }).open();
  await streamed({});
  await one(open("missing.ohlod"), /^missing\.ohlod: the server answers 404 .*; check the address$/);
  await one(open("planet.ply"), /^planet\.ply: .*is not an \.ohlod file; /);
  await one(open("planet.ohlod", { memory: 1000 }), /too little for the coarsest picture; allow at least \d+ bytes$/);
  fs.writeFileSync(path.join(folder, "cut.ohlod"), fs.readFileSync(ohlod).subarray(0, 500000));
  await one(open("cut.ohlod"), /^cut\.ohlod: .*truncated/);
  assert.throws(() => Hlod.read("planet.ohlod", fs.readFileSync(ohlod).subarray(0, 99)), OcclodError);
  const hlod = new Hlod("planet.ohlod", 10);
  assert.throws(() => hlod.select(path0[0]), /is not open yet/);
  hlod.dispose();
  const all = whole();
  assert.throws(() => all.mesh(1e6), /there is no node 1000000/);
  assert.throws(() => all.select(path0[0], { tolerancePx: -1 }), /tolerance_px/);
  all.select(path0[0]);
});
