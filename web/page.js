// The page: what is dropped goes to the worker, which refines it for every frame; what comes back is drawn.
import { Orbit, frustum, viewOf } from "./camera.js";
import { Drawing } from "./drawing.js";

const element = (id) => document.getElementById(id);
const canvas = element("canvas");
const words = ["visible", "hidden, or smaller than a pixel", "facing away", "off screen"];
const colors = ["#eeae5c", "#3e609e", "#805c94", "#70767e"];
const meshName = /\.(ply|obj|stl|off|gltf|glb|olod)$/i;

let worker;
let drawing;
let mesh; // what the worker has opened
let orbit;
let last; // what the worker has refined
let asked; // the question that it has not answered
let wanted = ""; // the last question, as text: asked again only when it changes
let redraw = true;

// For tests: every refinement so far, and what went wrong.
window.occlod = { refined: [], failure: undefined };

function tell(text) {
  element("told").textContent = text;
}

function fail(message) {
  window.occlod.failure = message;
  element("progress").hidden = true;
  element("invitation").hidden = Boolean(mesh);
  tell(message);
}

const budget = () => Math.round(10 ** Number(element("budget").value));

async function open(files) {
  const main = files.find((file) => meshName.test(file.name));
  if (!main) return fail(`${files[0]?.name ?? "this"}: is no mesh; drop a PLY, OBJ, STL, OFF, glTF or GLB file`);
  const others = {};
  for (const file of files) if (file !== main) others[file.name] = await file.arrayBuffer();
  const data = await main.arrayBuffer();
  mesh = orbit = last = asked = undefined;
  wanted = "";
  window.occlod.refined = [];
  window.occlod.failure = undefined;
  element("invitation").hidden = true;
  element("freeze").checked = false;
  worker?.terminate(); // whatever it does
  worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data }) => hear(data);
  worker.onerror = (event) => fail(`the worker ended: ${event.message ?? "out of memory"}`);
  worker.postMessage({ open: { name: main.name, data, others } }, [data]);
}

function hear({ progress, opened, refined, failed }) {
  if (failed) {
    mesh = orbit = undefined;
    return fail(failed);
  }
  if (progress) {
    element("progress").hidden = false;
    element("progress").value = progress.done;
    tell(`${progress.what}: ${Math.round(100 * progress.done)} %`);
  }
  if (opened) {
    element("progress").hidden = true;
    mesh = opened;
    orbit = new Orbit(opened.camera, opened.box);
    drawing.setVertices(opened.positions, opened.colors);
  }
  if (refined) {
    asked = undefined;
    last = refined;
    const { hash, camera, stats } = refined;
    window.occlod.refined.push({ hash, camera, stats });
    if (window.occlod.refined.length > 10000) window.occlod.refined.shift();
    drawing.setTriangles(refined.triangles, refined.seen);
    redraw = true;
    show(refined);
  }
}

function show({ stats, seen, hash }) {
  const { triangles, queries, queriesHidden } = stats;
  const lines = [
    `${mesh.name}: ${mesh.triangleCount.toLocaleString("en")} triangles`,
    `drawn ${triangles.toLocaleString("en")}, error left ${stats.maxQuadricErrorPx.toFixed(2)} px`,
    `${(stats.refineMs + stats.occlusionMs).toFixed(1)} ms; ${queriesHidden} of ${queries} queries hidden`,
    `hash ${hash}`,
  ];
  tell(lines.join("\n"));
  element("legend").style.display = seen ? "block" : "none";
  if (!seen) return;
  const counts = [0, 0, 0, 0];
  for (const kind of seen) ++counts[kind];
  element("legend").replaceChildren(
    ...words.map((word, i) => {
      const item = document.createElement("li");
      const patch = document.createElement("span");
      patch.style.background = colors[i];
      item.append(patch, `${counts[i].toLocaleString("en")} ${word}`);
      return item;
    }),
  );
}

function resize() {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * devicePixelRatio)));
  if (canvas.width === width && canvas.height === height) return;
  [canvas.width, canvas.height] = [width, height];
  redraw = true;
}

// Asks for the camera of this frame, unless it is frozen or the worker is busy; draws when something has changed.
function frame() {
  requestAnimationFrame(frame);
  resize();
  if (!orbit) return;
  const frozen = element("freeze").checked;
  const camera = orbit.camera(canvas.width, canvas.height);
  const question = { camera: frozen && last ? last.camera : camera, options: { budget: budget(), occlusion: element("occlusion").checked }, seen: element("why").checked };
  const text = JSON.stringify(question);
  if (!asked && text !== wanted) {
    asked = wanted = text;
    worker.postMessage({ refine: question });
  }
  if (!last || !redraw) return;
  redraw = false;
  const shown = frozen ? camera : last.camera;
  const options = { origin: mesh.origin, colorBySeen: Boolean(last.seen), wires: element("wires").checked, frozen: frozen && frustum(last.camera) };
  drawing.draw(viewOf(shown, canvas.width / canvas.height), options);
}

function listen() {
  const changed = () => {
    redraw = true;
    element("triangles").textContent = budget().toLocaleString("en");
  };
  for (const id of ["budget", "occlusion", "why", "wires", "freeze"]) element(id).addEventListener("input", changed);
  changed();
  element("file").addEventListener("change", ({ target }) => open([...target.files]));
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("over");
  });
  document.addEventListener("dragleave", () => document.body.classList.remove("over"));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    open([...event.dataTransfer.files]);
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (!orbit || !event.buttons) return;
    if (event.buttons > 1 || event.shiftKey) orbit.move(event.movementX, event.movementY, canvas.clientHeight);
    else orbit.turn(event.movementX, event.movementY);
    redraw = true;
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    orbit?.zoom(Math.exp(0.001 * event.deltaY));
    redraw = true;
  }, { passive: false });
}

try {
  drawing = new Drawing(canvas);
  listen();
  frame();
} catch (error) {
  fail(error.message);
}
