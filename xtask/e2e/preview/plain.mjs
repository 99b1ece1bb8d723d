// A page in Chromium with nobody listening: what drives browsers for tests is told of all that comes over a socket, byte for
// byte, which takes longer than what is measured.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { CHROMIUM, FLAGS, until } from "./setting.mjs";

/// Opens a page, and waits until it shows a picture with every pixel.
export async function open(url, { width, height } = { width: 1280, height: 760 }) {
  const profile = mkdtempSync(join(tmpdir(), "rtc-page-"));
  const flags = [...FLAGS, "--headless=new", "--remote-debugging-pipe", `--user-data-dir=${profile}`, `--window-size=${width},${height}`, url];
  const child = spawn(CHROMIUM, flags, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  const call = talk(child.stdio[3], child.stdio[4]);
  const { targetId } = await until("there is a page", async () => {
    const { targetInfos } = await call("Target.getTargets", {});
    return targetInfos.find((target) => target.type === "page");
  });
  const { sessionId } = await call("Target.attachToTarget", { targetId, flatten: true });
  const evaluate = async (work, argument) => {
    const expression = `(${work})(${JSON.stringify(argument) ?? ""})`;
    const answer = await call("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true }, sessionId);
    if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description ?? "the page failed");
    return answer.result.value;
  };
  const mouse = (type, x, y) => call("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1 }, sessionId);
  const key = (type, name) => call("Input.dispatchKeyEvent", { type, key: name, code: name }, sessionId);
  // Before it is loaded there is nothing to ask.
  const there = () => evaluate(() => document.getElementById("stage")?.dataset.step === "1").catch(() => false);
  await until("the page shows a picture", there);
  return {
    evaluate,
    async click(x, y) {
      await mouse("mousePressed", x, y);
      await mouse("mouseReleased", x, y);
    },
    async press(name) {
      await key("keyDown", name);
      await key("keyUp", name);
    },
    async close() {
      child.kill();
      await ended;
      rmSync(profile, { recursive: true, force: true, maxRetries: 20 });
    },
  };
}

/// Calls by the DevTools protocol, whose messages end with a zero.
function talk(to, from) {
  const waiting = new Map();
  let [id, rest] = [0, ""];
  from.setEncoding("utf8");
  from.on("data", (data) => {
    const messages = (rest + data).split("\0");
    rest = messages.pop();
    for (const { id, result, error } of messages.map((message) => JSON.parse(message))) {
      const call = waiting.get(id);
      waiting.delete(id);
      if (error) call?.reject(new Error(error.message));
      else call?.resolve(result);
    }
  });
  return (method, params, sessionId) =>
    new Promise((resolve, reject) => {
      waiting.set(++id, { resolve, reject });
      to.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    });
}
