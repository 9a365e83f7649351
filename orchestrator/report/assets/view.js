// What all plots share: the abscissa, the part of it that is shown, and where the pointer is.
"use strict";

// Values are rounded: equal ones in a row get their places between the next two, by time.
function separate(xs, times) {
  for (let i = 0, j; i < xs.length - 1; i = j) {
    for (j = i + 1; j < xs.length - 1 && xs[j] === xs[i]; j++);
    for (let k = i + 1; k < j; k++) xs[k] = xs[i] + (xs[j] - xs[i]) * (times[k] - times[i]) / (times[j] - times[i]);
  }
}

class View {
  constructor(records) { this.records = records; this.name = ""; this.pointer = null; this.listeners = []; }

  async over(name) {
    const base = this.records.bases[0];
    this.name = name;
    const unit = this.timeUnit(base);
    this.unit = name ? this.records.variables.get(name).unit : unit;
    const series = name ? await this.records.series(name) : null;
    const factor = name ? this.records.variables.get(name).factor : this.timeFactor;
    this.xs = Float64Array.from(base.times, (t, i) => factor * (series ? series.at(i) : t));
    this.falls = this.xs[this.xs.length - 1] < this.xs[0];
    if (this.falls) this.xs = this.xs.map((x) => -x);
    if (name) separate(this.xs, base.times);
    this.whole = [this.xs[0], this.xs[this.xs.length - 1]];
    if (!(this.whole[1] > this.whole[0])) this.whole[1] = this.whole[0] + 1;
    this.shown = [...this.whole];
    this.tell();
  }

  timeUnit(base) {
    const span = base.end - base.times[0];
    const [unit, factor] = span < 1e-3 ? ["µs", 1e6] : span < 1 ? ["ms", 1e3] : ["s", 1];
    this.timeFactor = factor;
    return unit;
  }

  // Whether the abscissa can take the place of time.
  get rises() { return this.xs.every((x, i) => i === 0 || x >= this.xs[i - 1]) && this.xs[this.xs.length - 1] > this.xs[0]; }

  label() {
    const name = this.name ? (this.name.includes(".") ? this.name : this.name.replace(/_/g, " ")) : "time";
    return (this.falls ? "−" : "") + name + (this.unit ? " (" + this.unit + ")" : "");
  }

  // The numbers of a base's rows along the abscissa; other bases only have time.
  along(base) {
    if (base === 0) return this.xs;
    const b = this.records.bases[base];
    if (b.alongOf !== this.xs) {
      b.alongOf = this.xs;
      b.along = this.name ? Float64Array.from(b.times, (t) => this.at(t)) : b.times.map((t) => this.timeFactor * t);
    }
    return b.along;
  }

  // The abscissa at an instant.
  at(t) {
    const times = this.records.bases[0].times, i = Math.min(locate(times, t), times.length - 2);
    if (i < 0) return this.xs[0];
    const span = times[i + 1] - times[i];
    return this.xs[i] + (span > 0 ? (t - times[i]) / span : 0) * (this.xs[i + 1] - this.xs[i]);
  }

  // The rows of a base that are shown, with one beyond each end.
  rows(base) {
    const xs = this.along(base), [a, b] = this.shown;
    return [Math.max(locate(xs, a) - 1, 0), Math.min(locate(xs, b) + 2, xs.length)];
  }

  zoom(center, f) {
    const [a, b] = this.shown, [lo, hi] = this.whole, least = (hi - lo) * 1e-6;
    const x0 = center - (center - a) * f, x1 = center + (b - center) * f;
    if (x1 - x0 < least) return;
    this.shown = [Math.max(lo, x0), Math.min(hi, x1)];
    this.tell();
  }

  move(by) {
    const [a, b] = this.shown, [lo, hi] = this.whole, d = Math.max(lo - a, Math.min(hi - b, by));
    this.shown = [a + d, b + d];
    this.tell();
  }

  // The shares of the whole from and to which is shown.
  get part() { return this.shown.map((x) => (x - this.whole[0]) / (this.whole[1] - this.whole[0])); }
  set part(shares) { this.shown = shares.map((s) => this.whole[0] + s * (this.whole[1] - this.whole[0])); this.tell(); }

  point(x) { this.pointer = x; this.tell(); }

  reset() { this.shown = [...this.whole]; this.tell(); }

  tell() { for (const one of this.listeners) one(); }

  // Zoom, move, pointer and keys of a canvas; `frame()` is that of its last picture, `go(x)` its click.
  listen(canvas, frame, go) {
    const value = (e) => {
      const f = frame(), [a, b] = this.shown;
      return a + (e.clientX - canvas.getBoundingClientRect().left - f.left) / (f.right - f.left) * (b - a);
    };
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.zoom(value(e), e.deltaY > 0 ? 1.25 : 0.8); }, { passive: false });
    canvas.ondblclick = () => this.reset();
    let from = null, moved = false;
    canvas.onpointerdown = (e) => { canvas.setPointerCapture(e.pointerId); from = value(e); moved = false; };
    canvas.onpointermove = (e) => {
      if (from === null) { this.point(value(e)); return; }
      const by = from - value(e);
      if (Math.abs(by) > 0.003 * (this.shown[1] - this.shown[0])) { moved = true; this.move(by); from = value(e); }
    };
    canvas.onpointerup = (e) => { if (from !== null && !moved) go(value(e)); from = null; };
    canvas.onpointercancel = () => { from = null; };
    canvas.onpointerleave = () => this.point(null);
  }
}
