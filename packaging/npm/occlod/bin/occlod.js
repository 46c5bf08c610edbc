#!/usr/bin/env node
// The command line. Its WebAssembly lies here as what the library lacks of it, which unpacks it.
import { readFileSync } from "node:fs";
import { connect } from "../calls.js";
import startLibrary from "../wasm/library.js";
import start from "../wasm/occlod.js";

const read = (name) => readFileSync(new URL(`../wasm/${name}`, import.meta.url));
const [base, patch] = [read("library.wasm"), read("occlod.wasm.patch")];
const { ready, library, withBytes, copy } = connect(startLibrary);
await ready({ wasm: base });
const wasmBinary = withBytes([base, patch], (...at) => copy(Uint8Array, library()._occlod_patched(at[0], base.length, at[1], patch.length)));
await start({ arguments: process.argv.slice(2), wasmBinary });
