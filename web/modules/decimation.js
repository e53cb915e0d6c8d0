// SPDX-License-Identifier: Apache-2.0
// From the rows of a window to the points of a curve: the least and the largest of each pixel, no peak lost.
// Pixels stand still in time, so that a curve that moves does not flicker and what was drawn before is not made again:
// while the window only moves on, the work is that of the new rows.

const COLUMNS = ['x', 'y', 'low', 'high'];

/**
 * Points of one curve, `channel` 'size', 'axial' or 'lateral'; `truth`: the true force in place of the estimate, without
 * bounds. Points [begin, count) of x [s], y, low, high [N] are those of the window; y is NaN where the curve is broken: a
 * pixel without a measured row, or rows more than `gap_s` apart. No allocation after this call.
 */
export function createDecimation(store, channel, truth, pixels, z) {
  const { columns, capacity } = store, room = 6 * pixels + 64;
  const values = columns[`${truth ? 'truth_' : ''}${channel}_N`], sigmas = columns[`sigma_${channel}_N`];
  const floor = channel === 'axial' ? -Infinity : 0; // a size is never negative
  const out = { x: new Float64Array(room), y: new Float64Array(room), low: new Float64Array(room), high: new Float64Array(room), begin: 0, count: 0, update };
  let step_s = NaN, from_s = NaN, until_s = NaN, epoch = -1, settled = 0; // of the points that there are; the latest pixel may grow
  let low = Infinity, high = -Infinity;

  const add = (slot) => {
    const i = out.count++;
    out.x[i] = columns.time_s[slot];
    out.y[i] = values[slot];
    out.low[i] = low;
    out.high[i] = high;
  };
  const breakCurve = () => {
    if (out.count <= out.begin || Number.isNaN(out.y[out.count - 1]) || out.count >= room) return;
    out.x[out.count] = out.x[out.count - 1];
    out.y[out.count++] = NaN;
  };
  const flush = (least, most) => {
    if (least < 0) return breakCurve();
    if (out.count + 2 > room) return;
    const early = columns.time_s[least] <= columns.time_s[most];
    add(early ? least : most);
    if (least !== most) add(early ? most : least);
  };
  /** Rows from the one at `i` on to `end`; the first begins a pixel. */
  function run(i, end, gap_s) {
    let pixel = NaN, least = -1, most = -1, last_s = i > 0 ? columns.time_s[store.slot(i - 1)] : -Infinity;
    for (let slot = store.slot(i); i < end; ++i, slot = slot + 1 === capacity ? 0 : slot + 1) {
      const time_s = columns.time_s[slot], at = Math.floor(time_s / step_s);
      if (at !== pixel) {
        if (!Number.isNaN(pixel)) flush(least, most);
        pixel = at;
        least = most = -1;
        low = Infinity;
        high = -Infinity;
        if (time_s - last_s > gap_s) breakCurve();
      }
      last_s = time_s;
      const value = values[slot];
      if (!Number.isFinite(value) || !(truth || columns.shown[slot] === 1)) continue;
      if (least < 0 || value < values[least]) least = slot;
      if (most < 0 || value > values[most]) most = slot;
      if (truth) continue;
      const reach = z * sigmas[slot];
      low = Math.min(low, Math.max(floor, value - reach));
      high = Math.max(high, value + reach);
    }
    if (Number.isNaN(pixel)) return;
    until_s = pixel * step_s;
    settled = out.count;
    flush(least, most);
  }
  /** Room for new points: those before the window go. */
  function drop() {
    while (out.begin < out.count && out.x[out.begin] < from_s - 2 * step_s) ++out.begin;
    if (out.begin < room / 3) return;
    for (const name of COLUMNS) out[name].copyWithin(0, out.begin, out.count);
    out.count -= out.begin;
    out.begin = 0;
  }
  function update(window) {
    const goesOn = window.step_s === step_s && store.epoch === epoch && window.from_s >= from_s && window.to_s >= until_s;
    from_s = window.from_s;
    if (goesOn) {
      out.count = settled; // and with it what the latest pixel made
      drop();
    } else {
      out.begin = out.count = settled = 0;
      until_s = NaN;
      ({ step_s } = window);
      ({ epoch } = store);
    }
    const start = goesOn && Number.isFinite(until_s) ? store.lowerBound(until_s) : store.lowerBound(from_s - step_s);
    run(Math.max(0, start), Math.min(store.length, store.lowerBound(window.to_s) + 1), window.gap_s);
    return out;
  }
  return out;
}

/**
 * Stretches in which nothing was measured: [begin, count) of from, to [s] and the status that they had; -1: no rows came.
 * Those less than a pixel apart are one. Likewise only the new rows are looked at.
 */
export function createStretches(store, pixels) {
  const { columns } = store, room = 2 * pixels + 16;
  const out = { from: new Float64Array(room), to: new Float64Array(room), status: new Int8Array(room), count: 0, update };
  let step_s = NaN, from_s = NaN, epoch = -1, until_s = NaN, settled = 0, settledEnd = NaN;
  const add = (from, to, status) => {
    const last = out.count - 1;
    if (last >= 0 && out.status[last] === status && from - out.to[last] < step_s) out.to[last] = to;
    else if (out.count < room) {
      out.from[out.count] = from;
      out.to[out.count] = to;
      out.status[out.count++] = status;
    }
  };
  const look = (slot, next_s, gap_s) => {
    const at = columns.time_s[slot];
    if (next_s - at > gap_s) add(at, next_s, -1);
    else if (columns.shown[slot] !== 1) add(at, next_s, columns.status[slot]);
  };
  function drop() {
    let gone = 0;
    while (gone < out.count && out.to[gone] < from_s) ++gone;
    if (gone < room / 3) return;
    for (const name of ['from', 'to', 'status']) out[name].copyWithin(0, gone, out.count);
    out.count -= gone;
  }
  function update(window) {
    const goesOn = window.step_s === step_s && store.epoch === epoch && window.from_s >= from_s;
    from_s = window.from_s;
    if (goesOn) {
      out.count = settled; // the latest row's stretch went to the present moment
      if (out.count) out.to[out.count - 1] = settledEnd;
      drop();
    } else {
      out.count = 0;
      ({ step_s } = window);
      ({ epoch } = store);
      until_s = NaN;
    }
    let i = Math.max(0, Number.isFinite(until_s) ? store.lowerBound(until_s) : store.lowerBound(from_s) - 1);
    for (; i + 1 < store.length; ++i) look(store.slot(i), columns.time_s[store.slot(i + 1)], window.gap_s);
    settled = out.count;
    settledEnd = settled ? out.to[settled - 1] : NaN;
    if (store.length) {
      until_s = store.lastTime();
      look(store.slot(store.length - 1), Math.max(until_s, window.now_s), window.gap_s);
    }
    return out;
  }
  return out;
}
