// Streams an .ohlod file and selects what to draw of it. Messages in: {open}, {wasm}, {frame}; out: {opened} or {failed}, {arrived},
// and {selection} or {missed} as the answer to each {frame}. Meshes and images go along with the first selection that has
// them; a frame names nodes that are no longer held.
import "../../occlod/calls.js"; // named, so that they are fetched along with what imports them
import "../../occlod/wasm/hlod.js";
import { ready } from "../../occlod/hlod.js";
import { NodeImages } from "./node_images.js";
import { HlodStream } from "./stream.js";

let stream;
let arrays; // that meshes need
let images; // where nodes have their own
const badImages = []; // lines, since the last answer
const held = new Set(); // nodes whose meshes the other side has
let takeWasm;
const wasm = new Promise((taken) => (takeWasm = taken));

// `memory`: of meshes; `meshMemory` and `imageMemory`: of both where nodes have images.
async function open({ url, imageMemory, meshMemory, ...options }) {
  stream = new HlodStream(url, { ...options, ready: wasm.then((wasm) => ready({ wasm })), onArrival: () => postMessage({ arrived: true }) });
  const hlod = await stream.open();
  const { triangleCount, nodeCount, box, origin, up, hasNormals, hasColors, hasImages } = hlod;
  arrays = ["positions", "indices", ...(hasNormals ? ["normals"] : []), ...(hasColors ? ["colors"] : []), ...(options.geomorph ? ["slides"] : [])];
  if (hasImages) {
    hlod.memory = meshMemory;
    arrays.push("imageCoordinates");
    images = new NodeImages({
      limit: imageMemory,
      read: (node) => hlod.mesh(node, ["image"]).image,
      fail: (node) => badImages.push(`${stream.name}: image of node ${node}: is neither a PNG nor a JPEG that can be decoded; build the file again`),
    });
  }
  postMessage({ opened: { triangleCount, nodeCount, box, origin, up, hasNormals, hasColors, hasImages } });
}

// The parts of a node that are drawn; a node that was selected twice has them all.
function partsOf(selected) {
  const parts = new Map();
  for (const { node, ranges } of selected) parts.get(node)?.push(...ranges) ?? parts.set(node, ranges);
  return parts;
}

// How far vertices of each patch have slid.
function sharesOf(patches, ranges) {
  return patches.map((first) => ranges.find((range) => range.first <= first && first < range.first + range.count)?.morph ?? 0);
}

// Parts of a node that show its image, or not. `firsts`, `ends`: of each patch, and of its triangles that do.
function divided(ranges, firsts, ends) {
  const parts = [];
  const add = (first, end, isPlain) => {
    const last = parts.at(-1);
    if (last && last.isPlain === isPlain && last.first + last.count === first) last.count = end - last.first;
    else if (end > first) parts.push({ first, count: end - first, isPlain });
  };
  for (const { first, count } of ranges)
    for (let i = firsts.indexOf(first); i < firsts.length && firsts[i] < first + count; ++i) {
      add(firsts[i], ends[i], false);
      add(ends[i], Math.min(firsts[i + 1] ?? Infinity, first + count), true);
    }
  return parts;
}

async function answer({ camera, transform, dropped, options }) {
  const { hlod } = stream;
  for (const node of dropped) held.delete(node);
  images?.drop(dropped);
  hlod.setTransform(transform);
  const stats = hlod.select(camera, options);
  const nodes = [];
  const meshes = [];
  for (const [node, ranges] of partsOf(hlod.selected)) {
    const patches = options.geomorph || images ? [...hlod.patches(node)] : [];
    const ends = images ? hlod.imageEnds(node) : [];
    nodes.push({ node, ranges: ends.length ? divided(ranges, patches, ends) : ranges, shares: options.geomorph ? sharesOf(patches, ranges) : [] });
    if (!held.has(node)) meshes.push({ node, ...hlod.mesh(node, arrays), patchCount: patches.length });
  }
  for (const { node } of meshes) held.add(node);
  stream.pump();
  const pictures = images ? await images.of(nodes.map(({ node }) => node)) : [];
  const store = hlod.store;
  const failures = [...hlod.takeFailures(), ...badImages.splice(0)];
  const transfer = meshes.flatMap((mesh) => Object.values(mesh).filter(ArrayBuffer.isView).map((array) => array.buffer));
  transfer.push(...pictures.map(({ image }) => image));
  postMessage({ selection: { nodes, meshes, pictures, stats, store, failures, counts: stream.counts, isWaiting: stream.isWaiting } }, transfer);
}

self.onmessage = async ({ data }) => {
  try {
    if (data.open) await open(data.open);
    else if (data.wasm) takeWasm(data.wasm);
    else await answer(data.frame);
  } catch (error) {
    postMessage(data.open ? { failed: error.message } : { missed: error.message });
  }
};
