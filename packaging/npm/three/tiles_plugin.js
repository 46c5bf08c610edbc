// A plugin of 3DTilesRendererJS that culls what is hidden. Before each update the tiles that were drawn last are rasterised
// for the camera as it is now; a tile whose bounding volume is behind them at every pixel is neither drawn nor refined, and
// what is missing of it is loaded last.
import { Matrix4, Vector2, Vector3, WebGPUCoordinateSystem } from "three";
import { Sight, addMesh, freeMesh, loadOcclusion } from "./occlusion.js";

const matrix = new Matrix4();
const worldToEye = new Matrix4();
const eye = new Vector3();
const point = new Vector3();
const axes = [new Vector3(), new Vector3(), new Vector3()];
const resolution = new Vector2();
const corners = new Float64Array(24);

// Bounds are asked as if they were nearer by this share of their distance, so that a tile does not hide itself where its
// content is a little outside of its bounding volume, and depth buffers of 24 bits agree.
const nearer = 1 - 1 / 1024;

// Whether all that a material covers is hidden behind it.
const isOpaque = (material) =>
  material.visible && !material.transparent && material.alphaTest === 0 && !material.alphaHash && !material.wireframe && material.depthWrite &&
  material.depthTest && material.colorWrite && !material.clippingPlanes?.length && !material.displacementMap && !material.isShaderMaterial &&
  !material.defines?.FEATURE_FADE; // TilesFadePlugin's, while it fades

const isRigid = (mesh) =>
  mesh.isMesh && !mesh.isSkinnedMesh && !mesh.isInstancedMesh && !mesh.isBatchedMesh && !Object.keys(mesh.geometry.morphAttributes).length;

const isWhole = ({ drawRange, attributes, index }) =>
  attributes.position && drawRange.start === 0 && drawRange.count >= (index ?? attributes.position).count;

// A mesh of a tile as occluder. Its copy is made when it is first drawn, and anew when the page changes its positions.
class Occluder {
  #mesh;
  #toGroup;
  #copy = 0;
  #copied = "";

  constructor(mesh, toGroup) {
    this.#mesh = mesh;
    this.#toGroup = toGroup;
  }

  get occludes() {
    const materials = [this.#mesh.material].flat();
    for (let object = this.#mesh; object; object = object.parent) if (!object.visible) return false;
    return isWhole(this.#mesh.geometry) && materials.every((material) => isOpaque(material) && material.side === materials[0].side);
  }
  get toGroup() {
    return this.#toGroup;
  }

  get copy() {
    const { geometry, material } = this.#mesh;
    const { position } = geometry.attributes;
    const { side } = [material].flat()[0];
    const version = `${geometry.uuid} ${position.version ?? position.data.version} ${geometry.index?.version} ${side}`;
    if (version === this.#copied) return this.#copy;
    this.dispose();
    const positions = new Float32Array(3 * position.count);
    for (let i = 0; i < position.count; ++i) {
      positions[3 * i] = position.getX(i);
      positions[3 * i + 1] = position.getY(i);
      positions[3 * i + 2] = position.getZ(i);
    }
    const triangles = geometry.index ? Uint32Array.from(geometry.index.array) : Uint32Array.from({ length: position.count }, (_, i) => i);
    this.#copy = addMesh(positions, triangles.subarray(0, triangles.length - (triangles.length % 3)), side);
    this.#copied = version;
    return this.#copy;
  }

  dispose() {
    if (this.#copy) freeMesh(this.#copy);
    this.#copy = 0;
    this.#copied = "";
  }
}

// The matrices of a camera and the size of its picture, as Sight.draw() takes them, in a world whose origin is the eye.
function cameraNumbers(camera, { width, height }) {
  worldToEye.copy(camera.matrixWorldInverse).multiply(matrix.makeTranslation(eye.setFromMatrixPosition(camera.matrixWorld)));
  const clip = camera.projectionMatrix.elements.slice();
  // Pixels have to be square, and whole ones have to show all: the picture may reach farther than the camera's.
  const focal = Math.max(width * clip[0], height * clip[5]) / 2;
  const pixels = [0, 5].map((k) => Math.ceil((2 * focal) / clip[k] - 1e-6));
  [0, 5].forEach((k, axis) => {
    const share = (2 * focal) / pixels[axis] / clip[k];
    for (let column = 0; column < 4; ++column) clip[4 * column + axis] *= share;
  });
  return [...worldToEye.elements, ...clip, ...pixels, camera.reversedDepth ? 2 : camera.coordinateSystem === WebGPUCoordinateSystem ? 1 : 0];
}

export class TilesOcclusionPlugin {
  name = "OCCLOD_OCCLUSION_PLUGIN";
  enabled = true;
  stats = { tested: 0, hidden: 0, occluders: 0, occluderTriangles: 0, drawMs: 0, testMs: 0 };

  #wasm;
  #tiles;
  #ready = false;
  #changed = false;
  #sights = new Map(); // by camera
  #occluders = new Map(); // by tile
  #verdicts = new Map(); // by tile, of this update
  #demoted = new WeakSet(); // tiles that are loaded last
  #listeners;

  constructor({ wasm } = {}) {
    this.#wasm = wasm;
  }

  init(tiles) {
    this.#tiles = tiles;
    this.#listeners = {
      "update-before": () => this.#look(),
      "update-after": () => this.#goOn(),
      "tile-visibility-change": ({ tile, visible }) => {
        this.#changed = true;
        if (!visible) this.#forget(tile);
      },
      "dispose-model": ({ tile }) => this.#forget(tile),
      "delete-camera": ({ camera }) => this.#forgetCamera(camera),
    };
    for (const [type, listener] of Object.entries(this.#listeners)) tiles.addEventListener(type, listener);
    this.ready = loadOcclusion(this.#wasm).then(() => {
      this.#ready = this.#tiles === tiles;
      tiles.dispatchEvent({ type: "needs-update" });
    });
    this.ready.catch((problem) => console.error(problem.message));
  }

  dispose() {
    for (const [type, listener] of Object.entries(this.#listeners)) this.#tiles.removeEventListener(type, listener);
    for (const tile of [...this.#occluders.keys()]) this.#forget(tile);
    for (const camera of [...this.#sights.keys()]) this.#forgetCamera(camera);
    this.#tiles.traverse((tile) => void this.#promote(tile), null, false);
    this.#tiles = undefined;
    this.#ready = false;
  }

  #forget(tile) {
    this.#occluders.get(tile)?.forEach((occluder) => occluder.dispose());
    this.#occluders.delete(tile);
  }
  #forgetCamera(camera) {
    this.#sights.get(camera)?.sight.dispose();
    this.#sights.delete(camera);
  }

  #occludersOf(tile) {
    let occluders = this.#occluders.get(tile);
    if (occluders) return occluders;
    occluders = [];
    const { scene } = tile.engineData;
    const visit = (object, toParent) => {
      object.updateMatrix();
      const toGroup = toParent.clone().multiply(object.matrix);
      if (isRigid(object)) occluders.push(new Occluder(object, toGroup));
      object.children.forEach((child) => visit(child, toGroup));
    };
    if (scene) visit(scene, new Matrix4());
    this.#occluders.set(tile, occluders);
    return occluders;
  }

  // Draws what was drawn last, as each camera sees it now.
  #look() {
    this.#verdicts.clear();
    Object.assign(this.stats, { tested: 0, hidden: 0, occluders: 0, occluderTriangles: 0, drawMs: 0, testMs: 0 });
    if (!this.#ready || !this.enabled) return;
    const begin = performance.now();
    const occluders = [...this.#tiles.visibleTiles].flatMap((tile) => this.#occludersOf(tile)).filter((occluder) => occluder.occludes);
    for (const camera of this.#tiles.cameras) this.#lookFrom(camera, occluders);
    this.stats.occluders = occluders.length;
    this.stats.drawMs = performance.now() - begin;
  }

  #lookFrom(camera, occluders) {
    if (!this.#sights.has(camera)) this.#sights.set(camera, { sight: new Sight(), toWorld: new Matrix4() });
    const seen = this.#sights.get(camera);
    const numbers = new Float64Array(35 + 17 * occluders.length);
    numbers.set(cameraNumbers(camera, this.#tiles.getResolution(camera, resolution)));
    seen.isOrthographic = camera.projectionMatrix.elements[15] === 1;
    seen.toWorld.copy(this.#tiles.group.matrixWorld).premultiply(matrix.makeTranslation(-eye.x, -eye.y, -eye.z));
    occluders.forEach((occluder, i) => {
      numbers[35 + 17 * i] = occluder.copy;
      numbers.set(matrix.multiplyMatrices(seen.toWorld, occluder.toGroup).elements, 36 + 17 * i);
    });
    try {
      this.stats.occluderTriangles += seen.sight.draw(numbers);
      seen.works = true;
    } catch (problem) {
      if (seen.works !== false) console.warn(`TilesOcclusionPlugin: nothing is culled: ${problem.message}`);
      seen.works = false;
    }
  }

  // Tiles that come or go are other occluders: one more update shows what they hide.
  #goOn() {
    if (!this.#changed) return;
    this.#changed = false;
    this.#tiles.dispatchEvent({ type: "needs-update" });
  }

  // For 3DTilesRendererJS: false has no effect, true with inView false takes the tile out of the view.
  calculateTileViewError(tile, target) {
    const begin = performance.now();
    const hidden = this.#ready && this.enabled && this.#sights.size > 0 && this.#isHidden(tile);
    this.stats.testMs += performance.now() - begin;
    if (hidden) this.#demote(tile);
    else this.#promote(tile);
    target.inView = !hidden;
    return hidden;
  }

  // What is missing of a hidden tile is loaded last, and nobody waits for it: its siblings replace their parent without it.
  #demote(tile) {
    this.stats.hidden += 1;
    tile.priority = -1;
    this.#demoted.add(tile);
    tile.traversal.allChildrenLoaded = tile.traversal.allChildrenReady = true;
  }

  #promote(tile) {
    if (this.#demoted.delete(tile)) delete tile.priority;
  }

  // Below a tile that stands in for its children these are asked with the error of what they will replace, since it must not
  // hide them itself; and not all children of a tile are hidden there, since then it would go before they come.
  #isHidden(tile) {
    const known = this.#verdicts.get(tile);
    if (known !== undefined) return known;
    const standIn = this.#standIn(tile);
    if (!standIn) {
      const hidden = this.#isBehind(tile, 0);
      this.#verdicts.set(tile, hidden);
      return hidden;
    }
    const siblings = tile.parent.children.filter((child) => child.engineData);
    const hidden = siblings.map((child) => this.#isBehind(child, standIn.geometricError));
    const all = hidden.every(Boolean);
    siblings.forEach((child, i) => this.#verdicts.set(child, hidden[i] && !all));
    return this.#verdicts.get(tile);
  }

  // The ancestor that is drawn instead of the tile.
  #standIn(tile) {
    for (let ancestor = tile.parent; ancestor; ancestor = ancestor.parent)
      if (ancestor.refine === "REPLACE" && this.#tiles.visibleTiles.has(ancestor)) return ancestor;
    return undefined;
  }

  // Whether no camera sees anything of the tile's bounding volume, grown by a length of the group.
  #isBehind(tile, growth) {
    this.stats.tested += 1;
    const { sphere, obb, regionObb } = tile.engineData.boundingVolume;
    for (const seen of this.#sights.values()) {
      if (!seen.works) return false;
      if (sphere && !this.#showsSphere(seen, sphere, growth)) continue;
      const box = obb ?? regionObb;
      if (box && !this.#showsBox(seen, box, growth)) continue;
      return false;
    }
    return true;
  }

  #showsBox({ sight, toWorld, isOrthographic }, { box, transform }, growth) {
    transform.extractBasis(...axes);
    const grown = axes.map((axis) => growth / axis.length());
    for (let i = 0; i < 8; ++i) {
      point.set(i & 1 ? box.max.x + grown[0] : box.min.x - grown[0], i & 2 ? box.max.y + grown[1] : box.min.y - grown[1], i & 4 ? box.max.z + grown[2] : box.min.z - grown[2]);
      point.applyMatrix4(transform).applyMatrix4(toWorld);
      if (!isOrthographic) point.multiplyScalar(nearer);
      point.toArray(corners, 3 * i);
    }
    return sight.showsHull(corners);
  }

  #showsSphere({ sight, toWorld, isOrthographic }, sphere, growth) {
    point.copy(sphere.center).applyMatrix4(toWorld);
    const radius = (sphere.radius + growth) * toWorld.getMaxScaleOnAxis();
    const share = isOrthographic ? 1 : nearer;
    return sight.showsSphere(point.x * share, point.y * share, point.z * share, radius * share);
  }
}
