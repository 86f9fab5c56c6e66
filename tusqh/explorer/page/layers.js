'use strict';
// What the stage shows: kept cells, the final mesh, the geometry, and highlighted places.

/**
 * Return squares of four corners each, of which only the first ones are drawn.  They are no
 * instances: drawing in software pays for every instance as for a whole object.
 */
function manySquares(n) {
  const geometry = new THREE.BufferGeometry();
  const index = new Uint32Array(6 * n);
  for (let f = 0, i = 0, c = 0; f < n; f++, c += 4) {
    index[i++] = c;
    index[i++] = c + 1;
    index[i++] = c + 2;
    index[i++] = c;
    index[i++] = c + 2;
    index[i++] = c + 3;
  }
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  return geometry;
}

/** Return an attribute over an array that changes. */
function changing(array, size, isNormalised = false) {
  const attribute = new THREE.BufferAttribute(array, size, isNormalised);
  attribute.setUsage(THREE.DynamicDrawUsage);
  return attribute;
}

function asObject(geometry, material) {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  return mesh;
}

/** Draw the first squares of a geometry, whose attributes changed. */
function drawFirst(geometry, n) {
  for (const attribute of Object.values(geometry.attributes)) {
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, 4 * n * attribute.itemSize);
    attribute.needsUpdate = true;
  }
  geometry.setDrawRange(0, 6 * n);
}

class CellLayer {
  constructor(faces) {
    this.faces = faces;
    const geometry = manySquares(faces.capacity);
    geometry.setAttribute('code', changing(faces.code, 1));
    geometry.setAttribute('tone', changing(new Uint8Array(faces.tones.buffer), 1, true));
    this.object = asObject(geometry, cellMaterial(faces.shape));
  }

  update(cut, exceptions, window, facing) {
    drawFirst(this.object.geometry, this.faces.collect(cut, exceptions, window, facing));
  }

  colourBy(mode) { this.object.material.uniforms.byTone.value = mode === 'fraction' ? 1 : 0; }
}

class MeshLayer {
  /**
   * @param arrays of tusqh.explorer.arrays.mesh_arrays
   * @param cells gives the layer of a cell, and whether all lie in the plane
   * @param group of every element, by which it has a colour and can be hidden
   * @param colours of the groups
   */
  constructor(arrays, cells, group, colours) {
    this.cells = cells;
    this.group = group;
    this.colours = colours.map((colour) => rgb(colour).map((part) => Math.round(255 * part)));
    this.hidden = colours.map(() => false);
    this.points = arrays.points;
    this.dim = cells.isFlat ? 2 : 3;
    this.corners = Int32Array.from(arrays.corners);
    this.first = accumulate(arrays.first);
    this.second = arrays.second;
    this.quality = arrays.quality;
    this.distance = arrays.distance; // Of every facet; only of fitted meshes.
    this.byDistance = false;
    this.cell = accumulate(arrays.cell);
    for (let f = 0, before = 0; f < this.corners.length; f += 4) {
      this.corners[f] = before += this.corners[f];
      for (let c = 1; c < 4; c++) this.corners[f + c] += before;
    }
    const n = this.first.length;
    const geometry = manySquares(n);
    geometry.setAttribute('place', changing(new Float32Array(12 * n), 3));
    geometry.setAttribute('tint', changing(new Uint8Array(12 * n), 3, true));
    geometry.setAttribute('quality', changing(new Uint8Array(4 * n), 1, true));
    this.object = asObject(geometry, elementMaterial());
    this.update(null);
  }

  /** Show the boundary of those elements that lie in the window and are not hidden. */
  update(window) {
    this.window = window;
    const { geometry } = this.object;
    const [place, tint, quality] = ['place', 'tint', 'quality'].map((a) => geometry.attributes[a].array);
    const isWhole = !window && !this.hidden.includes(true);
    const isIn = (element) => {
      if (this.hidden[this.group[element]]) return false;
      if (!window) return true;
      const at = this.cells.layer(this.cell[element], window.axis);
      return at >= window.from && at < window.to;
    };
    let n = 0;
    for (let f = 0; f < this.first.length; f++) {
      const hasSecond = this.second[f] !== 0;
      let inner = this.first[f];
      let isTurned = false; // Facets are walked so that they face out of their first element.
      if (hasSecond) {
        if (isWhole) continue;
        const other = inner + this.second[f];
        if (isIn(inner) === isIn(other)) continue;
        isTurned = !isIn(inner);
        if (isTurned) inner = other;
      } else if (!isIn(inner)) continue;
      const colour = this.colours[this.group[inner]];
      for (let c = 0; c < 4; c++) {
        const p = this.corners[4 * f + (isTurned ? 3 - c : c)] * this.dim;
        const at = 12 * n + 3 * c;
        place[at] = this.points[p];
        place[at + 1] = this.points[p + 1];
        place[at + 2] = this.dim === 3 ? this.points[p + 2] : 1;
        tint.set(colour, at);
      }
      const value = this.byDistance ? this.distance[f] : this.quality[inner];
      quality.fill(value, 4 * n, 4 * n + 4);
      n += 1;
    }
    this.count = n;
    drawFirst(geometry, n);
  }

  colourBy(mode) {
    const byDistance = mode === 'distance';
    this.object.material.uniforms.byQuality.value = byDistance ? 2 : Number(mode === 'quality');
    if (byDistance === this.byDistance) return;
    this.byDistance = byDistance;
    this.update(this.window);
  }
}

/** Return the unrepaired geometry: lines above the cells in the plane, triangles in space. */
function geometryObject(arrays, isFlat) {
  const dim = isFlat ? 2 : 3;
  const [lower, side] = [arrays.box.subarray(0, dim), arrays.box[dim]];
  const n = arrays.points.length / dim;
  const points = new Float32Array(3 * n);
  for (let p = 0; p < n; p++) {
    for (let a = 0; a < dim; a++) {
      points[3 * p + a] = lower[a] + side * arrays.points[dim * p + a] / 65535;
    }
    if (isFlat) points[3 * p + 2] = 1.5;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
  geometry.setIndex(new THREE.BufferAttribute(arrays.pieces, 1));
  if (!isFlat) return asObject(geometry, soupMaterial());
  const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: COLOURS.outline }));
  lines.frustumCulled = false;
  return lines;
}

/** The places that create and destroy a class, drawn through everything else. */
class Markers {
  constructor(shape, isFlat) {
    this.doubled = shape.map((n) => 2 * n + 1);
    this.isFlat = isFlat;
    this.object = new THREE.Group();
    this.box = new THREE.BoxGeometry(1, 1, 1);
    this.edges = new THREE.EdgesGeometry(this.box);
    this.places = [];
  }

  /** Mark places, given as {index, colour, label}; an index of -1 is no place. */
  set(places) {
    this.object.clear();
    this.places = places.filter(({ index }) => index >= 0).map((place) => {
      const { centre, size } = this.locate(place.index);
      const solid = new THREE.Mesh(this.box, new THREE.MeshBasicMaterial({
        color: place.colour, depthTest: false, transparent: true, opacity: 0.75,
      }));
      const frame = new THREE.LineSegments(this.edges, new THREE.LineBasicMaterial({
        color: '#ffffff', depthTest: false, transparent: true,
      }));
      solid.renderOrder = 10;
      frame.renderOrder = 11;
      for (const object of [solid, frame]) {
        object.position.set(...centre);
        object.scale.set(...size);
        this.object.add(object);
      }
      return { ...place, centre };
    });
  }

  /** Return centre and size, in cells, of a cell, face, edge or vertex of the doubled grid. */
  locate(index) {
    const at = [];
    for (let a = this.doubled.length - 1; a >= 0; a--) {
      at[a] = index % this.doubled[a];
      index = Math.floor(index / this.doubled[a]);
    }
    const centre = at.map((c) => c / 2);
    const size = at.map((c) => (c % 2 ? 1 : 0.3));
    return this.isFlat ? { centre: [...centre, 2], size: [...size, 0.5] } : { centre, size };
  }

  /** Return in words what a place is: "cell (12, 44)". */
  describe(index) {
    const at = this.locate(index);
    const dim = this.doubled.length;
    const odd = at.centre.slice(0, dim).filter((c) => c % 1 !== 0).length;
    const name = dim === 2 ? ['vertex', 'edge', 'cell'][odd] : ['vertex', 'edge', 'face', 'cell'][odd];
    return `${name} (${at.centre.slice(0, dim).map(Math.floor).join(', ')})`;
  }
}
