'use strict';
// One colour for one meaning, as in tusqh/figures/style.py: colour-blind safe.

const COLOURS = {
  material: '#a9d6ee',
  removed: '#3a3a3a',
  added: '#e7298a',
  leftOut: '#3a3a3a',
  filled: '#5b8db8',
  section: '#7fb4d3',
  outline: '#555555',
  inner: '#d7e4ec',
  separating: '#029e73',
  connecting: '#d55e00',
  bridge: '#de8f05',
  front: '#c9d3dc',
  back: '#e39a4e',
  birth: '#c2185b',
  death: '#1a1a1a',
};
// In the order of KINDS in tusqh/meshes/volume_mesh.py; templates at balls on sides look as
// separating ones do.
const KIND_COLOURS = ['material', 'inner', 'separating', 'connecting', 'bridge', 'separating']
  .map((key) => COLOURS[key]);
const DIMENSION_COLOURS = ['#0173b2', '#de8f05', '#029e73'];
const DIMENSION_NAMES = [['component', 'components'], ['hole', 'holes'], ['void', 'voids']];

// Matplotlib's cividis at nine steps.
const RAMP = [
  '#00224e', '#1a386f', '#434e6c', '#61656f', '#7d7c78',
  '#9b9476', '#bcae6c', '#dec958', '#fee838',
];

/** Return red, green and blue in 0..1. */
function rgb(hex) { return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255); }

/** Return a number for people: six digits, no padding. */
function show(value, digits = 6) {
  if (typeof value !== 'number') return value === null ? '' : String(value);
  if (Number.isInteger(value)) return value.toLocaleString('en-US');
  if (Math.abs(value) < 1e-4) return value.toExponential(2);
  const rounded = Number(value.toPrecision(digits));
  return Math.abs(rounded) < 1000 ? String(rounded) : rounded.toLocaleString('en-US');
}

/** Return two different numbers for people, with the digits that it takes to tell them apart. */
function showApart(low, high) {
  let digits = 5;
  while (digits < 15 && show(low, digits) === show(high, digits)) digits += 1;
  return [show(low, digits), show(high, digits)];
}

/** Return an element with a class and text. */
function element(tag, className = '', text = '') {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.textContent = text;
  return made;
}

/** Return the tick values in a range, about `count` of them. */
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
  const out = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) {
    out.push(Number((n * step).toPrecision(12)));
  }
  return out;
}

/** Make a canvas as sharp as the screen and return its context, in CSS pixels. */
function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.lineWidth = 1;
  context.setLineDash([]);
  context.font = '11px system-ui, "Segoe UI", Roboto, Arial, sans-serif';
  return { context, width, height };
}
