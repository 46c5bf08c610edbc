// The files of a tileset: those of a folder, or of an archive by the 3D Tiles Archive Format 1.3, a ZIP file without compression.
import { createHash } from "node:crypto";
import fs from "node:fs";
import path from "node:path";

const INDEX = "@3dtilesIndex1@";
const LOCAL = 0x04034b50, ENTRY = 0x02014b50, END = 0x06054b50, END_64 = 0x06064b50, LOCATOR_64 = 0x07064b50;
const IN_16_BITS = 0xffff, IN_32_BITS = 0xffffffff; // a number is to be found elsewhere

export const isArchive = (name) => name.toLowerCase().endsWith(".3tz");

const CRC = Uint32Array.from({ length: 256 }, (_, byte) => {
  for (let bit = 0; bit < 8; ++bit) byte = byte & 1 ? (byte >>> 1) ^ 0xedb88320 : byte >>> 1;
  return byte;
});
function crcOf(bytes) {
  let crc = -1;
  for (let i = 0; i < bytes.length; ++i) crc = (crc >>> 8) ^ CRC[(crc ^ bytes[i]) & 0xff];
  return ~crc >>> 0;
}

// Little-endian numbers, as [bytes, value] each.
function packed(...numbers) {
  const bytes = Buffer.alloc(numbers.reduce((sum, [size]) => sum + size, 0));
  let at = 0;
  for (const [size, value] of numbers) {
    if (size === 8) bytes.writeBigUInt64LE(BigInt(value), at);
    else bytes.writeUIntLE(value, at, size);
    at += size;
  }
  return bytes;
}

function readAt(file, offset, size) {
  const bytes = Buffer.alloc(size);
  if (fs.readSync(file, bytes, 0, size, offset) !== size) throw new Error("ends too early");
  return bytes;
}

// The directory of a ZIP file: its bytes, and how many entries it has.
function directoryOf(file) {
  const size = fs.fstatSync(file).size, tail = readAt(file, Math.max(0, size - 65557), Math.min(size, 65557));
  const at = tail.lastIndexOf(packed([4, END]));
  if (at < 0) throw new Error("is no archive");
  const locator = at >= 20 && tail.readUInt32LE(at - 20) === LOCATOR_64 && readAt(file, Number(tail.readBigUInt64LE(at - 12)), 56);
  if (!locator) return { count: tail.readUInt16LE(at + 10), bytes: readAt(file, tail.readUInt32LE(at + 16), tail.readUInt32LE(at + 12)) };
  const [count, length, offset] = [32, 40, 48].map((place) => Number(locator.readBigUInt64LE(place)));
  return { count, bytes: readAt(file, offset, length) };
}

// The offset of an entry's local header, which is in the field of 64-bit numbers where it does not fit.
function offsetOf(entry, fields) {
  const offset = entry.readUInt32LE(42);
  for (let at = 0; offset === IN_32_BITS && at + 12 <= fields.length; at += 4 + fields.readUInt16LE(at + 2))
    if (fields.readUInt16LE(at) === 1) return Number(fields.readBigUInt64LE(at + 4));
  return offset;
}

class ArchiveReader {
  constructor(name) {
    this.file = fs.openSync(name, "r");
    this.entries = new Map(); // by name
    const { count, bytes } = directoryOf(this.file);
    for (let at = 0, i = 0; i < count; ++i) {
      const entry = bytes.subarray(at), [nameSize, fieldsSize, commentSize] = [28, 30, 32].map((place) => entry.readUInt16LE(place));
      const entryName = entry.toString("utf8", 46, 46 + nameSize);
      if (entry.readUInt32LE(0) !== ENTRY || entry.readUInt16LE(10) !== 0) throw new Error(`${entryName || "its directory"} is compressed or damaged`);
      if (entryName !== INDEX) this.entries.set(entryName, { size: entry.readUInt32LE(24), offset: offsetOf(entry, entry.subarray(46 + nameSize, 46 + nameSize + fieldsSize)) });
      at += 46 + nameSize + fieldsSize + commentSize;
    }
  }
  get names() { return [...this.entries.keys()]; }
  read(name) {
    const { size, offset } = this.entries.get(name), header = readAt(this.file, offset, 30);
    if (header.readUInt32LE(0) !== LOCAL) throw new Error(`${name} is damaged`);
    return readAt(this.file, offset + 30 + header.readUInt16LE(26) + header.readUInt16LE(28), size);
  }
}

class ArchiveWriter {
  #end = 0;
  #entries = [];
  #index = []; // [MD5 of the name as two numbers, offset]
  constructor(name) { this.file = fs.openSync(name, "wx"); }

  write(name, bytes) {
    const digest = createHash("md5").update(name).digest();
    this.#index.push([digest.readBigUInt64LE(0), digest.readBigUInt64LE(8), BigInt(this.#end)]);
    this.#add(name, bytes);
  }
  finish() {
    this.#index.sort((a, b) => (a[0] < b[0] || (a[0] === b[0] && a[1] < b[1]) ? -1 : 1));
    this.#add(INDEX, packed(...this.#index.flat().map((value) => [8, value])));
    const offset = this.#end, count = this.#entries.length, directory = Buffer.concat(this.#entries);
    this.#append(directory);
    if (count >= IN_16_BITS || this.#end >= IN_32_BITS)
      this.#append(packed([4, END_64], [8, 44], [2, 45], [2, 45], [4, 0], [4, 0], [8, count], [8, count], [8, directory.length], [8, offset],
                          [4, LOCATOR_64], [4, 0], [8, offset + directory.length], [4, 1]));
    const few = Math.min(count, IN_16_BITS);
    this.#append(packed([4, END], [2, 0], [2, 0], [2, few], [2, few], [4, Math.min(directory.length, IN_32_BITS)], [4, Math.min(offset, IN_32_BITS)], [2, 0]));
    fs.closeSync(this.file);
  }

  #add(name, bytes) {
    const text = Buffer.from(name), isFar = this.#end >= IN_32_BITS;
    // Stored, without flags, of 1980-01-01.
    const described = [[2, 0], [2, 0], [2, 0], [2, 33], [4, crcOf(bytes)], [4, bytes.length], [4, bytes.length], [2, text.length]];
    const far = isFar ? packed([2, 1], [2, 8], [8, this.#end]) : Buffer.alloc(0);
    this.#entries.push(Buffer.concat([packed([4, ENTRY], [2, isFar ? 45 : 10], [2, isFar ? 45 : 10], ...described, [2, far.length], [2, 0], [2, 0], [2, 0], [4, 0],
                                             [4, isFar ? IN_32_BITS : this.#end]), text, far]));
    this.#append(Buffer.concat([packed([4, LOCAL], [2, 10], ...described, [2, 0]), text]));
    this.#append(bytes);
  }
  #append(bytes) {
    for (let done = 0; done < bytes.length;) done += fs.writeSync(this.file, bytes, done);
    this.#end += bytes.length;
  }
}

class FolderReader {
  constructor(folder) {
    this.folder = folder;
    this.names = fs.readdirSync(folder, { withFileTypes: true, recursive: true }).filter((entry) => entry.isFile())
      .map((entry) => path.relative(folder, path.join(entry.parentPath ?? entry.path, entry.name)).replaceAll(path.sep, "/")).sort();
  }
  read(name) { return fs.readFileSync(path.join(this.folder, name)); }
}

class FolderWriter {
  constructor(folder) { fs.mkdirSync(this.folder = folder); }
  write(name, bytes) {
    fs.mkdirSync(path.dirname(path.join(this.folder, name)), { recursive: true });
    fs.writeFileSync(path.join(this.folder, name), bytes);
  }
  finish() {}
}

/** The names of all files and read(name), of a folder or an archive. */
export const readTileset = (name) => (isArchive(name) ? new ArchiveReader(name) : new FolderReader(name));
/** write(name, bytes) for new files, and finish(). The folder or archive must not be there. */
export const writeTileset = (name) => (isArchive(name) ? new ArchiveWriter(name) : new FolderWriter(name));
