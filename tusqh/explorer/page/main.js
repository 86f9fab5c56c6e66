'use strict';
// Puts the page together: one state (plateau, view, colour, cut) and what follows from it.

class Explorer {
  static async open() {
    const facts = JSON.parse(byId('facts-json').textContent);
    const names = Object.keys(facts.manifests);
    const blocks = await Promise.all(names.map((name) => unpack(name, facts.manifests[name])));
    return new Explorer(facts, Object.fromEntries(names.map((name, n) => [name, blocks[n]])));
  }

  constructor(facts, blocks) {
    this.facts = facts;
    this.isFlat = facts.grid.shape.length === 2;
    document.body.classList.add(this.isFlat ? 'flat' : 'solid');
    this.dimensions = this.isFlat ? [0, 1] : [0, 1, 2];
    this.rank = blocks.field.rank;
    // Most cells of the final mesh are those of its base; its topology may be that of a seed.
    this.plateaus = new Plateaus(blocks.plateaus, blocks.field, facts.final.base);
    this.exceptions = new Exceptions(blocks.plateaus, this.rank.length);
    this.faces = new Faces(blocks.field, facts.grid.shape);
    this.view = 'cells';
    this.window = null;
    this.wishes = new Wishes(facts.wishes, blocks.wishes);
    this.changes = [
      { cells: blocks.changes.added, colour: COLOURS.added },
      { cells: blocks.changes.left_out, colour: COLOURS.leftOut },
    ];
    this.hasGeometry = blocks.geometry.pieces.length > 0; // Images and huge files have none.
    this.hasDistance = blocks.mesh.distance !== undefined; // Of fitted meshes.
    this.makeStage(blocks);
    this.makePanels(blocks);
    this.makeControls();
    writeFacts(this.facts);
    this.setView('cells');
    this.setPlateau(this.plateaus.chosen);
    document.body.dataset.ready = 'true';
  }

  makeStage(blocks) {
    this.layers = {};
    try {
      this.stage = new Stage(byId('stage'), this.faces.shape, this.isFlat, this.faces.cell.length);
    } catch (reason) {
      byId('failure').hidden = false;
      byId('failure').textContent = `The view needs WebGL 2, which this browser does not offer (${reason.message}). Curves, diagram and tables work without.`;
      return;
    }
    this.stage.up = this.facts.up;
    this.layers.cells = new CellLayer(this.faces);
    this.layers.mesh = new MeshLayer(blocks.mesh, this.faces, blocks.mesh.kind, KIND_COLOURS);
    this.geometry = geometryObject(blocks.geometry, this.isFlat);
    this.markers = new Markers(this.facts.grid.shape, this.isFlat);
    this.boxes = new CellBoxes(this.facts.grid.shape, this.isFlat);
    const { scene } = this.stage;
    scene.add(this.layers.cells.object, this.layers.mesh.object, this.geometry, this.markers.object);
    scene.add(this.boxes.object);
    this.axes = new Axes(this.stage, this.facts.grid, lengthScale(this.facts));
    this.axes.markers = () => this.markers.places;
    this.stage.look('oblique');
    this.stage.onTurn = () => this.fillCells();
    byId('stage').setAttribute('aria-label', this.isFlat
      ? 'View from above. Arrow keys move, plus and minus zoom, 0 shows everything.'
      : 'View in space. Arrow keys turn, with Shift move, plus and minus zoom, 0 shows everything.');
  }

  makePanels(blocks) {
    this.curves = new Curves(byId('curves'), this.plateaus, this.dimensions, (t) => this.setThreshold(t));
    this.diagram = new Diagram(byId('diagram'), blocks.pairs, (pair) => this.showPair(pair));
    byId('diagram').setAttribute('aria-label', `Persistence diagram of ${this.diagram.count} classes. `
      + 'Arrow keys go from class to class, the longest-lived first; Escape leaves them.');
    this.topologies = new TopologyTable(
      byId('panel-topologies'), this.plateaus, this.dimensions, (p) => this.setPlateau(p),
    );
    const { tables } = this.facts;
    fillPanel(byId('panel-defects'), [{
      title: 'Defects of the geometry, measured but not repaired', table: tables.defects,
      options: { under: 'explanation', classes: { defect: WIDE, unit: SMALL } },
    }]);
    fillPanel(byId('panel-quality'), [
      { title: 'Checks of the final mesh', table: tables.verdict, options: { classes: { holds: PASSES, name: WIDE, found: WIDE } } },
      { title: 'Quality of its elements', table: tables.elements, options: { digits: 4, classes: { unit: SMALL } } },
      { title: 'Small features removed or filled', table: tables.features, options: { digits: 4, hide: ['x', 'y', 'z'] } },
      { title: 'Bridges between components', table: this.isFlat || tables.bridges.rows.length ? tables.bridges : null, options: { digits: 4, hide: ['x_a', 'y_a', 'z_a', 'x_b', 'y_b', 'z_b'] } },
    ]);
    makeTabs(document.querySelector('.tabs'), () => this.diagram.draw());
    this.diagram.draw(1);
    this.showPair(-1);
  }

  makeControls() {
    const slider = byId('slider');
    slider.addEventListener('input', () => this.setThreshold(Number(slider.value)));
    slider.addEventListener('keydown', (event) => this.onSliderKey(event));
    for (const button of document.querySelectorAll('[data-step]')) {
      button.addEventListener('click', () => this.step(button.dataset.step));
    }
    const views = [...document.querySelectorAll('[data-view]')].filter(
      ({ dataset }) => this.hasGeometry || dataset.view !== 'geometry',
    );
    byId('view-geometry').hidden = !this.hasGeometry;
    byId('outline').closest('label').hidden = !this.hasGeometry;
    for (const button of views) button.addEventListener('click', () => this.setView(button.dataset.view));
    moveByArrows(byId('views'), views, (button) => this.setView(button.dataset.view));
    byId('colour').addEventListener('change', () => this.recolour());
    byId('outline').addEventListener('change', () => this.setView(this.view));
    byId('cut-axis').addEventListener('change', () => this.setCutAxis());
    byId('cut-at').addEventListener('input', () => this.setCut());
    for (const button of document.querySelectorAll('[data-look]')) {
      button.addEventListener('click', () => this.stage && this.stage.look(button.dataset.look));
    }
    const up = byId('up');
    const label = () => { up.textContent = `up: ${this.stage ? this.stage.up : 'z'}`; };
    up.addEventListener('click', () => {
      if (!this.stage) return;
      this.stage.up = { z: 'y', y: 'x', x: 'z' }[this.stage.up];
      this.stage.look('oblique');
      label();
    });
    label();
    byId('copy').addEventListener('click', copyCommand);
  }

  onSliderKey(event) {
    const step = {
      ArrowLeft: '-1', ArrowDown: '-1', ArrowRight: '+1', ArrowUp: '+1',
      PageDown: '-run', PageUp: '+run', Home: 'least', End: 'most',
    }[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.step(step);
  }

  step(how) {
    const { plateaus } = this;
    const last = plateaus.count - 1;
    this.setPlateau({
      '-1': () => Math.min(this.plateau + 1, last), '+1': () => Math.max(this.plateau - 1, 0),
      '-run': () => plateaus.nextRun(this.plateau, -1), '+run': () => plateaus.nextRun(this.plateau, 1),
      least: () => last, most: () => 0, chosen: () => plateaus.chosen,
    }[how]());
  }

  setThreshold(threshold) {
    const p = this.plateaus.find(threshold);
    // While the thumb is dragged within a plateau it snaps back to where the plateau is shown.
    this.setPlateau(p);
  }

  /** Show a plateau: the one step that everything follows. */
  setPlateau(p) {
    const start = performance.now();
    const { plateaus } = this;
    const threshold = plateaus.threshold(p);
    byId('slider').value = threshold;
    const leaves = this.view === 'geometry' || (this.view === 'mesh' && p !== plateaus.chosen);
    if (leaves && this.plateau !== undefined && p !== this.plateau) this.setView('cells');
    if (p !== this.plateau) {
      this.plateau = p;
      this.showWish(-1);
      this.exceptions.moveTo(p);
      this.drawCells();
      this.curves.draw(p);
      this.diagram.draw(threshold);
      this.writeState();
    }
    performance.measure('slider step', { start, end: performance.now() });
  }

  drawCells() {
    if (!this.stage) return;
    this.fillCells();
    this.stage.invalidate();
  }

  fillCells() {
    if (this.plateau === undefined) return;
    const cut = this.plateaus.cut[this.plateau];
    this.layers.cells.update(cut, this.exceptions, this.window, this.stage.facing);
  }

  /** Show the kept cells, the final mesh or the geometry. */
  setView(view) {
    this.view = view;
    // The mesh and all facts about it belong to one threshold.
    if (view === 'mesh' && this.plateau !== this.plateaus.chosen) this.setPlateau(this.plateaus.chosen);
    for (const button of document.querySelectorAll('[data-view]')) {
      const isShown = button.dataset.view === view;
      button.setAttribute('aria-checked', isShown);
      button.tabIndex = isShown ? 0 : -1;
    }
    const modes = {
      cells: [['plain', 'plain'], ['fraction', 'volume fraction']],
      mesh: [
        ['plain', 'templates'], ['quality', 'scaled Jacobian'],
        ...(this.hasDistance ? [['distance', 'distance']] : []),
      ],
      geometry: [['plain', this.isFlat ? 'plain' : 'front and back']],
    }[view];
    byId('cut-axis').disabled = view === 'geometry';
    this.allowCut();
    const colour = byId('colour');
    const before = colour.value;
    colour.replaceChildren(...modes.map(([value, text]) => new Option(text, value)));
    colour.value = modes.some(([value]) => value === before) ? before : 'plain';
    if (this.stage) {
      this.layers.cells.object.visible = view === 'cells';
      this.layers.mesh.object.visible = view === 'mesh';
      this.geometry.visible = view === 'geometry' || (this.isFlat && byId('outline').checked);
    }
    if (view !== 'cells') this.wishes.shown = -1;
    this.drawChanges();
    if (this.plateau !== undefined) this.writeState();
    this.recolour();
  }

  /** Show the cells of a wish, or those in which the final mesh differs from its base. */
  drawChanges() {
    if (!this.stage) return;
    this.boxes.set(this.view === 'mesh' ? this.changes : this.wishes.groups());
    this.stage.invalidate();
  }

  /** Show what it takes to open, cut or fill a class; -1: nothing. */
  showWish(k) {
    if (k === this.wishes.shown) return;
    this.wishes.shown = -1;
    if (k >= 0) {
      if (this.view !== 'cells') this.setView('cells');
      this.setPlateau(this.plateaus.chosen);
      this.wishes.shown = k;
    }
    this.drawChanges();
    if (this.plateau !== undefined) {
      this.writeState();
      this.showPair(this.diagram.shown);
      this.writeLegend(byId('colour').value);
    }
  }

  recolour() {
    const mode = byId('colour').value;
    if (this.stage) {
      for (const layer of Object.values(this.layers)) layer.colourBy(mode);
      this.stage.invalidate();
    }
    this.writeLegend(mode);
  }

  allowCut() {
    byId('cut-at').disabled = this.view === 'geometry' || byId('cut-axis').value === '';
  }

  setCutAxis() {
    this.allowCut();
    const [axis, at] = [byId('cut-axis').value, byId('cut-at')];
    if (axis !== '') {
      at.max = this.faces.shape[axis];
      at.value = Math.ceil(this.faces.shape[axis] / 2);
    }
    this.setCut();
  }

  /** Cut the side that faces the oblique view away: high x, low y, high z. */
  setCut() {
    this.window = cutWindow(byId('cut-axis').value, Number(byId('cut-at').value), this.faces.shape);
    this.drawCells();
    if (this.stage) this.layers.mesh.update(this.window);
    if (this.plateau !== undefined) this.writeLegend(byId('colour').value);
  }

  /** Light up what creates and destroys a class, and say it in words. */
  showPair(i) {
    const { pairs } = this.diagram;
    const card = byId('pair');
    if (this.stage) {
      this.markers.set(i < 0 ? [] : [
        { index: pairs.death_place[i], colour: COLOURS.death, label: `gone at ${show(this.diagram.death(i), 4)}`, shift: 12 },
        { index: pairs.birth_place[i], colour: COLOURS.birth, label: `appears at ${show(this.diagram.birth(i), 4)}`, shift: -12 },
      ]);
      this.stage.invalidate();
    }
    card.replaceChildren();
    if (i < 0) {
      card.append(element('p', 'quiet', 'Point at a class to see where it appears and disappears; '
        + 'click to keep it. With the keyboard: arrow keys in the diagram.'));
      return;
    }
    const [birth, death] = [this.diagram.birth(i), this.diagram.death(i)];
    const name = DIMENSION_NAMES[pairs.dimension[i]][0];
    const never = this.diagram.isEssential(i);
    card.append(element('strong', '', `${name[0].toUpperCase()}${name.slice(1)}, lives over ${show(birth - death, 4)} of the threshold`));
    const line = (colour, text) => {
      const p = element('p');
      const dot = element('span', 'dot');
      dot.style.background = colour;
      p.append(dot, text);
      card.append(p);
    };
    const describe = (index) => (this.markers ? this.markers.describe(index) : '');
    line(COLOURS.birth, `appears at ${show(birth, 4)}: ${describe(pairs.birth_place[i])} enters`);
    line(COLOURS.death, never ? 'nothing destroys it' : `disappears at ${show(death, 4)}: ${describe(pairs.death_place[i])} enters`);
    const buttons = element('div', 'buttons');
    const add = (text, act) => {
      const button = element('button', '', text);
      button.type = 'button';
      button.addEventListener('click', act);
      buttons.append(button);
    };
    add('Set threshold to birth', () => this.setThreshold(birth));
    if (!never) add('Set threshold to death', () => this.setThreshold(death));
    add('Zoom to feature', () => this.stage && this.stage.approach(this.markers.locate(pairs.birth_place[i]).centre));
    card.append(buttons);
    this.offer(i, card);
  }

  /** Offer what can be done about a class at the cells of the final mesh's base. */
  offer(i, card) {
    const numbers = this.wishes.of(i);
    if (!numbers.length) return;
    card.append(element('p', 'quiet', `At the threshold ${show(this.facts.final.base, 6)}, by itself:`));
    const buttons = element('div', 'buttons');
    for (const k of numbers) {
      const { why, do: what } = this.wishes.offers[k];
      if (why) {
        card.append(element('p', 'quiet', `${what}: ${why}`));
        continue;
      }
      buttons.append(offerButton(this.wishes, k, this.facts, (n) => this.showWish(n)));
    }
    card.append(buttons);
  }

  /** Return what is on the screen, as numbers. */
  state() {
    const { plateaus, plateau: p } = this;
    const { removed, filled } = this.exceptions.count(this.rank, plateaus.cut[p]);
    return {
      threshold: plateaus.threshold(p), lower: plateaus.lower(p), upper: plateaus.upper(p),
      cells: plateaus.byFraction[p] - removed + filled, removed, filled,
      mesh: plateaus.mesh(p), raw: plateaus.raw(p),
    };
  }

  writeState() {
    const now = this.state();
    const { grid, chosen, final } = this.facts;
    const { offer } = this.wishes;
    byId('threshold').textContent = show(now.threshold, 8);
    const [lower, upper] = showApart(now.lower, now.upper);
    byId('interval').textContent = `plateau ${lower} < t \u2264 ${upper}`;
    const isLocal = this.view === 'mesh' && final.is_local;
    if (isLocal || offer) now.mesh = isLocal ? final.betti : offer.betti;
    if (isLocal) now.cells = final.cells;
    if (offer) now.cells += (offer.adds ? 1 : -1) * this.wishes.cells(this.wishes.shown).length;
    const betti = now.mesh || now.raw;
    byId('betti').replaceChildren(...this.dimensions.map((k) => {
      const row = element('div');
      const swatch = element('i');
      swatch.style.background = DIMENSION_COLOURS[k];
      row.append(swatch, element('b', '', show(betti[k])), DIMENSION_NAMES[k][betti[k] === 1 ? 0 : 1]);
      if (now.mesh && now.raw[k] !== now.mesh[k]) row.append(element('small', '', `(filtration: ${show(now.raw[k])})`));
      return row;
    }));
    const whose = now.mesh ? '' : 'of the filtration; mesh not predicted here';
    if (whose) byId('betti').append(element('p', '', whose));
    const { scale, unit } = lengthScale(this.facts);
    const volume = now.cells * (grid.cell_size / scale) ** grid.shape.length;
    const dropped = [now.removed && `${show(now.removed)} removed`, now.filled && `${show(now.filled)} filled`].filter(Boolean);
    byId('cells').textContent = `${show(now.cells)} cells kept${dropped.length ? ` (${dropped.join(', ')})` : ''}`;
    byId('volume').textContent = `${this.isFlat ? 'area' : 'volume'} ${show(volume, 4)} ${unit}${this.isFlat ? '\u00b2' : '\u00b3'}`;
    const slider = byId('slider');
    const words = this.dimensions.map((k) => `${betti[k]} ${DIMENSION_NAMES[k][betti[k] === 1 ? 0 : 1]}`);
    slider.setAttribute('aria-valuetext', `${show(now.threshold, 8)}: ${words.join(', ')}${whose && ` (${whose})`}, ${now.cells} cells kept`);
    const { command } = this.facts;
    let goal = this.view === 'mesh' && command.goal ? command.goal : `--threshold ${now.threshold}`;
    if (offer) goal += ` --${offer.do} ${offer.row}`;
    const line = `${command.before} ${goal} ${command.after}`;
    writeCommand(line, command.note);
    this.writeDiagramLegend(now);
    this.topologies.mark(this.plateau);
    const note = byId('note');
    note.hidden = this.view === 'cells' && !offer;
    if (offer) note.textContent = `With ${this.wishes.describe(this.wishes.shown)}`;
    else if (isLocal) note.textContent = describeLocal(final, chosen);
    else if (this.view === 'mesh') note.textContent = `Mesh at the chosen threshold ${show(chosen.threshold)}: ${chosen.reason}`;
    else note.textContent = 'The geometry of the file, unrepaired';
  }

  writeDiagramLegend(now) {
    byId('diagram-legend').replaceChildren(...this.dimensions.map((k) => {
      const row = element('div');
      const swatch = element('i');
      swatch.style.background = DIMENSION_COLOURS[k];
      const isPaired = this.diagram.dimensions.includes(k) || now.raw[k] === 0;
      const mark = ['circles', 'triangles', 'squares'][k];
      const text = isPaired
        ? `${DIMENSION_NAMES[k][1]} (${mark}): ${show(this.diagram.countAlive(k, now.threshold))} in the filtration at ${show(now.threshold)}`
        : `${DIMENSION_NAMES[k][1]}: not paired on a grid this large`;
      row.append(swatch, text);
      return row;
    }));
  }

  writeLegend(mode) {
    const outline = this.isFlat && this.hasGeometry && byId('outline').checked ? [legendEntry(COLOURS.outline, 'geometry, unrepaired')] : [];
    let items = [];
    if (this.view === 'cells') {
      items = mode === 'fraction' ? legendScale('0', '1', 'volume fraction [-]') : [legendEntry(COLOURS.material, 'kept cells')];
      if (this.window && mode !== 'fraction') items.push(legendEntry(COLOURS.section, 'cut'));
      if (this.wishes.offer) items.push(legendEntry(...(this.wishes.offer.adds ? [COLOURS.added, 'cells to add'] : [COLOURS.leftOut, 'cells to leave out'])));
      if (this.facts.has_removed) items.push(legendEntry(COLOURS.removed, 'removed components'));
      if (this.facts.has_filled) items.push(legendEntry(COLOURS.filled, this.isFlat ? 'filled holes' : 'filled voids'));
      items.push(...outline);
    } else if (this.view === 'mesh') {
      const [cells, units] = this.facts.farthest.map((length) => show(length, 3));
      if (mode === 'quality') items = legendScale('0', '1', 'least scaled Jacobian [-]');
      else if (mode === 'distance') items = legendScale('0', `${cells} cells (${units} ${this.facts.unit}) or more`, 'distance of the boundary from the geometry');
      else items = this.facts.kinds.map(({ name, index, count }) => legendEntry(KIND_COLOURS[index], `${name} (${show(count)})`));
      const { added, left_out: leftOut, base } = this.facts.final;
      if (added) items.push(legendEntry(COLOURS.added, `cells added to those of ${show(base)} (${show(added)})`));
      if (leftOut) items.push(legendEntry(COLOURS.leftOut, `cells of ${show(base)} left out (${show(leftOut)})`));
      items.push(...outline);
    } else if (this.isFlat) items = [legendEntry(COLOURS.outline, 'geometry, unrepaired')];
    else items = [legendEntry(COLOURS.front, 'outer side'), legendEntry(COLOURS.back, 'inner side')];
    byId('legend').replaceChildren(...items);
  }
}

/** Return what a mesh of local changes is, in words. */
function describeLocal(final, chosen) {
  const n = final.added + final.left_out;
  const what = n === 1 ? '1 cell differs' : `${show(n)} cells differ`;
  const seed = chosen.threshold === final.base ? '' : `, with the topology of ${show(chosen.threshold)}`;
  return `Mesh of the cells of ${show(final.base)}${seed}; ${what}.`;
}

Explorer.open().then((explorer) => { window.explorer = explorer; }).catch((reason) => {
  byId('failure').hidden = false;
  byId('failure').textContent = `This page cannot be shown: ${reason.message}`;
  throw reason;
});
