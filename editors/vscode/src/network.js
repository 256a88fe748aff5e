// The picture of a model's network, which follows the text.
const vscode = require('vscode');
const { modelAt } = require('./model');
const { page } = require('./page');

/** Milliseconds without a change before the picture is drawn anew. */
const PAUSE = 400;

class Network {
  /** @type {vscode.WebviewPanel | undefined} */
  panel;
  /** @type {vscode.TextDocument | undefined} */
  document;
  /** @type {NodeJS.Timeout | undefined} */
  timer;
  /** The number of the last request; answers to older ones are dropped. */
  asked = 0;
  /** Whether a picture of the document is shown. */
  drawn = false;

  /** @param {(params: { uri: string, model?: string }) => Promise<{ model: string, svg: string }>} ask */
  constructor(ask) {
    this.ask = ask;
  }

  /** What it listens to. */
  listeners() {
    return [
      vscode.workspace.onDidChangeTextDocument((e) => {
        if (e.document === this.document) this.soon();
      }),
      vscode.window.onDidChangeActiveTextEditor((editor) => {
        if (this.panel && editor?.document.languageId === 'modelica' && editor.document !== this.document) {
          this.follow(editor.document);
          this.soon();
        }
      }),
    ];
  }

  async show() {
    const document = vscode.window.activeTextEditor?.document;
    if (document?.languageId !== 'modelica') throw new Error('Open a Modelica file to see its network.');
    this.follow(document);
    if (!this.panel) {
      this.panel = vscode.window.createWebviewPanel(
        'bramah.network', 'Network', { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true },
        { enableScripts: true, retainContextWhenHidden: true });
      this.panel.webview.html = page('', '');
      this.panel.onDidDispose(() => {
        this.panel = undefined;
        this.document = undefined;
      });
    }
    this.panel.reveal(undefined, true);
    await this.refresh();
  }

  /** @param {vscode.TextDocument} document */
  follow(document) {
    if (document === this.document) return;
    this.document = document;
    this.drawn = false;
    this.panel?.webview.postMessage({ svg: '', note: '' });
  }

  soon() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.refresh(), PAUSE);
  }

  /** The last good picture stays when there is no new one. */
  async refresh() {
    const document = this.document;
    if (!this.panel || !document) return;
    const number = ++this.asked;
    /** @type {{ svg?: string, note: string }} */
    let message;
    let title = 'Network';
    try {
      const { model, svg } = await this.ask({ uri: document.uri.toString(), model: await modelAt(document) });
      message = { svg, note: '' };
      title = model;
    } catch (error) {
      const kept = this.drawn ? '; this is the last picture that could be drawn' : '';
      message = { note: `The model does not compile${kept}.\n${error instanceof Error ? error.message : error}` };
    }
    if (number !== this.asked || !this.panel) return;
    if (message.svg) {
      this.panel.title = title;
      this.drawn = true;
    }
    this.panel.webview.postMessage(message);
  }
}

module.exports = { Network };
