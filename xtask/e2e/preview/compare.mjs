// Two pictures beside each other.

import { SIZE, browser, check, generation, keep, newer } from "./check.mjs";
import { SCENE, assert, equal, finished, open, pixels, save } from "./setting.mjs";

const isBlack = ({ rgb }) => rgb.every((byte) => byte === 0);
const sum = (all) => all.reduce((sum, { rgb }) => sum + rgb[0] + rgb[1] + rgb[2], 0);
const alike = (a, b, holds) => a.every((pixel, i) => !holds(pixel) || String(pixel.rgb) === String(b[i].rgb));

await check("pictures are compared", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  const resaved = async (text) => {
    const last = await generation(page);
    save(scene, text);
    await newer(page, last);
    await finished(page);
    return pixels(page, SIZE);
  };
  await finished(page);
  const old = await pixels(page, SIZE);
  assert(sum(old) > 0, "there is a picture");
  await page.keyboard.press("b");
  await page.getByText("Difference").click();
  assert((await pixels(page, SIZE)).every(isBlack), "a picture differs from itself");
  // Its values come at another scale where the exposure is another one.
  const bright = SCENE.replace("exposure: 0", "exposure: 8");
  assert((await resaved(bright)).every(isBlack), "a picture differs from the same at another scale");
  const other = await resaved(SCENE.replace("#d94f30", "#3050d9"));
  const changed = other.filter((pixel) => !isBlack(pixel));
  assert(changed.length > 100, `${changed.length} pixels differ where a ball has another colour`);
  assert(other.filter(({ y }) => y < 8).every(isBlack), "the sky differs where a ball has another colour");
  await keep(page, "difference");
  for (let i = 0; i < 4; i++) await page.keyboard.press("]");
  const amplified = sum(await pixels(page, SIZE));
  assert(amplified > 1.2 * sum(other), `a stop more makes ${amplified} of ${sum(other)}`);
  await page.keyboard.press("0");
  await page.getByText("Split").click();
  const split = await pixels(page, SIZE);
  await keep(page, "split");
  await page.keyboard.press("x");
  const flipped = await pixels(page, SIZE);
  assert(alike(flipped, old, () => true), "flipped, the pinned picture is shown");
  await page.keyboard.press("x");
  const now = await pixels(page, SIZE);
  assert(!alike(now, old, () => true), "flipped back, the new picture is shown");
  assert(alike(split, old, ({ x }) => x < SIZE[0] / 2 - 1), "left of the divider is the pinned picture");
  assert(alike(split, now, ({ x }) => x > SIZE[0] / 2 + 1), "right of the divider is the new picture");
  equal(page.problems.join("; "), "", "what the console says");
});
