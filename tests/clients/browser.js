// Chromium without a window, drawing by software.
import { existsSync } from "node:fs";
import puppeteer from "puppeteer-core";

export function option(name, otherwise) {
  const index = process.argv.indexOf(name);
  if (index < 0 && otherwise === undefined) throw new Error(name + " is missing");
  return index < 0 ? otherwise : process.argv[index + 1];
}

export async function open(url, width, height) {
  const places = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
  const browser = await puppeteer.launch({
    executablePath: places.find((place) => place && existsSync(place)),
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--force-device-scale-factor=1"],
    protocolTimeout: 600000,
  });
  const page = await browser.newPage();
  await page.setViewport({ width, height });
  const complaints = [];
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error" && !message.text().includes("favicon") ) complaints.push(message.text()); });
  await page.goto(url);
  return { browser, page, complaints };
}
