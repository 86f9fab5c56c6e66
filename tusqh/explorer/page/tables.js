'use strict';
// Tables of the results; every name is inserted as text, never as markup.

/**
 * Return a table of rows, numbers to the right.
 * @param options `classes` of cells by column; columns to `hide`; `digits` of numbers; the column
 *   whose text goes in small print `under` the first one
 */
function makeTable({ columns, rows }, { classes = {}, hide = [], digits = 6, under = null } = {}) {
  const shown = columns.map((name, c) => ({ name, c }))
    .filter(({ name }) => name !== under && !hide.includes(name));
  const small = columns.indexOf(under);
  const table = element('table');
  const head = table.createTHead().insertRow();
  const isNumber = (c) => rows.length > 0 && rows.every((row) => typeof row[c] !== 'string');
  for (const { name, c } of shown) {
    const cell = element('th', isNumber(c) ? 'number' : '', name.replaceAll('_', ' '));
    cell.scope = 'col';
    head.append(cell);
  }
  const body = table.createTBody();
  for (const row of rows) {
    const line = body.insertRow();
    for (const { name, c } of shown) {
      const given = classes[name] ? classes[name](row[c]) : '';
      line.append(element('td', given || (isNumber(c) ? 'number' : ''), show(row[c], digits)));
    }
    if (small >= 0 && row[small]) line.cells[0].append(element('small', '', row[small]));
  }
  return table;
}

const PASSES = (word) => ({ yes: 'good', no: 'bad' }[word] || '');
const SMALL = () => 'wide small';
const WIDE = () => 'wide';

/** Fill a panel with titled tables; those without rows say so. */
function fillPanel(panel, sections) {
  panel.replaceChildren();
  for (const { title, table, options } of sections) {
    if (!table) continue;
    panel.append(element('h2', '', title));
    const scroll = element('div', 'scroll');
    if (table.rows.length) scroll.append(makeTable(table, options));
    else scroll.append(element('p', 'empty', 'none'));
    panel.append(scroll);
  }
}

/** The table of runs of plateaus, each a row to click that shows its threshold. */
class TopologyTable {
  constructor(panel, plateaus, dimensions, onPick) {
    this.plateaus = plateaus;
    const names = dimensions.map((k) => DIMENSION_NAMES[k][1]);
    const table = makeTable({
      columns: ['below or at', 'above', ...names, 'width', 'mark'],
      rows: plateaus.runs.map((run) => [
        ...showApart(run.lower, run.upper).reverse(), ...dimensions.map((k) => run.betti[k]),
        Number((run.upper - run.lower).toPrecision(3)),
        run.start <= plateaus.chosen && plateaus.chosen <= run.end ? 'chosen' : '',
      ]),
    }, { under: 'mark' });
    panel.append(
      element('h2', '', 'Topology of the mesh at every threshold'),
      element('p', 'empty', 'One row for each range of thresholds whose meshes have the same Betti numbers.'),
      table,
    );
    this.rows = [...table.tBodies[0].rows];
    this.rows.forEach((row, r) => {
      row.className = 'pick';
      row.tabIndex = 0;
      const pick = () => onPick(plateaus.runs[r].middle);
      row.addEventListener('click', pick);
      row.addEventListener('keydown', (event) => {
        if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); pick(); }
      });
    });
  }

  mark(p) {
    const row = this.rows[this.plateaus.runs.findIndex((run) => run.start <= p && p <= run.end)];
    if (row === this.current) return;
    if (this.current) {
      this.current.classList.remove('current');
      this.current.removeAttribute('aria-current');
    }
    if (row) {
      row.classList.add('current');
      row.setAttribute('aria-current', 'true');
    }
    this.current = row;
  }
}

/** Make buttons with role "tab" show their panels, by click and arrow keys. */
function makeTabs(list, onShow) {
  const tabs = [...list.querySelectorAll('[role="tab"]')];
  const select = (tab) => {
    for (const other of tabs) {
      const isSelected = other === tab;
      other.setAttribute('aria-selected', isSelected);
      other.tabIndex = isSelected ? 0 : -1;
      document.getElementById(other.getAttribute('aria-controls')).hidden = !isSelected;
    }
    if (onShow) onShow(tab.id);
  };
  for (const tab of tabs) tab.addEventListener('click', () => select(tab));
  moveByArrows(list, tabs, select);
  select(tabs[0]);
}

/** Let arrow keys, Home and End go from button to button of a group. */
function moveByArrows(list, buttons, select) {
  list.addEventListener('keydown', (event) => {
    const at = buttons.indexOf(document.activeElement);
    const n = buttons.length;
    const next = {
      ArrowRight: (at + 1) % n, ArrowDown: (at + 1) % n, ArrowLeft: (at + n - 1) % n,
      ArrowUp: (at + n - 1) % n, Home: 0, End: n - 1,
    }[event.key];
    if (next === undefined || at < 0) return;
    event.preventDefault();
    buttons[next].focus();
    select(buttons[next]);
  });
}
