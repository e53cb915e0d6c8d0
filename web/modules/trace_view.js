// SPDX-License-Identifier: Apache-2.0
// Which stretch of time the traces show: it follows now, or stands where the person put it.

export const LEAST_SPAN_S = 1, MOST_SPAN_S = 600;
const within = (value, low, high) => Math.min(Math.max(value, low), high);

export function createTraceView(span_s) {
  const view = {
    follows: true, span_s: within(span_s, LEAST_SPAN_S, MOST_SPAN_S), to_s: NaN,
    /** The window [s] for the present edge of time; `first_s`: of the oldest row. */
    window(now_s, first_s) {
      if (!view.follows) {
        const oldest = Number.isFinite(first_s) ? Math.min(first_s + view.span_s, now_s) : -Infinity;
        view.to_s = within(view.to_s, oldest, now_s);
      }
      const to_s = view.follows ? now_s : view.to_s;
      return { from_s: to_s - view.span_s, to_s };
    },
    pause(now_s) {
      if (view.follows) Object.assign(view, { follows: false, to_s: now_s });
    },
    live() { view.follows = true; },
    /** By a share of the window; to the right edge: live again. */
    pan(share, now_s) {
      view.pause(now_s);
      view.to_s += share * view.span_s;
      if (view.to_s >= now_s) view.live();
    },
    /** About a moment; where it follows, the right edge stays now. */
    zoom(factor, about_s, now_s) {
      const span_s = within(view.span_s * factor, LEAST_SPAN_S, MOST_SPAN_S);
      if (!view.follows) view.to_s = Math.min(about_s + (view.to_s - about_s) * (span_s / view.span_s), now_s);
      view.span_s = span_s;
    },
    setSpan(span_s) { view.span_s = within(span_s, LEAST_SPAN_S, MOST_SPAN_S); },
  };
  return view;
}

/** The least round number that is not below `value`. */
export function niceAbove(value) {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].map((digit) => digit * power).find((nice) => nice >= value * (1 - 1e-9));
}
