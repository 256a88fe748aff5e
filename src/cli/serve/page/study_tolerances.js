// Step 3 of a study: how well each parameter is known.

import { byId, choice, element, fillTable, tableRow, withUnit } from "./tools.js";
import { circuit } from "./circuit.js";
import { rewrite, study } from "./study_text.js";
import { textField } from "./study_columns.js";

// Those that no other parameter decides: the others follow them.
const isOffered = parameter => parameter.kind === "real" && !parameter.structural && parameter.root;

// What a study without tolerances assumes to be uncertain.
const isAssumed = ({ root, unit, value }) => Boolean(root && unit && unit !== "1" && Math.abs(value) > 0);

export function showTolerances() {
  const all = circuit.data ? circuit.data.parameters : [], offered = all.filter(isOffered);
  const listed = new Set(offered.map(parameter => parameter.name));
  const strange = [...study.parameters.keys()].filter(name => !listed.has(name)).map(name => strangeOne(all, name));
  const rows = [...strange, ...offered].map(toleranceRow);
  fillTable(byId("tolerances"), ["parameter", "value", "tolerance", "one σ", "least", "greatest"], rows);
  filterTolerances();
  noteTolerances();
}

// One that the text names and the list does not offer: it says why.
function strangeOne(all, name) {
  const there = all.find(parameter => parameter.name === name && parameter.kind === "real");
  if (!there) return { name, shown: "", shown_unit: "", description: "not a number of the open circuit" };
  const why = there.structural ? "structural: it cannot be uncertain" : "follows from other parameters";
  return { ...there, description: [there.description, why].filter(Boolean).join("; ") };
}

const CHOICES = [["", ""], ["own", "own"], ["exact", "exact"]];
const FIELDS = [["sigma", "σ", "3 %"], ["min", "least value", ""], ["max", "greatest value", ""]];

function toleranceRow(parameter) {
  const { name, description, shown, shown_unit: unit } = parameter, entry = study.parameters.get(name);
  const own = typeof entry === "object" ? { ...entry } : { sigma: "", min: "", max: "" };
  const write = () => {
    study.parameters.set(name, own);
    rewrite("parameters");
  };
  const fields = FIELDS.map(([property, what, placeholder]) =>
    textField(own, property, `${what} of ${name}`, 8, write, { placeholder }));
  const enable = kind => fields.forEach(field => { field.disabled = kind !== "own"; });
  const kind = typeof entry === "object" ? "own" : entry || "";
  enable(kind);
  const kinds = choice(CHOICES, kind, `tolerance of ${name}`, chosen => {
    if (chosen === "own") fields[0].value = own.sigma ||= "5 %";
    setEntry(name, chosen === "own" ? own : chosen);
    enable(chosen);
  });
  kinds.dataset.assumed = isAssumed(parameter);
  const title = element("td", {}, element("code", {}, name), " ", element("span", { className: "soft" }, description));
  const row = tableRow(title, element("td", { className: "number" }, withUnit(shown, unit)), kinds, ...fields);
  Object.assign(row.dataset, { find: `${name} ${description}`.toLowerCase(), name });
  return row;
}

function setEntry(name, entry) {
  if (entry === "") study.parameters.delete(name);
  else study.parameters.set(name, entry);
  rewrite("parameters");
  noteTolerances();
}

// What a parameter without an entry may do depends on whether the study has any entry at all (docs/study.md).
function noteTolerances() {
  const count = study.parameters.size;
  for (const kinds of byId("tolerances").querySelectorAll("select")) {
    const assumed = count === 0 && kinds.dataset.assumed === "true";
    kinds.options[0].textContent = assumed ? "±5 % (assumed)" : "stays at its value";
  }
  byId("tolerance-none").disabled = count === 0;
  byId("tolerance-note").textContent = count === 0
    ? "No tolerance is given yet: ±5 % is assumed for the parameters that have a unit and are not 0."
    : `${count} given. Parameters without a tolerance stay at their value.`;
}

function filterTolerances() {
  const wanted = byId("tolerance-filter").value.toLowerCase().trim();
  for (const row of byId("tolerances").querySelectorAll("tbody tr")) row.hidden = !row.dataset.find.includes(wanted);
}
byId("tolerance-filter").oninput = filterTolerances;

byId("tolerance-all").onclick = () => {
  for (const row of byId("tolerances").querySelectorAll("tbody tr:not([hidden])")) {
    const assumed = row.querySelector("select").dataset.assumed === "true", { name } = row.dataset;
    if (assumed && !study.parameters.has(name)) study.parameters.set(name, { sigma: "5 %", min: "", max: "" });
  }
  rewrite("parameters");
  showTolerances();
};
byId("tolerance-none").onclick = () => {
  study.parameters.clear();
  rewrite("parameters");
  showTolerances();
};
