// A plot of one variable: coupled run, reference, or its error.
"use strict";

// Digits of a value that are read: those of every row are stored to 1/16384 of their range.
const KNOWN = 4;

class Panel {
  constructor(report, name) {
    this.report = report; this.view = report.view; this.records = report.records;
    this.root = document.createElement("div"); this.root.className = "panel";
    this.root.innerHTML = '<div class="bar"><select aria-label="Variable of this plot"></select>' +
      '<label><input type="checkbox"> error</label><button type="button" aria-label="Save this plot as PNG">PNG</button>' +
      '<button type="button" aria-label="Remove this plot">×</button><span class="reading"></span></div>' +
      '<canvas role="img" tabindex="0"></canvas>';
    this.choice = this.root.querySelector("select");
    this.wantsError = this.root.querySelector("input");
    this.canvas = this.root.querySelector("canvas");
    this.reading = this.root.querySelector(".reading");
    this.back = document.createElement("canvas");
    fillChoice(this.choice, this.records.variables, name);
    this.choice.onchange = this.wantsError.onchange = () => this.load();
    const [png, remove] = this.root.getElementsByTagName("button");
    png.onclick = () => savePicture(this.canvas, label(this.name, this.variable) + (this.shown === this.error ? ", error" : ""));
    remove.onclick = () => report.remove(this);
    this.view.listen(this.canvas, () => this.frame, (x) => report.goTo(x));
    this.load();
  }

  async load() {
    const name = this.choice.value, v = this.records.variables.get(name);
    const [values, error] = [await this.records.series(name), v.data.error ? await this.records.series(name, "error") : null];
    if (name !== this.choice.value) return;
    this.name = name; this.variable = v; this.values = values; this.error = error; this.detail = null;
    this.root.querySelector("label").hidden = !error;
    this.choice.title = v.description;
    this.canvas.setAttribute("aria-label", "Plot of " + name + ": " + v.description);
    this.part = v.group === "coupled" ? v.name.slice(0, v.name.lastIndexOf(".")) : "";
    this.key = null;
    this.report.refresh();
    if (v.data.detail) requestIdleCallback(() => this.loadDetail(name));
  }

  // Unpacked before it is needed, as that takes longer than a picture may.
  async loadDetail(name) {
    const found = await this.records.series(name, "detail");
    found.range(0, found.levels[0].low.length);
    if (name !== this.name) return;
    this.detail = found;
    this.view.along(this.variable.detailBase);
    this.key = null;
    this.report.refresh();
  }

  draw() {
    const box = this.canvas.getBoundingClientRect(), v = this.variable;
    if (!this.values || !this.view.xs || !isSeen(box)) return;
    // Only what moves is drawn anew while the rest stays.
    const key = [box.width, box.height, ...this.view.shown, this.view.name, this.wantsError.checked, this.report.edition].join();
    if (key !== this.key) { this.key = key; this.drawBack(box); }
    const { g } = prepare(this.canvas, box);
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.drawImage(this.back, 0, 0);
    const scale = window.devicePixelRatio || 1;
    g.setTransform(scale, 0, 0, scale, 0, 0);
    const i = this.report.row(v.base), xs = this.view.along(v.base);
    drawUpright(g, this.frame, xs[i], "now");
    if (this.view.pointer !== null) drawUpright(g, this.frame, this.view.pointer, "soft", [4, 3]);
    this.read(this.view.pointer === null ? i : locate(xs, this.view.pointer));
  }

  drawBack(box) {
    const { g, width, height } = prepare(this.back, box), v = this.variable, x = this.view.shown;
    this.shown = this.wantsError.checked && this.error ? this.error : this.values;
    let [series, base] = [this.shown, v.base], [i, j] = this.view.rows(base);
    const detail = this.findDetail(j - i, width);
    if (detail) { [series, base] = [detail, v.detailBase]; [i, j] = this.view.rows(base); }
    const xs = this.view.along(base), y = widen(series.range(i, j).map((n) => n * v.factor));
    const frame = this.frame = makeFrame(width, height, x, y);
    drawAxes(g, frame, x, y, this.view.label(), label((this.shown === this.error ? "error of " : "") + this.name, v));
    inside(g, frame, () => {
      this.report.marks.draw(g, frame, this.view, this.part);
      if (this.shown === this.values && this.error && this.records.bases[v.base].stretch === 1) {
        g.strokeStyle = color("reference"); g.lineWidth = 3.2;
        traceLine(g, frame, this.reference(), xs, v.factor, i, j);
      }
      g.lineWidth = 1.4;
      g.strokeStyle = color(this.shown === this.error ? "error" : "coupled");
      traceLine(g, frame, series, xs, v.factor, i, j);
    });
  }

  // Every row, where stretches of rows are wider than a pixel.
  findDetail(rows, width) { return this.detail && this.shown === this.values && rows <= width ? this.detail : null; }

  reference() {
    if (this.referenceOf !== this.values) {
      const a = this.values.levels[0].low, b = this.error.levels[0].low;
      const values = Float32Array.from(a, (n, i) => n - b[i]);
      this.ownReference = new Series(values, values);
      this.referenceOf = this.values;
    }
    return this.ownReference;
  }

  // The numbers at a row, in words.
  read(i) {
    const v = this.variable, unit = v.unit ? " " + v.unit : "", value = this.values.at(i);
    let text = v.choices.length && Number.isInteger(value) ? v.choices[value] || String(value) : readable(+(value * v.factor).toPrecision(KNOWN)) + unit;
    if (Number.isNaN(value)) text = "no contact";
    else if (this.error) text += ", error " + readable(this.error.at(i) * v.factor) + unit;
    if (text === this.reading.textContent) return;
    this.reading.textContent = text;
    if (!this.report.playing) this.canvas.setAttribute("aria-label", "Plot of " + this.name + ": " + v.description + "; here " + text);
  }
}

// What is asked for first by part; what else a part has comes behind all of these.
function fillChoice(select, variables, chosen) {
  const groups = new Map();
  for (const [key, v] of variables) {
    const dot = v.name.indexOf("."), more = v.main === false ? ", more" : "";
    const group = v.group !== "coupled" ? v.group : dot > 0 ? v.name.slice(0, dot) + more : "";
    if (!groups.has(group)) {
      const made = document.createElement("optgroup"); made.label = group || "variables";
      groups.set(group, made); select.append(made);
    }
    const option = document.createElement("option");
    option.value = key; option.textContent = key; option.title = v.description;
    groups.get(group).append(option);
  }
  if (chosen !== undefined) select.value = chosen;
}
