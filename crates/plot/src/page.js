"use strict";
// Draws HEAD and CURVES on canvases. Curves are [x, y, x, y, ...]; null lifts the pen.
const live = document.getElementById("live");
document.getElementById("still").style.display = "none";
const RIGHT = 16, TOP = 8, INK = "#777", GRID = "#e4e4e4", TEXT = "#333";
const range = () => ({ lo: Infinity, hi: -Infinity });
const take = (r, v) => { if (v !== null) { if (v < r.lo) r.lo = v; if (v > r.hi) r.hi = v; } };

const panels = HEAD.panels.map((head, i) => {
  const x = range(), y = range();
  for (const c of CURVES[i]) for (let k = 0; k < c.length; k += 2) { take(x, c[k]); take(y, c[k + 1]); }
  const box = live.appendChild(document.createElement("div"));
  box.className = "panel";
  const legend = box.appendChild(document.createElement("div"));
  legend.className = "legend";
  const canvas = box.appendChild(document.createElement("canvas"));
  const p = { head, curves: CURVES[i], box, canvas, hidden: head.names.map(() => false), full: { x, y }, view: null, drag: null };
  p.values = head.names.map((name, k) => {
    const button = legend.appendChild(document.createElement("button"));
    const line = button.appendChild(document.createElement("i"));
    line.style.borderColor = head.colours[k];
    if (head.dashed[k]) line.style.borderTopStyle = "dashed";
    button.append(name);
    button.onclick = () => { p.hidden[k] = !p.hidden[k]; button.className = p.hidden[k] ? "off" : ""; draw(p); };
    return button.appendChild(document.createElement("b"));
  });
  return p;
});

function whole(p) {
  let x = { ...p.full.x };
  if (HEAD.shared) for (const q of panels) { take(x, q.full.x.lo); take(x, q.full.x.hi); }
  let y = { ...p.full.y };
  if (p.head.words.length) y = { lo: -0.3, hi: p.head.words.length - 0.7 };
  else margin(y, 0.06);
  if (!HEAD.shared) margin(x, 0.05);
  if (!(x.hi > x.lo)) x = { lo: x.lo - 1, hi: x.lo + 1 };
  return { x, y };
}

function margin(r, part) {
  if (!(r.hi >= r.lo)) { r.lo = 0; r.hi = 1; }
  const w = r.hi - r.lo;
  const m = w > 1e-9 * Math.max(Math.abs(r.lo), Math.abs(r.hi)) ? part * w : (r.hi === 0 ? 1 : 0.1 * Math.abs(r.hi));
  r.lo -= m; r.hi += m;
}

function ticks(r, count) {
  const raw = (r.hi - r.lo) / count, base = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].find(f => f * base >= raw * (1 - 1e-9)) * base;
  const marks = [];
  for (let k = Math.ceil(r.lo / step - 1e-9); k * step <= r.hi + 1e-9 * step && marks.length < 50; k++) marks.push(k * step);
  const decimals = Math.max(0, Math.min(15, -Math.floor(Math.log10(step) + 1e-9)));
  const large = Math.max(Math.abs(r.lo), Math.abs(r.hi)) >= 1e6 || step < 1e-4;
  return marks.map(v => [v, v === 0 || Math.abs(v) < step * 1e-6 ? "0" : large ? v.toExponential(Math.max(0, Math.min(8, Math.ceil(Math.log10(Math.abs(v) / step))))) : v.toFixed(decimals)]);
}

function frame(p) {
  const w = p.canvas.clientWidth, h = p.canvas.clientHeight;
  return { l: p.left, t: TOP, w: w - p.left - RIGHT, h: h - TOP - (p.last ? 44 : 10) };
}
const px = (p, f, x) => f.l + (x - p.view.x.lo) / (p.view.x.hi - p.view.x.lo) * f.w;
const py = (p, f, y) => f.t + f.h - (y - p.view.y.lo) / (p.view.y.hi - p.view.y.lo) * f.h;

function draw(p, hover) {
  const scale = window.devicePixelRatio || 1;
  const height = p.head.words.length ? 30 + 24 * p.head.words.length : panels.length === 1 ? 520 : panels.length === 2 ? 320 : 230;
  p.last = !HEAD.shared || p === panels[panels.length - 1];
  p.canvas.style.height = height + (p.last ? 34 : 0) + "px";
  p.canvas.width = p.canvas.clientWidth * scale;
  p.canvas.height = p.canvas.clientHeight * scale;
  const g = p.canvas.getContext("2d");
  g.setTransform(scale, 0, 0, scale, 0, 0);
  g.font = "13px Ubuntu, 'Segoe UI', Helvetica, Arial, sans-serif";
  const f = frame(p);
  const ys = p.head.words.length ? p.head.words.map((w, i) => [i, w]) : ticks(p.view.y, f.h / 45);
  g.fillStyle = TEXT; g.strokeStyle = GRID; g.lineWidth = 1;
  g.textAlign = "center";
  for (const [v, text] of ticks(p.view.x, f.w / 110)) {
    line(g, px(p, f, v), f.t, px(p, f, v), f.t + f.h);
    if (p.last) g.fillText(text, px(p, f, v), f.t + f.h + 18);
  }
  g.textAlign = "right";
  for (const [v, text] of ys) {
    line(g, f.l, py(p, f, v), f.l + f.w, py(p, f, v));
    g.fillText(text, f.l - 8, py(p, f, v) + 4.5);
  }
  g.textAlign = "center";
  if (p.last) g.fillText(p.head.x, f.l + f.w / 2, f.t + f.h + 38);
  g.save(); g.translate(14, f.t + f.h / 2); g.rotate(-Math.PI / 2); g.fillText(p.head.y, 0, 0); g.restore();
  g.save(); g.beginPath(); g.rect(f.l, f.t, f.w, f.h); g.clip();
  g.lineWidth = 1.6; g.lineJoin = "round";
  p.curves.forEach((c, k) => { if (!p.hidden[k]) curve(g, p, f, c, k); });
  g.setLineDash([]); g.strokeStyle = INK; g.lineWidth = 1;
  if (hover !== undefined) { line(g, hover, f.t, hover, f.t + f.h); }
  if (p.drag && !p.drag.move) { g.fillStyle = "rgba(0,114,178,0.12)"; g.fillRect(p.drag.x0, p.drag.y0, p.drag.x1 - p.drag.x0, p.drag.y1 - p.drag.y0); }
  g.restore();
  g.strokeStyle = INK; g.strokeRect(f.l, f.t, f.w, f.h);
}

function line(g, x0, y0, x1, y1) { g.beginPath(); g.moveTo(x0, y0); g.lineTo(x1, y1); g.stroke(); }

function curve(g, p, f, c, k) {
  g.strokeStyle = p.head.colours[k];
  g.setLineDash(p.head.dashed[k] ? [6, 4] : []);
  g.beginPath();
  if (p.head.crosses[k]) {
    for (let i = 0; i < c.length; i += 2) {
      if (c[i] === null || c[i + 1] === null) continue;
      const x = px(p, f, c[i]), y = py(p, f, c[i + 1]), a = 4.5;
      g.moveTo(x - a, y - a); g.lineTo(x + a, y + a); g.moveTo(x - a, y + a); g.lineTo(x + a, y - a);
    }
    g.stroke();
    return;
  }
  let pen = false;
  for (let i = 0; i < c.length; i += 2) {
    if (c[i] === null || c[i + 1] === null) { pen = false; continue; }
    const x = px(p, f, c[i]), y = Math.max(-1e5, Math.min(1e5, py(p, f, c[i + 1])));
    if (pen) g.lineTo(x, y); else g.moveTo(x, y);
    pen = true;
  }
  g.stroke();
}

// The value of a curve whose x grows, at x.
function valueAt(c, x) {
  let a = 0, b = c.length / 2 - 1;
  if (b < 0 || x < c[0] || x > c[2 * b]) return null;
  while (b - a > 1) { const m = (a + b) >> 1; if (c[2 * m] <= x) a = m; else b = m; }
  const x0 = c[2 * a], x1 = c[2 * b], y0 = c[2 * a + 1], y1 = c[2 * b + 1];
  return y0 === null || y1 === null ? null : x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) : y1;
}

function hover(p, event) {
  const f = frame(p), x = event.offsetX;
  const at = p.view.x.lo + (x - f.l) / f.w * (p.view.x.hi - p.view.x.lo);
  for (const q of HEAD.shared ? panels : [p]) {
    q.values.forEach((b, k) => {
      const v = HEAD.shared ? valueAt(q.curves[k], at) : null;
      b.textContent = v === null ? "" : q.head.words[Math.round(v)] || Number(v.toPrecision(6)).toString();
    });
    draw(q, HEAD.shared ? x : undefined);
  }
  p.canvas.title = HEAD.shared ? "t = " + Number(at.toPrecision(7)) + " s" : "";
}

function setX(p, x) { for (const q of HEAD.shared ? panels : [p]) q.view.x = { ...x }; }
function redraw() { panels.forEach(p => draw(p)); }

for (const p of panels) {
  p.view = whole(p);
  p.canvas.ondblclick = () => { for (const q of HEAD.shared ? panels : [p]) q.view = whole(q); redraw(); };
  p.canvas.onpointerdown = e => {
    p.canvas.setPointerCapture(e.pointerId);
    p.drag = { x0: e.offsetX, y0: e.offsetY, x1: e.offsetX, y1: e.offsetY, move: e.shiftKey };
  };
  p.canvas.onpointermove = e => {
    if (p.drag) {
      const f = frame(p), dx = e.offsetX - p.drag.x1, dy = e.offsetY - p.drag.y1;
      p.drag.x1 = e.offsetX; p.drag.y1 = e.offsetY;
      if (p.drag.move) {
        const v = p.view, sx = dx / f.w * (v.x.hi - v.x.lo), sy = dy / f.h * (v.y.hi - v.y.lo);
        setX(p, { lo: v.x.lo - sx, hi: v.x.hi - sx });
        v.y = { lo: v.y.lo + sy, hi: v.y.hi + sy };
        redraw();
        return;
      }
    }
    hover(p, e);
  };
  p.canvas.onpointerup = () => {
    const d = p.drag, f = frame(p), v = p.view;
    p.drag = null;
    if (!d || d.move) return;
    const X = x => v.x.lo + (x - f.l) / f.w * (v.x.hi - v.x.lo), Y = y => v.y.lo + (f.t + f.h - y) / f.h * (v.y.hi - v.y.lo);
    const [xa, xb] = [Math.min(d.x0, d.x1), Math.max(d.x0, d.x1)], [ya, yb] = [Math.min(d.y0, d.y1), Math.max(d.y0, d.y1)];
    const y = yb - ya > 12 ? { lo: Y(yb), hi: Y(ya) } : v.y;
    if (xb - xa > 6) setX(p, { lo: X(xa), hi: X(xb) });
    if (xb - xa > 6 || yb - ya > 12) v.y = y;
    redraw();
  };
  p.canvas.onpointerleave = () => { if (!p.drag) { for (const q of panels) q.values.forEach(b => { b.textContent = ""; }); redraw(); } };
  p.canvas.addEventListener("wheel", e => {
    e.preventDefault();
    const f = frame(p), v = p.view, at = v.x.lo + (e.offsetX - f.l) / f.w * (v.x.hi - v.x.lo), s = Math.exp(e.deltaY * 0.0015);
    setX(p, { lo: at + (v.x.lo - at) * s, hi: at + (v.x.hi - at) * s });
    redraw();
  }, { passive: false });
}
function layout() {
  const g = document.createElement("canvas").getContext("2d");
  g.font = "13px Ubuntu, 'Segoe UI', Helvetica, Arial, sans-serif";
  const widths = panels.map(p => Math.max(...(p.head.words.length ? p.head.words : ticks(p.view.y, 5).map(t => t[1])).map(t => g.measureText(t).width), 30));
  panels.forEach((p, i) => { p.left = 44 + (HEAD.shared ? Math.max(...widths) : widths[i]); });
  redraw();
}
window.addEventListener("resize", layout);
layout();
