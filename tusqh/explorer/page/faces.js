'use strict';
// The boundary of the kept cells at any threshold.
//
// A face between two cells of ranks lo < hi is on it exactly when lo < cut <= hi, so every face is
// listed once, with its inner cell and the direction it faces.  In the plane the "faces" are the
// cells themselves, seen from above.
//
// A code is 27 bits of cell, 2 bits of state and 3 bits of direction: -x, +x, -y, +y, -z, +z.

const KEPT = 0;
const REMOVED = 1;
const FILLED = 2;
const CUT = 3;
const UPWARDS = 5;

/** The cells of a grid, numbered in C order. */
class Cells {
  constructor(shape) {
    this.isFlat = shape.length === 2;
    this.shape = this.isFlat ? [...shape, 1] : shape;
    const [, ny, nz] = this.shape;
    this.strides = [ny * nz, nz, 1];
  }

  /** Return the layer of a cell along an axis. */
  layer(cell, axis) { return Math.floor(cell / this.strides[axis]) % this.shape[axis]; }
}

class Faces extends Cells {
  constructor(field, shape) {
    super(shape);
    this.rank = field.rank;
    this.tone = Uint8Array.from(field.levels, (key) => Math.round(255 * key / TOP));
    this.list();
    const counts = [0, 1, 2, 3, 4, 5].map((d) => this.start[d + 1] - this.start[d]);
    const layers = this.strides.map((_, a) => this.rank.length / this.shape[a]);
    const [many, more] = this.isFlat ? [counts[UPWARDS], this.rank.length] : [
      [0, 2, 4].reduce((sum, d) => sum + Math.max(counts[d], counts[d + 1]), 0), Math.max(...layers),
    ];
    // A face has four corners, and what is drawn is given for each of them.
    this.capacity = many + more;
    this.code = new Uint32Array(4 * this.capacity);
    this.tones = new Uint32Array(this.capacity); // Four bytes each.
    this.count = 0;
  }

  /** List all faces, by direction: those of direction d from `start[d]` on. */
  list() {
    const counts = new Uint32Array(7);
    this.visit((cell, direction) => { counts[direction + 1] += 1; });
    this.start = accumulate(counts);
    const n = this.start[6];
    this.cell = new Uint32Array(n);
    this.hi = new this.rank.constructor(n);
    this.lo = new this.rank.constructor(n);
    const next = this.start.slice();
    this.visit((cell, direction, hi, lo) => {
      const f = next[direction]++;
      this.cell[f] = cell;
      this.hi[f] = hi;
      this.lo[f] = lo;
    });
  }

  /** Call with (inner cell, direction, its rank, the rank beyond) for every face. */
  visit(put) {
    const { rank, shape, strides } = this;
    const [nx, ny, nz] = shape;
    for (let i = 0, c = 0; i < nx; i++) {
      for (let j = 0; j < ny; j++) {
        for (let k = 0; k < nz; k++, c++) {
          const r = rank[c];
          if (this.isFlat) {
            if (r > 0) put(c, UPWARDS, r, 0);
            continue;
          }
          for (let axis = 0; axis < 3; axis++) {
            const at = axis === 0 ? i : axis === 1 ? j : k;
            if (at === 0 && r > 0) put(c, 2 * axis, r, 0);
            const next = at + 1 < shape[axis] ? rank[c + strides[axis]] : 0;
            if (r > next) put(c, 2 * axis + 1, r, next);
            else if (r < next) put(c + strides[axis], 2 * axis, next, r);
          }
        }
      }
    }
  }

  /**
   * Put the faces to draw into `code` and `tones`, and return how many they are.
   * @param cut least rank of a kept cell
   * @param exceptions cells removed or filled against their fraction
   * @param window {axis, from, to}: show only these layers of cells; or null
   * @param facing directions that face the eye; without perspective three at a time
   */
  collect(cut, exceptions, window, facing) {
    const { start, cell, hi, lo } = this;
    const isPlain = exceptions.size === 0 && !window;
    this.count = 0;
    for (const direction of facing) {
      for (let f = start[direction]; f < start[direction + 1]; f++) {
        if (lo[f] >= cut || hi[f] < cut) continue;
        const state = isPlain ? KEPT : this.inspect(cell[f], direction, exceptions, window);
        if (state >= 0) this.add(cell[f], direction, state);
      }
    }
    if (this.isFlat && exceptions.size) this.addFilled(cut, exceptions);
    if (window) this.addSection(cut, exceptions, window, facing);
    return this.count;
  }

  add(cell, direction, state) {
    const n = this.count++;
    const { code } = this;
    code[4 * n] = code[4 * n + 1] = code[4 * n + 2] = code[4 * n + 3] = cell * 32 + state * 8 + direction;
    this.tones[n] = this.tone[this.rank[cell]] * 0x01010101;
  }

  /** Return the state of a face on the boundary, -1 when it is not drawn after all. */
  inspect(cell, direction, exceptions, window) {
    if (window) {
      const at = this.layer(cell, window.axis);
      if (at < window.from || at >= window.to) return -1;
    }
    if (exceptions.mask[cell]) return REMOVED;
    if (this.isFlat) return KEPT;
    const axis = direction >> 1;
    const step = direction & 1 ? 1 : -1;
    const beyond = this.layer(cell, axis) + step;
    const isFilled = beyond >= 0 && beyond < this.shape[axis]
      && exceptions.mask[cell + step * this.strides[axis]];
    return isFilled ? -1 : KEPT; // Between kept cells and a filled void.
  }

  addFilled(cut, exceptions) {
    for (let c = 0; c < this.rank.length; c++) {
      if (exceptions.mask[c] && this.rank[c] < cut) this.add(c, UPWARDS, FILLED);
    }
  }

  /** Close the cut: faces between two kept cells, of which the window shows one. */
  addSection(cut, exceptions, { axis, from, to }, facing) {
    const [u, v] = [0, 1, 2].filter((a) => a !== axis);
    for (const [at, direction] of [[from, 2 * axis], [to - 1, 2 * axis + 1]]) {
      const beyond = direction & 1 ? at + 1 : at - 1;
      if (!facing.includes(direction) || beyond < 0 || beyond >= this.shape[axis]) continue;
      const step = (beyond - at) * this.strides[axis];
      for (let a = 0; a < this.shape[u]; a++) {
        for (let b = 0; b < this.shape[v]; b++) {
          const c = at * this.strides[axis] + a * this.strides[u] + b * this.strides[v];
          if (this.isKept(c, cut, exceptions) && this.isKept(c + step, cut, exceptions)) {
            this.add(c, direction, this.rank[c] < cut ? FILLED : CUT);
          }
        }
      }
    }
  }

  isKept(cell, cut, exceptions) { return (this.rank[cell] >= cut) !== (exceptions.mask[cell] === 1); }
}
