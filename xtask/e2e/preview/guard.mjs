// Who may ask: requests as a browser would not send them, or another page would.

import { Socket } from "node:net";
import { equal } from "./setting.mjs";

/// The status of an answer to a request written by hand.
function status(port, lines) {
  return new Promise((resolve, reject) => {
    const socket = new Socket();
    let answer = "";
    socket.setTimeout(5000, () => socket.destroy(new Error("no answer")));
    socket.on("data", (data) => {
      answer += data;
      const found = /^HTTP\/1\.1 (\d+)/.exec(answer);
      if (found) {
        resolve(Number(found[1]));
        socket.destroy();
      }
    });
    socket.on("error", reject);
    socket.connect(port, "127.0.0.1", () => socket.write(`${lines.join("\r\n")}\r\n\r\n`));
  });
}

const UPGRADE = ["Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="];

export async function guarded(url) {
  const { port, pathname } = new URL(url);
  const host = `Host: 127.0.0.1:${port}`;
  const token = pathname.slice(1, -1);
  const other = token.replace(/./g, (digit) => (digit === "0" ? "1" : "0"));
  const get = (path, ...headers) => status(port, [`GET ${path} HTTP/1.1`, ...headers]);
  equal(await get(pathname, host), 200, "the page");
  equal(await get(pathname, "Host: evil.example"), 403, "a foreign host");
  equal(await get(pathname, "Host: evil.example:" + port), 403, "a foreign host with our port");
  equal(await get(pathname, host, "Origin: http://evil.example"), 403, "a foreign origin");
  equal(await get("/", host), 403, "no secret");
  equal(await get(`/${other}/`, host), 403, "a wrong secret");
  equal(await get("/socket", host, ...UPGRADE), 403, "a socket without the secret");
  equal(await get(`${pathname}socket`, host, ...UPGRADE), 403, "a socket from nowhere");
  equal(await get(`${pathname}socket`, host, "Origin: http://evil.example", ...UPGRADE), 403, "a socket from another page");
  equal(await get(`${pathname}socket`, host, `Origin: http://127.0.0.1:${port}`, ...UPGRADE), 101, "a socket of the page");
  for (const path of ["/../Cargo.toml", "/Cargo.toml", "/%2e%2e/Cargo.toml", `${pathname}../Cargo.toml`, `${pathname}../../Cargo.toml`, `${pathname}%2e%2e%2fCargo.toml`, "//etc/passwd"]) {
    equal(await get(path, host), 404, path);
  }
  equal(await status(port, [`POST ${pathname} HTTP/1.1`, host, "Content-Length: 0"]), 405, "a POST");
}

/// Holds a socket and never reads from it, but says things.
export function deaf(url) {
  const { port, pathname } = new URL(url);
  return new Promise((resolve, reject) => {
    const socket = new Socket();
    socket.pause();
    socket.on("error", reject);
    socket.connect(port, "127.0.0.1", () => {
      socket.write([`GET ${pathname}socket HTTP/1.1`, `Host: 127.0.0.1:${port}`, `Origin: http://127.0.0.1:${port}`, ...UPGRADE].join("\r\n") + "\r\n\r\n");
      resolve({ say: (message) => socket.write(masked(JSON.stringify(message))), end: () => socket.destroy() });
    });
  });
}

/// A short text as a frame of a browser (RFC 6455, section 5.2), masked with zeros.
function masked(text) {
  const payload = Buffer.from(text);
  return Buffer.concat([Buffer.from([0x81, 0x80 | payload.length, 0, 0, 0, 0]), payload]);
}
