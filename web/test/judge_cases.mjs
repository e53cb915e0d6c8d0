// SPDX-License-Identifier: Apache-2.0
// What the page may say of the force, and how it knows the age of a row.
import assert from 'node:assert/strict';
import test from 'node:test';
import { createClockOffset } from '../modules/clock_offset.js';
import { createHiddenShare } from '../modules/hidden_share.js';
import { createSteady, judge, whyHidden } from '../modules/judge.js';
import { STATUSES, rowOf } from './page_schema.mjs';

const clock = (offset_ms, error_ms = 1, answers = 9) => ({ host: (ms) => ms + offset_ms, errorAt: () => error_ms, answers });
const live = (more = {}) => ({ now_ms: 5000, arrived_ms: 4990, clock: clock(1e6), statuses: STATUSES, words: ['all is well'], link: { open: true, refused: false, heard_ms: 4990 },
  row: rowOf({ state: 1, status: 0, shown: 1, size_N: 0.1, stale_after_s: 0.1, received_ms: 1_004_985, ...more.fields }), ...more });
const word = (more) => { const { word: said, shown } = judge(live(more)); return [said, shown]; };
test('what may be said of the force', () => {
  assert.deepEqual(word(), ['LIVE', true]);
  assert.deepEqual(word({ fields: { state: 2 } }), ['DEGRADED', true]);
  assert.deepEqual(word({ fields: { state: 3 } }), ['STALE', false]);
  assert.deepEqual(word({ row: null }), ['WAITING', false]);
  assert.deepEqual(word({ fields: { state: 0 } }), ['WAITING', false]);
  assert.deepEqual(word({ fields: { shown: 0, status: 2 } }), ['AMBIGUOUS', false]);
  assert.deepEqual(word({ fields: { shown: 0, status: 4 } }), ['NOT MEASURED', false]);
  assert.deepEqual(word({ fields: { size_N: NaN } }), ['NOT MEASURED', false]);
  for (const status of [0, 1]) {
    assert.deepEqual(word({ fields: { shown: 0, status } }), ['STALE', false]);
    assert.equal(judge(live({ fields: { shown: 0, status, size_N: NaN } })).reason, 'the latest frame came late');
  }
  assert.deepEqual([whyHidden(rowOf({ shown: 1, size_N: 1 }), STATUSES), whyHidden(rowOf({ state: 3, status: 6, shown: 0 }), STATUSES).word], [null, 'STALE']);
  assert.deepEqual(word({ link: { open: false, refused: false, heard_ms: 4990 } }), ['NO CONNECTION', false]);
  assert.deepEqual(word({ link: { open: true, refused: false, heard_ms: 3900 } }), ['NO CONNECTION', false]);
  assert.match(judge(live({ link: { open: false, refused: true } })).reason, /started anew: open the address that it printed/);
});
test('an old row is stale by the clock of the page, and by that of the host', () => {
  assert.deepEqual(word({ arrived_ms: 4901 }), ['LIVE', true]);
  assert.deepEqual(word({ arrived_ms: 4899 }), ['STALE', false]);
  assert.deepEqual(word({ fields: { received_ms: 1_004_902 } }), ['LIVE', true]);
  assert.deepEqual(word({ fields: { received_ms: 1_004_898 } }), ['STALE', false], 'it waited on its way');
  assert.deepEqual(word({ clock: clock(NaN, NaN, 0) }), ['WAITING', false], 'nothing is known of the clocks yet');
  assert.deepEqual(word({ fields: { stale_after_s: NaN } }), ['STALE', false], 'no limit is no leave');
});
test('a connection that is too slow to tell the age of a force shows none', () => {
  assert.deepEqual(word({ clock: clock(1e6, 49) }), ['LIVE', true]);
  assert.deepEqual(word({ clock: clock(1e6, 51) }), ['STALE', false]);
  assert.match(judge(live({ clock: clock(1e6, 51) })).reason, /connection is too slow to tell how old/);
  assert.deepEqual(word({ clock: clock(1e6, 51, 2) }), ['WAITING', false], 'the first answers may have waited for the page');
  assert.deepEqual(word({ clock: clock(1e6, 51), fields: { stale_after_s: 0.2 } }), ['LIVE', true]);
});
test('the large word does not flicker, and does not wait for bad news', () => {
  const steady = createSteady(), at = (kind, ms) => steady({ kind, word: kind, shown: kind === 'live' }, ms).kind;
  assert.deepEqual([at('live', 0), at('hidden', 10), at('live', 35), at('hidden', 60), at('hidden', 209), at('hidden', 211)], ['live', 'live', 'live', 'live', 'live', 'hidden']);
  assert.deepEqual([at('live', 300), at('live', 810), at('live', 812)], ['hidden', 'hidden', 'live']);
  assert.deepEqual([at('stale', 820), at('live', 830), at('lost', 840), at('live', 850)], ['stale', 'stale', 'lost', 'live']);
  assert.deepEqual([at('stale', 900), at('stale', 2000), at('live', 2010)], ['stale', 'stale', 'live'], 'a long silence ends with its first frame');
});
test('a mix of frames with and without a force is not live', () => {
  const said = (hiddenOf5) => {
    const steady = createSteady(), words = new Set();
    for (let i = 0; i < 200; ++i) {
      const hidden = i % 5 < hiddenOf5, held = steady({ kind: hidden ? 'hidden' : 'live', word: hidden ? 'AMBIGUOUS' : 'LIVE', shown: !hidden }, 25 * i);
      if (i > 40) words.add(held.word);
    }
    return [...words];
  };
  assert.deepEqual([0, 1, 2, 3, 4, 5].map(said), [['LIVE'], ['LIVE'], ['LIVE'], ['AMBIGUOUS'], ['AMBIGUOUS'], ['AMBIGUOUS']]);
});
test('the share of frames without a force is told', () => {
  const share = createHiddenShare();
  assert.equal(share.words(0), '');
  for (let i = 0; i < 80; ++i) share.add(25 * i, i % 5 ? 'AMBIGUOUS' : '');
  assert.equal(share.words(1976), 'AMBIGUOUS in 80 % of the latest second');
  for (let i = 80; i < 120; ++i) share.add(25 * i, ['', 'NOT MEASURED', '', 'AMBIGUOUS', 'AMBIGUOUS'][i % 5]);
  assert.equal(share.words(2976), 'AMBIGUOUS in 40 %, NOT MEASURED in 20 % of the latest second');
  for (let i = 120; i < 160; ++i) share.add(25 * i, 'HELD');
  assert.equal(share.words(3976), '', 'the verdict itself says it');
  for (let i = 160; i < 1159; ++i) share.add(4000 + i / 10, '');
  share.add(4100, 'AMBIGUOUS');
  assert.equal(share.words(4999.9), 'AMBIGUOUS in 1 % of the latest second', 'one of very many is not left out');
  share.forget();
  assert.equal(share.words(5000), '');
});

test('the clocks: the shortest round trip is believed, a clock that was set begins anew', () => {
  const clocks = createClockOffset();
  assert.ok(Number.isNaN(clocks.errorAt(0)) && Number.isNaN(clocks.host(0)));
  clocks.answer(100, 140, 1130);
  assert.deepEqual([clocks.offset_ms, clocks.errorAt(140)], [1010, 20]);
  clocks.answer(200, 202, 1202);
  clocks.answer(300, 350, 1330);
  assert.deepEqual([clocks.offset_ms, clocks.errorAt(202), clocks.host(5), clocks.answers], [1001, 1, 1006, 3]);
  assert.equal(clocks.errorAt(10_202), 2, 'ten seconds later it may be a millisecond worse');
  clocks.answer(20_000, 20_004, 21_004);
  assert.equal(clocks.offset_ms, 1002, 'a younger one that is better by now');
  clocks.answer(20_400, 20_410, 3_600_000);
  assert.equal(clocks.offset_ms, 3_600_000 - 20_405);
});
test('a connection that begins to lag on the way down does not teach a wrong clock', () => {
  for (const lagOf of [() => 1500, (s) => Math.min(1500, 20 * s)]) {
    const clocks = createClockOffset(), ask = (s, lag) => clocks.answer(1000 * s, 1000 * s + 2 + lag, 1e6 + 1000 * s + 1);
    for (let s = 0; s < 10; ++s) ask(s, 0);
    for (let s = 10; s < 600; ++s) {
      const lag = lagOf(s - 10), now_ms = 1000 * s + 2 + lag;
      ask(s, lag);
      assert.ok(Math.abs(clocks.host(0) - 1e6) <= clocks.errorAt(now_ms) && clocks.errorAt(now_ms) < 1.01 + 0.1 * s, `after ${s} s: ${clocks.host(0)} ± ${clocks.errorAt(now_ms)}`);
      if (lag >= 1500) assert.equal(judge(live({ now_ms, arrived_ms: now_ms - 1, link: { open: true, heard_ms: now_ms - 1 }, clock: clocks, fields: { received_ms: 1e6 + now_ms - lag } })).word, 'STALE');
    }
  }
});
