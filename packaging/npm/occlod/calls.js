// What classes over the C interface of a module share: binding.h.
export class OcclodError extends Error {
  name = "OcclodError";
}

export function asBytes(data, what) {
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new TypeError(`${what} is no ArrayBuffer and no typed array`);
}

export const defaultCamera = { up: [0, 1, 0], fovY: 45, width: 1024, height: 768, near: 0.01, far: 100, orthographicHeight: NaN };
const clipDepths = { "-1..1": 0, "0..1": 1, "1..0": 2 };

// What places a mesh: facts as tell_place() of binding.h puts them behind three others.
export const placeOf = (facts) => ({ box: { min: facts.slice(3, 6), max: facts.slice(6, 9) }, origin: facts.slice(9, 12), up: facts[12] ? "y" : "z" });

const decoder = new TextDecoder();
const encoder = new TextEncoder();

// An object in the memory of the module. Memory that is not given back by dispose() is when the object is collected.
export class Owned {
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

// What Emscripten's start() is told of a module that is compiled, bytes, or an address.
function where(wasm) {
  if (wasm instanceof WebAssembly.Module) return { instantiateWasm: (imports, done) => done(new WebAssembly.Instance(wasm, imports), wasm) };
  if (wasm instanceof ArrayBuffer || ArrayBuffer.isView(wasm)) return { wasmBinary: wasm };
  return wasm === undefined ? {} : { locateFile: () => String(wasm) };
}

// The calls of the module that `start` loads. `api`: what it is given.
export function connect(start, api = {}) {
  let module; // after ready()
  let loading;

  function ready(options = {}) {
    loading ??= start({
      ...where(options.wasm),
      ...api,
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

  const withName = (name, use) => withBytes([encoder.encode(`${name}\0`)], use);

  // A view of an array in the memory of the module, which the next call may move: callers copy what they keep.
  function view(Type, answer) {
    const { HEAPU8 } = library();
    const [data, size] = new Uint32Array(HEAPU8.buffer, checked(answer), 2);
    return new Type(HEAPU8.buffer, size === 0 ? 0 : data, size / Type.BYTES_PER_ELEMENT);
  }

  const copy = (Type, answer) => view(Type, answer).slice();
  const numbers = () => new Float64Array(library().HEAPU8.buffer, library()._occlod_numbers() >>> 0, 40);

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

  return { ready, library, text, checked, withBytes, withName, view, copy, numbers, setCamera };
}
