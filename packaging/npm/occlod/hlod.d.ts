/** Hierarchies of small meshes, whole or from afar. A module of its own, so that a page which streams loads no more. */
import type { Camera } from "./index.js";

export { OcclodError } from "./index.js";

type Bytes = ArrayBuffer | ArrayBufferView;

/** Loads the WebAssembly; everything else needs it. `wasm`: where `wasm/hlod.wasm` is, or its bytes. */
export function ready(options?: { wasm?: string | URL | Bytes | WebAssembly.Module }): Promise<void>;

/** The size of the memory of the module, bytes. */
export function memoryBytes(): number;

export interface SelectOptions {
  /** Everything visible is off by at most so many pixels, unless meshes or the budget do not allow it; 1 when not given. */
  tolerancePx?: number;
  /** The most triangles: the tolerance grows until so many do; 0, no limit, when not given. */
  budget?: number;
  /** Leave out what is hidden; true when not given. */
  occlusion?: boolean;
  /** Tell how far vertices have slid to where the coarser node has them; false when not given. */
  geomorph?: boolean;
  /** What would be seen if everything moved by so many pixels is not hidden either; 0 when not given. */
  slackPx?: number;
  /** Fetch what would be seen after so many more frames, when nothing else is missing; 0, nothing, when not given. */
  prefetchFrames?: number;
}

export interface SelectStats {
  triangles: number;
  /** By which nodes were selected: that of the options, or what the budget needs. */
  tolerancePx: number;
  /** Of a node; larger than the tolerance only where meshes or the budget are too few. */
  largestErrorPx: number;
  /** Nodes that were left out, with all below them. */
  hidden: number;
  /** Nodes whose meshes have not come, so that coarser ones are selected. */
  missing: number;
  /** Equal when the same triangles are selected; without occlusion that of the C++ library. */
  hash: string;
}

export interface SelectedNode {
  node: number;
  /** Of its indices. `morph`: how far its vertices have slid, in [0, 1]. */
  ranges: { first: number; count: number; morph: number }[];
}

export interface NodeMesh {
  /** Three for each vertex, relative to Hlod.origin. */
  positions: Float32Array;
  /** Three for each vertex; empty when there are none. */
  normals: Float32Array;
  /** Three vertices for each triangle. */
  indices: Uint16Array;
  /** Linear light and alpha, four for each vertex, with the base colour of its material. */
  colors: Uint16Array;
  /** Four for each vertex: where it slides to, relative to where it is, and the place of its patch in patches(). */
  slides: Float32Array;
  /** The node's own image, PNG or JPEG; empty when there is none, or when it came damaged. */
  image: Uint8Array;
  /** Two for each vertex: where it is in the image, 65,535 for width and height, from the top left. Empty without an image. */
  imageCoordinates: Uint16Array;
}

/**
 * An .ohlod file: a mesh in nodes of some thousand triangles, of which each view selects some. It is read as a whole, or
 * fetched piece by piece: put() what open() asks for until it asks for nothing; then each select() makes requests, and
 * meshes that have arrived are used by the next one. Call dispose() to give its memory back.
 */
export class Hlod {
  /** A file of `byteLength` bytes that is fetched piece by piece; `name` is for messages. */
  constructor(name: string, byteLength: number);
  /** Reads a file that is there. `memory`: bytes of meshes that are unpacked at once. */
  static read(name: string, data: Bytes, options?: { memory?: number }): Hlod;
  put(offset: number, data: Bytes): void;
  /** Returns begin and end of what is missing; nothing when the file is open. `memory`: a hard limit for meshes, bytes. */
  open(options?: { memory?: number }): [number, number][];
  /** Of the input. */
  readonly triangleCount: number;
  readonly nodeCount: number;
  readonly levelCount: number;
  /** Around positions. */
  readonly box: { min: number[]; max: number[] };
  /** What positions are relative to. */
  readonly origin: number[];
  readonly up: "y" | "z";
  readonly hasNormals: boolean;
  /** Of vertices or materials. */
  readonly hasColors: boolean;
  /** Whether nodes have images of their own. */
  readonly hasImages: boolean;
  /** The limit for meshes and images that open() was given; frees what no longer fits. */
  set memory(bytes: number);
  /** 16 numbers by columns, its coordinates to world. */
  setTransform(transform: Iterable<number>): void;
  /** Selects nodes that together show everything visible, without gaps. */
  select(camera: Camera, options?: SelectOptions): SelectStats;
  /** By the last select(), about from front to back. A node may be there twice, with other triangles. */
  readonly selected: SelectedNode[];
  /** Some arrays of a node whose mesh is there, as those of selected nodes are. Copies. */
  mesh<Name extends keyof NodeMesh = "positions" | "normals" | "indices">(node: number, what?: Name[]): Pick<NodeMesh, Name>;
  /** The first index of each patch: the triangles that one coarser node replaces. */
  patches(node: number): Uint32Array;
  /** Of a node with an image, for each patch the first index of triangles that show their material's colour instead. */
  imageEnds(node: number): Uint32Array;
  /** What to fetch next, the most urgent first. `again`: it came damaged, and a cache may hold it. */
  nextRequest(): { id: number; begin: number; end: number; again: boolean } | undefined;
  /** The bytes of a request. */
  arrive(id: number, data: Bytes): void;
  /** They have not come: they are asked for again if they are still wanted. */
  lose(id: number): void;
  /** They never will: coarser nodes take the place of theirs. */
  fail(id: number, problem: string): void;
  /** Requests that have become needless. */
  takeCancelled(): number[];
  /** A line on each node, and each image of one, that has failed since the last call. */
  takeFailures(): string[];
  readonly store: { residentBytes: number; residentNodes: number; loadingBytes: number; budgetBytes: number; failed: number; loads: number; bytesLoaded: number; evictions: number };
  dispose(): void;
}
