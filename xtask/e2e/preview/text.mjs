// Between the text and the picture: errors, places, params, and why.

import { existsSync } from "node:fs";
import { join } from "node:path";
import { SIZE, browser, check, desk, generation, keep, newer } from "./check.mjs";
import { SCENE, assert, equal, finished, load, open, pixels, placeOf, radiances, run, save, shown, until } from "./setting.mjs";

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
  await until("what stands there is lit up", async () => String(await shown(page)) !== before, 20000);
  await keep(page, "why");
  await page.locator("#why .uses .place").first().blur();
  await until("it is as it was", async () => String(await shown(page)) === before, 30_000);
});

/// How many pixels are darkened, and whether one of them is this.
const darkened = (before, after) => {
  const isDarker = ({ rgb }, i) => Math.max(...rgb) > 16 && after[i].rgb.every((byte, channel) => byte < 0.6 * rgb[channel] + 1);
  const dark = before.filter(isDarker);
  return { count: dark.length, has: (x, y) => dark.some((pixel) => pixel.x === x && pixel.y === y) };
};

await check("a place of the text is found in the picture", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  await finished(page);
  const plain = await pixels(page, SIZE);
  const find = async (text) => {
    const before = await page.textContent("#find-said");
    await page.keyboard.press("/");
    await page.keyboard.type(text);
    await page.keyboard.press("Enter");
    await until(`\`${text}\` is answered`, async () => (await page.textContent("#find-said")) !== before, 30_000);
    await page.locator("#stage").focus();
    return { said: await page.textContent("#find-said"), ...darkened(plain, await pixels(page, SIZE)) };
  };
  const [ball, floor, sky] = [[122, 82], [10, 150], [10, 2]];
  const lit = (found) => [ball, floor, sky].map((pixel) => !found.has(...pixel)).join();
  const whole = await find("7");
  equal(lit(whole), "true,false,false", "what is lit for the ball's line");
  const number = ({ said }) => Number(/^([\d\u202f]+) pixels show it\.$/.exec(said)[1].replaceAll("\u202f", ""));
  const share = number(whole) / (SIZE[0] * SIZE[1]) + whole.count / plain.length;
  assert(Math.abs(share - 1) < 0.02, `${whole.said} and ${whole.count} of ${plain.length} are dark`);
  await keep(page, "find");
  equal(lit(await find("6:20")), "false,true,false", "what is lit for the floor's material");
  equal(lit(await find(`${scene.split("/").pop()}:5`)), "false,false,true", "what is lit for the sky");
  for (const [text, said] of [
    ["4", "The light that stands there is a point: no pixel shows it."],
    ["2:8", "Nothing stands there that a pixel could show."],
    ["3", "Nothing stands there that a pixel could show."],
    ["99", `\`${scene}\` has no line 99.`.replace("`", "`")],
    ["lamp.rt:3", "The scene has no file `lamp.rt`."],
    ["the ball", "`the ball` is no place. A line, or file:line:column. The pixels that show what stands there are lit up."],
  ]) {
    if ((await page.textContent("#find-said")) === said) await page.click("#find-clear");
    const found = await find(text);
    equal(found.said, said, `what is said to ${text}`);
    equal(found.count, 0, `what is darkened for ${text}`);
  }
  // It is looked for again in the next text.
  await find("7");
  const last = await generation(page);
  save(scene, SCENE.replace("50cm", "60cm"));
  await newer(page, last);
  await until("more pixels show a larger ball", async () => number({ said: await page.textContent("#find-said") }) > number(whole), 30_000);
  const light = await open(browser, url, { colorScheme: "light" });
  await light.keyboard.press("/");
  await light.keyboard.type("4");
  await light.keyboard.press("Enter");
  await until("it is answered", async () => (await light.textContent("#find-said")).includes("point"), 30_000);
  await keep(light, "find-light");
  equal(page.problems.join("; "), "", "what the console says");
});

const opened = join(desk, "opened");
const editor = { flags: ["--open-with"], env: { RTC_EDITOR: `ln -s {file} ${opened}-{line}-{column}` } };
await check("a click opens the editor at the line", editor, async ({ url }, scene) => {
  const page = await open(browser, url);
  save(scene, SCENE.replace("radius: size", "radius: 8deg"));
  await page.locator("#messages-text .place").first().click();
  await until("the command has run", () => existsSync(`${opened}-7-41`), 30_000);
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
  await until("the flags are copied", async () => (await page.evaluate(() => navigator.clipboard.readText())) === "--set 'size=75cm'", 30_000);
  await keep(page, "params");
  await page.getByRole("button", { name: "Write" }).click();
  await until("the file says so", () => load(scene, "utf8").includes("param size: length = 75cm in 10cm to 1m"), 30_000);
  equal(page.problems.join("; "), "", "what the console says");
});

await check("a value whose param is gone can be dropped", {}, async ({ url }) => {
  const context = await browser.newContext();
  const page = await context.newPage();
  // As if it had been set before the file lost it.
  const gone = { name: "height", type: "", doc: null, default: "", value: "3m", set: true, low: null, high: null };
  const said = [];
  await page.routeWebSocket(/socket$/, (socket) => {
    const server = socket.connectToServer();
    socket.onMessage((message) => {
      said.push(JSON.parse(message));
      server.send(message);
    });
    server.onMessage((message) => {
      const told = typeof message === "string" ? JSON.parse(message) : {};
      if (told.type === "status") told.params.push(gone);
      socket.send(told.type === "status" ? JSON.stringify(told) : message);
    });
  });
  await page.goto(url);
  const row = page.locator(".param", { has: page.locator("#param-height") });
  equal(await row.getByRole("textbox").inputValue(), "3m", "the value");
  await keep(page, "param-gone");
  assert(!(await row.getByRole("button", { name: "Write" }).isVisible()), "there is no place to write it to");
  await row.getByRole("button", { name: "Reset" }).click();
  await until("it is dropped", () => said.some(({ type, name, value }) => type === "set" && name === "height" && value === ""), 30_000);
});
