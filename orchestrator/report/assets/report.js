// The page: plots, mechanism and player over one instant.
"use strict";

class Report {
  constructor(content) {
    this.content = content;
    this.records = new Records(content);
    this.view = new View(this.records);
    this.panels = []; this.drawings = [];
    this.now = 0; this.playing = false;
  }

  async start() {
    await this.records.start();
    if (!this.records.bases.length) return;
    this.base = this.records.bases[0];
    const time = this.base.times;
    this.now = time[0];
    await this.view.over("");
    for (const name of this.content.panels) this.add(name);
    await this.startDrawings();
    this.fillControls();
    this.view.listeners.push(() => this.refresh());
    window.addEventListener("resize", () => this.refresh());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.refresh());
    this.setTime(time[0]);
    document.body.dataset.ready = "true";
  }

  async startDrawings() {
    const values = new Map(), sketches = this.content.sketches;
    for (const sketch of sketches) {
      const names = new Set();
      for (const frame of sketch.frames) for (const [name] of [...(frame.turn || []), ...(frame.shift || [])]) names.add(name);
      for (const contact of sketch.contacts) for (const key in contact) if (key !== "title") names.add(contact[key]);
      for (const name of names) if (!values.has(name)) values.set(name, await this.records.series(name));
    }
    const last = this.base.times.length - 1, rows = Array.from({ length: 25 }, (_, k) => Math.round(k * last / 24));
    for (const sketch of sketches) {
      const scene = new Scene(sketch, values);
      document.getElementById("sketches").append(scene.root);
      scene.fit(rows);
      this.drawings.push(scene);
      for (const names of sketch.contacts.slice(0, sketches.length > 2 ? 0 : 2)) {
        const contact = new Contact(names, values);
        document.getElementById("contacts").append(contact.root);
        contact.start();
        this.drawings.push(contact);
      }
    }
  }

  fillControls() {
    const get = (id) => document.getElementById(id);
    const span = this.base.end - this.base.times[0];
    for (const seconds of [5, 10, 20, 60]) {
      const option = document.createElement("option");
      option.value = span / seconds;
      option.textContent = "1 : " + readable(+(seconds / span).toPrecision(2));
      get("speed").append(option);
    }
    get("speed").selectedIndex = 1;
    get("play").onclick = () => this.toggle();
    get("scrub").oninput = (e) => this.setTime(this.base.times[0] + e.target.value * span);
    get("whole").onclick = () => this.view.reset();
    get("add").onclick = () => this.add(this.records.variables.keys().next().value);
    get("csv").onclick = () => this.saveCsv();
    const over = get("abscissa"), time = document.createElement("option");
    time.value = ""; time.textContent = "time"; over.append(time);
    for (const [key, v] of this.records.variables)
      if (v.group === "coupled" && /angle$/.test(v.name) && v.unit === "deg") {
        const option = document.createElement("option");
        option.value = key; option.textContent = key; over.append(option);
      }
    over.onchange = () => this.over(over);
    const y = get("phase-y"), x = get("phase-x"), coupled = new Map([...this.records.variables].filter(([, v]) => v.base === 0));
    const names = [...coupled.keys()];
    const pick = (ending, other) => names.find((name) => name.endsWith(ending)) || other;
    fillChoice(x, coupled, pick(".position", pick(".piston_offset", names[0])));
    fillChoice(y, coupled, pick(".velocity", pick(".psi_rate", names[1] || names[0])));
    x.onchange = y.onchange = () => this.drawPhase();
    const left = this.content.leftOut, stretch = this.base.stretch;
    get("told").textContent = (left ? left + " variables are left out for the size of this page; result.nc has them. " : "") +
      (stretch > 1 ? "Lines show the least and largest values of " + stretch + " rows each. " : "") +
      "Values are rounded to five digits.";
    document.addEventListener("keydown", (e) => this.key(e));
  }

  // Only an angle that rises can take the place of time.
  async over(select) {
    const before = this.view.name;
    await this.view.over(select.value);
    const xs = this.view.xs;
    if (xs.every((v, i) => i === 0 || v > xs[i - 1])) return;
    select.value = before;
    await this.view.over(before);
  }

  add(name) {
    const panel = new Panel(this, name);
    this.panels.push(panel);
    document.getElementById("panels").append(panel.root);
  }

  remove(panel) {
    this.panels = this.panels.filter((one) => one !== panel);
    panel.root.remove();
  }

  // The row of a base at the instant.
  row(base) { return locate(this.records.bases[base].times, this.now); }

  goTo(x) { this.setTime(this.base.times[locate(this.view.xs, x)]); }

  setTime(t) {
    const [first, end] = [this.base.times[0], this.base.end];
    this.now = Math.min(Math.max(t, first), end);
    document.getElementById("scrub").value = (this.now - first) / (end - first || 1);
    const x = this.view.name ? ", " + readable(this.view.xs[this.row(0)]) + " " + this.view.unit : "";
    document.getElementById("now").textContent = readable(this.view.timeFactor * this.now) + " " + this.view.timeUnit(this.base) + x;
    this.refresh();
  }

  refresh() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      const began = performance.now(), row = this.row(0);
      for (const one of this.drawings) one.draw(row);
      for (const one of this.panels) one.draw();
      this.drawPhase();
      this.drawTime = performance.now() - began;
    });
  }

  async drawPhase() {
    const canvas = document.getElementById("phase");
    const names = ["phase-x", "phase-y"].map((id) => document.getElementById(id).value);
    if (!names[0] || !names[1]) return;
    const [a, b] = [this.records.variables.get(names[0]), this.records.variables.get(names[1])];
    const [x, y] = [await this.records.series(names[0]), await this.records.series(names[1])];
    const { g, width, height } = prepare(canvas), [s0, s1] = this.view.shown;
    const i = locate(this.view.xs, s0), j = Math.min(locate(this.view.xs, s1) + 1, this.view.xs.length);
    const limits = (s, f) => { let [p, q] = s.range(i, j).map((v) => v * f); if (!(q > p)) { p -= 1e-9; q += 1e-9; } const d = 0.05 * (q - p); return [p - d, q + d]; };
    const xr = limits(x, a.factor), yr = limits(y, b.factor), frame = makeFrame(width, height, xr, yr);
    drawAxes(g, frame, xr, yr, names[0] + (a.unit ? " (" + a.unit + ")" : ""));
    g.strokeStyle = color("coupled"); g.lineWidth = 1;
    g.beginPath();
    const step = Math.max(1, Math.floor((j - i) / 6000));
    for (let k = i; k < j; k += step) g[k === i ? "moveTo" : "lineTo"](frame.x(x.at(k) * a.factor), frame.y(y.at(k) * b.factor));
    g.stroke();
    const now = this.row(0);
    g.fillStyle = color("now");
    g.beginPath(); g.arc(frame.x(x.at(now) * a.factor), frame.y(y.at(now) * b.factor), 4, 0, 7); g.fill();
  }

  toggle() {
    this.playing = !this.playing;
    const button = document.getElementById("play");
    button.textContent = this.playing ? "Stop" : "Play";
    button.setAttribute("aria-pressed", String(this.playing));
    if (this.playing) { this.last = performance.now(); requestAnimationFrame((t) => this.step(t)); }
  }

  step(t) {
    if (!this.playing) return;
    const passed = Math.max(0, t - this.last) / 1000;
    this.last = t;
    let next = this.now + passed * document.getElementById("speed").value;
    if (next > this.base.end) next = this.base.times[0];
    this.setTime(next);
    requestAnimationFrame((later) => this.step(later));
  }

  key(e) {
    if (/^(SELECT|INPUT|BUTTON|SUMMARY)$/.test(e.target.tagName) && e.target.id !== "scrub") return;
    const times = this.base.times, row = this.row(0), hop = e.shiftKey ? Math.ceil(times.length / 100) : 1;
    const actions = {
      " ": () => this.toggle(),
      ArrowRight: () => this.setTime(times[Math.min(row + hop, times.length - 1)]),
      ArrowLeft: () => this.setTime(times[Math.max(row - hop, 0)]),
      Home: () => { this.view.reset(); this.setTime(times[0]); },
      "+": () => this.view.zoom(this.view.xs[row], 0.5),
      "-": () => this.view.zoom(this.view.xs[row], 2),
    };
    if (actions[e.key]) { e.preventDefault(); actions[e.key](); }
  }

  // The rows that are shown, of all variables in plots.
  saveCsv() {
    const panels = this.panels.filter((one) => one.variable.base === 0), [a, b] = this.view.shown;
    const quote = (text) => '"' + text.replace(/"/g, '""') + '"';
    const lines = [["time [s]", ...panels.map((one) => one.name + (one.variable.unit ? " [" + one.variable.unit + "]" : ""))].map(quote).join(",")];
    const i = locate(this.view.xs, a), j = locate(this.view.xs, b);
    for (let k = i; k <= j; k++)
      lines.push([this.base.times[k], ...panels.map((one) => +(one.values.at(k) * one.variable.factor).toPrecision(6))].join(","));
    save("plots.csv", URL.createObjectURL(new Blob([lines.join("\n") + "\n"], { type: "text/csv" })));
  }
}

window.report = new Report(JSON.parse(document.getElementById("data").textContent));
window.report.start();
