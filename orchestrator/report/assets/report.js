// The page: mechanism, contacts and plots over one instant.
"use strict";

/** @type {(id: string) => any} */
const get = (id) => document.getElementById(id);

class ReportPage {
  constructor(content) {
    this.content = content;
    this.records = content.sweep ? new SweepRecords(content) : content.cycle ? new CycleRecords(content) : new Records(content);
    this.view = new View(this.records);
    this.marks = new Marks(this.records, content.marks || []);
    this.panels = []; this.drawings = []; this.values = new Map();
    this.now = 0; this.playing = false; this.edition = 0; this.rest = 0;
  }

  async start() {
    await this.records.start();
    if (!this.records.bases.length) { document.body.dataset.ready = "true"; return; }
    this.base = this.records.bases[0];
    const time = this.base.times;
    this.now = time[0];
    await this.view.over(this.records.variables.has(this.content.abscissa) ? this.content.abscissa : "");
    if (!this.view.rises) await this.view.over("");
    await this.marks.start();
    for (const name of this.content.panels) this.add(name);
    await this.startDrawings();
    if (this.content.steps) { this.drawings.push(new Steps(this, this.content.steps)); await this.drawings.at(-1).start(); }
    this.phase = new Phase(this);
    this.drawings.push(this.phase);
    if (this.content.sweep) { this.drawings.push(new Sweep(this, this.content.sweep)); await this.drawings.at(-1).start(); }
    if (this.content.cycle) this.drawings.push(new Cycle(this));
    this.fillControls();
    this.view.listeners.push(() => this.refresh());
    for (const change of ["resize", "scroll"]) window.addEventListener(change, () => this.refresh());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recolor());
    // Paper is white.
    window.addEventListener("beforeprint", () => { document.documentElement.classList.add("light"); this.recolor(); this.draw(); });
    window.addEventListener("afterprint", () => { document.documentElement.classList.remove("light"); this.recolor(); });
    this.setTime(time[0]);
    document.body.dataset.ready = "true";
  }

  recolor() { colors.clear(); this.edition++; this.refresh(); }

  async startDrawings() {
    const sketches = this.content.sketches;
    for (const sketch of sketches) {
      for (const frame of sketch.frames) for (const [name] of [...(frame.turn || []), ...(frame.shift || [])]) this.values.set(name, null);
      for (const shape of sketch.shapes) for (const [name] of shape.lit || []) this.values.set(name, null);
      for (const contact of sketch.contacts) for (const name of Object.values(contact.variables)) this.values.set(name, null);
    }
    await this.loadValues();
    const last = this.base.times.length - 1, rows = Array.from({ length: 25 }, (_, k) => Math.round(k * last / 24));
    for (const sketch of sketches) {
      const scene = new Scene(sketch, this.values);
      get("sketches").append(scene.root);
      scene.fit(rows);
      this.drawings.push(scene);
    }
    const contacts = sketches.flatMap((sketch) => sketch.contacts);
    if (contacts.length) { this.drawings.push(new Contacts(this, contacts)); await this.drawings.at(-1).start(); }
  }

  // The same of another cycle.
  async reload() {
    await this.loadValues();
    await this.marks.start();
    await Promise.all([...this.panels, this.phase].map((one) => one.load()));
  }

  async loadValues() { for (const name of this.values.keys()) this.values.set(name, await this.records.series(name)); }

  fillControls() {
    const span = this.base.end - this.base.times[0];
    for (const seconds of [2, 5, 10, 20, 60]) {
      const option = document.createElement("option");
      option.value = String(span / seconds);
      option.textContent = readable(seconds) + " s (1 : " + readable(+(seconds / span).toPrecision(2)) + ")";
      get("speed").append(option);
    }
    get("speed").selectedIndex = 2;
    get("play").onclick = () => this.toggle();
    get("scrub").oninput = (e) => this.setTime(this.timeAt(+e.target.value));
    get("whole").onclick = () => this.view.reset();
    get("add").onclick = () => this.add(this.records.variables.keys().next().value);
    get("csv").onclick = () => this.saveCsv();
    get("before").onclick = () => this.goToEvent(false);
    get("after").onclick = () => this.goToEvent(true);
    get("events").hidden = !this.marks.events.length;
    /** @type {NodeListOf<HTMLButtonElement>} */
    const plotButtons = document.querySelectorAll("button[data-plot]");
    for (const button of plotButtons)
      if (this.records.variables.has(button.dataset.plot)) button.onclick = () => { this.add(button.dataset.plot); get("panels").lastChild.scrollIntoView(); };
      else button.hidden = true;
    const source = get("save-scenario");
    if (source) source.onclick = () => save("scenario.toml", URL.createObjectURL(new Blob([get("scenario").textContent])));
    this.fillAbscissae();
    const left = this.content.leftOut, stretch = this.base.stretch;
    get("told").textContent = (left ? left + " variables are left out for the size of this page; result.nc has them. " : "") +
      (stretch > 1 ? "Lines show the least and largest values of " + stretch + " rows each" + this.tellDetail() + ". " : "") +
      "Values are rounded to five digits." + (this.marks.events.length ? " Landings with less than 1 % of the largest load are not marked." : "");
    document.addEventListener("keydown", (e) => this.key(e));
    // What was clicked keeps no keys to itself; what was reached by the keyboard does.
    let pointed = false;
    document.addEventListener("pointerdown", () => { pointed = true; }, true);
    document.addEventListener("keydown", () => { pointed = false; }, true);
    for (const kind of ["click", "change"]) document.addEventListener(kind, (e) => {
      const at = /** @type {HTMLElement} */ (e.target), tag = at.tagName;
      if (pointed && !at.dataset.slider && (tag === "BUTTON" || tag === "SUMMARY" || kind === "change")) at.blur();
    });
  }

  tellDetail() {
    const names = [...this.records.variables].filter(([, v]) => v.data.detail).map(([name]) => name);
    return names.length ? "; zoomed in, every row of " + names.join(", ") : "";
  }

  fillAbscissae() {
    const over = get("abscissa"), add = (key, text) => {
      const option = document.createElement("option");
      option.value = key; option.textContent = text; over.append(option);
    };
    add("", "time");
    for (const [key, v] of this.records.variables) if (v.group === "coupled" && v.unit === "deg" && /angle$/.test(v.name)) add(key, key);
    over.value = this.view.name;
    over.onchange = () => this.over(over);
  }

  // Only an angle that turns one way can take the place of time.
  async over(select) {
    const before = this.view.name;
    await this.view.over(select.value);
    get("why").textContent = this.view.rises ? "" : select.value + " does not turn one way: it cannot take the place of time.";
    if (!this.view.rises) {
      select.value = before;
      await this.view.over(before);
    }
    this.setTime(this.now);
  }

  add(name) {
    const panel = new Panel(this, name);
    this.panels.push(panel);
    get("panels").append(panel.root);
  }

  remove(panel) {
    this.panels = this.panels.filter((one) => one !== panel);
    panel.root.remove();
  }

  // The row of a base at the instant.
  row(base) { return locate(this.records.bases[base].times, this.now); }

  goTo(x) { this.setTime(this.base.times[locate(this.view.xs, x)]); }

  goToEvent(ahead) {
    const event = this.marks.next(this.now, ahead);
    get("event").textContent = event ? event.part + " " + event.kind : "none";
    if (event) this.setTime(event.time);
  }

  // The scrubber runs over the abscissa: time, or an angle.
  timeAt(share) {
    const [a, b] = this.view.whole;
    return this.view.name ? this.base.times[locate(this.view.xs, a + share * (b - a))] : this.base.times[0] + share * (this.base.end - this.base.times[0]);
  }

  setTime(t) {
    this.now = Math.min(Math.max(t, this.base.times[0]), this.base.end);
    const [a, b] = this.view.whole, digit = Math.pow(10, Math.floor(Math.log10(b - a)) - 5); // values are rounded
    const x = this.view.name ? ", " + readable(Math.round(this.view.at(this.now) / digit) * digit) + " " + this.view.unit : "";
    const text = readable(this.view.timeFactor * this.now) + " " + this.view.timeUnit(this.base) + x;
    get("scrub").value = (this.view.at(this.now) - a) / (b - a);
    get("scrub").setAttribute("aria-valuetext", text);
    get("now").textContent = text;
    this.refresh();
  }

  // What is off the screen follows once nothing changes: a picture of the whole page has it.
  refresh() {
    clearTimeout(this.rest);
    this.rest = setTimeout(() => { drawsAll = !this.playing; this.draw(); drawsAll = false; }, 200);
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.draw(); });
  }

  draw() {
    const began = performance.now(), row = this.row(0);
    for (const one of this.drawings) one.draw(row);
    for (const one of this.panels) one.draw();
    this.drawTime = performance.now() - began;
  }

  toggle() {
    this.playing = !this.playing;
    get("play").textContent = this.playing ? "Stop" : "Play";
    get("play").setAttribute("aria-pressed", String(this.playing));
    get("now").setAttribute("aria-live", this.playing ? "off" : "polite");
    if (this.playing) { this.last = performance.now(); requestAnimationFrame((t) => this.step(t)); }
  }

  step(t) {
    if (!this.playing) return;
    const passed = Math.max(0, t - this.last) / 1000;
    this.last = t;
    let next = this.now + passed * get("speed").value;
    if (next > this.base.end) next = this.base.times[0];
    this.setTime(next);
    requestAnimationFrame((later) => this.step(later));
  }

  key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    if (/^(SELECT|INPUT|BUTTON|SUMMARY)$/.test(e.target.tagName) && e.target.id !== "scrub") return;
    const times = this.base.times, row = this.row(0), hop = e.shiftKey ? Math.ceil(times.length / 100) : 1;
    const span = this.view.shown[1] - this.view.shown[0];
    const actions = {
      " ": () => this.toggle(),
      ArrowRight: () => this.setTime(times[Math.min(row + hop, times.length - 1)]),
      ArrowLeft: () => this.setTime(times[Math.max(row - hop, 0)]),
      Home: () => { this.view.reset(); this.setTime(times[0]); },
      End: () => this.setTime(this.base.end),
      "+": () => this.view.zoom(this.view.xs[row], 0.5),
      "-": () => this.view.zoom(this.view.xs[row], 2),
      "<": () => this.view.move(-0.25 * span),
      ">": () => this.view.move(0.25 * span),
      n: () => this.goToEvent(true),
      p: () => this.goToEvent(false),
    };
    if (actions[e.key]) { e.preventDefault(); actions[e.key](); }
  }

  // The rows that are shown, of all variables in plots, with their reference where there is one.
  saveCsv() {
    const panels = this.panels.filter((one) => one.variable.base === 0), [a, b] = this.view.shown, exact = this.base.stretch === 1;
    const quote = (text) => '"' + text.replace(/"/g, '""') + '"', columns = [];
    for (const one of panels) {
      const unit = one.variable.unit ? " [" + one.variable.unit + "]" : "", factor = one.variable.factor, add = (name, series) =>
        columns.push({ head: name + unit, at: (k) => +(series.at(k) * factor).toPrecision(6) });
      add(one.name, one.values);
      if (!exact) columns.push({ head: one.name + ", largest" + unit, at: (k) => +(one.values.levels[0].high[k] * factor).toPrecision(6) });
      if (exact && one.error) add(one.name + ", reference", one.reference());
    }
    if (this.view.name) columns.push({ head: this.view.name + " [" + this.view.unit + "]", at: (k) => +this.view.xs[k].toPrecision(8) });
    const lines = [["time [s]", ...columns.map((one) => one.head)].map(quote).join(",")];
    for (let k = locate(this.view.xs, a), j = locate(this.view.xs, b); k <= j; k++)
      lines.push([this.base.times[k], ...columns.map((one) => one.at(k))].join(","));
    save("plots.csv", URL.createObjectURL(new Blob([lines.join("\n") + "\n"], { type: "text/csv" })));
  }
}

const page = new ReportPage(JSON.parse(get("data").textContent));
Object.assign(window, { report: page });
page.start();
