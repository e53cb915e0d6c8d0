// SPDX-License-Identifier: Apache-2.0
// What may be said of the force now. The program says it, and the page judges for itself: what it does not hear is old.

export const SILENT_MS = 1000;
/** So many answers about the clocks come soon after the greeting. */
export const FIRST_ANSWERS = 6;
const STATES = ['WAITING', 'LIVE', 'DEGRADED', 'STALE'];
/** What the program says of frames with a force; where it does not show that, the frame was old when it came. */
const MEASURED = ['UPDATED', 'RESEEDED'], STALE = STATES.indexOf('STALE');
const NO_FORCE = {
  AMBIGUOUS: 'another force fits as well',
  REJECTED: 'the frame contradicts itself',
  HELD: 'no usable sensor in the frame',
  NOT_CONVERGED: 'no answer within the bounded work',
  STALE: 'no usable frame for too long',
};

/** Age of a row [s]: since it arrived, or since its frame came to the host where the clocks are known; the longer.
 * `arrived_ms`: of the latest row that was not itself a message of silence; NaN: there was none. */
export function ageOf(row, arrived_ms, now_ms, clock) {
  const here = now_ms - arrived_ms, there = clock.host(now_ms) - clock.errorAt(now_ms) - row.get('received_ms');
  return Math.max(Number.isFinite(here) ? here : 0, Number.isFinite(there) ? there : 0) / 1000;
}

/** Why a row has no force: {word, reason, kind}; null where it has one. */
export function whyHidden(row, statuses) {
  if (row.get('shown') === 1 && Number.isFinite(row.get('size_N'))) return null;
  const status = statuses[row.get('status')] ?? '', late = MEASURED.includes(status) && row.get('shown') !== 1;
  if (late || row.get('state') === STALE) return { word: 'STALE', reason: 'the latest frame came late', kind: 'stale' };
  return { word: status === 'AMBIGUOUS' ? status : 'NOT MEASURED', reason: NO_FORCE[status] ?? 'no number came', kind: 'hidden' };
}

/**
 * `link`: {open, refused, heard_ms}; `row`: the latest, or null; `words`: of the program's status.
 * Returns {word, reason, kind, shown}: `kind` is the word's class for colours, `shown` whether the row's force is that of now.
 */
export function judge({ now_ms, link, row, arrived_ms, clock, statuses, words }) {
  const hidden = (word, reason, kind) => ({ word, reason, kind, shown: false });
  if (link.refused) return hidden('NO CONNECTION', 'the program was started anew: open the address that it printed', 'lost');
  if (!link.open || now_ms - link.heard_ms > SILENT_MS) return hidden('NO CONNECTION', 'to the program; trying again', 'lost');
  const said = words.join(' · ');
  const state = row ? STATES[row.get('state')] : 'WAITING';
  if (state === 'WAITING' || state === undefined) return hidden('WAITING', said || 'no frame has come yet', 'waiting');
  const age_s = ageOf(row, arrived_ms, now_ms, clock), limit_s = row.get('stale_after_s');
  if (state === 'STALE' || !(age_s <= limit_s)) return hidden('STALE', `no usable frame for ${age_s.toFixed(1)} s`, 'stale');
  // A clock that may be wrong by half of the limit tells nothing about it. The first answers may have waited for the page itself.
  if (!(clock.errorAt(now_ms) < (1000 * limit_s) / 2)) {
    if (clock.answers < FIRST_ANSWERS) return hidden('WAITING', 'connecting', 'waiting');
    return hidden('STALE', 'the connection is too slow to tell how old a force is', 'stale');
  }
  const why = whyHidden(row, statuses);
  return why ? { ...why, shown: false } : { word: state, reason: said, kind: state.toLowerCase(), shown: true };
}

/**
 * Holds a verdict for the eye: a single frame without a force blanks the number, but the large word changes only when they
 * add up to `patience_ms`. A bad word stays for `least_ms`, and until as much of frames with a force has made up for it. Time
 * without a force adds and time with one subtracts, so that one good frame of five does not make the word LIVE. Silence is
 * told at once.
 */
export function createSteady(patience_ms = 150, least_ms = 600) {
  let held = null, last = null, last_ms = NaN, since_ms = -Infinity, hidden_ms = 0;
  return (verdict, now_ms) => {
    if (last) hidden_ms = Math.min(patience_ms, Math.max(0, hidden_ms + (last.kind === 'hidden' ? 1 : -1) * (now_ms - last_ms)));
    last = verdict;
    last_ms = now_ms;
    const waits = verdict.kind === 'hidden' && held?.shown && hidden_ms < patience_ms;
    const stays = ['hidden', 'stale'].includes(held?.kind) && verdict.shown && (hidden_ms > 0 || now_ms - since_ms < least_ms);
    if (waits || stays) return held;
    if (held?.word !== verdict.word) since_ms = now_ms;
    return (held = verdict);
  };
}
