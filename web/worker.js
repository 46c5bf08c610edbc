// Reads and builds what is dropped, and refines it for each camera. Messages in: {open}, {refine}; out: {progress}, {opened},
// {refined}, {failed}, in the order of the questions.
import { Hierarchy, Mesh, Refiner, ready } from "./occlod/index.js";

let hierarchy;
let refiner;

function close() {
  refiner?.dispose();
  hierarchy?.dispose();
  refiner = hierarchy = undefined;
}

function build(name, data, others) {
  if (/\.olod$/i.test(name)) return Hierarchy.read(data);
  const tell = (what) => (done) => postMessage({ progress: { what, done } });
  const mesh = Mesh.read(name, data, { others, onProgress: tell("reading") });
  try {
    return mesh.build({ onProgress: tell("building") });
  } finally {
    mesh.dispose();
  }
}

function open({ name, data, others }) {
  close();
  hierarchy = build(name, data, others);
  refiner = new Refiner(hierarchy);
  const { positions, colors, box, origin, triangleCount, baseTriangleCount } = hierarchy;
  const camera = hierarchy.lookingAt();
  postMessage({ opened: { name, positions, colors, box, origin, triangleCount, baseTriangleCount, camera } }, [positions.buffer, colors.buffer]);
}

function refine({ camera, options, seen }) {
  if (!refiner) return;
  const stats = refiner.update(camera, { ...options, budget: Math.max(options.budget, hierarchy.baseTriangleCount) });
  const refined = { camera, stats, hash: refiner.hash, triangles: refiner.triangles().slice(), seen: seen ? refiner.seen(camera) : undefined };
  postMessage({ refined }, [refined.triangles.buffer]);
}

self.onmessage = async ({ data }) => {
  try {
    await ready();
    if (data.open) open(data.open);
    else refine(data.refine);
  } catch (error) {
    close();
    postMessage({ failed: error.message });
  }
};
