// A hilly sphere with images, as binary glTF: one hemisphere shows the first image, the other the second, but for a band that
// shows none and is red. Images are functions of the place, with lines, so that what is drawn wrongly is seen.
import zlib from "node:zlib";

const [around, down] = [360, 180]; // quads
const imageSize = 1024;

const crcTable = Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function png(width, height, rgb) {
  const chunk = (kind, data) => {
    const all = Buffer.concat([Buffer.alloc(4), Buffer.from(kind), data, Buffer.alloc(4)]);
    all.writeUInt32BE(data.length);
    all.writeUInt32BE(~all.subarray(4, -4).reduce((crc, byte) => crcTable[(crc ^ byte) & 255] ^ (crc >>> 8), -1) >>> 0, all.length - 4);
    return all;
  };
  const head = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0]);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let y = 0; y < height; ++y) rows.set(rgb.subarray(3 * width * y, 3 * width * (y + 1)), y * (1 + 3 * width) + 1);
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", head), chunk("IDAT", zlib.deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

// Rows from the top, which is the north pole.
function pattern(tint) {
  const rgb = Buffer.alloc(3 * imageSize ** 2);
  for (let y = 0, at = 0; y < imageSize; ++y)
    for (let x = 0; x < imageSize; ++x, at += 3) {
      const waves = [Math.sin(0.05 * x) * Math.cos(0.04 * y), Math.sin(0.31 * x + 0.2 * y), Math.cos(0.02 * (x - y))];
      const line = x % 64 < 3 || y % 64 < 3 ? 0.3 : 1;
      for (let k = 0; k < 3; ++k) rgb[at + k] = line * (tint[k] + 60 * waves[k]);
    }
  return rgb;
}
export const pngs = () => [[160, 110, 80], [70, 130, 170]].map((tint) => png(imageSize, imageSize, pattern(tint)));

// Many texels in few bytes.
export const largePngs = () => [70, 190].map((value) => png(2048, 2048, Buffer.alloc(3 * 2048 ** 2, value)));

// `images`: encoded, two.
export function glb(images, mimeType) {
  const parts = [[], [], []]; // three vertices for each triangle
  const vertices = [];
  for (let j = 0; j <= down; ++j)
    for (let i = 0; i <= around; ++i) {
      const [u, v] = [i / around, j / down];
      const [a, b] = [2 * Math.PI * (i % around) / around, Math.PI * v];
      const s = j % down === 0 ? 0 : Math.sin(b);
      const radius = 1 + 0.04 * Math.sin(7 * a) * s * Math.sin(9 * b) + 0.01 * Math.sin(41 * a) * s ** 2 * Math.cos(37 * b);
      vertices.push({ position: [radius * s * Math.sin(a), radius * Math.cos(b), radius * s * Math.cos(a)], u, v });
    }
  for (let j = 0; j < down; ++j)
    for (let i = 0; i < around; ++i) {
      const [a, b] = [j * (around + 1) + i, (j + 1) * (around + 1) + i];
      const isPlain = j >= 80 && j < 92 && i >= 40 && i < 110;
      const part = isPlain ? 2 : i < around / 2 ? 0 : 1;
      if (j > 0) parts[part].push(a, b, a + 1);
      if (j < down - 1) parts[part].push(a + 1, b, b + 1);
    }
  const [chunks, bufferViews, accessors] = [[], [], []];
  let length = 0;
  const view = (bytes) => {
    const padded = Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3)]);
    bufferViews.push({ buffer: 0, byteOffset: length, byteLength: bytes.length });
    chunks.push(padded);
    length += padded.length;
    return bufferViews.length - 1;
  };
  const accessor = (array, componentType, type, size, range = {}) => accessors.push({ bufferView: view(Buffer.from(array.buffer)), componentType, type, count: array.length / size, ...range }) - 1;
  const primitives = parts.map((indices, part) => {
    const used = [...new Set(indices)];
    const place = new Map(used.map((v, i) => [v, i]));
    const positions = Float32Array.from(used.flatMap((v) => vertices[v].position));
    const bounds = [Math.min, Math.max].map((of) => [0, 1, 2].map((k) => positions.reduce((best, value, i) => (i % 3 === k ? of(best, value) : best), positions[k])));
    const attributes = { POSITION: accessor(positions, 5126, "VEC3", 3, { min: bounds[0], max: bounds[1] }) };
    if (part < 2) attributes.TEXCOORD_0 = accessor(Float32Array.from(used.flatMap((v) => [2 * vertices[v].u - part, vertices[v].v])), 5126, "VEC2", 2);
    return { attributes, indices: accessor(Uint32Array.from(indices.map((v) => place.get(v))), 5125, "SCALAR", 1), material: part };
  });
  const shiny = { metallicFactor: 0, roughnessFactor: 1 };
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives }],
    materials: [
      ...[0, 1].map((index) => ({ name: `image${index}`, pbrMetallicRoughness: { baseColorTexture: { index }, ...shiny } })),
      { name: "plain", pbrMetallicRoughness: { baseColorFactor: [0.6, 0.02, 0.02, 1], ...shiny } },
    ],
    textures: [0, 1].map((source) => ({ source, sampler: 0 })),
    samplers: [{ wrapS: 33071, wrapT: 33071, magFilter: 9729, minFilter: 9987 }],
    images: images.map((bytes) => ({ bufferView: view(bytes), mimeType })),
    bufferViews,
    accessors,
    buffers: [{ byteLength: length }],
  };
  const text = Buffer.from(JSON.stringify(json));
  const head = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
  const word = (...values) => Buffer.from(Uint32Array.from(values).buffer);
  return Buffer.concat([word(0x46546c67, 2, 12 + 8 + head.length + 8 + length, head.length, 0x4e4f534a), head, word(length, 0x004e4942), ...chunks]);
}
