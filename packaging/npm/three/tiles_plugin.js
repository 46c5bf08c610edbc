// A plugin of 3DTilesRendererJS that culls what is hidden. Before each update the tiles that were drawn last are rasterised
// for the camera as it is now; a tile whose bounding volume is behind them at every pixel is neither drawn nor refined, and
// what is missing of it is loaded last.
import { DoubleSide, Matrix4, Sphere, Vector2, Vector3, WebGPUCoordinateSystem } from "three";
import { Sight, addMesh, freeMesh, loadOcclusion } from "./occlusion.js";

const matrix = new Matrix4();
const worldToEye = new Matrix4();
const eye = new Vector3();
const point = new Vector3();
const resolution = new Vector2();
const ball = new Sphere();
const corners = new Float64Array(24);

// Bounds are asked as if they were nearer by this share of their distance, so that a tile does not hide itself where its
// content is a little outside of its bounding volume, and depth buffers of 24 bits agree.
const nearer = 1 - 1 / 1024;

// Occluders are drawn until there are so many triangles towards the eye: those first that cover most with fewest.
const enoughTriangles = 16384;

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
  get triangles() {
    const { geometry, material } = this.#mesh;
    return (geometry.index ?? geometry.attributes.position).count / ([material].flat()[0].side === DoubleSide ? 3 : 6); // which face the eye
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

// Those of a tile, with transforms to the group of all tiles.
function occludersIn(object, toParent = new Matrix4()) {
  if (!object) return [];
  object.updateMatrix();
  const toGroup = toParent.clone().multiply(object.matrix);
  const own = isRigid(object) ? [new Occluder(object, toGroup)] : [];
  return own.concat(...object.children.map((child) => occludersIn(child, toGroup)));
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

// What one camera sees of all tiles that are drawn, and of those alone that stay.
class Look {
  #sights = { all: new Sight(), final: new Sight() };
  #camera = [];
  #toWorld = new Matrix4();
  #isOrthographic = false;
  #works = true;

  from(camera, tiles) {
    this.#camera = cameraNumbers(camera, tiles.getResolution(camera, resolution));
    this.#isOrthographic = camera.projectionMatrix.elements[15] === 1;
    this.#toWorld.copy(tiles.group.matrixWorld).premultiply(matrix.makeTranslation(-eye.x, -eye.y, -eye.z));
  }

  // Returns how many triangles were drawn.
  draw(which, occluders) {
    const numbers = new Float64Array(35 + 17 * occluders.length);
    numbers.set(this.#camera);
    occluders.forEach((occluder, i) => {
      numbers[35 + 17 * i] = occluder.copy;
      numbers.set(matrix.multiplyMatrices(this.#toWorld, occluder.toGroup).elements, 36 + 17 * i);
    });
    try {
      const count = this.#sights[which].draw(numbers);
      this.#works = true;
      return count;
    } catch (problem) {
      if (this.#works) console.warn(`TilesOcclusionPlugin: nothing is culled: ${problem.message}`);
      this.#works = false;
      return 0;
    }
  }

  hides(which, { sphere, obb, regionObb }) {
    if (!this.#works) return false;
    const box = obb ?? regionObb;
    return Boolean((sphere && !this.#showsSphere(this.#sights[which], sphere)) || (box && !this.#showsBox(this.#sights[which], box)));
  }

  #showsBox(sight, { box, transform }) {
    matrix.multiplyMatrices(this.#toWorld, transform);
    for (let i = 0; i < 8; ++i) {
      point.set(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z).applyMatrix4(matrix);
      point.multiplyScalar(this.#isOrthographic ? 1 : nearer).toArray(corners, 3 * i);
    }
    return sight.showsHull(corners);
  }

  #showsSphere(sight, { center, radius }) {
    const share = this.#isOrthographic ? 1 : nearer;
    point.copy(center).applyMatrix4(this.#toWorld).multiplyScalar(share);
    return sight.showsSphere(...point, radius * this.#toWorld.getMaxScaleOnAxis() * share);
  }

  dispose() {
    for (const sight of Object.values(this.#sights)) sight.dispose();
  }
}

export class TilesOcclusionPlugin {
  name = "OCCLOD_OCCLUSION_PLUGIN";
  enabled = true;
  stats = { tested: 0, hidden: 0, occluders: 0, occluderTriangles: 0, drawMs: 0, testMs: 0 };

  #wasm;
  #tiles;
  #ready = false;
  #changed = false;
  #looks = new Map(); // by camera
  #occluders = new Map(); // by tile
  #final = new Set(); // tiles that are drawn and will not be replaced in this view
  #finalDrawn = false;
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
    for (const camera of [...this.#looks.keys()]) this.#forgetCamera(camera);
    this.#tiles.traverse((tile) => void this.#promote(tile), null, false);
    this.#tiles = undefined;
    this.#ready = false;
  }

  #forget(tile) {
    this.#occluders.get(tile)?.forEach((occluder) => occluder.dispose());
    this.#occluders.delete(tile);
  }
  #forgetCamera(camera) {
    this.#looks.get(camera)?.dispose();
    this.#looks.delete(camera);
  }

  #occludersOf(tiles) {
    const ranked = tiles.map((tile) => {
      if (!this.#occluders.has(tile)) this.#occluders.set(tile, occludersIn(tile.engineData.scene));
      const occluders = this.#occluders.get(tile).filter((occluder) => occluder.occludes);
      const triangles = occluders.reduce((sum, occluder) => sum + occluder.triangles, 0);
      tile.engineData.boundingVolume.getSphere(ball);
      const size = Math.min(ball.radius / tile.traversal.distanceFromCamera, 1);
      return { occluders, triangles, worth: size ** 2 / triangles };
    });
    let left = enoughTriangles;
    return ranked
      .filter(({ triangles }) => triangles > 0)
      .sort((a, b) => b.worth - a.worth)
      .filter(({ triangles }) => (left -= triangles) + triangles > 0)
      .flatMap(({ occluders }) => occluders);
  }

  // Draws what was drawn last, as each camera sees it now.
  #look() {
    this.#finalDrawn = false;
    Object.assign(this.stats, { tested: 0, hidden: 0, occluders: 0, occluderTriangles: 0, drawMs: 0, testMs: 0 });
    if (!this.#ready || !this.enabled) return;
    const begin = performance.now();
    const drawn = [...this.#tiles.visibleTiles];
    this.#final = new Set(drawn.filter((tile) => !this.#standsIn(tile)));
    const occluders = this.#occludersOf(drawn);
    for (const camera of this.#tiles.cameras) {
      if (!this.#looks.has(camera)) this.#looks.set(camera, new Look());
      const look = this.#looks.get(camera);
      look.from(camera, this.#tiles);
      this.stats.occluderTriangles += look.draw("all", occluders);
    }
    this.stats.occluders = occluders.length;
    this.stats.drawMs = performance.now() - begin;
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
    const hidden = this.#ready && this.enabled && this.#looks.size > 0 && this.#isHidden(tile);
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

  // Whether children will replace the tile as soon as they are there.
  #standsIn(tile) {
    return tile.refine === "REPLACE" && tile.children.length > 0 && tile.traversal.error > this.#tiles.errorTarget;
  }

  // A tile that is drawn until its children are there must not hide them: these are asked about the tiles alone that stay.
  #isHidden(tile) {
    let which = "all";
    for (let ancestor = tile.parent; ancestor; ancestor = ancestor.parent)
      if (ancestor.refine === "REPLACE" && this.#tiles.visibleTiles.has(ancestor)) {
        if (this.#final.has(ancestor)) return false; // until now
        which = "final";
      }
    if (which === "final" && !this.#finalDrawn) this.#drawFinal();
    this.stats.tested += 1;
    const { boundingVolume } = tile.engineData;
    return [...this.#looks.values()].every((look) => look.hides(which, boundingVolume));
  }

  #drawFinal() {
    const occluders = this.#occludersOf([...this.#final]);
    for (const look of this.#looks.values()) this.stats.occluderTriangles += look.draw("final", occluders);
    this.#finalDrawn = true;
  }
}
