// Developing, as src/develop.rs does it: from scene radiance to what a display shows. What is done for each pixel is
// looked up where a table is as exact as the screen.

import { HALF, STRIDE } from "./film.js";

/// Linear values in [0, 1] as sRGB shows them (IEC 61966-2-1), and in bytes.
const STEPS = 65535;
const SHOWN = Float32Array.from({ length: STEPS + 1 }, (_, i) => encodeSrgb(i / STEPS));
const ENCODED = Uint8ClampedArray.from(SHOWN, (v) => Math.floor(255 * v + 0.5));

function encodeSrgb(v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
}

function step(linear) {
  return linear <= 0 ? 0 : linear >= 1 ? STEPS : (linear * STEPS + 0.5) | 0;
}

function byte(linear) {
  return ENCODED[step(linear)];
}

function clamp(v) {
  return v <= 0 ? 0 : v >= 1 ? 1 : v;
}

/// The curves. Each changes exposed radiance in place to linear display values, or to values that are meant for a
/// display already: `encoded`.
const CURVES = {
  none: { apply() {}, encoded: false },
  neutral: { apply: neutral, encoded: false },
  agx: { apply: agx, encoded: true },
};

/// Khronos PBR Neutral (Khronos Group, "PBR Neutral Tone Mapper specification", 2024).
function neutral(rgb) {
  const least = Math.min(rgb[0], rgb[1], rgb[2]);
  const offset = least < 0.08 ? least - (least * least) / 0.16 : 0.04;
  rgb[0] -= offset;
  rgb[1] -= offset;
  rgb[2] -= offset;
  const peak = Math.max(rgb[0], rgb[1], rgb[2]);
  const start = 0.76;
  if (peak < start) return;
  const room = 1 - start;
  const compressed = 1 - (room * room) / (peak + room - start);
  const grey = 1 - 1 / (0.15 * (peak - compressed) + 1);
  const scale = (compressed / peak) * (1 - grey);
  const add = compressed * grey;
  rgb[0] = rgb[0] * scale + add;
  rgb[1] = rgb[1] * scale + add;
  rgb[2] = rgb[2] * scale + add;
}

/// AgX (Troy Sobotka, 2022), its contrast by Benjamin Wrensch, "Minimal AgX implementation", 2023.
function agx(rgb) {
  const r = rgb[0];
  const g = rgb[1];
  const b = rgb[2];
  const u = contrast(INSET[0] * r + INSET[1] * g + INSET[2] * b);
  const v = contrast(INSET[3] * r + INSET[4] * g + INSET[5] * b);
  const w = contrast(INSET[6] * r + INSET[7] * g + INSET[8] * b);
  rgb[0] = OUTSET[0] * u + OUTSET[1] * v + OUTSET[2] * w;
  rgb[1] = OUTSET[3] * u + OUTSET[4] * v + OUTSET[5] * w;
  rgb[2] = OUTSET[6] * u + OUTSET[7] * v + OUTSET[8] * w;
}

/// Row by row.
const INSET = [
  0.842479062253094, 0.0784335999999992, 0.0792237451477643,
  0.0423282422610123, 0.878468636469772, 0.0791661274605434,
  0.0423756549057051, 0.0784336, 0.879142973793104,
];
const OUTSET = inverse(INSET);

function inverse([a, b, c, d, e, f, g, h, i]) {
  const cofactors = [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f, d * h - e * g, b * g - a * h, a * e - b * d];
  const determinant = a * cofactors[0] + b * cofactors[3] + c * cofactors[6];
  return cofactors.map((v) => v / determinant);
}

const LEAST_STOPS = -12.47393;
const MOST_STOPS = 4.026069;

/// The contrast of AgX for every float by its upper bits: the sign, the exponent and nine bits of the fraction. Within
/// one entry it changes by less than a tenth of a byte's step.
const CONTRAST = (() => {
  const table = new Float32Array(1 << 17);
  const bits = new Uint32Array(1);
  const value = new Float32Array(bits.buffer);
  for (let i = 0; i < table.length; i++) {
    // The middle of the entry.
    bits[0] = (i << 15) | (1 << 14);
    const stops = value[0] > 0 ? Math.log2(value[0]) : LEAST_STOPS;
    const x = (Math.min(Math.max(stops, LEAST_STOPS), MOST_STOPS) - LEAST_STOPS) / (MOST_STOPS - LEAST_STOPS);
    table[i] = -0.00232 + x * (0.1191 + x * (0.4298 + x * (-6.868 + x * (31.96 + x * (-40.14 + x * 15.5)))));
  }
  return table;
})();
const KEY_BITS = new Uint32Array(1);
const KEY = new Float32Array(KEY_BITS.buffer);

function contrast(v) {
  KEY[0] = v;
  return CONTRAST[KEY_BITS[0] >>> 15];
}

/// Beyond this every curve is flat.
const MOST = 1e12;

function expose(v, gain) {
  const exposed = v * gain;
  // Also what is not a number is nothing.
  return exposed > 0 ? (exposed < MOST ? exposed : MOST) : 0;
}

/// Exposed radiance by the bits of a half float, at one gain.
const exposed = { gain: 0, values: new Float32Array(65536) };

function exposures(gain) {
  if (exposed.gain === gain) return exposed.values;
  for (let bits = 0; bits < 65536; bits++) exposed.values[bits] = expose(HALF[bits], gain);
  exposed.gain = gain;
  return exposed.values;
}

/// What a window of pictures is painted with. `look` has `stops`, `tonemap` and `show`.
export function painter(look) {
  const curve = CURVES[look.tonemap] ?? CURVES.neutral;
  const paint = look.show === "noise" ? noise : picture;
  return (film, area, out) => paint(film, area, out, look.stops, curve);
}

function picture(film, area, out, stops, curve) {
  const gain = 2 ** (stops - film.scale);
  if (film.transparent) return transparent(film, area, out, gain, curve);
  const [left, top, right, bottom] = area;
  const { bits, width } = film;
  const { apply, encoded } = curve;
  const values = exposures(gain);
  const rgb = new Float64Array(3);
  for (let y = top, write = 0; y < bottom; y++) {
    let read = (y * width + left) * STRIDE;
    for (let x = left; x < right; x++, read += STRIDE, write += 4) {
      rgb[0] = values[bits[read]];
      rgb[1] = values[bits[read + 1]];
      rgb[2] = values[bits[read + 2]];
      apply(rgb);
      store(rgb, encoded, out, write);
      out[write + 3] = 255;
    }
  }
}

/// What covers a pixel is held times its share of it, and developed by itself.
function transparent(film, [left, top, right, bottom], out, gain, { apply, encoded }) {
  const { bits, width } = film;
  const rgb = new Float64Array(3);
  for (let y = top, write = 0; y < bottom; y++) {
    let read = (y * width + left) * STRIDE;
    for (let x = left; x < right; x++, read += STRIDE, write += 4) {
      const covered = HALF[bits[read + 4]];
      const own = covered > 0 && covered < 1 ? gain / covered : gain;
      rgb[0] = expose(HALF[bits[read]], own);
      rgb[1] = expose(HALF[bits[read + 1]], own);
      rgb[2] = expose(HALF[bits[read + 2]], own);
      apply(rgb);
      store(rgb, encoded, out, write);
      out[write + 3] = 255 * covered;
    }
  }
}

function store(rgb, encoded, out, write) {
  if (encoded) {
    out[write] = 255 * rgb[0];
    out[write + 1] = 255 * rgb[1];
    out[write + 2] = 255 * rgb[2];
  } else {
    out[write] = byte(rgb[0]);
    out[write + 1] = byte(rgb[1]);
    out[write + 2] = byte(rgb[2]);
  }
}

/// Exposed radiance to what a display shows, in [0, 1], without rounding.
function display(rgb, curve) {
  curve.apply(rgb);
  for (let channel = 0; channel < 3; channel++) {
    rgb[channel] = curve.encoded ? clamp(rgb[channel]) : SHOWN[step(rgb[channel])];
  }
}

/// Half the span on a display between the value less and plus the standard error of its luminance, where it is greatest, as a
/// share of white. The noise that is printed knows the errors of the channels, which are not sent.
function noise(film, [left, top, right, bottom], out, stops, curve) {
  const gain = 2 ** (stops - film.scale);
  const { bits, width } = film;
  const low = new Float64Array(3);
  const high = new Float64Array(3);
  for (let y = top, write = 0; y < bottom; y++) {
    let read = (y * width + left) * STRIDE;
    for (let x = left; x < right; x++, read += STRIDE, write += 4) {
      const error = HALF[bits[read + 3]];
      let span = 1;
      if (Number.isFinite(error)) {
        for (let channel = 0; channel < 3; channel++) {
          const value = HALF[bits[read + channel]];
          low[channel] = expose(value - error, gain);
          high[channel] = expose(value + error, gain);
        }
        display(low, curve);
        display(high, curve);
        span = 0.5 * Math.max(Math.abs(high[0] - low[0]), Math.abs(high[1] - low[1]), Math.abs(high[2] - low[2]));
      }
      const index = ramp(span) * 3;
      out[write] = RAMP[index];
      out[write + 1] = RAMP[index + 1];
      out[write + 2] = RAMP[index + 2];
      out[write + 3] = 255;
    }
  }
}

/// The difference of two pictures, exposed and without a curve: what is equal is black.
export function difference(film, other, [left, top, right, bottom], out, stops) {
  const gain = 2 ** (stops - film.scale);
  const theirs = 2 ** (stops - other.scale);
  for (let y = top, write = 0; y < bottom; y++) {
    let read = (y * film.width + left) * STRIDE;
    for (let x = left; x < right; x++, read += STRIDE, write += 4) {
      for (let channel = 0; channel < 3; channel++) {
        const a = expose(HALF[film.bits[read + channel]], gain);
        const b = expose(HALF[other.bits[read + channel]], theirs);
        out[write + channel] = byte(Math.abs(a - b));
      }
      out[write + 3] = 255;
    }
  }
}

/// Colours from quiet to loud, dark to light, so that they can be told without seeing hues.
const ANCHORS = [[10, 12, 28], [28, 44, 110], [22, 104, 128], [70, 158, 92], [214, 186, 52], [255, 246, 214]];
const RAMP_STEPS = 256;
const RAMP = new Uint8ClampedArray(RAMP_STEPS * 3);
for (let i = 0; i < RAMP_STEPS; i++) {
  const t = (i / (RAMP_STEPS - 1)) * (ANCHORS.length - 1);
  const k = Math.min(Math.floor(t), ANCHORS.length - 2);
  for (let channel = 0; channel < 3; channel++) {
    RAMP[i * 3 + channel] = ANCHORS[k][channel] + (t - k) * (ANCHORS[k + 1][channel] - ANCHORS[k][channel]);
  }
}

/// The step of the ramp for a share of white: 0.1 % to 100 %, by factors.
function ramp(share) {
  const t = (Math.log10(Math.max(share, 1e-3)) + 3) / 3;
  return Math.round(Math.min(t, 1) * (RAMP_STEPS - 1));
}

/// Draws the ramp for a legend.
export function legend(canvas) {
  const context = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; x++) {
    const index = Math.round((x / (canvas.width - 1)) * (RAMP_STEPS - 1)) * 3;
    context.fillStyle = `rgb(${RAMP[index]} ${RAMP[index + 1]} ${RAMP[index + 2]})`;
    context.fillRect(x, 0, 1, canvas.height);
  }
}
