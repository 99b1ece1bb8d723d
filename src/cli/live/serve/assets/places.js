// Places in files: each leads to the editor, and lights up what it made.

import { element } from "./element.js";

/// What the editor is reached by, set once the server has said so.
const editor = { url: null, runs: false, folder: "/" };
/// What happens as a place is looked at, left, or opened by the server.
const on = { look() {}, leave() {}, open() {} };

/// Tells how places are opened, and what else they do.
export function serveEditor(said, folder) {
  Object.assign(editor, said, { folder });
}

export function listen(listeners) {
  Object.assign(on, listeners);
}

/// A place to click, with a text of its own or its name.
export function place(at, text = `${at.file}:${at.line}:${at.column}`) {
  const listeners = {
    onpointerenter: () => on.look(at),
    onpointerleave: () => on.leave(at),
    onfocus: () => on.look(at),
    onblur: () => on.leave(at),
  };
  if (editor.runs) {
    const title = `Open ${at.file} in the editor`;
    return element("button", { class: "place", type: "button", title, onclick: () => on.open(at), ...listeners }, text);
  }
  const href = address(at);
  return element("a", { class: "place", href, title: `${at.file}:${at.line}:${at.column}`, ...listeners }, text);
}

function address({ file, line, column }) {
  const whole = absolute(file).split("/").map(encodeURIComponent).join("/");
  return editor.url.replaceAll("{file}", whole).replaceAll("{line}", line).replaceAll("{column}", column);
}

/// The path with `/` between its folders, which it also begins with.
function absolute(file) {
  const slashes = file.replaceAll("\\", "/");
  const rooted = /^(\/|[A-Za-z]:)/.test(slashes) ? slashes : `${editor.folder.replaceAll("\\", "/")}/${slashes}`;
  return rooted.startsWith("/") ? rooted : `/${rooted}`;
}

/// A text with its places made clickable. They come in order, and say where in the text they stand.
export function linked(text, places) {
  const parts = [];
  let end = 0;
  for (const at of places) {
    if (at.start < end || at.end > text.length) continue;
    parts.push(text.slice(end, at.start), place(at, text.slice(at.start, at.end)));
    end = at.end;
  }
  parts.push(text.slice(end));
  return parts;
}
