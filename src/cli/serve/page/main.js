// Tabs, the address, and the start. The address names the open circuit and what was changed: a reload keeps it, and
// it can be kept as a bookmark.

import { byId } from "./tools.js";
import { circuit, events, openCircuit, readFolder } from "./circuit.js";
import "./study.js";

// ---- Tabs

const TABS = ["circuit", "study"];

function showTab(name) {
  for (const tab of TABS) {
    const shown = tab === name;
    byId(tab).hidden = !shown;
    byId("tab-" + tab).setAttribute("aria-selected", shown);
    byId("tab-" + tab).tabIndex = shown ? 0 : -1;
  }
}

for (const tab of TABS) {
  byId("tab-" + tab).onclick = () => {
    showTab(tab);
    keepAddress();
  };
  byId("tab-" + tab).onkeydown = event => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const other = byId("tab-" + TABS.find(name => name !== tab));
    other.click();
    other.focus();
  };
}

// ---- Address

// Settings of a run that the address names where they are not the usual ones.
const USUAL = { stop: "", draw: "", units: "engineering" };

function keepAddress() {
  if (!circuit.data) return;
  const state = new URLSearchParams({ source: circuit.data.source, class: circuit.data.class });
  if (byId("circuit").hidden) state.set("tab", "study");
  for (const [id, usual] of Object.entries(USUAL)) {
    if (byId(id).value !== usual) state.set(id, byId(id).value);
  }
  for (const [name, value] of circuit.set) state.append("set", `${name}=${value}`);
  history.replaceState(null, "", "#" + state);
}

async function readAddress() {
  const state = new URLSearchParams(location.hash.slice(1));
  showTab(state.get("tab") === "study" ? "study" : "circuit");
  if (!state.get("class")) return;
  for (const [id, usual] of Object.entries(USUAL)) byId(id).value = state.get(id) || usual;
  await openCircuit(state.get("source") || "", state.get("class"), new Map(state.getAll("set").map(nameAndValue)));
}

function nameAndValue(text) {
  const cut = text.indexOf("=");
  return [text.slice(0, cut), text.slice(cut + 1)];
}

// ---- Start

events.addEventListener("change", keepAddress);
window.addEventListener("hashchange", readAddress);
await readFolder();
await readAddress();
