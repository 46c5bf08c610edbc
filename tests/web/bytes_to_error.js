// bytes_to_error.js FILE.ohlod TILESET...: bytes that come until a view is as fine as asked for, from an .ohlod by
// @occlod/three and from tilesets by 3DTilesRendererJS, beside the error of their pictures: depths against those of the
// .ohlod at a tenth of a pixel. Of the generated city (z up), from its box. Not part of check_web.sh: it takes minutes. Runs in
// build/web/tests, after it.
import path from "node:path";
import puppeteer from "puppeteer-core";

import { serve } from "./range_server.js";

const [file, ...tilesets] = process.argv.slice(2).map((name) => path.resolve(name));
const side = Number(process.env.SIDE ?? 960); // of the city, metres
const views = {
  overview: { eye: [-0.2 * side, -0.2 * side, 0.35 * side], target: [0.5 * side, 0.5 * side, 0] },
  roofs: { eye: [0.35 * side, 0.35 * side, 90], target: [0.6 * side, 0.6 * side, 0] },
  street: { eye: [480, 530, 1.7], target: [480, 800, 8] },
};
const here = process.cwd();
const folders = { modules: path.join(here, "node_modules"), page: here };
const slow = Object.fromEntries([file, ...tilesets].map((name, i) => [`data${i}`, i === 0 ? path.dirname(name) : name]));
const server = await serve({ folders, slow });
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--force-device-scale-factor=1"],
  protocolTimeout: 1200000,
});
const page = await browser.newPage();
page.on("pageerror", (error) => console.log(String(error)));
await page.setViewport({ width: 960, height: 600 });
await page.goto(`${server.url}/page/bytes_page.html`);
await page.waitForFunction(() => window.page);

async function measure(what, ...given) {
  const before = server.told.bytes;
  const told = await page.evaluate((what, given) => window.page[what](...given), what, given);
  return { bytes: server.told.bytes - before, ...told }; // an Ohlod says how much had come when its picture was complete
}

const url = `${server.url}/data0/${path.basename(file)}`;
console.log("view,what,asked_px,bytes,rms_px,share_off,triangles");
for (const [name, view] of Object.entries(views)) {
  const at = { up: [0, 0, 1], fovY: 60, ...view };
  const tell = (what, px, told) => console.log([name, what, px, told.bytes, told.rms.toFixed(4), told.off.toFixed(5), told.triangles].join(","));
  tell("reference", 0.1, await measure("ohlod", url, at, 0.1, false, { isReference: true }));
  for (const px of [0.5, 1, 2, 4, 8]) {
    for (const occlusion of [true, false]) tell(occlusion ? "ohlod, occlusion" : "ohlod", px, await measure("ohlod", url, at, px, occlusion));
  }
  for (const [i, tileset] of tilesets.entries())
    for (const px of [0.5, 1, 2, 4, 8, 16]) tell(path.basename(tileset), px, await measure("tiles", `${server.url}/data${i + 1}/tileset.json`, at, px));
}
await browser.close();
server.close();
