#!/usr/bin/env node
// The command line. Its WebAssembly lies here as what the library lacks of it, which unpacks it.
import { readFileSync } from "node:fs";

async function runCommandLine() {
  const { connect } = await import("../calls.js");
  const { default: startLibrary } = await import("../wasm/library.js");
  const { default: start } = await import("../wasm/occlod.js");
  const read = (name) => readFileSync(new URL(`../wasm/${name}`, import.meta.url));
  const [base, patch] = [read("library.wasm"), read("occlod.wasm.patch")];
  const { ready, library, withBytes, copy } = connect(startLibrary);
  await ready({ wasm: base });
  const wasmBinary = withBytes([base, patch], (...at) => copy(Uint8Array, library()._occlod_patched(at[0], base.length, at[1], patch.length)));
  await start({ arguments: process.argv.slice(2), wasmBinary });
}

if (process.argv[2] === "ktx2") {
  const { run } = await import("./ktx2/command.js");
  process.exitCode = await run(process.argv.slice(3));
} else {
  await runCommandLine();
}
