#!/usr/bin/env node
// The command line. Its WebAssembly is packed by Brotli: what pages load is not.
import { readFileSync } from "node:fs";
import { brotliDecompressSync } from "node:zlib";

if (process.argv[2] === "ktx2") {
  const { run } = await import("./ktx2/command.js");
  process.exitCode = await run(process.argv.slice(3));
} else {
  const { default: start } = await import("../wasm/occlod.js");
  const packed = readFileSync(new URL("../wasm/occlod.wasm.br", import.meta.url));
  await start({ arguments: process.argv.slice(2), wasmBinary: brotliDecompressSync(packed) });
}
