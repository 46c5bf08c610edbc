// An object for three.js that shows an .ohlod file while it streams in. A worker streams, unpacks and selects; here is what
// it has selected last, which is always a whole picture without gaps. index.d.ts describes the class.
import { BufferAttribute, BufferGeometry, Group, Material, Mesh, MeshStandardMaterial, SRGBColorSpace, Sphere, Texture, Vector2, Vector3, WebGPUCoordinateSystem } from "three";
import { texelBytes } from "./node_images.js";

// Of the limit of memory, what the worker may have in meshes. A mesh here takes at most 1.25 times its bytes there, in main
// memory and again in that of the GPU, and two selections may be here at once. With geomorphs a vertex has a target in each
// of up to four patches.
const workerShare = { plain: 1 / 6, geomorph: 1 / 24 };
// Where nodes have images, meshes have half of that, and the images of one selection this share of the limit.
const imageShare = 1 / 4;

const anisotropy = 4; // of images: surfaces are seen at any angle
const size = new Vector2();

// By address: WebAssembly that is compiled while workers start, for all objects that have the same.
const modules = new Map();

// Resolves with the module; with its address where it cannot be compiled here: the worker says why.
function moduleAt(address) {
  if (!modules.has(address))
    modules.set(address, WebAssembly.compileStreaming(fetch(address)).catch(() => (modules.delete(address), address)));
  return modules.get(address);
}

export class Ohlod extends Group {
  isOhlod = true;
  tolerancePx;
  budget;
  occlusion;
  slackPx;
  #geomorph;
  #memory;
  #material;
  #worker;
  #facts;
  #meshes = new Map(); // by node: {mesh, bytes, used}, and with an image {material}
  #bytes = 0; // of them
  #dropped = []; // nodes, since the last question
  #frame = 0;
  #asking = false; // the worker has not answered
  #asked = []; // the last question, as numbers
  #isBehind = false; // update() has seen another one since
  #arrived = false; // something, since the last question
  #last; // what the worker has answered last
  #isStill = false; // asked again, it would answer the same, unless something arrives
  #waiting = []; // of settled()

  constructor(url, options = {}) {
    super();
    const { tolerancePx = 1, budget = 0, occlusion = true, slackPx = 24, geomorph = false, memory = 512 * 2 ** 20, material, requests, stallMs, fetchOptions, wasm } = options;
    Object.assign(this, { tolerancePx, budget, occlusion, slackPx });
    this.#geomorph = geomorph;
    this.#memory = memory;
    this.#material = material;
    this.#worker = options.worker ?? new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    this.ready = new Promise((opened, failed) => {
      this.#worker.onmessage = ({ data }) => this.#hear(data, opened, failed);
      this.#worker.onerror = (event) => this.#fail(event.message ?? "the worker ended: out of memory", failed);
    });
    this.ready.catch(() => {}); // whoever awaits it hears of it
    const base = globalThis.document?.baseURI ?? globalThis.location?.href;
    const meshes = memory * (geomorph ? workerShare.geomorph : workerShare.plain);
    const limits = { memory: Math.floor(meshes), meshMemory: Math.floor(meshes / 2), imageMemory: Math.floor(memory * imageShare) };
    const open = { url: new URL(url, base).href, ...limits, geomorph, requests, stallMs, fetchOptions };
    this.#worker.postMessage({ open });
    const address = wasm ? new URL(wasm, base) : new URL("../../occlod/wasm/hlod.wasm", import.meta.url);
    moduleAt(address.href).then((wasm) => this.#worker.postMessage({ wasm }));
  }

  get material() {
    return this.#material;
  }
  get facts() {
    return this.#facts;
  }

  get stats() {
    const { stats, store, counts } = this.#last ?? {};
    const workerBytes = store ? store.residentBytes + store.loadingBytes : 0;
    return {
      triangles: stats?.triangles ?? 0,
      nodes: this.#last?.nodes.length ?? 0,
      tolerancePx: stats?.tolerancePx ?? 0,
      largestErrorPx: stats?.largestErrorPx ?? 0,
      hidden: stats?.hidden ?? 0,
      hash: stats?.hash ?? "",
      missing: stats?.missing ?? 0,
      failed: store?.failed ?? 0,
      memoryBytes: workerBytes + this.#bytes,
      bytesLoaded: counts?.bytes ?? 0,
      requests: counts?.requests ?? 0,
      lost: counts?.lost ?? 0,
      cancelled: counts?.cancelled ?? 0,
    };
  }

  get isBehind() {
    return this.#asking || this.#isBehind;
  }

  update(camera, renderer) {
    if (!this.#facts) return;
    const question = this.#question(camera, renderer);
    const isNew = question.key.some((value, i) => value !== this.#asked[i]);
    if (this.#asking) {
      this.#isBehind = isNew;
      return;
    }
    if (!isNew && this.#isStill && !this.#arrived) return;
    this.#isBehind = false;
    this.#asked = question.key;
    this.#arrived = false;
    this.#asking = true;
    this.#worker.postMessage({ frame: { ...question.frame, dropped: this.#dropped } });
    this.#dropped = [];
  }

  async settled() {
    if (!this.#isSettled()) await new Promise((done, failed) => this.#waiting.push({ done, failed }));
  }

  dispose() {
    this.#worker.terminate();
    for (const node of [...this.#meshes.keys()]) this.#drop(node);
    this.removeFromParent();
    this.#tellWaiting(new Error("Ohlod: has been disposed of"));
  }

  // The view is wider than the camera's by the pixels that it may move until the answer is drawn.
  #question(camera, renderer) {
    this.updateWorldMatrix(true, false);
    camera.updateWorldMatrix(true, false);
    renderer.getDrawingBufferSize(size);
    const { slackPx, tolerancePx, budget, occlusion } = this;
    const [width, height] = [size.x + 2 * slackPx, size.y + 2 * slackPx];
    const eyeToClip = [...camera.projectionMatrix.elements];
    for (let column = 0; column < 16; column += 4) {
      eyeToClip[column] *= size.x / width;
      eyeToClip[column + 1] *= size.y / height;
    }
    const clipDepth = camera.reversedDepth ? "1..0" : camera.coordinateSystem === WebGPUCoordinateSystem ? "0..1" : "-1..1";
    const worldToEye = [...camera.matrixWorldInverse.elements];
    [worldToEye[3], worldToEye[7], worldToEye[11], worldToEye[15]] = [0, 0, 0, 1]; // which an inverse is but for rounding
    const transform = this.#placed();
    const options = { tolerancePx, budget, occlusion, slackPx, geomorph: this.#geomorph };
    return {
      key: [...eyeToClip, ...worldToEye, ...transform, width, height, tolerancePx, budget, Number(occlusion)],
      frame: { camera: { worldToEye, eyeToClip, width, height, clipDepth }, transform, options },
    };
  }

  // From coordinates of the file, whose origin lies at that of this object, to world.
  #placed() {
    const m = [...this.matrixWorld.elements];
    const [x, y, z] = this.#facts.origin;
    for (let row = 0; row < 3; ++row) m[12 + row] -= m[row] * x + m[4 + row] * y + m[8 + row] * z;
    return m;
  }

  #hear({ opened, failed, arrived, selection, missed }, tellOpened, tellFailed) {
    if (failed) return this.#fail(failed, tellFailed);
    if (missed) return this.#miss(missed);
    if (opened) {
      this.#facts = opened;
      this.#material ??= new MeshStandardMaterial({ color: opened.hasColors ? 0xffffff : 0xcbb59a, roughness: 0.9, flatShading: !opened.hasNormals, vertexColors: opened.hasColors });
      tellOpened(this);
    }
    if (arrived) {
      if (!this.#asking && this.#last?.stats.missing === 0) return; // nothing that is drawn waits for it
      this.#arrived = true;
    }
    if (selection) this.#show(selection);
    this.dispatchEvent({ type: "change" });
  }

  #fail(message, tellFailed) {
    const error = new Error(message);
    tellFailed(error);
    this.#facts = undefined;
    this.#tellWaiting(error);
    this.dispatchEvent({ type: "error", error });
  }

  // What is drawn stays, until a camera comes that can be answered.
  #miss(message) {
    this.#asking = false;
    this.#isStill = true;
    this.dispatchEvent({ type: "failure", message });
  }

  #show(selection) {
    ++this.#frame;
    this.#asking = false;
    const before = this.#last?.stats.hash;
    const { meshes, pictures, ...last } = selection;
    this.#last = last;
    for (const { mesh } of this.#meshes.values()) mesh.visible = false;
    for (const { node } of last.nodes) {
      const held = this.#meshes.get(node);
      if (held) held.used = this.#frame;
    }
    for (const { node } of pictures) this.#takeImage(node); // one of another size
    const bytes = pictures.reduce((sum, { image }) => sum + bytesOfImage(image), 0);
    this.#makeRoom(meshes.reduce((sum, mesh) => sum + this.#bytesOf(mesh), bytes));
    for (const mesh of meshes) this.#hold(mesh);
    for (const { node, image } of pictures) this.#giveImage(node, image);
    for (const node of last.nodes) this.#draw(node);
    for (const message of last.failures) this.dispatchEvent({ type: "failure", message });
    // A frame takes over only so much of what has come: then the next one has the rest.
    const isComing = !last.isWaiting && last.store.loadingBytes > 0;
    this.#isStill = last.stats.missing > 0 ? !isComing : before === last.stats.hash;
    if (this.#isSettled()) this.#tellWaiting();
  }

  #isSettled() {
    return Boolean(this.#last) && !this.#asking && !this.#isBehind && this.#isStill && this.#last.stats.missing === 0;
  }
  #tellWaiting(error) {
    for (const { done, failed } of this.#waiting.splice(0)) error ? failed(error) : done();
  }

  // In main memory and in that of the GPU, where targets have a texture.
  #bytesOf({ positions, indices, normals, colors, imageCoordinates, slides, patchCount }) {
    const arrays = [positions, indices, normals, colors, imageCoordinates].reduce((sum, array) => sum + (array?.byteLength ?? 0), 0);
    return 2 * arrays + (slides ? (positions.length / 3) * patchCount * (12 + 16) : 0);
  }

  // Drops what is not drawn, the longest unused first, until so many bytes fit.
  #makeRoom(bytes) {
    const limit = this.#memory - (this.#last.store.residentBytes + this.#last.store.loadingBytes);
    if (this.#bytes + bytes <= limit) return;
    const unused = [...this.#meshes].filter(([, { used }]) => used < this.#frame).sort(([, a], [, b]) => a.used - b.used);
    for (const [node] of unused) {
      if (this.#bytes + bytes <= limit) return;
      this.#drop(node);
    }
  }

  #hold(given) {
    const { node, positions, indices, normals, colors, imageCoordinates, slides, patchCount } = given;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    if (normals) geometry.setAttribute("normal", new BufferAttribute(normals, 3));
    if (colors) geometry.setAttribute("color", new BufferAttribute(colors, 4, true));
    if (imageCoordinates?.length) geometry.setAttribute("uv", new BufferAttribute(imageCoordinates, 2, true));
    geometry.setIndex(new BufferAttribute(indices, 1));
    geometry.boundingSphere = sphereOf(positions);
    if (slides && patchCount > 0) {
      geometry.morphTargetsRelative = true;
      geometry.morphAttributes.position = targetsOf(slides, patchCount);
    }
    const mesh = new Mesh(geometry, this.#material);
    mesh.frustumCulled = false; // what is selected is inside
    mesh.matrixAutoUpdate = false;
    mesh.matrixWorldNeedsUpdate = true;
    mesh.name = `node ${node}`;
    this.add(mesh);
    const bytes = this.#bytesOf(given);
    this.#bytes += bytes;
    this.#meshes.set(node, { mesh, bytes, used: this.#frame });
  }

  #giveImage(node, image) {
    const held = this.#meshes.get(node);
    const texture = new Texture(image);
    texture.colorSpace = SRGBColorSpace;
    texture.flipY = false;
    texture.anisotropy = anisotropy;
    texture.needsUpdate = true;
    held.material = withMap(this.#material, texture);
    held.bytes += bytesOfImage(image);
    this.#bytes += bytesOfImage(image);
  }

  // Frees the image of a node that may be held.
  #takeImage(node) {
    const held = this.#meshes.get(node);
    if (!held?.material) return;
    const { map } = held.material;
    held.bytes -= bytesOfImage(map.image);
    this.#bytes -= bytesOfImage(map.image);
    held.material.dispose();
    map.dispose();
    map.image.close();
    held.material = undefined;
  }

  #draw({ node, ranges, shares }) {
    const { mesh, material = this.#material } = this.#meshes.get(node);
    mesh.visible = true;
    mesh.geometry.clearGroups();
    const materials = [material, this.#material];
    const isOne = ranges.length === 1;
    mesh.material = isOne ? materials[Number(ranges[0].isPlain ?? false)] : materials;
    mesh.geometry.setDrawRange(isOne ? ranges[0].first : 0, isOne ? ranges[0].count : Infinity);
    if (!isOne) for (const { first, count, isPlain = false } of ranges) mesh.geometry.addGroup(first, count, Number(isPlain));
    shares.forEach((share, i) => (mesh.morphTargetInfluences[i] = share));
  }

  #drop(node) {
    this.#takeImage(node);
    const { mesh, bytes } = this.#meshes.get(node);
    this.#meshes.delete(node);
    this.#bytes -= bytes;
    this.#dropped.push(node);
    this.remove(mesh);
    mesh.geometry.dispose();
  }
}

const bytesOfImage = ({ width, height }) => Math.ceil(width * height * texelBytes);

// A material that is the given one, whatever becomes of that, but for its map.
function withMap(material, map) {
  const { id, uuid } = new Material();
  const own = { id, uuid, map, _listeners: undefined };
  return Object.create(material, Object.fromEntries(Object.entries(own).map(([name, value]) => [name, { value, writable: true, enumerable: true }])));
}

function sphereOf(positions) {
  const [low, high] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  const at = new Vector3();
  for (let i = 0; i < positions.length; i += 3) {
    at.fromArray(positions, i);
    low.min(at);
    high.max(at);
  }
  const center = low.clone().add(high).multiplyScalar(0.5);
  return new Sphere(center, center.distanceTo(high));
}

// A target for each patch, of the vertices that slide with it.
function targetsOf(slides, patchCount) {
  const targets = Array.from({ length: patchCount }, () => new Float32Array((slides.length / 4) * 3));
  for (let v = 0; 4 * v < slides.length; ++v) targets[slides[4 * v + 3]].set(slides.subarray(4 * v, 4 * v + 3), 3 * v);
  return targets.map((target) => new BufferAttribute(target, 3));
}
