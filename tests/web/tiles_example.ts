// The plugin for 3DTilesRendererJS, for TypeScript's compiler.
import { TilesOcclusionPlugin, type TilesOcclusionStats } from "@occlod/three/tiles_plugin";
import { TilesRenderer } from "3d-tiles-renderer";
import { PerspectiveCamera } from "three";

export function show(url: string, camera: PerspectiveCamera): () => TilesOcclusionStats {
  const tiles = new TilesRenderer(url);
  const plugin = new TilesOcclusionPlugin({ wasm: "/wasm/occlusion.wasm" });
  tiles.registerPlugin(plugin);
  tiles.setCamera(camera);
  tiles.setResolution(camera, 1280, 720);
  plugin.ready.catch(() => (plugin.enabled = false));
  return () => plugin.stats;
}

// @ts-expect-error: no number
export const wrong = new TilesOcclusionPlugin({ wasm: 3 });
