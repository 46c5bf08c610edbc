// validate.js FOLDER...: every .glb below the folders by the glTF validator of Khronos. Prints each kind of message once, with counts; exit 1
// for errors and warnings.
import { readdirSync, readFileSync, statSync } from "node:fs";
import { dirname, join } from "node:path";
import validator from "gltf-validator";

const contents = (folder) => readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
  const path = join(folder, entry.name);
  return entry.isDirectory() ? contents(path) : entry.name.endsWith(".glb") ? [path] : [];
});

// The validator knows no KTX2; tileset_check.py does.
const KTX2 = { VALUE_NOT_IN_LIST: 2, IMAGE_UNRECOGNIZED_FORMAT: 2 };
const kinds = ["error", "warning", "info", "hint"];
let wrong = 0;
for (const folder of process.argv.slice(2)) {
  const totals = [0, 0, 0, 0];
  const messages = new Map();
  const files = contents(folder);
  for (const file of files) {
    const bytes = readFileSync(file);
    const report = await validator.validateBytes(new Uint8Array(bytes), {
      maxIssues: 0,
      severityOverrides: bytes.includes("KHR_texture_basisu") ? KTX2 : {},
      externalResourceFunction: (uri) => Promise.resolve(new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri))))),
    });
    const { numErrors, numWarnings, numInfos, numHints, messages: found } = report.issues;
    [numErrors, numWarnings, numInfos, numHints].forEach((count, kind) => { totals[kind] += count; });
    for (const { code, severity, message } of found)
      if (!messages.has(code)) messages.set(code, `${kinds[severity]}: ${code}: ${message} (${file})`);
  }
  for (const message of messages.values()) console.log(message);
  console.log(`${folder}: ${files.length} contents, ${totals[0]} errors, ${totals[1]} warnings, ${totals[2]} infos`);
  wrong += totals[0] + totals[1] + (files.length === 0);
}
process.exit(wrong > 0 ? 1 : 0);
