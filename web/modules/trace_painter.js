// SPDX-License-Identifier: Apache-2.0
// Paints curves with bands, stretches and marks into a plot's canvas, from typed arrays and without garbage.

/** Pixels of a plot: x = ax t + bx, y = ay v + by; `k`: the unit's numbers a newton. */
function pixelsOf(u, k) {
  const { left, top, width, height } = u.bbox, { x, y } = u.scales;
  const ax = width / (x.max - x.min), ay = -height / (y.max - y.min);
  return { ax, bx: left - ax * x.min, ay: ay * k, by: top - ay * y.max };
}

export function clipped(u, paint) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  paint(ctx);
  ctx.restore();
}

/** More points than this a pixel are painted column by column: a stroke that goes up and down in every pixel is costly. */
const DENSE = 1.2;
const isDense = (u, points) => points.count - points.begin > (DENSE * u.bbox.width) / devicePixelRatio;

/** Upright pixels from `under` to `over`, joined where the curve is; dots are `least` high. */
function paintColumns(u, ctx, points, under, over, k, least) {
  const { ax, bx, ay, by } = pixelsOf(u, k), wide = devicePixelRatio;
  let column = -1, low = Infinity, high = -Infinity, before = NaN;
  const paint = () => {
    if (high < low) return;
    const more = Math.max(0, least - (high - low)) / 2;
    ctx.fillRect(column * wide, low - more, wide, high - low + 2 * more);
  };
  for (let i = points.begin; i < points.count; ++i) {
    const gap = Number.isNaN(points.y[i]), at = Math.floor((ax * points.x[i] + bx) / wide);
    if (at !== column || gap) {
      paint();
      column = at;
      const joined = !gap && !Number.isNaN(before);
      low = joined ? before : Infinity;
      high = joined ? before : -Infinity;
    }
    before = NaN;
    if (gap) continue;
    const top = ay * over[i] + by, bottom = ay * under[i] + by;
    low = Math.min(low, top);
    high = Math.max(high, bottom);
    if (under === over) before = top;
  }
  paint();
}

/** `points`: of createDecimation(); the band between its bounds, broken where the curve is. */
export function paintBand(u, ctx, points, k, fill) {
  ctx.fillStyle = fill;
  if (isDense(u, points)) return paintColumns(u, ctx, points, points.low, points.high, k, 0);
  const { ax, bx, ay, by } = pixelsOf(u, k);
  for (let begin = points.begin; begin < points.count; ) {
    let end = begin;
    while (end < points.count && !Number.isNaN(points.y[end])) ++end;
    if (end > begin) {
      ctx.beginPath();
      for (let i = begin; i < end; ++i) ctx.lineTo(ax * points.x[i] + bx, ay * points.high[i] + by);
      for (let i = end - 1; i >= begin; --i) ctx.lineTo(ax * points.x[i] + bx, ay * points.low[i] + by);
      ctx.fill();
    }
    begin = end + 1;
  }
}

export function paintLine(u, ctx, points, k, ink, width, dash) {
  if (isDense(u, points)) {
    ctx.fillStyle = ink;
    return paintColumns(u, ctx, points, points.y, points.y, k, width * devicePixelRatio);
  }
  const { ax, bx, ay, by } = pixelsOf(u, k);
  ctx.beginPath();
  let broken = true;
  for (let i = points.begin; i < points.count; ++i) {
    if (Number.isNaN(points.y[i])) broken = true;
    else {
      const x = ax * points.x[i] + bx, y = ay * points.y[i] + by;
      if (broken) ctx.moveTo(x, y);
      ctx.lineTo(x, y); // a point alone is a dot
      broken = false;
    }
  }
  ctx.strokeStyle = ink;
  ctx.lineWidth = width * devicePixelRatio;
  ctx.lineJoin = 'bevel';
  ctx.lineCap = 'round';
  ctx.setLineDash(dash ? dash.map((part) => part * devicePixelRatio) : []);
  ctx.stroke();
  ctx.setLineDash([]);
}

/** `inks(status)`: {fill, edge}. A stretch of a single frame keeps a mark on top that can be seen. */
export function paintStretches(u, ctx, stretches, inks) {
  const { ax, bx } = pixelsOf(u, 1), { top, height } = u.bbox, dot = devicePixelRatio;
  for (let i = 0; i < stretches.count; ++i) {
    const left = ax * stretches.from[i] + bx, right = ax * stretches.to[i] + bx, { fill, edge } = inks(stretches.status[i]);
    ctx.fillStyle = fill;
    ctx.fillRect(left, top, Math.max(dot, right - left), height);
    ctx.fillStyle = edge;
    ctx.fillRect(left - dot, top, Math.max(3 * dot, right - left), 4 * dot);
  }
}

/** `marks`: [{time_s, text, colour, quiet}]; the text beside its line where `named` and there is room for it. */
export function paintMarks(u, ctx, marks, named, font, paper) {
  const { ax, bx } = pixelsOf(u, 1), { left, top, width, height } = u.bbox, dot = devicePixelRatio;
  ctx.font = font;
  ctx.textBaseline = 'top';
  ctx.textAlign = 'left';
  let free = Infinity;
  for (let i = marks.length - 1; i >= 0; --i) {
    const x = Math.round(ax * marks[i].time_s + bx);
    if (x < left || x > left + width) continue;
    ctx.fillStyle = marks[i].colour;
    ctx.fillRect(x - dot / 2, top, dot, height);
    if (!named || marks[i].quiet) continue;
    const wide = ctx.measureText(marks[i].text).width, before = x + wide + 10 * dot > Math.min(left + width, free);
    const at = before ? x - wide - 5 * dot : x + 5 * dot;
    if (before && (at < left || at + wide > free)) continue;
    ctx.fillStyle = paper;
    ctx.fillRect(at - 2 * dot, top + 5 * dot, wide + 4 * dot, 15 * dot);
    ctx.fillStyle = marks[i].colour;
    ctx.fillText(marks[i].text, at, top + 7 * dot);
    free = Math.min(x, at) - 4 * dot;
  }
}
