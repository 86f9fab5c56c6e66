'use strict';
// Cells that change, drawn through everything else: those in which the final mesh differs from its
// base, or those that it takes to open, cut or fill a class of the diagram.

class CellBoxes {
  constructor(shape, isFlat) {
    this.shape = shape;
    this.isFlat = isFlat;
    this.object = new THREE.Group();
  }

  /** Show groups of cells, given as {cells, colour}. */
  set(groups) {
    for (const { geometry, material } of this.object.children) {
      geometry.dispose();
      material.dispose();
    }
    this.object.clear();
    for (const { cells, colour } of groups.filter((group) => group.cells.length)) {
      const box = new THREE.Mesh(this.geometryOf(cells), new THREE.MeshBasicMaterial({
        color: colour, depthTest: false, transparent: true, opacity: 0.6, side: THREE.DoubleSide,
      }));
      box.renderOrder = 9;
      box.frustumCulled = false;
      this.object.add(box);
    }
  }

  /** Return the sides at which cells meet others; in the plane squares above the cells. */
  geometryOf(cells) {
    const corners = this.isFlat ? [[4, 5, 7, 6]]
      : [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    const chosen = new Set(cells);
    const points = [];
    const index = [];
    for (const cell of cells) {
      const low = this.indexOf(cell);
      corners.forEach((side, k) => {
        if (!this.isFlat && this.hasNeighbour(chosen, cell, low, k >> 1, k & 1)) return;
        const first = points.length / 3;
        for (const c of side) {
          for (let a = 0; a < 3; a++) points.push(this.isFlat && a === 2 ? 2 : low[a] + (c >> a & 1 ? 0.97 : 0.03));
        }
        index.push(first, first + 1, first + 2, first, first + 2, first + 3);
      });
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(index), 1));
    return geometry;
  }

  /** Return whether the next cell along an axis is among the chosen ones. */
  hasNeighbour(chosen, cell, low, axis, isUpper) {
    const at = low[axis] + (isUpper ? 1 : -1);
    if (at < 0 || at >= this.shape[axis]) return false;
    let step = 1;
    for (let a = this.shape.length - 1; a > axis; a--) step *= this.shape[a];
    return chosen.has(cell + (isUpper ? step : -step));
  }

  /** Return the index of a cell along each axis. */
  indexOf(cell) {
    const at = [];
    for (let a = this.shape.length - 1; a >= 0; a--) {
      at[a] = cell % this.shape[a];
      cell = Math.floor(cell / this.shape[a]);
    }
    return at;
  }
}

/** What can be done about the classes of the diagram, of which one at a time is shown. */
class Wishes {
  /**
   * @param offers of tusqh.explorer.changes.offer_wishes
   * @param arrays their cells
   */
  constructor(offers, arrays) {
    Object.assign(this, { offers, arrays, shown: -1 });
  }

  /** Return the numbers of the offers for a pair. */
  of(pair) {
    return this.offers.map((_, k) => k).filter((k) => this.offers[k].pair === pair);
  }

  cells(k) { return this.arrays.cells.subarray(this.arrays.cells_from[k], this.arrays.cells_from[k + 1]); }

  get offer() { return this.shown < 0 ? null : this.offers[this.shown]; }

  /** Return an offer in words: "cut: 53 cells left out". */
  describe(k) {
    const { do: what, adds } = this.offers[k];
    const n = this.cells(k).length;
    return `${what}: ${show(n)} cell${n === 1 ? '' : 's'} ${adds ? 'added' : 'left out'}`;
  }

  groups() {
    return this.offer ? [{ cells: this.cells(this.shown), colour: this.offer.adds ? COLOURS.added : COLOURS.leftOut }] : [];
  }
}
