// Packed numbers, and the least and largest values of their stretches at every scale.
"use strict";

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Bytes stand sorted by their place in a number; see packing.py.
async function unpack(text, Kind) {
  const sorted = await inflate(text), size = Kind.BYTES_PER_ELEMENT, count = sorted.length / size;
  const bytes = new Uint8Array(sorted.length);
  for (let k = 0; k < size; k++)
    for (let i = 0, at = k * count; i < count; i++) bytes[i * size + k] = sorted[at + i];
  return new Kind(bytes.buffer);
}

// Whole numbers whose second differences were packed, and the range that they divide; see packing.py.
async function unpackDetail({ text, least, step }) {
  const values = await unpack(text, Int32Array), found = new Float32Array(values.length);
  for (let i = 0, slope = 0, at = 0; i < values.length; i++) {
    slope += values[i]; at += slope;
    found[i] = least + step * at;
  }
  return found;
}

const FOLD = 2;

// Values over the rows of a base; levels[k] has least and largest values of FOLD^k rows.
class Series {
  constructor(low, high) { this.levels = [{ low, high }]; }

  at(i) { return this.levels[0].low[i]; }

  level(k) {
    while (this.levels.length <= k) {
      const { low, high } = this.levels[this.levels.length - 1], n = Math.ceil(low.length / FOLD);
      const less = new Float32Array(n).fill(NaN), more = new Float32Array(n).fill(NaN);
      for (let i = 0; i < low.length; i++) {
        const j = (i / FOLD) | 0;
        if (!(less[j] <= low[i])) less[j] = low[i] === low[i] ? low[i] : less[j];
        if (!(more[j] >= high[i])) more[j] = high[i] === high[i] ? high[i] : more[j];
      }
      this.levels.push({ low: less, high: more });
    }
    return this.levels[k];
  }

  // Least and largest value of the rows from i to j (not j).
  range(i, j) {
    let k = 0;
    while (Math.pow(FOLD, k + 1) * 64 < j - i) k++;
    const { low, high } = this.level(k), f = Math.pow(FOLD, k);
    let least = Infinity, most = -Infinity;
    for (let m = Math.floor(i / f); m < Math.ceil(j / f); m++) {
      if (low[m] < least) least = low[m];
      if (high[m] > most) most = high[m];
    }
    return [least, most];
  }
}

// The row before or at a value in ascending numbers.
function locate(values, x) {
  let a = 0, b = values.length - 1;
  while (a < b) { const m = (a + b + 1) >> 1; if (values[m] <= x) a = m; else b = m - 1; }
  return a;
}

// Unpacks variables when they are asked for.
class Records {
  constructor(content) {
    this.bases = content.bases; this.variables = new Map();
    for (const v of content.variables) this.variables.set((v.group === "coupled" ? "" : v.group + ": ") + v.name, v);
    this.open = new Map();
  }

  async start() {
    for (const b of this.bases)
      b.times = b.time ? await unpack(b.time, Float64Array) : Float64Array.from({ length: b.rows }, (_, i) => b.begin + i * b.every);
  }

  async series(name, key = "values") {
    const v = this.variables.get(name);
    if (!v || !v.data[key]) return null;
    const id = key + " " + name;
    if (!this.open.has(id)) this.open.set(id, (async () => {
      const low = await (key === "detail" ? unpackDetail(v.data[key]) : unpack(v.data[key], Float32Array));
      const more = v.data[key + "High"];
      return new Series(low, more ? await unpack(more, Float32Array) : low);
    })());
    return this.open.get(id);
  }

  // Spans of rows in which a contact is lost.
  findLost(mark) { return mark.lost[0]; }
}

function readable(x) {
  if (x === 0 || !isFinite(x)) return String(x);
  const size = Math.abs(x);
  return size >= 1e5 || size < 1e-3 ? x.toExponential(3).replace(/\.?0+e/, "e") : String(+x.toPrecision(5));
}
