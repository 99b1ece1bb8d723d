// Why a pixel looks as it does, as `rtc why --json` has it.

import { count, element, figures, part, percent, say } from "./element.js";
import { place } from "./places.js";

const PATHS = {
  seen: "seen at once",
  direct: "direct",
  caustic: "focused by glass or mirrors",
  mirrored: "mirrored",
  refracted: "refracted",
};

/// Characters of a file's name that are shown, where there is more room and less.
const MOST_NAME = 18;
const BRIEF_NAME = 10;

/// The least share that is told of.
const LEAST_SHARE = 0.0005;

/// The panel. `on` has `ask(x, y, patient)`, `mark(pixel or null)` and `film()`, which is shown now if anything is.
export class Inspector {
  constructor(on) {
    this.on = on;
    this.pixel = null;
    this.asked = 0;
  }

  /// Marks a pixel and asks nothing yet.
  mark(pixel) {
    this.on.mark(pixel);
  }

  /// Asks why a pixel looks as it does.
  async look(pixel) {
    this.pixel = pixel;
    this.on.mark(pixel);
    const film = this.on.film();
    if (film) this.know(film);
    part("why-close").hidden = false;
    part("side").classList.add("asking");
    await this.ask(true);
  }

  /// Asks again where the picture now shows another text, has twice the samples, or is done.
  refresh(film, done) {
    const { generation } = film;
    const samples = samplesOf(film);
    const more = done ? samples !== this.samples : samples >= 2 * this.samples && samples > 0;
    if (!this.pixel || (generation === this.generation && !more)) return;
    this.know(film);
    this.ask(false);
  }

  /// This is the picture that is asked about.
  know(film) {
    Object.assign(this, { generation: film.generation, samples: samplesOf(film) });
  }

  /// Asks, and says aloud what comes if it was asked for: what only becomes more exact is not read out again and again.
  async ask(aloud) {
    const asked = ++this.asked;
    const [x, y] = this.pixel;
    part("why").setAttribute("aria-busy", "true");
    // What can be told at once, then what all samples tell.
    let more = true;
    for (const patient of [false, true]) {
      const answer = more && (await this.on.ask(x, y, patient).catch((error) => ({ error: error.message })));
      // Another pixel has been chosen since.
      if (asked !== this.asked) return;
      if (answer) {
        replace(answer.ok ? told(answer.why) : [element("p", { class: "hint" }, answer.error)]);
        part("why").dataset.pixel = `${x},${y}`;
        if (aloud && !patient) say(part("why-said"), inWords(this.pixel, answer));
      }
      more = answer.more;
    }
    part("why").removeAttribute("aria-busy");
  }

  clear() {
    this.asked++;
    this.pixel = null;
    this.on.mark(null);
    part("why-close").hidden = true;
    part("side").classList.remove("asking");
    delete part("why").dataset.pixel;
    say(part("why-said"), "");
    part("why").replaceChildren(element("p", { class: "hint" }, "Click a pixel: what it shows, what it is made of, and where its light comes from."));
  }
}

/// The samples that every pixel has.
const samplesOf = ({ step, samples }) => (step === 1 ? samples[0] : 0);

/// Puts something else into the panel; a place that has the focus keeps it.
function replace(children) {
  const places = () => [...part("why").querySelectorAll(".place")];
  const focused = places().indexOf(document.activeElement);
  part("why").replaceChildren(...children);
  places()[focused]?.focus();
}

/// A pixel in a sentence.
function inWords([x, y], { why, error }) {
  if (!why) return `Pixel ${x}, ${y}: ${error}`;
  const [first] = why.shows;
  const from = why.lights[0];
  return `Pixel ${x}, ${y} shows ${first ? title(first) : "the background"}${from ? `, lit most by ${title(from)}` : ""}.`;
}

function told(why) {
  const [r, g, b] = why.radiance;
  const luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const relative = why.error != null && luminance > 0 ? ` (${percent(why.error / luminance)})` : "";
  return [
    element("dl", { class: "numbers" },
      ...entry("pixel", `${why.pixel[0]}, ${why.pixel[1]}`),
      ...entry("radiance", `${[r, g, b].map((v) => figures(v)).join("  ")} W/(m²·sr)`, { "data-radiance": JSON.stringify(why.radiance) }),
      ...entry("error", why.error == null ? "unknown yet" : `± ${figures(why.error, 3)}${relative}`),
      ...entry("samples", count(why.samples)),
      ...(why.coverage < 1 ? entry("covered", percent(why.coverage)) : []),
      ...(why.depth == null ? [] : entry("distance", `${figures(why.depth)} m`)),
      ...(why.normal == null ? [] : entry("normal", why.normal.map((v) => v.toFixed(3).replace("-", "−")).join("  ")))),
    element("h3", {}, "Shows"),
    ...(why.shows.length ? why.shows.map(shown) : [element("p", { class: "hint" }, "Nothing but the background.")]),
    ...rest(why),
    element("h3", {}, "Light from"),
    shares(why.lights, light),
    element("h3", {}, "By paths"),
    shares(why.paths, path),
  ];
}

function entry(name, value, attributes = {}) {
  return [element("dt", {}, name), element("dd", attributes, value)];
}

/// A thing with its uses, the outermost first, and its material.
function shown(what) {
  const { share, material } = what;
  const head = element("p", { class: "thing" }, element("strong", {}, title(what)), element("span", { class: "share" }, percent(share)));
  const made = material && element("p", { class: "material" }, "of ",
    element("span", {}, material.name && material.name !== material.kind ? `${material.name} (${material.kind})` : material.kind),
    material.place ? element("span", { class: "at" }, " ", short(material.place)) : null);
  return element("div", { class: "shown" }, head, uses(what.uses), made);
}

/// What a pixel shows besides the things that are listed.
function rest({ shows, others, background }) {
  if (shows.length === 0) return [];
  const things = others.count === 1 ? "another thing" : `${count(others.count)} other things`;
  return [[others.share, things], [background, "the background"]]
    .filter(([share]) => share >= LEAST_SHARE)
    .map(([share, what]) => element("p", { class: "thing" }, element("span", {}, what), element("span", { class: "share" }, percent(share))));
}

function title({ kind, number, count: lights }) {
  if (lights > 1) return `${lights} of ${kind}`;
  return number ? `${kind} ${number.this} of ${number.of}` : kind;
}

function uses(all) {
  if (all.length === 0) return element("p", { class: "hint" }, "chosen for you");
  return element("ol", { class: "uses" }, ...all.map((use) => element("li", {}, short(use), element("code", {}, use.text))));
}

/// The file's name, not too much of it, and the line; the rest is in the title.
function short({ file, start }, most = MOST_NAME) {
  const name = file.split(/[\\/]/).pop();
  const brief = name.length > most ? `${name.slice(0, most / 2)}…${name.slice(-most / 2)}` : name;
  return place({ file, line: start.line, column: start.column }, `${brief}:${start.line}`);
}

function shares(all, describe) {
  const rows = all.map((one) => element("li", {}, ...describe(one),
    element("meter", { min: 0, max: 1, value: one.share, "aria-hidden": "true" }),
    element("span", { class: "share" }, percent(one.share))));
  return element("ul", { class: "shares" }, ...rows);
}

function light(one) {
  const last = one.uses.at(-1);
  return [element("span", {}, title(one), last ? element("span", { class: "at" }, " ", short(last, BRIEF_NAME)) : null)];
}

function path({ kind, order }) {
  return [element("span", {}, PATHS[kind] ?? (order ? `indirect, by ${order} surface${order === 1 ? "" : "s"}` : kind))];
}
