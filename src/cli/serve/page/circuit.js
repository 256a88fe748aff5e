// The circuits of the folder, the open circuit with its parameters, and its runs.

import { JobView, ask, byId, element, guarded, say, wordsOf } from "./tools.js";
import { ParameterRow } from "./parameters.js";

// What later modules listen to: "folder" (it was read), "leave" (another circuit is asked for), "open" (it is there),
// "reread" (the same one with a new text), "none" (it cannot be opened), "change" (of a value or a setting of the run).
export const events = new EventTarget();
const emit = name => events.dispatchEvent(new Event(name));

const runView = new JobView(byId("run-view"));

// ---- Lists of the folder

export const folder = { circuits: [], shipped: [], studies: [], recordings: [], troubles: [] };

export async function readFolder() {
  await guarded(byId("folder-messages"), async () => {
    Object.assign(folder, await ask("/api/folder"));
    byId("version").textContent = folder.version;
    byId("folder").textContent = folder.folder;
    listCircuits();
    emit("folder");
  });
}

function listCircuits() {
  const wanted = byId("circuit-filter").value.toLowerCase();
  const fits = listed => `${listed.class} ${listed.source} ${listed.description}`.toLowerCase().includes(wanted);
  const group = (title, all) => {
    const links = all.filter(fits).map(circuitLink);
    return links.length ? [element("h3", {}, title), element("ul", {}, ...links)] : [];
  };
  const found = [...group("In the folder", folder.circuits), ...group("Shipped with bramah", folder.shipped)];
  const nothing = wanted ? "No circuit fits the filter." : "The folder holds no circuit.";
  const circuits = found.length ? found : [element("p", { className: "soft" }, nothing)];
  byId("circuit-list").replaceChildren(...troubleList(), ...circuits);
}

function troubleList() {
  const details = folder.troubles.map(({ source, messages }) =>
    element("details", {}, element("summary", {}, source), element("pre", { className: "messages wrong" }, messages)));
  return details.length ? [element("h3", {}, "Cannot be read"), ...details] : [];
}

// Links, not buttons: the browser's Back works then, and a circuit can be opened in a second tab.
function circuitLink({ source, class: name, description }) {
  const about = [source, description].filter(Boolean).join(": ");
  const href = "#" + new URLSearchParams({ source, class: name });
  const link = element("a", { href }, name, element("small", {}, about));
  if (circuit.source === source && circuit.class === name) link.setAttribute("aria-current", "true");
  return element("li", {}, link);
}

// ---- The open circuit

// `data` is the server's answer, null where the circuit is wrong; `set` holds the changed values, with units, by name;
// `rows` the table's rows by name; `turn` counts openings: answers to an earlier one are dropped.
export const circuit = { source: "", class: "", data: null, set: new Map(), rows: new Map(), turn: 0 };

export async function openCircuit(source, name, set) {
  const turn = ++circuit.turn, other = !circuit.data || source !== circuit.source || name !== circuit.class;
  if (other) {
    runView.clear();
    emit("leave");
  }
  Object.assign(circuit, { source, class: name });
  listCircuits();
  byId("circuit-none").hidden = true;
  say(byId("circuit-messages"), "");
  try {
    const data = await ask("/api/circuit", { source, class: name });
    if (turn === circuit.turn) showCircuit(data, set, other);
  } catch (error) {
    if (turn === circuit.turn) showTrouble(error, set, other);
  }
}

function showCircuit(data, set, other) {
  circuit.data = data;
  document.title = `${data.class} – bramah`;
  byId("circuit-head").hidden = byId("circuit-open").hidden = false;
  byId("circuit-name").textContent = data.class;
  byId("circuit-description").textContent = data.description;
  byId("stop").placeholder = `${data.stop} s`;
  showPicture(data.picture);
  showParameters();
  say(byId("circuit-messages"), [data.messages, ...putValues(set)].filter(Boolean).join("\n"));
  filterParameters();
  changed();
  emit(other ? "open" : "reread");
}

// A reload that fails keeps the form: its values are still wanted once the text is right again.
function showTrouble(error, set, other) {
  if (other) {
    Object.assign(circuit, { data: null, set });
    byId("circuit-open").hidden = true;
    byId("circuit-description").textContent = "";
    emit("none");
  }
  byId("circuit-name").textContent = circuit.class;
  byId("circuit-head").hidden = false;
  say(byId("circuit-messages"), wordsOf(error), true);
  showPicture(error.answer?.picture || "");
}

function showPicture(svg) {
  byId("picture-box").hidden = !svg;
  byId("picture").replaceChildren();
  if (!svg) return;
  const root = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  byId("picture").append(root.nodeName === "svg" ? document.importNode(root, true) : "The picture cannot be shown.");
}

byId("picture-size").onclick = () => {
  const large = byId("picture").classList.toggle("large");
  byId("picture-size").textContent = large ? "Fit" : "Enlarge";
  byId("picture-size").setAttribute("aria-pressed", large);
};
byId("circuit-filter").oninput = listCircuits;
byId("folder-again").onclick = readFolder;
byId("circuit-again").onclick = () => openCircuit(circuit.source, circuit.class, new Map(circuit.set));

// ---- Parameters

function showParameters() {
  circuit.rows.clear();
  const { data } = circuit, boxes = [];
  if (data.inputs.length) boxes.push(parameterGroup("Inputs", true, data.inputs.map(constantInput)));
  for (const [component, parameters] of byComponent(data.parameters)) {
    boxes.push(parameterGroup(component || data.class, component === "", parameters));
  }
  byId("parameters").replaceChildren(...boxes);
}

// Parameters by component (the part of the name before the last dot); those of the circuit itself come first.
function byComponent(parameters) {
  const groups = new Map([["", []]]);
  for (const parameter of parameters) {
    const component = parameter.name.slice(0, Math.max(0, parameter.name.lastIndexOf(".")));
    if (!groups.has(component)) groups.set(component, []);
    groups.get(component).push(parameter);
  }
  return [...groups].filter(([, members]) => members.length);
}

function constantInput({ name, unit }) {
  const description = "constant during the run; empty: not given";
  return { name, shown: "", shown_unit: unit, min: "", max: "", kind: "real", description };
}

function parameterGroup(title, open, parameters) {
  const rows = parameters.map(parameter => new ParameterRow(parameter, edited));
  for (const row of rows) circuit.rows.set(row.parameter.name, row);
  const count = element("span", { className: "soft" }, `  ${rows.length}`);
  const body = element("tbody", {}, ...rows.map(row => row.node));
  return element("details", { open, "data-open": open }, element("summary", {}, title, count), element("table", {}, body));
}

function edited(row, live) {
  remember(row);
  changed();
  if (live) runSoon();
}

function remember(row) {
  if (row.changed && row.valid) circuit.set.set(row.parameter.name, row.value);
  else circuit.set.delete(row.parameter.name);
}

// Puts changed values into the rows; returns a message for each that has none any more.
function putValues(set) {
  circuit.set = new Map();
  const messages = [];
  for (const [name, value] of set) {
    const row = circuit.rows.get(name);
    if (!row) {
      messages.push(`the circuit has no parameter \`${name}\` any more: its changed value was dropped`);
      continue;
    }
    row.value = value;
    remember(row);
  }
  return messages;
}

function changed() {
  const count = circuit.set.size;
  byId("changed").textContent = count ? `${count} changed` : "";
  byId("reset-all").hidden = count === 0;
  emit("change");
}

byId("reset-all").onclick = () => {
  for (const row of circuit.rows.values()) if (row.changed) row.reset();
  circuit.set.clear();
  changed();
};

function filterParameters() {
  const wanted = byId("parameter-filter").value.toLowerCase().trim();
  for (const group of byId("parameters").children) {
    const lines = [...group.querySelectorAll("tr")];
    for (const line of lines) line.hidden = !line.dataset.find.includes(wanted);
    group.hidden = lines.every(line => line.hidden);
    const holdsChange = lines.some(line => line.classList.contains("changed"));
    group.open = wanted !== "" || group.dataset.open === "true" || holdsChange;
  }
}
byId("parameter-filter").oninput = filterParameters;

// ---- Run

const withSeconds = text => /^[\d.]+(e[+-]?\d+)?$/i.test(text) ? text + " s" : text;

function run() {
  const wrong = [...circuit.rows.values()].find(row => !row.valid);
  if (wrong) {
    showWrong(wrong);
    return;
  }
  const { source, class: name } = circuit.data;
  const variables = byId("draw").value.split(",").map(text => text.trim()).filter(Boolean);
  const stop = withSeconds(byId("stop").value.trim());
  const set = Object.fromEntries(circuit.set);
  runView.start("/api/run", { source, class: name, set, stop, variables, units: byId("units").value });
}

function showWrong(row) {
  row.node.closest("details").open = true;
  row.field.node.focus();
  runView.failed(`\`${row.parameter.name}\` is no number`);
}

let rest = 0;
function runSoon() {
  clearTimeout(rest);
  if (byId("live").checked) rest = setTimeout(run, 200);
}

byId("run").onsubmit = event => {
  event.preventDefault();
  run();
};
for (const id of ["stop", "draw", "units"]) byId(id).addEventListener("change", () => emit("change"));

// A datalist completes all of a field: so its entries repeat what stands before the last comma.
function listVariables() {
  const text = byId("draw").value, cut = text.lastIndexOf(",") + 1, before = text.slice(0, cut) + (cut ? " " : "");
  const wanted = text.slice(cut).trim().toLowerCase();
  const all = circuit.data ? circuit.data.variables : [];
  const found = all.filter(variable => variable.name.toLowerCase().includes(wanted)).slice(0, 200);
  byId("draw-list").replaceChildren(...found.map(variable => variableOption(variable, before)));
}
byId("draw").oninput = byId("draw").onfocus = listVariables;

export function variableOption({ name, description, shown_unit: unit }, before = "") {
  const about = [description, unit && unit !== "1" ? `[${unit}]` : ""].filter(Boolean).join(" ");
  return element("option", { value: before + name }, about);
}
