// The npm package in Node: answers equal to native's, errors, memory, the command line.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import test, { before } from "node:test";
import { Worker } from "node:worker_threads";
import zlib from "node:zlib";

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

test("a scan is refined as native refines it, and the times of both are told", (context) => {
  const scan = realMesh("scans/dragon_vrip_res2.ply");
  if (!scan) return context.skip("OCCLOD_MESHES has no scans/dragon_vrip_res2.ply");
  // By turns, and the best of each: other programs disturb both.
  const best = [Infinity, Infinity];
  for (let round = 0; round < 3; ++round) {
    const web = hashesAlong(scan, (h) => around(h, 100), 10000, true);
    const native = updates(scan, web.cameras, 10000, true);
    assert.deepEqual(web.frames.map((f) => f.hash), native.map((f) => f.hash));
    best[0] = Math.min(best[0], median(web.frames.slice(1).map((f) => f.ms)));
    best[1] = Math.min(best[1], median(native.slice(1).map((f) => f.refine_ms + f.occlusion_ms)));
  }
  const ratio = best[0] / best[1];
  context.diagnostic(`median of 99 updates to 10,000 triangles: ${best[0].toFixed(2)} ms, native ${best[1].toFixed(2)} ms: ${ratio.toFixed(2)} times`);
});

test("a mesh, a cut and a simplified mesh are written as native writes them", () => {
  const mesh = Mesh.read("planet.ply", bytes());
  const hierarchy = mesh.build();
  const file = (name) => new Uint8Array(fs.readFileSync(path.join(folder, name)));
  run("build", planet, "-o", "planet.olod");
  assert.deepEqual(hierarchy.write({ compressed: false }), file("planet.olod"));
  run("simplify", planet, "--triangles", "1000", "-o", "native.glb");
  assert.deepEqual(mesh.simplify({ triangles: 1000 }).write("glb"), file("native.glb"));
  run("cut", "planet.olod", "--triangles", "1000", "-o", "native.stl");
  assert.deepEqual(hierarchy.cut({ triangles: 1000 }).write("stl"), file("native.stl"));
  const again = Hierarchy.read(hierarchy.write());
  assert.deepEqual(again.write({ compressed: false }), file("planet.olod"));
  assert.equal(again.triangleCount, mesh.triangleCount);
});

test("a glTF file takes its buffer and a GLB file its images along", () => {
  const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
  const triangles = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
  const tetrahedron = Mesh.of({ positions, triangles });
  assert.deepEqual(tetrahedron.positions, positions);
  assert.deepEqual([...tetrahedron.triangles], triangles);
  const object = "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
  const image = Buffer.from("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==", "base64");
  const others = { "t.mtl": Buffer.from("newmtl m\nmap_Kd t.png\n"), "t.png": image };
  const glb = Buffer.from(Mesh.read("t.obj", Buffer.from(object), { others }).write("glb"));
  assert.ok(glb.includes(image), "the image is in the GLB file");
  assert.equal(Mesh.read("t.glb", glb).triangleCount, 1);
  const buffer = Buffer.from(positions.buffer);
  const gltf = { asset: { version: "2.0" }, scenes: [{ nodes: [0] }], scene: 0, nodes: [{ mesh: 0 }], meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }], buffers: [{ uri: "b.bin", byteLength: 48 }], bufferViews: [{ buffer: 0, byteLength: 48 }], accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }] };
  assert.equal(Mesh.read("b.gltf", Buffer.from(JSON.stringify(gltf)), { others: { "b.bin": buffer } }).triangleCount, 1);
});

test("what is wrong is one line, and the next call works", () => {
  const one = (call, pattern) => assert.throws(call, (error) => error instanceof OcclodError && pattern.test(error.message) && !error.message.includes("\n"));
  one(() => Mesh.read("cut.ply", bytes().subarray(0, 5000)), /^cut\.ply: .*; /);
  one(() => Mesh.read("no.xyz", bytes()), /no\.xyz/);
  one(() => Hierarchy.read(bytes()), /hierarchy\.olod: .*; /);
  const hierarchy = Mesh.read("planet.ply", bytes()).build();
  const refiner = new Refiner(hierarchy);
  one(() => refiner.triangles(), /nothing has been refined yet/);
  one(() => refiner.update(hierarchy.lookingAt(), { budget: 1 }), /budget/);
  one(() => refiner.update({ eye: [0, 0, 0], target: [0, 0, 0] }), /camera/);
  assert.throws(() => refiner.setTransform(1, [1]), OcclodError);
  refiner.update(hierarchy.lookingAt(), { budget: 3000 });
  assert.equal(refiner.triangles().length, 9000);
  assert.equal(refiner.seen(hierarchy.lookingAt()).length, 3000);
  one(() => refiner.triangles(1), /there is no object 1/);
  hierarchy.dispose();
  one(() => hierarchy.positions, /has been disposed of/);
  refiner.update({ eye: [0, 0, 5], target: [0, 0, 0] }); // which keeps what it needs
  assert.equal(version(), "0.1.0");
});

test("progress reaches 1 and can cancel", () => {
  const mesh = Mesh.read("planet.ply", bytes());
  const told = [];
  mesh.build({ onProgress: (done) => void told.push(done) }).dispose();
  assert.equal(told.at(-1), 1);
  assert.deepEqual(told, [...told].sort((a, b) => a - b));
  assert.throws(() => mesh.build({ onProgress: () => false }), /cancelled/);
  assert.throws(() => mesh.build({ onProgress: () => { throw new RangeError("mine"); } }), (error) => error instanceof RangeError && error.message === "mine");
});

test("cameras by matrices see what cameras by eye and target see", () => {
  const hierarchy = Mesh.read("planet.ply", bytes()).build();
  const camera = { eye: [0, 0, 4], target: [0, 0, 0], fovY: 60, width: 800, height: 600, near: 1, far: 10 };
  const f = 1 / Math.tan(Math.PI / 6);
  const matrices = {
    worldToEye: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -4, 1],
    eyeToClip: [(f * 600) / 800, 0, 0, 0, 0, f, 0, 0, 0, 0, -11 / 9, -1, 0, 0, -20 / 9, 0],
    width: 800,
    height: 600,
  };
  const hash = (view, transform) => {
    const refiner = new Refiner([{ hierarchy, transform }]);
    refiner.refine(view, { budget: 3000 });
    return refiner.hash;
  };
  assert.equal(hash(matrices), hash(camera));
  const moved = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1];
  assert.equal(hash({ ...camera, eye: [0, 0, 6], target: [0, 0, 2] }, moved), hash(camera));
});

test("memory is given back: a hundred meshes need no more than three", () => {
  const round = () => {
    const mesh = Mesh.read("planet.ply", bytes());
    const hierarchy = mesh.build();
    const refiner = new Refiner(hierarchy);
    refiner.update(hierarchy.lookingAt(), { budget: 3000 });
    for (const owned of [refiner, hierarchy, mesh]) owned.dispose();
  };
  for (let i = 0; i < 3; ++i) round();
  const before = memoryBytes();
  for (let i = 0; i < 97; ++i) round();
  assert.equal(memoryBytes(), before);
});

test("it works in a worker", async () => {
  const worker = new Worker(
    `import("occlod").then(async ({ Mesh, ready }) => {
       await ready();
       const { parentPort, workerData } = await import("node:worker_threads");
       parentPort.postMessage(Mesh.read("planet.ply", workerData).triangleCount);
     });`,
    { eval: true, workerData: bytes() },
  );
  const count = await new Promise((done, failed) => worker.once("message", done).once("error", failed));
  assert.equal(count, Mesh.read("planet.ply", bytes()).triangleCount);
});

const command = (...words) => spawnSync("npx", ["--no-install", "occlod", ...words], { encoding: "utf8", cwd: process.cwd() });

test("npx occlod simplifies as native does", () => {
  const [web, native] = [path.join(folder, "web.glb"), path.join(folder, "native.glb")];
  const answer = command("simplify", planet, "-o", web, "--error", "0.01");
  assert.equal(answer.status, 0, answer.stderr);
  run("simplify", planet, "-o", native, "--error", "0.01");
  assert.deepEqual(fs.readFileSync(web), fs.readFileSync(native));
  const millimetres = command("simplify", web, "-o", path.join(folder, "mm.glb"), "--error", "0.5mm");
  assert.equal(millimetres.status, 0, millimetres.stderr);
  const wrong = command("simplify", "missing.ply", "-o", web, "--ratio", "0.1");
  assert.equal(wrong.status, 1);
  assert.match(wrong.stderr, /^occlod: error: missing\.ply: .*; .*\n$/);
  assert.equal(command("--version").stdout.trim(), version());
});

test("TypeScript's compiler accepts the examples", () => {
  execFileSync("node_modules/.bin/tsc", ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--lib", "es2023,dom", "example.ts"], { stdio: "pipe", encoding: "utf8" });
});

test("a page loads at most 600 kB, and the package with the command line has at most 1,100", (context) => {
  const folder = "node_modules/occlod";
  const files = ["calls.js", "index.js", "wasm/library.js", "wasm/library.wasm"];
  const bytes = files.map((file) => zlib.gzipSync(fs.readFileSync(path.join(folder, file)), { level: 9 }).length);
  const sum = bytes.reduce((a, b) => a + b);
  const all = fs.statSync(process.env.OCCLOD_PACKAGE).size;
  context.diagnostic(`${sum} bytes, compressed; the package with the command line ${all}`);
  assert.ok(sum <= 600000 && all <= 1100000, `${sum}, ${all} bytes`);
});
