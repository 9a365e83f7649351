// A lubricated contact, enlarged: gap of two elastic bodies and the pressure between them, as solved where the
// result has that, otherwise of Hertz.
"use strict";

// µm, about the size of an atom: a thinner film is none.
const ATOM = 0.3e-3;

// One contact of all, chosen by name.
class Contacts {
  constructor(report, told) {
    this.all = told.map((one) => new Contact(one, report, (report.content.profiles || {})[one.title]));
    this.root = get("contacts");
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.caption = document.createElement("figcaption");
    this.choice = document.createElement("select");
    this.choice.setAttribute("aria-label", "Contact that is enlarged");
    told.forEach((one, k) => { const option = document.createElement("option"); option.value = k; option.textContent = one.title; this.choice.append(option); });
    this.choice.onchange = () => report.refresh();
    const figure = document.createElement("figure");
    figure.className = "contact";
    figure.append(this.choice, this.canvas, this.caption);
    this.root.append(figure);
  }

  async start() { for (const one of this.all) if (one.profiles) await one.profiles.start(); }

  draw(row) {
    const one = this.all[this.choice.value];
    one.draw(this.canvas, row);
    this.caption.textContent = one.describe(row);
    this.canvas.setAttribute("aria-label", "Contact " + one.told.title + ", enlarged: " + this.caption.textContent);
  }
}

// Pressure and film over the nodes of a contact, at some instants.
class Profiles {
  constructor(packed) { this.packed = packed; this.nodes = packed.nodes; }

  async start() {
    this.times = await unpack(this.packed.time, Float64Array);
    this.position = await unpack(this.packed.position, Float32Array);
    this.pressure = await unpack(this.packed.pressure, Float32Array);
    this.film = await unpack(this.packed.film, Float32Array);
  }

  // The instant nearest to a time.
  near(time) {
    const k = locate(this.times, time), next = Math.min(k + 1, this.times.length - 1);
    return this.times[next] - time < time - this.times[k] ? next : k;
  }

  // The field begins with the first step.
  begun(k) { return this.position[k * this.nodes] < 0; }

  curve(key, k) { return Array.from({ length: this.nodes }, (_, i) => [this.position[k * this.nodes + i], this[key][k * this.nodes + i]]); }
}

class Contact {
  constructor(told, report, packed) {
    this.told = told; this.report = report; this.variables = told.variables;
    this.profiles = packed ? new Profiles(packed) : null;
  }

  // The instant of the solved profiles that is drawn at a row; -1: none.
  solved(row) {
    if (!this.profiles) return -1;
    const k = this.profiles.near(this.report.base.times[row]);
    return this.profiles.begun(k) ? k : -1;
  }

  series(key) { return this.report.values.get(this.variables[key]); }

  value(key, row) { const s = this.series(key); return s ? s.at(row) : 0; }

  // Scales, for all instants alike: widest contact, highest pressure, a thick film under load.
  fit() {
    const load = this.series("load"), film = this.series("film_thickness");
    if (this.fitted === load) return;
    this.fitted = load;
    const most = (key) => { const s = this.series(key); return s ? s.range(0, s.levels[0].low.length)[1] : 0; };
    this.width = Math.max(most("half_width"), 1e-6);
    this.pressure = Math.max(most("maximum_pressure"), this.profiles ? this.profiles.pressure.reduce((a, b) => Math.max(a, b), 0) : 0, 1);
    const loaded = Array.from(film.levels[0].low).filter((h, i) => load.at(i) > 0 && h > 0).sort((a, b) => a - b);
    this.film = loaded.length ? loaded[Math.floor(0.95 * (loaded.length - 1))] : 1e-6;
  }

  // Hertz: outside of the contact the gap grows by b^2/(2 R) (s sqrt(s^2 - 1) - arcosh s), s = |x|/b.
  gap(x, h, b, radius) {
    const s = Math.abs(x) / b;
    if (b <= 0) return h + x * x / (2 * radius);
    return s <= 1 ? h : h + b * b / (2 * radius) * (s * Math.sqrt(s * s - 1) - Math.acosh(s));
  }

  // Curves [x, film] and [x, pressure] at a row.
  curves(row) {
    const solved = this.solved(row);
    if (solved >= 0) return { film: this.profiles.curve("film", solved), pressure: this.profiles.curve("pressure", solved) };
    const load = this.value("load", row), b = load > 0 ? this.value("half_width", row) : 0, span = 2.2 * this.width;
    const h = Math.max(load > 0 ? this.value("film_thickness", row) : this.open(row), 0), radius = Math.abs(this.value("radius", row)) || 0.02;
    const p = load > 0 ? this.value("maximum_pressure", row) : 0;
    const film = Array.from({ length: 161 }, (_, k) => { const x = span * (k / 80 - 1); return [x, this.gap(x, h, b, radius)]; });
    const pressure = p > 0 ? Array.from({ length: 81 }, (_, k) => { const s = k / 40 - 1; return [s * b, p * Math.sqrt(Math.max(0, 1 - s * s))]; }) : [];
    return { film, pressure };
  }

  draw(canvas, row) {
    this.fit();
    const { g, width, height } = prepare(canvas), { film, pressure } = this.curves(row), span = 2.2 * this.width;
    const middle = 0.8 * height, tall = 3.2 * this.film, up = 0.3 * height / tall;
    const x = (v) => width / 2 + v / span * width / 2, y = (v) => middle - Math.min(v, 3.4 * tall) * up;
    const base = 0.72 * height, high = (p) => base - 0.66 * height * p / this.pressure;
    g.fillStyle = color("metal");
    g.fillRect(0, middle, width, height - middle);
    g.fillStyle = color("cam");
    g.beginPath(); g.moveTo(x(film[0][0]), 0);
    for (const [at, h] of film) g.lineTo(x(at), y(h));
    g.lineTo(x(film[film.length - 1][0]), 0); g.fill();
    g.strokeStyle = color("error"); g.fillStyle = color("error"); g.lineWidth = 2;
    g.beginPath();
    pressure.forEach(([at, p], k) => g[k ? "lineTo" : "moveTo"](x(at), high(p)));
    g.stroke();
    this.drawScales(g, width, height, x, high);
  }

  // What a length and the highest pressure of the recorded rows are.
  drawScales(g, width, height, x, high) {
    const long = ticks(0, this.width, 2)[1] || this.width;
    g.fillStyle = g.strokeStyle = color("ink"); g.lineWidth = 1; g.textBaseline = "alphabetic"; g.textAlign = "left";
    g.beginPath(); g.moveTo(10, height - 8); g.lineTo(10 + x(long) - x(0), height - 8); g.stroke();
    g.fillText(readable(1e3 * long) + " mm", 14, height - 12);
    g.setLineDash([2, 4]);
    g.beginPath(); g.moveTo(0, high(this.pressure)); g.lineTo(width, high(this.pressure)); g.stroke();
    g.setLineDash([]);
    g.fillText(readable(1e-6 * this.pressure) + " MPa, the highest recorded", 8, high(this.pressure) + 14);
  }

  // The gap of a contact without load; NaN where the result lacks it. Without retreat the other surface rests.
  open(row) {
    if (!this.variables.approach) return NaN;
    return Math.max((this.variables.retreat ? this.value("retreat", row) : 0) - this.value("approach", row), 0);
  }

  describe(row) {
    const load = this.value("load", row), h = 1e6 * this.value("film_thickness", row), open = 1e6 * this.open(row);
    return (load > 0
      ? "load " + readable(load) + " N, " + (h < ATOM ? "no film" : "film " + readable(h) + " µm") + ", pressure " + readable(1e-6 * this.value("maximum_pressure", row)) +
        " MPa, width " + readable(2e3 * this.value("half_width", row)) + " mm"
      : "no load" + (open === open ? ", gap " + readable(open) + " µm" : "")) + "; " + this.describeSource(row) + ", heights enlarged";
  }

  describeSource(row) {
    const k = this.solved(row);
    return k < 0 ? "gap and pressure of Hertz"
      : "gap and pressure solved by the reference at t = " + readable(1e3 * this.profiles.times[k]) + " ms";
  }
}
