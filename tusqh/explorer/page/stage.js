'use strict';
// Camera, light and drawing on demand; the axes live in axes.js.

const OBLIQUE = [1.0, -1.6, 0.9]; // Where the figures look from.

const MANY_FACES = 150000; // More are drawn without smoothing where the processor draws.

/** Return whether there is no graphics card, and the processor draws. */
function drawsInSoftware() {
  const context = document.createElement('canvas').getContext('webgl2');
  const names = context && context.getExtension('WEBGL_debug_renderer_info');
  if (!names) return false;
  const name = context.getParameter(names.UNMASKED_RENDERER_WEBGL);
  context.getExtension('WEBGL_lose_context').loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

class Stage {
  /**
   * @param box element that holds the two canvases
   * @param shape cells along x, y, z
   * @param isFlat whether to look from above only
   * @param nFaces how many faces there may be to draw
   */
  constructor(box, shape, isFlat, nFaces) {
    this.box = box;
    this.shape = shape;
    this.isFlat = isFlat;
    this.up = 'z';
    this.afterDraw = [];
    this.facing = isFlat ? [UPWARDS] : [];
    this.onTurn = () => {}; // Called when other directions of faces come into sight.
    const canvas = box.querySelector('#gl');
    const antialias = nFaces < MANY_FACES || !drawsInSoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias });
    this.renderer.setClearColor('#ffffff');
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.scene = new THREE.Scene();
    this.camera = new THREE.OrthographicCamera();
    this.controls = new THREE.OrbitControls(this.camera, box);
    this.controls.enableRotate = !isFlat;
    this.controls.screenSpacePanning = true;
    this.controls.zoomToCursor = true;
    if (isFlat) this.controls.mouseButtons.LEFT = 2; // Pan.
    if (isFlat) this.controls.touches.ONE = 1;
    this.controls.addEventListener('change', () => this.invalidate());
    this.gridBox = gridBox(shape);
    if (!isFlat) this.scene.add(this.gridBox);
    new ResizeObserver(() => this.resize()).observe(box);
    box.addEventListener('keydown', (event) => this.onKey(event));
    this.resize();
    this.look('oblique');
  }

  get centre() { return new THREE.Vector3(...this.shape).multiplyScalar(0.5); }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    const tall = this.camera.top || 1;
    this.camera.left = -tall * width / height;
    this.camera.right = tall * width / height;
    this.camera.top = tall;
    this.camera.bottom = -tall;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  /** Look from a side ("x", "y", "z", "oblique") at the whole grid, or fit it as it is seen. */
  look(from) {
    const up = this.isFlat ? [0, 1, 0] : ['x', 'y', 'z'].map((axis) => Number(axis === this.up));
    const sides = { x: [1, 0, 0], y: [0, -1, 0], z: [0, 0, 1], oblique: OBLIQUE };
    let towards = new THREE.Vector3(...(this.isFlat ? [0, 0, 1] : sides[from] || [0, 0, 0]));
    if (!this.isFlat && from !== 'fit') {
      const { x, y, z } = towards;
      if (this.up === 'y') towards.set(x, z, -y); // Turned about x.
      if (this.up === 'x') towards.set(z, x, y); // Turned about the diagonal.
    }
    if (from === 'fit' && !this.isFlat) {
      towards = this.camera.position.clone().sub(this.controls.target);
    }
    towards.normalize();
    this.camera.up.set(...up);
    if (Math.abs(this.camera.up.dot(towards)) > 0.999) towards.addScaledVector(
      this.up === 'z' ? new THREE.Vector3(0, -1, 0) : new THREE.Vector3(0, 0, 1), this.isFlat ? 0 : 1e-3,
    );
    this.controls.target.copy(this.centre);
    const far = 2 * Math.hypot(...this.shape) + 10;
    this.camera.position.copy(this.centre).addScaledVector(towards, far);
    this.camera.near = 0;
    this.camera.far = 3 * far;
    this.camera.zoom = 1;
    this.camera.lookAt(this.centre);
    this.camera.updateMatrixWorld();
    this.fit();
    this.controls.update();
    this.invalidate();
  }

  /** Choose the zoom that shows the whole grid with room for its axes. */
  fit() {
    const inverse = this.camera.matrixWorld.clone().invert();
    let [wide, tall] = [0, 0];
    for (let corner = 0; corner < 8; corner++) {
      const at = new THREE.Vector3(...this.shape.map((n, a) => (corner >> a & 1) * n)).applyMatrix4(inverse);
      wide = Math.max(wide, Math.abs(at.x));
      tall = Math.max(tall, Math.abs(at.y));
    }
    const { clientWidth: width, clientHeight: height } = this.box;
    const margin = this.isFlat ? 40 : 44;
    this.camera.top = Math.max(
      tall * height / Math.max(height - 2 * margin, 50),
      wide * height / Math.max(width - 2 * (margin + 26), 50),
    );
    this.camera.zoom = 1;
    this.resize();
  }

  onKey(event) {
    const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (turn) {
      if (this.isFlat || event.shiftKey) this.pan(turn[0], turn[1]); else this.orbit(turn[0], turn[1]);
    } else if (event.key === '+' || event.key === '=') this.zoomBy(1.2);
    else if (event.key === '-') this.zoomBy(1 / 1.2);
    else if (event.key === '0' || event.key === 'Home') this.look('oblique');
    else return;
    event.preventDefault();
  }

  orbit(right, over) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new THREE.Vector3().crossVectors(this.camera.up, offset).normalize();
    offset.applyAxisAngle(this.camera.up, right * Math.PI / 24);
    const tilted = offset.clone().applyAxisAngle(side, -over * Math.PI / 24);
    const angle = tilted.angleTo(this.camera.up);
    const isSafe = over === 0 || (angle > 0.05 && angle < Math.PI - 0.05);
    this.camera.position.copy(this.controls.target).add(isSafe ? tilted : offset);
    this.controls.update();
    this.invalidate();
  }

  pan(right, up) {
    const step = 0.1 * this.camera.top / this.camera.zoom;
    const move = new THREE.Vector3(right * step, up * step, 0).applyQuaternion(this.camera.quaternion);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
    this.invalidate();
  }

  zoomBy(factor) {
    this.camera.zoom = Math.min(Math.max(this.camera.zoom * factor, 0.2), 200);
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  /** Bring a place, in cells, to the middle, near enough to see cells. */
  approach(place) {
    const move = new THREE.Vector3(...place).sub(this.controls.target);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.camera.zoom = Math.max(this.camera.zoom, this.camera.top / 10);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.invalidate();
  }

  /** Return where a place, in cells, is on the screen, in CSS pixels. */
  project(place) {
    const at = new THREE.Vector3(...place).project(this.camera);
    return [(at.x + 1) / 2 * this.box.clientWidth, (1 - at.y) / 2 * this.box.clientHeight];
  }

  /** Follow the eye to another octant. */
  turn(eye) {
    const facing = eye.toArray().map((towards, axis) => 2 * axis + (towards > 0));
    if (String(facing) === String(this.facing)) return;
    this.facing = facing;
    this.hideNearEdges(eye);
    this.onTurn();
  }

  /** Leave out the edges of the box that stand between the eye and the cells. */
  hideNearEdges(eye) {
    const nearest = (eye.x > 0) + 2 * (eye.y > 0) + 4 * (eye.z > 0);
    const { index } = this.gridBox.geometry;
    let n = 0;
    for (let corner = 0; corner < 8; corner++) {
      for (const other of [corner ^ 1, corner ^ 2, corner ^ 4]) {
        if (corner > other || corner === nearest || other === nearest) continue;
        index.array[n++] = corner;
        index.array[n++] = other;
      }
    }
    index.needsUpdate = true;
  }

  invalidate() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.draw();
    });
  }

  draw() {
    this.camera.updateMatrixWorld();
    const eye = new THREE.Vector3(0, 0, 1).applyQuaternion(this.camera.quaternion);
    const light = new THREE.Vector3(-0.35, 0.55, 1).applyQuaternion(this.camera.quaternion).normalize();
    this.scene.traverse(({ material }) => {
      if (!material || !material.uniforms) return;
      material.uniforms.towards.value.copy(light);
      material.uniforms.eye.value.copy(eye);
      material.uniforms.shading.value = this.isFlat ? 0 : 1;
    });
    if (!this.isFlat) this.turn(eye);
    this.renderer.render(this.scene, this.camera);
    for (const draw of this.afterDraw) draw();
  }
}

/** Return the edges of the background grid's box, nine of twelve at a time. */
function gridBox(shape) {
  const geometry = new THREE.BufferGeometry();
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((c) => shape.map((n, a) => (c >> a & 1) * n));
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(corners), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint16Array(18), 1));
  const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: '#c3ccd5' }));
  lines.frustumCulled = false;
  return lines;
}
