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

  /** Return boxes a little smaller than the cells; in the plane squares above them. */
  geometryOf(cells) {
    const sides = this.isFlat ? [[4, 5, 7, 6]]
      : [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    const points = new Float32Array(24 * cells.length);
    const index = new Uint32Array(6 * sides.length * cells.length);
    let at = 0;
    cells.forEach((cell, n) => {
      const low = this.indexOf(cell);
      for (let c = 0; c < 8; c++) {
        for (let a = 0; a < 3; a++) {
          const isUpper = c >> a & 1;
          points[24 * n + 3 * c + a] = this.isFlat && a === 2 ? 2 : low[a] + (isUpper ? 0.95 : 0.05);
        }
      }
      for (const [a, b, c, d] of sides) for (const corner of [a, b, c, a, c, d]) index[at++] = 8 * n + corner;
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    return geometry;
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
