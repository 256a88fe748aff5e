"use strict";
// The page of `bramah serve`. Top to bottom: helpers, jobs, tabs and lists, the circuit, the study.

const $ = id => document.getElementById(id);
const GONE = "bramah serve does not answer: was it stopped?";
const pause = ms => new Promise(done => setTimeout(done, ms));

// An element with properties (those with a dash are attributes) and children.
function el(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes("-")) node.setAttribute(key, value);
    else node[key] = value;
  }
  node.append(...children);
  return node;
}

const button = (text, onclick, label = text) => el("button", { type: "button", textContent: text, onclick, className: "small", "aria-label": label });
const select = (options, value, onchange, label) => {
  const node = el("select", { "aria-label": label, onchange }, ...options.map(([v, text]) => el("option", { value: v }, text)));
  node.value = value;
  return node;
};
const head = (...names) => el("thead", {}, el("tr", {}, ...names.map(n => el("th", { scope: "col" }, n))));
const row = (...cells) => el("tr", {}, ...cells.map(c => c instanceof HTMLTableCellElement ? c : el("td", {}, c)));

// ---- Server

class Refusal extends Error {
  constructor(status, answer) { super(answer.messages || `bramah serve answered with status ${status}`); this.status = status; this.answer = answer; }
}

async function ask(path, options) {
  let response;
  try { response = await fetch(path, options); } catch { throw new Refusal(0, { messages: GONE }); }
  const answer = await response.json().catch(() => null);
  if (!response.ok || answer === null) throw new Refusal(response.status, answer || {});
  return answer;
}
const post = (path, body) => ask(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
const query = values => new URLSearchParams(values).toString();

function say(place, text, wrong = false) {
  place.textContent = text;
  place.classList.toggle("wrong", wrong && text !== "");
}

// The words for what was thrown; a mistake of this page itself also goes to the console.
function wordsOf(e) {
  if (!(e instanceof Refusal)) console.error(e);
  return e.message;
}

// Does something, and shows in `place` what was wrong about it.
async function guarded(place, action) {
  say(place, "");
  try { await action(); } catch (e) { say(place, wordsOf(e), true); }
}

// ---- Jobs: progress, messages and the page of one run, comparison or diagnosis after the other

class JobView {
  constructor(place) {
    this.turn = 0;       // counts starts: answers to an earlier one are dropped
    this.id = null;      // the job that runs
    this.bar = el("progress", { "aria-label": "Progress" });
    this.stage = el("span", { "aria-live": "polite" });
    this.time = el("span", { className: "soft" });
    this.stopper = el("button", { type: "button", textContent: "Stop", onclick: () => this.stop() });
    this.progress = el("div", { className: "progress", hidden: true }, this.bar, this.stage, this.time, this.stopper);
    this.messages = el("pre", { className: "messages", "aria-live": "polite" });
    this.caption = el("div", { className: "caption" });
    this.frame = el("div", { className: "frame" });
    place.append(this.progress, this.messages, this.caption, this.frame);
  }

  async stop() {
    this.stage.textContent = "stopping…";
    this.stopping = true;
    await guarded(this.messages, () => post("/api/job/stop", { id: this.id }));
  }

  // A job still running is stopped first: nobody will see what it computes.
  async start(path, body) {
    const turn = ++this.turn, before = this.id;
    this.id = null;
    this.stopping = false;
    this.stage.textContent = "starting";
    this.time.textContent = "";
    this.bar.removeAttribute("value");
    try {
      if (before !== null) await post("/api/job/stop", { id: before });
      const { job } = await post(path, body);
      if (turn !== this.turn) { await post("/api/job/stop", { id: job }); return; }
      this.id = job;
      await this.follow(job, turn);
    } catch (e) {
      if (turn !== this.turn) return;
      this.failed(wordsOf(e));
    }
    if (turn === this.turn) { this.progress.hidden = true; this.id = null; }
  }

  async follow(id, turn) {
    for (const begin = performance.now(); ;) {
      const job = await ask("/api/job?" + query({ id })), elapsed = performance.now() - begin;
      if (turn !== this.turn) return;
      if (job.state !== "running") { this.show(job); return; }
      if (!this.stopping) this.stage.textContent = job.stage;
      this.time.textContent = `${job.seconds.toFixed(1)} s`;
      if (job.share === null) this.bar.removeAttribute("value"); else this.bar.value = job.share;
      // A short run shows no progress: the curves would jump up and down while a slider moves.
      if (elapsed > 300) this.progress.hidden = false;
      await pause(elapsed < 2000 ? 100 : 500);
    }
  }

  show(job) {
    if (job.state !== "done") { this.failed(job.messages || (job.state === "stopped" ? "Stopped." : "It failed, and said no reason."), job.state === "failed"); return; }
    say(this.messages, job.messages);
    const address = "/api/job/page?" + query({ id: job.id });
    this.caption.replaceChildren(el("span", {}, `Done in ${job.seconds.toFixed(job.seconds < 1 ? 3 : 1)} s`), ...job.files.map(file => button("Download " + file.name, () => download(file))));
    if (!job.page) { this.frame.replaceChildren(); return; }
    this.caption.append(el("a", { href: address, target: "_blank", rel: "noopener" }, "Open in a tab of its own"));
    this.frame.classList.remove("stale");
    // The old page stays until the new one is there, so that nothing flickers while a slider moves.
    const old = [...this.frame.children], frame = el("iframe", { src: address, title: "Result", className: "loading" });
    frame.setAttribute("sandbox", "allow-scripts");
    frame.onload = () => { frame.className = ""; old.forEach(o => o.remove()); };
    this.frame.append(frame);
  }

  failed(text, wrong = true) {
    say(this.messages, text, wrong);
    if (!this.frame.children.length) return;
    this.frame.classList.add("stale");
    this.caption.replaceChildren("Below: the result before this one");
  }

  // Forgets the job and its result, as they belong to another circuit.
  clear() {
    this.turn++;
    if (this.id !== null) post("/api/job/stop", { id: this.id }).catch(e => say(this.messages, e.message, true));
    this.id = null;
    this.progress.hidden = true;
    say(this.messages, "");
    this.caption.replaceChildren();
    this.frame.replaceChildren();
  }
}

function download(file) {
  const address = URL.createObjectURL(new Blob([file.text]));
  el("a", { href: address, download: file.name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

const runView = new JobView($("run-view")), studyView = new JobView($("study-view"));

// ---- Tabs, and the state of the open circuit in the address

const TABS = ["circuit", "study"];
function showTab(name) {
  for (const tab of TABS) {
    $(tab).hidden = tab !== name;
    $("tab-" + tab).setAttribute("aria-selected", tab === name);
    $("tab-" + tab).tabIndex = tab === name ? 0 : -1;
  }
}
for (const tab of TABS) {
  $("tab-" + tab).onclick = () => { showTab(tab); keepAddress(); };
  $("tab-" + tab).onkeydown = e => {
    if (e.key !== "ArrowLeft" && e.key !== "ArrowRight") return;
    const other = $("tab-" + TABS.find(t => t !== tab));
    other.click();
    other.focus();
  };
}

function keepAddress() {
  if (!circuit.data) return;
  const state = new URLSearchParams({ source: circuit.data.source, class: circuit.data.class });
  if ($("circuit").hidden) state.set("tab", "study");
  if ($("stop").value) state.set("stop", $("stop").value);
  if ($("draw").value) state.set("draw", $("draw").value);
  if ($("units").value !== "engineering") state.set("units", $("units").value);
  for (const [name, value] of circuit.set) state.append("set", `${name}=${value}`);
  history.replaceState(null, "", "#" + state);
}

async function readAddress() {
  const state = new URLSearchParams(location.hash.slice(1));
  showTab(state.get("tab") === "study" ? "study" : "circuit");
  if (!state.get("class")) return;
  const set = state.getAll("set").map(s => [s.slice(0, s.indexOf("=")), s.slice(s.indexOf("=") + 1)]);
  $("stop").value = state.get("stop") || "";
  $("draw").value = state.get("draw") || "";
  $("units").value = state.get("units") || "engineering";
  await openCircuit(state.get("source") || "", state.get("class"), new Map(set));
}

// ---- Lists of the folder

let folder = { circuits: [], shipped: [], studies: [], recordings: [], troubles: [] };

async function readFolder() {
  await guarded($("folder-messages"), async () => {
    folder = await ask("/api/folder");
    $("version").textContent = folder.version;
    $("folder").textContent = folder.folder;
    listCircuits();
    fill($("folder-recordings"), folder.recordings);
    fill($("folder-studies"), folder.studies);
    $("add-recording").disabled = !folder.recordings.length;
    $("open-study").disabled = !folder.studies.length;
  });
}
const fill = (node, names) => node.replaceChildren(...(names.length ? names : ["none"]).map(name => el("option", { value: name }, name)));

function listCircuits() {
  const wanted = $("circuit-filter").value.toLowerCase();
  const group = (title, all) => {
    const shown = all.filter(c => `${c.class} ${c.source} ${c.description}`.toLowerCase().includes(wanted));
    return shown.length ? [el("h3", {}, title), el("ul", {}, ...shown.map(circuitLink))] : [];
  };
  const troubles = folder.troubles.map(t => el("details", {}, el("summary", {}, t.source), el("pre", { className: "messages wrong" }, t.messages)));
  const found = [...group("In the folder", folder.circuits), ...group("Shipped with bramah", folder.shipped)];
  $("circuit-list").replaceChildren(
    ...(troubles.length ? [el("h3", {}, "Cannot be read"), ...troubles] : []),
    ...(found.length ? found : [el("p", { className: "soft" }, wanted ? "No circuit fits the filter." : "The folder holds no circuit.")]));
}

// Links, not buttons: the browser's Back works then, and a circuit can be opened in a second tab.
function circuitLink(c) {
  const link = el("a", { href: "#" + query({ source: c.source, class: c.class }) }, c.class, el("small", {}, [c.source, c.description].filter(Boolean).join(": ")));
  if (circuit.source === c.source && circuit.class === c.class) link.setAttribute("aria-current", "true");
  return el("li", {}, link);
}

// ---- Circuit

// `set` holds the changed values as texts in the shown unit; `rows` what redraws a parameter's row.
const circuit = { source: "", class: "", data: null, set: new Map(), rows: new Map(), turn: 0 };

async function openCircuit(source, name, set) {
  const turn = ++circuit.turn, other = !circuit.data || source !== circuit.source || name !== circuit.class;
  if (other) { runView.clear(); studyView.clear(); }
  Object.assign(circuit, { source, class: name });
  listCircuits();
  $("circuit-none").hidden = true;
  say($("circuit-messages"), "");
  try {
    const data = await ask("/api/circuit?" + query({ source, class: name }));
    if (turn === circuit.turn) showCircuit(data, set, other);
  } catch (e) {
    if (turn !== circuit.turn) return;
    // A reload that fails keeps the form: its values are still wanted once the text is right again.
    if (other) { circuit.data = null; circuit.set = set; $("circuit-open").hidden = true; $("circuit-description").textContent = ""; studyCircuit(); }
    $("circuit-name").textContent = name;
    $("circuit-head").hidden = false;
    say($("circuit-messages"), wordsOf(e), true);
    showPicture(e.answer?.picture || "");
  }
}

function showCircuit(data, set, other) {
  const known = new Set([...data.parameters, ...data.inputs].map(p => p.name));
  const gone = [...set.keys()].filter(name => !known.has(name));
  circuit.data = data;
  circuit.set = new Map();
  for (const name of gone) set.delete(name);
  document.title = `${data.class} – bramah`;
  $("circuit-head").hidden = $("circuit-open").hidden = false;
  $("circuit-name").textContent = data.class;
  $("circuit-description").textContent = data.description;
  say($("circuit-messages"), [data.messages, ...gone.map(n => `the circuit has no parameter \`${n}\` any more: its changed value was dropped`)].filter(Boolean).join("\n"));
  showPicture(data.picture);
  $("stop").placeholder = `${data.stop} s`;
  showParameters(set);
  keepAddress();
  studyCircuit(other);
}

function showPicture(svg) {
  $("picture-box").hidden = !svg;
  $("picture").replaceChildren();
  if (!svg) return;
  const root = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  $("picture").append(root.nodeName === "svg" ? document.importNode(root, true) : "The picture cannot be shown.");
}

$("picture-size").onclick = () => {
  const large = $("picture").classList.toggle("large");
  $("picture-size").textContent = large ? "Fit" : "Enlarge";
  $("picture-size").setAttribute("aria-pressed", large);
};

// Parameters by component: the part of the name before the last dot.
function showParameters(set) {
  const groups = new Map([["", []]]);
  for (const p of circuit.data.parameters) {
    const component = p.name.slice(0, Math.max(0, p.name.lastIndexOf(".")));
    if (!groups.has(component)) groups.set(component, []);
    groups.get(component).push(p);
  }
  circuit.rows.clear();
  const boxes = [...groups].filter(([, all]) => all.length).map(([component, all]) => parameterGroup(component || circuit.data.class, component === "", all));
  const inputs = circuit.data.inputs.map(i => ({ name: i.name, shown: "", shown_unit: i.unit, min: "", max: "", kind: "real", description: "constant during the run; empty: not given" }));
  if (inputs.length) boxes.unshift(parameterGroup("Inputs", true, inputs));
  $("parameters").replaceChildren(...boxes);
  for (const [name, text] of set) circuit.rows.get(name).take(text);
  filterParameters();
  countChanged();
}

function parameterGroup(title, open, parameters) {
  const body = el("tbody", {}, ...parameters.map(parameterRow));
  return el("details", { open, "data-open": open }, el("summary", {}, title, el("span", { className: "soft" }, `  ${parameters.length}`)), el("table", {}, body));
}

const withUnit = (value, unit) => unit && unit !== "1" ? `${value} ${unit}` : value;

function parameterRow(p) {
  const field = valueField(p), slider = sliderOf(p), reset = button("reset", () => change(p.shown), `reset ${p.name}`);
  const line = row(el("td", {}, el("code", {}, p.name.slice(p.name.lastIndexOf(".") + 1)), el("small", {}, p.description)),
    slider ? slider.node : "", el("div", { className: "value" }, field.node, el("span", {}, p.shown_unit === "1" ? "" : p.shown_unit)), reset);
  line.dataset.find = `${p.name} ${p.description}`.toLowerCase();
  function note(text) {
    if (text === p.shown || !field.valid(text)) circuit.set.delete(p.name);
    else circuit.set.set(p.name, withUnit(text, p.shown_unit));
    line.classList.toggle("changed", text !== p.shown);
    reset.hidden = text === p.shown;
    if (slider) slider.put(text);
  }
  function change(text) { field.put(text); note(text); changed(); }
  field.node.addEventListener(p.kind === "boolean" || p.kind === "enumeration" ? "change" : "input", () => { note(field.get()); changed(); });
  if (slider) slider.node.oninput = () => { const text = slider.get(); field.put(text); note(text); changed(); runSoon(); };
  // Values of an address or of before a reload carry their unit.
  const take = text => {
    const bare = p.shown_unit && text.endsWith(" " + p.shown_unit) ? text.slice(0, -p.shown_unit.length - 1) : text;
    field.put(bare);
    note(bare);
  };
  take(p.shown);
  circuit.rows.set(p.name, { take, reset: () => take(p.shown) });
  return line;
}

function valueField(p) {
  const label = { id: "value-" + p.name, "aria-label": p.name };
  const any = () => true;
  if (p.kind === "boolean") {
    const node = el("input", { type: "checkbox", ...label });
    return { node, get: () => String(node.checked), put: text => { node.checked = text === "true"; }, valid: any };
  }
  if (p.kind === "enumeration") {
    const node = el("select", label, ...p.literals.map(l => el("option", { value: l }, l)));
    return { node, get: () => node.value, put: text => { node.value = text; }, valid: any };
  }
  const node = el("input", { autocomplete: "off", ...label });
  if (p.kind === "text") return { node, get: () => node.value, put: text => { node.value = text; }, valid: any };
  node.inputMode = "decimal";
  const valid = text => {
    const right = text === p.shown || (text.trim() !== "" && Number.isFinite(Number(text)));
    node.setAttribute("aria-invalid", !right);
    return right;
  };
  return { node, get: () => node.value.trim(), put: text => { node.value = text; }, valid };
}

// A slider over a parameter's range, or null where it has no number. Its positions are 0 to 1000.
function sliderOf(p) {
  const value = Number(p.shown);
  if ((p.kind !== "real" && p.kind !== "integer") || p.shown === "" || !Number.isFinite(value)) return null;
  let [lo, hi] = sliderRange(value, p.min === "" ? null : Number(p.min), p.max === "" ? null : Number(p.max));
  if (!(hi > lo)) return null;
  const logarithmic = lo > 0 && hi > 100 * lo;
  const step = p.kind === "integer" ? 1 : niceStep((hi - lo) / 1000);
  const node = el("input", { type: "range", min: 0, max: 1000, step: 1, "aria-label": p.name });
  const positionOf = v => 1000 * (logarithmic ? Math.log(v / lo) / Math.log(hi / lo) : (v - lo) / (hi - lo));
  const valueAt = x => logarithmic ? lo * Math.pow(hi / lo, x) : lo + x * (hi - lo);
  const get = () => {
    const v = valueAt(node.value / 1000);
    const round = p.kind === "integer" || !logarithmic ? Math.round(v / step) * step : Number(v.toPrecision(3));
    return String(Number(Math.min(hi, Math.max(lo, round)).toPrecision(12)));
  };
  const put = text => {
    const v = Math.min(hi, Math.max(lo, Number(text)));
    // Not while the slider itself gave the value: rounding would pull it back from an arrow key.
    if (Number.isFinite(v) && get() !== text) node.value = positionOf(v);
    node.setAttribute("aria-valuetext", withUnit(text, p.shown_unit));
  };
  return { node, get, put };
}

function sliderRange(value, min, max) {
  // Bounds like 0 to 1e10 around 0.02 only say what is possible: a linear slider over them moves nothing.
  const useful = min > 0 || value === 0 || max - min <= 1000 * Math.abs(value);
  if (min !== null && max !== null && useful) return [min, max];
  const [lo, hi] = value === 0 ? [-1, 1] : [Math.min(0, 2 * value), Math.max(0, 2 * value)];
  return [min === null ? lo : Math.max(lo, min), max === null ? hi : Math.min(hi, max)];
}

function niceStep(raw) {
  const base = Math.pow(10, Math.floor(Math.log10(raw)));
  return [1, 2, 5, 10].find(f => f * base >= raw * (1 - 1e-9)) * base;
}

function changed() { countChanged(); keepAddress(); }
function countChanged() {
  const n = circuit.set.size;
  $("changed").textContent = n ? `${n} changed` : "";
  $("reset-all").hidden = n === 0;
}
$("reset-all").onclick = () => { for (const name of [...circuit.set.keys()]) circuit.rows.get(name).reset(); changed(); };

function filterParameters() {
  const wanted = $("parameter-filter").value.toLowerCase().trim();
  for (const group of $("parameters").children) {
    const lines = [...group.querySelectorAll("tr")];
    for (const line of lines) line.hidden = !line.dataset.find.includes(wanted);
    group.hidden = lines.every(line => line.hidden);
    group.open = wanted !== "" || group.dataset.open === "true" || lines.some(line => line.classList.contains("changed"));
  }
}
$("parameter-filter").oninput = filterParameters;
$("circuit-filter").oninput = listCircuits;
$("folder-again").onclick = readFolder;
$("circuit-again").onclick = () => openCircuit(circuit.source, circuit.class, new Map(circuit.set));

// ---- Run

const withSeconds = text => /^[\d.]+(e[+-]?\d+)?$/i.test(text) ? text + " s" : text;
function run() {
  const wrong = $("parameters").querySelector("[aria-invalid=true]");
  if (wrong) {
    wrong.closest("details").open = true;
    wrong.focus();
    runView.failed(`\`${wrong.getAttribute("aria-label")}\` is no number`);
    return;
  }
  const { source, class: name } = circuit.data;
  const variables = $("draw").value.split(",").map(v => v.trim()).filter(Boolean);
  runView.start("/api/run", { source, class: name, set: Object.fromEntries(circuit.set), stop: withSeconds($("stop").value.trim()), variables, units: $("units").value });
}
$("run").onsubmit = e => { e.preventDefault(); run(); };
let rest = 0;
function runSoon() {
  clearTimeout(rest);
  if ($("live").checked) rest = setTimeout(run, 200);
}
for (const id of ["stop", "draw", "units"]) $(id).addEventListener("change", keepAddress);

// A datalist completes a whole field: so its entries repeat what stands before the last comma.
function listVariables() {
  const text = $("draw").value, cut = text.lastIndexOf(",") + 1, before = text.slice(0, cut) + (cut ? " " : "");
  const wanted = text.slice(cut).trim().toLowerCase();
  const found = (circuit.data?.variables || []).filter(v => v.name.toLowerCase().includes(wanted)).slice(0, 200);
  $("draw-list").replaceChildren(...found.map(v => variableOption(v, before)));
}
const variableOption = (v, before = "") => el("option", { value: before + v.name }, [v.description, v.shown_unit && v.shown_unit !== "1" ? `[${v.shown_unit}]` : ""].filter(Boolean).join(" "));
$("draw").oninput = $("draw").onfocus = listVariables;

// ---- Study: its state, its TOML text

// inputs: name -> {column, unit, hold, kind}; parameters: name -> "exact" or {sigma, min, max}; recordings carry
// `name`, as the server knows them, and `info`, their columns; `uploaded` are names in the server's memory.
const newStudy = () => ({ file: "study.toml", inputs: new Map(), signals: [], recordings: [], parameters: new Map(), uploaded: [] });
let study = newStudy();

const dirOf = path => path.slice(0, Math.max(0, path.lastIndexOf("/")));
function joinPath(dir, path) {
  const parts = [];
  for (const part of `${dir}/${path}`.split("/")) {
    if (part === ".." && parts.length && parts.at(-1) !== "..") parts.pop();
    else if (part && part !== ".") parts.push(part);
  }
  return parts.join("/");
}
function relativePath(dir, path) {
  const from = dir ? dir.split("/") : [], to = path.split("/");
  while (from.length && to.length > 1 && from[0] === to[0]) { from.shift(); to.shift(); }
  return [...from.map(() => ".."), ...to].join("/");
}
const studyFolder = () => dirOf(study.file);
// An upload lies nowhere yet: saving writes it beside the study.
const recordingPath = r => study.uploaded.includes(r.name) ? r.name : relativePath(studyFolder(), r.name);
const recordingName = file => study.uploaded.includes(file) ? file : joinPath(studyFolder(), file);

const quoted = text => JSON.stringify(text);
const tomlKey = name => /^[\w-]+$/.test(name) ? name : quoted(name);
const amount = text => /^[+-]?\d+(\.\d+)?(e[+-]?\d+)?$/i.test(text) ? text : quoted(text);
const table = entries => `{ ${entries.filter(([, v]) => v !== "").map(([k, v]) => `${k} = ${v}`).join(", ")} }`;
const quotedOrNone = value => value && quoted(value);

const WRITERS = {
  top: () => ["version = 1", ...(circuit.data.source ? [`model = ${quoted(relativePath(studyFolder(), circuit.data.source))}`] : []), `class = ${quoted(circuit.data.class)}`],
  inputs: () => section("inputs", [...study.inputs].filter(([, i]) => i.column).map(([name, i]) =>
    `${tomlKey(name)} = ${table([["column", quoted(i.column)], ["unit", quotedOrNone(i.unit)], ["hold", String(i.hold)], ["kind", i.kind === "measured" ? quoted(i.kind) : ""]])}`)),
  signals: () => section("signals", study.signals.filter(s => s.name && s.variable && s.column).map(s =>
    `${tomlKey(s.name)} = ${table([["variable", quoted(s.variable)], ["column", quoted(s.column)], ["unit", quotedOrNone(s.unit)], ["sign", s.sign === -1 ? "-1" : ""],
      ["full_scale", s.full_scale && amount(s.full_scale)], ["accuracy", s.accuracy && amount(s.accuracy)]])}`)),
  recordings: () => study.recordings.flatMap((r, i) => [...(i ? [""] : []), "[[recordings]]", `file = ${quoted(recordingPath(r))}`, `role = ${quoted(r.role)}`,
    ...(r.time ? [`time = ${quoted(r.time)}`] : []), ...(r.window ? [`window = [${r.window.map(decimal).join(", ")}]`] : []), ...(r.optional ? ["optional = true"] : [])]),
  parameters: () => section("parameters", [...study.parameters].map(([name, p]) =>
    `${quoted(name)} = ${p === "exact" ? quoted(p) : table([["sigma", quotedOrNone(p.sigma)], ["min", p.min && amount(p.min)], ["max", p.max && amount(p.max)]])}`)),
};
const ORDER = [...Object.keys(WRITERS), "effects"];
const section = (name, lines) => lines.length ? [`[${name}]`, ...lines] : [];
const decimal = number => Number.isInteger(number) ? number.toFixed(1) : String(number);

// The text as its sections in turn; comment lines directly above a head belong to that section.
function sectionsOf(toml) {
  const parts = [{ name: "top", lead: [], lines: [] }];
  for (const line of toml.split("\n")) {
    const name = /^\s*\[\[?\s*(inputs|signals|recordings|parameters|effects)\b/.exec(line)?.[1], last = parts.at(-1);
    if (name && name !== last.name) {
      let cut = last.lines.length;
      while (cut > 0 && /^\s*(#.*)?$/.test(last.lines[cut - 1])) cut--;
      parts.push({ name, lead: last.lines.splice(cut).filter(l => l.trim()), lines: [] });
    }
    parts.at(-1).lines.push(line);
  }
  const first = parts[0];
  while (first.lines.length && first.lines[0].trim().startsWith("#")) first.lead.push(first.lines.shift());
  return parts;
}

// Only the sections that the form changed are written anew: comments and keys elsewhere are the user's.
function rewrite(...names) {
  let parts = sectionsOf($("text").value);
  for (const name of names) {
    const lines = WRITERS[name](), there = parts.find(p => p.name === name);
    parts = parts.filter(p => p.name !== name || p === there);
    if (there) there.lines = lines;
    else parts.splice(parts.filter(p => ORDER.indexOf(p.name) < ORDER.indexOf(name)).length, 0, { name, lead: [], lines });
  }
  const texts = parts.filter(p => p.lines.some(l => l.trim())).map(p => [...p.lead, ...p.lines].join("\n").trim());
  $("text").value = texts.join("\n\n") + "\n";
  keepStudy();
  // Where the text was wrong, this change may be the cure.
  if ($("text-messages").textContent) guarded($("text-messages"), readText);
}

const readText = () => post("/api/study/read", { text: $("text").value, folder: studyFolder() });

// A study per circuit survives a reload of the page, and a look at another circuit.
const keptAs = (source, name) => `study:${source}:${name}`;
function keepStudy({ source, class: name } = circuit.data) {
  sessionStorage.setItem(keptAs(source, name), JSON.stringify({ text: $("text").value, file: study.file, uploaded: study.uploaded }));
}

// The study goes with the open circuit: a kept one, or a new one with the recordings at hand.
async function studyCircuit(other) {
  const c = circuit.data;
  $("study-model").replaceChildren("Model of the study: ", el("strong", {}, c ? c.class : "none"), c ? ` (${c.source || "shipped with bramah"}), the circuit open in the other tab` : ". Open a circuit in the other tab first.");
  for (const id of ["compare", "diagnose", "add-signal"]) $(id).disabled = !c;
  if (!c) return;
  if (!other) { addInputs(); showStudy(); return; }
  const kept = JSON.parse(sessionStorage.getItem(keptAs(c.source, c.class)));
  study = { ...newStudy(), recordings: study.recordings, uploaded: kept ? [...new Set([...study.uploaded, ...kept.uploaded])] : study.uploaded };
  if (kept) {
    study.file = kept.file;
    $("text").value = kept.text;
    await adoptText();
  } else {
    addInputs();
    $("text").value = "";
    guessColumns();
    rewrite("top", "inputs", "signals", "recordings");
    showStudy();
  }
}

// Inputs of the circuit that the study does not speak of are shown too, without a column.
function addInputs() {
  for (const { name } of circuit.data.inputs) if (!study.inputs.has(name)) study.inputs.set(name, { column: "", unit: "", hold: true, kind: "command" });
}

// Reads the text back into the form. Another model in it opens that circuit.
const adoptText = () => guarded($("text-messages"), async () => {
  let sent, read;
  // A click into the form may have changed the text meanwhile.
  do { sent = $("text").value; read = await readText(); } while (sent !== $("text").value);
  const source = read.model ? joinPath(studyFolder(), read.model) : "";
  const name = read.class || folder.circuits.find(c => c.source === source)?.class || "";
  keepStudy({ source, class: name });
  if (source !== circuit.data?.source || name !== circuit.data?.class) {
    await openCircuit(source, name, new Map());
    if (!circuit.data) throw new Refusal(0, { messages: $("circuit-messages").textContent });
    return;
  }
  const before = study.recordings;
  study.inputs = new Map(read.inputs.map(({ name: input, ...rest }) => [input, rest]));
  addInputs();
  study.signals = read.signals;
  study.parameters = new Map(read.parameters.map(p => [p.name, p.entry === "exact" ? "exact" : { sigma: p.sigma || "", min: p.min || "", max: p.max || "" }]));
  study.recordings = read.recordings.map(r => {
    const recording = { ...r, name: recordingName(r.file) };
    return { ...recording, info: before.find(b => b.name === recording.name)?.info || null };
  });
  showStudy();
  await Promise.all(study.recordings.filter(r => !r.info).map(readRecording));
  showStudy();
});

async function readRecording(r) {
  try { r.info = await ask("/api/recording?" + query({ name: r.name })); } catch (e) { r.trouble = e.message; }
}

function showStudy() {
  $("study-file").value = study.file;
  showRecordings();
  showInputs();
  showSignals();
  showTolerances();
}

// ---- Step 1: recordings

$("files").onchange = async () => { await upload([...$("files").files]); $("files").value = ""; };
$("drop").ondragover = e => { e.preventDefault(); $("drop").classList.add("over"); };
// A file dropped beside the field must not replace the page.
window.ondragover = window.ondrop = e => e.preventDefault();
$("drop").ondragleave = () => $("drop").classList.remove("over");
$("drop").ondrop = e => { e.preventDefault(); $("drop").classList.remove("over"); upload([...e.dataTransfer.files]); };
$("add-recording").onclick = () => addRecordings([$("folder-recordings").value], name => ask("/api/recording?" + query({ name })));

function upload(files) {
  return addRecordings(files, async file => {
    const info = await ask("/api/recordings?" + query({ name: file.name }), { method: "POST", headers: { "Content-Type": "text/csv" }, body: file });
    if (!study.uploaded.includes(info.name)) study.uploaded.push(info.name);
    return info;
  });
}

// One bad file does not keep the others away.
async function addRecordings(all, read) {
  const troubles = [], known = new Set(columnsOf().keys());
  for (const one of all) {
    say($("recording-messages"), `reading ${one.name || one} …`);
    try {
      const info = await read(one), there = study.recordings.find(r => r.name === info.name);
      if (there) Object.assign(there, { info, trouble: "" });
      else study.recordings.push({ name: info.name, role: /held|valid/i.test(info.name) ? "held" : "train", time: info.time, window: null, optional: false, info });
    } catch (e) {
      troubles.push(wordsOf(e));
    }
  }
  say($("recording-messages"), troubles.join("\n"), true);
  if (circuit.data) { guessColumns(known); rewrite("inputs", "signals", "recordings"); }
  showStudy();
}

function showRecordings() {
  const edit = (r, key, value) => { r[key] = value; if (circuit.data) rewrite("recordings"); };
  const lines = study.recordings.map(r => {
    const label = what => `${what} of ${r.name}`;
    const times = [...new Set([r.time, ...(r.info ? [r.info.time, ...r.info.columns.map(c => c.name)] : [])])];
    const role = select([["train", "train"], ["held", "held"]], r.role, () => edit(r, "role", role.value), label("role"));
    const time = select(times.map(t => [t, t || "usual name"]), r.time, () => edit(r, "time", time.value), label("time column"));
    const remove = () => { study.recordings = study.recordings.filter(o => o !== r); if (circuit.data) rewrite("recordings"); showStudy(); };
    const facts = r.info ? `${r.info.rows} rows, ${short(r.info.start)} to ${short(r.info.end)} s` : r.trouble ? el("pre", { className: "messages wrong" }, r.trouble) : "reading …";
    return row(r.name + (study.uploaded.includes(r.name) ? " (not saved yet)" : ""), role, time, windowFields(r, label, w => edit(r, "window", w)), facts, button("remove", remove, `remove ${r.name}`));
  });
  $("recordings").replaceChildren(...(lines.length ? [head("file", "role", "time column", "window in s, if not all", "holds", ""), el("tbody", {}, ...lines)] : []));
}
const short = number => String(Number(number.toPrecision(6)));

// Both ends or none; an end left empty is that of the recording.
function windowFields(r, label, put) {
  const ends = [0, 1].map(i => el("input", { size: 6, inputMode: "decimal", value: r.window ? r.window[i] : "", "aria-label": label(i ? "end of the window" : "begin of the window"), placeholder: r.info ? short(i ? r.info.end : r.info.start) : "" }));
  for (const end of ends) end.onchange = () => {
    const numbers = ends.map((e, i) => e.value.trim() === "" ? (i ? r.info?.end : r.info?.start) : Number(e.value));
    const right = numbers.every(Number.isFinite) && numbers[0] < numbers[1];
    const none = ends.every(e => e.value.trim() === "");
    for (const e of ends) e.setAttribute("aria-invalid", !right && !none);
    if (right || none) put(none ? null : numbers);
  };
  return el("span", {}, ends[0], " to ", ends[1]);
}

// ---- Step 2: columns

const columnsOf = () => {
  const found = new Map();
  for (const r of study.recordings) for (const c of r.info?.columns || []) if (c.name !== (r.time || r.info.time) && !found.has(c.name)) found.set(c.name, c.unit);
  return found;
};
const plain = name => name.toLowerCase().replace(/[^a-z0-9]/g, "");

// What has no column yet gets one of equal name; an input also the only column of its unit. Columns known before are
// left alone: the user has decided about them.
function guessColumns(known = new Set()) {
  const columns = new Map([...columnsOf()].filter(([name]) => !known.has(name)));
  for (const [name, input] of study.inputs) {
    if (input.column) continue;
    const column = columns.has(name) ? name : [...columns.keys()].find(c => plain(c) === plain(name));
    if (column) Object.assign(input, { column, unit: columns.get(column) });
  }
  const used = usedColumns();
  const unit = name => circuit.data.inputs.find(i => i.name === name)?.unit;
  const open = [...study.inputs].filter(([, i]) => !i.column);
  for (const [name, input] of open) {
    const fitting = [...columns].filter(([c, u]) => u && u === unit(name) && !used.has(c));
    if (fitting.length === 1 && open.filter(([other]) => unit(other) === unit(name)).length === 1) Object.assign(input, { column: fitting[0][0], unit: fitting[0][1] });
  }
  for (const [column, u] of columns) {
    if (usedColumns().has(column)) continue;
    const names = circuit.data.variables.map(v => v.name);
    const variable = names.find(n => n === column) || names.find(n => plain(n) === plain(column));
    if (variable) study.signals.push(newSignal(column, u, variable));
  }
}
const usedColumns = () => new Set([...study.inputs.values(), ...study.signals].map(o => o.column));
const newSignal = (column, unit, variable = "") => ({ name: column, variable, column, unit, sign: 1, full_scale: "", accuracy: "" });

// A choice among the columns; one that no recording has stays, and is marked.
function columnSelect(owner, label, changed) {
  const columns = columnsOf();
  const options = [["", "–"], ...[...columns].map(([name, unit]) => [name, withUnitInBrackets(name, unit)])];
  if (owner.column && !columns.has(owner.column)) options.push([owner.column, `${owner.column} (in no recording)`]);
  const node = select(options, owner.column, () => {
    owner.column = node.value;
    owner.unit = columns.get(node.value) || owner.unit;
    changed();
  }, label);
  return node;
}
const withUnitInBrackets = (name, unit) => unit ? `${name} [${unit}]` : name;

// A text field of a study's table that writes `owner[key]`.
function textField(owner, key, label, size, changed, more = {}) {
  const node = el("input", { value: owner[key], size, autocomplete: "off", "aria-label": label, ...more });
  node.onchange = () => { owner[key] = node.value.trim(); changed(); };
  return node;
}

function showInputs() {
  if (!circuit.data) { $("inputs").replaceChildren(); return; }
  const changed = () => { rewrite("inputs"); showInputs(); showUnused(); };
  const lines = [...study.inputs].map(([name, i]) => {
    const model = circuit.data.inputs.find(m => m.name === name);
    const hold = select([["true", "holds until the next sample"], ["false", "straight lines"]], String(i.hold), () => { i.hold = hold.value === "true"; changed(); }, `between samples of ${name}`);
    const kind = select([["command", "command"], ["measured", "measured"]], i.kind, () => { i.kind = kind.value; changed(); }, `kind of ${name}`);
    return row(el("code", {}, name), model ? model.unit : "no input of the circuit", columnSelect(i, `column of ${name}`, changed),
      textField(i, "unit", `unit of ${name}`, 8, changed), hold, kind);
  });
  $("inputs").replaceChildren(...(lines.length ? [head("input", "its unit", "column", "unit of the column", "between samples", "kind"), el("tbody", {}, ...lines)] : [el("caption", {}, "The circuit has no inputs.")]));
}

function showSignals() {
  if (!circuit.data) { $("signals").replaceChildren(); showUnused(); return; }
  const lists = new Map();   // unit -> datalist of the variables that have it
  const listFor = unit => {
    if (!lists.has(unit)) {
      const fitting = circuit.data.variables.filter(v => v.unit === unit || v.shown_unit === unit);
      lists.set(unit, el("datalist", { id: `variables-${lists.size}` }, ...(fitting.length ? fitting : circuit.data.variables).map(v => variableOption(v))));
    }
    return lists.get(unit).id;
  };
  const write = () => rewrite("signals"), changed = () => { write(); showSignals(); };
  const lines = study.signals.map(s => {
    const known = !s.variable || circuit.data.variables.some(v => v.name === s.variable);
    const sign = select([["1", "+1"], ["-1", "−1"]], String(s.sign), () => { s.sign = Number(sign.value); write(); }, `sign of ${s.name}`);
    const column = columnSelect(s, `column of ${s.name}`, () => { s.name = s.name || s.column; changed(); });
    return row(textField(s, "name", "name of the signal", 10, changed),
      textField(s, "variable", `variable of ${s.name}`, 20, changed, { "aria-invalid": String(!known), placeholder: "variable of the model" }),
      column, textField(s, "unit", `unit of ${s.name}`, 8, changed), sign,
      textField(s, "full_scale", `full scale of ${s.name}`, 9, write, { placeholder: "range" }), textField(s, "accuracy", `accuracy of ${s.name}`, 7, write, { placeholder: "from data" }),
      button("remove", () => { study.signals = study.signals.filter(o => o !== s); changed(); }, `remove ${s.name}`));
  });
  $("signals").replaceChildren(...(lines.length ? [head("signal", "variable", "column", "unit", "sign", "full scale", "accuracy", ""), el("tbody", {}, ...lines)] : []));
  lines.forEach((line, k) => line.cells[1].firstChild.setAttribute("list", listFor(study.signals[k].unit)));
  $("signals").append(...lists.values());
  showUnused();
}

function showUnused() {
  const used = usedColumns(), unused = circuit.data ? [...columnsOf()].filter(([name]) => !used.has(name)) : [];
  const add = ([name, unit]) => button(withUnitInBrackets(name, unit), () => addSignal(newSignal(name, unit)), `add a signal for column ${name}`);
  $("unused").replaceChildren(...(unused.length ? ["for a column not used yet: ", ...unused.flatMap(c => [add(c), " "])] : []));
}
function addSignal(signal) {
  study.signals.push(signal);
  showSignals();
  $("signals").querySelector("tbody tr:last-child td:nth-child(2) input").focus();
}
$("add-signal").onclick = () => addSignal(newSignal("", ""));

// ---- Step 3: tolerances

const physical = p => p.kind === "real" && Number(p.value) !== 0 && p.unit && p.unit !== "1";

function showTolerances() {
  const all = circuit.data ? circuit.data.parameters.filter(p => p.kind === "real") : [], known = new Set(all.map(p => p.name));
  const strange = [...study.parameters.keys()].filter(n => !known.has(n)).map(name => ({ name, shown: "", shown_unit: "", description: "not a number of the open circuit" }));
  const body = el("tbody", {}, ...[...strange, ...(circuit.data ? all : [])].map(toleranceRow));
  $("tolerances").replaceChildren(...(body.children.length ? [head("parameter", "value", "tolerance", "one σ", "least", "greatest"), body] : []));
  filterTolerances();
  noteTolerances();
}

function toleranceRow(p) {
  const entry = () => study.parameters.get(p.name);
  const own = typeof entry() === "object" ? { ...entry() } : { sigma: "", min: "", max: "" };
  const write = () => { study.parameters.set(p.name, own); rewrite("parameters"); };
  const fields = [["sigma", "σ", "3 %"], ["min", "least value", ""], ["max", "greatest value", ""]].map(([k, what, placeholder]) => textField(own, k, `${what} of ${p.name}`, 8, write, { placeholder }));
  const choice = select([["", ""], ["own", "own"], ["exact", "exact"]], entry() === undefined ? "" : entry() === "exact" ? "exact" : "own", () => {
    if (choice.value === "") study.parameters.delete(p.name);
    else if (choice.value === "exact") study.parameters.set(p.name, "exact");
    else { own.sigma = fields[0].value = own.sigma || "5 %"; study.parameters.set(p.name, own); }
    enable();
    rewrite("parameters");
    noteTolerances();
  }, `tolerance of ${p.name}`);
  const enable = () => { for (const f of fields) f.disabled = choice.value !== "own"; };
  enable();
  const line = row(el("td", {}, el("code", {}, p.name), " ", el("span", { className: "soft" }, p.description)), el("td", { className: "number" }, withUnit(p.shown, p.shown_unit)), choice, ...fields);
  Object.assign(line.dataset, { find: `${p.name} ${p.description}`.toLowerCase(), name: p.name });
  choice.dataset.physical = physical(p);
  return line;
}

// What a parameter without an entry may do depends on whether the study has any entry at all (docs/study.md).
function noteTolerances() {
  const none = study.parameters.size === 0;
  for (const choice of $("tolerances").querySelectorAll("select")) choice.options[0].textContent = none && choice.dataset.physical === "true" ? "±5 % (assumed)" : "stays at its value";
  $("tolerance-none").disabled = none;
  $("tolerance-note").textContent = none
    ? "Nothing is stated yet: every parameter that has a unit is taken as known to ±5 %."
    : `${study.parameters.size} stated. As soon as one is stated, the parameters without a tolerance stay at their value.`;
}

function filterTolerances() {
  const wanted = $("tolerance-filter").value.toLowerCase().trim();
  for (const line of $("tolerances").querySelectorAll("tbody tr")) line.hidden = !line.dataset.find.includes(wanted);
}
$("tolerance-filter").oninput = filterTolerances;
$("tolerance-all").onclick = () => {
  for (const line of $("tolerances").querySelectorAll("tbody tr:not([hidden])")) {
    const free = line.querySelector("select").dataset.physical === "true" && !study.parameters.has(line.dataset.name);
    if (free) study.parameters.set(line.dataset.name, { sigma: "5 %", min: "", max: "" });
  }
  rewrite("parameters");
  showTolerances();
};
$("tolerance-none").onclick = () => { study.parameters.clear(); rewrite("parameters"); showTolerances(); };

// ---- Step 4: text

$("text").onchange = adoptText;
$("open-study").onclick = () => guarded($("recording-messages"), async () => {
  const file = $("folder-studies").value, found = await ask("/api/study?" + query({ file }));
  study.file = file;
  $("text").value = found.text;
  $("replace").hidden = true;
  say($("save-messages"), "");
  await adoptText();
});

// Paths in the text are relative to the study: another folder for it changes them.
$("study-file").onchange = () => {
  const before = studyFolder();
  study.file = joinPath("", $("study-file").value.trim() || "study.toml");
  $("study-file").value = study.file;
  $("replace").hidden = true;
  if (circuit.data && studyFolder() !== before) rewrite("top", "recordings");
  else if (circuit.data) keepStudy();
};

async function save(replace) {
  $("replace").hidden = true;
  say($("save-messages"), "");
  try {
    const { written } = await post("/api/study/save", { file: study.file, text: $("text").value, replace });
    say($("save-messages"), "written: " + written.join(", "));
    const saved = new Set(written);
    for (const r of study.recordings) {
      const path = joinPath(studyFolder(), r.name);
      if (!study.uploaded.includes(r.name) || !saved.has(path)) continue;
      study.uploaded = study.uploaded.filter(n => n !== r.name);
      r.name = path;
    }
    if (circuit.data) keepStudy();
    showRecordings();
    await readFolder();
  } catch (e) {
    say($("save-messages"), wordsOf(e), true);
    $("replace").hidden = e.status !== 409;
    if (e.status === 409) $("replace").focus();
  }
}
$("save").onsubmit = e => { e.preventDefault(); save(false); };
$("replace").onclick = () => save(true);

// ---- Step 5: compare and diagnose

for (const what of ["compare", "diagnose"]) $(what).onclick = () => studyView.start(`/api/study/${what}`, { text: $("text").value, folder: studyFolder() });

window.addEventListener("hashchange", readAddress);
studyCircuit();
readFolder().then(readAddress);
