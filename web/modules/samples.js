// SPDX-License-Identifier: Apache-2.0

/** The latest measurements of some duration, `room` at most, with percentiles of those of the latest `window_ms`. */
export function createSamples(room, window_ms) {
  const times = new Float64Array(room).fill(-Infinity), values = new Float64Array(room), sorted = new Float64Array(room);
  let next = 0, known = 0;
  return {
    add(now_ms, value) {
      times[next] = now_ms;
      values[next] = value;
      next = (next + 1) % room;
    },
    /** Sorts those of the window, or of a shorter one; percentile() then speaks of them. */
    sort(now_ms, latest_ms = window_ms) {
      known = 0;
      for (let i = 0; i < room; ++i) if (times[i] > now_ms - latest_ms) sorted[known++] = values[i];
      sorted.subarray(0, known).sort();
      return known;
    },
    /** The least value that `share` of them do not exceed; NaN where there are none. */
    percentile: (share) => (known ? sorted[Math.max(0, Math.ceil(share * known) - 1)] : NaN),
  };
}

/** How many a second: count() for each, rate() now and then. */
export function createRate(window_ms = 2000) {
  const times = [], counts = [];
  return {
    /** `total`: counted so far. Returns the rate over the window [1/s]; NaN until two were told. */
    tell(now_ms, total) {
      if (counts.length && total < counts[counts.length - 1]) times.length = counts.length = 0; // counted anew
      times.push(now_ms);
      counts.push(total);
      while (times.length > 2 && times[1] <= now_ms - window_ms) { times.shift(); counts.shift(); }
      const span_s = (now_ms - times[0]) / 1000;
      return span_s > 0 ? (total - counts[0]) / span_s : NaN;
    },
  };
}
