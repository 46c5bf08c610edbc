// Software occlusion of meshes that a page has loaded: a class over the C interface of occlusion_binding.cpp.
import start from "./wasm/occlusion.js";

let module; // after loadOcclusion()
let loading;
let meshChanges = 0;

// Loads the WebAssembly. `wasm`: where wasm/occlusion.wasm is, or its bytes, when it does not lie beside this script.
export function loadOcclusion(wasm) {
  loading ??= start({
    ...(wasm instanceof ArrayBuffer || ArrayBuffer.isView(wasm) ? { wasmBinary: wasm } : {}),
    ...(typeof wasm === "string" || wasm instanceof URL ? { locateFile: () => String(wasm) } : {}),
  }).then(
    (started) => {
      module = started;
    },
    (problem) => {
      loading = undefined;
      throw new Error(`@occlod/three: its WebAssembly cannot be started: ${problem.message ?? problem}`);
    },
  );
  return loading;
}

function failure() {
  const begin = module._occlusion_failure() >>> 0;
  return new Error(new TextDecoder().decode(module.HEAPU8.subarray(begin, module.HEAPU8.indexOf(0, begin))));
}

// Room for `count` numbers in the memory of the module, until the next call into it.
function numbers(count) {
  const pointer = module._occlusion_numbers(count) >>> 0;
  return new Float64Array(module.HEAPU8.buffer, pointer, count);
}

// A copy of a mesh in the memory of the module; a pointer. `side` is that of a material of three.js.
export function addMesh(positions, triangles, side) {
  const bytes = [positions, triangles].map((array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  const pointers = bytes.map((array) => module._malloc(Math.max(array.length, 1)) >>> 0);
  try {
    if (pointers.includes(0)) throw new Error("@occlod/three: not enough memory for occluders");
    bytes.forEach((array, i) => module.HEAPU8.set(array, pointers[i]));
    const mesh = module._occlusion_add_mesh(pointers[0], positions.length / 3, pointers[1], triangles.length / 3, side) >>> 0;
    if (!mesh) throw failure();
    ++meshChanges;
    return mesh;
  } finally {
    pointers.forEach((pointer) => module._free(pointer));
  }
}

export function freeMesh(mesh) {
  ++meshChanges;
  module._occlusion_free_mesh(mesh);
}

// What hides what, seen by one camera.
export class Sight {
  #pointer = module._occlusion_new() >>> 0;
  #drawn = new Float64Array(0);
  #changes = 0;

  // Draws occluders, unless they are those of the last call, seen as then. `all`: of the camera 35 numbers, which are two
  // matrices, the size in pixels and the range of depths in clip space; then 17 of each occluder, its mesh and its transform.
  // Returns the number of triangles drawn, 0 where nothing has changed. Throws where the matrices are of no camera.
  draw(all) {
    if (this.#changes === meshChanges && all.length === this.#drawn.length && all.every((value, i) => value === this.#drawn[i])) return 0;
    this.#drawn = new Float64Array(0);
    numbers(all.length).set(all);
    const count = module._occlusion_draw(this.#pointer, (all.length - 35) / 17) >>> 0;
    if (count === 0) throw failure();
    this.#drawn = all;
    this.#changes = meshChanges;
    return count - 1;
  }

  // Whether something in the hull of 8 points, 24 coordinates, may be seen in the view of the last draw().
  showsHull(points) {
    numbers(24).set(points);
    return Boolean(module._occlusion_shows_hull(this.#pointer, 8));
  }
  showsSphere(x, y, z, radius) {
    numbers(24).set([x, y, z, radius]);
    return Boolean(module._occlusion_shows_sphere(this.#pointer));
  }

  dispose() {
    module._occlusion_free(this.#pointer);
    this.#pointer = 0;
  }
}
