// What each check of the preview is run with: a scene of its own that is followed, and a browser.

import { join } from "node:path";
import { SCENE, assert, browse, save, until, watch } from "./setting.mjs";

/// The folder of the step: scenes, and pictures of the page.
export const desk = process.cwd();
/// Width and height of the picture of `SCENE`.
export const SIZE = [240, 160];
export const browser = await browse();
const failed = [];

/// One thing that must hold. The scene is `SCENE` unless told otherwise.
export async function check(name, { flags = [], env = {}, text = SCENE }, does) {
  const scene = join(desk, `${name.replaceAll(/[^a-z]+/g, "-")}.rt`);
  save(scene, text);
  const start = performance.now();
  let watched;
  try {
    watched = await watch(scene, flags, env);
    await does(watched, scene);
    console.log(`  ${name}: ${Math.round(performance.now() - start)} ms`);
  } catch (error) {
    console.log(`  ${name}: FAILED: ${error.message}\n${watched?.said() ?? ""}`);
    failed.push(`${name}: ${error.message}`);
  } finally {
    await watched?.end();
    for (const context of browser.contexts()) await context.close();
  }
}

/// Ends with failure if anything did not hold.
export async function end() {
  await browser.close();
  if (failed.length === 0) return;
  console.log(`failed:\n${failed.join("\n")}`);
  process.exit(1);
}

/// Keeps a picture of the page, of which nothing may stick out.
export async function keep(page, name, options = {}) {
  const beyond = await page.evaluate(() => Math.max(...[...document.querySelectorAll("body, body *:not(#stage, pre *, .tools *)")].map((part) => part.getBoundingClientRect().right)) - innerWidth);
  assert(beyond < 1, `${name}: something sticks out by ${beyond} pixels`);
  await page.screenshot({ path: join(desk, `${name}.png`), ...options });
}

export const generation = (page) => page.locator("#stage").getAttribute("data-generation").then(Number);

/// Waits until the picture is of another text than it was.
export const newer = (page, than) => until("a newer picture is shown", async () => (await generation(page)) > than);
