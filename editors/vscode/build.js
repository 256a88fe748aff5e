// Bundles the extension, and writes the licences of what is bundled beside it.
const esbuild = require('esbuild');
const fs = require('fs');
const path = require('path');

/** @param {esbuild.Metafile} metafile */
function licences(metafile) {
  const packages = new Set();
  for (const input of Object.keys(metafile.inputs)) {
    const found = input.match(/^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//);
    if (found) packages.add(found[1]);
  }
  const texts = [...packages].sort().map((folder) => {
    const file = fs.readdirSync(folder).find((name) => /^licen[sc]e/i.test(name));
    if (!file) throw new Error(`${folder} has no licence`);
    return `${path.basename(folder)}\n\n${fs.readFileSync(path.join(folder, file), 'utf8').trim()}\n`;
  });
  return texts.join('\n----\n\n');
}

async function build() {
  const result = await esbuild.build({
    entryPoints: ['src/extension.js'],
    outfile: 'dist/extension.js',
    bundle: true,
    minify: true,
    platform: 'node',
    target: 'node20',
    format: 'cjs',
    external: ['vscode'],
    metafile: true,
  });
  fs.writeFileSync('dist/licences.txt', licences(result.metafile));
}

build();
