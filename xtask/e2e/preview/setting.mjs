// What the checks of the preview stand on: `rtc watch`, a browser, and scenes that are saved.

import { spawn, spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

/// The built command, and the folder of node_modules, as the task gives them.
export const [rtc, tools] = process.argv.slice(2);
const { chromium } = createRequire(join(tools, "package.json"))("playwright-core");

/// Headless, and without attempts to reach the network.
export const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

export const browse = () => chromium.launch({ executablePath: CHROMIUM, args: FLAGS });

export function assert(holds, message) {
  if (!holds) throw new Error(message);
}

export function equal(seen, wanted, what) {
  assert(seen === wanted, `${what}: ${JSON.stringify(seen)} in place of ${JSON.stringify(wanted)}`);
}

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/// Waits until something holds.
export async function until(what, holds, ms = 60_000) {
  const end = Date.now() + ms;
  for (;;) {
    const value = await holds();
    if (value) return value;
    if (Date.now() > end) throw new Error(`waited ${ms / 1000} s in vain until ${what}`);
    await pause(20);
  }
}

export const save = (scene, text) => writeFileSync(scene, text);
export const load = (path, encoding = "utf8") => readFileSync(path, encoding);

/// Runs the command to its end.
export const run = (...flags) => spawnSync(rtc, flags, { encoding: "utf8", env: { ...process.env, NO_COLOR: "1" } });

/// Follows a scene until `end` is called. `url` is the page's address.
export async function watch(scene, flags = [], env = {}) {
  const serve = flags.some((flag) => flag.startsWith("--serve")) ? [] : ["--serve=127.0.0.1:0"];
  const child = spawn(rtc, ["watch", scene, ...serve, ...flags], { env: { ...process.env, NO_COLOR: "1", ...env } });
  let said = "";
  let printed = "";
  child.stderr.on("data", (data) => (said += data));
  child.stdout.on("data", (data) => (printed += data));
  const ended = new Promise((resolve) => child.on("exit", resolve));
  const url = await until("the address is printed", () => /http:\S+/.exec(printed)?.[0]);
  const end = async () => {
    child.kill("SIGINT");
    await ended;
  };
  return { url, end, child, said: () => said };
}

/// A page of the preview that has shown a picture with every pixel. `before` is run in it before anything else.
export async function open(browser, url, options = {}, before = () => {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 760 }, colorScheme: "dark", ...options });
  await context.addInitScript(before);
  const page = await context.newPage();
  page.problems = [];
  page.on("pageerror", (error) => page.problems.push(error.message));
  page.on("console", (message) => message.type() === "error" && page.problems.push(message.text()));
  await page.goto(url);
  await page.waitForSelector('#stage[data-step="1"]', { timeout: 120_000 });
  return page;
}

/// Waits until the picture of the newest text is finished.
export const finished = (page) => page.waitForSelector("#state[data-state=done]", { timeout: 120_000 });

/// The middle of a pixel of the picture on the page.
export async function placeOf(page, [x, y], size) {
  const box = await page.evaluate(() => document.getElementById("stage").getBoundingClientRect().toJSON());
  const zoom = Math.min((box.width - 24) / size[0], (box.height - 24) / size[1]);
  return { x: box.x + (box.width - size[0] * zoom) / 2 + (x + 0.5) * zoom, y: box.y + (box.height - size[1] * zoom) / 2 + (y + 0.5) * zoom };
}

/// The bytes that the page shows on its canvas, at some of its pixels: red, green, blue and alpha of each.
export const shown = (page, count = 500) =>
  page.evaluate(async (count) => {
    // What has arrived is drawn with the next frame.
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const stage = document.getElementById("stage");
    const { data } = stage.getContext("2d").getImageData(0, 0, stage.width, stage.height);
    const all = [];
    for (let i = 0; i < count; i++) {
      const at = 4 * Math.floor(((i + 0.5) / count) * stage.width * stage.height);
      all.push([...data.slice(at, at + 4)]);
    }
    return all;
  }, count);

/// Reads a PFM: a function of x and y.
export function radiances(path) {
  const bytes = load(path, null);
  const [, width, height] = /^PF\n(\d+) (\d+)\n/.exec(bytes.toString("latin1", 0, 64)).map(Number);
  const at = bytes.length - width * height * 12;
  return (x, y) => [0, 4, 8].map((channel) => bytes.readFloatLE(at + ((height - 1 - y) * width + x) * 12 + channel));
}

/// Red, green and blue of every fourth pixel across and down of a picture that is shown as large as it goes.
export const pixels = (page, size) =>
  page.evaluate(async ([width, height]) => {
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const stage = document.getElementById("stage");
    const zoom = Math.min((stage.width - 24) / width, (stage.height - 24) / height);
    const { data } = stage.getContext("2d").getImageData(0, 0, stage.width, stage.height);
    const all = [];
    for (let y = 2; y < height; y += 4) {
      for (let x = 2; x < width; x += 4) {
        const column = Math.floor((stage.width - width * zoom) / 2 + (x + 0.5) * zoom);
        const row = Math.floor((stage.height - height * zoom) / 2 + (y + 0.5) * zoom);
        const at = 4 * (row * stage.width + column);
        all.push({ x, y, rgb: [...data.slice(at, at + 3)] });
      }
    }
    return all;
  }, size);

/// Listens beside the page, from its own place: `heard()` gives the newest status, and of each picture that came since how
/// many samples its pixels have, at least and at most.
export async function eavesdrop(page) {
  await page.evaluate(async () => {
    const socket = new WebSocket(new URL("socket", location.href).href.replace("http", "ws"));
    window.heard = { status: null, pictures: [] };
    socket.onmessage = ({ data }) => {
      if (typeof data !== "string") return;
      const message = JSON.parse(data);
      if (message.type === "status") window.heard.status = message;
      if (message.type === "frame") window.heard.pictures.push({ samples: message.samples });
    };
    await new Promise((resolve) => (socket.onopen = resolve));
  });
  await page.waitForFunction(() => window.heard.status && window.heard.pictures.length > 0);
  return () => page.evaluate(() => window.heard);
}

/// Saves what a link of the page leads to.
export async function download(page, link, path) {
  const coming = page.waitForEvent("download");
  await page.click(link);
  await (await coming).saveAs(path);
  return path;
}

/// The scenes of the checks.
export const SCENE = `\
/// How large the ball is.
param size: length = 50cm in 10cm to 1m
camera { from: (0, 1, 4)m, look: (0, 0.5, 0)m, exposure: 0 }
light { at: (2, 3, 2)m, power: 400W }
sky { color: #8090a0, radiance: 0.1W/m2 }
plane { material: diffuse { color: #8a8f98 } }
sphere ball { at: (0, 0.5, 0)m, radius: size, material: diffuse { color: #d94f30 } }
render { size: (240, 160), samples: 16, tonemap: none }
`;
