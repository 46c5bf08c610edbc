// A server of range requests over a simulated link, which loses, stalls and damages what a test says.
import fs from "node:fs";
import http from "node:http";
import path from "node:path";

const types = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm", ".json": "application/json" };
const chunkBytes = 16384;

// `folders`: by first part of the path, served at once and whole. `slow`: likewise, over the link: `bytesPerSecond` for all
// answers together, `latencyMs` before each. `fault(request)`: called for each request of `slow`, numbered from 0 in
// `request.number`, with its file and range; may return "drop", "stall", a status, or bytes in place of those of the file.
export async function serve({ folders = {}, slow = {}, bytesPerSecond = Infinity, latencyMs = 0, fault = () => undefined }) {
  const told = { requests: 0, bytes: 0, aborted: 0 };
  const link = { fault, bytesPerSecond, latencyMs };
  let free = 0; // the time at which the link has sent all that it was given

  const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
  const pass = async (bytes) => {
    free = Math.max(free, performance.now()) + (1000 * bytes) / link.bytesPerSecond;
    const wait = free - performance.now();
    if (wait > 1) await sleep(wait);
  };

  async function answerSlowly(file, request, response) {
    const all = fs.statSync(file).size;
    const range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? "");
    const begin = range ? Number(range[1]) : 0;
    const end = range ? Math.min(Number(range[2]) + 1, all) : all;
    const number = told.requests++;
    let over = false;
    response.on("close", () => {
      if (!response.writableFinished) ++told.aborted;
      over = true;
    });
    const cause = link.fault({ number, file, begin, end });
    await sleep(link.latencyMs);
    if (cause === "drop") return request.socket.destroy();
    if (typeof cause === "number") return response.writeHead(cause).end();
    let bytes = Buffer.alloc(end - begin);
    const descriptor = fs.openSync(file, "r");
    fs.readSync(descriptor, bytes, 0, bytes.length, begin);
    fs.closeSync(descriptor);
    if (cause instanceof Uint8Array) bytes = cause;
    const headers = { "Content-Type": types[path.extname(file)] ?? "application/octet-stream", "Content-Length": bytes.length, "Access-Control-Allow-Origin": "*", "Access-Control-Expose-Headers": "Content-Range", "Cache-Control": "no-store" };
    response.writeHead(range ? 206 : 200, range ? { ...headers, "Content-Range": `bytes ${begin}-${end - 1}/${all}` } : headers);
    for (let at = 0; at < bytes.length && !over; at += chunkBytes) {
      if (cause === "stall" && at > 0) return; // for ever
      const chunk = bytes.subarray(at, at + chunkBytes);
      await pass(chunk.length);
      told.bytes += chunk.length;
      response.write(chunk);
    }
    response.end();
  }

  const server = http.createServer((request, response) => {
    const [, first, ...rest] = decodeURIComponent(new URL(request.url, "http://here").pathname).split("/");
    const isSlow = first in slow;
    const file = path.join((isSlow ? slow : folders)[first] ?? "/nowhere", ...rest);
    if (!fs.existsSync(file) || !fs.statSync(file).isFile()) return response.writeHead(404).end();
    if (isSlow) return answerSlowly(file, request, response).catch(() => response.destroy());
    response.writeHead(200, { "Content-Type": types[path.extname(file)] ?? "application/octet-stream" });
    fs.createReadStream(file).pipe(response);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    told,
    link,
    close: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}
