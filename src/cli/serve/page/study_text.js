// The study: its state, and its TOML text. The text is what the server gets; the form changes sections of it.

import { byId, guarded, post } from "./tools.js";
import { circuit, folder as served } from "./circuit.js";

// inputs: name -> {column, unit, hold, kind}; parameters: name -> "exact" or {sigma, min, max}; recordings carry
// `name`, as the server knows them, and `info`, their columns; `uploaded` are names in the server's memory.
export const study = newStudy();

function newStudy() {
  return { file: "study.toml", inputs: new Map(), signals: [], recordings: [], parameters: new Map(), uploaded: [] };
}

export function renew(kept) {
  Object.assign(study, newStudy(), kept);
}

// ---- Paths: the server's begin in its folder, those in the text in the folder of the study

const folderOf = path => path.slice(0, Math.max(0, path.lastIndexOf("/")));
export const studyFolder = () => folderOf(study.file);

export function joinPath(folder, path) {
  const parts = [];
  for (const part of `${folder}/${path}`.split("/")) {
    if (part === ".." && parts.length && parts.at(-1) !== "..") parts.pop();
    else if (part && part !== ".") parts.push(part);
  }
  return parts.join("/");
}

function relativePath(folder, path) {
  const from = folder ? folder.split("/") : [], to = path.split("/");
  while (from.length && to.length > 1 && from[0] === to[0]) {
    from.shift();
    to.shift();
  }
  return [...from.map(() => ".."), ...to].join("/");
}

// An upload lies nowhere yet: saving writes it beside the study.
export const isUploaded = name => study.uploaded.includes(name);
export const recordingName = file => isUploaded(file) ? file : joinPath(studyFolder(), file);
const recordingPath = name => isUploaded(name) ? name : relativePath(studyFolder(), name);

// ---- Sections as TOML

const quoted = text => JSON.stringify(text);
const quotedIfAny = text => text && quoted(text);
const key = name => /^[\w-]+$/.test(name) ? name : quoted(name);
// A bare number is one; all else is a text with a unit.
const amount = text => !text || /^[+-]?\d+(\.\d+)?(e[+-]?\d+)?$/i.test(text) ? text : quoted(text);
// TOML keeps integers and decimal numbers apart.
const decimal = number => Number.isInteger(number) ? number.toFixed(1) : String(number);
const section = (name, lines) => lines.length ? [`[${name}]`, ...lines] : [];

// Values that are empty are left out.
function table(values) {
  const entries = Object.entries(values).filter(([, value]) => value !== "");
  return `{ ${entries.map(([name, value]) => `${name} = ${value}`).join(", ")} }`;
}

function topLines() {
  const { source, class: name } = circuit.data;
  const model = source ? [`model = ${quoted(relativePath(studyFolder(), source))}`] : [];
  return ["version = 1", ...model, `class = ${quoted(name)}`];
}

function inputLine([name, { column, unit, hold, kind }]) {
  const kindOrUsual = kind === "measured" ? quoted(kind) : "";
  return `${key(name)} = ${table({ column: quoted(column), unit: quotedIfAny(unit), hold, kind: kindOrUsual })}`;
}

function signalLine({ name, variable, column, unit, sign, full_scale: scale, accuracy }) {
  return `${key(name)} = ${table({
    variable: quoted(variable),
    column: quoted(column),
    unit: quotedIfAny(unit),
    sign: sign === -1 ? "-1" : "",
    full_scale: amount(scale),
    accuracy: amount(accuracy),
  })}`;
}

function recordingLines(recording, index) {
  const lines = ["[[recordings]]", `file = ${quoted(recordingPath(recording.name))}`, `role = ${quoted(recording.role)}`];
  if (index > 0) lines.unshift("");
  if (recording.time) lines.push(`time = ${quoted(recording.time)}`);
  if (recording.window) lines.push(`window = [${recording.window.map(decimal).join(", ")}]`);
  if (recording.optional) lines.push("optional = true");
  if (recording.pieces > 1) lines.push(`pieces = ${recording.pieces}`);
  return lines;
}

function parameterLine([name, entry]) {
  if (entry === "exact") return `${quoted(name)} = "exact"`;
  return `${quoted(name)} = ${table({ sigma: quotedIfAny(entry.sigma), min: amount(entry.min), max: amount(entry.max) })}`;
}

// What is half filled in stays in the form until the rest is there.
const complete = signal => signal.name && signal.variable && signal.column;
const WRITERS = {
  top: topLines,
  inputs: () => section("inputs", [...study.inputs].filter(([, input]) => input.column).map(inputLine)),
  signals: () => section("signals", study.signals.filter(complete).map(signalLine)),
  recordings: () => study.recordings.flatMap(recordingLines),
  parameters: () => section("parameters", [...study.parameters].map(parameterLine)),
};

// ---- The text

const ORDER = [...Object.keys(WRITERS), "effects"];
const HEAD = new RegExp(`^\\s*\\[\\[?\\s*(${ORDER.slice(1).join("|")})\\b`);

// The text as its sections in turn; comment lines directly above a head belong to that section.
function sectionsOf(text) {
  const parts = [{ name: "top", lead: [], lines: [] }];
  for (const line of text.split("\n")) {
    const name = HEAD.exec(line)?.[1], last = parts.at(-1);
    if (name && name !== last.name) parts.push({ name, lead: cutComments(last.lines), lines: [] });
    parts.at(-1).lines.push(line);
  }
  const top = parts[0];
  while (top.lines[0]?.trim().startsWith("#")) top.lead.push(top.lines.shift());
  return parts;
}

// Takes the comments at the end of some lines away from them.
function cutComments(lines) {
  let cut = lines.length;
  while (cut > 0 && /^\s*(#.*)?$/.test(lines[cut - 1])) cut--;
  return lines.splice(cut).filter(line => line.trim());
}

// The sections with new lines for one: where its first piece stands, else in the usual order.
function withSection(parts, name, lines) {
  const first = parts.find(part => part.name === name);
  const others = parts.filter(part => part.name !== name);
  const before = first ? parts.indexOf(first) : others.filter(part => ORDER.indexOf(part.name) < ORDER.indexOf(name)).length;
  return [...others.slice(0, before), { name, lead: first ? first.lead : [], lines }, ...others.slice(before)];
}

// Only the sections that the form changed are written anew: comments and keys elsewhere are the user's.
export function rewrite(...names) {
  if (!circuit.data) return;
  const parts = names.reduce((all, name) => withSection(all, name, WRITERS[name]()), sectionsOf(byId("text").value));
  const filled = parts.filter(part => part.lines.some(line => line.trim()));
  byId("text").value = filled.map(part => [...part.lead, ...part.lines].join("\n").trim()).join("\n\n") + "\n";
  keepStudy();
  // Where the text was wrong, this change may be the cure.
  if (byId("text-messages").textContent) guarded(byId("text-messages"), readText);
}

export const readText = () => post("/api/study/read", { text: byId("text").value, folder: studyFolder() });

// ---- A study per circuit survives a reload of the page, and a look at another circuit

const keptAs = (source, name) => `study:${served.folder}:${source}:${name}`;

// With the form: a study just begun is half filled in, and its text cannot be read back.
export function keepStudy() {
  if (!circuit.data) return;
  const recordings = study.recordings.map(({ info, trouble, ...recording }) => recording);
  keep(circuit.data, { inputs: [...study.inputs], signals: study.signals, recordings, parameters: [...study.parameters] });
}

// For another circuit, which has its form still to be made.
export function keepText(source, name) {
  keep({ source, class: name }, null);
}

function keep({ source, class: name }, form) {
  const kept = { text: byId("text").value, file: study.file, uploaded: study.uploaded, form };
  sessionStorage.setItem(keptAs(source, name), JSON.stringify(kept));
}

// The study kept for the open circuit, or null.
export function keptStudy() {
  const kept = JSON.parse(sessionStorage.getItem(keptAs(circuit.data.source, circuit.data.class)));
  if (!kept?.form) return kept;
  const { inputs, parameters } = kept.form;
  return { ...kept, form: { ...kept.form, inputs: new Map(inputs), parameters: new Map(parameters) } };
}
