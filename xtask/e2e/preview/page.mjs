// The server and its pages: who may ask, and what happens to who is strange, slow, or cut off.

import { browser, check, desk, generation, newer } from "./check.mjs";
import { deaf, guarded } from "./guard.mjs";
import { SCENE, assert, equal, finished, load, open, save, until, watch } from "./setting.mjs";

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

// More than what the system holds back for who does not read.
const large = { text: SCENE.replace("size: (240, 160), samples: 16", "size: (1920, 1080), samples: 4096") };
await check("a slow page slows nobody and is heard", large, async ({ url }, scene) => {
  const page = await open(browser, url);
  const slow = [await deaf(url), await deaf(url), await deaf(url)];
  const rounds = async () => {
    const start = performance.now();
    for (let i = 0; i < 5; i++) {
      const last = await generation(page);
      save(scene, load(scene, "utf8").replace(/param size: length = \d+cm/, `param size: length = ${30 + i}cm`));
      await newer(page, last);
      await page.waitForSelector('#stage[data-step="1"]');
    }
    return performance.now() - start;
  };
  const withSlow = await rounds();
  slow[0].say({ type: "pause", on: true });
  await page.waitForSelector("#state[data-state=paused]", { timeout: 30_000 });
  slow[1].say({ type: "pause", on: false });
  await page.waitForSelector("#state[data-state=rendering]", { timeout: 30_000 });
  slow.forEach(({ end }) => end());
  const without = await rounds();
  // Whoever waits for them waits for ever; how busy the machine is changes what is in between.
  assert(withSlow < 4 * without + 2000, `5 saves took ${Math.round(withSlow)} ms beside slow pages, ${Math.round(without)} ms without`);
});
