// Replaces images of binary glTF files (glTF 2.0, 4.4) by KTX2 ones (KHR_texture_basisu).

const GLB = 0x46546c67, JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942;
const ALIGNMENT = 8; // what lies behind an image moves by a multiple

const padded = (size, to) => Math.ceil(size / to) * to;

function read(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== GLB || view.getUint32(4, true) !== 2 || view.getUint32(16, true) !== JSON_CHUNK)
    throw new Error("is no binary glTF 2.0 file");
  const end = 20 + view.getUint32(12, true);
  const gltf = JSON.parse(new TextDecoder().decode(bytes.subarray(20, end)));
  if (end === bytes.length) return { gltf, binary: bytes.subarray(end) };
  if (end + 8 > bytes.length || view.getUint32(end + 4, true) !== BINARY_CHUNK || end + 8 + view.getUint32(end, true) > bytes.length)
    throw new Error("is cut off, or its second chunk is not binary");
  return { gltf, binary: bytes.subarray(end + 8, end + 8 + view.getUint32(end, true)) };
}

function written(gltf, binary) {
  const json = new TextEncoder().encode(JSON.stringify(gltf));
  const jsonSize = padded(json.length, 4), binarySize = padded(binary.length, 4);
  const bytes = new Uint8Array(28 + jsonSize + binarySize), view = new DataView(bytes.buffer);
  [GLB, 2, bytes.length, jsonSize, JSON_CHUNK].forEach((word, i) => view.setUint32(4 * i, word, true));
  bytes.fill(0x20, 20 + json.length, 20 + jsonSize); // spaces
  bytes.set(json, 20);
  view.setUint32(20 + jsonSize, binarySize, true);
  view.setUint32(24 + jsonSize, BINARY_CHUNK, true);
  bytes.set(binary, 28 + jsonSize);
  return bytes;
}

// The numbers of the textures that show colours. Others, such as normals, lose too much by ETC1S.
function colorTextures(gltf) {
  const colors = new Set(), others = new Set();
  const visit = (value, key) => {
    if (typeof value !== "object" || value === null) return;
    if (key.endsWith("Texture") && Number.isInteger(value.index)) (/^(baseColor|emissive)Texture$/.test(key) ? colors : others).add(value.index);
    for (const [name, inner] of Object.entries(value)) visit(inner, name);
  };
  visit(gltf.materials ?? [], "");
  return [...colors].filter((texture) => !others.has(texture));
}

// The numbers of the images inside the file that only colour textures show, PNG and JPEG alone.
function colorImages(gltf) {
  const colors = new Set(colorTextures(gltf)), textures = [...(gltf.textures ?? []).entries()];
  return [...(gltf.images ?? []).keys()].filter((i) => {
    const users = textures.filter(([, texture]) => texture.source === i), { bufferView, mimeType } = gltf.images[i];
    return users.length > 0 && users.every(([number]) => colors.has(number)) && bufferView !== undefined && /^image\/(png|jpeg)$/.test(mimeType);
  });
}

// All that gives a range of the binary chunk: views, and what meshopt has packed for them.
function ranges(gltf) {
  return (gltf.bufferViews ?? []).flatMap((view) => [view, view.extensions?.EXT_meshopt_compression ?? view.extensions?.KHR_meshopt_compression])
    .filter((range) => range?.buffer === 0);
}

// Puts bytes in the places of ranges; what lies behind moves by a multiple of ALIGNMENT.
function withReplaced(gltf, binary, replaced) {
  replaced.sort((a, b) => a.first - b.first);
  const pieces = [], moves = []; // from an offset on, by so many bytes
  let at = 0, move = 0;
  for (const { first, end, bytes } of replaced) {
    const size = bytes.length + ((((end - first - bytes.length) % ALIGNMENT) + ALIGNMENT) % ALIGNMENT);
    const piece = new Uint8Array(size);
    piece.set(bytes);
    pieces.push(binary.subarray(at, first), piece);
    at = end;
    move += size - (end - first);
    moves.push({ from: end, move });
  }
  pieces.push(binary.subarray(at));
  for (const range of ranges(gltf)) {
    const offset = range.byteOffset ?? 0, last = moves.findLast(({ from }) => from <= offset);
    if (last) range.byteOffset = offset + last.move;
  }
  return Buffer.concat(pieces);
}

/**
 * Returns the file with all images of its colours as `encode` gives them, or null where it has none that can be replaced.
 * `encode(bytes)` returns a KTX2 file, or null for an image that stays. Throws where the file is damaged.
 */
export async function withKtx2Images(file, encode) {
  const { gltf, binary } = read(file);
  const images = colorImages(gltf), done = new Set(), replaced = [];
  for (const number of new Set(images.map((i) => gltf.images[i].bufferView))) {
    const view = gltf.bufferViews[number], first = view.byteOffset ?? 0, end = first + view.byteLength;
    if (view.buffer !== 0 || end > binary.length) throw new Error(`has an image in buffer view ${number} that is not in the file`);
    if (ranges(gltf).some((other) => other !== view && (other.byteOffset ?? 0) < end && (other.byteOffset ?? 0) + other.byteLength > first)) continue;
    const bytes = await encode(binary.subarray(first, end));
    if (!bytes) continue;
    replaced.push({ first, end, bytes, view });
    for (const i of images) if (gltf.images[i].bufferView === number) done.add(i);
  }
  if (done.size === 0) return null;
  const moved = withReplaced(gltf, binary, replaced);
  for (const { view, bytes } of replaced) view.byteLength = bytes.length;
  for (const i of done) gltf.images[i].mimeType = "image/ktx2";
  for (const texture of gltf.textures) {
    if (!done.has(texture.source)) continue;
    texture.extensions = { ...texture.extensions, KHR_texture_basisu: { source: texture.source } };
    delete texture.source;
  }
  for (const list of ["extensionsUsed", "extensionsRequired"]) gltf[list] = [...new Set([...(gltf[list] ?? []), "KHR_texture_basisu"])];
  gltf.buffers[0].byteLength = moved.length;
  return written(gltf, moved);
}
