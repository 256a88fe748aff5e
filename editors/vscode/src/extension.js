// The extension: starts `bramah lsp` and offers the commands.
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');
const { Network } = require('./network');
const { Runs } = require('./run');
const { settings } = require('./settings');

/** @type {LanguageClient | undefined} */
let client;

async function start() {
  const { program, libraries } = settings();
  client = new LanguageClient(
    'bramah', 'Bramah', { command: program, args: ['lsp'] },
    {
      documentSelector: [{ scheme: 'file', language: 'modelica' }],
      initializationOptions: { libraries },
    });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    throw new Error(`\`${program}\` does not start. Set bramah.path to where it is. ${error}`);
  }
}

async function stop() {
  const running = client;
  client = undefined;
  await running?.stop();
}

async function restart() {
  await stop();
  await start();
}

/**
 * A failure is shown to the user.
 * @param {() => Promise<void>} act
 */
function shown(act) {
  return async () => {
    try {
      await act();
    } catch (error) {
      vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
    }
  };
}

/** @param {vscode.ExtensionContext} context */
async function activate(context) {
  const runs = new Runs(context);
  const network = new Network(async (params) => {
    if (!client) throw new Error('the server does not run');
    return client.sendRequest('bramah/network', params);
  });
  context.subscriptions.push(
    vscode.commands.registerCommand('bramah.run', shown(() => runs.run())),
    vscode.commands.registerCommand('bramah.plot', shown(() => runs.plot())),
    vscode.commands.registerCommand('bramah.network', shown(() => network.show())),
    vscode.commands.registerCommand('bramah.restart', shown(restart)),
    vscode.workspace.onDidChangeConfiguration((e) => {
      if (e.affectsConfiguration('bramah')) shown(restart)();
    }),
    ...network.listeners());
  await shown(start)();
}

module.exports = { activate, deactivate: stop };
