// Decodes the images that nodes have of their own, off the thread that draws. Where those of a picture would take more than a
// limit, each is halved as often.

export const texelBytes = 4 + (4 * 4) / 3; // decoded; and on the GPU, with smaller versions
const halvingsAtMost = 15;
const calm = 0.7; // of the limit: images are halved less often only below this, lest each picture decodes all anew

const isFrame = (marker) => marker >= 0xffc0 && marker <= 0xffcf && ![0xffc4, 0xffc8, 0xffcc].includes(marker);

// Width and height that a PNG or a JPEG claims; undefined where it is neither.
export function sizeOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length >= 24 && view.getUint32(0) === 0x89504e47) return [view.getUint32(16), view.getUint32(20)];
  if (bytes.length < 4 || view.getUint16(0) !== 0xffd8) return undefined;
  for (let at = 2; at + 9 <= bytes.length && bytes[at] === 0xff; at += 2 + view.getUint16(at + 2))
    if (isFrame(view.getUint16(at))) return [view.getUint16(at + 7), view.getUint16(at + 5)];
  return undefined;
}

const halved = (size, times) => Math.max(1, Math.ceil(size / 2 ** times));

async function decode(bytes, [width, height], halvings) {
  return createImageBitmap(new Blob([bytes]), {
    colorSpaceConversion: "none",
    premultiplyAlpha: "none",
    ...(halvings ? { resizeWidth: halved(width, halvings), resizeHeight: halved(height, halvings), resizeQuality: "medium" } : {}),
  });
}

export class NodeImages {
  #limit;
  #read;
  #fail;
  #sizes = new Map(); // by node; undefined where it has no image that can be shown
  #given = new Map(); // by node: how often its image was halved
  #halvings = 0;

  /** `limit` bytes for a picture. `read(node)` returns an encoded image, or an empty array; `fail(node)` hears of bad ones. */
  constructor({ limit, read, fail }) {
    this.#limit = limit;
    this.#read = read;
    this.#fail = fail;
  }

  /** Forgets nodes that have left. */
  drop(nodes) {
    for (const node of nodes) this.#given.delete(node);
  }

  /** Resolves with {node, image} for each of the nodes of a picture whose image is not given yet, or not in the size that fits. */
  async of(nodes) {
    for (const node of nodes) if (!this.#sizes.has(node)) this.#sizes.set(node, this.#sizeOf(node));
    const shown = nodes.filter((node) => this.#sizes.get(node));
    this.#halvings = this.#halvingsFor(shown);
    const due = shown.filter((node) => this.#given.get(node) !== this.#halvings);
    const encoded = due.map(this.#read); // before anything is awaited: meshes leave
    const images = await Promise.all(due.map((node, i) => decode(encoded[i], this.#sizes.get(node), this.#halvings).catch(() => this.#spoil(node))));
    return due.map((node, i) => ({ node, image: images[i] })).filter(({ node, image }) => image && this.#given.set(node, this.#halvings));
  }

  #sizeOf(node) {
    const bytes = this.#read(node);
    const size = sizeOf(bytes);
    if (size || !bytes.length) return size;
    return this.#spoil(node);
  }

  #spoil(node) {
    this.#sizes.set(node, undefined);
    this.#fail(node);
  }

  #bytes(nodes, halvings) {
    return nodes.reduce((sum, node) => sum + this.#sizes.get(node).reduce((area, size) => area * halved(size, halvings), texelBytes), 0);
  }

  #halvingsFor(nodes) {
    for (let times = 0; times < halvingsAtMost; ++times)
      if (this.#bytes(nodes, times) <= (times < this.#halvings ? calm : 1) * this.#limit) return times;
    return halvingsAtMost;
  }
}
