/** Level of detail under a hard triangle budget, controlled by occlusion. Lengths are in the mesh's own unit. */

type Bytes = ArrayBuffer | ArrayBufferView;

/** Told the share that is done, in [0, 1]; false cancels, and then the call throws. */
type OnProgress = (done: number) => boolean | void;

/** Says in one line what is wrong, where, and what helps. */
export class OcclodError extends Error {}

/**
 * Loads the WebAssembly; everything else needs it. `wasm`: where `wasm/library.wasm` is, or its bytes, when it does not
 * lie beside the script. Later calls wait for the first.
 */
export function ready(options?: { wasm?: string | URL | Bytes | WebAssembly.Module }): Promise<void>;

export function version(): string;

/** The size of the memory of the module, bytes. It grows as it is needed and never shrinks; what is freed is reused. */
export function memoryBytes(): number;

type Until =
  /** At most so many triangles. */
  | { triangles: number; error?: undefined }
  /** No point of either surface farther from the other. */
  | { error: number; triangles?: undefined };

/** A triangle mesh. Call dispose() to give its memory back at once. */
export class Mesh {
  private constructor();
  /**
   * Reads PLY, OBJ, OFF, STL, glTF or GLB: the extension of `name` decides. `others`: the content of files that it names,
   * by name, such as materials, images and buffers.
   */
  static read(name: string, data: Bytes, options?: { others?: Record<string, Bytes>; onProgress?: OnProgress }): Mesh;
  /** A mesh of three coordinates for each vertex and three vertices for each triangle. */
  static of(arrays: { positions: ArrayLike<number>; triangles: ArrayLike<number> }): Mesh;
  readonly triangleCount: number;
  /** Three for each vertex, with a vertex for each set of attributes. A copy. */
  readonly positions: Float32Array;
  /** Three vertices for each triangle. A copy. */
  readonly triangles: Uint32Array;
  /** A mesh with fewer triangles, the same for every view. */
  simplify(options: Until & { onProgress?: OnProgress }): Mesh;
  /** The hierarchy that a Refiner needs. */
  build(options?: { onProgress?: OnProgress }): Hierarchy;
  /** The bytes of a file. */
  write(format: "glb" | "ply" | "stl" | "off"): Uint8Array;
  dispose(): void;
}

/** A mesh in all its levels of detail. Call dispose() to give its memory back; a Refiner keeps what it needs. */
export class Hierarchy {
  private constructor();
  /** Reads an .olod file. */
  static read(data: Bytes): Hierarchy;
  /** Writes an .olod file; without `compressed` twice the size or more, which the command line can map. */
  write(options?: { compressed?: boolean }): Uint8Array;
  /** Of the mesh that it was built from. */
  readonly triangleCount: number;
  /** The fewest that a cut or a refinement can have. */
  readonly baseTriangleCount: number;
  /** No cut is farther from the mesh. */
  readonly errorBound: number;
  /** Around `positions`. */
  readonly box: { min: number[]; max: number[] };
  /** What `positions` are relative to. Not 0 only where floats would lose digits. */
  readonly origin: number[];
  /** The axis that points up, as far as the format of the file says. */
  readonly up: "y" | "z";
  /** Three for each vertex, of all levels: triangles index them. A copy. */
  readonly positions: Float32Array;
  /** Three for each vertex; empty when the mesh had none. A copy. */
  readonly normals: Float32Array;
  /** sRGB and alpha, four for each vertex; empty when the mesh had none. A copy. */
  readonly colors: Uint8Array;
  /** A camera that sees all of it, with the size, angle and other settings of `camera`. */
  lookingAt(camera?: Partial<LookAt>): LookAt;
  /** A mesh of its own, the same for every view. */
  cut(options: Until): Mesh;
  dispose(): void;
}

/** A camera at `eye` that looks at `target`. */
export interface LookAt {
  eye: ArrayLike<number> & Iterable<number>;
  target: ArrayLike<number> & Iterable<number>;
  /** [0, 1, 0] when not given. */
  up?: ArrayLike<number> & Iterable<number>;
  /** The full vertical angle, degrees; 45 when not given. */
  fovY?: number;
  /** Pixels; 1024 x 768 when not given. */
  width?: number;
  height?: number;
  /** Distances; 0.01 and 100 when not given. */
  near?: number;
  far?: number;
  /** The height of the image for parallel rays. */
  orthographicHeight?: number;
}

/** The camera of a program that has matrices, by columns. */
export interface Matrices {
  worldToEye: Iterable<number>;
  eyeToClip: Iterable<number>;
  /** Pixels. */
  width: number;
  height: number;
  /** z on the near and on the far plane: WebGL, WebGPU, WebGPU reversed. "-1..1" when not given. */
  clipDepth?: "-1..1" | "0..1" | "1..0";
}

export type Camera = LookAt | Matrices;

export interface RefineOptions {
  /** The most triangles of all objects together, never exceeded; 10,000 when not given. */
  budget?: number;
  /** Spend no more of the budget than this error in pixels needs; 0 when not given: spend it. */
  tolerancePx?: number;
  /** Give hidden surface no triangles; true when not given. */
  occlusion?: boolean;
  /** Let only what stays hidden for certain be hidden; false when not given. */
  conservative?: boolean;
}

export interface RefineStats {
  triangles: number;
  /** Triangles that differ from those of the call before. */
  changedTriangles: number;
  /** Questions whether something is hidden, and how many were answered so. */
  queries: number;
  queriesHidden: number;
  /** What is left on visible surface: a bound, and about the root mean square. */
  maxErrorPx: number;
  maxQuadricErrorPx: number;
  /** The priority of what would have been next. */
  levelPx: number;
  refineMs: number;
  occlusionMs: number;
}

/** Chooses the triangles of hierarchies for a camera. Call dispose() to give its memory back. */
export class Refiner {
  /** `transform`: 16 numbers by columns, its coordinates to world. */
  constructor(objects: Hierarchy | (Hierarchy | { hierarchy: Hierarchy; transform?: Iterable<number>; twoSided?: boolean })[]);
  /** Places an object elsewhere, from the next call on. */
  setTransform(object: number, transform: Iterable<number>): void;
  /** Refines from the coarsest mesh. */
  refine(camera: Camera, options?: RefineOptions): RefineStats;
  /** Goes on from the call before: for every frame. */
  update(camera: Camera, options?: RefineOptions): RefineStats;
  /**
   * Three indices into the hierarchy's positions for each triangle. Valid until the next call of anything here, and no
   * copy: upload it at once.
   */
  triangles(object?: number): Uint32Array;
  /** First and count of the triangles that have changed, in pairs. Valid as triangles(). */
  changes(object?: number): Uint32Array;
  /** Equal when the triangles are; the same as that of the C++ library. */
  readonly hash: string;
  /**
   * How the camera sees each triangle of all objects: 0 owns a pixel, 1 hidden or smaller than a pixel, 2 faces away,
   * 3 off screen.
   */
  seen(camera: Camera): Uint8Array;
  dispose(): void;
}
