// Step 2 of a study: which columns drive the inputs, and which show variables of the model.

import { button, byId, choice, element, fillTable, tableRow } from "./tools.js";
import { circuit, variableOption } from "./circuit.js";
import { rewrite, study } from "./study_text.js";

// ---- Columns of all recordings: name -> unit

export function columnUnits() {
  const found = new Map();
  for (const { time, info } of study.recordings) {
    for (const { name, unit } of info ? info.columns : []) {
      if (name !== (time || info.time) && !found.has(name)) found.set(name, unit);
    }
  }
  return found;
}

const usedColumns = () => new Set([...study.inputs.values(), ...study.signals].map(owner => owner.column));
const withBrackets = (name, unit) => unit ? `${name} [${unit}]` : name;

function newSignal(column, unit, variable = "") {
  return { name: column, variable, column, unit, sign: 1, full_scale: "", accuracy: "" };
}

// ---- Guesses

const plain = name => name.toLowerCase().replace(/[^a-z0-9]/g, "");
const alike = (names, wanted) => names.find(name => name === wanted) || names.find(name => plain(name) === plain(wanted));

// What has no column yet gets one of equal name; an input also the only column of its unit. Columns known before are
// left alone: the user has decided about them.
export function guessColumns(known = new Map()) {
  const columns = new Map([...columnUnits()].filter(([name]) => !known.has(name)));
  guessInputsByName(columns);
  guessInputsByUnit(columns);
  guessSignals(columns);
}

const openInputs = () => [...study.inputs].filter(([, input]) => !input.column);

function guessInputsByName(columns) {
  for (const [name, input] of openInputs()) {
    const column = alike([...columns.keys()], name);
    if (column) Object.assign(input, { column, unit: columns.get(column) });
  }
}

function guessInputsByUnit(columns) {
  const used = usedColumns(), open = openInputs();
  const unitOf = name => circuit.data.inputs.find(input => input.name === name)?.unit;
  for (const [name, input] of open) {
    const wanted = unitOf(name);
    const fitting = [...columns].filter(([column, unit]) => unit && unit === wanted && !used.has(column));
    const rivals = open.filter(([other]) => unitOf(other) === wanted);
    if (fitting.length === 1 && rivals.length === 1) Object.assign(input, { column: fitting[0][0], unit: wanted });
  }
}

function guessSignals(columns) {
  const used = usedColumns(), names = circuit.data.variables.map(variable => variable.name);
  for (const [column, unit] of columns) {
    const variable = used.has(column) ? undefined : alike(names, column);
    if (variable) study.signals.push(newSignal(column, unit, variable));
  }
}

// ---- Fields

// A text field that writes `owner[property]`.
export function textField(owner, property, label, size, changed, more = {}) {
  const node = element("input", { value: owner[property], size, autocomplete: "off", "aria-label": label, ...more });
  node.onchange = () => {
    owner[property] = node.value.trim();
    changed();
  };
  return node;
}

// A choice among the columns; one that no recording has stays, and is marked.
function columnChoice(owner, label, changed) {
  const columns = columnUnits();
  const options = [["", "–"], ...[...columns].map(([name, unit]) => [name, withBrackets(name, unit)])];
  if (owner.column && !columns.has(owner.column)) options.push([owner.column, `${owner.column} (in no recording)`]);
  return choice(options, owner.column, label, column => {
    Object.assign(owner, { column, unit: columns.get(column) || owner.unit });
    changed();
  });
}

// ---- Inputs

export function showColumns() {
  showInputs();
  showSignals();
}

const BETWEEN = [["true", "holds until the next sample"], ["false", "straight lines"]];
const KINDS = [["command", "command"], ["measured", "measured"]];

function showInputs() {
  const lines = circuit.data ? [...study.inputs].map(inputRow) : [];
  fillTable(byId("inputs"), ["input", "its unit", "column", "unit of the column", "between samples", "kind"], lines);
  if (circuit.data && !lines.length) byId("inputs").append(element("caption", {}, "The circuit has no inputs."));
}

function inputRow([name, input]) {
  const changed = () => {
    rewrite("inputs");
    showInputs();
    showUnused();
  };
  const change = values => {
    Object.assign(input, values);
    changed();
  };
  const known = circuit.data.inputs.find(offered => offered.name === name);
  return tableRow(
    element("code", {}, name),
    known ? known.unit : "no input of the circuit",
    columnChoice(input, `column of input ${name}`, changed),
    textField(input, "unit", `unit of input ${name}`, 8, changed),
    choice(BETWEEN, String(input.hold), `between samples of input ${name}`, text => change({ hold: text === "true" })),
    choice(KINDS, input.kind, `kind of input ${name}`, kind => change({ kind })));
}

// ---- Signals

function showSignals() {
  const lists = new Map(), lines = circuit.data ? study.signals.map(signal => signalRow(signal, lists)) : [];
  fillTable(byId("signals"), ["signal", "variable", "column", "unit", "sign", "full scale", "accuracy", ""], lines);
  byId("signals").append(...lists.values());
  showUnused();
}

function signalsChanged() {
  rewrite("signals");
  showSignals();
}

function signalRow(signal, lists) {
  const { name, variable, sign } = signal, write = () => rewrite("signals");
  return tableRow(
    textField(signal, "name", "name of the signal", 10, signalsChanged),
    variableField(signal, lists),
    columnChoice(signal, `column of ${name}`, () => {
      signal.name ||= signal.column;
      signalsChanged();
    }),
    textField(signal, "unit", `unit of ${name}`, 8, signalsChanged),
    choice([["1", "+1"], ["-1", "−1"]], String(sign), `sign of ${name}`, text => {
      signal.sign = Number(text);
      write();
    }),
    textField(signal, "full_scale", `full scale of ${name}`, 9, write, { placeholder: "range" }),
    textField(signal, "accuracy", `accuracy of ${name}`, 7, write, { placeholder: "from data" }),
    button("remove", () => removeSignal(signal), `remove ${name || variable || "signal"}`));
}

function removeSignal(signal) {
  study.signals = study.signals.filter(other => other !== signal);
  signalsChanged();
}

function variableField(signal, lists) {
  const known = !signal.variable || circuit.data.variables.some(({ name }) => name === signal.variable);
  const more = { "aria-invalid": String(!known), placeholder: "variable of the model" };
  const node = textField(signal, "variable", `variable of ${signal.name}`, 20, signalsChanged, more);
  node.setAttribute("list", variableList(signal.unit, lists).id);
  return node;
}

// The variables of a unit to choose from, all where none has it; signals of the same unit share a list.
function variableList(unit, lists) {
  if (!lists.has(unit)) {
    const all = circuit.data.variables;
    const fitting = all.filter(variable => variable.unit === unit || variable.shown_unit === unit);
    const options = (fitting.length ? fitting : all).map(variable => variableOption(variable));
    lists.set(unit, element("datalist", { id: `variables-${lists.size}` }, ...options));
  }
  return lists.get(unit);
}

function showUnused() {
  const used = usedColumns();
  const unused = circuit.data ? [...columnUnits()].filter(([name]) => !used.has(name)) : [];
  const buttons = unused.flatMap(([name, unit]) =>
    [button(withBrackets(name, unit), () => addSignal(newSignal(name, unit)), `add a signal for column ${name}`), " "]);
  byId("unused").replaceChildren(...(buttons.length ? ["for a column not used yet: ", ...buttons] : []));
}

function addSignal(signal) {
  study.signals.push(signal);
  showSignals();
  byId("signals").querySelector("tbody tr:last-child td:nth-child(2) input").focus();
}
byId("add-signal").onclick = () => addSignal(newSignal("", ""));
