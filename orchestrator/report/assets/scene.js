// Mechanisms: frames that variables turn and shift, and shapes through points of frames (mechanism.py).
"use strict";

const SVG = "http://www.w3.org/2000/svg";

class Scene {
  constructor(sketch, values) {
    this.sketch = sketch; this.values = values;
    this.root = document.createElement("figure");
    const caption = document.createElement("figcaption");
    caption.textContent = sketch.title;
    this.svg = document.createElementNS(SVG, "svg");
    this.svg.setAttribute("role", "img");
    this.svg.setAttribute("aria-label", "Mechanism " + sketch.title);
    this.paths = sketch.shapes.map((shape) => {
      const path = document.createElementNS(SVG, "path");
      path.setAttribute("class", shape.kind);
      path.dataset.title = shape.title;
      if (shape.title) {
        const title = document.createElementNS(SVG, "title");
        title.textContent = shape.title;
        path.append(title);
      }
      this.svg.append(path);
      return path;
    });
    this.root.append(this.svg, caption);
  }

  // Sine, cosine and shift of every frame at a row.
  place(row) {
    return this.sketch.frames.map((frame) => {
      let angle = 0, dx = 0, dy = 0;
      for (const [name, factor] of frame.turn || []) angle += factor * this.value(name, row);
      for (const [name, fx, fy] of frame.shift || []) { const v = this.value(name, row); dx += fx * v; dy += fy * v; }
      return { s: Math.sin(angle), c: Math.cos(angle), about: frame.about || [0, 0], dx, dy };
    });
  }

  value(name, row) { const series = this.values.get(name); return series ? series.at(row) : 0; }

  point(frames, node) {
    const one = (f, x, y) => {
      const p = frames[f], u = x - p.about[0], v = y - p.about[1];
      return [p.about[0] + p.c * u - p.s * v + p.dx, p.about[1] + p.s * u + p.c * v + p.dy];
    };
    if (node.length === 3) return one(...node);
    const [f, other, share, x, y] = node, a = one(f, x, y), b = one(other, x, y);
    return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
  }

  points(row) {
    const frames = this.place(row);
    return this.sketch.shapes.map((shape) => shape.nodes.map((node) => this.point(frames, node)));
  }

  // A wall lights up under force, and for a while after an impact that its counter counts.
  isLit(shape, row) {
    const before = Math.max(0, row - Math.ceil(this.rows / 500));
    return shape.lit.some(([name, counts]) => this.value(name, row) !== (counts ? this.value(name, before) : 0));
  }

  // The view box around the mechanism at several instants.
  fit(rows) {
    this.rows = rows[rows.length - 1] + 1;
    const box = [Infinity, Infinity, -Infinity, -Infinity], sign = this.sketch.mirrored ? 1 : -1;
    for (const row of rows)
      for (const shape of this.points(row))
        for (const [x, y] of shape) {
          box[0] = Math.min(box[0], x); box[2] = Math.max(box[2], x);
          box[1] = Math.min(box[1], sign * y); box[3] = Math.max(box[3], sign * y);
        }
    const pad = 4;
    this.svg.setAttribute("viewBox", [box[0] - pad, box[1] - pad, box[2] - box[0] + 2 * pad, box[3] - box[1] + 2 * pad].join(" "));
  }

  draw(row) {
    const sign = this.sketch.mirrored ? 1 : -1;
    this.points(row).forEach((points, i) => {
      const line = points.map(([x, y]) => x.toFixed(3) + " " + (sign * y).toFixed(3)).join("L");
      const shape = this.sketch.shapes[i];
      this.paths[i].setAttribute("d", "M" + line + (shape.closed ? "Z" : ""));
      if (shape.lit) this.paths[i].classList.toggle("lit", this.isLit(shape, row));
    });
  }
}
