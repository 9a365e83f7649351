// A sweep over speed: maps over angle and speed, numbers over speed, and one cycle chosen for the other plots.
"use strict";

// Every variable has a row of values for each speed; series are those of the chosen speed.
class SweepRecords extends Records {
  constructor(content) { super(content); this.sweep = content.sweep; this.chosen = 0; this.wholes = new Map(); }

  async start() { this.choose(0); }

  choose(k) {
    const base = this.bases[0], period = this.sweep.periods[k];
    this.chosen = k;
    base.end = period;
    base.times = Float64Array.from({ length: base.rows }, (_, i) => i * period / (base.rows - 1));
  }

  findLost(mark) { return mark.lost[this.chosen]; }

  async whole(name) {
    const v = this.variables.get(name);
    if (v && !this.wholes.has(name)) this.wholes.set(name, await unpack(v.data.values, Float32Array));
    return v ? this.wholes.get(name) : null;
  }

  async series(name) {
    const all = await this.whole(name), n = this.bases[0].rows;
    if (!all) return null;
    const row = all.subarray(this.chosen * n, (this.chosen + 1) * n);
    return new Series(row, row);
  }
}

class Sweep {
  constructor(report, told) {
    this.report = report; this.records = report.records; this.told = told;
    this.rpm = told.speeds.map((w) => w * 30 / Math.PI);
    this.choice = get("speeds");
    get("pale").hidden = !told.lost.includes(true);
    this.rpm.forEach((n, k) => {
      const option = document.createElement("option");
      option.value = k; option.textContent = readable(+n.toFixed(1)) + " r/min"; this.choice.append(option);
    });
    this.choice.onchange = () => this.choose(+this.choice.value);
    this.views = [...told.maps.map((name) => new AngleSpeedMap(this, name)), ...told.curves.map((name) => new Curve(this, name))];
  }

  async start() {
    this.angles = await this.records.whole(this.told.angle);
    for (const one of this.views) await one.load();
    await this.choose(Math.floor(this.rpm.length / 2));
  }

  // Another speed, at the same share of the cycle.
  async choose(k) {
    const share = this.report.now / (this.report.base.end || 1), view = this.report.view, shown = [...view.shown];
    const whole = view.shown.join() === view.whole.join();
    this.choice.value = k;
    this.records.choose(k);
    await view.over(view.name);
    if (!whole) view.shown = shown;
    await this.report.reload();
    this.report.setTime(share * this.report.base.end);
  }

  // Speed and angle of a click.
  async point(k, angle) { await this.choose(k); this.report.setTime(this.report.base.times[locate(this.report.view.xs, angle)]); }

  nearest(rpm) { return this.rpm.reduce((best, n, k) => Math.abs(n - rpm) < Math.abs(this.rpm[best] - rpm) ? k : best, 0); }

  // Of values that are `rows` to a speed those at speeds with contact: impacts after separation would hide all else.
  kept(values, rows) {
    const { lost } = this.told;
    return lost.includes(false) ? values.filter((_, at) => !lost[Math.floor(at / rows)]) : values;
  }

  // Degrees of the cam at a row of a speed.
  angle(k, i) { return this.angles[k * this.records.bases[0].rows + i] * 180 / Math.PI; }

  draw(row) { for (const one of this.views) one.draw(row); }
}

const SCALE = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"]
  .map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));

// Red, green, blue of a share of the scale; NaN is its begin.
function shade(share) {
  const at = Math.min(Math.max(share || 0, 0), 1) * (SCALE.length - 1), k = Math.min(Math.floor(at), SCALE.length - 2);
  return SCALE[k].map((c, i) => c + (at - k) * (SCALE[k + 1][i] - c));
}

// The frame of a chart with a choice of variables and a button for PNG.
class Chart {
  constructor(parent, variables, name, words) {
    const root = document.createElement("figure");
    root.innerHTML = '<div class="bar"><select></select><button type="button">PNG</button><span class="reading"></span></div>' +
      '<canvas role="img" tabindex="0"></canvas>';
    this.choice = root.querySelector("select"); this.canvas = root.querySelector("canvas");
    this.reading = root.querySelector(".reading"); this.png = root.querySelector("button");
    this.choice.setAttribute("aria-label", "Variable of this " + words);
    this.png.setAttribute("aria-label", "Save this " + words + " as PNG");
    fillChoice(this.choice, variables, name);
    get(parent).append(root);
  }
}

class AngleSpeedMap extends Chart {
  constructor(sweep, name) {
    super("maps", sweep.records.variables, name, "map");
    this.sweep = sweep; this.records = sweep.records;
    this.choice.onchange = () => this.load();
    this.png.onclick = () => savePicture(this.canvas, label(this.choice.value, this.variable) + " over angle and speed");
    this.canvas.onclick = (e) => {
      const box = this.canvas.getBoundingClientRect(), f = this.frame, back = (at, a, b, ends) => ends[0] + (at - a) / (b - a) * (ends[1] - ends[0]);
      const rpm = back(e.clientY - box.top, f.bottom, f.top, this.speeds), k = sweep.nearest(rpm);
      sweep.point(k, back(e.clientX - box.left, f.left, f.right, this.degrees));
    };
    this.canvas.onkeydown = (e) => this.key(e);
  }

  key(e) {
    const by = { ArrowUp: 1, ArrowDown: -1 }[e.key], k = this.records.chosen + by;
    if (!by || !(k >= 0 && k < this.sweep.rpm.length)) return;
    e.preventDefault();
    this.sweep.choose(k);
  }

  async load() {
    this.variable = this.records.variables.get(this.choice.value);
    this.values = await this.records.whole(this.choice.value);
    const sorted = this.sweep.kept(this.values, this.records.bases[0].rows).filter((v) => v === v).sort();
    this.range = [sorted[0], sorted[sorted.length - 1]].map((v) => v * this.variable.factor);
    if (!(this.range[1] > this.range[0])) this.range[1] = this.range[0] + 1e-12;
    this.paint();
    this.sweep.report.refresh();
  }

  // One pixel for each value; where a load is zero or there is no film, none, and faint at speeds at which contact is lost.
  paint() {
    const n = this.records.bases[0].rows, rows = this.sweep.rpm.length, [least, most] = this.range, isLoad = /\.load$/.test(this.variable.name);
    this.picture = document.createElement("canvas");
    this.picture.width = n; this.picture.height = rows;
    const g = this.picture.getContext("2d"), image = g.createImageData(n, rows);
    this.values.forEach((value, at) => {
      const k = Math.floor(at / n), place = 4 * ((rows - 1 - k) * n + at % n);
      const [red, green, blue] = shade((value * this.variable.factor - least) / (most - least));
      image.data.set([red, green, blue, (isLoad && value <= 0) || value !== value ? 0 : this.sweep.told.lost[k] ? 70 : 255], place);
    });
    g.putImageData(image, 0, 0);
  }

  draw(row) {
    if (!this.picture) return;
    const { g, width, height } = prepare(this.canvas), rpm = this.sweep.rpm, n = this.records.bases[0].rows, k = this.records.chosen;
    const half = 0.5 * (rpm[rpm.length - 1] - rpm[0]) / (rpm.length - 1);
    this.degrees = [this.sweep.angle(0, 0), this.sweep.angle(0, n - 1)];
    this.speeds = [rpm[0] - half, rpm[rpm.length - 1] + half];
    const f = this.frame = makeFrame(width - 62, height, this.degrees, this.speeds);
    g.imageSmoothingEnabled = false;
    g.drawImage(this.picture, f.left, f.top, f.right - f.left, f.bottom - f.top);
    this.drawScale(g, f);
    drawAxes(g, f, this.degrees, this.speeds, "cam angle (deg)", "speed (r/min)");
    drawUpright(g, f, this.sweep.angle(k, row), "now");
    g.strokeStyle = color("now");
    g.beginPath(); g.moveTo(f.left, f.y(rpm[k])); g.lineTo(f.right, f.y(rpm[k])); g.stroke();
    const here = this.values[k * n + row] * this.variable.factor;
    const value = Number.isNaN(here) ? "no contact" : readable(here) + (this.variable.unit ? " " + this.variable.unit : "");
    this.reading.textContent = value;
    this.canvas.setAttribute("aria-label", "Map of " + this.choice.value + " over angle and speed; at the chosen speed and angle " + value);
  }

  drawScale(g, f) {
    const x = f.right + 8, tall = f.bottom - f.top;
    for (let at = 0; at < tall; at++) {
      const [red, green, blue] = shade(1 - at / tall);
      g.fillStyle = `rgb(${red},${green},${blue})`; g.fillRect(x, f.top + at, 10, 1.5);
    }
    g.fillStyle = color("soft"); g.textAlign = "left"; g.textBaseline = "middle";
    for (const v of ticks(...this.range, 5))
      g.fillText(readable(v), x + 14, f.bottom - (v - this.range[0]) / (this.range[1] - this.range[0]) * tall);
  }
}

// A number of all cycles over speed.
class Curve extends Chart {
  constructor(sweep, name) {
    const numbers = new Map(sweep.told.numbers.map((one) => [one.name, one]));
    super("curves", numbers, name, "curve");
    this.sweep = sweep; this.numbers = numbers;
    this.choice.onchange = () => { this.load(); sweep.report.refresh(); };
    this.png.onclick = () => savePicture(this.canvas, label(this.choice.value, this.number) + " over speed");
    this.canvas.onclick = (e) => {
      const f = this.frame, share = (e.clientX - this.canvas.getBoundingClientRect().left - f.left) / (f.right - f.left);
      sweep.choose(sweep.nearest(this.x[0] + share * (this.x[1] - this.x[0])));
    };
    this.load();
  }

  load() { this.number = this.numbers.get(this.choice.value); }

  draw() {
    const { g, width, height } = prepare(this.canvas), rpm = this.sweep.rpm, v = this.number;
    const values = v.values.map((one) => one === null ? NaN : one * v.factor), finite = this.sweep.kept(values, 1).filter((one) => one === one);
    const y = widen([Math.min(...finite), Math.max(...finite)]), x = this.x = [rpm[0], rpm[rpm.length - 1]];
    const f = this.frame = makeFrame(width, height, x, y);
    drawAxes(g, f, x, y, "speed (r/min)", label(v.name, v));
    inside(g, f, () => this.trace(g, f, values));
    const k = this.sweep.records.chosen, value = Number.isNaN(values[k]) ? "none" : readable(values[k]) + (v.unit ? " " + v.unit : "");
    drawUpright(g, f, rpm[k], "now");
    this.reading.textContent = value;
    this.canvas.setAttribute("aria-label", v.description + " over speed; at the chosen speed " + value);
  }

  trace(g, f, values) {
    const { rpm, told } = this.sweep, ends = told.edges.map(f.x);
    g.fillStyle = color("shade");
    told.lost.forEach((lost, k) => { if (lost) g.fillRect(ends[k], f.top, ends[k + 1] - ends[k], f.bottom - f.top); });
    g.strokeStyle = g.fillStyle = color("coupled"); g.lineWidth = 1.4;
    g.beginPath();
    let down = false;
    values.forEach((one, k) => { if (one === one) g[down ? "lineTo" : "moveTo"](f.x(rpm[k]), f.y(one)); down = one === one && told.lost[k] === told.lost[k + 1]; });
    g.stroke();
    for (const [k, one] of values.entries()) if (one === one) g.fillRect(f.x(rpm[k]) - 2, f.y(one) - 2, 4, 4);
  }
}
