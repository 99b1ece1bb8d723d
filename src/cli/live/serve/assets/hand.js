// Mouse, touch and keys on the picture.

/// Device pixels that a press may move and still be a click.
const STILL = 4;
const WHEEL = 0.0016;

/// Makes a view follow the hand. `on` has `click(pixel)`, `hover(pixel or null)`, `window(rectangle, done)`, and
/// `cropping()`: whether a window is to be dragged.
export function hold(view, on) {
  const { stage } = view;
  const pointers = new Map();
  const hand = { dragging: false, from: null, spread: 0 };

  stage.addEventListener("pointerdown", (event) => {
    if (event.button > 1) return;
    stage.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    hand.dragging = pointers.size > 1;
    hand.from = [event.clientX, event.clientY];
    hand.corner = view.place(event.clientX, event.clientY);
    hand.spread = spread(pointers);
  });

  stage.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return on.hover(view.pixel(event.clientX, event.clientY));
    const before = middle(pointers);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const moved = Math.hypot(event.clientX - hand.from[0], event.clientY - hand.from[1]);
    hand.dragging ||= moved > STILL;
    if (!hand.dragging) return;
    if (on.cropping() && pointers.size === 1) return on.window(rectangle(event), false);
    const now = middle(pointers);
    const ratio = devicePixelRatio;
    view.pan((now[0] - before[0]) * ratio, (now[1] - before[1]) * ratio);
    if (pointers.size > 1) pinch(now);
    stage.dataset.hand = "drag";
  });

  const letGo = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    delete stage.dataset.hand;
    if (event.type === "pointercancel") return;
    if (on.cropping() && hand.dragging) return on.window(rectangle(event), true);
    const pixel = view.pixel(event.clientX, event.clientY);
    if (!hand.dragging && pixel && event.button === 0) on.click(pixel);
  };
  stage.addEventListener("pointerup", letGo);
  stage.addEventListener("pointercancel", letGo);
  stage.addEventListener("pointerleave", () => on.hover(null));

  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    const by = Math.exp(-event.deltaY * lines * WHEEL * (event.ctrlKey ? 4 : 1));
    view.zoomTo(view.zoom * by, onStage([event.clientX, event.clientY]));
  }, { passive: false });

  function rectangle(event) {
    const to = view.place(event.clientX, event.clientY);
    const side = (v, i) => Math.min(Math.max(v, 0), view.film?.size[i] ?? 0);
    const low = hand.corner.map((v, i) => Math.floor(side(Math.min(v, to[i]), i)));
    const high = hand.corner.map((v, i) => Math.ceil(side(Math.max(v, to[i]), i)));
    return [low[0], low[1], high[0] - low[0], high[1] - low[1]];
  }

  function pinch(at) {
    const now = spread(pointers);
    if (hand.spread > 0) view.zoomTo((view.zoom * now) / hand.spread, onStage(at));
    hand.spread = now;
  }

  function onStage([x, y]) {
    const box = stage.getBoundingClientRect();
    return [(x - box.left) * devicePixelRatio, (y - box.top) * devicePixelRatio];
  }
}

function middle(pointers) {
  const all = [...pointers.values()];
  return [0, 1].map((i) => all.reduce((sum, p) => sum + p[i], 0) / all.length);
}

/// How far the first two fingers are apart.
function spread(pointers) {
  const [a, b] = pointers.values();
  return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
}
