// Drives the page of `bramah serve` in Chromium: node tests/serve/drive.mjs BRAMAH [FOLDER FOR PICTURES]
// Prints a line for each check; the exit status is 1 where one failed.

import { spawn } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { Chromium, until } from "./chromium.mjs";

// After so many milliseconds all is given up.
const LIMIT = 180_000;
// A diagnosis takes seconds, in a slow build on a busy machine more.
const LONG = 120_000;
// Of the window.
const [WIDTH, HEIGHT] = [1200, 900];

const [bramah, pictures] = process.argv.slice(2);
if (!bramah) {
  console.error("node drive.mjs BRAMAH [FOLDER FOR PICTURES]");
  process.exit(2);
}

// ---- Checks

let failures = 0;

function check(what, holds, more = "") {
  console.log(`${holds ? "ok   " : "FAIL "} ${what}${holds || more === "" ? "" : `: ${more}`}`);
  if (!holds) failures++;
}

// What was waited for has come.
const reached = what => check(what, true);

// ---- The folder that is served, and files to be uploaded

const temporary = mkdtempSync(path.join(tmpdir(), "bramah-serve-"));
const inside = (...names) => path.join(temporary, ...names);
const served = (...names) => inside("served", ...names);
const UPLOADS = { "bench_1.csv": "train_1.csv", "bench_2.csv": "train_2.csv", "bench_held.csv": "held_1.csv" };

function makeFolders() {
  const examples = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../examples/diagnosis");
  for (const name of ["served", "uploads", "downloads", "chromium"]) mkdirSync(inside(name));
  for (const name of ["Loop.mo", "gap.toml", ...Object.values(UPLOADS)]) cpSync(path.join(examples, name), served(name));
  for (const [name, original] of Object.entries(UPLOADS)) cpSync(path.join(examples, original), inside("uploads", name));
  writeFileSync(inside("uploads", "bad.csv"), "nothing");
  writeFileSync(served("Broken.mo"), "model Broken\n  Hydraulics.Pmup pump;\nend Broken;\n");
  writeFileSync(served("Torn.mo"), "model Torn\n  Real x\nend Torn;\n");
  writeFileSync(served("Latin.mo"), Buffer.from("model Latin \"\xd6lkreis\" end Latin;\n", "latin1"));
  if (pictures) mkdirSync(pictures, { recursive: true });
}

// ---- Processes

const processes = [];

// Kills a process with all that it has started: each leads a group.
function kill(child) {
  try {
    process.kill(-child.pid, "SIGKILL");
  } catch {
    // It has ended already.
  }
}

function cleanUp() {
  processes.forEach(kill);
  // Helpers of Chromium may still be writing for a moment.
  rmSync(temporary, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
}

async function startServer() {
  const server = spawn(path.resolve(bramah), ["serve", served()], { stdio: ["ignore", "pipe", "inherit"], detached: true });
  processes.push(server);
  let said = "", trouble = "";
  server.on("error", error => { trouble = error.message; });
  server.on("exit", status => { trouble = `ended with status ${status}`; });
  server.stdout.on("data", chunk => { said += chunk; });
  const address = await until("the address of the server", () => /http:\/\/[\d.]+:\d+\//.exec(said)?.[0] || trouble);
  if (address === trouble) throw new Error(`${bramah} serve: ${trouble}`);
  return { server, address };
}

// ---- Parts of the page

const labelled = label => `[aria-label="${label}"]`;
const field = name => `[id="value-${name}"]`;
const slider = name => `input[type=range]${labelled(name)}`;
const RUN = "#run button.main";

// The address of the page that a view shows, once that is another one than before.
function shownPage(page, view, before = "") {
  const look = (wanted, old) => {
    const frames = document.querySelectorAll(`#${wanted} iframe`), frame = frames[0];
    return frames.length === 1 && !frame.classList.contains("loading") && frame.src !== old && frame.src;
  };
  return until(`a new result in ${view}`, () => page.evaluate(look, view, before), LONG);
}

// Runs in the frame: something is painted on one of its canvases.
function painted() {
  const isPainted = canvas => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.some(value => value !== 0);
  };
  return [...document.querySelectorAll("canvas")].some(isPainted);
}

// What a window of some height shows, from an element on.
async function picture(page, name, height, selector) {
  if (!pictures) return;
  await page.resize(WIDTH, height);
  await page.show(selector);
  await page.picture(path.join(pictures, name + ".png"));
  await page.resize(WIDTH, HEIGHT);
}

// ---- Steps; each goes on where the one before has ended

async function openCircuit(page, address) {
  await page.open(address);
  await page.until("the list", () => document.querySelectorAll("#circuit-list ul a").length > 5);
  const troubles = await page.text("#circuit-list details");
  check("what cannot be read is listed with its messages", troubles?.includes("UTF-8"), troubles);
  await page.click('#circuit-list a[href*="class=Loop"]');
  await page.until("its picture", () => document.querySelector("#picture svg"));
  check("a circuit opens with picture and parameters", await page.count("#parameters tr") > 20);
  check("the address names the circuit", await page.evaluate(() => location.hash.includes("class=Loop")));
}

async function run(page) {
  await page.click(RUN);
  await page.untilText("#run-view .messages", "E106");
  reached("a run without inputs is refused with E106");
  await page.fill(field("f_ref"), "27");
  await page.fill(field("u_load"), "3");
  await page.press(slider("J_L"), "ArrowRight", 20);
  const moved = await page.value(field("J_L"));
  check("keys move a slider, and its field follows", Number(moved) > 2, moved);
  await page.fill("#stop", "3");
  await page.fill("#draw", "n_p, p");
  await page.click(RUN);
  const shown = await shownPage(page, "run-view");
  await page.untilInFrame("painted curves", shown, painted);
  reached("a run draws its curves in the frame");
  await page.click("#live");
  await page.press(slider("J_L"), "PageDown");
  await page.untilInFrame("painted curves", await shownPage(page, "run-view", shown), painted);
  reached("a moved slider runs by itself, and only the newest result stays");
  await picture(page, "circuit", 1500, "header");
}

async function keepValues(page) {
  await page.reload();
  await page.untilText("#changed", "3 changed");
  reached("a reload keeps changed values");
  await page.fill(field("J_L"), "abc");
  await page.click(RUN);
  await page.untilText("#run-view .messages", "`J_L` is no number");
  check("what is no number is marked", await page.count(`${field("J_L")}[aria-invalid=true]`) === 1);
  await page.click(labelled("reset J_L"));
  check("reset gives back the value of the circuit", await page.value(field("J_L")) === "2");
}

async function upload(page) {
  await page.click("#tab-study");
  await page.giveFiles("#files", [...Object.keys(UPLOADS), "bad.csv"].map(name => inside("uploads", name)));
  await page.untilCount("#recordings tbody tr", 3);
  await page.untilText("#recording-messages", "bad.csv");
  reached("a bad file is refused, the others are taken");
  check("names say the roles", await page.value(labelled("role of bench_held.csv")) === "held");
  check("columns of equal name drive the inputs", await page.value(labelled("column of input u_load")) === "u_load");
}

const SIGNALS = { n_pump: "n_p", n_motor: "n_m", p_high: "p", T_drive: "T_e" };
// Those of gap.toml.
const SIGMAS = { "J_L": "5 %", "shaft_1.J": "3 %", "p_low": "3 %", "V_line": "8 %", "bearing_1.d": "20 %",
  "electricMotor.R_r": "5 %", "load.a_0": "10 %", "load.a_1": "3 %", "load.a_2": "10 %", "load.B": "15 %" };
const EXPECTED = ['model = "Loop.mo"', 'u_load = { column = "u_load", unit = "V", hold = true }', 'variable = "T_e"',
  'full_scale = "200 bar"', 'file = "bench_held.csv"', "window = [0.5, ", '"load.B" = { sigma = "15 %" }',
  '"oil.rho_0" = "exact"'];

async function fillStudy(page) {
  for (const [column, variable] of Object.entries(SIGNALS)) {
    await page.click(labelled(`add a signal for column ${column}`));
    await page.fill(labelled(`variable of ${column}`), variable);
  }
  await page.fill(labelled("full scale of p_high"), "200 bar");
  await page.fill(labelled("begin of the window of bench_1.csv"), "0.5");
  await checkOffered(page);
  for (const [name, sigma] of Object.entries(SIGMAS)) {
    await page.choose(labelled(`tolerance of ${name}`), "own");
    await page.fill(labelled(`σ of ${name}`), sigma);
  }
  await page.choose(labelled("tolerance of oil.rho_0"), "exact");
  const text = await page.value("#text"), missing = EXPECTED.filter(part => !text.includes(part));
  check("the form writes the text", missing.length === 0, missing.join("\n"));
  await picture(page, "study", 2500, "header");
}

// `shaft_2.J` follows J_L, `steady` is no number; `oil.m` has no unit, `inverter.U_b` is 0.
async function checkOffered(page) {
  const offered = name => page.count(labelled(`tolerance of ${name}`));
  const counts = [await offered("J_L"), await offered("shaft_2.J"), await offered("steady")];
  check("tolerances are offered for real parameters that follow no other", counts.join() === "1,0,0", counts.join());
  const first = name => page.text(`${labelled(`tolerance of ${name}`)} option`);
  const texts = [await first("J_L"), await first("oil.m"), await first("inverter.U_b")];
  const wanted = ["±5 % (assumed)", "stays at its value", "stays at its value"];
  check("±5 % is assumed for those with a unit and a value", texts.join() === wanted.join(), texts.join());
}

async function editText(page) {
  const text = await page.value("#text");
  const [comment, pieces] = ["# my comment\n[signals]", 'file = "bench_2.csv"\npieces = 3'];
  const edited = text.replace("[signals]", comment).replace('file = "bench_2.csv"', pieces);
  await page.fill("#text", edited.replace('role = "train"', 'role = "held"'));
  await page.untilValue(labelled("role of bench_1.csv"), "held");
  reached("the form follows the text");
  await page.choose(labelled("role of bench_1.csv"), "train");
  const rewritten = await page.value("#text");
  check("comments elsewhere stay", rewritten.includes(comment));
  check("what the form does not show stays too", rewritten.includes("pieces = 3"));
  await page.fill("#text", rewritten.replace("[inputs]", "[inptus]"));
  await page.untilText("#text-messages", "inptus");
  reached("a wrong text is shown with its messages");
  await page.fill("#text", rewritten);
  await page.until("no messages", () => document.querySelector("#text-messages").textContent === "");
}

async function diagnose(page) {
  await page.click("#compare");
  const compared = await shownPage(page, "study-view");
  await page.untilInFrame("painted curves", compared, painted);
  reached("a comparison draws measured and simulated curves");
  await page.click("#diagnose");
  const report = await shownPage(page, "study-view", compared);
  const text = await page.untilInFrame("the report", report, () => document.body?.innerText);
  check("a diagnosis shows its report", text.includes("Gap of"), text.slice(0, 80));
  const height = await page.evaluate(() => document.querySelector("#study-view iframe").clientHeight / innerHeight);
  check("the report has at least 80 % of the window's height", height >= 0.8, String(height));
  await page.click(labelled("Download verdict.json"));
  const verdict = await until("verdict.json", () => JSON.parse(readFileSync(inside("downloads", "verdict.json"), "utf8")));
  check("verdict.json can be downloaded", verdict.verdict !== undefined);
  await picture(page, "report", 1200, "#study-view");
}

async function save(page) {
  await page.fill("#study-file", "driven.toml");
  await page.click("#save button");
  await page.untilText("#save-messages", "written: ");
  const names = ["driven.toml", ...Object.keys(UPLOADS)];
  check("saving writes study and uploads", names.every(name => existsSync(served(name))), await page.text("#save-messages"));
  await page.choose(labelled("sign of p_high"), "-1");
  await page.click("#save button");
  await page.untilText("#save-messages", "is there already");
  check("nothing is replaced without a question", !readFileSync(served("driven.toml"), "utf8").includes("sign = -1"));
  await page.click("#replace");
  await page.untilText("#save-messages", "written: ");
  check("but after it", readFileSync(served("driven.toml"), "utf8").includes("sign = -1"));
  await page.reload();
  await page.untilValue(labelled("sign of p_high"), "-1");
  await page.untilCount("#recordings tbody tr", 3);
  reached("a reload keeps the study");
}

async function openStudy(page) {
  await page.choose("#folder-studies", "gap.toml");
  await page.click("#open-study");
  await page.untilValue(labelled("role of train_1.csv"), "train");
  await page.until("its recordings", () => !document.querySelector("#recordings").textContent.includes("reading"));
  const read = [await page.value(labelled("variable of p_high")), await page.value(labelled("σ of load.a_1"))];
  check("a study of the folder opens", read.join() === "p,3 %", read.join());
  await page.fill("#study-file", "rig/deep/x.toml");
  const text = await page.value("#text");
  check("paths follow the study's folder", text.includes('"../../Loop.mo"') && text.includes('"../../train_1.csv"'));
  await page.fill("#study-file", "gap.toml");
}

async function goBack(page) {
  await page.click("#tab-circuit");
  await page.click('#circuit-list a[href*="class=ServoPump.DeadZone"]');
  await page.untilText("#circuit-name", "ServoPump.DeadZone");
  await page.evaluate(() => history.back());
  await page.untilText("#circuit-name", "Loop");
  await page.click("#tab-study");
  await page.untilCount("#signals tbody tr", 4);
  reached("Back opens the circuit before, with its study");
}

async function stopDiagnosis(page) {
  await page.click("#diagnose");
  await page.click("#study-view .progress button");
  const ended = () => document.querySelector("#study-view .progress").hidden;
  await until("the end of the diagnosis", () => page.evaluate(ended), LONG);
  const [messages, frames] = [await page.text("#study-view .messages"), await page.count("#study-view iframe")];
  check("a diagnosis can be stopped", messages !== "" && frames === 0, messages);
}

async function broken(page, address) {
  await page.open(address + "#source=Broken.mo&class=Broken");
  await page.untilText("#circuit-messages", "Pmup");
  await page.click('#circuit-list a[href*="class=Torn"]');
  await page.untilText("#circuit-messages", "^ `;` is missing here");
  reached("a broken circuit shows its messages");
  await page.open(address + "#source=Loop.mo&class=Loop");
  await page.until("the circuit", () => !document.querySelector("#circuit-open").hidden);
  await page.resize(800, HEIGHT);
  const fits = () => document.documentElement.scrollWidth <= innerWidth;
  for (const tab of ["study", "circuit"]) {
    await page.click("#tab-" + tab);
    check(`nothing is wider than a window of 800 px: ${tab}`, await page.evaluate(fits));
  }
}

// Refusals are part of the tests, and the browser notes each as an error.
const isExpected = error => /status of 4\d\d/.test(error);

async function serverGone(page, server) {
  const unexpected = page.errors.filter(error => !isExpected(error));
  check("nothing else went wrong in the page", unexpected.length === 0, unexpected.join("\n"));
  kill(server);
  await page.click(RUN);
  await page.untilText("#run-view .messages", "was it stopped?");
  reached("a server that is gone is named");
}

async function drive() {
  makeFolders();
  const { server, address } = await startServer();
  const browser = new Chromium(inside("chromium"));
  processes.push(browser.process);
  await browser.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: inside("downloads") });
  const page = await browser.newPage();
  await page.resize(WIDTH, HEIGHT);
  await openCircuit(page, address);
  await run(page);
  await keepValues(page);
  await upload(page);
  await fillStudy(page);
  await editText(page);
  await diagnose(page);
  await save(page);
  await openStudy(page);
  await goBack(page);
  await stopDiagnosis(page);
  await broken(page, address);
  await serverGone(page, server);
}

process.on("exit", cleanUp);
for (const signal of ["SIGINT", "SIGTERM", "SIGHUP"]) process.on(signal, () => process.exit(1));
setTimeout(() => {
  check(`all is over after ${LIMIT / 1000} s`, false);
  process.exit(1);
}, LIMIT);
try {
  await drive();
} catch (error) {
  check(error.message, false);
}
process.exit(failures ? 1 : 0);
