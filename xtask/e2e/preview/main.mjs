// The preview as a person sees it: Debian's Chromium on the page of the built command. Pictures of the page stay in the
// folder of the step.

import { existsSync } from "node:fs";
import { join } from "node:path";
import { deaf, guarded } from "./guard.mjs";
import { SCENE, assert, browse, equal, finished, load, open, placeOf, run, save, shown, until, watch } from "./setting.mjs";

const SIZE = [240, 160];
const desk = process.cwd();
const browser = await browse();
const failed = [];

/// One thing that must hold, with a scene of its own that is followed.
async function check(name, flags, does) {
  const scene = join(desk, `${name.replaceAll(/[^a-z]+/g, "-")}.rt`);
  save(scene, SCENE);
  const start = performance.now();
  let watched;
  try {
    watched = await watch(scene, flags.flags ?? [], flags.env ?? {});
    await does(watched, scene);
    console.log(`  ${name}: ${Math.round(performance.now() - start)} ms`);
  } catch (error) {
    console.log(`  ${name}: FAILED: ${error.message}\n${watched?.said() ?? ""}`);
    failed.push(name);
  } finally {
    await watched?.end();
    for (const context of browser.contexts()) await context.close();
  }
}

/// Keeps a picture of the page, of which nothing may stick out.
async function keep(page, name, options = {}) {
  const beyond = await page.evaluate(() => Math.max(...[...document.querySelectorAll("body, body *:not(#stage, pre *, .tools *)")].map((part) => part.getBoundingClientRect().right)) - innerWidth);
  assert(beyond < 1, `${name}: something sticks out by ${beyond} pixels`);
  await page.screenshot({ path: join(desk, `${name}.png`), ...options });
}
const generation = (page) => page.locator("#stage").getAttribute("data-generation").then(Number);
/// Waits until the picture is of another text than it was.
const newer = (page, than) => until("a newer picture is shown", async () => (await generation(page)) > than);

await check("a picture arrives", {}, async ({ url }) => {
  const page = await open(browser, url);
  await finished(page);
  const values = await shown(page);
  assert(new Set(values.map(String)).size > 20, "the canvas shows a picture");
  equal(await page.textContent("#samples"), "16 of 16", "samples");
  await keep(page, "dark");
  const light = await open(browser, url, { colorScheme: "light" });
  await keep(light, "light");
  const narrow = await open(browser, url, { viewport: { width: 390, height: 780 } });
  await keep(narrow, "narrow", { fullPage: true });
  equal([...page.problems, ...light.problems, ...narrow.problems].join("; "), "", "what the console says");
});

await check("errors are said as rtc check says them", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  const before = await shown(page);
  save(scene, SCENE.replace("radius: size", "radius: 8deg").replace("power:", "powr:"));
  await page.waitForSelector("#messages:not([hidden])");
  equal(await page.textContent("#messages-text"), run("check", scene).stderr, "the text");
  const after = await shown(page);
  assert(after.some((pixel) => pixel[3] > 0) && before.length === after.length, "the last good picture stays");
  assert((await page.textContent("#badge")).includes("last good"), "it says that it is the last good one");
  const link = page.locator("#messages-text .place").first();
  equal(await link.getAttribute("href"), `vscode://file${scene}:4:25`, "the first place leads to the editor");
  await keep(page, "error");
  save(scene, SCENE);
  await page.waitForSelector("#messages", { state: "hidden" });
  await finished(page);
  equal(page.problems.join("; "), "", "what the console says");
});

await check("nothing flashes", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  await page.keyboard.press("]");
  const exposure = await page.textContent("#exposure-text");
  // Every frame that is painted is looked at.
  await page.evaluate(() => {
    const stage = document.getElementById("stage");
    const context = stage.getContext("2d");
    window.blank = 0;
    window.looks = 0;
    const look = () => {
      const { data } = context.getImageData(stage.width / 2 - 20, stage.height / 2 - 20, 40, 40);
      for (let i = 3; i < data.length; i += 4) if (data[i] === 0) window.blank++;
      window.looks++;
      requestAnimationFrame(look);
    };
    look();
  });
  for (let i = 0; i < 20; i++) {
    const last = await generation(page);
    save(scene, SCENE.replace("#d94f30", `#d94f${(30 + i).toString()}`).replace("50cm", `${40 + i}cm`));
    await newer(page, last);
  }
  const { blank, looks } = await page.evaluate(() => ({ blank: window.blank, looks: window.looks }));
  equal(blank, 0, "blank pixels");
  assert(looks > 20, `${looks} frames were looked at`);
  equal(await page.textContent("#exposure-text"), exposure, "the exposure survives");
  await page.keyboard.press("+");
  const zoom = await page.textContent("#zoom-fit");
  assert(zoom !== "fit", "it is zoomed");
  await page.reload();
  await page.waitForSelector('#stage[data-step="1"]');
  await until("the zoom survives a reload", async () => (await page.textContent("#zoom-fit")) === zoom, 5000);
  equal(await page.textContent("#exposure-text"), exposure, "the exposure survives a reload");
});

await check("a pixel tells what the file holds", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  await finished(page);
  const exr = join(desk, "why.exr");
  const pfm = join(desk, "why.pfm");
  equal(run("build", scene, "-o", exr).status, 0, "rtc build");
  equal(run("develop", exr, "-o", pfm).status, 0, "rtc develop");
  const held = radiances(pfm);
  for (const pixel of [[120, 80], [100, 60], [10, 150], [200, 20]]) {
    const { x, y } = await placeOf(page, pixel, SIZE);
    await page.mouse.click(x, y);
    await page.waitForSelector(`#why[data-pixel="${pixel}"]:not([aria-busy])`);
    const told = JSON.parse(await page.locator("#why [data-radiance]").getAttribute("data-radiance"));
    const wanted = held(...pixel);
    for (const channel of [0, 1, 2]) {
      const off = Math.abs(told[channel] - wanted[channel]);
      assert(off <= 1e-5 * Math.abs(wanted[channel]) + 1e-9, `pixel ${pixel} is ${told}, and ${wanted} in the file`);
    }
  }
  const { x, y } = await placeOf(page, [120, 80], SIZE);
  await page.mouse.click(x, y);
  await page.waitForSelector('#why[data-pixel="120,80"]:not([aria-busy])');
  await page.mouse.move(0, 0);
  const before = String(await shown(page));
  await page.locator("#why .uses .place").first().focus();
  await until("what stands there is lit up", async () => String(await shown(page)) !== before, 5000);
  await keep(page, "why");
  await page.locator("#why .uses .place").first().blur();
  await until("it is as it was", async () => String(await shown(page)) === before, 5000);
});

/// Reads a PFM: a function of x and y.
function radiances(path) {
  const bytes = load(path, null);
  const [, width, height] = /^PF\n(\d+) (\d+)\n/.exec(bytes.toString("latin1", 0, 64)).map(Number);
  const at = bytes.length - width * height * 12;
  return (x, y) => [0, 4, 8].map((channel) => bytes.readFloatLE(at + ((height - 1 - y) * width + x) * 12 + channel));
}

const opened = join(desk, "opened");
const editor = { flags: ["--open-with"], env: { RTC_EDITOR: `ln -s {file} ${opened}-{line}-{column}` } };
await check("a click opens the editor at the line", editor, async ({ url }, scene) => {
  const page = await open(browser, url);
  save(scene, SCENE.replace("radius: size", "radius: 8deg"));
  await page.locator("#messages-text .place").first().click();
  await until("the command has run", () => existsSync(`${opened}-7-41`), 5000);
});

await check("who may ask", {}, ({ url }) => guarded(url));

await check("strange messages are answered", {}, async ({ url }) => {
  const page = await open(browser, url);
  const answers = await page.evaluate(async () => {
    const socket = new WebSocket(new URL("socket", location.href).href.replace("http", "ws"));
    await new Promise((resolve) => (socket.onopen = resolve));
    const strange = ["", "{}", "[".repeat(5000), '{"type":"halt"}', '{"type":"why","id":1,"x":-1,"y":1e99}', '{"type":"open","file":"/etc/passwd","line":1,"column":1}', new Uint8Array(9)];
    const answers = [];
    for (const message of strange) {
      const answer = new Promise((resolve) => (socket.onmessage = ({ data }) => typeof data === "string" && JSON.parse(data).type === "error" && resolve("answered")));
      socket.send(message);
      answers.push(await answer);
    }
    const closed = new Promise((resolve) => (socket.onclose = () => resolve("closed")));
    socket.send(" ".repeat(70_000));
    answers.push(await closed);
    return answers;
  });
  equal(answers.join(), `${"answered,".repeat(7)}closed`, "answers");
  equal(await page.getAttribute("#state", "data-state") !== "away", true, "the other page is still served");
});

await check("it goes on after a restart", { env: { XDG_RUNTIME_DIR: desk } }, async (watched, scene) => {
  const page = await open(browser, watched.url);
  const { port } = new URL(watched.url);
  await watched.end();
  await page.waitForSelector("#state[data-state=away]");
  const again = await watch(scene, [`--serve=127.0.0.1:${port}`], { XDG_RUNTIME_DIR: desk });
  equal(again.url, watched.url, "the address");
  await finished(page);
  await again.end();
  // Where the secret is another one, the page says so.
  await page.waitForSelector("#state[data-state=away]");
  const moved = await watch(scene, [`--serve=127.0.0.1:${port}`], { XDG_RUNTIME_DIR: "" });
  await until("the page says that it has moved", async () => (await page.textContent("#reason")).includes("new address"));
  await moved.end();
});

await check("a stop is a factor of two", {}, async ({ url }) => {
  const page = await open(browser, url);
  await finished(page);
  const before = await shown(page, 5000);
  for (let i = 0; i < 4; i++) await page.keyboard.press("]");
  equal(await page.textContent("#exposure-text"), "1.00 stops (+ 1.00)", "exposure");
  const after = await shown(page, 5000);
  const linear = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
  let compared = 0;
  before.forEach((pixel, i) => {
    for (const channel of [0, 1, 2]) {
      // Neither burnt out, nor so dark that the steps of a byte are coarse.
      if (pixel[3] === 0 || pixel[channel] < 64 || after[i][channel] > 250) continue;
      const factor = linear(after[i][channel]) / linear(pixel[channel]);
      assert(Math.abs(factor - 2) < 0.08, `${pixel} became ${after[i]}`);
      compared++;
    }
  });
  assert(compared > 50, `${compared} values were compared`);
});

await check("a slow page slows nobody", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  const slow = [await deaf(url), await deaf(url), await deaf(url)];
  const rounds = async () => {
    const start = performance.now();
    for (let i = 0; i < 10; i++) {
      const last = await generation(page);
      save(scene, load(scene, "utf8").replace(/param size: length = \d+cm/, `param size: length = ${30 + i}cm`));
      await newer(page, last);
    }
    return performance.now() - start;
  };
  const withSlow = await rounds();
  slow.forEach((socket) => socket.destroy());
  const without = await rounds();
  assert(withSlow < 2 * without + 500, `10 saves took ${Math.round(withSlow)} ms beside slow pages, ${Math.round(without)} ms without`);
});

await check("params are set and written back", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  await finished(page);
  const last = await generation(page);
  await page.locator("#param-size").fill("75cm");
  await page.keyboard.press("Enter");
  await newer(page, last);
  await page.locator(".param.is-set").waitFor();
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.click("#copy-set");
  await until("the flags are copied", async () => (await page.evaluate(() => navigator.clipboard.readText())) === "--set 'size=75cm'", 5000);
  await keep(page, "params");
  await page.getByRole("button", { name: "Write" }).click();
  await until("the file says so", () => load(scene, "utf8").includes("param size: length = 75cm in 10cm to 1m"), 5000);
  equal(page.problems.join("; "), "", "what the console says");
});

await check("pictures are compared, windowed and saved", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  await finished(page);
  await page.keyboard.press("b");
  const last = await generation(page);
  save(scene, SCENE.replace("#d94f30", "#3050d9"));
  await newer(page, last);
  await finished(page);
  await keep(page, "split");
  await page.getByText("Difference").click();
  await keep(page, "difference");
  await page.keyboard.press("b");
  await page.keyboard.press("n");
  await keep(page, "noise");
  await page.keyboard.press("n");
  await page.keyboard.press("c");
  const [from, to] = [await placeOf(page, [60, 40], SIZE), await placeOf(page, [120, 80], SIZE)];
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 4 });
  await page.mouse.up();
  await page.waitForSelector("#crop[aria-pressed=true]");
  await keep(page, "window");
  const coming = page.waitForEvent("download");
  await page.click("#save-exr");
  const file = join(desk, "saved.exr");
  await (await coming).saveAs(file);
  equal(run("develop", file, "-o", join(desk, "saved.png")).status, 0, "the EXR is one");
  equal(page.problems.join("; "), "", "what the console says");
});

await browser.close();
if (failed.length) {
  console.log(`failed: ${failed.join("; ")}`);
  process.exit(1);
}
