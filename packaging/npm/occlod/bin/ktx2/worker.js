// A thread of `occlod ktx2`: encodes the images of one content after the other.
import { parentPort } from "node:worker_threads";
import { encodeToKTX2 } from "ktx2-encoder";
import sharp from "sharp";
import { withKtx2Images } from "./glb.js";

const MOST_TEXELS = 12 << 20; // that the encoder takes
const OPTIONS = { isUASTC: false, qualityLevel: 255, compressionLevel: 1, generateMipmap: true, isKTX2File: true, isPerceptual: true, isSetKTX2SRGBTransferFunc: true };

sharp.concurrency(1); // images wait for the encoder
parentPort.on("message", async ({ name, bytes }) => {
  const counts = { images: 0, left: 0, texels: 0, before: 0, after: 0 };
  const encode = async (image) => {
    const { data, info: { width, height } } = await sharp(image).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
    if (width % 4 !== 0 || height % 4 !== 0 || width * height > MOST_TEXELS) { // KHR_texture_basisu wants whole blocks
      ++counts.left;
      return null;
    }
    const encoded = await encodeToKTX2(image, { ...OPTIONS, imageDecoder: () => ({ data, width, height }) });
    ++counts.images;
    counts.texels += width * height;
    counts.before += image.length;
    counts.after += encoded.length;
    return encoded;
  };
  try {
    parentPort.postMessage({ name, counts, bytes: await withKtx2Images(bytes, encode) });
  } catch (error) {
    parentPort.postMessage({ name, error: String(error.message ?? error) });
  }
});
