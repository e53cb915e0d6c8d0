// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import test from 'node:test';
import { bandNames, bandOf, shadeOf } from '../modules/band_names.js';
import { createDecimation, createStretches } from '../modules/decimation.js';
import { MESSAGE, createRow, readMessage, rowLayout } from '../modules/row_layout.js';
import { COLUMNS, createRowStore } from '../modules/row_store.js';
import { createRate, createSamples } from '../modules/samples.js';
import { createSettings } from '../modules/settings.js';
import { createTraceView, niceAbove } from '../modules/trace_view.js';
import { UNITS, timeOfDay } from '../modules/units.js';
import { HISTORY, ROW, rowOf } from './page_schema.mjs';
import { crc64 } from './tracker.mjs';
import './judge_cases.mjs';

/** The same numbers at every run. */
const random = (seed) => () => ((seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648);

test('every field that the page asks for is one that the program tells', () => {
  const sources = ['../dashboard.js', ...readdirSync(new URL('../modules', import.meta.url)).map((name) => `../modules/${name}`)].map((name) => readFileSync(new URL(name, import.meta.url), 'utf8'));
  const asked = new Set(sources.flatMap((text) => [...text.matchAll(/(?:row\.get|row\.part|\bpart|\bsaid|\bof)\('(\w{3,})'\)/g)].map(([, name]) => name)));
  asked.delete('truth_'); // report's columns
  assert.ok(asked.size > 30, `${asked.size} fields`);
  const told = new Set(ROW.map(({ name }) => name));
  assert.deepEqual([...asked].filter((name) => !told.has(name)), []);
  assert.deepEqual(COLUMNS.filter((name) => !told.has(name)), ['truth_axial_N', 'truth_lateral_N']); // the store makes them
  assert.deepEqual(HISTORY.filter((name) => !told.has(name)), []);
});

test('a row is read by names, whatever their order', () => {
  const fields = [{ name: 'b', count: 3 }, { name: 'a', count: 1 }], message = Float64Array.from([1, 2, 10, 11, 12, 5]);
  const row = createRow(rowLayout(fields)), found = readMessage(message.buffer, row.layout, 12);
  assert.deepEqual([found.kind, found.catheter], [MESSAGE.ROW, 2]);
  row.numbers.set(found.body);
  assert.equal(row.get('a'), 5);
  assert.deepEqual([...row.part('b')], [10, 11, 12]);
  assert.ok(Number.isNaN(row.get('newer')));
  assert.equal(readMessage(Float64Array.from([1, 2, 10]).buffer, row.layout, 12), null);
  assert.equal(readMessage(new ArrayBuffer(7), row.layout, 12), null);
  assert.equal(readMessage(Float64Array.from([2, 0, 3, 1, 1]).buffer, row.layout, 2), null, 'a history that lies about its rows');
  assert.equal(readMessage(Float64Array.from([2, 0, 1, 1, 1]).buffer, row.layout, 2).rows, 1);
});

test('the store keeps the latest rows in order', () => {
  const store = createRowStore(5);
  for (let i = 0; i < 8; ++i) assert.ok(store.push(rowOf({ time_s: 100 + i, size_N: i, truth_tip_N: [3, 4, -2] })));
  assert.deepEqual([store.length, store.firstTime(), store.lastTime(), store.at('size_N', 0)], [5, 103, 107, 3]);
  assert.deepEqual([store.at('truth_axial_N', 4), store.at('truth_lateral_N', 4)], [-2, 5]);
  assert.ok(!store.push(rowOf({ time_s: 107 })) && !store.push(rowOf({ time_s: 106 })) && !store.push(rowOf({ time_s: NaN })), 'time does not stand still or step back');
  assert.deepEqual([102, 103, 104.5, 107, 108].map((t) => store.lowerBound(t)), [0, 0, 2, 4, 5]);
  const { epoch } = store;
  assert.ok(store.push(rowOf({ time_s: 50 })), 'another clock begins anew');
  assert.deepEqual([store.length, store.firstTime(), store.epoch], [1, 50, epoch + 1]);
});

test('history fills what the store does not have', () => {
  const store = createRowStore(100), fields = ['time_s', 'size_N'];
  for (const t of [10.0, 10.05, 10.1, 12.0]) store.push(rowOf({ time_s: t, size_N: 1, shown: 1 }));
  const times = [9.0, 9.9, 10.0, 10.1, 10.2, 11.0, 11.0, 13.0];
  store.merge(fields, times.length, Float64Array.from(times.flatMap((t, i) => [t, i === 5 ? NaN : 2])), 0.1);
  const all = Array.from({ length: store.length }, (_, i) => [store.at('time_s', i), store.at('size_N', i), store.at('shown', i)]);
  assert.deepEqual(all, [[9, 2, 1], [9.9, 2, 1], [10, 1, 1], [10.05, 1, 1], [10.1, 1, 1], [10.2, 2, 1], [11, NaN, 0], [12, 1, 1], [13, 2, 1]]);
  assert.ok(Number.isNaN(store.at('axial_N', 0)));
});

/** The extremes of each pixel, and the bounds, by brute force. */
function bruteForce(store, channel, from_s, step_s, z) {
  const pixels = new Map();
  for (let i = store.lowerBound(from_s); i < store.length; ++i) {
    const v = store.at(`${channel}_N`, i), pixel = Math.floor(store.at('time_s', i) / step_s);
    if (!Number.isFinite(v) || store.at('shown', i) !== 1) continue;
    const p = pixels.get(pixel) ?? [Infinity, -Infinity, Infinity, -Infinity], reach = z * store.at(`sigma_${channel}_N`, i);
    pixels.set(pixel, [Math.min(p[0], v), Math.max(p[1], v), Math.min(p[2], channel === 'axial' ? v - reach : Math.max(0, v - reach)), Math.max(p[3], v + reach)]);
  }
  return pixels;
}
function pixelsOf(points, from_s, step_s) {
  const pixels = new Map();
  for (let i = points.begin; i < points.count; ++i) {
    if (points.x[i] < from_s || Number.isNaN(points.y[i])) continue;
    const pixel = Math.floor(points.x[i] / step_s), p = pixels.get(pixel) ?? [Infinity, -Infinity, Infinity, -Infinity];
    pixels.set(pixel, [Math.min(p[0], points.y[i]), Math.max(p[1], points.y[i]), Math.min(p[2], points.low[i]), Math.max(p[3], points.high[i])]);
  }
  return pixels;
}
test('no peak is lost, whether the curve is made at once or goes on', () => {
  const next = random(7), store = createRowStore(4000), span_s = 40, step_s = span_s / 200;
  const going = Object.fromEntries(['size', 'axial'].map((channel) => [channel, createDecimation(store, channel, false, 200, 1.96)])), stretches = createStretches(store, 200);
  let time_s = 1000;
  for (let i = 0; i < 6000; ++i) {
    time_s += next() < 0.002 ? 1.5 : 0.01 + 0.01 * next();
    store.push(rowOf({ time_s, shown: Number(next() > 0.05), status: 4, size_N: next(), sigma_size_N: 0.2 * next(), axial_N: -next(), sigma_axial_N: 0.1 }));
    if (next() < 0.9) continue;
    const from_s = step_s * Math.ceil((time_s - span_s) / step_s), window = { from_s, to_s: time_s, now_s: time_s + 0.05, step_s, gap_s: 0.3 };
    for (const channel of ['size', 'axial']) {
      const points = going[channel].update(window);
      assert.ok(points.count - points.begin < 3 * 203 + 3, 'about a pair a pixel');
      const oracle = bruteForce(store, channel, from_s, step_s, 1.96), found = pixelsOf(points, from_s, step_s);
      oracle.delete(Math.floor(from_s / step_s)); // the window begins within it
      found.delete(Math.floor(from_s / step_s));
      assert.deepEqual([...found].sort(), [...oracle].sort());
      if (i % 37 === 0) {
        const anew = createDecimation(store, channel, false, 200, 1.96).update(window), tail = (p, k) => Array.from(p[k].subarray(p.begin, p.count)).slice(-300);
        for (const k of ['x', 'y']) assert.deepEqual(tail(points, k), tail(anew, k));
      }
    }
    stretches.update(window);
    const fresh = createStretches(store, 200).update(window), list = (s) => Array.from({ length: s.count }, (_, k) => [s.from[k], s.to[k], s.status[k]]).filter(([, to]) => to > from_s + 1);
    assert.deepEqual(list(stretches).slice(1), list(fresh).slice(1));
  }
});

test('what was not measured breaks the curve and is a stretch', () => {
  const store = createRowStore(100);
  for (let i = 0; i < 10; ++i) store.push(rowOf({ time_s: i, shown: Number(i < 4 || i > 5), status: i === 4 || i === 5 ? 2 : 0, size_N: i }));
  store.push(rowOf({ time_s: 20, shown: 1, size_N: 1 }));
  const window = { from_s: 0, to_s: 25, now_s: 25, step_s: 0.5, gap_s: 1.5 }, points = createDecimation(store, 'size', false, 50, 2).update(window);
  const y = Array.from(points.y.subarray(points.begin, points.count));
  assert.deepEqual(y, [0, 1, 2, 3, NaN, 6, 7, 8, 9, NaN, 1]);
  const found = createStretches(store, 50).update(window);
  assert.deepEqual(Array.from({ length: found.count }, (_, i) => [found.from[i], found.to[i], found.status[i]]), [[4, 6, 2], [9, 25, -1]]);
});

test('percentiles of a window, and rates', () => {
  const samples = createSamples(100, 1000);
  for (let i = 1; i <= 250; ++i) samples.add(10 * i, i);
  assert.equal(samples.sort(2500), 100);
  assert.deepEqual([0.5, 0.95, 1].map(samples.percentile), [200, 245, 250]);
  assert.equal(samples.sort(3000), 50);
  assert.equal(samples.sort(2500, 95), 10);
  assert.ok(Number.isNaN(createSamples(10, 10).percentile(0.5)));
  const rate = createRate(2000);
  assert.ok(Number.isNaN(rate.tell(0, 10)));
  assert.equal(rate.tell(1000, 50), 40);
  assert.ok(Number.isNaN(rate.tell(1200, 5)), 'counted anew');
});

test('an edge belongs to the band above it, in every unit', () => {
  const edges = [5, 10, 30, 40], newtons = (g) => g / UNITS.g.perNewton;
  assert.deepEqual([0, 4.9, 5.1, 9.9, 10.1, 29.9, 30.1, 39.9, 40.1, 500, NaN].map((g) => bandOf(newtons(g), edges)), [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, -1]);
  assert.deepEqual(bandNames(edges, UNITS.g), ['< 5 g', '5–10 g', '10–30 g', '30–40 g', '≥ 40 g']);
  assert.deepEqual(bandNames([2.5], UNITS.mN), ['< 25 mN', '≥ 25 mN']);
  assert.deepEqual([0, 1, 2, 3, 4].map((i) => shadeOf(i, 5)), [0, 1, 2, 3, 4]);
});

test('the window of the traces', () => {
  const view = createTraceView(30);
  assert.deepEqual(view.window(100, 0), { from_s: 70, to_s: 100 });
  view.pan(0.5, 100);
  assert.ok(view.follows, 'there is no future');
  view.pan(-0.5, 100);
  assert.deepEqual(view.window(110, 0), { from_s: 55, to_s: 85 });
  view.pan(-9, 110);
  assert.deepEqual(view.window(110, 40), { from_s: 40, to_s: 70 }, 'nor a past before the first row');
  view.zoom(0.5, 50, 110);
  assert.deepEqual(view.window(110, 40), { from_s: 45, to_s: 60 }, 'what is under the pointer stays');
  view.pan(9, 110);
  assert.ok(view.follows);
  view.zoom(1e9, 0, 110);
  assert.equal(view.span_s, 600);
  assert.deepEqual([0, 0.9, 1, 21, 41, 0.0045].map(niceAbove), [0, 1, 1, 30, 50, 0.005]);
});

test('settings are kept, and what is not ours does no harm', () => {
  const kept = new Map(), storage = { getItem: (k) => kept.get(k) ?? null, setItem: (k, v) => kept.set(k, v) };
  const first = createSettings({ unit: 'g', window_s: 30 }, storage);
  assert.ok(!first.has('unit'));
  first.set('unit', 'N');
  const second = createSettings({ unit: 'g', window_s: 30 }, storage);
  assert.deepEqual([second.get('unit'), second.has('unit'), second.get('window_s'), second.has('window_s')], ['N', true, 30, false]);
  for (const text of ['nonsense', 'null', '{"unit": 5}']) assert.equal(createSettings({ unit: 'g' }, { getItem: () => text, setItem() { throw new Error('full'); } }).get('unit'), 'g');
  createSettings({ unit: 'g' }, { getItem: () => null, setItem() { throw new Error('full'); } }).set('unit', 'N');
});

test('time of day', () => {
  assert.match(timeOfDay(1_700_000_000.96), /^\d\d:\d\d:20$/);
  assert.match(timeOfDay(1_700_000_000.96, 1), /^\d\d:\d\d:20\.9$/);
});

test("the tracker's checksum is CRC-64 of ECMA-182", () => {
  assert.equal(crc64(Buffer.from('123456789')), 0x6c40df5f0b497347n); // the check value of the catalogue
});
