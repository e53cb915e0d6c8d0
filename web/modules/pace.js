// SPDX-License-Identifier: Apache-2.0

/** How fast frames come: where the machine cannot keep up, what is large is drawn half as often. */
export function createPace(slow_ms = 24) {
  let last_ms = NaN, mean_ms = 16.7;
  return {
    frame(now_ms) {
      if (now_ms - last_ms < 500) mean_ms += 0.05 * (now_ms - last_ms - mean_ms);
      last_ms = now_ms;
    },
    stretch: () => (mean_ms > slow_ms ? 2 : 1),
  };
}
