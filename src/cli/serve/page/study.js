// The study of the open circuit: which one it is, its text and its file, comparison and diagnosis.

import { JobView, Refusal, ask, byId, element, guarded, post, say, wordsOf } from "./tools.js";
import { circuit, events, folder, openCircuit, readFolder } from "./circuit.js";
import {
  isUploaded, joinPath, keepStudy, keepText, keptStudy, readText, recordingName, renew, rewrite, study, studyFolder,
} from "./study_text.js";
import { guessColumns, showColumns } from "./study_columns.js";
import { readRecording, showRecordings } from "./study_recordings.js";
import { showTolerances } from "./study_tolerances.js";

const studyView = new JobView(byId("study-view"));

function showStudy() {
  byId("study-file").value = study.file;
  showRecordings();
  showColumns();
  showTolerances();
}

// ---- The study goes with the open circuit

events.addEventListener("leave", () => studyView.clear());
events.addEventListener("none", showModel);
events.addEventListener("reread", () => {
  addInputs();
  showStudy();
});
events.addEventListener("open", async () => {
  showModel();
  say(byId("text-messages"), "");
  const kept = keptStudy();
  if (kept) await takeKept(kept);
  else beginStudy();
});
events.addEventListener("folder", () => {
  fillChoice("folder-recordings", "add-recording", folder.recordings);
  fillChoice("folder-studies", "open-study", folder.studies);
});

function fillChoice(id, action, names) {
  const options = (names.length ? names : ["none"]).map(name => element("option", { value: name }, name));
  byId(id).replaceChildren(...options);
  byId(action).disabled = !names.length;
}

function showModel() {
  const { data } = circuit, name = element("strong", {}, data ? data.class : "none");
  const more = data
    ? ` (${data.source || "shipped with bramah"}), the circuit open in the other tab`
    : ". Open a circuit in the other tab first.";
  byId("study-model").replaceChildren("Model of the study: ", name, more);
  for (const id of ["compare", "diagnose", "add-signal"]) byId(id).disabled = !data;
}

async function takeKept({ file, text, uploaded, form }) {
  renew({ file, recordings: study.recordings, uploaded: [...new Set([...study.uploaded, ...uploaded])] });
  byId("text").value = text;
  if (form) await takeForm(form);
  else await adoptText();
}

// A new study begins with the recordings at hand.
function beginStudy() {
  renew({ recordings: study.recordings, uploaded: study.uploaded });
  addInputs();
  guessColumns();
  byId("text").value = "";
  rewrite("top", "inputs", "signals", "recordings");
  showStudy();
}

// Inputs of the circuit that the study does not name are shown too, without a column.
function addInputs() {
  for (const { name } of circuit.data.inputs) {
    if (!study.inputs.has(name)) study.inputs.set(name, { column: "", unit: "", hold: true, kind: "command" });
  }
}

// ---- From the text into the form

const adoptText = () => guarded(byId("text-messages"), async () => {
  const read = await readSteadyText();
  const source = read.model ? joinPath(studyFolder(), read.model) : "";
  const name = read.class || folder.circuits.find(listed => listed.source === source)?.class || "";
  // Another model in the text opens that circuit, which takes up the text kept for it.
  if (source !== circuit.data?.source || name !== circuit.data?.class) {
    keepText(source, name);
    await openCircuit(source, name, new Map());
    if (!circuit.data) throw new Refusal(0, { messages: byId("circuit-messages").textContent });
    return;
  }
  await takeForm(formOf(read));
});

// A click into the form may change the text while it is read.
async function readSteadyText() {
  for (;;) {
    const sent = byId("text").value, read = await readText();
    if (sent === byId("text").value) return read;
  }
}

function formOf({ inputs, signals, recordings, parameters }) {
  const entryOf = ({ entry, sigma, min, max }) => entry === "exact" ? entry : { sigma, min, max };
  return {
    inputs: new Map(inputs.map(({ name, ...input }) => [name, input])),
    signals,
    recordings: recordings.map(({ file, ...recording }) => ({ ...recording, name: recordingName(file) })),
    parameters: new Map(parameters.map(parameter => [parameter.name, entryOf(parameter)])),
  };
}

// Columns that are known already are not read again.
async function takeForm(form) {
  const infos = new Map(study.recordings.map(({ name, info }) => [name, info]));
  const recordings = form.recordings.map(recording => ({ ...recording, info: infos.get(recording.name) || null }));
  Object.assign(study, form, { recordings });
  addInputs();
  keepStudy();
  showStudy();
  await Promise.all(recordings.filter(recording => !recording.info).map(readRecording));
  showStudy();
}

byId("text").onchange = adoptText;

// ---- Files

byId("open-study").onclick = () => guarded(byId("recording-messages"), async () => {
  const file = byId("folder-studies").value;
  const { text } = await ask("/api/study", { file });
  study.file = file;
  byId("text").value = text;
  byId("replace").hidden = true;
  say(byId("save-messages"), "");
  await adoptText();
});

// Paths in the text are relative to the study: another folder for it changes them.
byId("study-file").onchange = () => {
  const before = studyFolder();
  study.file = joinPath("", byId("study-file").value.trim() || "study.toml");
  byId("study-file").value = study.file;
  byId("replace").hidden = true;
  if (studyFolder() !== before) rewrite("top", "recordings");
  else keepStudy();
};

async function save(replace) {
  byId("replace").hidden = true;
  say(byId("save-messages"), "");
  try {
    const { written } = await post("/api/study/save", { file: study.file, text: byId("text").value, replace });
    say(byId("save-messages"), "written: " + written.join(", "));
    settle(new Set(written));
    await readFolder();
  } catch (error) {
    say(byId("save-messages"), wordsOf(error), true);
    byId("replace").hidden = error.status !== 409;
    if (error.status === 409) byId("replace").focus();
  }
}

// Uploads that were written are files of the folder from now on.
function settle(written) {
  for (const recording of study.recordings) {
    const { name } = recording, path = joinPath(studyFolder(), name);
    if (!isUploaded(name) || !written.has(path)) continue;
    study.uploaded = study.uploaded.filter(other => other !== name);
    recording.name = path;
  }
  keepStudy();
  showRecordings();
}

byId("save").onsubmit = event => {
  event.preventDefault();
  save(false);
};
byId("replace").onclick = () => save(true);

// ---- Compare and diagnose

for (const what of ["compare", "diagnose"]) {
  const body = () => ({ text: byId("text").value, folder: studyFolder() });
  byId(what).onclick = () => studyView.start(`/api/study/${what}`, body());
}

showModel();
