// What can be set: a slider, a switch, a colour or a field for each param.

import { element, part } from "./element.js";

/// Milliseconds between values while a slider is dragged.
const PERIOD = 40;

const GONE = "The file has no such param any more: Reset drops this value.";

/// Units by name: factor and dimension.
let units = new Map();

export function serveUnits(list) {
  units = new Map(list.map(([name, factor]) => [name, factor]));
}

/// The rows of the panel. `on` has `set(name, value)` and `write(name)`.
export class Params {
  constructor(on) {
    this.on = on;
    this.rows = new Map();
    this.params = [];
    part("copy-set").addEventListener("click", () => this.copy());
  }

  update(params) {
    this.params = params;
    part("params-section").hidden = params.length === 0;
    part("copy-set").hidden = !params.some((param) => param.set);
    const names = new Set(params.map((param) => param.name));
    for (const [name, row] of this.rows) {
      if (names.has(name) && row.same(params.find((param) => param.name === name))) continue;
      row.root.remove();
      this.rows.delete(name);
    }
    let before = null;
    for (const param of params) {
      let row = this.rows.get(param.name);
      if (!row) {
        row = new Row(param, this.on);
        this.rows.set(param.name, row);
      }
      const next = before ? before.nextSibling : part("params").firstChild;
      if (next !== row.root) part("params").insertBefore(row.root, next);
      before = row.root;
      row.update(param);
    }
  }

  /// The flags of the command line that set what is set here.
  flags() {
    const quoted = (text) => `'${text.replaceAll("'", "'\\''")}'`;
    return this.params.filter((param) => param.set).map((param) => `--set ${quoted(`${param.name}=${param.value}`)}`).join(" ");
  }

  async copy() {
    await navigator.clipboard.writeText(this.flags());
    this.on.say("Copied");
  }
}

class Row {
  constructor(param, on) {
    this.shape = shape(param);
    this.name = param.name;
    this.on = on;
    const id = `param-${param.name}`;
    this.field = element("input", {
      id, type: "text", spellcheck: "false", autocomplete: "off", autocapitalize: "off", "aria-describedby": `${id}-doc`,
      onchange: () => this.set(this.field.value.trim()),
    });
    this.control = control(param, (value) => this.drag(value));
    if (this.control) this.control.node.setAttribute("aria-label", param.name);
    this.back = element("button", { type: "button", class: "quiet", title: "As the file says", onclick: () => on.set(param.name, "") }, "Reset");
    this.write = element("button", { type: "button", class: "quiet", title: "Writes this value into the text, as the param's default", onclick: () => on.write(param.name) }, "Write");
    this.actions = element("span", { class: "actions" }, this.back, this.write);
    // One that the file has not any more can be dropped, and nothing else.
    const gone = param.default === "";
    this.write.hidden = this.field.readOnly = gone;
    const range = param.low != null ? `${param.low} to ${param.high}` : "";
    this.root = element("div", { class: "param" },
      element("div", { class: "row" }, element("label", { for: id }, param.name), element("span", { class: "type" }, [param.type, range].filter(Boolean).join(", ")), this.actions),
      element("div", { class: "row" }, this.control?.node, this.field),
      element("p", { class: "doc", id: `${id}-doc` }, gone ? GONE : (param.doc ?? "")));
  }

  same(param) {
    return this.shape === shape(param);
  }

  update(param) {
    this.root.classList.toggle("is-set", param.set);
    this.actions.hidden = !param.set;
    if (document.activeElement !== this.field) this.field.value = param.value;
    if (this.control && document.activeElement !== this.control.node) this.control.show(param.value);
  }

  set(value) {
    clearTimeout(this.timer);
    this.timer = null;
    this.control?.show(value);
    this.on.set(this.name, value);
  }

  /// Takes values as fast as they come, and passes on some of them, and the last.
  drag(value) {
    this.field.value = value;
    this.value = value;
    this.timer ??= setTimeout(() => {
      this.timer = null;
      this.on.set(this.name, this.value);
    }, PERIOD);
  }
}

/// What a row is made for; another needs another row.
function shape(param) {
  return JSON.stringify([param.type, param.doc, param.default, param.low, param.high]);
}

/// What a value is chosen with, where its type has something better than a field.
function control(param, drag) {
  if (param.type === "bool") return toggle(drag);
  if (param.type === "color" && hex(param.default)) return swatch(drag);
  return slider(param, drag);
}

function toggle(drag) {
  const node = element("input", { type: "checkbox", role: "switch", onchange: () => drag(String(node.checked)) });
  return { node, show: (value) => (node.checked = value === "true") };
}

function swatch(drag) {
  const node = element("input", { type: "color", oninput: () => drag(node.value) });
  return { node, show: (value) => { if (hex(value)) node.value = hex(value); } };
}

/// `#rgb` and `#rrggbb` as the browser writes colours.
function hex(text) {
  const digits = /^#([0-9a-f]{3}|[0-9a-f]{6})$/i.exec(text)?.[1];
  if (!digits) return null;
  return `#${digits.length === 3 ? [...digits].map((d) => d + d).join("") : digits}`.toLowerCase();
}

/// A slider from the least to the greatest, in the unit of the default.
function slider(param, drag) {
  const [low, high, now] = [param.low, param.high, param.default].map(literal);
  if (!low || !high || !now) return null;
  const inUnit = (quantity) => (quantity.value * quantity.factor) / now.factor;
  const [least, most] = [inUnit(low), inUnit(high)];
  if (!(most > least)) return null;
  const step = param.type === "int" ? 1 : nice((most - least) / 200);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const write = (v) => `${Number(v.toFixed(decimals))}${now.unit}`;
  const node = element("input", { type: "range", min: least, max: most, step, oninput: () => drag(write(node.valueAsNumber)) });
  const show = (value) => {
    const quantity = literal(value);
    if (quantity) node.value = inUnit(quantity);
    node.setAttribute("aria-valuetext", value);
  };
  return { node, show };
}

/// The greatest of 1, 2 and 5 times a power of ten that is not above a number.
function nice(v) {
  const power = 10 ** Math.floor(Math.log10(v));
  return [5, 2, 1].find((n) => n * power <= v * 1.000001) * power;
}

/// A number with its unit, such as `45cm` or `10W/m2`; nothing for any other expression.
function literal(text) {
  const found = /^(-?[\d_]*\.?\d+(?:e[+-]?\d+)?)([a-zA-Z%][\w/%]*)?$/.exec(text);
  if (!found) return null;
  const unit = found[2] ?? "";
  const factor = unit === "" ? 1 : unit.split("/").map(power).reduce((product, f, i) => (i ? product / f : product * f), 1);
  return Number.isFinite(factor) ? { value: Number(found[1].replaceAll("_", "")), unit, factor } : null;
}

function power(text) {
  const [, name, exponent] = /^(\D+)(\d*)$/.exec(text) ?? [];
  return (units.get(name) ?? NaN) ** Number(exponent || 1);
}
