// Axes and lines of plots on a canvas.
"use strict";

const MARGIN = { left: 82, right: 22, top: 8, bottom: 36 };

const colors = new Map();

// A colour of report.css; asked of the browser once.
function color(name) {
  if (!colors.has(name)) colors.set(name, getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim());
  return colors.get(name);
}

// Round numbers, about n of them.
function ticks(a, b, n) {
  const span = b - a;
  if (!(span > 0) || !isFinite(span)) return [a];
  let step = Math.pow(10, Math.floor(Math.log10(span / n)));
  for (const f of [1, 2, 5, 10]) if (span / (step * f) <= n) { step *= f; break; }
  const found = [];
  for (let k = Math.ceil(a / step - 1e-9); k * step <= b + 1e-9 * span; k++) found.push(k * step);
  return found;
}

// A cleared canvas of the size of a box (CSS pixels).
function prepare(canvas, box = canvas.getBoundingClientRect()) {
  const scale = window.devicePixelRatio || 1;
  const width = Math.max(box.width, 200), height = Math.max(box.height, 80);
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale); canvas.height = Math.round(height * scale);
  }
  const g = canvas.getContext("2d");
  g.setTransform(scale, 0, 0, scale, 0, 0);
  g.clearRect(0, 0, width, height);
  g.font = "12px system-ui, sans-serif";
  return { g, width, height };
}

// Whether a box is on the screen, or about to be; on paper, and once nothing changes, all are.
let drawsAll = false;
function isSeen(box) { return drawsAll || document.documentElement.classList.contains("light") || (box.bottom > -200 && box.top < window.innerHeight + 200); }

function drawAxes(g, frame, x, y, label, upright) {
  g.strokeStyle = color("line"); g.fillStyle = color("soft"); g.lineWidth = 1;
  g.textAlign = "right"; g.textBaseline = "middle";
  const rows = frame.logarithmic ? decades(...y) : ticks(...y, 6);
  for (const v of rows) {
    const at = frame.y(v);
    g.beginPath(); g.moveTo(frame.left, at); g.lineTo(frame.right, at); g.stroke();
    g.fillText(readable(v), frame.left - 6, at);
  }
  g.textAlign = "center"; g.textBaseline = "top";
  for (const v of ticks(...x, 8)) {
    const at = frame.x(v);
    g.beginPath(); g.moveTo(at, frame.top); g.lineTo(at, frame.bottom); g.stroke();
    g.fillText(readable(v), at, frame.bottom + 5);
  }
  g.fillText(label, 0.5 * (frame.left + frame.right), frame.bottom + 20);
  g.save();
  g.translate(10, 0.5 * (frame.top + frame.bottom)); g.rotate(-Math.PI / 2); g.textBaseline = "middle";
  const room = frame.bottom - frame.top + 12, short = g.measureText(upright).width > room ? upright.replace(/^.*\.(?=\S+( \(|$))/, "") : upright;
  g.fillText(short, 0, 0, room);
  g.restore();
}

// Powers of ten from a to b.
function decades(a, b) {
  const found = [];
  for (let k = Math.ceil(Math.log10(a)); k <= Math.log10(b); k++) found.push(Math.pow(10, k));
  return found;
}

// The frame of a plot: pixels of x and y.
function makeFrame(width, height, x, y, logarithmic = false) {
  const f = { left: MARGIN.left, right: width - MARGIN.right, top: MARGIN.top, bottom: height - MARGIN.bottom, logarithmic };
  const of = logarithmic ? Math.log10 : (v) => v, low = of(y[0]), high = of(y[1]);
  f.x = (v) => f.left + (v - x[0]) / (x[1] - x[0]) * (f.right - f.left);
  f.y = (v) => f.bottom - (of(v) - low) / (high - low) * (f.bottom - f.top);
  return f;
}

// Limits with some room about them, also of a constant.
function widen([least, most]) {
  if (!(most >= least)) return [0, 1];
  if (!(most > least)) { const d = Math.abs(least) * 1e-3 || 1e-12; least -= d; most += d; }
  const pad = 0.06 * (most - least);
  return [least - pad, most + pad];
}

// What is drawn in `paint` stays within the frame.
function inside(g, frame, paint) {
  g.save();
  g.beginPath(); g.rect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top); g.clip();
  paint();
  g.restore();
}

function drawUpright(g, frame, x, name, dashes = []) {
  const at = frame.x(x);
  if (!(at >= frame.left && at <= frame.right)) return;
  g.strokeStyle = color(name); g.lineWidth = 1; g.setLineDash(dashes);
  g.beginPath(); g.moveTo(at, frame.top); g.lineTo(at, frame.bottom); g.stroke();
  g.setLineDash([]);
}

// A line through rows i to j. Where many share a pixel it goes from their least to their largest value: of upright
// rectangles a picture takes a tenth of the time that a line takes which goes up and down.
function traceLine(g, frame, series, xs, factor, i, j) {
  const { low, high } = series.levels[0], single = low === high, last = xs.length - 1, thick = g.lineWidth;
  g.fillStyle = g.strokeStyle;
  g.beginPath();
  for (let m = i, before = -1, n; m < j; m = n) {
    n = m + 1;
    if (low[m] !== low[m]) { before = -1; continue; }
    const from = frame.x(xs[m]);
    let least = low[m], most = high[m], to;
    while ((to = frame.x(xs[Math.min(n, last)])) - from < 1 && n < j) {
      if (low[n] < least) least = low[n];
      if (high[n] > most) most = high[n];
      n++;
    }
    if (before >= 0) { least = Math.min(least, high[before]); most = Math.max(most, low[before]); }
    if (!single || n > m + 1) {
      const top = frame.y(most * factor), wide = Math.max(to - from, thick);
      g.fillRect(0.5 * (from + to - wide), top - 0.5 * thick, wide, frame.y(least * factor) - top + thick);
    }
    const lined = single && n < j && low[n] === low[n] && to - from > 1;
    if (lined) {
      g.moveTo(n > m + 1 ? to - 1 : from, frame.y(low[n - 1] * factor));
      g.lineTo(to, frame.y(low[n] * factor));
    }
    before = lined ? -1 : n - 1;
  }
  g.stroke();
}

function save(name, url) {
  const link = document.createElement("a");
  link.href = url; link.download = name; link.click();
}

// A canvas with its title, on paper, as PNG.
function savePicture(canvas, title) {
  const scale = window.devicePixelRatio || 1, head = Math.round(24 * scale), made = document.createElement("canvas");
  made.width = canvas.width; made.height = canvas.height + head;
  const g = made.getContext("2d");
  g.fillStyle = color("paper"); g.fillRect(0, 0, made.width, made.height);
  g.fillStyle = color("ink"); g.font = 13 * scale + "px system-ui, sans-serif"; g.textBaseline = "middle";
  g.fillText(title, 8 * scale, head / 2);
  g.drawImage(canvas, 0, head);
  save(title.replace(/\W+/g, "_") + ".png", made.toDataURL("image/png"));
}

// "name (unit)", of a variable.
function label(name, variable) { return name + (variable.unit ? " (" + variable.unit + ")" : ""); }
