// occlod ktx2 TILES -o OUT: a tileset whose images are KTX2 (ETC1S), which stay compressed in the memory of the GPU.
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { parseArgs } from "node:util";
import { Worker } from "node:worker_threads";
import { isArchive, readTileset, writeTileset } from "./tileset_files.js";

const HELP = `Turn the images in the contents of a tileset into KTX2
Usage: occlod ktx2 TILES -o OUT [--threads N]

  TILES            Folder of a tileset, or an archive (.3tz)
  -o,--output OUT  Folder or archive (.3tz) to write; must not be there
  --threads N      Number of threads [one for each core]
  --json           Print one JSON object

Needs the packages ktx2-encoder and sharp.`;
const MISSING = "the packages ktx2-encoder and sharp are missing; install them beside occlod: npm install ktx2-encoder sharp";

class Mistake extends Error {}

function parse(args) {
  let parsed;
  try {
    parsed = parseArgs({ args, allowPositionals: true, options: {
      output: { type: "string", short: "o" }, threads: { type: "string" }, json: { type: "boolean" }, help: { type: "boolean", short: "h" } } });
  } catch (error) {
    throw new Mistake(`${error.message}; see occlod ktx2 --help`);
  }
  const { values, positionals } = parsed, threads = Number(values.threads ?? os.availableParallelism());
  if (values.help) return null;
  if (positionals.length !== 1 || !values.output) throw new Mistake("takes one tileset and -o OUT; see occlod ktx2 --help");
  if (!Number.isInteger(threads) || threads < 1 || threads > 1024) throw new Mistake(`--threads ${values.threads} is no whole number in [1, 1024]`);
  const [from, to] = [positionals[0], values.output].map((name) => path.resolve(name));
  if (!fs.existsSync(from)) throw new Mistake(`${positionals[0]}: is not there; give the folder of a tileset, or an archive`);
  if (fs.existsSync(to)) throw new Mistake(`${values.output}: is there already; choose a new name`);
  if (to.startsWith(from + path.sep)) throw new Mistake(`${values.output}: lies in the tileset; choose another name`);
  return { name: positionals[0], from, to, threads, json: values.json };
}

// Calls take(name, answer) with what a worker tells of each content. All have ended when it fails.
async function encodeAll(tileset, names, threads, take) {
  let next = 0;
  const thread = () => new Promise((resolve, reject) => {
    const worker = new Worker(new URL("worker.js", import.meta.url), { stdout: true }); // the encoder talks
    worker.stdout.resume();
    const fail = (problem) => {
      next = names.length;
      worker.terminate().then(() => reject(problem));
    };
    const give = () => {
      if (next === names.length) return worker.terminate().then(resolve);
      const name = names[next++];
      worker.postMessage({ name, bytes: tileset.read(name) });
    };
    const attempt = (action) => { try { action(); } catch (problem) { fail(problem); } };
    worker.on("error", fail);
    worker.on("message", ({ name, error, ...answer }) => attempt(() => {
      if (error) throw new Error(`${name}: ${error}`);
      take(name, answer);
      give();
    }));
    attempt(give);
  });
  const ends = await Promise.allSettled(Array.from({ length: Math.min(threads, names.length) }, thread));
  for (const end of ends) if (end.status === "rejected") throw end.reason;
}

// Results come in any order, but files are written in that of the tileset.
function inOrder(names, write) {
  const waiting = new Map();
  let next = 0;
  return (name, bytes) => {
    waiting.set(name, bytes);
    for (; waiting.has(names[next]); waiting.delete(names[next++])) write(names[next], waiting.get(names[next]));
  };
}

async function convert({ from, to, threads }) {
  const total = { contents: 0, images: 0, left: 0, texels: 0, before: 0, after: 0 };
  const tileset = readTileset(from), { names } = tileset, contents = names.filter((name) => name.endsWith(".glb"));
  if (!names.includes("tileset.json")) throw new Error("has no tileset.json");
  const beside = path.join(path.dirname(to), `.${path.basename(to)}.${process.pid}.tmp${isArchive(to) ? ".3tz" : ""}`);
  const remove = () => fs.rmSync(beside, { recursive: true, force: true });
  const stop = () => { remove(); process.exit(130); };
  process.once("SIGINT", stop).once("SIGTERM", stop);
  try {
    const written = writeTileset(beside), write = inOrder(names, (name, bytes) => written.write(name, bytes));
    for (const name of names) if (!name.endsWith(".glb")) write(name, tileset.read(name));
    await encodeAll(tileset, contents, threads, (name, { bytes, counts }) => {
      write(name, bytes ?? tileset.read(name));
      for (const key of Object.keys(counts)) total[key] += counts[key];
      if (++total.contents % 10 === 0 && process.stderr.isTTY) process.stderr.write(`\rocclod ktx2: ${total.contents} of ${contents.length} contents `);
    });
    if (process.stderr.isTTY) process.stderr.write("\r\x1b[K");
    written.finish();
    fs.renameSync(beside, to);
  } finally {
    process.removeListener("SIGINT", stop).removeListener("SIGTERM", stop);
    remove();
  }
  return total;
}

function tell(to, { contents, images, left, texels, before, after }) {
  const mega = (count) => (count / 1e6).toFixed(1);
  console.log(`${to}: ${contents} contents, ${images} images of ${mega(texels)} million texels: ${mega(before)} MB before, ${mega(after)} MB as KTX2`);
  if (left > 0) console.log(`${left} images stay: their sides are no multiples of 4, or they have more than 12 million texels`);
}

/** Runs the command; returns its exit status. */
export async function run(args) {
  try {
    const options = parse(args);
    if (!options) return console.log(HELP), 0;
    for (const name of ["ktx2-encoder", "sharp"])
      await import(name).catch((error) => { throw error.code === "ERR_MODULE_NOT_FOUND" ? new Mistake(MISSING) : error; });
    const total = await convert(options).catch((error) => { throw new Mistake(`${options.name}: ${error.message}`); });
    options.json ? console.log(JSON.stringify(total)) : tell(options.to, total);
    return 0;
  } catch (error) {
    if (!(error instanceof Mistake)) throw error;
    console.error(`occlod ktx2: ${error.message}`);
    return 2;
  }
}
