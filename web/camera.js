// A camera that turns around a point, and what drawing needs of it. World space is that of the mesh.
const add = (a, b, k = 1) => a.map((x, i) => x + k * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

// Directions of a camera: to its right, up in its image, and where it looks.
function axes({ eye, target, up }) {
  const forward = unit(add(target, eye, -1));
  const right = unit(cross(forward, up));
  return { right, up: cross(right, forward), forward };
}

export class Orbit {
  #target;
  #distance;
  #azimuth;
  #elevation;
  #radius;
  #settings;

  // Begins as `camera`, which sees all of a box.
  constructor(camera, box) {
    const offset = add(camera.eye, camera.target, -1);
    this.#target = camera.target;
    this.#distance = Math.hypot(...offset);
    this.#azimuth = Math.atan2(offset[0], offset[2]);
    this.#elevation = Math.asin(offset[1] / this.#distance);
    this.#radius = Math.hypot(...add(box.max, box.min, -1)) / 2;
    this.#settings = { fovY: camera.fovY, up: [0, 1, 0] };
  }

  turn(dx, dy) {
    this.#azimuth -= 0.008 * dx;
    this.#elevation = Math.max(-1.55, Math.min(1.55, this.#elevation + 0.008 * dy));
  }
  zoom(factor) {
    this.#distance = Math.max(0.002 * this.#radius, Math.min(20 * this.#radius, this.#distance * factor));
  }
  // By pixels of an image of this height.
  move(dx, dy, height) {
    const { right, up } = axes(this.camera(1, 1));
    const step = (2 * this.#distance * Math.tan((this.#settings.fovY * Math.PI) / 360)) / height;
    this.#target = add(add(this.#target, right, -dx * step), up, dy * step);
  }

  camera(width, height) {
    const level = Math.cos(this.#elevation);
    const direction = [Math.sin(this.#azimuth) * level, Math.sin(this.#elevation), Math.cos(this.#azimuth) * level];
    const near = Math.max(this.#distance - 2 * this.#radius, 0.02 * this.#distance);
    return { ...this.#settings, eye: add(this.#target, direction, this.#distance), target: this.#target, width, height, near, far: this.#distance + 4 * this.#radius };
  }
}

// What Drawing.draw() takes, for an image of the camera's height over the width of `aspect` times that.
export function viewOf(camera, aspect) {
  const { right, up, forward } = axes(camera);
  const { eye, near, far } = camera;
  const f = 1 / Math.tan((camera.fovY * Math.PI) / 360);
  const rows = [right.map((x) => (f / aspect) * x), up.map((x) => f * x), forward.map((x) => ((far + near) / (far - near)) * x), forward];
  const lasts = [0, 0, (-2 * far * near) / (far - near), 0];
  const worldToClip = new Float32Array(16);
  rows.forEach((row, i) => {
    row.forEach((x, j) => (worldToClip[4 * j + i] = x));
    worldToClip[12 + i] = lasts[i] - dot(row, eye);
  });
  const key = unit(add(add(right.map((x) => -0.6 * x), up, 0.75), forward, -0.45));
  return { worldToClip, eye, keyLight: key, up };
}

// The corners of what a camera sees.
export function frustum(camera) {
  const { right, up, forward } = axes(camera);
  const t = Math.tan((camera.fovY * Math.PI) / 360);
  const corners = [];
  for (const depth of [camera.near, camera.far])
    for (const y of [-1, 1])
      for (const x of [-1, 1])
        corners.push(add(add(add(camera.eye, forward, depth), right, (x * t * depth * camera.width) / camera.height), up, y * t * depth));
  return corners;
}
