// The settings of the extension.
const vscode = require('vscode');
const { absolute } = require('./command');

/**
 * The program, and the folders of libraries.
 * @param {vscode.Uri} [uri] of the file concerned
 */
function settings(uri) {
  const values = vscode.workspace.getConfiguration('bramah', uri);
  const folder = (uri && vscode.workspace.getWorkspaceFolder(uri)) ?? vscode.workspace.workspaceFolders?.[0];
  const base = folder?.uri.fsPath ?? process.cwd();
  const libraries = /** @type {string[]} */ (values.get('libraries', []));
  return { program: values.get('path', 'bramah'), libraries: libraries.map((l) => absolute(l, base)) };
}

module.exports = { settings };
