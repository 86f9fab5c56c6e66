'use strict';
// Axes with units, and the names of highlighted places, drawn over the stage.

class Axes {
  /**
   * @param stage the stage
   * @param grid {shape, cell_size, origin} of the background grid
   * @param lengths {scale, unit} of the numbers to write
   */
  constructor(stage, grid, { scale, unit }) {
    this.stage = stage;
    this.canvas = stage.box.querySelector('#overlay');
    this.grid = grid;
    this.scale = scale;
    this.unit = unit;
    this.markers = () => [];
    stage.afterDraw.push(() => this.draw());
  }

  toModel(axis, cells) {
    return (this.grid.origin[axis] + cells * this.grid.cell_size) / this.scale;
  }

  toCells(axis, length) {
    return (length * this.scale - this.grid.origin[axis]) / this.grid.cell_size;
  }

  draw() {
    const pen = prepare(this.canvas);
    if (this.stage.isFlat) this.drawFrame(pen); else this.drawBox(pen);
    this.drawMarkers(pen);
  }

  /** In the plane: ticks along the left and lower side of the screen. */
  drawFrame({ context, width, height }) {
    const [left, below] = [58, 34];
    const from = this.stage.project([0, 0, 0]);
    const to = this.stage.project([1, 1, 0]);
    const perCell = [to[0] - from[0], to[1] - from[1]];
    const corner = this.stage.project(this.stage.shape);
    context.strokeStyle = '#c3ccd5';
    context.strokeRect(from[0], from[1], corner[0] - from[0], corner[1] - from[1]);
    context.fillStyle = '#ffffff';
    context.fillRect(0, 0, left, height);
    context.fillRect(left, height - below, width, below);
    context.strokeStyle = '#8a97a3';
    context.strokeRect(left + 0.5, -1, width, height - below + 0.5);
    context.fillStyle = '#3b4753';
    for (const axis of [0, 1]) {
      const ends = axis === 0 ? [left, width] : [height - below, 0];
      const [low, high] = ends.map((e) => this.toModel(axis, (e - from[axis]) / perCell[axis]));
      for (const value of ticks(low, high, (axis === 0 ? width : height) / 90)) {
        const at = from[axis] + this.toCells(axis, value) * perCell[axis];
        const isX = axis === 0;
        if (isX ? at < left + 12 || at > width - 70 : at > height - below - 8 || at < 30) continue;
        context.textAlign = isX ? 'center' : 'right';
        context.textBaseline = isX ? 'top' : 'middle';
        context.fillText(show(value), isX ? at : left - 7, isX ? height - below + 7 : at);
        context.fillRect(isX ? at - 0.5 : left - 4, isX ? height - below : at - 0.5, isX ? 1 : 4, isX ? 4 : 1);
      }
    }
    context.font = `600 ${context.font}`;
    context.textAlign = 'right';
    context.textBaseline = 'top';
    context.fillText(`x [${this.unit}]`, width - 10, height - below + 7);
    context.fillText(`y [${this.unit}]`, left - 7, 8);
  }

  /** In space: ticks along three edges of the grid's box that have nothing in front of them. */
  drawBox({ context }) {
    const { shape } = this.grid;
    const middle = this.stage.project(shape.map((n) => n / 2));
    const upright = ['x', 'y', 'z'].indexOf(this.stage.up);
    for (const axis of [0, 1, 2]) {
      const [u, v] = [0, 1, 2].filter((a) => a !== axis);
      let best = null;
      for (let corner = 0; corner < 4; corner++) {
        const place = [0, 0, 0];
        place[u] = (corner & 1) * shape[u];
        place[v] = (corner >> 1) * shape[v];
        const ends = [0, shape[axis]].map((at) => {
          place[axis] = at;
          return this.stage.project(place);
        });
        const at = [(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2];
        const score = axis === upright ? -at[0] : at[1];
        if (!best || score > best.score) best = { score, ends, at };
      }
      this.drawAxis(context, axis, best, middle, axis === upright);
    }
  }

  drawAxis(context, axis, { ends, at }, middle, isUpright) {
    const along = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
    const length = Math.hypot(...along);
    if (length < 50) return;
    let away = [-along[1] / length, along[0] / length];
    if (away[0] * (at[0] - middle[0]) + away[1] * (at[1] - middle[1]) < 0) away = away.map((a) => -a);
    context.textBaseline = 'middle';
    context.textAlign = away[0] < -0.35 ? 'right' : away[0] > 0.35 ? 'left' : 'center';
    context.fillStyle = '#3b4753';
    context.strokeStyle = '#8a97a3';
    const n = this.grid.shape[axis];
    const [low, high] = [this.toModel(axis, 0), this.toModel(axis, n)];
    for (const value of ticks(low, high, Math.min(Math.max(length / 48, 1), 6))) {
      const part = this.toCells(axis, value) / n;
      const x = ends[0][0] + part * along[0];
      const y = ends[0][1] + part * along[1];
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 5 * away[0], y + 5 * away[1]);
      context.stroke();
      context.fillText(show(value), x + 9 * away[0], y + 11 * away[1]);
    }
    context.save();
    context.font = `600 ${context.font}`;
    const title = `${'xyz'[axis]} [${this.unit}]`;
    if (isUpright) {
      const top = ends[0][1] < ends[1][1] ? ends[0] : ends[1];
      context.fillText(title, top[0] + 9 * away[0], top[1] - 8);
    } else context.fillText(title, at[0] + 38 * away[0], at[1] + 32 * away[1]);
    context.restore();
  }

  drawMarkers({ context, width }) {
    context.textBaseline = 'middle';
    for (const { centre, colour, label, shift } of this.markers()) {
      const [x, y] = this.stage.project(centre);
      context.lineWidth = 5;
      context.strokeStyle = 'rgb(255 255 255 / 90%)';
      context.beginPath();
      context.arc(x, y, 11, 0, 2 * Math.PI);
      context.stroke();
      context.lineWidth = 2.5;
      context.strokeStyle = colour;
      context.stroke();
      context.font = '600 12px system-ui, "Segoe UI", Roboto, Arial, sans-serif';
      const wide = context.measureText(label).width + 12;
      const left = x + 18 + wide > width ? x - 18 - wide : x + 18;
      context.fillStyle = colour;
      context.fillRect(left, y - 10 + shift, wide, 20);
      context.fillStyle = '#ffffff';
      context.textAlign = 'left';
      context.fillText(label, left + 6, y + 0.5 + shift);
    }
  }
}
