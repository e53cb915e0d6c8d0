// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { at, forceCurves, isMeasured } from '../modules/force_curves.js';
import { UNITS, clock, fixed, format } from '../modules/units.js';

test('one gram-force is 9.80665 mN', () => {
  assert.equal(format(9.80665e-3, UNITS.g), '1.0');
  assert.equal(format(9.80665e-3, UNITS.mN, 5), '9.80665');
  assert.equal(format(0.0980665, UNITS.N), '0.0981');
  assert.equal(format(null, UNITS.g), '–');
});

test('numbers have a true minus, and no negative zero', () => {
  assert.equal(fixed(-1.25, 1), '−1.3');
  assert.equal(fixed(-0.01, 1), '0.0');
});

test('times', () => {
  assert.equal(clock(59.96), '60.0 s');
  assert.equal(clock(61.25, 2), '1:01.25');
  assert.equal(clock(119.96), '2:00.0');
  assert.equal(clock(600, 0), '10:00');
});

const rows = {
  time_s: [0, 1, 2], statuses: ['UPDATED', 'RESEEDED', 'AMBIGUOUS', 'REJECTED', 'HELD'], status: [0, 4, 2],
  fx_N: [0.03, 1, 1], fy_N: [0.04, 1, 1], fz_N: [-0.12, 1, 1],
  sigma_x_N: [0.01, 1, 1], sigma_y_N: [0.01, 1, 1], sigma_z_N: [0.02, 1, 1], sigma_size_N: [0.1, 1, 1], sigma_lateral_N: [0.05, 1, 1],
};

test('size, lateral and axial force of a row', () => {
  assert.ok(Math.abs(at(rows, 'size', 0).value - 0.13) < 1e-15);
  assert.ok(Math.abs(at(rows, 'lateral', 0).value - 0.05) < 1e-15);
  assert.equal(at(rows, 'axial', 0).value, -0.12);
  assert.equal(at(rows, 'axial', 0).sigma, 0.02);
});

test('a held or ambiguous force is no curve, and a size no less than nothing', () => {
  assert.deepEqual([0, 1, 2].map((i) => isMeasured(rows, i)), [true, false, false]);
  const [size, x] = forceCurves(rows, ['size', 'x'], UNITS.N);
  assert.deepEqual(size.values.slice(1), [null, null]);
  assert.deepEqual(size.upper.slice(1), [null, null]);
  assert.equal(size.lower[0], 0);
  assert.ok(Math.abs(x.lower[0] - (0.03 - 1.959964e-2)) < 1e-12);
});
