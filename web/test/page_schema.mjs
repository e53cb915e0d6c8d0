// SPDX-License-Identifier: Apache-2.0
// The rows as the program describes them: read from its own header, so that mock and page are held against it.
import { readFileSync } from 'node:fs';
import { createRow, rowLayout } from '../modules/row_layout.js';

const text = readFileSync(new URL('../../palpate/service/page_schema.hpp', import.meta.url), 'utf8');
const COUNTS = { kPagePoints: 25, kMaxSensors: 8 };
const count = (words) => words.split('*').map((word) => COUNTS[word.trim()] ?? Number(word)).reduce((a, b) => a * b, 1);

export const ROW = [...text.matchAll(/PageField\{"(\w+)", ([^,]+),/g)].map(([, name, words]) => ({ name, count: count(words) }));
export const HISTORY = [...text.match(/kPageHistory\{([^}]*)\}/)[1].matchAll(/"(\w+)"/g)].map(([, name]) => name);
export const STATUSES = ['UPDATED', 'RESEEDED', 'AMBIGUOUS', 'REJECTED', 'HELD', 'NOT_CONVERGED', 'STALE'];

const layout = rowLayout(ROW);
/** A row of which a test says some fields; the others are not known. */
export const rowOf = (fields) => {
  const row = createRow(layout);
  for (const [name, value] of Object.entries(fields)) [value].flat().forEach((x, i) => { row.part(name)[i] = x; });
  return row;
};
