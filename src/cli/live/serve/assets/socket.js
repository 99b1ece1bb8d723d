// The connection to `rtc watch`: it is kept, or made again, as long as the page is open.

import { Film, read } from "./film.js";

const TILE = 1;
/// Milliseconds between attempts: soon at first, then patiently.
const SOONEST = 150;
const LATEST = 1500;

/// Keeps a connection. `told` has a function for each thing that is told: `hello`, `status`, `film`, `away`, `error`.
export class Link {
  constructor(told) {
    this.told = told;
    this.film = null;
    /// A picture that is coming: its shape, and the tiles that are there.
    this.next = null;
    this.asked = new Map();
    this.id = 0;
    this.wait = SOONEST;
    this.connect();
  }

  connect() {
    const url = new URL("socket", location.href);
    url.protocol = "ws:";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.text(JSON.parse(data)) : this.bytes(data));
    socket.onopen = () => (this.wait = SOONEST);
    socket.onclose = () => this.closed();
    this.socket = socket;
  }

  async closed() {
    this.next = null;
    for (const { reject } of this.asked.values()) reject(new Error("the connection was lost"));
    this.asked.clear();
    this.told.away(await whyAway());
    setTimeout(() => this.connect(), this.wait);
    this.wait = Math.min(2 * this.wait, LATEST);
  }

  /// Tells the other side something, if it is there.
  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /// Asks for something that is answered.
  ask(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error("`rtc watch` does not answer"));
    const id = ++this.id;
    return new Promise((resolve, reject) => {
      this.asked.set(id, { resolve, reject });
      this.send({ ...message, id });
    });
  }

  text(message) {
    switch (message.type) {
      case "begin":
        return this.begin(message);
      case "frame":
        return this.finish(message);
      case "light":
        // Its mask follows.
        if (!message.ok) this.answer(message.id, message);
        return;
      case "why":
      case "wrote":
        return this.answer(message.id, message);
      default:
        this.told[message.type]?.(message);
    }
  }

  answer(id, answer) {
    this.asked.get(id)?.resolve(answer);
    this.asked.delete(id);
  }

  bytes(buffer) {
    const head = read(buffer);
    if (head.kind !== TILE) {
      const bits = new Uint8Array(buffer, head.at);
      return this.answer(head.id, { size: [head.width, head.height], bits });
    }
    this.next?.tiles.push(head);
  }

  /// Tiles wait until all are there: the picture that is shown is a whole one at any time.
  begin({ size, step, scale }) {
    this.next = { size, step, scale, tiles: [] };
  }

  /// Tiles of a picture of the same shape go into the one there is.
  finish({ generation, samples, remixed, develop }) {
    if (!this.next) return;
    const { size, step, scale, tiles } = this.next;
    this.next = null;
    const kept = this.film?.scale === scale && this.film.isLike({ size, step });
    const film = kept ? this.film : new Film(size, step, scale);
    for (const tile of tiles) film.take(tile);
    this.film = Object.assign(film, { generation, samples, remixed, develop });
    this.told.film(film);
  }
}

/// Why there is no connection, as far as it can be told.
async function whyAway() {
  try {
    const answer = await fetch(location.href, { cache: "no-store" });
    if (answer.ok) return "busy";
    return answer.status === 403 ? "moved" : "gone";
  } catch {
    return "gone";
  }
}
