// SPDX-License-Identifier: Apache-2.0

/**
 * How many of the frames of the latest second had no force, and why. The eye sees the latest frame alone: of frames that come
 * and go 40 times a second it would take a mix for what it happens to catch, so the share is said in words.
 * Returns {add(now_ms, why), forget(), words(now_ms)}; `why`: '' for a frame with a force.
 */
export function createHiddenShare(window_ms = 1000) {
  const times = [], reasons = [];
  const drop = (now_ms) => { while (times.length && times[0] <= now_ms - window_ms) { times.shift(); reasons.shift(); } };
  const counted = () => {
    const counts = new Map();
    for (const why of reasons) if (why) counts.set(why, (counts.get(why) ?? 0) + 1);
    return counts;
  };
  const percent = (count) => Math.min(count < reasons.length ? 99 : 100, Math.max(1, Math.round((100 * count) / reasons.length)));
  return {
    add(now_ms, why) {
      drop(now_ms);
      times.push(now_ms);
      reasons.push(why);
    },
    forget() { times.length = reasons.length = 0; },
    /** 'AMBIGUOUS in 80 % of the latest second'; '' where no frame was without a force, or all were for the same reason: then
     * the verdict says it. */
    words(now_ms) {
      drop(now_ms);
      const counts = counted();
      if (counts.size === 0 || Math.max(...counts.values()) === reasons.length) return '';
      return `${[...counts].sort((a, b) => b[1] - a[1]).map(([why, count]) => `${why} in ${percent(count)} %`).join(', ')} of the latest second`;
    },
  };
}
