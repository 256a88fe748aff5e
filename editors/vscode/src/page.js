// Pages with one picture.
const { randomBytes } = require('crypto');

/** @param {string} text */
function escape(text) {
  return text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');
}

/**
 * A page with a picture and a line above it. A message `{ svg?, note }` to the page changes them.
 * @param {string} svg
 * @param {string} note
 */
function page(svg, note) {
  const nonce = randomBytes(16).toString('hex');
  return `<!DOCTYPE html>
<html>
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; style-src 'unsafe-inline'; script-src 'nonce-${nonce}'">
<style>
  svg { max-width: 100%; height: auto; }
  #note { white-space: pre-wrap; }
  #note:empty { display: none; }
</style>
</head>
<body>
<p id="note">${escape(note)}</p>
<div id="picture">${svg}</div>
<script nonce="${nonce}">
  addEventListener('message', ({ data }) => {
    document.getElementById('note').textContent = data.note;
    if (data.svg !== undefined) document.getElementById('picture').innerHTML = data.svg;
  });
</script>
</body>
</html>`;
}

module.exports = { page };
