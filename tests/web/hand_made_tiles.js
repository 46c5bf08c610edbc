// A tileset made by hand: a wall, and behind it what each kind of refinement can hide. The eye is at (0, -10, 1) and looks
// along y; z is up. The wall is 3 high at y = 0, so from there everything lower than 4 at y = 5 is behind it.
import fs from "node:fs";
import path from "node:path";

export const before = { eye: [0, -10, 1], target: [0, 0, 1.5], up: [0, 0, 1] };
export const behind = { eye: [0, 20, 1], target: [0, 0, 1.5], up: [0, 0, 1] };
export const above = { eye: [0, -10, 14], target: [0, 5, 1], up: [0, 0, 1] };

// A binary glTF of boxes [x0, x1, y0, y1, z0, z1] whose faces look outwards; of their faces towards the eye alone with `open`.
function glb(boxes, { open = false, alphaMode = "OPAQUE" } = {}) {
  const positions = [], triangles = [];
  for (const [x0, x1, y0, y1, z0, z1] of boxes) {
    const first = positions.length / 3;
    for (let i = 0; i < 8; ++i) positions.push(i & 1 ? x1 : x0, i & 4 ? z1 : z0, -(i & 2 ? y1 : y0)); // glTF has y up
    const faces = [[0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6], [4, 5, 7, 6], [2, 3, 1, 0]];
    for (const [a, b, c, d] of open ? faces.slice(0, 1) : faces) triangles.push(...[a, b, c, a, c, d].map((corner) => first + corner));
  }
  const bin = Buffer.concat([Buffer.from(Float32Array.from(positions).buffer), Buffer.from(Uint32Array.from(triangles).buffer)]);
  const bounds = (pick) => [0, 1, 2].map((k) => pick(...positions.filter((_, i) => i % 3 === k)));
  const json = JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], materials: [{ alphaMode, doubleSided: false }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }], buffers: [{ byteLength: bin.length }],
    bufferViews: [{ buffer: 0, byteLength: 4 * positions.length }, { buffer: 0, byteOffset: 4 * positions.length, byteLength: 4 * triangles.length }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3", min: bounds(Math.min), max: bounds(Math.max) },
      { bufferView: 1, componentType: 5125, count: triangles.length, type: "SCALAR" },
    ],
  });
  const text = Buffer.from(json.padEnd(Math.ceil(json.length / 4) * 4));
  const header = Buffer.alloc(20);
  [0x46546c67, 2, 28 + text.length + bin.length, text.length, 0x4e4f534a].forEach((word, i) => header.writeUInt32LE(word, 4 * i));
  const second = Buffer.alloc(8);
  [bin.length, 0x004e4942].forEach((word, i) => second.writeUInt32LE(word, 4 * i));
  return Buffer.concat([header, text, second, bin]);
}

const volume = ([x0, x1, y0, y1, z0, z1]) => ({ box: [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2, (x1 - x0) / 2, 0, 0, 0, (y1 - y0) / 2, 0, 0, 0, (z1 - z0) / 2] });

// Writes the tileset; `wall`: as glb() takes it.
export function writeTileset(folder, wall = {}) {
  fs.mkdirSync(path.join(folder, "inner"), { recursive: true });
  const tile = (name, box, { geometricError = 0, children, refine, options } = {}) => {
    fs.writeFileSync(path.join(folder, `${name}.glb`), glb([box], options));
    return { boundingVolume: volume(box), geometricError, refine, children, content: { uri: `${path.basename(name)}.glb` } };
  };
  const save = (file, root) => fs.writeFileSync(path.join(folder, file), JSON.stringify({ asset: { version: "1.0" }, geometricError: 100, root }));

  const outer = [2, 4, 8, 9, 0, 1];
  save("inner/tileset.json", { ...tile("inner/external", outer), refine: "REPLACE" });
  const tower = [-2, -1, 5, 6, 0, 6], hidden = [1, 2, 5, 6, 0, 2];
  const parent = tile("parent", [-2, 2, 5, 6, 0, 5], { geometricError: 50, children: [tile("tower", tower), tile("hidden", hidden)] });
  parent.boundingVolume = volume([-2, 2, 5, 6, 0, 6]);
  const added = tile("added", [-4, -3, 6, 7, 0, 6], { geometricError: 50, refine: "ADD", children: [tile("added_hidden", [-4, -3, 7, 8, 0, 1]), tile("added_seen", [-4, -3, 6, 7, 6, 7])] });
  added.boundingVolume = volume([-4, -3, 6, 8, 0, 7]);
  const around = tile("around", [0.2, 0.3, -9.5, -9.4, 1.1, 1.15]);
  around.boundingVolume = volume([-1, 1, -11, -9, 0, 2]);
  save("tileset.json", {
    boundingVolume: volume([-6, 6, -11, 10, 0, 8]), geometricError: 100, refine: "REPLACE",
    children: [
      tile("wall", [-5, 5, 0, 0.1, 0, 3], { options: wall }), parent, added, around, tile("front", [0, 0.5, -3, -2.5, 0, 1]),
      { boundingVolume: volume(outer), geometricError: 50, content: { uri: "inner/tileset.json" } },
    ],
  });
}
