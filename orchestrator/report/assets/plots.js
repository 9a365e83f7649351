// Plots over time: one canvas for each, with a common view and a common instant.
"use strict";

const MARGIN = { left: 68, right: 12, top: 8, bottom: 36 };

function color(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); }

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

function prepare(canvas) {
  const scale = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
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

function drawAxes(g, frame, x, y, label) {
  g.strokeStyle = color("line"); g.fillStyle = color("soft"); g.lineWidth = 1;
  g.textAlign = "right"; g.textBaseline = "middle";
  for (const v of ticks(...y, 6)) {
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
}

// The frame of a plot: pixels of x and y.
function makeFrame(width, height, x, y) {
  const f = { left: MARGIN.left, right: width - MARGIN.right, top: MARGIN.top, bottom: height - MARGIN.bottom };
  f.x = (v) => f.left + (v - x[0]) / (x[1] - x[0]) * (f.right - f.left);
  f.y = (v) => f.bottom - (v - y[0]) / (y[1] - y[0]) * (f.bottom - f.top);
  return f;
}

// A line through rows i to j; where many rows share a pixel, their least and largest values.
function traceLine(g, frame, series, xs, factor, i, j) {
  let k = 0;
  while (Math.pow(FOLD, k) * 2 * (frame.right - frame.left) < j - i) k++;
  const f = Math.pow(FOLD, k), { low, high } = series.level(k), last = xs.length - 1;
  g.beginPath();
  let down = false, before = 0;
  for (let m = Math.floor(i / f), end = Math.min(Math.ceil((j + 1) / f), low.length); m < end; m++) {
    if (low[m] !== low[m]) { down = false; continue; }
    // From the end that is nearer to where the line comes from.
    const falls = Math.abs(high[m] - before) < Math.abs(low[m] - before);
    const at = frame.x(xs[Math.min(m * f, last)]), first = falls ? high[m] : low[m];
    before = falls ? low[m] : high[m];
    if (down) g.lineTo(at, frame.y(first * factor)); else g.moveTo(at, frame.y(first * factor));
    if (before !== first) g.lineTo(at, frame.y(before * factor));
    down = true;
  }
  g.stroke();
}

// What all plots share: the abscissa, the part of it that is shown, the instant.
class View {
  constructor(records) { this.records = records; this.name = ""; this.listeners = []; }

  async over(name) {
    const base = this.records.bases[0];
    this.name = name;
    this.unit = name ? this.records.variables.get(name).unit : this.timeUnit(base);
    const series = name ? await this.records.series(name) : null;
    const factor = name ? this.records.variables.get(name).factor : this.timeFactor;
    this.xs = Float64Array.from(base.times, (t, i) => factor * (series ? series.at(i) : t));
    this.whole = [this.xs[0], this.xs[this.xs.length - 1]];
    if (!(this.whole[1] > this.whole[0])) this.whole[1] = this.whole[0] + 1;
    this.shown = [...this.whole];
    this.tell();
  }

  timeUnit(base) {
    const span = base.end - base.times[0];
    const [unit, factor] = span < 1e-3 ? ["us", 1e6] : span < 1 ? ["ms", 1e3] : ["s", 1];
    this.timeFactor = factor;
    return unit;
  }

  label() { return (this.name || "time") + (this.unit ? " (" + this.unit + ")" : ""); }

  // The numbers of a base's rows along the abscissa; other bases only have time.
  along(base) {
    if (base === 0) return this.xs;
    const b = this.records.bases[base], first = this.records.bases[0];
    if (!b.along || b.alongName !== this.name) {
      b.alongName = this.name;
      b.along = Float64Array.from(b.times, (t) => {
        const i = Math.min(locate(first.times, t), first.times.length - 2), span = first.times[i + 1] - first.times[i];
        const share = span > 0 ? (t - first.times[i]) / span : 0;
        return this.xs[i] + share * (this.xs[i + 1] - this.xs[i]);
      });
    }
    return b.along;
  }

  zoom(center, f) {
    const [a, b] = this.shown, [lo, hi] = this.whole, least = (hi - lo) * 1e-6;
    let x0 = center - (center - a) * f, x1 = center + (b - center) * f;
    if (x1 - x0 < least) return;
    this.shown = [Math.max(lo, x0), Math.min(hi, x1)];
    this.tell();
  }

  move(by) {
    const [a, b] = this.shown, [lo, hi] = this.whole, d = Math.max(lo - a, Math.min(hi - b, by));
    this.shown = [a + d, b + d];
    this.tell();
  }

  reset() { this.shown = [...this.whole]; this.tell(); }

  tell() { for (const one of this.listeners) one(); }
}

class Panel {
  constructor(report, name) {
    this.report = report; this.view = report.view; this.records = report.records;
    this.root = document.createElement("div"); this.root.className = "panel";
    this.root.innerHTML = '<div class="bar"><select aria-label="Variable"></select>' +
      '<label><input type="checkbox"> error</label><button type="button">PNG</button>' +
      '<button type="button" aria-label="Remove this plot">×</button><span class="reading"></span></div>' +
      '<canvas role="img"></canvas>';
    [this.choice] = this.root.getElementsByTagName("select");
    [this.wantsError] = this.root.getElementsByTagName("input");
    [this.canvas] = this.root.getElementsByTagName("canvas");
    [this.reading] = this.root.getElementsByClassName("reading");
    fillChoice(this.choice, this.records.variables, name);
    this.choice.onchange = this.wantsError.onchange = () => this.load();
    const [png, remove] = this.root.getElementsByTagName("button");
    png.onclick = () => save(this.name.replace(/\W+/g, "_") + ".png", this.canvas.toDataURL("image/png"));
    remove.onclick = () => report.remove(this);
    this.listen();
    this.load();
  }

  async load() {
    this.name = this.choice.value;
    const v = this.variable = this.records.variables.get(this.name);
    this.root.querySelector("label").hidden = !v.data.error;
    this.error = v.data.error ? await this.records.series(this.name, "error") : null;
    this.values = await this.records.series(this.name);
    const dot = v.name.lastIndexOf(".");
    const load = dot > 0 ? v.name.slice(0, dot) + ".load" : "";
    this.lost = v.group === "coupled" && this.records.variables.has(load) ? await this.records.series(load) : null;
    this.choice.title = v.description;
    this.canvas.setAttribute("aria-label", this.name + ": " + v.description);
    this.draw();
  }

  draw() {
    if (!this.values || !this.view.xs) return;
    const { g, width, height } = prepare(this.canvas), v = this.variable, x = this.view.shown;
    const xs = this.view.along(v.base), i = Math.max(locate(xs, x[0]) - 1, 0), j = Math.min(locate(xs, x[1]) + 2, xs.length);
    const shown = this.wantsError.checked && this.error ? this.error : this.values;
    let [least, most] = shown.range(i, j).map((n) => n * v.factor);
    if (!(most > least)) { const d = Math.abs(least) * 1e-3 || 1e-12; least -= d; most += d; }
    const pad = 0.06 * (most - least), y = [least - pad, most + pad];
    const frame = this.frame = makeFrame(width, height, x, y);
    drawAxes(g, frame, x, y, this.view.label());
    g.save();
    g.beginPath(); g.rect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top); g.clip();
    if (this.lost) this.shade(g, frame, xs, i, j);
    g.lineWidth = 1.5;
    if (shown === this.values && this.error && this.records.bases[v.base].stretch === 1) {
      g.strokeStyle = color("reference"); g.lineWidth = 3.2;
      traceLine(g, frame, this.reference(), xs, v.factor, i, j);
      g.lineWidth = 1.4;
    }
    g.strokeStyle = color(shown === this.error ? "error" : "coupled");
    traceLine(g, frame, shown, xs, v.factor, i, j);
    g.restore();
    this.drawNow(g, frame, xs, shown);
  }

  reference() {
    if (!this.ownReference || this.ownReference.of !== this.values) {
      const a = this.values.levels[0].low, b = this.error.levels[0].low;
      const values = Float32Array.from(a, (n, i) => n - b[i]);
      this.ownReference = new Series(values, values);
      this.ownReference.of = this.values;
    }
    return this.ownReference;
  }

  // Where the contact of this variable carries no load.
  shade(g, frame, xs, i, j) {
    g.fillStyle = color("shade");
    const load = this.lost.levels[0].high, step = Math.max(1, Math.floor((j - i) / 4000));
    let begin = -1;
    for (let m = i; m < j; m += step) {
      const open = load[m] <= 0;
      if (open && begin < 0) begin = m;
      if ((!open || m + step >= j) && begin >= 0) {
        g.fillRect(frame.x(xs[begin]), frame.top, Math.max(1, frame.x(xs[m]) - frame.x(xs[begin])), frame.bottom - frame.top);
        begin = -1;
      }
    }
  }

  drawNow(g, frame, xs, shown) {
    const v = this.variable, i = this.report.row(v.base), at = frame.x(this.view.along(v.base)[i]);
    if (at >= frame.left && at <= frame.right) {
      g.strokeStyle = color("now"); g.lineWidth = 1;
      g.beginPath(); g.moveTo(at, frame.top); g.lineTo(at, frame.bottom); g.stroke();
    }
    const unit = v.unit ? " " + v.unit : "", value = this.values.at(i);
    let text = v.choices.length && Number.isInteger(value) ? v.choices[value] || String(value) : readable(value * v.factor) + unit;
    if (this.error) text += ", error " + readable(this.error.at(i) * v.factor) + unit;
    this.reading.textContent = text;
  }

  listen() {
    const c = this.canvas;
    const value = (e) => {
      const f = this.frame, [a, b] = this.view.shown, r = c.getBoundingClientRect();
      return a + (e.clientX - r.left - f.left) / (f.right - f.left) * (b - a);
    };
    c.addEventListener("wheel", (e) => { e.preventDefault(); this.view.zoom(value(e), e.deltaY > 0 ? 1.25 : 0.8); }, { passive: false });
    c.ondblclick = () => this.view.reset();
    let from = null, moved = false;
    c.onpointerdown = (e) => { c.setPointerCapture(e.pointerId); from = value(e); moved = false; };
    c.onpointermove = (e) => {
      if (from === null) return;
      const by = from - value(e);
      if (Math.abs(by) > 0.003 * (this.view.shown[1] - this.view.shown[0])) { moved = true; this.view.move(by); from = value(e); }
    };
    c.onpointerup = (e) => { if (from !== null && !moved) this.report.goTo(value(e)); from = null; };
  }
}

function fillChoice(select, variables, chosen) {
  const groups = new Map();
  for (const [key, v] of variables) {
    const dot = v.name.indexOf("."), group = v.group !== "coupled" ? v.group : dot > 0 ? v.name.slice(0, dot) : "";
    if (!groups.has(group)) {
      const made = document.createElement("optgroup"); made.label = group;
      groups.set(group, made); select.append(made);
    }
    const option = document.createElement("option");
    option.value = key; option.textContent = key; option.title = v.description;
    groups.get(group).append(option);
  }
  if (chosen !== undefined) select.value = chosen;
}

function save(name, url) {
  const link = document.createElement("a");
  link.href = url; link.download = name; link.click();
}
