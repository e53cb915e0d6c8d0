// SPDX-License-Identifier: Apache-2.0
// The latest rows of one catheter, in rings that are allocated once.

/** What is kept of a row. */
export const COLUMNS = [
  'time_s', 'shown', 'status', 'size_N', 'sigma_size_N', 'axial_N', 'sigma_axial_N', 'lateral_N', 'sigma_lateral_N',
  'truth_size_N', 'truth_axial_N', 'truth_lateral_N',
];

/** Ten minutes at 60 Hz. */
export const CAPACITY = 36_000;

/** A step back in time that is more than a frame out of order: another clock, another history. */
const NEW_CLOCK_S = 2;

/**
 * Row 0 is the oldest. Times increase: a row that does not come after the latest one is left out, one that lies far before
 * it begins anew. `slot(i)` is where row i lies in each of `columns`; `epoch` changes
 * when rows change that were there before.
 */
export function createRowStore(capacity = CAPACITY) {
  const columns = Object.fromEntries(COLUMNS.map((name) => [name, new Float64Array(capacity)]));
  const store = {
    capacity, columns, first: 0, length: 0, pushed: 0, epoch: 0,
    slot: (i) => (store.first + i) % capacity,
    at: (name, i) => columns[name][store.slot(i)],
    clear() { store.first = store.length = 0; ++store.epoch; },
    lastTime: () => (store.length ? store.at('time_s', store.length - 1) : NaN),
    firstTime: () => (store.length ? store.at('time_s', 0) : NaN),
    push, merge, lowerBound,
  };

  /** The slot of a new row at `time_s`, or -1. */
  function open(time_s) {
    const last = store.lastTime();
    if (!Number.isFinite(time_s)) return -1;
    if (time_s < last - NEW_CLOCK_S) store.clear();
    else if (time_s <= last) return -1;
    if (store.length < capacity) ++store.length;
    else store.first = (store.first + 1) % capacity;
    return store.slot(store.length - 1);
  }

  /** `row`: see createRow(). Returns whether it was kept. */
  function push(row) {
    const to = open(row.get('time_s'));
    if (to < 0) return false;
    for (const name of COLUMNS) columns[name][to] = row.get(name);
    const truth = row.part('truth_tip_N');
    columns.truth_axial_N[to] = truth ? truth[2] : NaN;
    columns.truth_lateral_N[to] = truth ? Math.hypot(truth[0], truth[1]) : NaN;
    ++store.pushed;
    return true;
  }

  /** Rows of the past, `fields` each, row-major: they fill what the store does not have to within half a `step_s`. */
  function merge(fields, rows, numbers, step_s) {
    const places = COLUMNS.map((name) => fields.indexOf(name)), time = fields.indexOf('time_s'), size = fields.indexOf('size_N');
    const past = (i, k) => (COLUMNS[k] === 'shown' ? Number(Number.isFinite(numbers[i * fields.length + size])) : places[k] < 0 ? NaN : numbers[i * fields.length + places[k]]);
    const own = store.length, from = COLUMNS.map((name) => Float64Array.from({ length: own }, (_, i) => store.at(name, i)));
    const taken = [];
    for (let i = 0, k = 0, last = -Infinity; i < rows; ++i) {
      const at = numbers[i * fields.length + time];
      if (!(at > last)) continue;
      last = at;
      while (k < own && from[0][k] < at - step_s / 2) ++k;
      if (k === own || from[0][k] > at + step_s / 2) taken.push(i);
    }
    store.clear();
    const write = (value) => {
      const to = open(value(0));
      if (to >= 0) COLUMNS.forEach((name, k) => { columns[name][to] = value(k); });
    };
    let i = 0;
    for (let k = 0; k <= own; ++k) {
      for (; i < taken.length && (k === own || past(taken[i], 0) < from[0][k]); ++i) write((c) => past(taken[i], c));
      if (k < own) write((c) => from[c][k]);
    }
  }

  /** The first row that is not before `time_s`; `length` where there is none. */
  function lowerBound(time_s) {
    let low = 0, high = store.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (columns.time_s[store.slot(middle)] < time_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }
  return store;
}
