'use strict';
// The page about a mesh of several materials: colours by material, each of which can be hidden.

class MaterialsExplorer {
  static async open() {
    const facts = JSON.parse(byId('facts-json').textContent);
    const [mesh, wishes] = await Promise.all(['mesh', 'wishes'].map((name) => unpack(name, facts.manifests[name])));
    return new MaterialsExplorer(facts, mesh, wishes);
  }

  constructor(facts, mesh, wishes) {
    this.facts = facts;
    this.wishes = new Wishes(facts.wishes, wishes);
    this.cells = new Cells(facts.grid.shape);
    this.window = null;
    document.body.classList.add(this.cells.isFlat ? 'flat' : 'solid');
    this.makeStage(mesh);
    this.makeLegend();
    this.makePanels();
    this.makeControls();
    writeFacts(facts);
    this.writeNote();
    document.body.dataset.ready = 'true';
  }

  makeStage(mesh) {
    const { facts, cells } = this;
    try {
      this.stage = new Stage(byId('stage'), cells.shape, cells.isFlat, mesh.first.length);
    } catch (reason) {
      byId('failure').hidden = false;
      byId('failure').textContent = `The view needs WebGL 2, which this browser does not offer (${reason.message}). The tables work without.`;
      return;
    }
    this.stage.up = facts.up;
    this.layer = new MeshLayer(mesh, cells, mesh.material, facts.materials.map(({ colour }) => colour));
    // Facets lie a little behind the curves at their edges.
    Object.assign(this.layer.object.material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.curves = curvesObject(mesh.points, mesh.curves);
    this.cellBoxes = new CellBoxes(cells.shape, cells.isFlat);
    this.stage.scene.add(this.layer.object, this.curves, this.cellBoxes.object);
    this.axes = new Axes(this.stage, facts.grid, lengthScale(facts));
    this.stage.look('oblique');
    byId('stage').setAttribute('aria-label', cells.isFlat
      ? 'View from above. Arrow keys move, plus and minus zoom, 0 shows everything.'
      : 'View in space. Arrow keys turn, with Shift move, plus and minus zoom, 0 shows everything.');
  }

  /** One line for each material that has elements: a box to tick, its colour and its name. */
  makeLegend() {
    this.boxes = new Map();
    const items = this.facts.materials.flatMap(({ name, colour, count }, index) => {
      if (!count) return [];
      const item = element('li');
      const label = element('label');
      const box = element('input');
      box.type = 'checkbox';
      box.checked = true;
      box.addEventListener('change', () => this.show(index, box.checked));
      const swatch = element('i');
      swatch.style.background = colour;
      label.append(box, swatch, `${name} (${show(count)})`);
      item.append(label);
      this.boxes.set(index, box);
      return [item];
    });
    byId('legend').replaceChildren(...items);
    // The legend lies in the stage, which turns and zooms with the pointer.
    for (const name of ['pointerdown', 'wheel']) {
      byId('legend').addEventListener(name, (event) => event.stopPropagation(), { passive: true });
    }
  }

  makePanels() {
    const { tables, materials } = this.facts;
    fillPanel(byId('panel-materials'), [{
      title: 'Betti numbers and size of each material, and of all together', table: tables.materials,
      options: { digits: 5, classes: { verdict: WIDE }, under: 'verdict' },
    }]);
    const colours = new Map(materials.map(({ name, colour }) => [name, colour]));
    for (const row of byId('panel-materials').querySelectorAll('tbody tr')) {
      const cell = row.cells[0];
      const colour = colours.get(cell.firstChild.textContent);
      if (!colour || row.rowIndex > materials.length) continue;
      const swatch = element('span', 'dot');
      swatch.style.background = colour;
      cell.prepend(swatch);
    }
    fillFeatures(byId('panel-features'), this.facts, this.wishes, (k) => this.showWish(k));
    fillPanel(byId('panel-pairs'), [{
      title: 'Overlap, gap and interface of every two materials', table: tables.pairs, options: { digits: 4 },
    }]);
    fillPanel(byId('panel-quality'), [
      { title: 'Quality of the elements', table: tables.elements, options: { digits: 4, classes: { unit: SMALL } } },
      { title: 'Checks of the mesh and of each material', table: tables.verdict, options: { classes: { holds: PASSES, name: WIDE, found: WIDE }, under: 'remedy' } },
    ]);
    makeTabs(document.querySelector('.tabs'));
  }

  makeControls() {
    byId('colour').addEventListener('change', () => this.recolour());
    byId('cut-axis').addEventListener('change', () => this.setCutAxis());
    byId('cut-at').addEventListener('input', () => this.setCut());
    byId('cut-axis').disabled = !this.facts.can_cut;
    byId('curves').addEventListener('change', () => {
      if (!this.stage) return;
      this.curves.visible = byId('curves').checked;
      this.stage.invalidate();
    });
    byId('copy').addEventListener('click', copyCommand);
    byId('show-all').addEventListener('click', () => this.showAll(true));
    byId('hide-all').addEventListener('click', () => this.showAll(false));
    for (const button of document.querySelectorAll('[data-look]')) {
      button.addEventListener('click', () => this.stage && this.stage.look(button.dataset.look));
    }
  }

  /** Show what it takes to open, cut or fill a class; -1: nothing. */
  showWish(k) {
    this.wishes.shown = k;
    for (const button of byId('panel-features').querySelectorAll('[data-wish]')) {
      button.setAttribute('aria-pressed', Number(button.dataset.wish) === k);
    }
    this.writeNote();
    if (!this.stage) return;
    this.cellBoxes.set(this.wishes.groups());
    this.stage.invalidate();
  }

  /** Show a material, or hide it. */
  show(index, isShown) {
    this.boxes.get(index).checked = isShown;
    if (!this.layer) return;
    this.layer.hidden[index] = !isShown;
    this.update();
  }

  showAll(isShown) {
    for (const [index, box] of this.boxes) {
      box.checked = isShown;
      if (this.layer) this.layer.hidden[index] = !isShown;
    }
    this.update();
  }

  update() {
    if (!this.layer) return;
    this.layer.update(this.window);
    this.stage.invalidate();
  }

  recolour() {
    const mode = byId('colour').value;
    byId('scale').replaceChildren(...(mode === 'quality' ? legendScale('0', '1', 'least scaled Jacobian [-]') : []));
    if (!this.layer) return;
    this.layer.colourBy(mode);
    this.stage.invalidate();
  }

  setCutAxis() {
    const [axis, at] = [byId('cut-axis').value, byId('cut-at')];
    at.disabled = axis === '';
    if (axis !== '') {
      at.max = this.cells.shape[axis];
      at.value = Math.ceil(this.cells.shape[axis] / 2);
    }
    this.setCut();
  }

  setCut() {
    this.window = cutWindow(byId('cut-axis').value, Number(byId('cut-at').value), this.cells.shape);
    this.update();
  }

  writeNote() {
    const { command } = this.facts;
    const { offer } = this.wishes;
    byId('cut-note').hidden = this.facts.can_cut;
    byId('note').hidden = !offer;
    if (offer) byId('note').textContent = describeOffer(this.wishes, this.facts);
    const goal = [command.goal, offer && `--${offer.do} ${offer.option}`].filter(Boolean).join(' ');
    writeCommand([command.before, goal, command.after].filter(Boolean).join(' '), command.note);
  }
}

/** Return the curves at which three materials meet, the outside among them. */
function curvesObject(points, curves) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
  geometry.setIndex(new THREE.BufferAttribute(curves, 1));
  const material = new THREE.LineBasicMaterial({ color: '#000000' });
  const lines = new THREE.LineSegments(geometry, material);
  lines.frustumCulled = false;
  lines.visible = false;
  return lines;
}

MaterialsExplorer.open().then((explorer) => { window.explorer = explorer; }).catch((reason) => {
  byId('failure').hidden = false;
  byId('failure').textContent = `This page cannot be shown: ${reason.message}`;
  throw reason;
});
