// SPDX-License-Identifier: Apache-2.0

/** Two clocks that nobody sets drift apart by no more than this. */
const DRIFT = 1e-4;

/**
 * What the host's clock shows when the page's shows 0, from questions and answers. An answer is right to within half of its
 * round trip, and less so the older it is; the best one of the whole connection is kept. Only the latest ones would not do: on
 * a connection that begins to lag all of them are wrong, and what is old would look fresh. An answer that contradicts the best
 * one by more than both can err means that a clock was set.
 */
export function createClockOffset() {
  let trip_ms = NaN, answered_ms = NaN;
  const clock = {
    offset_ms: NaN, answers: 0,
    /** Page's clock at question and answer, host's in between. */
    answer(asked_ms, now_ms, host_ms) {
      const trip = now_ms - asked_ms, offset = host_ms - (asked_ms + now_ms) / 2, error = clock.errorAt(now_ms);
      if (!(trip >= 0) || !Number.isFinite(offset)) return;
      ++clock.answers;
      const wasSet = Math.abs(offset - clock.offset_ms) > trip / 2 + error + 5;
      if (trip / 2 > error && !wasSet) return;
      clock.offset_ms = offset;
      trip_ms = trip;
      answered_ms = now_ms;
    },
    /** Host's clock at a moment of the page's; NaN as long as nothing is known. */
    host: (page_ms) => page_ms + clock.offset_ms,
    /** By how much host() may be wrong [ms]; NaN likewise. */
    errorAt: (page_ms) => trip_ms / 2 + DRIFT * Math.max(0, page_ms - answered_ms),
    forget() { clock.offset_ms = trip_ms = answered_ms = NaN; clock.answers = 0; },
  };
  return clock;
}
