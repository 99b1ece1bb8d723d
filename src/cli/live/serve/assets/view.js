// The picture on the screen: zoom, pan, comparison, and what is drawn over it.

import { difference, painter } from "./develop.js";

/// Device pixels a pixel of the picture, at most and at least.
const MOST_ZOOM = 64;
const LEAST_ZOOM = 1 / 64;
/// From here on pixels are squares.
const SQUARES = 2;

/// A developed picture, kept such that only what changes is developed again.
class Plate {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.context = this.canvas.getContext("2d");
    this.film = null;
  }

  /// Develops a film, or where nothing else has changed, what has changed of it.
  develop(film, paint, all) {
    const whole = [0, 0, film.width, film.height];
    const area = all || this.film !== film ? whole : film.dirty;
    if (this.canvas.width !== film.width || this.canvas.height !== film.height) {
      this.canvas.width = film.width;
      this.canvas.height = film.height;
    }
    this.film = film;
    film.dirty = null;
    if (!area) return;
    const [left, top, right, bottom] = area;
    const pixels = new ImageData(right - left, bottom - top);
    paint(film, area, pixels.data);
    this.context.putImageData(pixels, left, top);
  }
}

/// What is seen, and how.
export class View {
  /// `changed` is called when zoom or place have changed.
  constructor(stage, changed) {
    this.stage = stage;
    this.context = stage.getContext("2d");
    this.changed = changed;
    this.look = { stops: 0, tonemap: "neutral", show: "picture" };
    this.film = null;
    this.pinned = null;
    this.compare = "split";
    this.flipped = false;
    this.split = 0.5;
    /// Whether the difference of the two is on the plate.
    this.differs = false;
    this.plates = { now: new Plate(), pinned: new Plate() };
    this.zoom = 1;
    this.origin = [0, 0];
    this.fitted = true;
    /// Where the first picture is to be, if not as large as it goes.
    this.wanted = null;
    this.mark = null;
    this.window = null;
    this.lit = null;
    /// What is to be done before the next frame of the display: nothing, drawing, and developing what changed or all.
    this.due = { drawing: false, developing: false, all: false };
    new ResizeObserver(() => this.resize()).observe(stage);
  }

  /// Shows a picture that has arrived.
  show(film) {
    const first = !this.film || this.film.size.some((side, i) => side !== film.size[i]);
    this.film = film;
    this.due.developing = true;
    if (first) this.begin();
    else this.draw();
  }

  /// Puts the first picture where a page before had it, any other as large as it goes.
  begin() {
    const wanted = this.wanted;
    this.wanted = null;
    if (!wanted) return this.fit();
    this.zoom = wanted.zoom;
    this.origin = wanted.origin;
    this.fitted = false;
    this.keep();
  }

  /// Develops otherwise from now on.
  develop() {
    this.due.developing = true;
    this.due.all = true;
    this.draw();
  }

  /// Draws with the next frame of the display, once for all that has changed until then.
  draw() {
    if (this.due.drawing) return;
    this.due.drawing = true;
    requestAnimationFrame(() => {
      const { developing, all } = this.due;
      this.due = { drawing: false, developing: false, all: false };
      if (developing && this.film) this.developNow(all);
      this.drawNow();
    });
  }

  developNow(all) {
    const paint = painter(this.look);
    const differs = this.compare === "difference" && this.pinned !== null && this.film.isLike(this.pinned);
    const subtract = (film, area, out) => difference(film, this.pinned, area, out, this.look.stops);
    this.plates.now.develop(this.film, differs ? subtract : paint, all || differs !== this.differs);
    if (this.pinned && !differs) this.plates.pinned.develop(this.pinned, paint, all);
    this.differs = differs;
  }

  /// Keeps the picture to compare with, or lets go of it.
  pin(on) {
    this.pinned = on && this.film ? this.film.copy() : null;
    this.flipped = false;
    this.develop();
  }

  resize() {
    const ratio = devicePixelRatio;
    const width = Math.max(1, Math.round(this.stage.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.stage.clientHeight * ratio));
    if (this.stage.width === width && this.stage.height === height) return;
    this.stage.width = width;
    this.stage.height = height;
    // That has emptied it, and frames are drawn before sizes are told.
    if (this.fitted) this.fit();
    this.drawNow();
  }

  /// The whole picture, as large as it goes.
  fit() {
    if (!this.film) return;
    const { width, height } = this.stage;
    const [w, h] = this.film.size;
    const margin = 12 * devicePixelRatio;
    const zoom = Math.min((width - 2 * margin) / w, (height - 2 * margin) / h);
    this.zoom = Math.max(zoom, LEAST_ZOOM);
    this.origin = [(width - w * this.zoom) / 2, (height - h * this.zoom) / 2];
    this.fitted = true;
    this.draw();
    this.changed();
  }

  /// Zooms about a point of the stage, in device pixels; by default its middle.
  zoomTo(zoom, at = [this.stage.width / 2, this.stage.height / 2]) {
    const to = Math.min(Math.max(zoom, LEAST_ZOOM), MOST_ZOOM);
    this.origin = this.origin.map((origin, i) => at[i] - ((at[i] - origin) / this.zoom) * to);
    this.zoom = to;
    this.fitted = false;
    this.keep();
  }

  pan(dx, dy) {
    this.origin = [this.origin[0] + dx, this.origin[1] + dy];
    this.fitted = false;
    this.keep();
  }

  /// Keeps some of the picture on the stage.
  keep() {
    if (!this.film) return;
    const sides = [this.stage.width, this.stage.height];
    this.origin = this.origin.map((origin, i) => {
      const side = this.film.size[i] * this.zoom;
      const rest = Math.min(48 * devicePixelRatio, side);
      return Math.min(Math.max(origin, rest - side), sides[i] - rest);
    });
    this.draw();
    this.changed();
  }

  /// The pixel of the picture at a place on the page, if there is one.
  pixel(clientX, clientY) {
    const at = this.place(clientX, clientY).map(Math.floor);
    const inside = this.film && at.every((v, i) => v >= 0 && v < this.film.size[i]);
    return inside ? at : null;
  }

  /// A place on the page in pixels of the picture.
  place(clientX, clientY) {
    const box = this.stage.getBoundingClientRect();
    const at = [(clientX - box.left) * devicePixelRatio, (clientY - box.top) * devicePixelRatio];
    return at.map((v, i) => (v - this.origin[i]) / this.zoom);
  }

  /// The pixel in the middle of the picture.
  middle() {
    return this.film.size.map((side) => side >> 1);
  }

  /// The nearest pixel of the picture.
  inside(pixel) {
    return pixel.map((v, i) => Math.min(Math.max(v, 0), this.film.size[i] - 1));
  }

  /// Moves the picture as far as it takes to see a pixel.
  reveal(pixel) {
    const margin = 8 * devicePixelRatio;
    const sides = [this.stage.width, this.stage.height];
    const by = pixel.map((v, i) => {
      const at = this.origin[i] + (v + 0.5) * this.zoom;
      return Math.min(Math.max(at, margin), sides[i] - margin) - at;
    });
    if (by.some((v) => v !== 0)) this.pan(...by);
  }

  /// Draws a window, or none.
  frame(window) {
    if (String(window) === String(this.window)) return;
    this.window = window;
    this.draw();
  }

  /// Where a column of the picture stands on the stage, in its own pixels.
  columnAt(share) {
    return (this.origin[0] + share * (this.film?.size[0] ?? 0) * this.zoom) / devicePixelRatio;
  }

  /// Lights up pixels: a mask of bits, or nothing.
  light(mask) {
    this.lit = mask && lamp(mask);
    this.draw();
  }

  drawNow() {
    const { context, stage, film } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, stage.width, stage.height);
    if (!film) return;
    const [w, h] = film.size;
    // At whole steps pixels of the picture meet pixels of the display.
    const exact = this.zoom >= SQUARES || Number.isInteger(this.zoom);
    const [x, y] = exact ? this.origin.map(Math.round) : this.origin;
    context.setTransform(this.zoom, 0, 0, this.zoom, x, y);
    if (film.transparent) this.checker(w, h);
    this.paste(this.plates.now, exact);
    if (this.pinned && !this.differs) this.drawPinned(w, h, exact);
    if (this.lit) {
      context.imageSmoothingEnabled = false;
      context.drawImage(this.lit, 0, 0, w, h);
    }
    if (this.window) this.drawWindow(this.window);
    if (this.mark) this.drawMark(this.mark);
  }

  /// Pictures of the first look are smooth, as nothing is known between their pixels.
  paste(plate, exact) {
    const { film, canvas } = plate;
    this.context.imageSmoothingEnabled = film.step > 1 || !exact;
    this.context.imageSmoothingQuality = this.zoom < 1 ? "high" : "low";
    const [w, h] = film.size;
    // The last column and row of a first look stand for what is left.
    this.context.drawImage(canvas, 0, 0, w / film.step, h / film.step, 0, 0, w, h);
  }

  drawPinned(w, h, exact) {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(0, 0, this.compare === "split" ? this.split * w : this.flipped ? w : 0, h);
    context.clip();
    if (this.pinned.transparent) this.checker(w, h);
    this.paste(this.plates.pinned, exact);
    context.restore();
  }

  checker(w, h) {
    const { context } = this;
    context.fillStyle = "#9a9a9a";
    context.fillRect(0, 0, w, h);
    context.fillStyle = "#6c6c6c";
    const side = 8 / this.zoom;
    context.beginPath();
    for (let row = 0; row * side < h; row++) {
      for (let x = (row % 2) * side; x < w; x += 2 * side) {
        context.rect(x, row * side, Math.min(side, w - x), Math.min(side, h - row * side));
      }
    }
    context.fill();
  }

  drawWindow([x, y, w, h]) {
    const { context } = this;
    const line = 1 / this.zoom;
    context.lineWidth = line;
    for (const [style, dash] of [["rgb(0 0 0 / .8)", []], ["#fff", [5 * line, 4 * line]]]) {
      context.strokeStyle = style;
      context.setLineDash(dash);
      context.strokeRect(x - line / 2, y - line / 2, w + line, h + line);
    }
    context.setLineDash([]);
  }

  /// Rings the pixel that is asked about.
  drawMark([x, y]) {
    const { context } = this;
    const line = devicePixelRatio / this.zoom;
    const gap = Math.max(4 * line, 0.5);
    for (const [style, width] of [["rgb(0 0 0 / .75)", 3 * line], ["#fff", line]]) {
      context.strokeStyle = style;
      context.lineWidth = width;
      context.beginPath();
      context.rect(x + 0.5 - gap, y + 0.5 - gap, 2 * gap, 2 * gap);
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(x + 0.5 + dx * gap, y + 0.5 + dy * gap);
        context.lineTo(x + 0.5 + dx * (gap + 5 * line), y + 0.5 + dy * (gap + 5 * line));
      }
      context.stroke();
    }
  }
}

/// A shade over all pixels but those of a mask.
function lamp({ size: [width, height], bits }) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const pixels = new ImageData(width, height);
  const bytes = Math.ceil(width / 8);
  for (let y = 0, i = 3; y < height; y++) {
    for (let x = 0; x < width; x++, i += 4) {
      const lit = bits[y * bytes + (x >> 3)] & (0x80 >> (x & 7));
      pixels.data[i] = lit ? 0 : 168;
    }
  }
  canvas.getContext("2d").putImageData(pixels, 0, 0);
  return canvas;
}
