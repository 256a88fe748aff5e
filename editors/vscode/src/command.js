// The program `bramah`: its arguments and its answers. Knows nothing of VS Code.
const { execFile } = require('child_process');
const os = require('os');
const path = require('path');

/**
 * A folder of a library as the settings name it.
 * @param {string} folder
 * @param {string} base the folder that is open
 */
function absolute(folder, base) {
  if (folder === '~' || folder.startsWith('~/')) return path.join(os.homedir(), folder.slice(1));
  return path.resolve(base, folder);
}

/**
 * @param {{ file: string, model?: string, libraries: string[], result: string }} run
 */
function simulateArguments({ file, model, libraries, result }) {
  const chosen = model ? ['--model', model] : [];
  const folders = libraries.flatMap((dir) => ['--library', dir]);
  return ['simulate', file, ...chosen, ...folders, '--csv-units', 'header', '-o', result];
}

/**
 * @param {{ result: string, variables: string, picture: string }} plot
 */
function plotArguments({ result, variables, picture }) {
  const chosen = variables ? ['--variables', variables] : [];
  return ['plot', result, ...chosen, '--unit-system', 'engineering', '-o', picture];
}

/**
 * Runs it to its end and returns what it says on stderr, which is also the reason of a failure.
 * @param {string} program
 * @param {string[]} args
 * @returns {Promise<string>}
 */
function call(program, args) {
  return new Promise((done, fail) => {
    execFile(program, args, (error, _, stderr) => {
      if (error) fail(new Error(stderr.trim() || error.message));
      else done(stderr.trim());
    });
  });
}

/**
 * A class of a file, with its text and whether the cursor is in it.
 * @typedef {{ name: string, package: boolean, text: string, around: boolean, children: Class[] }} Class
 */

/**
 * The full name of the model around the cursor, if it has an experiment.
 * Otherwise bramah chooses.
 * @param {string} text of the file
 * @param {Class[]} classes
 * @returns {string | undefined}
 */
function modelAround(text, classes) {
  const within = text.match(/^\s*within\s+([\w.]+)\s*;/m);
  const names = within ? [within[1]] : [];
  let model;
  let inside = classes.find((c) => c.around);
  while (inside) {
    names.push(inside.name);
    if (!inside.package && /\bexperiment\s*\(/.test(inside.text)) model = names.join('.');
    inside = inside.children.find((c) => c.around);
  }
  return model;
}

module.exports = { absolute, simulateArguments, plotArguments, call, modelAround };
