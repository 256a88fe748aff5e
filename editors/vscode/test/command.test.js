// The parts of the extension that need no VS Code; runs with BRAMAH=PATH in the environment, or `bramah` in PATH.
const assert = require('assert/strict');
const { spawnSync } = require('child_process');
const fs = require('fs');
const os = require('os');
const path = require('path');
const test = require('node:test');
const { absolute, call, modelAround, plotArguments, simulateArguments } = require('../src/command');
const { page } = require('../src/page');

const BRAMAH = process.env.BRAMAH ?? 'bramah';
const skip = spawnSync(BRAMAH, ['--version']).error ? 'no bramah' : false;

const TEXT = `package Two
  model A
    Real x(start = 1, fixed = true);
  equation
    der(x) = -x;
    annotation(experiment(StopTime = 1));
  end A;
  model B
    extends A;
    annotation(experiment(StopTime = 1));
  end B;
end Two;
`;

test('folders of libraries', () => {
  assert.equal(absolute('~/lib', '/work'), path.join(os.homedir(), 'lib'));
  assert.equal(absolute('lib', '/work'), path.resolve('/work/lib'));
  assert.equal(absolute('/lib', '/work'), path.resolve('/lib'));
});

test('the model around the cursor', () => {
  /** @param {string} name @param {boolean} around @param {string} text */
  const model = (name, around, text) => ({ name, package: false, text, around, children: [] });
  /** @param {import('../src/command').Class[]} children */
  const inPackage = (children) => [{ name: 'P', package: true, text: '', around: true, children }];
  const a = model('A', false, 'experiment(StopTime = 1)');
  const b = model('B', true, 'experiment (StopTime = 1)');
  assert.equal(modelAround('within Q.R;\n', inPackage([a, b])), 'Q.R.P.B');
  assert.equal(modelAround('', inPackage([a, model('C', true, 'Real x;')])), undefined);
  assert.equal(modelAround('', inPackage([a])), undefined);
});

test('a run and its plot', { skip }, async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'bramah-'));
  const [file, result, picture] = ['Two.mo', 'r.csv', 'p.svg'].map((name) => path.join(folder, name));
  fs.writeFileSync(file, TEXT);
  await call(BRAMAH, simulateArguments({ file, model: 'Two.B', libraries: [folder], result }));
  await call(BRAMAH, plotArguments({ result, variables: 'x', picture }));
  const svg = fs.readFileSync(picture, 'utf8');
  assert.match(page(svg, ''), /<div id="picture"><svg /);
  const several = simulateArguments({ file, libraries: [], result });
  await assert.rejects(call(BRAMAH, several), /several models could be run/);
  fs.rmSync(folder, { recursive: true });
});
