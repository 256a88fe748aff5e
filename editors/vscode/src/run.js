// Runs of models, and plots of their results.
const fs = require('fs');
const path = require('path');
const vscode = require('vscode');
const { call, plotArguments, simulateArguments } = require('./command');
const { modelAt } = require('./model');
const { page } = require('./page');
const { settings } = require('./settings');

class Runs {
  /** @type {vscode.WebviewPanel | undefined} */
  panel;
  /** @type {string | undefined} */
  last;

  /** @param {vscode.ExtensionContext} context */
  constructor(context) {
    this.state = context.workspaceState;
    this.folder = (context.storageUri ?? context.globalStorageUri).fsPath;
  }

  /** Simulates the model of the editor and shows its result. */
  async run() {
    const document = vscode.window.activeTextEditor?.document;
    if (document?.languageId !== 'modelica') throw new Error('Open a Modelica file to run its model.');
    if (document.isUntitled || (document.isDirty && !(await document.save()))) throw new Error('Save the file first.');
    const file = document.uri.fsPath;
    const model = await modelAt(document);
    const { program, libraries } = settings(document.uri);
    fs.mkdirSync(this.folder, { recursive: true });
    const name = model ?? path.basename(file, '.mo');
    const result = path.join(this.folder, `${name}.csv`);
    fs.rmSync(result, { force: true });
    const args = simulateArguments({ file, model, libraries, result });
    const status = await inTerminal(name, program, args, document.uri);
    // a run that stopped early has written what it had
    if (fs.existsSync(result)) await this.show(result);
    else if (status !== 0) throw new Error('There is no result; the terminal says why.');
  }

  /** Asks which result and which of its variables are drawn. */
  async plot() {
    const chosen = await vscode.window.showOpenDialog({
      title: 'Result to plot',
      defaultUri: this.last ? vscode.Uri.file(this.last) : undefined,
      filters: { Results: ['csv', 'mat'] },
    });
    if (!chosen) return;
    const result = chosen[0].fsPath;
    const variables = await vscode.window.showInputBox({
      title: 'Variables to draw',
      prompt: 'Such as cyl.*,pump.port.p; empty for as many as fit. The next run of this model draws the same.',
      value: this.state.get(result, ''),
    });
    if (variables === undefined) return;
    await this.state.update(result, variables.trim());
    await this.show(result);
  }

  /** @param {string} result */
  async show(result) {
    this.last = result;
    fs.mkdirSync(this.folder, { recursive: true });
    const picture = path.join(this.folder, 'plot.svg');
    const { program } = settings();
    const said = await call(program, plotArguments({ result, variables: this.state.get(result, ''), picture }));
    const note = said.split('\n').filter((line) => !line.startsWith('wrote ')).join('\n');
    if (!this.panel) {
      this.panel = vscode.window.createWebviewPanel(
        'bramah.plot', 'Plot', { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, { enableScripts: true });
      this.panel.onDidDispose(() => (this.panel = undefined));
    }
    this.panel.title = path.basename(result);
    this.panel.webview.html = page(fs.readFileSync(picture, 'utf8'), note);
    this.panel.reveal(undefined, true);
  }
}

/**
 * Runs a program as a task and returns its exit status.
 * @param {string} name
 * @param {string} program
 * @param {string[]} args
 * @param {vscode.Uri} uri
 * @returns {Promise<number | undefined>}
 */
function inTerminal(name, program, args, uri) {
  const folder = vscode.workspace.getWorkspaceFolder(uri);
  const cwd = folder?.uri.fsPath ?? path.dirname(uri.fsPath);
  const execution = new vscode.ProcessExecution(program, args, { cwd });
  const task = new vscode.Task(
    { type: 'bramah', model: name }, folder ?? vscode.TaskScope.Workspace, name, 'bramah', execution, []);
  task.presentationOptions = { clear: true, showReuseMessage: false };
  return new Promise((done, fail) => {
    /** @param {vscode.TaskExecution} ended @param {number | undefined} status */
    const end = (ended, status) => {
      if (ended.task.source !== 'bramah' || ended.task.name !== name) return;
      listeners.forEach((l) => l.dispose());
      done(status);
    };
    const listeners = [
      vscode.tasks.onDidEndTaskProcess((e) => end(e.execution, e.exitCode)),
      // without a process, as when the program is missing, only this comes
      vscode.tasks.onDidEndTask((e) => setTimeout(() => end(e.execution, undefined), 500)),
    ];
    vscode.tasks.executeTask(task).then(undefined, fail);
  });
}

module.exports = { Runs };
