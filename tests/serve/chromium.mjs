// A Chromium and a page in it, by the DevTools protocol over two pipes: nothing but node is needed.
// https://chromedevtools.github.io/devtools-protocol/

import { spawn } from "node:child_process";
import { accessSync, constants, writeFileSync } from "node:fs";
import path from "node:path";

const NAMES = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
const FLAGS = ["--headless=new", "--no-sandbox", "--no-first-run", "--disable-gpu", "--disable-dev-shm-usage",
  "--remote-debugging-pipe"];
// Milliseconds between two looks at a condition, and after which it is given up.
const POLL = 50, PATIENCE = 20_000;

export const pause = milliseconds => new Promise(done => setTimeout(done, milliseconds));

// Looks again and again until `look` gives something true, and returns it. What is thrown meanwhile is no answer: a page
// that is just loading has none.
export async function until(what, look, patience = PATIENCE) {
  const end = Date.now() + patience;
  let why = "";
  while (Date.now() < end) {
    try {
      const found = await look();
      if (found) return found;
      why = "";
    } catch (error) {
      why = `: ${error.message}`;
    }
    await pause(POLL);
  }
  throw new Error(`waited ${patience / 1000} s for: ${what}${why}`);
}

// The browser to use: $CHROMIUM, or the first one in $PATH.
function program() {
  const folders = (process.env.PATH || "").split(path.delimiter);
  const candidates = folders.flatMap(folder => NAMES.map(name => path.join(folder, name)));
  const found = process.env.CHROMIUM || candidates.find(isProgram);
  if (!found) throw new Error(`no Chromium in $PATH (${NAMES.join(", ")}); $CHROMIUM may name one`);
  return found;
}

function isProgram(file) {
  try {
    accessSync(file, constants.X_OK);
    return true;
  } catch {
    return false;
  }
}

export class Chromium {
  // `own` is a folder for its settings. Its process leads a group: killing that ends all its helpers.
  constructor(own) {
    const stdio = ["ignore", "ignore", "ignore", "pipe", "pipe"];
    this.process = spawn(program(), [...FLAGS, `--user-data-dir=${own}`], { stdio, detached: true });
    this.process.on("error", error => this.end(error));
    this.process.on("exit", () => this.end(new Error("Chromium has ended")));
    this.ended = null;   // why, once it has
    this.number = 0;
    this.waiting = new Map();
    this.listeners = [];
    this.toBrowser = this.process.stdio[3];
    this.toBrowser.on("error", error => this.end(error));
    this.receive(this.process.stdio[4]);
  }

  // Messages end with a NUL byte; a chunk may hold several of them, or a part of one.
  receive(stream) {
    let rest = [];
    stream.on("data", chunk => {
      let from = 0;
      for (let end = chunk.indexOf(0); end >= 0; end = chunk.indexOf(0, from)) {
        const message = Buffer.concat([...rest, chunk.subarray(from, end)]);
        rest = [];
        from = end + 1;
        this.take(JSON.parse(message.toString()));
      }
      rest.push(chunk.subarray(from));
    });
  }

  take(message) {
    if (message.id === undefined) {
      for (const listener of this.listeners) listener(message);
      return;
    }
    const { done, failed } = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.error) failed(new Error(message.error.message));
    else done(message.result);
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.number;
    if (this.ended) return Promise.reject(this.ended);
    return new Promise((done, failed) => {
      this.waiting.set(id, { done, failed });
      this.toBrowser.write(JSON.stringify({ id, method, params, sessionId }) + "\0");
    });
  }

  end(error) {
    this.ended ??= new Error(`${this.process.spawnfile}: ${error.message}`);
    for (const { failed } of this.waiting.values()) failed(this.ended);
    this.waiting.clear();
  }

  async newPage() {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page(this, sessionId);
    await page.prepare();
    return page;
  }
}

class Page {
  constructor(browser, session) {
    this.browser = browser;
    this.session = session;
    this.errors = [];            // on the console
    this.contexts = new Map();   // where scripts of this page and of its frames run: `session id` -> both
    browser.listeners.push(message => this.hear(message));
  }

  send(method, params = {}, session = this.session) {
    return this.browser.send(method, params, session);
  }

  async prepare() {
    await this.listen(this.session);
    await this.send("Page.enable");
    // Fields get and lose the focus as in a window in front.
    await this.send("Emulation.setFocusEmulationEnabled", { enabled: true });
  }

  // A frame with a sandbox may be a target of its own, with its own session.
  async listen(session) {
    await this.send("Runtime.enable", {}, session);
    await this.send("Log.enable", {}, session);
    await this.send("Target.setAutoAttach", { autoAttach: true, waitForDebuggerOnStart: false, flatten: true }, session);
  }

  hear({ method, params, sessionId: session }) {
    const forget = test => [...this.contexts].filter(([, c]) => test(c)).forEach(([key]) => this.contexts.delete(key));
    const actions = {
      // A frame may be gone before it can be listened to.
      "Target.attachedToTarget": () => this.listen(params.sessionId).catch(() => {}),
      "Target.detachedFromTarget": () => forget(context => context.session === params.sessionId),
      "Runtime.executionContextCreated": () => {
        const { id, auxData } = params.context;
        if (auxData?.isDefault) this.contexts.set(`${session} ${id}`, { session, id });
      },
      "Runtime.executionContextDestroyed": () => this.contexts.delete(`${session} ${params.executionContextId}`),
      "Runtime.executionContextsCleared": () => forget(context => context.session === session),
      "Runtime.exceptionThrown": () => this.errors.push(thrown(params.exceptionDetails)),
      "Runtime.consoleAPICalled": () => {
        if (params.type === "error") this.errors.push(params.args.map(one => one.description ?? one.value).join(" "));
      },
      "Log.entryAdded": () => {
        if (params.entry.level === "error") this.errors.push(`${params.entry.text} ${params.entry.url ?? ""}`);
      },
    };
    actions[method]?.();
  }

  resize(width, height) {
    return this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
  }

  async open(address) {
    await this.send("Page.navigate", { url: address });
  }

  // Marks the old document, so that the new one can be recognised.
  async reload() {
    await this.evaluate(() => { window.old = true; });
    await this.send("Page.reload");
    await this.until("the page is loaded again", () => !window.old && document.readyState === "complete");
  }

  // Calls a function in the page, or in a context of it.
  evaluate(act, ...values) {
    return this.evaluateIn({ session: this.session }, act, ...values);
  }

  async evaluateIn({ session, id }, act, ...values) {
    const expression = `(${act})(...${JSON.stringify(values)})`;
    const options = { expression, contextId: id, returnByValue: true, awaitPromise: true };
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", options, session);
    if (exceptionDetails) throw new Error(thrown(exceptionDetails));
    return result.value;
  }

  until(what, look, ...values) {
    return until(what, () => this.evaluate(look, ...values));
  }

  // What a function gives in the frame with an address, as soon as that is something true.
  untilInFrame(what, address, look) {
    return until(what, async () => {
      for (const context of this.contexts.values()) {
        const here = await this.evaluateIn(context, () => location.href).catch(() => "");
        if (here === address) return this.evaluateIn(context, look);
      }
      return false;
    });
  }

  // ---- What a user does; elements are named by selectors

  // Waits until the element is there, to be seen and not disabled.
  ready(selector) {
    return this.until(`${selector} can be used`, wanted => {
      const node = document.querySelector(wanted);
      return node && node.getClientRects().length > 0 && !node.disabled;
    }, selector);
  }

  async click(selector) {
    await this.ready(selector);
    await this.evaluate(wanted => {
      const node = document.querySelector(wanted);
      node.focus();
      node.click();
    }, selector);
  }

  // Types a text in place of what stands there, and leaves the field.
  async fill(selector, text) {
    await this.ready(selector);
    await this.evaluate(wanted => {
      const node = document.querySelector(wanted);
      node.focus();
      node.select();
    }, selector);
    if (text === "") await this.key("Delete");
    else await this.send("Input.insertText", { text });
    await this.evaluate(() => document.activeElement.blur());
  }

  async choose(selector, value) {
    await this.ready(selector);
    await this.evaluate((wanted, chosen) => {
      const node = document.querySelector(wanted);
      node.value = chosen;
      node.dispatchEvent(new Event("change", { bubbles: true }));
    }, selector, value);
  }

  async press(selector, key, times = 1) {
    await this.ready(selector);
    await this.evaluate(wanted => document.querySelector(wanted).focus(), selector);
    for (let count = 0; count < times; count++) await this.key(key);
  }

  async key(key) {
    const windowsVirtualKeyCode = { PageDown: 34, ArrowRight: 39, Delete: 46 }[key];
    for (const type of ["rawKeyDown", "keyUp"]) {
      await this.send("Input.dispatchKeyEvent", { type, key, code: key, windowsVirtualKeyCode });
    }
  }

  async giveFiles(selector, files) {
    const found = await this.send("Runtime.evaluate", { expression: `document.querySelector(${JSON.stringify(selector)})` });
    await this.send("DOM.setFileInputFiles", { files, objectId: found.result.objectId });
  }

  // ---- What a user sees

  value(selector) {
    return this.evaluate(wanted => document.querySelector(wanted)?.value, selector);
  }

  text(selector) {
    return this.evaluate(wanted => document.querySelector(wanted)?.textContent, selector);
  }

  count(selector) {
    return this.evaluate(wanted => document.querySelectorAll(wanted).length, selector);
  }

  untilValue(selector, wanted) {
    const look = (node, text) => document.querySelector(node)?.value === text;
    return this.until(`${selector} is ${wanted}`, look, selector, wanted);
  }

  untilText(selector, part) {
    const look = (node, text) => document.querySelector(node)?.textContent.includes(text);
    return this.until(`${selector} shows ${part}`, look, selector, part);
  }

  untilCount(selector, wanted) {
    const look = (nodes, count) => document.querySelectorAll(nodes).length === count;
    return this.until(`${wanted} of ${selector}`, look, selector, wanted);
  }

  // Scrolls to an element, and waits until the page is painted again.
  show(selector) {
    return this.evaluate(async wanted => {
      document.querySelector(wanted).scrollIntoView();
      for (let count = 0; count < 2; count++) await new Promise(requestAnimationFrame);
    }, selector);
  }

  // What the window shows, as PNG.
  async picture(file) {
    const { data } = await this.send("Page.captureScreenshot");
    writeFileSync(file, Buffer.from(data, "base64"));
  }
}

const thrown = details => details.exception?.description ?? details.text;
