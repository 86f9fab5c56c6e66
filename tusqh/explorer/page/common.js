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

/** Write a command, and what it omits. */
function writeCommand(line, note) {
  const parts = line.split(' ').flatMap((word) => [element('span', '', word), ' ']);
  byId('command').replaceChildren(...parts.slice(0, -1)); // Lines break between words only.
  byId('command-note').textContent = note;
}

/** Copy the command, or select it where this is not allowed. */
async function copyCommand() {
  const text = byId('command').textContent;
  const button = byId('copy');
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = 'Copied';
  } catch {
    window.getSelection().selectAllChildren(byId('command')); // Ctrl+C then copies it.
    button.textContent = 'Selected';
  }
  setTimeout(() => { button.textContent = 'Copy'; }, 1500);
}

/** Return a volume of cells (in the plane an area) with its unit. */
function showVolume(cells, facts) {
  const { scale, unit } = lengthScale(facts);
  const dim = facts.grid.shape.length;
  return `${show(cells * (facts.grid.cell_size / scale) ** dim, 3)} ${unit}${dim === 2 ? '\u00b2' : '\u00b3'}`;
}

/** Return a button for an offer to change a class. */
function offerButton(wishes, k, facts, act) {
  const button = element('button', '', `${wishes.describe(k)}, ${showVolume(wishes.cells(k).length, facts)}`);
  button.type = 'button';
  button.dataset.wish = k;
  button.setAttribute('aria-pressed', k === wishes.shown);
  button.addEventListener('click', () => act(k === wishes.shown ? -1 : k));
  return button;
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
