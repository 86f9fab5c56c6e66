'use strict';
// The persistence diagram: a class appears at one threshold and disappears at a lower one.
// Those of the complex at threshold t lie to the right of t and below it.

const DRAWN_PAIRS = 2000; // The longest-lived; Betti numbers are counted over all of them.
const STAMP = 14; // Room for a mark, in CSS pixels.
const NEVER = -0.06; // Where classes stand that nothing destroys.

class Diagram {
  /**
   * @param canvas where to draw
   * @param pairs of tusqh.explorer.arrays.pair_arrays, the longest-lived first
   * @param onFocus called with a pair, or -1, when another one is pointed at
   */
  constructor(canvas, pairs, onFocus) {
    Object.assign(this, { canvas, pairs, onFocus, threshold: 1, focus: -1, pinned: -1 });
    this.count = pairs.birth.length;
    this.drawn = Math.min(this.count, DRAWN_PAIRS);
    this.dimensions = [...new Set(pairs.dimension)].sort();
    new ResizeObserver(() => this.draw()).observe(canvas);
    canvas.addEventListener('pointermove', (event) => this.lookAt(this.hit(event)));
    canvas.addEventListener('pointerleave', () => this.lookAt(-1));
    canvas.addEventListener('click', (event) => this.pin(this.hit(event)));
    canvas.addEventListener('keydown', (event) => this.onKey(event));
  }

  birth(i) { return this.pairs.birth[i] / TOP; }

  death(i) { return this.pairs.death[i] / TOP; }

  isEssential(i) { return this.pairs.death_place[i] < 0; }

  /** Return how many classes of a dimension there are at a threshold, over all pairs. */
  countAlive(dimension, threshold) {
    const key = threshold * TOP;
    const { birth, death, dimension: of } = this.pairs;
    let n = 0;
    for (let i = 0; i < this.count; i++) {
      if (of[i] === dimension && birth[i] >= key && death[i] < key) n += 1;
    }
    return n;
  }

  lookAt(i) {
    if (i === this.focus) return;
    this.focus = i;
    this.tell();
  }

  pin(i) {
    this.pinned = i === this.pinned ? -1 : i;
    this.focus = -1;
    this.tell();
  }

  /** The pair that the page shows: under the pointer, else the pinned one. */
  get shown() { return this.focus >= 0 ? this.focus : this.pinned; }

  tell() {
    this.draw();
    this.onFocus(this.shown);
  }

  onKey(event) {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step) this.pin0((this.pinned < 0 ? (step > 0 ? -1 : 0) : this.pinned) + step);
    else if (event.key === 'Home') this.pin0(0);
    else if (event.key === 'End') this.pin0(this.drawn - 1);
    else if (event.key === 'Escape') { this.pinned = this.focus = -1; this.tell(); } else return;
    event.preventDefault();
  }

  /** Pin the next pair in the order of persistence, around the ends. */
  pin0(i) {
    if (!this.drawn) return;
    this.focus = -1;
    this.pinned = (i + this.drawn) % this.drawn;
    this.tell();
  }

  toX(value) { return 44 + value * (this.width - 44 - 12); }

  toY(value) {
    const [top, bottom] = [8, this.height - 34];
    return bottom - (bottom - top) * (value - NEVER - NEVER / 2) / (1 - 1.5 * NEVER);
  }

  place(i) { return [this.toX(this.birth(i)), this.toY(this.isEssential(i) ? NEVER : this.death(i))]; }

  hit(event) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let [best, nearest] = [-1, 10 * 10];
    for (let i = 0; i < this.drawn; i++) {
      const [a, b] = this.place(i);
      const distance = (a - x) ** 2 + (b - y) ** 2;
      if (distance < nearest) [best, nearest] = [i, distance];
    }
    return best;
  }

  draw(threshold = this.threshold) {
    this.threshold = threshold;
    if (!this.canvas.clientWidth) return;
    const { context, width, height } = prepare(this.canvas);
    [this.width, this.height] = [width, height];
    this.drawAxes(context, width, height);
    context.drawImage(this.drawAll(), 0, 0, width, height);
    const key = threshold * TOP;
    const { birth, death } = this.pairs;
    for (let i = this.drawn - 1; i >= 0; i--) {
      if (birth[i] >= key && death[i] < key) this.stamp(context, i, true);
    }
    if (this.shown >= 0) {
      const path = new Path2D();
      addShape(path, this.pairs.dimension[this.shown], ...this.place(this.shown), 7);
      context.fillStyle = DIMENSION_COLOURS[this.pairs.dimension[this.shown]];
      context.strokeStyle = '#1c2733';
      context.lineWidth = 2;
      context.fill(path);
      context.stroke(path);
    }
  }

  /** Return a picture of all classes as if none of them were there, drawn once for a size. */
  drawAll() {
    const { width, height } = this.canvas;
    if (this.all && this.all.width === width && this.all.height === height) return this.all;
    this.all = document.createElement('canvas');
    this.all.width = width;
    this.all.height = height;
    const context = this.all.getContext('2d');
    context.setTransform(this.canvas.getContext('2d').getTransform());
    for (let i = this.drawn - 1; i >= 0; i--) this.stamp(context, i, false);
    return this.all;
  }

  stamp(context, i, isAlive) {
    const [x, y] = this.place(i);
    const mark = this.makeStamps()[2 * this.pairs.dimension[i] + isAlive];
    context.drawImage(mark, x - STAMP / 2, y - STAMP / 2, STAMP, STAMP);
  }

  /** Return the marks to stamp: for each dimension those of classes not there, and there. */
  makeStamps() {
    const ratio = window.devicePixelRatio || 1;
    if (this.stamps && this.stamps.ratio === ratio) return this.stamps;
    this.stamps = [0, 1, 2, 3, 4, 5].map((key) => {
      const stamp = document.createElement('canvas');
      stamp.width = stamp.height = Math.ceil(STAMP * ratio);
      const context = stamp.getContext('2d');
      context.scale(ratio, ratio);
      const path = new Path2D();
      addShape(path, key >> 1, STAMP / 2, STAMP / 2, 4.5);
      const colour = DIMENSION_COLOURS[key >> 1];
      context.lineWidth = 1.3;
      context.strokeStyle = key & 1 ? '#ffffff' : colour;
      context.fillStyle = key & 1 ? colour : 'rgb(255 255 255 / 85%)';
      context.fill(path);
      context.stroke(path);
      return stamp;
    });
    this.stamps.ratio = ratio;
    return this.stamps;
  }

  drawAxes(context, width, height) {
    const [left, right, floor, top] = [this.toX(0), this.toX(1), this.toY(1.5 * NEVER), this.toY(1)];
    const [x, y] = [this.toX(this.threshold), this.toY(this.threshold)];
    context.fillStyle = '#dcecf7';
    context.fillRect(x, y, right - x + 8, floor - y);
    context.strokeStyle = '#8a97a3';
    context.lineWidth = 1;
    context.strokeRect(left - 0.5, top - 4.5, right - left + 8, floor - top + 5);
    context.beginPath();
    context.moveTo(left, this.toY(0));
    context.lineTo(right, top);
    context.moveTo(x, y);
    context.lineTo(right + 8, y);
    context.moveTo(x, y);
    context.lineTo(x, floor);
    context.stroke();
    context.setLineDash([2, 3]);
    context.beginPath();
    context.moveTo(left, this.toY(NEVER));
    context.lineTo(right + 8, this.toY(NEVER));
    context.stroke();
    context.setLineDash([]);
    context.fillStyle = '#5a6876';
    for (let t = 0; t <= 10; t += 2) {
      context.textAlign = 'center';
      context.textBaseline = 'top';
      context.fillText(String(t / 10), this.toX(t / 10), floor + 5);
      context.textAlign = 'right';
      context.textBaseline = 'middle';
      context.fillText(String(t / 10), left - 6, this.toY(t / 10));
    }
    context.fillText('never', left - 6, this.toY(NEVER) + 3);
    context.textAlign = 'center';
    context.textBaseline = 'bottom';
    context.fillStyle = '#3b4753';
    context.fillText('appears at threshold [-]', (left + right) / 2, height - 2);
    context.save();
    context.translate(2, (top + floor) / 2);
    context.rotate(-Math.PI / 2);
    context.textBaseline = 'top';
    context.fillText('disappears at threshold [-]', 0, 0);
    context.restore();
  }
}

/** Add the mark of a dimension to a path: circle, triangle or square, as in the figures. */
function addShape(path, dimension, x, y, size) {
  if (dimension === 0) {
    path.moveTo(x + size, y);
    path.arc(x, y, size, 0, 2 * Math.PI);
  } else if (dimension === 1) {
    path.moveTo(x, y - 1.15 * size);
    path.lineTo(x + 1.1 * size, y + 0.8 * size);
    path.lineTo(x - 1.1 * size, y + 0.8 * size);
    path.closePath();
  } else path.rect(x - 0.85 * size, y - 0.85 * size, 1.7 * size, 1.7 * size);
}
