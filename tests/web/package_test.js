// The npm package in Node: answers equal to native's, errors, memory, the command line.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import test, { before } from "node:test";
import { Worker } from "node:worker_threads";

import { Hierarchy, Mesh, OcclodError, Refiner, memoryBytes, ready, version } from "occlod";
import { around, folder, median, realMesh, run, updates } from "./native.js";

const planet = path.join(folder, "planet.ply");
const bytes = () => fs.readFileSync(planet);

before(async () => {
  assert.throws(() => Mesh.read("planet.ply", new Uint8Array()), /is not loaded yet; await ready\(\) first/);
  await ready();
  run("generate", "rough-planet", "level=6", "-o", planet);
});

function hashesAlong(file, cameras, budget, occlusion) {
  const hierarchy = Mesh.read(path.basename(file), fs.readFileSync(file)).build();
  const refiner = new Refiner(hierarchy);
  const frames = cameras(hierarchy).map((camera) => {
    const stats = refiner.update(camera, { budget, occlusion });
    return { hash: refiner.hash, triangles: stats.triangles, ms: stats.refineMs + stats.occlusionMs };
  });
  return { frames, cameras: cameras(hierarchy) };
}

for (const occlusion of [true, false])
  test(`update() gives native's triangles, occlusion ${occlusion}`, () => {
    const web = hashesAlong(planet, (h) => around(h, 12), 5000, occlusion);
    const native = updates(planet, web.cameras, 5000, occlusion);
    assert.deepEqual(web.frames.map((f) => f.hash), native.map((f) => f.hash));
    assert.equal(new Set(web.frames.map((f) => f.hash)).size, 12);
  });

test("update() of a scan takes at most 3 times native's time", (context) => {
  const scan = realMesh("scans/dragon_vrip_res2.ply");
  if (!scan) return context.skip("OCCLOD_MESHES has no scans/dragon_vrip_res2.ply");
  const web = hashesAlong(scan, (h) => around(h, 100), 10000, true);
  const native = updates(scan, web.cameras, 10000, true);
  assert.deepEqual(web.frames.map((f) => f.hash), native.map((f) => f.hash));
  const ms = [median(web.frames.slice(1).map((f) => f.ms)), median(native.slice(1).map((f) => f.refine_ms + f.occlusion_ms))];
  const ratio = ms[0] / ms[1];
  context.diagnostic(`median of 99 updates to 10,000 triangles: ${ms[0].toFixed(2)} ms, native ${ms[1].toFixed(2)} ms: ${ratio.toFixed(2)} times`);
  assert.ok(ratio <= 3, `${ratio} times native's`);
});
