'use strict';
// Plateaus of the threshold: every threshold t with lower < t <= upper keeps the same cells.

const TOP = 2 ** 20; // Key of a full cell: fractions are whole multiples of 1 / TOP.

class Plateaus {
  /**
   * @param arrays of tusqh.explorer.arrays.plateau_arrays, from high to low
   * @param field of tusqh.explorer.arrays.field_arrays
   * @param chosen threshold of the final mesh
   */
  constructor(arrays, field, chosen) {
    this.arrays = arrays;
    this.count = arrays.upper.length;
    const { levels, rank } = field;
    // Cells of at least this rank are kept.
    this.cut = Uint32Array.from(arrays.upper, (key) => lowerBound(levels, key));
    const atLeast = new Uint32Array(levels.length + 1);
    for (const r of rank) atLeast[r] += 1;
    for (let r = levels.length - 1; r >= 0; r--) atLeast[r] += atLeast[r + 1];
    this.byFraction = Uint32Array.from(this.cut, (cut) => atLeast[cut]);
    this.chosen = this.find(chosen);
    this.chosenThreshold = chosen;
    this.runs = this.findRuns();
  }

  upper(p) { return this.arrays.upper[p] / TOP; }

  lower(p) { return p + 1 < this.count ? this.arrays.upper[p + 1] / TOP : 0; }

  /** Return the plateau that holds a threshold. */
  find(threshold) {
    const key = Math.min(Math.max(threshold * TOP, 1e-9), TOP);
    let low = 0;
    let high = this.count - 1;
    while (low < high) { // The last plateau whose upper end is not below the threshold.
      const middle = (low + high + 1) >> 1;
      if (this.arrays.upper[middle] >= key) low = middle; else high = middle - 1;
    }
    return low;
  }

  /** Return a short number well inside a plateau; on the chosen one the chosen threshold. */
  threshold(p) {
    if (p === this.chosen) return this.chosenThreshold;
    const middle = (this.upper(p) + this.lower(p)) / 2;
    const room = (this.upper(p) - this.lower(p)) / 4;
    for (let digits = 4; digits < 12; digits++) {
      const rounded = Number(middle.toFixed(digits));
      if (Math.abs(rounded - middle) <= room) return rounded;
    }
    return middle;
  }

  /** Return the Betti numbers of the filtration. */
  raw(p) { return [0, 1, 2].map((k) => this.arrays[`raw_${k}`][p]); }

  /** Return the Betti numbers that the mesh will have, or null where nobody looked. */
  mesh(p) {
    return this.arrays.mesh_0[p] < 0 ? null : [0, 1, 2].map((k) => this.arrays[`mesh_${k}`][p]);
  }

  /** Return runs of examined plateaus whose meshes have the same Betti numbers. */
  findRuns() {
    const runs = [];
    for (let p = 0; p < this.count; p++) {
      const betti = this.mesh(p);
      if (!betti || !this.byFraction[p]) continue;
      const last = runs[runs.length - 1];
      if (last && String(last.betti) === String(betti)) {
        last.end = p;
        last.examined.push(p);
      } else runs.push({ start: p, end: p, betti, examined: [p] });
    }
    for (const run of runs) {
      run.upper = this.upper(run.start);
      run.lower = this.lower(run.end);
      const isChosen = run.start <= this.chosen && this.chosen <= run.end;
      run.middle = isChosen ? this.chosen : this.nearest(run.examined, (run.upper + run.lower) / 2);
    }
    return runs;
  }

  /** Return the plateau, of some, that holds a threshold or comes nearest to it. */
  nearest(some, threshold) {
    const away = (p) => Math.max(this.lower(p) - threshold, threshold - this.upper(p), 0);
    return some.reduce((best, p) => (away(p) < away(best) ? p : best));
  }

  /** Return the middle of the nearest run above (direction 1) or below (-1) a plateau. */
  nextRun(p, direction) {
    const at = this.runs.findIndex((run) => p <= run.end);
    if (at < 0) return this.runs.length && direction > 0 ? this.runs[this.runs.length - 1].middle : p;
    const inside = this.runs[at].start <= p;
    const next = direction > 0 ? at - 1 : inside ? at + 1 : at;
    return this.runs[next] ? this.runs[next].middle : p;
  }
}

/** Return the first index of an ascending array whose entry is at least a value. */
function lowerBound(ascending, value) {
  let low = 0;
  let high = ascending.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}

/** Cells that are removed or filled against their fraction, at one plateau after the other. */
class Exceptions {
  constructor(arrays, nCells) {
    this.arrays = arrays;
    this.mask = new Uint8Array(nCells);
    this.done = 0; // Number of plateaus whose changes are in the mask.
    this.size = 0;
  }

  /** Apply the changes between the last plateau and this one; each is its own inverse. */
  moveTo(p) {
    const { toggles, toggles_from: from } = this.arrays;
    const [begin, end] = [Math.min(this.done, p + 1), Math.max(this.done, p + 1)];
    for (let i = from[begin]; i < from[end]; i++) {
      this.mask[toggles[i]] ^= 1;
      this.size += this.mask[toggles[i]] ? 1 : -1;
    }
    this.done = p + 1;
  }

  /** Return how many cells are removed and how many are filled. */
  count(rank, cut) {
    let removed = 0;
    if (this.size) {
      for (let c = 0; c < rank.length; c++) if (this.mask[c] && rank[c] >= cut) removed += 1;
    }
    return { removed, filled: this.size - removed };
  }
}
