// What every part of the page uses: elements, requests, messages, and the progress of jobs.

// ---- Elements

export const byId = id => document.getElementById(id);

// An element with properties (those with a dash are attributes) and children.
export function element(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes("-")) node.setAttribute(key, value);
    else node[key] = value;
  }
  node.append(...children);
  return node;
}

export function button(text, onclick, label = text) {
  return element("button", { type: "button", textContent: text, onclick, className: "small", "aria-label": label });
}

// A choice; `options` are pairs of value and text.
export function choice(options, value, label, onchange) {
  const items = options.map(([optionValue, text]) => element("option", { value: optionValue }, text));
  const node = element("select", { "aria-label": label }, ...items);
  node.value = value;
  node.onchange = () => onchange(node.value);
  return node;
}

export function tableRow(...cells) {
  const asCell = content => content instanceof HTMLTableCellElement ? content : element("td", {}, content);
  return element("tr", {}, ...cells.map(asCell));
}

// Fills a table; without rows it shows no head either.
export function fillTable(table, heads, rows) {
  const head = element("tr", {}, ...heads.map(text => element("th", { scope: "col" }, text)));
  table.replaceChildren(...(rows.length ? [element("thead", {}, head), element("tbody", {}, ...rows)] : []));
}

export const withUnit = (value, unit) => unit && unit !== "1" ? `${value} ${unit}` : value;

// ---- Server

const GONE = "bramah serve does not answer: was it stopped?";

// An answer of the server that says why not.
export class Refusal extends Error {
  constructor(status, answer) {
    super(answer.messages || `bramah serve answered with status ${status}`);
    this.status = status;
    this.answer = answer;
  }
}

export async function ask(path, values = {}, options = {}) {
  const query = new URLSearchParams(values).toString();
  let response;
  try {
    response = await fetch(query ? `${path}?${query}` : path, options);
  } catch {
    throw new Refusal(0, { messages: GONE });
  }
  const answer = await response.json().catch(() => null);
  if (!response.ok || answer === null) throw new Refusal(response.status, answer || {});
  return answer;
}

export function post(path, body) {
  const headers = { "Content-Type": "application/json" };
  return ask(path, {}, { method: "POST", headers, body: JSON.stringify(body) });
}

// ---- Messages

export function say(place, text, wrong = false) {
  place.textContent = text;
  place.classList.toggle("wrong", wrong && text !== "");
}

// The words for what was thrown; a mistake of this page itself also goes to the console.
export function wordsOf(error) {
  if (!(error instanceof Refusal)) console.error(error);
  return error.message;
}

// Does something, and shows in `place` what was wrong about it.
export async function guarded(place, action) {
  say(place, "");
  try {
    await action();
  } catch (error) {
    say(place, wordsOf(error), true);
  }
}

// ---- Jobs

const pause = milliseconds => new Promise(done => setTimeout(done, milliseconds));
const stopJob = id => post("/api/job/stop", { id });

// Progress, messages and page of one run, comparison or diagnosis after the other.
export class JobView {
  constructor(place) {
    this.turn = 0;       // counts starts: answers to an earlier one are dropped
    this.id = null;      // the job that runs
    this.stopping = false;
    this.bar = element("progress", { "aria-label": "Progress" });
    this.stage = element("span", { "aria-live": "polite" });
    this.time = element("span", { className: "soft" });
    const stop = element("button", { type: "button", textContent: "Stop", onclick: () => this.stop() });
    this.progress = element("div", { className: "progress", hidden: true }, this.bar, this.stage, this.time, stop);
    this.messages = element("pre", { className: "messages", "aria-live": "polite" });
    this.caption = element("div", { className: "caption" });
    this.frame = element("div", { className: "frame" });
    place.append(this.progress, this.messages, this.caption, this.frame);
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
      if (before !== null) await stopJob(before);
      const { job } = await post(path, body);
      if (turn !== this.turn) {
        await stopJob(job);
        return;
      }
      this.id = job;
      // Stop was pressed before there was anything to stop.
      if (this.stopping) await stopJob(job);
      await this.follow(job, turn);
    } catch (error) {
      if (turn === this.turn) this.failed(wordsOf(error));
    }
    if (turn !== this.turn) return;
    this.progress.hidden = true;
    this.id = null;
  }

  async follow(id, turn) {
    const begin = performance.now();
    for (;;) {
      const job = await ask("/api/job", { id }), elapsed = performance.now() - begin;
      if (turn !== this.turn) return;
      if (job.state !== "running") {
        this.ended(job);
        return;
      }
      this.showProgress(job);
      // A short run shows no progress: the curves would jump up and down while a slider moves.
      if (elapsed > 300) this.progress.hidden = false;
      await pause(elapsed < 2000 ? 100 : 500);
    }
  }

  showProgress(job) {
    if (!this.stopping) this.stage.textContent = job.stage;
    this.time.textContent = `${job.seconds.toFixed(1)} s`;
    if (job.share === null) this.bar.removeAttribute("value");
    else this.bar.value = job.share;
  }

  async stop() {
    this.stage.textContent = "stopping…";
    this.stopping = true;
    if (this.id !== null) await guarded(this.messages, () => stopJob(this.id));
  }

  ended(job) {
    if (job.state === "stopped") this.failed(job.messages || "Stopped.", false);
    else if (job.state === "failed") this.failed(job.messages || "It failed, and gave no reason.");
    else this.done(job);
  }

  done(job) {
    say(this.messages, job.messages);
    const time = element("span", {}, `Done in ${job.seconds.toFixed(job.seconds < 1 ? 3 : 1)} s`);
    const downloads = job.files.map(file => button("Download " + file.name, () => download(file)));
    this.caption.replaceChildren(time, ...downloads);
    if (job.page) this.showPage("/api/job/page?id=" + job.id);
    else this.frame.replaceChildren();
  }

  // The old page stays until the new one is there, so that nothing flickers while a slider moves.
  showPage(address) {
    this.caption.append(element("a", { href: address, target: "_blank", rel: "noopener" }, "Open in a new tab"));
    this.frame.classList.remove("stale");
    const old = [...this.frame.children];
    const page = element("iframe", { src: address, title: "Result", className: "loading" });
    page.setAttribute("sandbox", "allow-scripts");
    page.onload = () => {
      page.className = "";
      old.forEach(node => node.remove());
    };
    this.frame.append(page);
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
    if (this.id !== null) stopJob(this.id).catch(error => say(this.messages, wordsOf(error), true));
    this.id = null;
    this.progress.hidden = true;
    say(this.messages, "");
    this.caption.replaceChildren();
    this.frame.replaceChildren();
  }
}

function download(file) {
  const address = URL.createObjectURL(new Blob([file.text]));
  element("a", { href: address, download: file.name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
