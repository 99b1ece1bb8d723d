// The window that is rendered first: dragged, or spanned with keys from the pixel that is marked.

import { part } from "./element.js";

const HOW = "Drag a window; or span it from the marked pixel with ⇧ and the arrows, and press Enter";

/// Chooses a window of a view. `on` has `set(window or null)` and `say(text)`.
export class Cropper {
  constructor(view, on) {
    this.view = view;
    this.on = on;
    /// Whether one is to be chosen.
    this.armed = false;
    /// The pixels in its corners, where keys span it: the one it began at, and the one that moves.
    this.corners = null;
    /// What is rendered first.
    this.set = null;
  }

  /// Begins to choose a window, or lets go of the one there is.
  toggle() {
    if (this.set) return this.choose(null);
    this.arm(!this.armed);
    if (!this.armed) return;
    this.on.say(HOW);
    this.view.stage.focus({ preventScroll: true });
  }

  /// Chooses nothing after all. Whether anything was being chosen.
  cancel() {
    const was = this.armed;
    this.arm(false);
    return was;
  }

  /// Moves a corner.
  span(way, step) {
    const { view } = this;
    const from = view.mark ?? view.middle();
    const [first, last] = this.corners ?? [from, from];
    const moved = view.inside(last.map((v, i) => v + way[i] * step));
    this.corners = [first, moved];
    view.reveal(moved);
    const window = rectangle(this.corners);
    view.frame(window);
    this.on.say(`${window[2]} × ${window[3]} pixels; Enter takes them`);
  }

  /// Takes what keys have spanned. Whether they have.
  take() {
    if (!this.corners) return false;
    this.choose(rectangle(this.corners));
    return true;
  }

  /// A window is dragged, or was.
  drag(window, done) {
    this.view.frame(window);
    if (done) this.choose(window[2] > 0 && window[3] > 0 ? window : null);
  }

  /// Shows what `rtc watch` renders first.
  update(window) {
    this.set = window;
    if (!this.armed) this.view.frame(window);
    this.show();
  }

  choose(window) {
    this.arm(false);
    this.on.set(window);
    this.on.say(window ? `${window[2]} × ${window[3]} pixels are rendered first` : "The whole picture is rendered");
    this.update(window);
  }

  arm(on) {
    this.armed = on;
    this.corners = null;
    this.view.frame(this.set);
    this.show();
  }

  show() {
    part("crop").setAttribute("aria-pressed", String(this.armed || this.set !== null));
    this.view.stage.classList.toggle("cropping", this.armed);
  }
}

/// Left, top, width and height of what two pixels span, both inside.
function rectangle([a, b]) {
  const [left, top] = a.map((v, i) => Math.min(v, b[i]));
  const [right, bottom] = a.map((v, i) => Math.max(v, b[i]) + 1);
  return [left, top, right - left, bottom - top];
}
