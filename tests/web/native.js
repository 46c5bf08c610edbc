// The native command line, whose answers those of WebAssembly must equal.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";

const program = path.resolve(process.env.OCCLOD ?? "build/release/tools/occlod");

export const folder = fs.mkdtempSync(path.join(os.tmpdir(), "occlod_web_"));
process.on("exit", () => fs.rmSync(folder, { recursive: true, force: true }));

export const run = (...words) => execFileSync(program, words, { encoding: "utf8", cwd: folder, stdio: ["ignore", "pipe", "pipe"] });

// Frames of update() along cameras: hash, triangles, refine_ms and occlusion_ms of each. One thread.
export function updates(mesh, cameras, budget, occlusion) {
  const keys = cameras.map(({ fovY, orthographicHeight, ...camera }) => ({ ...camera, fov_y_deg: fovY }));
  const scene = { objects: [{ mesh: path.basename(mesh) }], cameras: { default: keys[0] }, paths: { test: { frames: keys.length, jump: true, keys } } };
  fs.writeFileSync(path.join(folder, "scene.json"), JSON.stringify(scene));
  const answer = run("render", "scene.json", "--path", "test", "--frame-to-frame", "--budget", String(budget), "--occlusion",
    occlusion ? "software" : "none", "--threads", "1", "--json", "--no-cache");
  return JSON.parse(answer).frames;
}

// Fronts of an HLOD along cameras without occlusion: hash and number of triangles of each. `png`: pictures, at the end of
// whose name the frame is told.
export function fronts(ohlod, mesh, cameras, tolerancePx, png) {
  const keys = cameras.map(({ fovY, ...camera }) => ({ up: [0, 1, 0], fov_y_deg: fovY ?? 45, near: 0.001, far: 100, ...camera }));
  if (keys.length === 1) keys.push(keys[0]); // a path has two keys or more
  const scene = { objects: [{ mesh: path.basename(mesh) }], cameras: { default: keys[0] }, paths: { test: { frames: keys.length, jump: true, keys } } };
  fs.writeFileSync(path.join(folder, "fronts.json"), JSON.stringify(scene));
  const answer = run("hlod", "render", ohlod, "--scene", "fronts.json", "--path", "test", "--strategy", "vfc", "--tolerance", String(tolerancePx), "--json", ...(png ? ["--png", png] : []));
  return JSON.parse(answer).frames.map(({ hash, drawn_triangles }) => ({ hash, triangles: drawn_triangles }));
}

// Cameras around what `hierarchy` holds, a step of a hundredth of a turn from one to the next.
export function around(hierarchy, count) {
  const { orthographicHeight, ...camera } = hierarchy.lookingAt({ width: 1024, height: 768 });
  const [x, y, z] = camera.eye.map((value, i) => value - camera.target[i]);
  return Array.from({ length: count }, (_, i) => {
    const [c, s] = [Math.cos(0.0628 * i), Math.sin(0.0628 * i)];
    return { ...camera, eye: [camera.target[0] + c * x + s * z, camera.target[1] + y, camera.target[2] + c * z - s * x] };
  });
}

export const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

// A real mesh of `name` in the folders of OCCLOD_MESHES, copied beside the scene; nothing where there is none.
export function realMesh(name) {
  for (const place of (process.env.OCCLOD_MESHES ?? "").split(":").filter(Boolean)) {
    const file = path.join(place, name);
    if (fs.existsSync(file)) {
      fs.copyFileSync(file, path.join(folder, path.basename(name)));
      return path.join(folder, path.basename(name));
    }
  }
}
