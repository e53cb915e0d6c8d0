// SPDX-License-Identifier: Apache-2.0
// Where the fields of a row are: by the greeting's names, never by fixed positions.

/** `fields`: [{name, count}]. Returns {size, place: {name: first number}, count: {name: numbers}}. */
export function rowLayout(fields) {
  const layout = { size: 0, place: {}, count: {} };
  for (const { name, count } of fields) {
    layout.place[name] = layout.size;
    layout.count[name] = count;
    layout.size += count;
  }
  return layout;
}

/** One row that is read by name; `numbers` is written over by the next one. */
export function createRow(layout) {
  const numbers = new Float64Array(layout.size).fill(NaN), parts = {};
  for (const [name, at] of Object.entries(layout.place)) parts[name] = numbers.subarray(at, at + layout.count[name]);
  return {
    layout, numbers,
    /** A single number; NaN where the program does not know the field. */
    get: (name) => (layout.place[name] === undefined ? NaN : numbers[layout.place[name]]),
    /** All numbers of a field, a view that follows; undefined for a field that there is not. */
    part: (name) => parts[name],
  };
}

export const MESSAGE = { ROW: 1, HISTORY: 2 };

/** Reads a binary message: {kind, catheter, rows, body}; null where it is none. */
export function readMessage(buffer, layout, historyFields) {
  if (buffer.byteLength % 8 !== 0 || buffer.byteLength < 16) return null;
  const all = new Float64Array(buffer);
  if (all[0] === MESSAGE.ROW && all.length === 2 + layout.size)
    return { kind: MESSAGE.ROW, catheter: all[1], rows: 1, body: all.subarray(2) };
  if (all[0] === MESSAGE.HISTORY && all.length === 3 + all[2] * historyFields)
    return { kind: MESSAGE.HISTORY, catheter: all[1], rows: all[2], body: all.subarray(3) };
  return null;
}
