// A plot of one variable over another, of what the other plots show.
"use strict";

class Phase {
  constructor(report) {
    this.report = report; this.records = report.records; this.view = report.view;
    this.canvas = get("phase"); this.x = get("phase-x"); this.y = get("phase-y");
    const coupled = new Map([...this.records.variables].filter(([, v]) => v.base === 0)), names = [...coupled.keys()];
    const pick = (endings, other) => names.find((name) => endings.some((one) => name.endsWith(one))) || other;
    fillChoice(this.x, coupled, pick([".position", ".piston_offset", ".psi"], names[0]));
    fillChoice(this.y, coupled, pick([".velocity", ".piston_offset_rate", ".psi_rate"], names[1] || names[0]));
    this.x.onchange = this.y.onchange = () => this.load();
    document.getElementById("phase-png").onclick = () => savePicture(this.canvas, this.y.value + " over " + this.x.value);
    this.load();
  }

  async load() {
    this.series = await Promise.all([this.x, this.y].map((one) => this.records.series(one.value)));
    this.report.refresh();
  }

  draw() {
    if (!this.series || !this.series[0] || !this.series[1] || !isSeen(this.canvas.getBoundingClientRect())) return;
    const [a, b] = [this.x, this.y].map((one) => this.records.variables.get(one.value)), [x, y] = this.series;
    const { g, width, height } = prepare(this.canvas), [i, j] = this.view.rows(0);
    const limits = (s, f) => widen(s.range(i, j).map((v) => v * f));
    const xr = limits(x, a.factor), yr = limits(y, b.factor), frame = makeFrame(width, height, xr, yr);
    drawAxes(g, frame, xr, yr, label(this.x.value, a), label(this.y.value, b));
    g.strokeStyle = color("coupled"); g.lineWidth = 1; g.lineJoin = "bevel";
    g.beginPath();
    for (let k = i, step = Math.max(1, Math.floor((j - i) / 3000)); k < j; k += step)
      g[k === i ? "moveTo" : "lineTo"](frame.x(x.at(k) * a.factor), frame.y(y.at(k) * b.factor));
    g.stroke();
    const now = this.report.row(0);
    g.fillStyle = color("now");
    g.beginPath(); g.arc(frame.x(x.at(now) * a.factor), frame.y(y.at(now) * b.factor), 4, 0, 7); g.fill();
  }
}
