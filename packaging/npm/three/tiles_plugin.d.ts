import type { TilesRenderer } from "3d-tiles-renderer";

/** Of the last update. */
export interface TilesOcclusionStats {
  /** Bounding volumes that were asked. */
  tested: number;
  /** Tiles that were hidden, and so neither drawn nor refined. */
  hidden: number;
  /** Meshes that hide others, and those of their triangles that were drawn; 0 where the picture of the last update held. */
  occluders: number;
  occluderTriangles: number;
  /** Milliseconds of the main thread, of occluders and of tests. */
  drawMs: number;
  testMs: number;
}

/**
 * A plugin of 3DTilesRendererJS: what other tiles hide is neither drawn nor refined, and what is missing of it is loaded
 * last. Before each update it rasterises those of the tiles drawn last that cover most, for every camera, at the resolution
 * that the renderer has been told, and asks whether bounding volumes are behind them. So give the resolution of the picture;
 * with antialiasing, gaps thinner than a pixel may be missed. Opaque meshes hide, by the sides that are drawn; skinned,
 * instanced and batched ones do not, nor do those of ShaderMaterial. For a camera whose matrix is no rigid motion nothing is
 * culled, and the console says so. Hidden tiles cast no shadows, unless `displayActiveTiles` is set.
 */
export class TilesOcclusionPlugin {
  /** `wasm`: where `wasm/occlusion.wasm` is, or its bytes, when it does not lie beside the script. */
  constructor(options?: { wasm?: string | URL | ArrayBuffer | ArrayBufferView });
  readonly name: string;
  /** False shows everything again. */
  enabled: boolean;
  /** Settled when the WebAssembly is loaded, after registerPlugin(); before, nothing is culled. */
  readonly ready: Promise<void>;
  readonly stats: TilesOcclusionStats;
  /** What the renderer calls. */
  init(tiles: TilesRenderer): void;
  calculateTileViewError(tile: object, target: { inView: boolean }): boolean;
  dispose(): void;
}
