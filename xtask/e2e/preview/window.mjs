// The window that is rendered first, and all else that is done on the picture without a mouse.

import { SIZE, browser, check, keep } from "./check.mjs";
import { SCENE, assert, eavesdrop, equal, open, placeOf, until } from "./setting.mjs";

const press = async (page, key, times = 1) => {
  for (let i = 0; i < times; i++) await page.keyboard.press(key);
};

// So many that tracing the window alone takes several pictures, however fast the machine and slow the page.
const SAMPLES = 8192;
const long = { text: SCENE.replace("size: (240, 160), samples: 16", `size: (512, 320), samples: ${SAMPLES}`) };

await check("a window is spanned by keys and traced first", long, async ({ url }) => {
  const page = await open(browser, url);
  await press(page, "p");
  await page.waitForSelector("#state[data-state=paused]");
  // From the middle of the picture to a corner of the window, by steps of 16 pixels and of one.
  await page.focus("#stage");
  await press(page, "Control+Shift+ArrowLeft", 8);
  await press(page, "Control+Shift+ArrowUp", 2);
  await press(page, "Shift+ArrowRight");
  assert((await page.textContent("#under")).startsWith("129, 128 "), "the pixel that is chosen");
  await press(page, "c");
  await press(page, "Control+Shift+ArrowDown", 2);
  await press(page, "Shift+ArrowRight", 2);
  await press(page, "Control+Shift+ArrowRight", 3);
  await keep(page, "spanning");
  await press(page, "Enter");
  const heard = await eavesdrop(page);
  await until("the window is known", async () => String((await heard()).status.crop) === "129,128,51,33", 30_000);
  // Which pictures come while nothing is traced is up to how fast the page is: they have no more samples than now.
  const [base] = (await heard()).pictures.at(-1).samples;
  await press(page, "p");
  const beyond = () => heard().then(({ pictures }) => pictures.find(({ samples }) => samples[0] > base));
  const [, most] = (await until("the rest follows", beyond)).samples;
  equal(most, SAMPLES, "samples of the window when the rest follows");
  const { pictures } = await heard();
  const ahead = new Set(pictures.map(({ samples }) => samples[1]).filter((own) => own > base && own < SAMPLES));
  assert(ahead.size >= 3, `${ahead.size} pictures of the window alone came before the rest`);
  await keep(page, "window");
  await press(page, "c");
  await until("the window is let go of", async () => (await heard()).status.crop === null, 30_000);
  equal(page.problems.join("; "), "", "what the console says");
});

await check("a window is dragged", {}, async ({ url }) => {
  const page = await open(browser, url);
  const heard = await eavesdrop(page);
  await press(page, "c");
  const [from, to] = [await placeOf(page, [60, 40], SIZE), await placeOf(page, [120, 80], SIZE)];
  const drag = async () => {
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 4 });
    await page.mouse.up();
  };
  await press(page, "Escape");
  await drag();
  equal((await heard()).status.crop, null, "after Escape the hand moves the picture");
  await press(page, "f");
  await press(page, "c");
  await drag();
  await until("the window is known", async () => (await heard()).status.crop?.every((side, i) => Math.abs(side - [60, 40, 60, 40][i]) <= 1), 30_000);
  equal(await page.getAttribute("#crop", "aria-pressed"), "true", "the button");
});

await check("a pixel is asked about by keys and said once", { text: long.text }, async ({ url }) => {
  const page = await open(browser, url);
  await page.evaluate(() => {
    window.saidOnce = [];
    const said = document.getElementById("why-said");
    new MutationObserver(() => saidOnce.push(said.textContent)).observe(said, { childList: true });
    window.told = 0;
    new MutationObserver(() => told++).observe(document.getElementById("why"), { childList: true });
  });
  await page.focus("#stage");
  await press(page, "Shift+ArrowDown");
  await press(page, "Enter");
  await page.waitForSelector('#why[data-pixel="256,161"]');
  await until("the answer has become more exact", () => page.evaluate(() => told >= 4));
  const said = await page.evaluate(() => saidOnce);
  equal(said.length, 1, "how often it is read out");
  assert(/^Pixel 256, 161 shows a? ?\S+/.test(said[0]), said[0]);
  equal(await page.locator("[aria-live] #why").count(), 0, "regions that read out every refresh");
  await press(page, "Escape");
  await page.waitForSelector("#why-close", { state: "hidden" });
});
