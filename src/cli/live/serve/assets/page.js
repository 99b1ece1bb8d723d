// The page: what is told goes to its parts, and what is done there is sent.

import { legend } from "./develop.js";
import { part, say } from "./element.js";
import { Finder } from "./find.js";
import { hold } from "./hand.js";
import { Inspector } from "./inspect.js";
import { keys } from "./keys.js";
import { Params, serveUnits } from "./params.js";
import { listen, serveEditor } from "./places.js";
import { showAway, showMessages, showPicture, showStatus, showUnder } from "./said.js";
import { Link } from "./socket.js";
import { View } from "./view.js";
import { Cropper } from "./window.js";

/// What this page was left with, as far as a reload should keep it.
const kept = JSON.parse(sessionStorage.getItem("look") ?? "{}");
const state = { place: kept.place, status: null, stops: kept.stops ?? 0, tonemap: kept.tonemap ?? "", show: kept.show ?? "picture", under: null };
/// The place that is looked at, what there is to say of it, and the pixels of the one that was looked for.
let [looked, note, found] = [null, null, null];

const view = new View(part("stage"), () => {
  say(part("zoom-fit"), view.fitted ? "fit" : `${Math.round(view.zoom * 100)} %`);
  state.place = view.fitted ? null : { zoom: view.zoom, origin: view.origin };
  remember();
  placeDivider();
});
const params = new Params({
  set: (name, value) => link.send({ type: "set", name, value }),
  write: writeBack,
  say: toast,
});
const inspector = new Inspector({
  ask: (x, y, patient) => link.ask({ type: "why", x, y, patient }),
  film: () => link.film,
  mark: (pixel) => {
    view.mark = pixel;
    state.under = null;
    view.draw();
    showPixel();
  },
});
const cropper = new Cropper(view, {
  set(window) {
    link.send({ type: "crop", window });
    if (state.status) state.status.crop = window;
  },
  say: toast,
});
const finder = new Finder({
  ask: (at) => link.ask({ type: "light", ...at }),
  light(mask) {
    found = mask;
    if (!looked) view.light(found);
  },
});
const link = new Link({
  hello(hello) {
    serveUnits(hello.units);
    serveEditor(hello.editor, hello.folder);
    offerTonemaps(hello.tonemaps);
  },
  status(status) {
    state.status = status;
    showStatus(status);
    showMessages(status, link.film);
    params.update(status.params);
    pointAt(status.cursor);
    cropper.update(status.crop);
    finder.know([status.scene, ...status.files.filter((file) => file !== status.scene)]);
    part("pause").setAttribute("aria-pressed", String(status.paused));
    if (link.film) inspector.refresh(link.film, status.state === "done");
  },
  film(film) {
    state.develop = film.develop;
    develop();
    view.show(film);
    showPicture(film, state.status);
    showMessages(state.status, film);
    inspector.refresh(film, false);
    finder.refresh(film);
    showPixel();
  },
  away(why) {
    showAway(why, state.status);
  },
  error({ message }) {
    toast(message);
  },
});

view.wanted = kept.place ?? null;

/// Shows the numbers of the pixel under the pointer, else of the one that is marked.
function showPixel() {
  showUnder(view, state.under ?? view.mark, note);
}

// ---- developing

function stops() {
  return (state.develop?.stops ?? 0) + state.stops;
}

function tonemap() {
  return state.tonemap || (state.develop?.tonemap ?? "neutral");
}

/// Keeps for a reload how the picture is looked at.
function remember() {
  const { stops, tonemap, show, place } = state;
  sessionStorage.setItem("look", JSON.stringify({ stops, tonemap, show, place }));
}

/// Develops the picture anew if that looks otherwise now.
function develop() {
  const look = { stops: stops(), tonemap: tonemap(), show: state.show };
  remember();
  const offset = state.stops === 0 ? "" : ` (${signed(state.stops)})`;
  say(part("exposure-text"), `${look.stops.toFixed(2)} stops${offset}`);
  part("exposure").value = state.stops;
  part("exposure-back").hidden = state.stops === 0;
  part("legend").hidden = look.show !== "noise";
  part("save-png").href = `picture.png?stops=${look.stops}&tonemap=${look.tonemap}`;
  if (JSON.stringify(look) === JSON.stringify(view.look)) return;
  view.look = look;
  view.develop();
}

function signed(v) {
  return `${v < 0 ? "−" : "+"} ${Math.abs(v).toFixed(2)}`;
}

function expose(to) {
  const most = Number(part("exposure").max);
  state.stops = Math.min(Math.max(Math.round(to * 100) / 100, -most), most);
  develop();
}

function offerTonemaps(names) {
  const select = part("tonemap");
  select.replaceChildren(select.options[0], ...names.map((name) => new Option(name, name)));
  select.value = state.tonemap;
}

part("exposure").addEventListener("input", (event) => expose(event.target.valueAsNumber));
part("exposure").addEventListener("dblclick", () => expose(0));
part("exposure-back").addEventListener("click", () => expose(0));
part("tonemap").addEventListener("change", (event) => {
  state.tonemap = event.target.value;
  develop();
});
part("show").value = state.show;
part("show").addEventListener("change", (event) => {
  state.show = event.target.value;
  develop();
});
legend(part("ramp"));

// ---- the hand on the picture

hold(view, {
  click: (pixel) => inspector.look(pixel),
  hover(pixel) {
    state.under = pixel;
    showPixel();
  },
  cropping: () => cropper.armed,
  window: (rectangle, done) => cropper.drag(rectangle, done),
});
part("crop").addEventListener("click", () => cropper.toggle());

// ---- comparing

function pin() {
  view.pin(!view.pinned);
  part("pin").setAttribute("aria-pressed", String(Boolean(view.pinned)));
  part("compare").hidden = !view.pinned;
  placeDivider();
}

function compareBy(mode) {
  view.compare = mode;
  part("compare").querySelector(`[value=${mode}]`).checked = true;
  view.develop();
  placeDivider();
}

function flip() {
  if (!view.pinned) return;
  if (view.compare !== "flip") compareBy("flip");
  view.flipped = !view.flipped;
  view.draw();
}

function placeDivider() {
  const divider = part("divider");
  divider.hidden = !(view.pinned && view.compare === "split");
  divider.style.left = `${view.columnAt(view.split)}px`;
  divider.setAttribute("aria-valuenow", String(Math.round(view.split * 100)));
}

function splitAt(share) {
  view.split = Math.min(Math.max(share, 0), 1);
  view.draw();
  placeDivider();
}

part("pin").addEventListener("click", pin);
part("compare").addEventListener("change", (event) => compareBy(event.target.value));
// A second click on `Flip` flips.
part("compare").querySelector("[value=flip]").addEventListener("click", () => view.compare === "flip" && flip());
const divider = part("divider");
divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
divider.addEventListener("pointermove", (event) => {
  if (divider.hasPointerCapture(event.pointerId)) splitAt(view.place(event.clientX, event.clientY)[0] / view.film.size[0]);
});
divider.addEventListener("keydown", (event) => {
  const by = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
  if (!by) return;
  event.preventDefault();
  splitAt(view.split + by);
});

// ---- places

/// What stands at the cursor of an editor is what was looked for last.
let pointed = null;
async function pointAt(cursor) {
  const name = JSON.stringify(cursor);
  if (name === pointed) return;
  pointed = name;
  if (!cursor) return;
  const answer = await link.ask({ type: "light", ...cursor }).catch((error) => ({ error: error.message }));
  if (name !== pointed) return;
  found = answer.error ? null : answer;
  if (!looked) view.light(found);
}

listen({
  async look(at) {
    looked = at;
    const answer = await link.ask({ type: "light", file: at.file, line: at.line, column: at.column }).catch((error) => ({ error: error.message }));
    if (looked !== at) return;
    note = answer.error ?? null;
    view.light(note === null ? answer : null);
    showPixel();
  },
  leave() {
    looked = note = null;
    view.light(found);
    showPixel();
  },
  open: (at) => link.send({ type: "open", file: at.file, line: at.line, column: at.column }),
});

async function writeBack(name) {
  const answer = await link.ask({ type: "write", name }).catch((error) => ({ error: error.message }));
  toast(answer.ok ? `\`${name}\` is written` : answer.error);
}

let fading;
function toast(text) {
  say(part("toast"), text);
  part("toast").hidden = false;
  clearTimeout(fading);
  fading = setTimeout(() => (part("toast").hidden = true), 4000);
}

// ---- buttons and keys

function pause() {
  link.send({ type: "pause", on: !state.status?.paused });
}

const zoomBy = (factor) => view.zoomTo(view.zoom * factor);
part("pause").addEventListener("click", pause);
part("zoom-in").addEventListener("click", () => zoomBy(Math.SQRT2));
part("zoom-out").addEventListener("click", () => zoomBy(Math.SQRT1_2));
part("zoom-fit").addEventListener("click", () => (view.fitted ? view.zoomTo(1) : view.fit()));
part("help").addEventListener("click", () => part("keys").showModal());
part("why-close").addEventListener("click", () => inspector.clear());
part("fold").addEventListener("click", () => {
  const folded = part("messages").classList.toggle("folded");
  part("fold").setAttribute("aria-expanded", String(!folded));
  say(part("fold"), folded ? "Show" : "Hide");
});

keys(view, inspector, cropper, {
  f: () => view.fit(),
  1: () => view.zoomTo(1),
  "+": () => zoomBy(Math.SQRT2),
  "=": () => zoomBy(Math.SQRT2),
  "-": () => zoomBy(Math.SQRT1_2),
  "[": () => expose(state.stops - 0.25),
  "]": () => expose(state.stops + 0.25),
  0: () => expose(0),
  n() {
    state.show = state.show === "noise" ? "picture" : "noise";
    part("show").value = state.show;
    develop();
  },
  b: pin,
  x: flip,
  c: () => cropper.toggle(),
  p: pause,
  "/"() {
    part("find").focus();
    part("find").select();
  },
  "?": () => part("keys").showModal(),
  Escape() {
    if (!cropper.cancel()) inspector.clear();
  },
});
