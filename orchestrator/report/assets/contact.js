// A lubricated contact, enlarged: gap of two elastic bodies and the pressure of Hertz between them.
"use strict";

class Contact {
  constructor(names, values) {
    this.names = names; this.values = values;
    this.root = document.createElement("figure");
    this.root.className = "contact";
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.caption = document.createElement("figcaption");
    this.root.append(this.canvas, this.caption);
  }

  start() {
    const most = (key) => { const s = this.values.get(this.names[key]); return s ? s.range(0, s.levels[0].low.length)[1] : 0; };
    this.width = Math.max(most("half_width"), 1e-6);
    this.pressure = Math.max(most("maximum_pressure"), 1);
    const film = this.values.get(this.names.film_thickness), load = this.values.get(this.names.load);
    const loaded = Array.from(film.levels[0].low).filter((h, i) => load.at(i) > 0 && h > 0).sort((a, b) => a - b);
    this.film = loaded.length ? loaded[Math.floor(0.95 * (loaded.length - 1))] : 1e-6;
  }

  // Hertz: outside of the contact the gap grows by b^2/(2 R) (s sqrt(s^2 - 1) - arcosh s), s = |x|/b.
  gap(x, h, b, radius) {
    const s = Math.abs(x) / b;
    if (b <= 0) return h + x * x / (2 * radius);
    return s <= 1 ? h : h + b * b / (2 * radius) * (s * Math.sqrt(s * s - 1) - Math.acosh(s));
  }

  draw(row) {
    const value = (key) => { const s = this.values.get(this.names[key]); return s ? s.at(row) : 0; };
    const { g, width, height } = prepare(this.canvas), load = value("load");
    const b = load > 0 ? value("half_width") : 0, h = Math.max(value("film_thickness"), 0), p = load > 0 ? value("maximum_pressure") : 0;
    const radius = this.names.radius ? Math.abs(value("radius")) || 0.02 : 0.02, span = 2.2 * this.width;
    const tall = 3.2 * this.film, middle = 0.74 * height, up = 0.3 * height / tall;
    const x = (v) => width / 2 + v / span * width / 2, y = (v) => middle - Math.min(v, 3.4 * tall) * up;
    g.fillStyle = color("metal");
    g.beginPath(); g.moveTo(0, height); g.lineTo(0, middle); g.lineTo(width, middle); g.lineTo(width, height); g.fill();
    g.fillStyle = color("cam");
    g.beginPath(); g.moveTo(0, 0);
    for (let k = 0; k <= 160; k++) { const v = span * (k / 80 - 1); g.lineTo(x(v), y(this.gap(v, h, b, radius))); }
    g.lineTo(width, 0); g.fill();
    if (p > 0) {
      g.strokeStyle = color("error"); g.lineWidth = 2;
      g.beginPath();
      for (let k = 0; k <= 80; k++) {
        const s = k / 40 - 1, at = 0.5 * height * p / this.pressure * Math.sqrt(Math.max(0, 1 - s * s));
        g[k ? "lineTo" : "moveTo"](x(s * b), middle - 6 - at);
      }
      g.stroke();
    }
    this.caption.textContent = this.names.title + (load > 0
      ? ": load " + readable(load) + " N, film " + readable(1e6 * h) + " um, pressure " + readable(1e-9 * p) + " GPa, width " + readable(2e3 * b) + " mm"
      : ": no load, gap " + readable(1e6 * h) + " um") + "; heights enlarged";
  }
}
