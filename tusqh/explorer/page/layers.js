'use strict';
// What the stage shows: kept cells, the final mesh, the geometry, and highlighted places.

/** Return the square of which every face is an instance. */
function instancedSquare() {
  const geometry = new THREE.InstancedBufferGeometry();
  const corners = new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]);
  geometry.setAttribute('corner', new THREE.BufferAttribute(corners, 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.instanceCount = 0;
  return geometry;
}

/** Return an instanced attribute over an array that changes. */
function instanced(array, size, isNormalised = false) {
  const attribute = new THREE.InstancedBufferAttribute(array, size, isNormalised);
  attribute.setUsage(THREE.DynamicDrawUsage);
  return attribute;
}

function asObject(geometry, material) {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  return mesh;
}

/** Tell the renderer which part of an attribute changed. */
function refresh(attribute, count) {
  attribute.clearUpdateRanges();
  attribute.addUpdateRange(0, count * attribute.itemSize);
  attribute.needsUpdate = true;
}

class CellLayer {
  constructor(faces) {
    this.faces = faces;
    const geometry = instancedSquare();
    geometry.setAttribute('code', instanced(faces.visible.code, 1));
    geometry.setAttribute('tone', instanced(faces.visible.tone, 1, true));
    this.object = asObject(geometry, cellMaterial(faces.shape));
  }

  update(cut, exceptions, window) {
    const { geometry } = this.object;
    geometry.instanceCount = this.faces.collect(cut, exceptions, window);
    refresh(geometry.attributes.code, geometry.instanceCount);
    refresh(geometry.attributes.tone, geometry.instanceCount);
  }

  colourBy(mode) { this.object.material.uniforms.byTone.value = mode === 'fraction' ? 1 : 0; }
}

class MeshLayer {
  /**
   * @param arrays of tusqh.explorer.arrays.mesh_arrays
   * @param faces of the kept cells, for the layer of a cell
   */
  constructor(arrays, faces) {
    this.faces = faces;
    this.points = arrays.points;
    this.dim = faces.isFlat ? 2 : 3;
    this.corners = Int32Array.from(arrays.corners);
    this.first = accumulate(arrays.first);
    this.second = arrays.second;
    this.kind = arrays.kind;
    this.quality = arrays.quality;
    this.cell = accumulate(arrays.cell);
    for (let f = 0, before = 0; f < this.corners.length; f += 4) {
      this.corners[f] = before += this.corners[f];
      for (let c = 1; c < 4; c++) this.corners[f + c] += before;
    }
    const geometry = instancedSquare();
    const n = this.first.length;
    for (let c = 0; c < 4; c++) {
      geometry.setAttribute(`corner${c}`, instanced(new Float32Array(3 * n), 3));
    }
    geometry.setAttribute('kind', instanced(new Uint8Array(n), 1));
    geometry.setAttribute('quality', instanced(new Uint8Array(n), 1, true));
    this.object = asObject(geometry, elementMaterial());
    this.update(null);
  }

  /** Show the boundary of those elements that lie in the window. */
  update(window) {
    const { geometry } = this.object;
    const { corner0, corner1, corner2, corner3, kind, quality } = geometry.attributes;
    const places = [corner0, corner1, corner2, corner3];
    const isIn = (element) => {
      if (!window) return true;
      const at = this.faces.layer(this.cell[element], window.axis);
      return at >= window.from && at < window.to;
    };
    let n = 0;
    for (let f = 0; f < this.first.length; f++) {
      const hasSecond = this.second[f] !== 0;
      let inner = this.first[f];
      let isTurned = false; // Facets are walked so that they face out of their first element.
      if (hasSecond) {
        if (!window) continue;
        const other = inner + this.second[f];
        if (isIn(inner) === isIn(other)) continue;
        isTurned = !isIn(inner);
        if (isTurned) inner = other;
      } else if (!isIn(inner)) continue;
      for (let c = 0; c < 4; c++) {
        const p = this.corners[4 * f + (isTurned ? 3 - c : c)] * this.dim;
        places[c].array[3 * n] = this.points[p];
        places[c].array[3 * n + 1] = this.points[p + 1];
        places[c].array[3 * n + 2] = this.dim === 3 ? this.points[p + 2] : 1;
      }
      kind.array[n] = this.kind[inner];
      quality.array[n++] = this.quality[inner];
    }
    for (const attribute of [...places, kind, quality]) refresh(attribute, n);
    geometry.instanceCount = n;
  }

  colourBy(mode) { this.object.material.uniforms.byQuality.value = mode === 'quality' ? 1 : 0; }
}

/** Return the geometry as it is: lines above the cells in the plane, triangles in space. */
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
