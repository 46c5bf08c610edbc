// The examples of @occlod/three's README and of the guide, for TypeScript's compiler.
import { Ohlod } from "@occlod/three";
import { PerspectiveCamera, Scene, WebGLRenderer } from "three";

export async function show(scene: Scene, camera: PerspectiveCamera, renderer: WebGLRenderer): Promise<void> {
  const city = new Ohlod("https://example.org/city.ohlod", { memory: 256 * 2 ** 20, tolerancePx: 1 });
  city.addEventListener("failure", ({ message }) => console.warn(message));
  scene.add(city);
  await city.ready;
  const [x, y, z]: [number, number, number] = city.facts!.origin;
  city.position.set(x, y, z);
  renderer.setAnimationLoop(() => {
    city.update(camera, renderer);
    renderer.render(scene, camera);
  });
  await city.settled();
  console.log(city.stats.triangles, city.stats.bytesLoaded);
  city.tolerancePx = 2;
  city.dispose();
}

// @ts-expect-error: tolerances are numbers
export const wrong = () => new Ohlod("city.ohlod", { tolerancePx: "1" });
