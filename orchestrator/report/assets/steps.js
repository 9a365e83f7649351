// Macro steps: how long they were, coloured by what set their length.
"use strict";

class Steps {
  constructor(report, told) {
    this.report = report; this.view = report.view; this.records = report.records; this.told = told;
    this.canvas = document.getElementById("steps"); this.reading = document.getElementById("step");
    this.view.listen(this.canvas, () => this.frame, (x) => report.goTo(x));
    this.kinds = new Map();
    told.kinds.forEach((kind, k) => kind.pairs.forEach((pair) => this.kinds.set(pair.join(), k)));
    const legend = document.getElementById("step-kinds");
    told.kinds.forEach((kind, k) => {
      const chip = document.createElement("i"), words = document.createElement("span");
      chip.style.background = "var(--kind" + k + ")";
      words.textContent = kind.words;
      legend.append(chip, words);
    });
  }

  async start() {
    this.length = await this.records.series("steps: macro_step");
    this.reason = await this.records.series("steps: reason");
    this.source = await this.records.series("steps: source");
  }

  kind(i) { return this.kinds.get(this.reason.at(i) + "," + this.source.at(i)) ?? this.kinds.get(this.reason.at(i) + ",*") ?? 0; }

  draw() {
    if (!this.length || !isSeen(this.canvas.getBoundingClientRect())) return;
    const { g, width, height } = prepare(this.canvas), base = this.told.base, x = this.view.shown;
    const xs = this.view.along(base), [i, j] = this.view.rows(base), [least, most] = this.length.range(i, j);
    const even = most < 1.5 * least, y = even ? [0, 1.5 * most] : [least / 1.6, most * 1.6];
    const frame = this.frame = makeFrame(width, height, x, y, !even);
    drawAxes(g, frame, x, y, this.view.label(), "macro step (s)");
    inside(g, frame, () => this.drawBars(g, frame, xs, i, j));
    const now = locate(this.records.bases[base].times, this.report.now);
    drawUpright(g, frame, this.view.at(this.report.now), "now");
    if (this.view.pointer !== null) drawUpright(g, frame, this.view.pointer, "soft", [4, 3]);
    // A row stands for the step that ends there.
    const at = Math.min(this.view.pointer === null ? now + 1 : locate(xs, this.view.pointer) + 1, xs.length - 1);
    this.reading.textContent = readable(this.length.at(at)) + " s, set by " + this.told.kinds[this.kind(at)].words.replace(/:[^:]*$/, "");
  }

  drawBars(g, frame, xs, i, j) {
    const step = Math.max(1, Math.floor((j - i) / (4 * (frame.right - frame.left)))), { low, high } = this.length.levels[0];
    for (let m = Math.max(i, 1); m < j; m += step) {
      g.fillStyle = color("kind" + this.kind(m));
      const from = frame.x(xs[m - 1]), top = frame.y(high[m]);
      g.fillRect(from, top - 1, Math.max(frame.x(xs[m]) - from, 1.5), Math.max(frame.y(low[m]) - top, 2));
    }
  }
}
