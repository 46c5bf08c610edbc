// Two renderers of one tileset, with and without the plugin, each with its own cache; their pictures are compared pixel by
// pixel. tiles_test.js calls window.tiles.
import * as three from "three";
import { LRUCache, TilesRenderer } from "3d-tiles-renderer";
import { TilesOcclusionPlugin } from "@occlod/three/tiles_plugin.js";

const renderer = new three.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const background = new three.Color(0xff00ff);

// Culls tiles that are seen: what the comparison has to notice.
class TooMuch extends TilesOcclusionPlugin {
  calculateTileViewError(tile, target) {
    if (super.calculateTileViewError(tile, target)) return true;
    target.inView = !(tile.internal.hasRenderableContent && tile.children.length === 0 && tile.parent?.children.indexOf(tile) === 0);
    return !target.inView;
  }
}

class Drawn {
  constructor(url, plugin, cameras, settings) {
    this.tiles = Object.assign(new TilesRenderer(url), { errorTarget: 2, ...settings });
    this.tiles.lruCache = Object.assign(new LRUCache(), { maxSize: 1e6, minSize: 1e6, minBytesSize: 4e9, maxBytesSize: 4e9, unloadPriorityCallback: this.tiles.lruCache.unloadPriorityCallback });
    this.loaded = new Map(); // tiles, and how many were before each
    this.failed = 0;
    for (const camera of cameras) {
      this.tiles.setCamera(camera);
      this.tiles.setResolution(camera, innerWidth, innerHeight);
    }
    this.tiles.addEventListener("load-model", ({ tile, scene }) => {
      this.loaded.set(tile, this.loaded.size);
      paint(scene, tile.content.uri);
    });
    this.tiles.addEventListener("load-error", () => (this.failed += 1));
    if (plugin) this.tiles.registerPlugin((this.plugin = plugin));
    this.scene = new three.Scene();
    this.scene.background = background;
    this.scene.add(new three.HemisphereLight(0xffffff, 0x888888, 3), this.tiles.group);
  }

  update() {
    this.tiles.update();
    this.scene.updateMatrixWorld();
  }
  get isIdle() {
    const { stats, root } = this.tiles;
    return root && stats.downloading + stats.parsing + stats.queued === 0;
  }
  picture(camera) {
    renderer.render(this.scene, camera);
    this.triangles = renderer.info.render.triangles;
    const context = renderer.getContext();
    const pixels = new Uint32Array(context.drawingBufferWidth * context.drawingBufferHeight);
    context.readPixels(0, 0, context.drawingBufferWidth, context.drawingBufferHeight, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(pixels.buffer));
    return pixels;
  }
  // The picture with tiles that are loaded, but hidden or out of sight.
  pictureOfAll(camera) {
    const { activeTiles, visibleTiles, group } = this.tiles;
    const more = [...activeTiles].filter((tile) => !visibleTiles.has(tile)).map(({ engineData }) => engineData.scene);
    for (const scene of more) group.add(scene);
    const pixels = this.picture(camera);
    for (const scene of more) {
      group.remove(scene);
      scene.parent = group; // as the renderer leaves them
    }
    return pixels;
  }
  // `complete`: how many tiles were loaded before all of these were.
  get counts() {
    const { stats, visibleTiles } = this.tiles;
    return { drawn: visibleTiles.size, triangles: this.triangles, loaded: this.loaded.size, complete: 1 + Math.max(...[...visibleTiles].map((tile) => this.loaded.get(tile))), failed: this.failed, stats: this.plugin && { ...this.plugin.stats } };
  }
}

// A colour for each tile, so that one that is missing shows; and a place in the order of drawing, which decides between
// surfaces of equal depth: else that in which tiles were loaded does.
function paint(scene, uri) {
  let hash = 7;
  for (const letter of uri) hash = (hash * 31 + letter.charCodeAt(0)) >>> 0;
  scene.traverse((object) => {
    object.renderOrder = hash;
    object.material?.color.setHSL(((hash * 0.618) % 1 + 1) % 1, 0.6, 0.6);
  });
}

function place(camera, at) {
  Object.assign(camera, { fov: at.fov_y_deg ?? 60, near: at.near ?? 0.1, far: at.far ?? 2000, aspect: innerWidth / innerHeight });
  camera.up.set(...(at.up ?? [0, 1, 0]));
  camera.position.set(...at.eye);
  camera.lookAt(...at.target);
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
}

function differing(a, b) {
  let count = 0;
  for (let i = 0; i < a.length; ++i) count += a[i] !== b[i];
  return count;
}

const frame = () => new Promise(requestAnimationFrame);

class Comparison {
  constructor(url, { plugin = "ours", cameras = 1, settings = {} } = {}) {
    this.cameras = Array.from({ length: cameras }, () => new three.PerspectiveCamera());
    const culling = plugin === "too much" ? new TooMuch() : new TilesOcclusionPlugin();
    this.all = new Drawn(url, undefined, this.cameras, settings);
    this.culled = new Drawn(url, culling, this.cameras, settings);
  }

  // Updates both once and compares what the first camera sees; `late`: pixels of the plugin's own picture that tiles which
  // it hides would change.
  step(...places) {
    places.forEach((at, i) => place(this.cameras[i], at));
    for (const drawn of [this.all, this.culled]) drawn.update();
    const late = differing(this.culled.pictureOfAll(this.cameras[0]), this.culled.picture(this.cameras[0]));
    const different = differing(this.all.picture(this.cameras[0]), this.culled.picture(this.cameras[0]));
    return { different, late, all: this.all.counts, culled: this.culled.counts };
  }

  // The same once everything is loaded. Both have then been asked about this view alone.
  async settle(...places) {
    await this.culled.plugin.ready;
    places.forEach((at, i) => place(this.cameras[i], at));
    const begin = performance.now();
    for (const drawn of [this.all, this.culled])
      for (let calm = 0; calm < 6; calm = drawn.isIdle ? calm + 1 : 0) {
        drawn.update();
        await frame();
        if (performance.now() - begin > 200000) throw new Error("tiles are not loaded: " + JSON.stringify(drawn.tiles.stats));
      }
    return this.step(...places);
  }

  isDrawn(uri) {
    return [this.all, this.culled].map(({ tiles }) => [...tiles.visibleTiles].some((tile) => tile.content.uri === uri));
  }
  dispose() {
    for (const { tiles } of [this.all, this.culled]) tiles.dispose();
  }
}

window.tiles = {
  open(url, options) {
    window.tiles.now?.dispose();
    window.tiles.now = new Comparison(url, options);
  },
};
