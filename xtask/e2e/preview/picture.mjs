// The picture: it arrives, it is whole at any time, and what is saved of it is what `rtc build` makes.

import { join } from "node:path";
import { SIZE, browser, check, desk, generation, keep, newer } from "./check.mjs";
import { SCENE, assert, download, equal, finished, load, open, pixels, run, save, shown, until } from "./setting.mjs";

await check("a picture arrives", {}, async ({ url }) => {
  const page = await open(browser, url);
  await finished(page);
  const values = await shown(page);
  assert(new Set(values.map(String)).size > 20, "the canvas shows a picture");
  equal(await page.textContent("#samples"), "16 of 16", "samples");
  await keep(page, "dark");
  const light = await open(browser, url, { colorScheme: "light" });
  await keep(light, "light");
  await light.keyboard.press("?");
  await keep(light, "keys");
  const narrow = await open(browser, url, { viewport: { width: 390, height: 780 } });
  await keep(narrow, "narrow", { fullPage: true });
  equal([...page.problems, ...light.problems, ...narrow.problems].join("; "), "", "what the console says");
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
  await until("the zoom survives a reload", async () => (await page.textContent("#zoom-fit")) === zoom, 30_000);
  equal(await page.textContent("#exposure-text"), exposure, "the exposure survives a reload");
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

/// Lets what comes over the page's sockets be held, from the end of the next picture on.
function holdable() {
  const { set } = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
  window.held = { on: false, waiting: [] };
  Object.defineProperty(WebSocket.prototype, "onmessage", {
    set(hear) {
      set.call(this, (event) => {
        const isEnd = typeof event.data === "string" && JSON.parse(event.data).type === "frame";
        if (held.on && (isEnd || held.waiting.length > 0)) held.waiting.push(() => hear(event));
        else hear(event);
      });
    },
  });
}

await check("a picture is shown once it is whole", { text: SCENE.replace("samples: 16", "samples: 4096") }, async ({ url, end }) => {
  const page = await open(browser, url, {}, holdable);
  await page.keyboard.press("p");
  await page.waitForSelector("#state[data-state=paused]");
  await until("no picture is under way", async () => {
    const before = String(await pixels(page, SIZE));
    await page.waitForTimeout(300);
    return String(await pixels(page, SIZE)) === before;
  });
  await page.keyboard.press("]");
  const before = JSON.stringify(await pixels(page, SIZE));
  await page.keyboard.press("[");
  await page.evaluate(() => (held.on = true));
  await page.keyboard.press("p");
  await page.waitForFunction(() => held.waiting.length > 0);
  await page.keyboard.press("]");
  assert(JSON.stringify(await pixels(page, SIZE)) === before, "tiles of the next picture are shown before its end");
  await end();
  await page.waitForSelector("#state[data-state=away]");
  await page.keyboard.press("[");
  await page.keyboard.press("]");
  assert(JSON.stringify(await pixels(page, SIZE)) === before, "tiles of a picture that never came are shown");
  await page.evaluate(() => held.waiting.splice(0).forEach((hear) => hear()));
});

await check("what is saved is what rtc build makes", {}, async ({ url }, scene) => {
  const page = await open(browser, url);
  await finished(page);
  const [exr, png] = [join(desk, "built.exr"), join(desk, "built.png")];
  equal(run("build", scene, "-o", exr).status, 0, "rtc build");
  const floats = (path) => {
    equal(run("develop", path, "-o", `${path}.pfm`).status, 0, `rtc develop ${path}`);
    return load(`${path}.pfm`, null);
  };
  const saved = await download(page, "#save-exr", join(desk, "saved.exr"));
  assert(floats(saved).equals(floats(exr)), "the EXR holds the radiance of rtc build");
  // As it is shown here, not as the file says.
  for (let i = 0; i < 4; i++) await page.keyboard.press("]");
  await page.selectOption("#tonemap", "agx");
  equal(run("develop", exr, "--exposure", "1", "--tonemap", "agx", "-o", png).status, 0, "rtc develop");
  const shown = await download(page, "#save-png", join(desk, "saved.png"));
  assert(load(shown, null).equals(load(png, null)), "the PNG is what rtc develop makes of it");
});
