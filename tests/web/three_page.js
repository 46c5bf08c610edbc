// What three_test.js calls in the browser: a scene with one .ohlod, drawn in one flat colour over another, so that pixels
// without surface can be counted.
import * as three from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { Ohlod } from "@occlod/three";

const [width, height] = [innerWidth, innerHeight];
// Around what is counted: where SwiftShader clips triangles, at the border, it leaves out single pixels of edges that two of
// them share.
const margin = 32;
const renderer = new three.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
renderer.setSize(width + 2 * margin, height + 2 * margin);
Object.assign(renderer.domElement.style, { position: "absolute", left: `${-margin}px`, top: `${-margin}px` });
document.body.append(renderer.domElement);
const counted = { getDrawingBufferSize: (size) => size.set(width, height) };
const background = new three.Color(1, 0, 1);
const scene = new three.Scene();
scene.background = background;
const camera = new three.PerspectiveCamera(45, width / height, 0.001, 100);
let ohlod;
let whole; // after load()
let opened; // when

const frame = () => new Promise(requestAnimationFrame);

function place({ eye, target, up = [0, 1, 0], fovY = 45, near = 0.001, far = 100 }) {
  Object.assign(camera, { fov: fovY, near, far });
  camera.up.set(...up);
  camera.position.set(...eye);
  camera.lookAt(...target);
  camera.updateProjectionMatrix();
}

const update = () => ohlod.update(camera, counted);

function render() {
  camera.setViewOffset(width, height, -margin, -margin, width + 2 * margin, height + 2 * margin);
  renderer.render(scene, camera);
  camera.clearViewOffset();
}

// Where there is no surface: 1 for each such pixel.
function empty() {
  const gl = renderer.getContext();
  const rgba = new Uint8Array(4 * width * height);
  gl.readPixels(margin, margin, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  const mask = new Uint8Array(width * height);
  for (let i = 0; i < mask.length; ++i) mask[i] = rgba[4 * i] > 250 && rgba[4 * i + 1] < 5 && rgba[4 * i + 2] > 250;
  return { width, height, mask };
}

// Pixels without surface that those at the border of the picture do not reach by steps across edges.
function holes({ width, height, mask }) {
  const left = mask.slice();
  const stack = [];
  const reach = (x, y) => {
    if (x < 0 || y < 0 || x >= width || y >= height || !left[y * width + x]) return;
    left[y * width + x] = 0;
    stack.push(x, y);
  };
  for (let x = 0; x < width; ++x) [0, height - 1].forEach((y) => reach(x, y));
  for (let y = 0; y < height; ++y) [0, width - 1].forEach((x) => reach(x, y));
  while (stack.length) {
    const [y, x] = [stack.pop(), stack.pop()];
    reach(x - 1, y), reach(x + 1, y), reach(x, y - 1), reach(x, y + 1);
  }
  return left.reduce((sum, is) => sum + is, 0);
}

const count = (mask) => mask.reduce((sum, is) => sum + is, 0);

window.page = {
  failures: [],

  // `color` null: those of the file, and its images.
  open(url, { color = 0x406080, ...options }, at) {
    ohlod?.dispose();
    page.failures = [];
    opened = performance.now();
    ohlod = new Ohlod(url, { ...options, material: new three.MeshBasicMaterial({ color: color ?? 0xffffff, vertexColors: color === null, side: three.DoubleSide }) });
    ohlod.addEventListener("failure", ({ message }) => page.failures.push(message));
    scene.add(ohlod);
    place(at);
    return ohlod.ready.then(() => ohlod.facts);
  },

  set(options) {
    Object.assign(ohlod, options);
  },

  // Draws frames until something is seen. Returns the ms since open().
  async first() {
    for (;;) {
      update();
      render();
      if (ohlod.stats.triangles > 0 && count(empty().mask) < empty().mask.length) return performance.now() - opened;
      await frame();
    }
  },

  // Draws frames until all has come.
  async look(at) {
    place(at);
    let isSettled = false;
    const begin = performance.now();
    do {
      update();
      ohlod.settled().then(() => (isSettled = true), () => {});
      await frame();
      if (performance.now() - begin > 60000) throw new Error(`has not settled: ${JSON.stringify(ohlod.stats)}`);
    } while (!isSettled);
    if (page.failures.some((line) => line.startsWith("view"))) throw new Error(page.failures.join());
    render();
    const seen = empty();
    return { stats: ohlod.stats, empty: count(seen.mask), holes: holes(seen), pixels: seen.mask.length, drawn: renderer.info.render.triangles };
  },

  // One frame for each camera, whatever has come. Returns the most of each that any frame had, and where pixels lacked
  // surface: frame, x, y. Pictures are drawn of what was
  // selected for the camera before: one frame late, however slow the machine. Without pictures frames follow each other as
  // fast as timers do.
  async fly(cameras, { picture = true } = {}) {
    const most = { memoryBytes: 0, empty: 0, holes: 0, triangles: 0, where: [] };
    for (const [number, at] of cameras.entries()) {
      place(at);
      if (picture) {
        render();
        const seen = empty();
        most.empty = Math.max(most.empty, count(seen.mask));
        for (let i = 0; i < seen.mask.length && most.where.length < 9; ++i)
          if (seen.mask[i]) most.where.push([number, i % seen.width, Math.floor(i / seen.width)]);
        most.holes = Math.max(most.holes, holes(seen));
      }
      do {
        update();
        if (picture) await frame();
      } while (picture && ohlod.isBehind);
      const { memoryBytes, triangles } = ohlod.stats;
      most.memoryBytes = Math.max(most.memoryBytes, memoryBytes);
      most.triangles = Math.max(most.triangles, triangles);
      if (!picture) await new Promise((done) => setTimeout(done));
    }
    return most;
  },

  // Base 64, a bit for each pixel, from the top left.
  mask() {
    const { width, height, mask } = empty();
    const bits = new Uint8Array(Math.ceil((width * height) / 8));
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width; ++x) if (mask[(height - 1 - y) * width + x]) bits[(y * width + x) >> 3] |= 128 >> ((y * width + x) & 7);
    let text = "";
    for (const byte of bits) text += String.fromCharCode(byte);
    return btoa(text);
  },

  // Loads a whole model, to be drawn in place of the streamed one by compare().
  async load(url) {
    const { scene: loaded } = await new GLTFLoader().loadAsync(url);
    loaded.traverse((mesh) => {
      if (!mesh.isMesh) return;
      const { map, color } = mesh.material;
      if (map) map.anisotropy = 4;
      mesh.material = new three.MeshBasicMaterial({ map, color, side: three.DoubleSide });
    });
    whole = loaded;
  },

  // Draws both from one place. Returns the peak signal-to-noise ratio of pixels that both cover, in dB, and the share of red
  // ones, which no image has, in each. `texels`: of images of nodes that are drawn.
  compare({ isWhole = false } = {}) {
    const gl = renderer.getContext();
    const draw = (object) => {
      scene.clear();
      scene.add(object);
      render();
      const rgba = new Uint8Array(4 * width * height);
      gl.readPixels(margin, margin, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
      return rgba;
    };
    const [streamed, true_] = [draw(ohlod), draw(whole)];
    if (!isWhole) draw(ohlod);
    const maps = ohlod.children.filter((mesh) => mesh.visible).flatMap((mesh) => mesh.material).map(({ map }) => map?.image);
    const texels = [...new Set(maps)].reduce((sum, image) => sum + (image ? image.width * image.height : 0), 0);
    const isEmpty = (rgba, i) => rgba[i] > 250 && rgba[i + 1] < 5 && rgba[i + 2] > 250;
    const isRed = (rgba, i) => rgba[i] > 150 && rgba[i + 1] < 60 && rgba[i + 2] < 60;
    let [pixels, squares, red, trueRed] = [0, 0, 0, 0];
    for (let i = 0; i < streamed.length; i += 4) {
      if (isEmpty(streamed, i) || isEmpty(true_, i)) continue;
      ++pixels;
      for (let k = 0; k < 3; ++k) squares += (streamed[i + k] - true_[i + k]) ** 2;
      red += isRed(streamed, i);
      trueRed += isRed(true_, i);
    }
    return { pixels, psnr: 10 * Math.log10((255 ** 2 * 3 * pixels) / squares), red: red / pixels, trueRed: trueRed / pixels, textures: renderer.info.memory.textures, texels };
  },

  // An image in other bytes, base 64.
  async encode(base64, type) {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    canvas.getContext("2d").drawImage(bitmap, 0, 0);
    const bytes = new Uint8Array(await (await canvas.convertToBlob({ type, quality: 0.95 })).arrayBuffer());
    return btoa(bytes.reduce((text, byte) => text + String.fromCharCode(byte), ""));
  },

  close() {
    ohlod.dispose();
    render();
  },

  textures: () => renderer.info.memory.textures,

  // Leaves out one node after another. Returns the largest counts.
  hideEach() {
    const most = { empty: 0, holes: 0 };
    for (const mesh of ohlod.children.filter((mesh) => mesh.visible)) {
      mesh.visible = false;
      render();
      const seen = empty();
      most.empty = Math.max(most.empty, count(seen.mask));
      most.holes = Math.max(most.holes, holes(seen));
      mesh.visible = true;
    }
    return most;
  },

  stats: () => ohlod.stats,
};
