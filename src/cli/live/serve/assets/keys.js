// Keys: some work everywhere, arrows only on the picture.

/// Device pixels that an arrow moves the picture.
const STEP = 60;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/// Listens for keys, each with what it does.
export function keys(view, inspector, actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  });

  view.stage.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && view.mark) return inspector.look(view.mark);
    const way = ARROWS[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey || !view.film) return;
    event.preventDefault();
    if (event.shiftKey) inspector.mark(next(view, way));
    else view.pan(-way[0] * STEP, -way[1] * STEP);
  });
}

/// The pixel beside the one that is marked, or the middle of the picture.
function next(view, way) {
  const from = view.mark ?? view.film.size.map((side) => side >> 1);
  return from.map((v, i) => Math.min(Math.max(v + way[i], 0), view.film.size[i] - 1));
}

/// Whether keys mean text, or a value, where they are typed.
function isTyping(target) {
  return target.matches("input:not([type=checkbox], [type=radio], [type=range]), select, textarea, dialog *");
}
