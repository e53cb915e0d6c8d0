// SPDX-License-Identifier: Apache-2.0
// Curves with bands over time: zoom, pan, marked stretches and a moment that is shared with other views.
import uPlot from 'uplot';
import { SECONDS, axisInk } from './plot_style.js';
import { colour, faded, onThemeChange } from './theme.js';
import { minutes } from './units.js';

/**
 * `plain`: {
 *   time_s: increasing numbers,
 *   curves: [{label, colour (custom property), values, lower, upper, dashed, width, points}],   null: a gap
 *   spans: [{from, to, label, kind}],     shaded over the whole height
 *   y_label, height, range, format(value) }
 * `events`: {onMoment(time_s), onRange(from_s, to_s)}.
 * Returns {set(plain), setMoment(time_s), setRange(from_s, to_s), plot, destroy}.
 */
export function createTimePlot(parent, plain, events = {}) {
  let state = plain, moment = NaN, plot, range = null, quiet = false;

  const build = () => {
    plot?.destroy();
    plot = new uPlot(options(), columns(state), parent);
    parent.tabIndex = 0;
    if (range) applyRange();
  };
  const applyRange = () => {
    quiet = true;
    plot.batch(() => plot.setScale('x', { min: range[0], max: range[1] }));
    quiet = false;
  };
  const options = () => ({
    width: Math.max(200, parent.clientWidth),
    height: state.height,
    padding: [10, 12, 0, 0],
    scales: { x: { time: false }, y: { range: state.range ?? undefined } },
    legend: { show: false },
    cursor: { drag: { x: true, y: false, uni: 8 }, points: { size: 6 }, sync: { key: 'time', scales: ['x', null] } },
    axes: axes(),
    series: series(),
    bands: bands(),
    hooks: {
      drawClear: [drawSpans],
      draw: [drawMoment],
      setScale: [(u, key) => key === 'x' && !quiet && rangeChanged(u)],
      setCursor: [(u) => events.onHover?.(u.cursor.idx ?? null)],
      ready: [attach],
    },
  });
  const rangeChanged = (u) => {
    range = [u.scales.x.min, u.scales.x.max];
    events.onRange?.(...range);
  };
  const axes = () => {
    const ink = axisInk();
    const seconds = (u, marks) => marks.map((mark) => (u.scales.x.max > 120 ? minutes(mark, marks[1] - marks[0] < 1 ? 2 : 0) : String(Number(mark.toFixed(6)))));
    return [
      { ...ink, values: seconds, incrs: SECONDS, label: state.x_label, labelSize: 18, size: 34, labelGap: -4 },
      { ...ink, label: state.y_label, labelSize: 18, size: 56 },
    ];
  };
  const series = () => [{}, ...state.curves.flatMap((curve) => {
    const stroke = colour(curve.colour);
    const edge = { stroke: null, width: 0, points: { show: false } };
    const line = { label: curve.label, stroke, width: curve.width ?? 1.5, dash: curve.dashed ? [6, 4] : undefined, points: curve.points ?? { show: false } };
    if (curve.onlyPoints) Object.assign(line, { paths: () => null, points: { show: true, size: 3, fill: stroke, width: 0 } });
    return curve.lower ? [edge, edge, line] : [line];
  })];
  const bands = () => {
    const found = [];
    let at = 1;
    for (const curve of state.curves) {
      if (curve.lower) found.push({ series: [at + 1, at], fill: faded(colour(curve.colour), 0.22) });
      at += curve.lower ? 3 : 1;
    }
    return found;
  };
  const drawSpans = (u) => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const span of state.spans ?? []) {
      const left = u.valToPos(span.from, 'x', true), right = u.valToPos(span.to, 'x', true);
      if (right < bbox.left || left > bbox.left + bbox.width) continue;
      ctx.fillStyle = faded(colour(span.kind), 0.35);
      ctx.fillRect(left, bbox.top, Math.max(devicePixelRatio, right - left), bbox.height);
      // A mark on top as well: the shade of a single frame is one pixel wide.
      ctx.fillStyle = colour(span.kind);
      ctx.fillRect(left - devicePixelRatio, bbox.top, Math.max(3 * devicePixelRatio, right - left), 4 * devicePixelRatio);
    }
    ctx.restore();
  };
  const drawMoment = (u) => {
    const x = Math.round(u.valToPos(moment, 'x', true));
    if (!(x >= u.bbox.left && x <= u.bbox.left + u.bbox.width)) return;
    u.ctx.fillStyle = colour('--ink');
    u.ctx.fillRect(x - devicePixelRatio / 2, u.bbox.top, 1.5 * devicePixelRatio, u.bbox.height);
  };
  const zoom = (u, factor, about) => {
    const { min, max } = u.scales.x, first = state.time_s[0], last = state.time_s[state.time_s.length - 1];
    const span = Math.min(last - first, Math.max((max - min) * factor, 0.02));
    const from = Math.min(Math.max(about - (about - min) * (span / (max - min)), first), last - span);
    u.setScale('x', { min: from, max: from + span });
  };
  const pan = (u, share) => {
    const { min, max } = u.scales.x, first = state.time_s[0], last = state.time_s[state.time_s.length - 1];
    const step = Math.min(Math.max((max - min) * share, first - min), last - max);
    u.setScale('x', { min: min + step, max: max + step });
  };
  const attach = (u) => {
    let pressed = null, panned = null;
    u.over.addEventListener('mousedown', (event) => {
      pressed = [event.clientX, event.clientY];
      if (event.button === 0 && event.shiftKey) {
        panned = { x: event.clientX, ...u.scales.x };
        event.stopImmediatePropagation();
      }
    }, true);
    u.over.addEventListener('mousemove', (event) => {
      if (!panned) return;
      const step = ((panned.x - event.clientX) / u.over.clientWidth) * (panned.max - panned.min);
      u.setScale('x', { min: panned.min + step, max: panned.max + step });
    });
    u.over.addEventListener('mouseup', (event) => {
      const still = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4;
      if (still && !panned) events.onMoment?.(u.posToVal(event.clientX - u.over.getBoundingClientRect().left, 'x'));
      pressed = panned = null;
    });
    u.over.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.shiftKey && document.activeElement !== parent) return; // the page scrolls
      event.preventDefault();
      zoom(u, event.deltaY > 0 ? 1.25 : 0.8, u.posToVal(event.clientX - u.over.getBoundingClientRect().left, 'x'));
    }, { passive: false });
  };
  parent.addEventListener('keydown', (event) => {
    const middle = (plot.scales.x.min + plot.scales.x.max) / 2;
    const about = moment >= plot.scales.x.min && moment <= plot.scales.x.max ? moment : middle;
    const actions = {
      '+': () => zoom(plot, 0.7, about), '=': () => zoom(plot, 0.7, about), '-': () => zoom(plot, 1.4, about),
      '0': () => zoom(plot, Infinity, about), PageUp: () => pan(plot, -0.5), PageDown: () => pan(plot, 0.5),
      ArrowLeft: () => events.onStep?.(event.shiftKey ? -10 : -1), ArrowRight: () => events.onStep?.(event.shiftKey ? 10 : 1),
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  });

  build();
  const resized = new ResizeObserver(() => plot.setSize({ width: Math.max(200, parent.clientWidth), height: state.height }));
  resized.observe(parent);
  const forget = onThemeChange(build);
  return {
    get plot() { return plot; },
    set(next) { state = next; build(); },
    setMoment(time_s) { moment = time_s; plot.redraw(false, false); },
    setRange(from_s, to_s) {
      if (range && range[0] === from_s && range[1] === to_s) return;
      range = [Math.max(from_s, state.time_s[0]), Math.min(to_s, state.time_s[state.time_s.length - 1])];
      applyRange();
    },
    zoom: (factor) => zoom(plot, factor, (plot.scales.x.min + plot.scales.x.max) / 2),
    destroy() { resized.disconnect(); forget(); plot.destroy(); },
  };
}

const columns = ({ time_s, curves }) => [
  time_s,
  ...curves.flatMap(({ values, lower, upper }) => (lower ? [lower, upper, values] : [values])),
];
