// SPDX-License-Identifier: Apache-2.0
// What a played program says: a beating force, its past, its status.
import assert from 'node:assert/strict';
import { hello, status } from './mock_server.mjs';
import { HISTORY } from './page_schema.mjs';

export const GRAM = 9.80665e-3;
export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
export const demo = hello().catheters[0];
/** A beating heart on a breath. */
export const force_N = (t) => 0.16 + 0.09 * Math.sin(2 * Math.PI * 1.17 * t) ** 3 + 0.03 * Math.sin(2 * Math.PI * 0.25 * t);

/** `seconds` of history that end now, every `step_s`. */
export function history(seconds, step_s, catheter = 0) {
  const rows = Math.round(seconds / step_s), numbers = new Float64Array(3 + rows * HISTORY.length), now_s = Date.now() / 1000;
  numbers.set([2, catheter, rows]);
  for (let i = 0; i < rows; ++i) {
    const time_s = now_s - step_s * (rows - i), ambiguous = i % 2500 > 2440, size = force_N(time_s);
    const row = { time_s, state: 1, status: ambiguous ? 2 : 0, size_N: ambiguous ? NaN : size, sigma_size_N: 0.008, axial_N: -0.92 * size, sigma_axial_N: 0.012, lateral_N: 0.39 * size, sigma_lateral_N: 0.005, contact: 1, integral_Ns: 0.16 * i * step_s, truth_size_N: 1.02 * size };
    HISTORY.forEach((name, k) => { numbers[3 + i * HISTORY.length + k] = row[name]; });
  }
  return numbers;
}
/** Rows at 60 Hz and status at 5 Hz until stop(). */
export function play(mock, fields = () => ({}), said = () => status()) {
  const rows = setInterval(() => { const t = Date.now() / 1000; mock.row({ size_N: force_N(t), ...fields(t) }, fields(t).catheter ?? 0); }, 16);
  const states = setInterval(() => mock.send(said()), 200);
  return () => { clearInterval(rows); clearInterval(states); };
}
export const alive = (mock) => { const timer = setInterval(() => mock.send(status()), 200); return () => clearInterval(timer); };
/** Nothing to complain of, nobody else asked. */
export const calm = ({ complaints, others }) => {
  assert.deepEqual(complaints, []);
  assert.deepEqual(others(), []);
};
