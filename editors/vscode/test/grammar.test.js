// The grammar, as VS Code reads it, on a sample.
const assert = require('assert/strict');
const fs = require('fs');
const path = require('path');
const test = require('node:test');
const oniguruma = require('vscode-oniguruma');
const { INITIAL, Registry, parseRawGrammar } = require('vscode-textmate');

const GRAMMAR = path.join(__dirname, '../syntaxes/modelica.tmLanguage.json');

/** Lines of the sample, each a list of `[text, innermost scope]`. */
async function tokens() {
  await oniguruma.loadWASM(fs.readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm')));
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (sources) => new oniguruma.OnigScanner(sources),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => parseRawGrammar(fs.readFileSync(GRAMMAR, 'utf8'), GRAMMAR),
  });
  const grammar = await registry.loadGrammar('source.modelica');
  assert(grammar);
  let state = INITIAL;
  const lines = fs.readFileSync(path.join(__dirname, 'sample.mo'), 'utf8').trimEnd().split('\n');
  return lines.map((line) => {
    const result = grammar.tokenizeLine(line, state);
    state = result.ruleStack;
    return result.tokens.map((t) => [line.slice(t.startIndex, t.endIndex), t.scopes[t.scopes.length - 1]]);
  });
}

test('the grammar tells the words of a sample apart', async () => {
  const lines = await tokens();
  /** @param {number} line @param {string} word */
  const scope = (line, word) => lines[line - 1].find(([text]) => text.trim() === word)?.[1].replace('.modelica', '');
  const expected = /** @type {[number, string, string][]} */ ([
    [1, 'within', 'keyword.other'],
    [1, 'Plant.Hydraulics', 'entity.name.namespace'],
    [3, 'and what drives it', 'comment.block'],
    [4, 'model', 'storage.type.class'],
    [4, 'Press', 'entity.name.type.class'],
    [4, '\\"', 'constant.character.escape'],
    [4, '// no comment', 'string.quoted.double'],
    [5, 'Base', 'entity.other.inherited-class'],
    [6, 'inner', 'storage.modifier'],
    [6, 'Oil.ISOVG46', 'entity.name.type'],
    [7, 'Hydraulic.Tank', 'entity.name.type'],
    [8, 'parameter', 'storage.modifier'],
    [8, 'Real', 'support.type'],
    [8, '1.5e-3', 'constant.numeric'],
    [9, "'a b'", 'variable.other.quoted'],
    [10, 'initial equation', 'keyword.other.section'],
    [11, 'if', 'keyword.control'],
    [11, 'time', 'variable.language'],
    [11, '.5', 'constant.numeric'],
    [11, 'and', 'keyword.operator.word'],
    [11, 'true', 'constant.language'],
    [11, 'der', 'support.function.builtin'],
    [13, 'loop', 'keyword.control'],
    [14, 'connect', 'keyword.other'],
    [14, '// joined', 'comment.line.double-slash'],
    [15, 'for', 'keyword.control'],
    [16, 'annotation', 'keyword.other.annotation'],
    [16, 'experiment', 'support.function.annotation'],
    [16, 'StopTime', 'variable.parameter.annotation'],
    [17, 'end', 'keyword.control'],
    [17, 'Press', 'entity.name.type.class'],
    [18, 'type', 'storage.type.class'],
    [18, 'Pressure', 'entity.name.type.class'],
  ]);
  for (const [line, word, wanted] of expected) assert.equal(scope(line, word), wanted, `line ${line}, ${word}`);
});
