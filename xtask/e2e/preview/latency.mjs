// How long it takes from a save to the screen: the built command and a page in Chromium, on the scene of the project's
// bars (640×360, about 100 primitives).

import { join } from "node:path";
import { open } from "./plain.mjs";
import { pause, placeOf, save, until, watch } from "./setting.mjs";

const ROUNDS = Number(process.argv[4] ?? 40);
const SIZE = [640, 360];
const scene = join(process.cwd(), "latency.rt");

/// A ring of balls; `color` is what a save changes.
const text = (color) => `\
param count: int = 96
plane { material: diffuse { color: #8a8f98 } }
material paint = diffuse { color: ${color} }
for i in range(count) {
  let a = 360deg * i / count
  sphere { at: ((1 + 0.6 * rand(i)) * 1m * cos(a), 8cm, (1 + 0.6 * rand(i)) * 1m * sin(a)), radius: 8cm, material: if mod(i, 3) == 0 then mirror {} else paint }
}
light { at: (2, 3, 2)m, radius: 20cm, power: 300W }
sky { color: #8090a0 }
camera { from: (0, 1.5, 3.4)m, look: (0, 0.2, 0)m, exposure: 0 }
render { size: (640, 360), samples: 4096 }
`;
const color = (i) => `rgb(0.8, ${(0.1 + (i % 50) / 100).toFixed(2)}, 0.2)`;

/// Notes when each thing has been painted, on the page's clock.
function watchPaints() {
  window.paints = [];
  const now = () => performance.timeOrigin + performance.now();
  // What is drawn in this task is on the screen after the next frame.
  const painted = (what) => requestAnimationFrame(() => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => window.paints.push({ ...what, at: now() });
    channel.port2.postMessage(null);
  });
  const stage = document.getElementById("stage");
  const told = new MutationObserver(() => painted({ kind: "picture", generation: Number(stage.dataset.generation), step: Number(stage.dataset.step) }));
  told.observe(stage, { attributeFilter: ["data-generation", "data-step", "data-samples"] });
  const messages = document.getElementById("messages");
  new MutationObserver(() => painted({ kind: messages.hidden ? "clear" : "messages" })).observe(messages, { attributeFilter: ["hidden"] });
  const why = document.getElementById("why");
  new MutationObserver(() => why.dataset.pixel && painted({ kind: "why", pixel: why.dataset.pixel })).observe(why, { attributeFilter: ["data-pixel"] });
}

const clock = () => performance.timeOrigin + performance.now();

/// Waits for the first paint of a kind, and gives its time.
const paint = (page, kind, { after = 0, step = 8, pixel = null } = {}) =>
  until(`${kind} is painted`, () => page.evaluate(
    ([kind, after, step, pixel]) =>
      window.paints.find((paint) => paint.kind === kind && !(paint.generation <= after) && !(paint.step > step) && (paint.pixel ?? null) === pixel)?.at,
    [kind, after, step, pixel],
  ));

const times = { "save to error painted": [], "save to first pixels": [], "save to full resolution": [], inspector: [], "cancelled and ended": [] };

async function measure(page) {
  const shown = () => page.evaluate(() => Number(document.getElementById("stage").dataset.generation));
  const clear = () => page.evaluate(() => (window.paints = []));
  for (let i = 0; i < ROUNDS; i++) {
    await pause(100 + (i * 37) % 60);
    const last = await shown();
    await clear();
    let start = clock();
    save(scene, text(color(i)));
    times["save to first pixels"].push((await paint(page, "picture", { after: last })) - start);
    times["save to full resolution"].push((await paint(page, "picture", { after: last, step: 1 })) - start);
    await clear();
    start = clock();
    save(scene, text(color(i)).replace("radius: 8cm", "radius: 8deg"));
    times["save to error painted"].push((await paint(page, "messages")) - start);
    save(scene, text(color(i)));
    await paint(page, "clear");
    await pause(200);
    await clear();
    const pixel = [40 + ((i * 97) % 560), 60 + ((i * 53) % 240)];
    const { x, y } = await placeOf(page, pixel, SIZE);
    start = clock();
    await page.click(x, y);
    times.inspector.push((await paint(page, "why", { pixel: String(pixel) })) - start);
    await page.press("Escape");
  }
}

/// From Ctrl-C in the middle of a render to the end of the process: what runs is let go of.
async function interrupt() {
  const watched = await watch(scene);
  await until("paths are traced", () => fetch(`${watched.url}picture.exr`).then((answer) => answer.ok));
  await pause(50);
  const start = clock();
  await watched.end();
  times["cancelled and ended"].push(clock() - start);
}

save(scene, text(color(49)));
const watched = await watch(scene);
try {
  const page = await open(watched.url);
  try {
    await page.evaluate(watchPaints);
    await measure(page);
  } finally {
    await page.close();
  }
} finally {
  await watched.end();
}
for (let i = 0; i < ROUNDS; i++) await interrupt();
const rank = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
console.log("ms                          p50     p95");
for (const [name, all] of Object.entries(times)) {
  const sorted = all.sort((a, b) => a - b);
  console.log(`${name.padEnd(24)}${rank(sorted, 0.5).toFixed(0).padStart(7)}${rank(sorted, 0.95).toFixed(0).padStart(8)}`);
}
