'use strict';
// What the pages about one and about several materials share.

const byId = (id) => document.getElementById(id);

/** Return by what to divide lengths, and the unit to write: km for large maps in m. */
function lengthScale({ grid, unit }) {
  const isLarge = unit === 'm' && Math.max(...grid.shape) * grid.cell_size >= 10000;
  return isLarge ? { scale: 1000, unit: 'km' } : { scale: 1, unit };
}

/** Write the name of the model, the numbers about it and the verdict. */
function writeFacts(facts) {
  byId('model-name').textContent = facts.name;
  byId('facts').replaceChildren(...facts.head.map(([title, value]) => {
    const group = element('div');
    group.append(element('dt', '', title), element('dd', '', show(value)));
    return group;
  }));
  byId('verdict').textContent = facts.verdict;
  byId('verdict').classList.toggle('bad', !facts.verdict.startsWith('suitable'));
  byId('verdict').classList.toggle('warned', facts.verdict.startsWith('suitable with warnings'));
}

/** Return an entry of a legend: a swatch and its text. */
function legendEntry(colour, text) {
  const item = element('li');
  const swatch = element('i');
  swatch.style.background = colour;
  item.append(swatch, text);
  return item;
}

/** Return the entries of a legend for a scale of colours. */
function legendScale(low, high, title) {
  const item = element('li');
  const bar = element('i', 'ramp');
  bar.style.background = `linear-gradient(to right, ${RAMP.join(', ')})`;
  item.append(low, bar, high);
  return [element('li', '', title), item];
}

/** Return the layers of cells that a cut leaves; what faces the oblique view is cut away. */
function cutWindow(axis, at, shape) {
  if (axis === '') return null;
  const n = shape[axis];
  return axis === '1' ? { axis: 1, from: n - at, to: n } : { axis: Number(axis), from: 0, to: at };
}
