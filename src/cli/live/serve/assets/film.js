// Pictures as they arrive: linear half floats in tiles.

/// Words at the head of a binary message, all of 32 bits.
const HEAD = 12;

/// The value of each half float (IEEE 754 binary16) by its bits.
export const HALF = (() => {
  const values = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    if (exponent === 31) values[bits] = fraction ? NaN : sign * Infinity;
    else if (exponent === 0) values[bits] = sign * fraction * 2 ** -24;
    else values[bits] = sign * (1024 + fraction) * 2 ** (exponent - 25);
  }
  return values;
})();

/// Numbers held for each pixel: red, green, blue, the standard error of luminance, and the share that is covered.
export const STRIDE = 5;
const WHOLE = 0x3c00;

/// What a binary message holds.
export function read(buffer) {
  const words = new Uint32Array(buffer, 0, HEAD);
  const [kind, id, generation, version, x, y, width, height, step, channels] = words;
  const scale = new Int32Array(buffer, 0, HEAD)[10];
  return { kind, id, generation, version, x, y, width, height, step, channels, scale, buffer, at: HEAD * 4 };
}

/// A picture, whole or the first look at one.
export class Film {
  constructor(size, step, scale) {
    this.size = size;
    this.step = step;
    /// The power of two that its values are multiplied by.
    this.scale = scale;
    this.width = Math.ceil(size[0] / step);
    this.height = Math.ceil(size[1] / step);
    this.bits = new Uint16Array(this.width * this.height * STRIDE);
    this.transparent = false;
    this.generation = 0;
    /// How the text that it shows develops it.
    this.develop = null;
    /// The rectangle that has changed since it was last developed: left, top, right, bottom.
    this.dirty = null;
  }

  /// Whether another picture has the same pixels, at whatever scale it came.
  isLike({ size, step }) {
    return this.size[0] === size[0] && this.size[1] === size[1] && this.step === step;
  }

  /// Takes a tile; what lies outside is left.
  take(tile) {
    const { x, y, width, height, channels } = tile;
    if (x + width > this.width || y + height > this.height) return;
    const from = new Uint16Array(tile.buffer, tile.at, width * height * channels);
    const bits = this.bits;
    for (let row = 0, read = 0; row < height; row++) {
      let write = ((y + row) * this.width + x) * STRIDE;
      for (let column = 0; column < width; column++, write += STRIDE) {
        bits[write] = from[read];
        bits[write + 1] = from[read + 1];
        bits[write + 2] = from[read + 2];
        bits[write + 3] = from[read + 3];
        bits[write + 4] = channels === STRIDE ? from[read + 4] : WHOLE;
        read += channels;
      }
    }
    this.transparent ||= channels === STRIDE;
    const [left, top, right, bottom] = this.dirty ?? [x, y, x, y];
    this.dirty = [Math.min(left, x), Math.min(top, y), Math.max(right, x + width), Math.max(bottom, y + height)];
  }

  /// Scene radiance and its error at a pixel of the whole picture.
  at(x, y) {
    const index = Math.floor(y / this.step) * this.width + Math.floor(x / this.step);
    const factor = 2 ** -this.scale;
    const value = (channel) => HALF[this.bits[index * STRIDE + channel]];
    return { radiance: [0, 1, 2].map((channel) => value(channel) * factor), error: value(3) * factor, covered: value(4) };
  }

  /// One that stays as it is.
  copy() {
    const copy = Object.assign(new Film(this.size, this.step, this.scale), this);
    copy.bits = this.bits.slice();
    copy.dirty = null;
    return copy;
  }
}
