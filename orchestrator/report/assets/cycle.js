// The steady cycle of a train, computed here: its kernels as WebAssembly (fmus/native/browser/cycle.c).
"use strict";

// A period is steady when it changes no state by more than this, over nominal + |value|: less than a plot shows.
const STEADY = 1e-4, MOST_PERIODS = 12;
// Of the integrator, over nominal + |value|; it leaves less than a thousandth of the largest load, and a few
// hundredths where a train that has lost contact rings.
const TOLERANCE = 3e-6;

const least = (values) => values ? values.reduce((a, b) => Math.min(a, b), Infinity) : Infinity;
const megapascals = (pressure) => +(1e-6 * pressure).toPrecision(4) + " MPa";

// Rows in which a contact is lost: ContactLaw of orchestrator/assessment/lost_contact.py, where this page has its own lash.
function judgeLost(loads, lifts, lash, lobe) {
  let lost = false;
  return Array.from(loads, (load, i) => lost = !(load > 1e-9) && (lifts[i] > lobe || (lost && lifts[i] > lash)));
}

class CycleRecords extends Records {
  constructor(content) {
    super(content);
    this.told = content.cycle;
    this.chosen = this.told.sliders.map((slider) => slider.at);
    this.columns = new Map(this.told.outputs.map((name, k) => [name, k]));
  }

  async start() {
    await super.start();
    get("verdict").className = "verdict ";
    get("cycle-state").textContent = "computing the first cycle: a train of many valves takes minutes, and answers only between periods";
    await new Promise((done) => setTimeout(done, 20));
    const { instance } = await WebAssembly.instantiate(await inflate(this.told.code), {});
    /** @type {any} */
    this.train = instance.exports;
    this.train._initialize();
    this.begin();
    this.rows = new Float64Array(this.bases[0].rows * this.told.outputs.length);
    await this.compute();
  }

  view(name, Kind, count) { return new Kind(this.train.memory.buffer, this.train[name].value, count); }

  // From the start of the scenario; otherwise a cycle begins where the last one ended.
  begin() {
    for (const name of ["inputs", "state", "start", "nominal"]) {
      const values = name === "start" ? this.told.state : this.told[name];
      this.view(name, Float64Array, values.length).set(values);
    }
    for (const name of ["held", "positive"]) this.view(name, Int32Array, this.told[name].length).set(this.told[name]);
  }

  // Whether there is another cycle to show.
  async compute() {
    const { told } = this, began = performance.now(), base = this.bases[0];
    this.overtaken = false;
    this.settle();
    let found = await this.turn();
    if (!(found.change <= STEADY) && !this.overtaken) { this.begin(); this.settle(); found = await this.turn(); }
    if (this.overtaken) return false;
    this.found = { ...found, milliseconds: performance.now() - began };
    if (found.change !== found.change) return false;
    this.rows = this.view("rows", Float64Array, base.rows * told.outputs.length).slice();
    this.lows = this.view("lows", Float64Array, (base.rows - 1) * told.outputs.length).slice();
    this.highs = this.view("highs", Float64Array, this.lows.length).slice();
    this.measured = this.measure();
    this.shows = true;
    base.end = this.period;
    base.times = Float64Array.from({ length: base.rows }, (_, i) => i * this.period / (base.rows - 1));
    return true;
  }

  // The numbers of the chosen positions.
  settle() {
    const { told } = this, parameters = this.view("parameters", Float64Array, told.parameters.length);
    const states = ["state", "start"].map((name) => this.view(name, Float64Array, told.state.length));
    parameters.set(told.parameters);
    told.sliders.forEach((slider, k) => {
      const position = slider.positions[this.chosen[k]];
      for (const [at, value] of position.parameters) parameters[at] = value;
      for (const [at, value] of position.state || []) for (const one of states) one[at] = value;
      this.period = position.period || this.period;
    });
  }

  // Periods until they are steady, or the sliders have moved on.
  async turn() {
    let change = NaN, periods = 0;
    do {
      change = this.train.revolve(this.period, TOLERANCE, periods++);
      get("cycle-state").textContent = "computing: period " + periods + " of " + MOST_PERIODS + " at most is done";
      await new Promise((done) => setTimeout(done));
    } while (change > STEADY && periods < MOST_PERIODS && !this.overtaken);
    return { change, periods };
  }

  // Of each kind the worst part, as orchestrator/assessment/figures_of_merit.py measures it, and of what to warn.
  measure() {
    const lost = [], yielding = [], clashing = [], found = new Map(), add = (kind, part, output, value, size = Math.abs(value)) => {
      const { unit, factor } = this.variables.get(part + "." + output) || {}, shown = factor * size;
      if (isFinite(shown) && !(found.get(kind)?.value <= value)) found.set(kind, { value, text: readable(+shown.toPrecision(3)) + " " + unit + " (" + part + ")" });
    };
    for (const train of this.told.trains) {
      const { lift, contacts, valves, springs, rests } = train, lifts = this.column(lift), { lobe } = this.findLaw(train);
      for (const [part, limit] of Object.entries(contacts)) {
        const loads = this.column(part + ".load", this.lows);
        const load = least(loads.filter((_, i) => Math.min(lifts[i], lifts[i + 1]) > lobe));
        const pressure = -least(this.column(part + ".maximum_pressure", this.highs).map((one) => -one));
        add("least load while the cam lifts", part, "load", load);
        add("highest pressure", part, "maximum_pressure", -pressure);
        const film = least(this.column(part + ".minimum_film_thickness", this.lows));
        add("least film", part, "minimum_film_thickness", film < 1e-6 * ATOM ? 0 : film);
        if ((rests ? load : least(loads)) <= 0) lost.push(part);
        if (pressure > limit) yielding.push(part + " (" + megapascals(pressure) + ", limit " + megapascals(limit) + ")");
      }
      for (const part of springs) {
        const gap = least(this.column(part + ".least_gap", this.lows));
        add("least travel left to coil bind", part, "least_gap", gap, gap);
        if (gap < 0) clashing.push(part + " (the tightest " + readable(+(-1e3 * gap).toPrecision(3)) + " mm of travel beyond coil bind)");
      }
      for (const part of valves) add("seating velocity", part, "velocity", this.land(part));
    }
    const figures = [...found].map(([kind, { value, text }]) => (kind.endsWith("lifts") && value <= 0 ? "contact is lost: " : "") + kind + " " + text).join(", ");
    const warnings = { "contact is lost in": lost, "coils clash in": clashing, "bodies yield above the elastic limit, which is not computed:": yielding };
    return { figures, warnings: Object.entries(warnings).filter(([, parts]) => parts.length).map(([words, parts]) => words + " " + parts.join(", ")) };
  }

  // Lifts of the cam at the sliders' lash and where its lobe begins (m), after ContactLaw.
  findLaw({ lobe, lashes }) {
    const chosen = this.view("parameters", Float64Array, this.told.parameters.length);
    const lash = Math.max(0, ...lashes.map(([at, share]) => share * chosen[at]));
    return { lash, lobe: Math.max(lobe, lash) };
  }

  findLost(mark) {
    const { part } = mark, train = this.told.trains.find((one) => part in one.contacts), loads = this.column(part + ".load");
    const { lash, lobe } = train && train.rests ? this.findLaw(train) : { lash: -Infinity, lobe: -Infinity };
    const lost = judgeLost(loads, train ? this.column(train.lift) : loads, lash, lobe);
    return findSpans(lost.length, (i) => lost[i]);
  }

  // The velocity at the last row before the seat, of the hardest landing of a flight from the cam's lift.
  land(part) {
    const dip = this.column(part + ".seat_dip"), velocity = this.column(part + ".velocity"), deep = this.told.lifted * least(dip);
    let lowest = dip[0] < 0 ? -Infinity : 0, hardest = Infinity;
    dip.forEach((one, i) => {
      if (one < 0) { lowest = Math.min(lowest, one); return; }
      if (lowest < deep) hardest = Math.min(hardest, velocity[i - 1]);
      lowest = 0;
    });
    return hardest;
  }

  column(name, rows = this.rows) {
    const at = this.columns.get(name), n = this.told.outputs.length;
    return at === undefined ? null : Float32Array.from({ length: rows.length / n }, (_, i) => rows[i * n + at]);
  }

  // Without load there is no film.
  async series(name) {
    const values = this.column(name);
    if (!values) return null;
    const load = /film_thickness$/.test(name) ? this.column(name.replace(/[^.]*$/, "load")) : null;
    if (load) load.forEach((one, i) => { if (!(one > 0)) values[i] = NaN; });
    return new Series(values, values);
  }
}

// The sliders of a train.
class Cycle {
  constructor(report) {
    this.report = report; this.records = report.records;
    this.records.told.sliders.forEach((slider, k) => this.add(slider, k));
    this.tell();
  }

  add(slider, k) {
    const root = document.createElement("label"), name = document.createElement("span"), input = document.createElement("input"), value = document.createElement("output");
    const last = slider.positions.length - 1, said = (i) => slider.positions[i].shown.toPrecision(4) * 1 + " " + slider.unit;
    const show = () => { value.textContent = said(+input.value); input.setAttribute("aria-valuetext", value.textContent); };
    name.textContent = slider.name;
    Object.assign(input, { type: "range", min: "0", max: String(last), step: "1", value: String(slider.at), id: "slider-" + k });
    input.setAttribute("aria-label", slider.name + " (" + slider.unit + ")");
    root.title = slider.description + ", " + said(0) + " to " + said(last) + "; the scenario has " + said(slider.at);
    root.htmlFor = value.htmlFor.value = input.id;
    input.dataset.slider = slider.name;
    input.oninput = () => { show(); this.records.chosen[k] = +input.value; this.repeat(); this.ask(); };
    show();
    root.append(name, value, input);
    get("sliders").append(root);
  }

  // The command of a run with the numbers of the sliders that were moved.
  repeat() {
    const { command, sliders } = this.records.told, moved = sliders.flatMap((slider, k) => {
      const at = this.records.chosen[k], value = +slider.positions[at].shown.toPrecision(9) + " " + slider.unit.replace("r/min", "rpm");
      return at === slider.at ? [] : slider.keys.map((key) => " --set " + key + "='" + value + "'");
    });
    get("command").textContent = command + moved.join("");
  }

  // What is computed as a slider moves on is given up after its period.
  async ask() {
    this.records.overtaken = this.wanted = true;
    if (this.busy) return;
    this.busy = true;
    document.body.classList.add("computing");
    this.judge("", "computing");
    while (this.wanted) { this.wanted = false; await this.change(); }
    document.body.classList.remove("computing");
    this.busy = false;
    this.tell();
  }

  // Another cycle, at the same share of it, and the same part of it in the plots.
  async change() {
    const share = this.report.now / (this.report.base.end || 1), view = this.report.view, part = view.part;
    if (!await this.records.compute()) return;
    await view.over(view.name);
    view.part = part;
    await this.report.reload();
    this.report.setTime(share * this.report.base.end);
    get("cycle-figures").textContent = this.records.measured.figures;
  }

  tell() {
    const { change, periods, milliseconds } = this.records.found, time = Math.round(milliseconds) + " ms";
    const { figures, warnings } = this.records.shows ? this.records.measured : { figures: "", warnings: [] };
    get("cycle-figures").textContent = figures;
    if (change !== change) this.judge("bad", "no step succeeds: " + (this.records.shows ? "the cycle before is shown" : "there is no cycle"));
    else if (change <= STEADY) this.judge("good", "steady after " + periods + (periods > 1 ? " periods, " : " period, ") + time, warnings);
    else this.judge("unsteady", "not steady after " + periods + " periods: the last one is shown, and the next would change states by up to " + readable(+change.toPrecision(2)) + " of their sizes; " + time, warnings);
  }

  // What the motion is, beside the sliders and by the colour of the page's verdict: warnings make it amber.
  judge(kind, words, warnings = []) {
    get("cycle-state").textContent = words;
    const motion = { good: "steady cycle, computed in this page", unsteady: "no steady cycle at these numbers", bad: "no motion at these numbers" }[kind] || "computing";
    get("verdict").textContent = [motion, ...warnings].join("; ");
    get("verdict").className = "verdict " + (warnings.length ? "unsteady" : kind);
  }

  draw() {}
}
