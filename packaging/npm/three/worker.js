// Streams an .ohlod file and selects what to draw of it. Messages in: {open}, {wasm}, {frame}; out: {opened} or {failed}, {arrived},
// and {selection} or {missed} as the answer to each {frame}. Meshes go along with the first selection that has them; a frame
// names those that are no longer held.
import "../../occlod/calls.js"; // named, so that they are fetched along with what imports them
import "../../occlod/wasm/hlod.js";
import { ready } from "../../occlod/hlod.js";
import { HlodStream } from "./stream.js";

let stream;
let arrays; // that meshes need
const held = new Set(); // nodes whose meshes the other side has
let takeWasm;
const wasm = new Promise((taken) => (takeWasm = taken));

async function open({ url, ...options }) {
  stream = new HlodStream(url, { ...options, ready: wasm.then((wasm) => ready({ wasm })), onArrival: () => postMessage({ arrived: true }) });
  const hlod = await stream.open();
  const { triangleCount, nodeCount, box, origin, up, hasNormals, hasColors } = hlod;
  arrays = ["positions", "indices", ...(hasNormals ? ["normals"] : []), ...(hasColors ? ["colors"] : []), ...(options.geomorph ? ["slides"] : [])];
  postMessage({ opened: { triangleCount, nodeCount, box, origin, up, hasNormals, hasColors } });
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

function answer({ camera, transform, dropped, options }) {
  const { hlod } = stream;
  for (const node of dropped) held.delete(node);
  hlod.setTransform(transform);
  const stats = hlod.select(camera, options);
  const nodes = [];
  const meshes = [];
  for (const [node, ranges] of partsOf(hlod.selected)) {
    const patches = options.geomorph ? [...hlod.patches(node)] : [];
    nodes.push({ node, ranges, shares: sharesOf(patches, ranges) });
    if (!held.has(node)) meshes.push({ node, ...hlod.mesh(node, arrays), patchCount: patches.length });
  }
  for (const { node } of meshes) held.add(node);
  stream.pump();
  const store = hlod.store;
  const failures = hlod.takeFailures();
  const transfer = meshes.flatMap((mesh) => Object.values(mesh).filter(ArrayBuffer.isView).map((array) => array.buffer));
  postMessage({ selection: { nodes, meshes, stats, store, failures, counts: stream.counts, isWaiting: stream.isWaiting } }, transfer);
}

self.onmessage = async ({ data }) => {
  try {
    if (data.open) await open(data.open);
    else if (data.wasm) takeWasm(data.wasm);
    else answer(data.frame);
  } catch (error) {
    postMessage(data.open ? { failed: error.message } : { missed: error.message });
  }
};
