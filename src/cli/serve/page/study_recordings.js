// Step 1 of a study: its recordings, from files of the user or of the folder.

import { ask, button, byId, choice, element, fillTable, say, tableRow, wordsOf } from "./tools.js";
import { isUploaded, rewrite, study } from "./study_text.js";
import { columnUnits, guessColumns, showColumns } from "./study_columns.js";
import { circuit } from "./circuit.js";

// ---- New recordings

async function upload(files) {
  await addRecordings(files, async file => {
    const options = { method: "POST", headers: { "Content-Type": "text/csv" }, body: file };
    const info = await ask("/api/recordings", { name: file.name }, options);
    if (!isUploaded(info.name)) study.uploaded.push(info.name);
    return info;
  });
}

const columnsOf = name => ask("/api/recording", { name });

// One bad file does not keep the others away.
async function addRecordings(all, read) {
  const troubles = [], known = columnUnits();
  for (const one of all) {
    say(byId("recording-messages"), `reading ${one.name || one} …`);
    try {
      take(await read(one));
    } catch (error) {
      troubles.push(wordsOf(error));
    }
  }
  say(byId("recording-messages"), troubles.join("\n"), true);
  if (circuit.data) guessColumns(known);
  rewrite("inputs", "signals", "recordings");
  showRecordings();
  showColumns();
}

function take(info) {
  const { name, time } = info, there = study.recordings.find(recording => recording.name === name);
  const role = /held|valid/i.test(name) ? "held" : "train";
  if (there) Object.assign(there, { info, trouble: "" });
  else study.recordings.push({ name, role, time, window: null, optional: false, pieces: 1, info });
}

// What a text only names.
export async function readRecording(recording) {
  try {
    recording.info = await columnsOf(recording.name);
  } catch (error) {
    recording.trouble = wordsOf(error);
  }
}

const dropArea = byId("drop"), files = byId("files");
files.onchange = async () => {
  await upload([...files.files]);
  files.value = "";
};
dropArea.ondragover = () => dropArea.classList.add("over");
dropArea.ondragleave = () => dropArea.classList.remove("over");
dropArea.ondrop = event => {
  dropArea.classList.remove("over");
  upload([...event.dataTransfer.files]);
};
// A file dropped beside the area must not replace the page.
window.ondragover = window.ondrop = event => event.preventDefault();
byId("add-recording").onclick = () => addRecordings([byId("folder-recordings").value], columnsOf);

// ---- Their table

export function showRecordings() {
  const heads = ["file", "role", "time column", "window in s, if not all", "holds", ""];
  fillTable(byId("recordings"), heads, study.recordings.map(recordingRow));
}

const ROLES = [["train", "train"], ["held", "held"]];

function recordingRow(recording) {
  const { name, role, time } = recording, label = what => `${what} of ${name}`;
  const change = values => {
    Object.assign(recording, values);
    rewrite("recordings");
  };
  return tableRow(
    name + (isUploaded(name) ? " (not saved yet)" : ""),
    choice(ROLES, role, label("role"), chosen => change({ role: chosen })),
    choice(timeOptions(recording), time, label("time column"), chosen => change({ time: chosen })),
    windowFields(recording, label, span => change({ window: span })),
    contentOf(recording),
    button("remove", () => remove(recording), `remove ${name}`));
}

function timeOptions({ time, info }) {
  const columns = info ? [info.time, ...info.columns.map(column => column.name)] : [];
  return [...new Set([time, ...columns])].map(name => [name, name || "usual name"]);
}

const short = number => String(Number(number.toPrecision(6)));

function contentOf({ info, trouble }) {
  if (info) return `${info.rows} rows, ${short(info.start)} to ${short(info.end)} s`;
  return trouble ? element("pre", { className: "messages wrong" }, trouble) : "reading …";
}

function remove(recording) {
  study.recordings = study.recordings.filter(other => other !== recording);
  rewrite("recordings");
  showRecordings();
  showColumns();
}

// Both ends or none; an end left empty is that of the recording.
function windowFields({ window: span, info }, label, put) {
  const limits = info ? [info.start, info.end] : [undefined, undefined];
  const fields = ["begin", "end"].map((end, index) => element("input", {
    size: 6,
    inputMode: "decimal",
    value: span ? span[index] : "",
    placeholder: info ? short(limits[index]) : "",
    "aria-label": label(`${end} of the window`),
  }));
  const changed = () => {
    const none = fields.every(field => isEmpty(field));
    const ends = fields.map((field, index) => isEmpty(field) ? limits[index] : Number(field.value));
    const valid = none || (ends.every(Number.isFinite) && ends[0] < ends[1]);
    for (const field of fields) field.setAttribute("aria-invalid", !valid);
    if (valid) put(none ? null : ends);
  };
  for (const field of fields) field.onchange = changed;
  return element("span", {}, fields[0], " to ", fields[1]);
}

const isEmpty = field => field.value.trim() === "";
