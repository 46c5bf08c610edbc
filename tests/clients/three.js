// three.js FOLDER --cameras FILE [--error PX] [--size WxH] [--png FILE] [--frame N]: the same as cesium.js with 3DTilesRendererJS, on three.html.
import { createReadStream, existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { option, open } from "./browser.js";

const [width, height] = option("--size", "1024x768").split("x").map(Number);
const modules = option("--modules");
const types = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".png": "image/png", ".jpg": "image/jpeg" };
const server = createServer((request, response) => {
  const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
  const [, first, ...rest] = path.split("/");
  const folders = { tileset: process.argv[2], modules, "": dirname(fileURLToPath(import.meta.url)) };
  const file = first in folders ? join(folders[first], ...rest) : join(folders[""], first);
  if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end();
  response.writeHead(200, { "Content-Type": types[extname(file)] ?? "application/octet-stream" });
  createReadStream(file).pipe(response);
}).listen(0, "127.0.0.1");
await new Promise((resolve) => server.on("listening", resolve));
const { browser, page, complaints } = await open(`http://127.0.0.1:${server.address().port}/three.html?error=${option("--error", "2")}`, width, height);
await page.waitForFunction("window.occlod && window.occlod.look", { timeout: 60000 });
const rows = [], files = { contents: 0, images: 0 };
page.on("request", (request) => {
  files.contents += /\.glb$/.test(request.url());
  files.images += /\/tileset\/.*\.(png|jpg)$/.test(request.url());
});
for (const [index, camera] of JSON.parse(readFileSync(option("--cameras"), "utf8")).cameras.entries()) {
  rows.push(await page.evaluate((at) => window.occlod.look(at), camera));
  if (index === Number(option("--frame", "0")) && option("--png", "")) await page.screenshot({ path: option("--png") });
}
const failed = await page.evaluate("window.occlod.failed");
const mean = (key) => rows.reduce((sum, row) => sum + row[key], 0) / rows.length;
console.log(JSON.stringify({ client: "3DTilesRendererJS", cameras: rows.length, triangles: mean("triangles"), tiles: mean("tiles"), pixels: mean("pixels"), texels: mean("texels"),
                             resident_texels: mean("resident_texels"), ...files, failed, complaints, rows }));
await browser.close();
server.close();
process.exit(failed > 0 || complaints.length > 0 || rows.some((row) => row.triangles === 0) ? 1 : 0);
