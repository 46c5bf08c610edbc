#!/usr/bin/env node
// The command line.
import start from "../wasm/occlod.js";

await start({ arguments: process.argv.slice(2) });
