import type { Camera, Group, Material, Mesh, Object3DEventMap, WebGLRenderer } from "three";

export interface OhlodOptions {
  /** Everything visible is off by at most so many pixels, as far as it has come; 1 when not given. */
  tolerancePx?: number;
  /** The most triangles: the tolerance grows until so many do; 0, no limit, when not given. */
  budget?: number;
  /** Neither draw nor fetch what is hidden; found out in the worker. true when not given. */
  occlusion?: boolean;
  /**
   * How far things may move in the picture until an answer of the worker is drawn, pixels: what would be seen then is drawn
   * too. 24 when not given.
   */
  slackPx?: number;
  /** Let vertices slide from level to level, by morph targets; false when not given. */
  geomorph?: boolean;
  /**
   * A hard limit for meshes and images in the worker, in main memory and in that of the GPU together, bytes; 512 MiB when not
   * given. Images that would take more than a quarter are halved.
   */
  memory?: number;
  /**
   * Of all meshes. A standard material, with colours and normals of the file, when not given. Nodes with images of their own
   * have one that inherits from it, with their `map`.
   */
  material?: Material;
  /** At once; 6 when not given. */
  requests?: number;
  /** An answer that brings nothing for so long counts as lost; 4,000 when not given. */
  stallMs?: number;
  /**
   * Headers and others for fetch(); they go to the worker. The browser keeps no answers unless `cache` says so: Chrome would
   * make one request after the other.
   */
  fetchOptions?: RequestInit;
  /** Where wasm/hlod.wasm of the package occlod is, when it does not lie there. */
  wasm?: string | URL;
  /** A worker that runs worker.js of this package, for bundlers that do not find it. */
  worker?: Worker;
}

export interface OhlodStats {
  triangles: number;
  nodes: number;
  /** That nodes were selected by: that of the options, or what the budget needs. */
  tolerancePx: number;
  /** Of a node that is drawn; larger than the tolerance only where meshes have not come or the budget is too small. */
  largestErrorPx: number;
  /** Nodes that were left out because they are hidden. */
  hidden: number;
  /** Equal when the same triangles are drawn; without occlusion that of the C++ library. */
  hash: string;
  /** Nodes that have not come, so that coarser ones are drawn. */
  missing: number;
  /** Nodes that never come: damaged in the file, or refused by the server. */
  failed: number;
  /** Of OhlodOptions.memory. */
  memoryBytes: number;
  /** Over the network. */
  bytesLoaded: number;
  requests: number;
  lost: number;
  cancelled: number;
}

export interface OhlodEventMap extends Object3DEventMap {
  /** There is something new to draw: call update() and render. */
  change: {};
  /** Nothing more will come. */
  error: { error: Error };
  /**
   * A node never comes, and coarser ones take its place; its image is damaged, and it has the colours of its materials; or the
   * last camera sees nothing that can be drawn.
   */
  failure: { message: string };
}

/**
 * An .ohlod file that streams in. Its coordinates are relative to `facts.origin`; z is up where facts.up says so, so it may
 * have to be turned. Call update() before each frame, and dispose() in the end. What is drawn is a whole picture without
 * gaps, first a coarse one.
 */
export class Ohlod extends Group<OhlodEventMap> {
  constructor(url: string | URL, options?: OhlodOptions);
  readonly isOhlod: true;
  /** These may change at any time. */
  tolerancePx: number;
  budget: number;
  occlusion: boolean;
  slackPx: number;
  /** Resolves when the coarsest picture can be drawn; rejects with one line that says what is wrong. */
  readonly ready: Promise<this>;
  /** Once it is ready. */
  readonly facts?: {
    triangleCount: number;
    nodeCount: number;
    box: { min: number[]; max: number[] };
    origin: [number, number, number];
    up: "y" | "z";
    hasNormals: boolean;
    hasColors: boolean;
    /** Whether nodes have images of their own. Images that all nodes share are not shown. */
    hasImages: boolean;
  };
  readonly material: Material | undefined;
  readonly stats: OhlodStats;
  /** Asks for what this camera sees at the size of the renderer. Returns at once; what is drawn follows some frames later. */
  update(camera: Camera, renderer: WebGLRenderer): void;
  /** Whether what is drawn was selected for an earlier camera than that of the last update(). */
  readonly isBehind: boolean;
  /** Resolves when all has come that the last update() asked for. update() must go on being called. */
  settled(): Promise<void>;
  dispose(): void;
  children: Mesh[];
}
