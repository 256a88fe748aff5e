// A row of the parameter table: name, slider, field, and the way back to the value of the circuit.

import { button, element, tableRow, withUnit } from "./tools.js";

export class ParameterRow {
  // `edited(row, live)` is called after each change by the user; live: by the slider.
  constructor(parameter, edited) {
    this.parameter = parameter;
    this.edited = edited;
    this.field = fieldOf(parameter);
    this.slider = sliderOf(parameter);
    this.undo = button("reset", () => this.change(parameter.shown), `reset ${parameter.name}`);
    this.node = this.build();
    this.put(parameter.shown);
    this.listen();
  }

  build() {
    const { name, description, shown_unit: unit } = this.parameter;
    const short = name.slice(name.lastIndexOf(".") + 1);
    const title = element("td", {}, element("code", {}, short), element("small", {}, description));
    const value = element("div", { className: "value" }, this.field.node, element("span", {}, unit === "1" ? "" : unit));
    const node = tableRow(title, this.slider ? this.slider.node : "", value, this.undo);
    node.dataset.find = `${name} ${description}`.toLowerCase();
    return node;
  }

  listen() {
    this.field.node.addEventListener(this.field.event, () => {
      this.note(this.field.get());
      this.edited(this, false);
    });
    if (!this.slider) return;
    this.slider.node.oninput = () => this.change(this.slider.get(), true);
  }

  change(text, live = false) {
    this.put(text);
    this.edited(this, live);
  }

  put(text) {
    this.field.put(text);
    this.note(text);
  }

  note(text) {
    this.text = text;
    this.valid = this.field.check(text);
    this.changed = text !== this.parameter.shown;
    this.node.classList.toggle("changed", this.changed);
    this.undo.hidden = !this.changed;
    if (this.slider) this.slider.put(text);
  }

  // The value as the server takes it, and as the address keeps it: with its unit.
  get value() {
    return withUnit(this.text, this.parameter.shown_unit);
  }

  set value(text) {
    const end = " " + this.parameter.shown_unit;
    this.put(end !== " " && text.endsWith(end) ? text.slice(0, -end.length) : text);
  }

  reset() {
    this.put(this.parameter.shown);
  }
}

// ---- Fields. `event` is what the browser sends after each change, `check` marks what is no value.

function fieldOf(parameter) {
  const label = { id: "value-" + parameter.name, "aria-label": parameter.name };
  if (parameter.kind === "boolean") return switchField(label);
  if (parameter.kind === "enumeration") return literalField(label, parameter.literals);
  return numberField(label, parameter.shown);
}

const always = () => true;

function switchField(label) {
  const node = element("input", { type: "checkbox", ...label });
  const put = text => { node.checked = text === "true"; };
  return { node, event: "change", get: () => String(node.checked), put, check: always };
}

function literalField(label, literals) {
  const node = element("select", label, ...literals.map(literal => element("option", { value: literal }, literal)));
  const put = text => { node.value = text; };
  return { node, event: "change", get: () => node.value, put, check: always };
}

// The value of the circuit is right in any case: that of an input is empty.
function numberField(label, shown) {
  const node = element("input", { autocomplete: "off", inputMode: "decimal", ...label });
  const put = text => { node.value = text; };
  const check = text => {
    const valid = text === shown || (text.trim() !== "" && Number.isFinite(Number(text)));
    node.setAttribute("aria-invalid", !valid);
    return valid;
  };
  return { node, event: "input", get: () => node.value.trim(), put, check };
}

// ---- Sliders

const POSITIONS = 1000;

// A slider over a parameter's range, or null where it has no number.
function sliderOf(parameter) {
  const value = Number(parameter.shown), integer = parameter.kind === "integer";
  if (!(integer || parameter.kind === "real") || parameter.shown === "" || !Number.isFinite(value)) return null;
  const [least, greatest] = rangeAround(value, limit(parameter.min), limit(parameter.max));
  if (!(greatest > least)) return null;
  const scale = scaleOf(least, greatest, integer);
  const node = element("input", { type: "range", min: 0, max: POSITIONS, step: 1, "aria-label": parameter.name });
  const get = () => scale.textAt(node.value / POSITIONS);
  const put = text => {
    // Not while the slider itself gave the value: rounding would pull it back from an arrow key.
    if (Number.isFinite(Number(text)) && get() !== text) node.value = POSITIONS * scale.partOf(Number(text));
    node.setAttribute("aria-valuetext", withUnit(text, parameter.shown_unit));
  };
  return { node, get, put };
}

const limit = text => text === "" ? null : Number(text);

function rangeAround(value, min, max) {
  // Bounds like 0 to 1e10 around 0.02 only say what is possible: a linear slider over them moves nothing.
  const useful = min > 0 || value === 0 || max - min <= 1000 * Math.abs(value);
  if (min !== null && max !== null && useful) return [min, max];
  const [least, greatest] = value === 0 ? [-1, 1] : [Math.min(0, 2 * value), Math.max(0, 2 * value)];
  return [min === null ? least : Math.max(least, min), max === null ? greatest : Math.min(greatest, max)];
}

// Between parts of the way (0 to 1) and values: logarithmic where the range spans more than two decades.
function scaleOf(least, greatest, integer) {
  const logarithmic = least > 0 && greatest > 100 * least;
  const step = integer ? 1 : niceStep((greatest - least) / POSITIONS);
  const inside = value => Math.min(greatest, Math.max(least, value));
  const valueAt = part => logarithmic ? least * (greatest / least) ** part : least + part * (greatest - least);
  const rounded = value => integer || !logarithmic ? Math.round(value / step) * step : Number(value.toPrecision(3));
  const partOf = value => logarithmic
    ? Math.log(inside(value) / least) / Math.log(greatest / least)
    : (inside(value) - least) / (greatest - least);
  // Twelve digits: a step of 0.1 gives 0.3, not 0.30000000000000004.
  const textAt = part => String(Number(inside(rounded(valueAt(part))).toPrecision(12)));
  return { partOf, textAt };
}

function niceStep(raw) {
  const base = Math.pow(10, Math.floor(Math.log10(raw)));
  return [1, 2, 5, 10].find(factor => factor * base >= raw * (1 - 1e-9)) * base;
}
