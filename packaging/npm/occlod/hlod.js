// HLODs in JavaScript: a class over the C interface of hlod_binding.cpp. hlod.d.ts describes it.
import { OcclodError, Owned, asBytes, connect, placeOf } from "./calls.js";
import start from "./wasm/hlod.js";

const { ready, library, text, checked, withBytes, withName, view, copy, numbers, setCamera } = connect(start);
export { OcclodError, ready };

const meshArrays = { positions: [0, Float32Array], normals: [1, Float32Array], indices: [2, Uint16Array], colors: [3, Uint16Array], slides: [4, Float32Array], image: [5, Uint8Array], imageCoordinates: [6, Uint16Array] };

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
      this.#facts = [...numbers().subarray(0, 16)];
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
    return this.#pointer && placeOf(this.#facts).box;
  }
  get origin() {
    return this.#pointer && placeOf(this.#facts).origin;
  }
  get up() {
    return this.#pointer && placeOf(this.#facts).up;
  }
  get hasNormals() {
    return Boolean(this.#fact(13));
  }
  get hasColors() {
    return Boolean(this.#fact(14));
  }
  get hasImages() {
    return Boolean(this.#fact(15));
  }

  set memory(bytes) {
    checked(library()._occlod_limit_hlod(this.#pointer, bytes));
  }

  setTransform(transform) {
    numbers().set(transform);
    checked(library()._occlod_place_hlod(this.#pointer));
  }

  select(camera, { tolerancePx = 1, budget = 0, occlusion = true, geomorph = false, slackPx = 0, prefetchFrames = 0 } = {}) {
    setCamera(camera);
    checked(library()._occlod_select(this.#pointer, tolerancePx, budget, occlusion, geomorph, slackPx, prefetchFrames));
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

  imageEnds(node) {
    return copy(Uint32Array, library()._occlod_image_ends(this.#pointer, node));
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

export const memoryBytes = () => library().HEAPU8.byteLength;
