// The examples of the package's README and guide, for TypeScript's compiler.
import { Hierarchy, Mesh, OcclodError, Refiner, ready, type RefineStats } from "occlod";

export async function refine(file: ArrayBuffer, budget: number): Promise<[RefineStats, Uint32Array]> {
  await ready();
  const mesh: Mesh = Mesh.read("statue.ply", file, { onProgress: (done) => done < 0.5 });
  const hierarchy: Hierarchy = mesh.build({ onProgress: (done) => console.log(done) });
  mesh.dispose();
  const refiner = new Refiner([{ hierarchy, transform: new Float64Array(16), twoSided: true }]);
  const stats = refiner.update(hierarchy.lookingAt({ width: 1280, height: 720 }), { budget, occlusion: true });
  const worldToEye = new Float32Array(16), eyeToClip = new Float32Array(16);
  refiner.refine({ worldToEye, eyeToClip, width: 640, height: 480, clipDepth: "0..1" }, { tolerancePx: 1 });
  return [stats, refiner.triangles().slice()];
}

export function smaller(mesh: Mesh, hierarchy: Hierarchy): Uint8Array {
  try {
    return mesh.simplify({ error: 0.5 }).write("glb");
  } catch (error) {
    if (error instanceof OcclodError) console.log(error.message);
    return hierarchy.cut({ triangles: 1000 }).write("stl");
  }
}

// @ts-expect-error: either triangles or an error
export const both = (mesh: Mesh) => mesh.simplify({ triangles: 3, error: 1 });
