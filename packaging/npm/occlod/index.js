// occlod in JavaScript: classes over the C interface of binding.cpp. index.d.ts describes them.
import start from "./wasm/library.js";

let module; // after ready()
let loading;
let progress;

export class OcclodError extends Error {
  name = "OcclodError";
}

export function ready(options = {}) {
  loading ??= start({
    ...(options.wasm instanceof ArrayBuffer || ArrayBuffer.isView(options.wasm) ? { wasmBinary: options.wasm } : {}),
    ...(typeof options.wasm === "string" || options.wasm instanceof URL ? { locateFile: () => String(options.wasm) } : {}),
    occlodProgress: (done) => progress?.(done) ?? true,
  }).then(
    (started) => {
      module = started;
    },
    (problem) => {
      loading = undefined;
      throw new OcclodError(`occlod: its WebAssembly cannot be started: ${problem.message ?? problem}`);
    },
  );
  return loading;
}

function library() {
  if (!module) throw new OcclodError("occlod: is not loaded yet; await ready() first");
  return module;
}

const decoder = new TextDecoder();
const encoder = new TextEncoder();

function text(pointer) {
  const { HEAPU8 } = library();
  const begin = pointer >>> 0;
  return decoder.decode(HEAPU8.subarray(begin, HEAPU8.indexOf(0, begin)));
}

// Returns the answer of a call that may fail.
function checked(answer) {
  if (!answer) throw new OcclodError(text(library()._occlod_failure()));
  return answer >>> 0;
}

// The same for a call that tells how far it is. onProgress may return false to cancel; what it throws cancels too.
function watched(onProgress, call) {
  let thrown;
  progress = onProgress && ((done) => {
    try {
      return onProgress(done) !== false;
    } catch (problem) {
      thrown = { problem };
      return false;
    }
  });
  try {
    return checked(call());
  } catch (error) {
    throw thrown ? thrown.problem : error;
  } finally {
    progress = undefined;
  }
}

// Calls use(pointer, ...) with copies of byte arrays in the memory of the module.
function withBytes(arrays, use) {
  const { _malloc, _free } = library();
  const pointers = [];
  try {
    for (const array of arrays) {
      const pointer = _malloc(Math.max(array.byteLength, 1)) >>> 0;
      if (!pointer) throw new OcclodError("memory: not enough for this; dispose of what is no longer needed");
      pointers.push(pointer);
      library().HEAPU8.set(array, pointer); // which may have grown
    }
    return use(...pointers);
  } finally {
    pointers.forEach(_free);
  }
}

function asBytes(data, what) {
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new TypeError(`${what} is no ArrayBuffer and no typed array`);
}

function addFile(name, data) {
  const bytes = asBytes(data, `the content of ${name}`);
  const cString = encoder.encode(`${name}\0`);
  withBytes([cString, bytes], (namePointer, pointer) => checked(library()._occlod_add_file(namePointer, pointer, bytes.length)));
}

const withName = (name, use) => withBytes([encoder.encode(`${name}\0`)], use);
const baseName = (name) => name.replace(/^.*[/\\]/, "");

// A view of an array in the memory of the module, which the next call may move: callers copy what they keep.
function view(Type, answer) {
  const { HEAPU8 } = library();
  const [data, size] = new Uint32Array(HEAPU8.buffer, checked(answer), 2);
  return new Type(HEAPU8.buffer, size === 0 ? 0 : data, size / Type.BYTES_PER_ELEMENT);
}

const copy = (Type, answer) => view(Type, answer).slice();
const numbers = () => new Float64Array(library().HEAPU8.buffer, library()._occlod_numbers() >>> 0, 40);

const defaultCamera = { up: [0, 1, 0], fovY: 45, width: 1024, height: 768, near: 0.01, far: 100, orthographicHeight: NaN };
const clipDepths = { "-1..1": 0, "0..1": 1, "1..0": 2 };

function setCamera(camera) {
  if (camera.worldToEye) {
    const depth = clipDepths[camera.clipDepth ?? "-1..1"];
    if (depth === undefined) throw new TypeError(`clipDepth is ${camera.clipDepth}: give "-1..1", "0..1" or "1..0"`);
    numbers().set([1, ...camera.worldToEye, ...camera.eyeToClip, camera.width, camera.height, depth]);
    return;
  }
  const c = { ...defaultCamera, ...camera };
  numbers().set([0, ...c.eye, ...c.target, ...c.up, c.fovY, c.width, c.height, c.near, c.far, c.orthographicHeight]);
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

// An object in the memory of the module. Memory that is not given back by dispose() is when the object is collected.
class Owned {
  static #forgotten = new FinalizationRegistry(({ pointer, free }) => free(pointer));
  #pointer;
  #free;
  constructor(pointer, free) {
    this.#pointer = pointer;
    this.#free = free;
    Owned.#forgotten.register(this, { pointer, free }, this);
  }
  get pointer() {
    if (!this.#pointer) throw new OcclodError(`${this.constructor.name}: has been disposed of`);
    return this.#pointer;
  }
  dispose() {
    if (!this.#pointer) return;
    Owned.#forgotten.unregister(this);
    this.#free(this.#pointer);
    this.#pointer = 0;
  }
}

// What cut() and simplify() have to reach.
function target({ triangles, error }, what) {
  if ((triangles === undefined) === (error === undefined)) throw new TypeError(`${what}: give either triangles or error`);
  if (triangles !== undefined && !(Number.isInteger(triangles) && triangles > 0 && triangles < 2 ** 32))
    throw new TypeError(`${what}: triangles is ${triangles}, no whole number from 1 on`);
  return [triangles ?? 0, error ?? 0];
}

export class Mesh {
  #owned;
  constructor(pointer) {
    this.#owned = new Owned(pointer, library()._occlod_free_mesh);
  }

  static read(name, data, { others = {}, onProgress } = {}) {
    for (const [other, content] of Object.entries(others)) addFile(baseName(other), content);
    addFile(baseName(name), data);
    return new Mesh(withName(baseName(name), (pointer) => watched(onProgress, () => library()._occlod_read_mesh(pointer))));
  }

  static of({ positions, triangles }) {
    const arrays = [Float32Array.from(positions), Uint32Array.from(triangles)];
    if (arrays[0].length % 3 || arrays[1].length % 3) throw new TypeError("Mesh.of: positions and triangles have three numbers each");
    return new Mesh(
      withBytes(arrays.map(asBytes), (p, t) => checked(library()._occlod_make_mesh(p, arrays[0].length / 3, t, arrays[1].length / 3))),
    );
  }

  get triangleCount() {
    return library()._occlod_mesh_triangle_count(this.#owned.pointer) >>> 0;
  }
  get positions() {
    return copy(Float32Array, library()._occlod_mesh_positions(this.#owned.pointer));
  }
  get triangles() {
    return copy(Uint32Array, library()._occlod_mesh_triangles(this.#owned.pointer));
  }

  simplify(options) {
    const [triangles, error] = target(options, "simplify");
    return new Mesh(watched(options.onProgress, () => library()._occlod_simplify(this.#owned.pointer, triangles, error)));
  }

  build({ onProgress } = {}) {
    return new Hierarchy(watched(onProgress, () => library()._occlod_build(this.#owned.pointer)));
  }

  write(format) {
    if (!["glb", "ply", "stl", "off"].includes(format)) throw new TypeError(`write: there is no format ${format}: give "glb", "ply", "stl" or "off"`);
    return withName(`mesh.${format}`, (name) => copy(Uint8Array, library()._occlod_write_mesh(this.#owned.pointer, name)));
  }

  dispose() {
    this.#owned.dispose();
  }
}

export class Hierarchy {
  #owned;
  #facts;
  constructor(pointer) {
    this.#owned = new Owned(pointer, library()._occlod_free_hierarchy);
    library()._occlod_hierarchy_facts(pointer);
    this.#facts = [...numbers().subarray(0, 13)];
  }

  // For Refiner.
  get pointer() {
    return this.#owned.pointer;
  }

  static read(data) {
    addFile("hierarchy.olod", data);
    return new Hierarchy(withName("hierarchy.olod", (name) => checked(library()._occlod_read_hierarchy(name))));
  }

  write({ compressed = true } = {}) {
    return copy(Uint8Array, library()._occlod_write_hierarchy(this.pointer, compressed));
  }

  get triangleCount() {
    return this.#facts[0];
  }
  get baseTriangleCount() {
    return this.#facts[1];
  }
  get errorBound() {
    return this.#facts[2];
  }
  get box() {
    return { min: this.#facts.slice(3, 6), max: this.#facts.slice(6, 9) };
  }
  get origin() {
    return this.#facts.slice(9, 12);
  }
  get up() {
    return this.#facts[12] ? "y" : "z";
  }
  get positions() {
    return copy(Float32Array, library()._occlod_hierarchy_positions(this.pointer));
  }
  get normals() {
    return copy(Float32Array, library()._occlod_hierarchy_normals(this.pointer));
  }
  get colors() {
    return copy(Uint8Array, library()._occlod_hierarchy_colors(this.pointer));
  }

  lookingAt(camera = {}) {
    const given = { ...defaultCamera, ...camera };
    setCamera({ ...given, eye: [0, 0, 3], target: [0, 0, 0] });
    checked(library()._occlod_look_at(this.pointer));
    const [, ...n] = numbers();
    return { ...given, eye: n.slice(0, 3), target: n.slice(3, 6), near: n[12], far: n[13] };
  }

  cut(options) {
    const [triangles, error] = target(options, "cut");
    return new Mesh(checked(library()._occlod_cut(this.pointer, triangles, error)));
  }

  dispose() {
    this.#owned.dispose();
  }
}

const statNames = ["triangles", "changedTriangles", "queries", "queriesHidden", "maxErrorPx", "maxQuadricErrorPx", "levelPx", "refineMs", "occlusionMs"];

export class Refiner {
  #owned;
  #objects;
  #refined = false;
  constructor(objects) {
    this.#objects = [objects].flat().map((object) => (object instanceof Hierarchy ? { hierarchy: object } : object));
    const pointer = library()._occlod_new_refiner() >>> 0;
    this.#owned = new Owned(pointer, library()._occlod_free_refiner);
    for (const { hierarchy, transform = identity, twoSided = false } of this.#objects) {
      numbers().set(transform);
      library()._occlod_add_object(pointer, hierarchy.pointer, twoSided);
    }
    checked(library()._occlod_start_refiner(pointer));
  }

  setTransform(object, transform) {
    numbers().set(transform);
    checked(library()._occlod_set_transform(this.#owned.pointer, object));
  }

  #run(goingOn, camera, { budget = 10000, tolerancePx = 0, occlusion = true, conservative = false } = {}) {
    setCamera(camera);
    this.#refined = false;
    checked(library()._occlod_refine(this.#owned.pointer, goingOn, occlusion, conservative, budget, tolerancePx));
    this.#refined = true;
    const given = numbers();
    return Object.fromEntries(statNames.map((name, i) => [name, given[i]]));
  }
  refine(camera, options) {
    return this.#run(false, camera, options);
  }
  update(camera, options) {
    return this.#run(true, camera, options);
  }

  // The pointer, once there is something to read.
  #result(object = 0) {
    if (!this.#refined) throw new OcclodError("Refiner: nothing has been refined yet; call refine() or update() first");
    if (!(object in this.#objects)) throw new OcclodError(`Refiner: there is no object ${object}; there are ${this.#objects.length}`);
    return this.#owned.pointer;
  }
  triangles(object = 0) {
    return view(Uint32Array, library()._occlod_triangles(this.#result(object), object));
  }
  changes(object = 0) {
    return view(Uint32Array, library()._occlod_changes(this.#result(object), object));
  }
  get hash() {
    return text(library()._occlod_hash(this.#result()));
  }
  seen(camera) {
    setCamera(camera);
    return copy(Uint8Array, library()._occlod_seen(this.#result()));
  }

  dispose() {
    this.#owned.dispose();
    this.#refined = false;
  }
}

const meshArrays = { positions: [0, Float32Array], normals: [1, Float32Array], indices: [2, Uint16Array], colors: [3, Uint16Array], slides: [4, Float32Array] };

export class Hlod {
  #owned;
  #facts;
  #open = false;
  constructor(name, byteLength) {
    const pointer = withName(name, (name) => checked(library()._occlod_new_hlod(name, byteLength)));
    this.#owned = new Owned(pointer, library()._occlod_free_hlod);
  }

  static read(name, data, { memory = 2 ** 30 } = {}) {
    const bytes = asBytes(data, `the content of ${name}`);
    const hlod = new Hlod(name, bytes.length);
    try {
      hlod.put(0, bytes);
      hlod.#openWith(memory, true);
    } catch (error) {
      hlod.dispose();
      throw error;
    }
    return hlod;
  }

  put(offset, data) {
    const bytes = asBytes(data, "what was put");
    withBytes([bytes], (pointer) => checked(library()._occlod_put(this.#owned.pointer, offset, pointer, bytes.length)));
  }

  #openWith(memory, whole) {
    if (this.#open) return [];
    const ends = copy(Float64Array, library()._occlod_open_hlod(this.#owned.pointer, memory, whole));
    if (!ends.length) {
      this.#open = true;
      library()._occlod_hlod_facts(this.#owned.pointer);
      this.#facts = [...numbers().subarray(0, 15)];
    }
    return Array.from({ length: ends.length / 2 }, (_, i) => [ends[2 * i], ends[2 * i + 1]]);
  }
  open({ memory = 2 ** 28 } = {}) {
    return this.#openWith(memory, false);
  }

  // The pointer of a file that is open.
  get #pointer() {
    if (!this.#open) throw new OcclodError("Hlod: is not open yet; put what open() asks for");
    return this.#owned.pointer;
  }
  #fact(i) {
    return this.#pointer && this.#facts[i];
  }

  get triangleCount() {
    return this.#fact(0);
  }
  get nodeCount() {
    return this.#fact(1);
  }
  get levelCount() {
    return this.#fact(2);
  }
  get box() {
    return this.#pointer && { min: this.#facts.slice(3, 6), max: this.#facts.slice(6, 9) };
  }
  get origin() {
    return this.#pointer && this.#facts.slice(9, 12);
  }
  get up() {
    return this.#fact(12) ? "y" : "z";
  }
  get hasNormals() {
    return Boolean(this.#fact(13));
  }
  get hasColors() {
    return Boolean(this.#fact(14));
  }

  setTransform(transform) {
    numbers().set(transform);
    checked(library()._occlod_place_hlod(this.#pointer));
  }

  select(camera, { tolerancePx = 1, budget = 0, occlusion = true, geomorph = false, slackPx = 0 } = {}) {
    setCamera(camera);
    checked(library()._occlod_select(this.#pointer, tolerancePx, budget, occlusion, geomorph, slackPx));
    const [triangles, tolerance, largestErrorPx, hidden, missing] = numbers();
    return { triangles, tolerancePx: tolerance, largestErrorPx, hidden, missing, hash: text(library()._occlod_front_hash()) };
  }

  get selected() {
    const words = view(Uint32Array, library()._occlod_selected(this.#pointer));
    const morphs = new Float32Array(words.buffer, words.byteOffset, words.length);
    const nodes = [];
    for (let at = 0; at < words.length; ) {
      const node = { node: words[at], ranges: [] };
      for (let count = words[at + 1], i = (at += 2); at < i + 3 * count; at += 3)
        node.ranges.push({ first: words[at], count: words[at + 1], morph: morphs[at + 2] });
      nodes.push(node);
    }
    return nodes;
  }

  mesh(node, what = ["positions", "normals", "indices"]) {
    if (!(node >= 0 && node < this.nodeCount)) throw new OcclodError(`Hlod: there is no node ${node}; there are ${this.nodeCount}`);
    const mesh = {};
    for (const name of what) {
      if (!meshArrays[name]) throw new TypeError(`mesh: there is no array ${name}`);
      const [number, Type] = meshArrays[name];
      mesh[name] = copy(Type, library()._occlod_node_mesh(this.#pointer, node, number));
    }
    return mesh;
  }
  patches(node) {
    return copy(Uint32Array, library()._occlod_node_patches(this.#pointer, node));
  }

  nextRequest() {
    if (!library()._occlod_next_request(this.#pointer)) return undefined;
    const [id, begin, end, again] = numbers();
    return { id, begin, end, again: Boolean(again) };
  }
  arrive(id, data) {
    const bytes = asBytes(data, "what has arrived");
    withBytes([bytes], (pointer) => checked(library()._occlod_arrive(this.#pointer, id, pointer, bytes.length)));
  }
  lose(id) {
    library()._occlod_lose(this.#pointer, id);
  }
  fail(id, problem) {
    withName(problem, (text) => library()._occlod_fail(this.#pointer, id, text));
  }
  takeCancelled() {
    return [...view(Uint32Array, library()._occlod_cancelled(this.#pointer))];
  }
  takeFailures() {
    return text(library()._occlod_node_failures(this.#pointer)).split("\n").filter(Boolean);
  }

  get store() {
    library()._occlod_store_stats(this.#pointer);
    const [residentBytes, residentNodes, loadingBytes, budgetBytes, failed, loads, bytesLoaded, evictions] = numbers();
    return { residentBytes, residentNodes, loadingBytes, budgetBytes, failed, loads, bytesLoaded, evictions };
  }

  dispose() {
    this.#owned.dispose();
    this.#open = false;
  }
}

export const version = () => text(library()._occlod_version());
export const memoryBytes = () => library().HEAPU8.byteLength;
