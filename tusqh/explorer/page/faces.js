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

class Faces {
  constructor(field, shape) {
    this.rank = field.rank;
    this.isFlat = shape.length === 2;
    this.shape = this.isFlat ? [...shape, 1] : shape;
    const [, ny, nz] = this.shape;
    this.strides = [ny * nz, nz, 1];
    this.tone = Uint16Array.from(field.levels, (key) => Math.round(65535 * key / TOP));
    if (this.isFlat) this.listCells(); else this.listFaces();
    const layers = this.strides.map((_, a) => this.rank.length / this.shape[a]);
    const more = this.isFlat ? this.rank.length : Math.max(...layers);
    this.visible = {
      count: 0,
      code: new Uint32Array(this.code.length + more),
      tone: new Uint16Array(this.code.length + more),
    };
  }

  listCells() {
    const cells = [];
    this.rank.forEach((r, c) => { if (r > 0) cells.push(c); });
    this.code = Uint32Array.from(cells, (c) => c * 32 + UPWARDS);
    this.hi = this.rank.constructor.from(cells, (c) => this.rank[c]);
    this.lo = new this.rank.constructor(cells.length);
  }

  listFaces() {
    const { rank, shape, strides } = this;
    const [nx, ny, nz] = shape;
    const visit = (put) => {
      for (let i = 0, c = 0; i < nx; i++) {
        for (let j = 0; j < ny; j++) {
          for (let k = 0; k < nz; k++, c++) {
            const r = rank[c];
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
    };
    let n = 0;
    visit(() => { n += 1; });
    this.code = new Uint32Array(n);
    this.hi = new rank.constructor(n);
    this.lo = new rank.constructor(n);
    n = 0;
    visit((cell, direction, hi, lo) => {
      this.code[n] = cell * 32 + direction;
      this.hi[n] = hi;
      this.lo[n++] = lo;
    });
  }

  /**
   * Put the faces to draw into `visible`.
   * @param cut least rank of a kept cell
   * @param exceptions cells removed or filled against their fraction
   * @param window {axis, from, to}: show only these layers of cells; or null
   */
  collect(cut, exceptions, window) {
    const { code, hi, lo, tone, visible } = this;
    const isPlain = exceptions.size === 0 && !window;
    let n = 0;
    for (let f = 0; f < code.length; f++) {
      if (lo[f] >= cut || hi[f] < cut) continue;
      const drawn = isPlain ? code[f] : this.inspect(code[f], exceptions, window);
      if (drawn < 0) continue;
      visible.code[n] = drawn;
      visible.tone[n++] = tone[hi[f]];
    }
    visible.count = n;
    if (this.isFlat && exceptions.size) this.addFilled(cut, exceptions);
    if (window) this.addSection(cut, exceptions, window);
    return visible.count;
  }

  /** Return the code of a boundary face with its state, -1 when it is not drawn after all. */
  inspect(code, exceptions, window) {
    const cell = code >>> 5;
    if (window) {
      const at = this.layer(cell, window.axis);
      if (at < window.from || at >= window.to) return -1;
    }
    if (exceptions.mask[cell]) return (code | REMOVED << 3) >>> 0;
    if (this.isFlat) return code;
    const direction = code & 7;
    const axis = direction >> 1;
    const step = direction & 1 ? 1 : -1;
    const beyond = this.layer(cell, axis) + step;
    const isFilled = beyond >= 0 && beyond < this.shape[axis]
      && exceptions.mask[cell + step * this.strides[axis]];
    return isFilled ? -1 : code; // Between kept cells and a filled void.
  }

  layer(cell, axis) { return Math.floor(cell / this.strides[axis]) % this.shape[axis]; }

  addFilled(cut, exceptions) {
    for (let c = 0; c < this.rank.length; c++) {
      if (exceptions.mask[c] && this.rank[c] < cut) this.add(c, UPWARDS, FILLED);
    }
  }

  /** Close the cut: faces between two kept cells, of which the window shows one. */
  addSection(cut, exceptions, { axis, from, to }) {
    const [u, v] = [0, 1, 2].filter((a) => a !== axis);
    for (const [at, direction] of [[from, 2 * axis], [to - 1, 2 * axis + 1]]) {
      const beyond = direction & 1 ? at + 1 : at - 1;
      if (beyond < 0 || beyond >= this.shape[axis]) continue;
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

  add(cell, direction, state) {
    this.visible.code[this.visible.count] = cell * 32 + state * 8 + direction;
    this.visible.tone[this.visible.count++] = this.tone[this.rank[cell]];
  }
}
