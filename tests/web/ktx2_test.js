// occlod ktx2: what it changes of a tileset, and what it leaves.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import test, { before } from "node:test";
import { NodeBasisEncoder } from "ktx2-encoder";
import sharp from "sharp";
import { withKtx2Images } from "./node_modules/occlod/bin/ktx2/glb.js";
import { folder } from "./native.js";

const IDENTIFIER = "ab4b5458203230bb0d0a1a0a"; // of KTX2
const tool = path.resolve("node_modules/occlod/bin/occlod.js");
const ktx2 = (...args) => spawnSync(process.execPath, [tool, "ktx2", ...args], { cwd: folder, encoding: "utf8" });
const tiles = (...args) => execFileSync(process.env.OCCLOD, ["tiles", "sheet.obj", ...args], { cwd: folder });

function glb(bytes) {
  const end = 20 + bytes.readUInt32LE(12);
  return { gltf: JSON.parse(bytes.subarray(20, end)), binary: bytes.subarray(end + 8) };
}
const part = ({ binary }, range) => binary.subarray(range.byteOffset ?? 0, (range.byteOffset ?? 0) + range.byteLength);
const files = (name) => fs.readdirSync(path.join(folder, name), { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile())
  .map((entry) => path.relative(path.join(folder, name), path.join(entry.parentPath ?? entry.path, entry.name))).sort();
const read = (...names) => fs.readFileSync(path.join(folder, ...names));

// Hills of 3,200 triangles that show an image of 512 x 256 texels.
before(async () => {
  const pixels = Buffer.alloc(512 * 256 * 3);
  for (let i = 0; i < 512 * 256; ++i) {
    const light = 128 + 60 * Math.sin((i % 512) / 12) + i / 4096;
    pixels.set([light, 0.8 * light, 0.6 * light], 3 * i);
  }
  await sharp(pixels, { raw: { width: 512, height: 256, channels: 3 } }).png().toFile(path.join(folder, "sheet.png"));
  const n = 40, lines = ["mtllib sheet.mtl", "usemtl sheet"];
  for (let y = 0; y <= n; ++y) for (let x = 0; x <= n; ++x) lines.push(`v ${x} ${y} ${Math.sin(x / 4) * Math.cos(y / 5)}`, `vt ${x / n} ${y / n}`);
  for (let y = 0; y < n; ++y) for (let x = 0; x < n; ++x) {
    const a = y * (n + 1) + x + 1, b = a + n + 1;
    for (const corners of [[a, a + 1, b], [a + 1, b + 1, b]]) lines.push("f " + corners.map((c) => `${c}/${c}`).join(" "));
  }
  fs.writeFileSync(path.join(folder, "sheet.obj"), lines.join("\n"));
  fs.writeFileSync(path.join(folder, "sheet.mtl"), "newmtl sheet\nmap_Kd sheet.png\n");
  tiles("-o", "png", "--node-triangles", "512");
  tiles("-o", "packed", "--node-triangles", "512", "--compress", "meshopt");
});

for (const kind of ["png", "packed"])
  test(`contents have KTX2 images and else the bytes that they had (${kind})`, async () => {
    const end = ktx2(kind, "-o", `${kind}_k`, "--json", "--threads", "3");
    assert.equal(end.status, 0, end.stderr);
    const counts = JSON.parse(end.stdout), module = await new NodeBasisEncoder().init();
    assert.deepEqual(files(`${kind}_k`), files(kind));
    let squares = 0, values = 0, images = 0;
    for (const name of files(kind)) {
      if (!name.endsWith(".glb")) { assert.deepEqual(read(`${kind}_k`, name), read(kind, name)); continue; }
      const was = glb(read(kind, name)), is = glb(read(`${kind}_k`, name));
      was.gltf.bufferViews.forEach((view, i) => {
        const next = is.gltf.bufferViews[i];
        if (view.buffer === 0 && was.gltf.images[0].bufferView !== i) assert.deepEqual(part(is, next), part(was, view));
        const [packed, moved] = [view, next].map((v) => v.extensions?.EXT_meshopt_compression);
        if (packed) assert.deepEqual(part(is, moved), part(was, packed));
        for (const range of [next, moved]) if (range?.buffer === 0) assert.equal((range.byteOffset ?? 0) % 4, 0);
      });
      assert.deepEqual(is.gltf.textures[0], { sampler: 0, extensions: { KHR_texture_basisu: { source: 0 } } });
      for (const list of ["extensionsUsed", "extensionsRequired"]) assert.ok(is.gltf[list].includes("KHR_texture_basisu"));
      const [others, othersBefore] = [is, was].map(({ gltf }) => JSON.stringify({ ...gltf, textures: 0, images: 0, bufferViews: 0, buffers: 0, extensionsUsed: 0, extensionsRequired: 0 }));
      assert.equal(others.replace(/"extensions(Used|Required)":0,?/g, ""), othersBefore.replace(/"extensions(Used|Required)":0,?/g, ""));
      const { data, info: { width, height } } = await sharp(part(was, was.gltf.bufferViews[was.gltf.images[0].bufferView])).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
      const image = part(is, is.gltf.bufferViews[is.gltf.images[0].bufferView]);
      assert.equal(image.toString("hex", 0, 12), IDENTIFIER);
      assert.equal(is.gltf.images[0].mimeType, "image/ktx2");
      assert.deepEqual([20, 24, 40, 44].map((at) => image.readUInt32LE(at)), [width, height, 1 + Math.floor(Math.log2(Math.max(width, height))), 1]); // all sizes, BasisLZ
      const file = new module.KTX2File(new Uint8Array(image)), rgba = new Uint8Array(4 * width * height);
      assert.ok(file.startTranscoding() && file.transcodeImage(rgba, 0, 0, 0, 13, 0, -1, -1));
      file.close();
      file.delete();
      rgba.forEach((value, i) => { squares += i % 4 === 3 ? 0 : (value - data[i]) ** 2; });
      values += 3 * width * height;
      ++images;
    }
    assert.equal(counts.images, images);
    assert.equal(counts.texels, values / 3);
    assert.ok(images > 5);
    const psnr = 10 * Math.log10((255 ** 2 * values) / squares);
    assert.ok(psnr > 33, `${psnr} dB`);
  });

test("the same bytes by any number of threads, in archives too, which are valid", () => {
  tiles("-o", "png.3tz", "--node-triangles", "512");
  for (const [from, to, threads] of [["png", "one", 1], ["png", "two", 2], ["png.3tz", "one.3tz", 1], ["png.3tz", "two.3TZ", 3], ["png.3tz", "three", 2]]) {
    const end = ktx2(from, "-o", to, "--threads", String(threads));
    assert.equal(end.status, 0, end.stderr);
  }
  for (const name of files("one")) for (const other of ["two", "three"]) assert.deepEqual(read(other, name), read("one", name));
  assert.deepEqual(read("two.3TZ"), read("one.3tz"));
  for (const name of ["one", "one.3tz"]) execFileSync("python3", [path.join(process.env.OCCLOD_ROOT, "tests/tools/tileset_check.py"), path.join(folder, name)]);
});

test("mistakes are told in a line, and leave nothing", () => {
  fs.cpSync(path.join(folder, "png"), path.join(folder, "bad"), { recursive: true });
  fs.writeFileSync(path.join(folder, "bad/tiles/0/1.glb"), read("png/tiles/0/1.glb").subarray(0, 300));
  fs.writeFileSync(path.join(folder, "bad.3tz"), read("png.3tz").subarray(0, 5000));
  const names = fs.readdirSync(folder).sort();
  for (const [args, wanted] of [[["png", "-o", "bad"], /bad: is there already/], [["none", "-o", "x"], /none: is not there/], [["sheet.png", "-o", "x"], /sheet.png: /], [["bad.3tz", "-o", "x.3tz"], /bad.3tz: is no archive/], [["png"], /takes one tileset and -o OUT/],
    [["png", "-o", "x", "--threads", "0"], /--threads 0 is no whole number/], [["png", "-o", "x", "--fast"], /--fast/], [["bad", "-o", "x"], /1\.glb: /], [["png", "-o", "png/x"], /lies in the tileset/]]) {
    const end = ktx2(...args);
    assert.equal(end.status, 2, end.stderr);
    assert.match(end.stderr, wanted);
    assert.equal(end.stderr.trim().split("\n").length, 1);
  }
  assert.deepEqual(fs.readdirSync(folder).sort(), names);
});

test("what is missing is told in a line", () => {
  const alone = path.join(folder, "alone");
  fs.cpSync(path.resolve("node_modules/occlod"), alone, { recursive: true });
  const end = spawnSync(process.execPath, [path.join(alone, "bin/occlod.js"), "ktx2", "png", "-o", "x"], { cwd: folder, encoding: "utf8" });
  assert.equal(end.status, 2);
  assert.equal(end.stderr, "occlod ktx2: the packages ktx2-encoder and sharp are missing; install them beside occlod: npm install ktx2-encoder sharp\n");
});

// A file with two images that share a buffer view, bytes between that are not aligned, and an image that a normal map shows.
test("only images of colours are replaced, and bytes between them stay", async () => {
  const binary = Buffer.from([1, 2, 3, 10, 11, 12, 13, 14, 21, 22, 23, 31, 32, 41, 42, 43, 44, 45]);
  const gltf = { asset: { version: "2.0" }, buffers: [{ byteLength: 18 }],
    bufferViews: [{ buffer: 0, byteLength: 3 }, { buffer: 0, byteOffset: 3, byteLength: 5 }, { buffer: 0, byteOffset: 8, byteLength: 3 }, { buffer: 0, byteOffset: 11, byteLength: 2 }, { buffer: 0, byteOffset: 13, byteLength: 5 }],
    images: [{ bufferView: 1, mimeType: "image/png" }, { bufferView: 1, mimeType: "image/png" }, { bufferView: 3, mimeType: "image/jpeg" }],
    textures: [{ source: 0 }, { source: 1 }, { source: 2 }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } }, emissiveTexture: { index: 1 }, normalTexture: { index: 2 } }] };
  const json = Buffer.from(JSON.stringify(gltf).padEnd(Math.ceil(JSON.stringify(gltf).length / 4) * 4));
  const head = (size, ...words) => { const bytes = Buffer.alloc(size); words.forEach((word, i) => bytes.writeUInt32LE(word, 4 * i)); return bytes; };
  const file = Buffer.concat([head(20, 0x46546c67, 2, 28 + json.length + 20, json.length, 0x4e4f534a), json, head(8, 20, 0x4e4942), binary, Buffer.alloc(2)]);
  const seen = [];
  const is = glb(Buffer.from(await withKtx2Images(file, (bytes) => { seen.push([...bytes]); return Buffer.from("KTX2-image"); })));
  assert.deepEqual(seen, [[10, 11, 12, 13, 14]]);
  assert.deepEqual(is.gltf.bufferViews.map((view) => part(is, view).toString("latin1")), ["\x01\x02\x03", "KTX2-image", "\x15\x16\x17", "\x1f ", ")*+,-"]);
  assert.deepEqual(is.gltf.bufferViews.map((view, i) => ((view.byteOffset ?? 0) - (gltf.bufferViews[i].byteOffset ?? 0)) % 8), [0, 0, 0, 0, 0]);
  assert.deepEqual(is.gltf.images.map((image) => image.mimeType), ["image/ktx2", "image/ktx2", "image/jpeg"]);
  assert.deepEqual(is.gltf.textures[2], { source: 2 });
  assert.equal(await withKtx2Images(file, () => null), null);
});
