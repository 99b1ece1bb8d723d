// What is said about the picture in words: its state, its numbers, and what the compiler says.

import { count, duration, element, figures, part, percent, say } from "./element.js";
import { linked } from "./places.js";

const STATES = { compiling: "Compiling", rendering: "Rendering", paused: "Paused", done: "Done", error: "Error" };

/// The head and foot of the page.
export function showStatus(status) {
  const name = status.scene.split(/[\\/]/).pop();
  say(part("scene"), name);
  document.title = `${status.state === "error" ? "✗ " : ""}${name} – rtc`;
  part("scene").title = status.scene;
  showState(status.state, STATES[status.state]);
  say(part("reason"), status.reason ?? "");
  part("reason").title = status.reason ?? "";
  const wanted = status.target?.samples;
  say(part("samples"), wanted ? `${count(status.samples)} of ${count(wanted)}` : count(status.samples));
  const noise = status.noise == null ? "–" : percent(status.noise);
  say(part("noise"), status.target?.noise ? `${noise} of ${percent(status.target.noise)}` : noise);
  say(part("time"), duration(status.seconds));
  say(part("left"), status.left == null || status.state === "done" ? "–" : duration(status.left));
  say(part("size"), status.size[0] ? `${status.size[0]} × ${status.size[1]}` : "–");
  part("progress").value = progress(status);
  say(part("empty"), status.state === "error" ? "No picture before the errors are mended" : "Waiting for the first picture");
  part("notes-section").hidden = status.notes.length === 0;
  if (part("notes").textContent !== status.notes.join("")) {
    part("notes").replaceChildren(...status.notes.map((note) => element("li", {}, note)));
  }
}

function showState(state, text) {
  part("state").dataset.state = state;
  say(part("state-text"), text);
}

/// How much is done, from 0 to 1; with noise it falls with the root of the samples.
function progress({ state, samples, target, noise }) {
  if (state === "done") return 1;
  if (target?.samples) return samples / target.samples;
  if (target?.noise && noise) return Math.min(1, (target.noise / noise) ** 2);
  return 0;
}

const AWAY = {
  gone: "Waiting for rtc watch",
  moved: "Moved",
  busy: "Too many pages",
};
const AWAY_REASON = {
  gone: "It does not answer. The page goes on as soon as it runs again.",
  moved: "rtc watch has restarted with a new address: it stands in its terminal.",
  busy: "This picture is open in as many pages as it can be. Close one.",
};

/// There is no connection.
export function showAway(why) {
  showState("away", AWAY[why]);
  say(part("reason"), AWAY_REASON[why]);
  part("reason").title = AWAY_REASON[why];
}

/// What is shown of a picture beside its pixels.
export function showPicture(film) {
  part("empty").hidden = true;
  part("stage").dataset.generation = film.generation;
  part("stage").dataset.step = film.step;
  part("stage").dataset.samples = film.samples[0];
}

/// What the compiler says, in the very words of `rtc check`; and of which text the picture is, if not of the newest.
export function showMessages(status, film) {
  if (!status) return;
  const { errors, warnings, text, places } = status.diagnostics;
  const panel = part("messages");
  panel.hidden = text === "";
  panel.dataset.severity = errors ? "error" : "warning";
  const title = [errors && plural(errors, "error"), warnings && plural(warnings, "warning")].filter(Boolean).join(", ");
  say(part("messages-title"), title);
  // What has not changed stays as it is, with its selection and its scroll.
  if (part("messages-text").textContent !== text) part("messages-text").replaceChildren(...linked(text, places));
  const stale = errors > 0 && film && film.generation < status.generation;
  const badge = stale ? `Picture ${film.generation}: the last good one. The text is at ${status.generation}.` : film?.remixed ? "Lamps remixed; tracing follows" : "";
  part("badge").hidden = badge === "";
  part("badge").dataset.kind = stale ? "stale" : "remixed";
  say(part("badge"), badge);
}

function plural(n, word) {
  return `${n} ${word}${n === 1 ? "" : "s"}`;
}

/// A note, or the pixel under the pointer.
export function showUnder(view, pixel, note = null) {
  if (note) return say(part("under"), note);
  if (!pixel || !view.film) return say(part("under"), "");
  const { radiance, error } = view.film.at(...pixel);
  const noise = Number.isFinite(error) ? ` ± ${figures(error, 2)}` : "";
  say(part("under"), `${pixel[0]}, ${pixel[1]}   ${radiance.map((v) => figures(v)).join("  ")}${noise} W/(m²·sr)`);
}
