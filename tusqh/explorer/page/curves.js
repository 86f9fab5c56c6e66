'use strict';
// Betti numbers over the threshold: solid for the mesh, dotted for the filtration,
// before features are changed, bridges built or votes overruled.  The plot lies over the slider, thumb under line.

const THUMB = 16; // Width of a slider's thumb in browsers, in CSS pixels.
const BESIDE = 26; // Room for numbers left of the slider, as in explorer.css.

class Curves {
  constructor(canvas, plateaus, dimensions, onPick) {
    Object.assign(this, { canvas, plateaus, dimensions, at: 0 });
    this.base = document.createElement('canvas');
    new ResizeObserver(() => { this.isStale = true; this.draw(); }).observe(canvas);
    const pick = (event) => {
      const { left } = canvas.getBoundingClientRect();
      onPick(Math.min(Math.max(this.toThreshold(event.clientX - left), 0), 1));
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      pick(event);
    });
    canvas.addEventListener('pointermove', (event) => { if (event.buttons & 1) pick(event); });
    let largest = 1;
    for (const key of this.series()) for (const value of key.values) largest = Math.max(largest, value);
    this.largest = largest;
  }

  /** Return every curve, those of the filtration first. */
  series() {
    const { arrays } = this.plateaus;
    return ['raw', 'mesh'].flatMap((kind) => this.dimensions.map((k) =>
      ({ kind, k, values: arrays[`${kind}_${k}`] })));
  }

  get wide() { return this.canvas.clientWidth - BESIDE - THUMB; }

  toX(threshold) { return BESIDE + THUMB / 2 + threshold * this.wide; }

  toThreshold(x) { return (x - BESIDE - THUMB / 2) / this.wide; }

  /** Few classes are told apart one by one, many by their order of magnitude. */
  toY(value) {
    const scale = this.largest <= 12 ? (v) => v : Math.log1p;
    const [top, bottom] = [8, this.canvas.clientHeight - 18];
    return bottom - (bottom - top) * scale(value) / scale(this.largest);
  }

  drawBase() {
    const { canvas, plateaus } = this;
    this.isStale = false;
    prepare(canvas);
    this.base.width = canvas.width;
    this.base.height = canvas.height;
    const context = this.base.getContext('2d');
    context.setTransform(canvas.getContext('2d').getTransform());
    context.font = '11px system-ui, "Segoe UI", Roboto, Arial, sans-serif';
    const [left, right, floor] = [this.toX(0), this.toX(1), this.toY(0)];
    const steps = this.largest <= 4 ? [0, 1, 2, 3, 4] : this.largest <= 12
      ? ticks(0, this.largest, 4).filter(Number.isInteger)
      : [0, 1, 3, 10, 30, 100, 300, 1000, 3000, 1e4, 3e4, 1e5, 3e5, 1e6];
    context.textBaseline = 'middle';
    for (const value of steps.filter((v) => v <= this.largest)) {
      const y = Math.round(this.toY(value)) + 0.5;
      context.strokeStyle = value ? '#e8ecf0' : '#8a97a3';
      context.beginPath();
      context.moveTo(left, y);
      context.lineTo(right, y);
      context.stroke();
    }
    context.textAlign = 'center';
    context.fillStyle = '#5a6876';
    for (let t = 0; t <= 10; t += 1) {
      context.fillRect(this.toX(t / 10), floor, 1, 4);
      if (t % 2 === 0) context.fillText(String(t / 10), this.toX(t / 10), floor + 11);
    }
    for (const { kind, k, values } of this.series()) {
      context.strokeStyle = DIMENSION_COLOURS[k];
      context.lineWidth = kind === 'mesh' ? 2 : 1.25;
      context.setLineDash(kind === 'mesh' ? [] : [2, 3]);
      context.beginPath();
      let isDown = false;
      for (let p = 0; p < plateaus.count; p++) {
        if (values[p] < 0) { isDown = false; continue; }
        const y = this.toY(values[p]);
        if (isDown) context.lineTo(this.toX(plateaus.upper(p)), y);
        else context.moveTo(this.toX(plateaus.upper(p)), y);
        context.lineTo(this.toX(plateaus.lower(p)), y);
        isDown = true;
      }
      context.stroke();
    }
    context.setLineDash([]);
    context.textAlign = 'right';
    context.fillStyle = '#5a6876';
    for (const value of steps.filter((v) => v <= this.largest)) {
      context.fillText(show(value), left - 5, this.toY(value));
    }
  }

  /** Draw with the threshold marked. */
  draw(p = this.at) {
    this.at = p;
    if (!this.canvas.clientWidth) return;
    if (this.isStale !== false) this.drawBase();
    const { context, height } = prepare(this.canvas);
    const { plateaus } = this;
    const [from, to] = [this.toX(plateaus.lower(p)), this.toX(plateaus.upper(p))];
    context.fillStyle = '#dcecf7';
    context.fillRect(from, 0, Math.max(to - from, 1), height - 18);
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.base, 0, 0);
    context.restore();
    const chosen = this.toX(plateaus.chosenThreshold);
    context.fillStyle = '#1c2733';
    context.beginPath(); // A flag on the axis at the chosen threshold.
    context.moveTo(chosen, height - 18);
    context.lineTo(chosen - 4, height - 11);
    context.lineTo(chosen + 4, height - 11);
    context.fill();
    const x = this.toX(plateaus.threshold(p));
    context.fillRect(x - 0.75, 0, 1.5, height - 18);
    const betti = plateaus.mesh(p) || plateaus.raw(p);
    for (const k of this.dimensions) {
      context.fillStyle = DIMENSION_COLOURS[k];
      context.strokeStyle = '#ffffff';
      context.lineWidth = 1.5;
      context.beginPath();
      context.arc(x, this.toY(betti[k]), 4, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
    }
  }
}
