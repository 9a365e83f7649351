// Where contacts are lost, and when bodies land or strike.
"use strict";

const MOST_MARKS = 50000;
// Landings with less than this share of a contact's largest load are not marked.
const SLIGHT = 0.01;

// Begin and end of rows.
function findSpans(count, holds) {
  const spans = [];
  for (let i = 0, begin = -1; i <= count && spans.length < MOST_MARKS; i++) {
    const now = i < count && holds(i);
    if (now && begin < 0) begin = i;
    if (now || begin < 0) continue;
    spans.push([begin, i]);
    begin = -1;
  }
  return spans;
}

class Marks {
  constructor(records, told) { this.records = records; this.told = told; this.lost = new Map(); this.events = []; }

  async start() {
    this.lost.clear(); this.events = [];
    const times = this.records.bases[0].times;
    for (const mark of this.told) {
      const { part, kind, variable } = mark, series = await this.records.series(variable);
      if (!series) continue;
      if (kind !== "load") { this.findCounts(part, series, times); continue; }
      this.lost.set(part, this.records.findLost(mark));
      this.findLandings(part, series, times);
    }
    this.events.sort((a, b) => a.time - b.time);
  }

  // It lands where rows without load end.
  findLandings(part, series, times) {
    const { low } = series.levels[0], spans = findSpans(low.length, (i) => low[i] <= 0);
    const least = SLIGHT * series.range(0, low.length)[1];
    spans.forEach(([, at], k) => {
      const until = k + 1 < spans.length ? spans[k + 1][0] : low.length;
      if (at < until && series.range(at, until)[1] >= least) this.events.push({ part, kind: "lands", time: times[at] });
    });
  }

  findCounts(part, series, times) {
    const { low, high } = series.levels[0];
    for (let i = 0, before = low[0]; i < low.length && this.events.length < MOST_MARKS; i++) {
      if (high[i] > before) this.events.push({ part, kind: "strikes", time: times[i] });
      before = high[i];
    }
  }

  // Those of a part; of the only part that has any, for all others too.
  of(part) {
    const parts = new Set([...this.told.map((one) => one.part)]);
    return parts.has(part) ? part : parts.size === 1 ? [...parts][0] : null;
  }

  draw(g, frame, view, part) {
    const of = this.of(part), xs = view.xs, [i, j] = view.rows(0);
    if (of === null) return;
    g.fillStyle = color("shade");
    let drawn = -1;
    for (const [begin, end] of this.lost.get(of) || []) {
      if (end < i || begin > j) continue;
      const from = frame.x(xs[begin]), to = Math.max(frame.x(xs[Math.min(end, xs.length - 1)]), from + 1);
      if (to > drawn) g.fillRect(Math.max(from, drawn), frame.top, to - Math.max(from, drawn), frame.bottom - frame.top);
      drawn = Math.max(drawn, to);
    }
    g.fillStyle = color("now");
    let last = -10;
    for (const event of this.events) {
      if (event.part !== of) continue;
      const at = frame.x(view.at(event.time));
      if (at < frame.left || at > frame.right || at - last < 2) continue;
      last = at;
      g.beginPath(); g.moveTo(at - 4, frame.top); g.lineTo(at + 4, frame.top); g.lineTo(at, frame.top + 7); g.fill();
    }
  }

  // The next event after an instant, or the last one before it.
  next(time, ahead) {
    const later = ahead ? this.events.find((e) => e.time > time) : this.events.filter((e) => e.time < time).pop();
    return later || null;
  }
}
