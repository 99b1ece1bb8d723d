// Keys: some work everywhere, arrows only on the picture.

/// Device pixels that an arrow moves the picture.
const STEP = 60;
/// Pixels of the picture that an arrow goes on at a time, by small steps and by large ones.
const SMALL = 1;
const LARGE = 16;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/// Listens for keys, each with what it does.
export function keys(view, inspector, cropper, actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  });

  view.stage.addEventListener("keydown", (event) => {
    if (event.metaKey || event.altKey || !view.film) return;
    if (event.key === "Enter") {
      if (!cropper.take() && view.mark) inspector.look(view.mark);
      return;
    }
    const way = ARROWS[event.key];
    if (!way || (event.ctrlKey && !event.shiftKey)) return;
    event.preventDefault();
    if (!event.shiftKey) return view.pan(-way[0] * STEP, -way[1] * STEP);
    const step = event.ctrlKey ? LARGE : SMALL;
    if (cropper.armed) cropper.span(way, step);
    else inspector.mark(next(view, way, step));
  });
}

/// A pixel so far from the one that is marked, or from the middle of the picture.
function next(view, way, step) {
  const from = view.mark ?? view.middle();
  const pixel = view.inside(from.map((v, i) => v + way[i] * step));
  view.reveal(pixel);
  return pixel;
}

/// Whether keys mean text, or a value, where they are typed.
function isTyping(target) {
  return target.matches("input:not([type=checkbox], [type=radio], [type=range]), select, textarea, dialog *");
}
