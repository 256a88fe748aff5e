// The model that the user works at.
const vscode = require('vscode');
const { modelAround } = require('./command');

/**
 * The model around the cursor if it has an experiment; `undefined` leaves the choice to bramah.
 * @param {vscode.TextDocument} document
 * @returns {Promise<string | undefined>}
 */
async function modelAt(document) {
  const editor = vscode.window.visibleTextEditors.find((e) => e.document === document);
  if (!editor) return undefined;
  const at = editor.selection.active;
  /** @type {vscode.DocumentSymbol[] | undefined} */
  const symbols = await vscode.commands.executeCommand('vscode.executeDocumentSymbolProvider', document.uri);
  const kinds = [vscode.SymbolKind.Class, vscode.SymbolKind.Package];
  /** @param {vscode.DocumentSymbol[]} symbols @returns {import('./command').Class[]} */
  const classes = (symbols) =>
    symbols.filter((s) => kinds.includes(s.kind)).map((s) => ({
      name: s.name,
      package: s.kind === vscode.SymbolKind.Package,
      text: document.getText(s.range),
      around: s.range.contains(at),
      children: classes(s.children),
    }));
  return modelAround(document.getText(), classes(symbols ?? []));
}

module.exports = { modelAt };
