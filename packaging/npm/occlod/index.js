// occlod in JavaScript: classes over the C interface of binding.cpp. index.d.ts describes them.
import { OcclodError, Owned, asBytes, connect, defaultCamera, placeOf } from "./calls.js";
import start from "./wasm/library.js";

let progress;
const { ready, library, text, checked, withBytes, withName, view, copy, numbers, setCamera } = connect(start, { occlodProgress: (done) => progress?.(done) ?? true });
export { OcclodError, ready };

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

function addFile(name, data) {
  const bytes = asBytes(data, `the content of ${name}`);
  withName(name, (namePointer) => withBytes([bytes], (pointer) => checked(library()._occlod_add_file(namePointer, pointer, bytes.length))));
}

const baseName = (name) => name.replace(/^.*[/\\]/, "");

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

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
    return placeOf(this.#facts).box;
  }
  get origin() {
    return placeOf(this.#facts).origin;
  }
  get up() {
    return placeOf(this.#facts).up;
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

export const version = () => text(library()._occlod_version());
export const memoryBytes = () => library().HEAPU8.byteLength;
