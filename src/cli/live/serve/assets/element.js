// Building the page's parts.

/// An element with attributes, or listeners where a name begins with `on`, and what it holds.
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child != null));
  return made;
}

/// The element of an id of the page.
export function part(id) {
  return document.getElementById(id);
}

/// Sets a text, if it is not that already, so that what is selected stays.
export function say(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

/// Whole numbers with narrow spaces between thousands.
export function count(n) {
  return Math.round(n).toString().replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

/// A value with as many figures as matter.
export function figures(v, most = 4) {
  if (v === 0 || !Number.isFinite(v)) return String(v);
  const size = Math.abs(v);
  if (size >= 1e6 || size < 1e-4) return v.toExponential(most - 2).replace("e+", "e");
  return String(Number(v.toPrecision(most)));
}

/// Seconds as one says them.
export function duration(seconds) {
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 60) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${Math.floor(seconds % 60)} s`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/// A ratio in per cent.
export function percent(ratio) {
  return `${figures(100 * ratio, ratio < 0.1 ? 2 : 3)} %`;
}
