// SPDX-License-Identifier: Apache-2.0
// One plot of the traces: uPlot keeps scales, axes and cursor; the curves are painted from the store's decimated rows.
import uPlot from 'uplot';
import { createDecimation, createStretches } from './decimation.js';
import { CHANNELS, Z_95 } from './force_curves.js';
import { SECONDS, axisInk } from './plot_style.js';
import { colour, faded, onThemeChange } from './theme.js';
import { clipped, paintBand, paintLine, paintMarks, paintStretches } from './trace_painter.js';
import { niceAbove } from './trace_view.js';
import { fixed, timeOfDay } from './units.js';

const MOST_PIXELS = 4000;
const digitsOf = (step) => (step > 0 ? Math.min(6, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))) : 0);

/**
 * `channels`: of CHANNELS; `state`: {store, unit, statuses, simulated, marks, edges_g, least_N}, read at every drawing.
 * Returns {draw({from_s, to_s, span_s, now_s, gap_s}), plot, hovered: [s] or NaN}.
 */
export function createTracePanel(parent, channels, state, { timeAxis, named }) {
  const curves = channels.map((channel) => ({ points: createDecimation(state.store, channel, false, MOST_PIXELS, Z_95), truth: createDecimation(state.store, channel, true, MOST_PIXELS, Z_95) }));
  const stretches = createStretches(state.store, MOST_PIXELS);
  const panel = { draw, plot: null, hovered: NaN };
  let inks = null, range = [0, 1];

  const font = () => `${Math.round(0.72 * parseFloat(getComputedStyle(document.documentElement).fontSize))}px system-ui, sans-serif`;
  const build = () => {
    panel.plot?.destroy();
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize), ink = axisInk(font());
    inks = {
      line: channels.map((channel) => colour(CHANNELS[channel].colour)), band: channels.map((channel) => faded(colour(CHANNELS[channel].colour), 0.24)),
      truth: colour('--truth'), edge: faded(colour('--ink-soft'), 0.45), paper: colour('--card'),
      held: { fill: faded(colour('--held'), 0.28), edge: colour('--held') }, ambiguous: { fill: faded(colour('--ambiguous'), 0.3), edge: colour('--ambiguous') },
      font: `${Math.round(0.72 * rem * devicePixelRatio)}px system-ui, sans-serif`,
    };
    panel.plot = new uPlot({
      width: Math.max(100, parent.clientWidth), height: Math.max(60, parent.clientHeight), padding: [Math.round(0.5 * rem), Math.round(0.6 * rem), 0, 0],
      legend: { show: false }, scales: { x: { time: false, auto: false, range: (u, low, high) => [low, high] }, y: { auto: false, range: () => range } },
      cursor: { drag: { x: false, y: false }, bind: { dblclick: () => null }, points: { show: false }, sync: { key: 'live', scales: ['x', null] } },
      axes: [
        { ...ink, show: true, values: (u, marks) => marks.map((mark) => (timeAxis ? timeOfDay(mark) : '')), incrs: SECONDS.filter((step) => step >= 1), space: Math.round(6 * rem), size: timeAxis ? Math.round(2 * rem) : Math.round(0.6 * rem) },
        { ...ink, size: Math.round(3.6 * rem), space: Math.round(2 * rem), values: (u, marks) => marks.map((mark) => fixed(mark, digitsOf(marks[1] - marks[0]))) },
      ],
      series: [{}, { show: true, stroke: null, points: { show: false } }],
      hooks: { drawClear: [paintBelow], draw: [paint], setCursor: [(u) => { panel.hovered = u.cursor.left >= 0 ? u.posToVal(u.cursor.left, 'x') : NaN; }] },
    }, [[0, 1e12], [null, null]], parent);
  };
  function paintBelow(u) {
    clipped(u, (ctx) => paintStretches(u, ctx, stretches, (status) => (state.statuses[status] === 'AMBIGUOUS' ? inks.ambiguous : inks.held)));
  }
  function paint(u) {
    const k = state.unit.perNewton;
    clipped(u, (ctx) => {
      if (channels.includes('size')) paintEdges(u, ctx);
      curves.forEach(({ points }, i) => paintBand(u, ctx, points, k, inks.band[i]));
      if (state.simulated) for (const { truth } of curves) paintLine(u, ctx, truth, k, inks.truth, 1.25, [6, 4]);
      curves.forEach(({ points }, i) => paintLine(u, ctx, points, k, inks.line[i], 2));
      paintMarks(u, ctx, state.marks, named, inks.font, inks.paper);
    });
  }
  /** Where one band ends and the next begins. */
  function paintEdges(u, ctx) {
    ctx.fillStyle = inks.edge;
    for (const edge_g of state.edges_g) {
      const y = Math.round(u.valToPos(edge_g * 9.80665e-3 * state.unit.perNewton, 'y', true));
      for (let x = u.bbox.left; x < u.bbox.left + u.bbox.width; x += 8 * devicePixelRatio) ctx.fillRect(x, y, 2 * devicePixelRatio, devicePixelRatio);
    }
  }
  /** The values' range, and as much of the bands as does not make them small. */
  function fit() {
    let low = 0, high = state.least_N;
    for (const { points, truth } of curves)
      for (const { y, begin, count } of state.simulated ? [points, truth] : [points])
        for (let i = begin; i < count; ++i) {
          low = Math.min(low, y[i] || 0);
          high = Math.max(high, y[i] || 0);
        }
    const most = 1.6 * high, least = 1.6 * low;
    for (const { points: { y, low: under, high: over, begin, count } } of curves)
      for (let i = begin; i < count; ++i) {
        if (Number.isNaN(y[i])) continue;
        high = Math.max(high, Math.min(most, over[i]));
        low = Math.min(low, Math.max(least, under[i]));
      }
    const k = state.unit.perNewton;
    return [-niceAbove(-low * k), niceAbove(high * k)];
  }
  function draw({ from_s, to_s, span_s, now_s, gap_s }) {
    const width = Math.min(MOST_PIXELS - 2, Math.max(1, panel.plot.bbox.width / devicePixelRatio));
    const window = { from_s, to_s, now_s, gap_s, step_s: span_s / width };
    for (const { points, truth } of curves) {
      points.update(window);
      if (state.simulated) truth.update(window);
    }
    stretches.update(window);
    range = fit();
    panel.plot.batch(() => {
      panel.plot.setScale('x', { min: from_s, max: to_s });
      panel.plot.setScale('y', { min: range[0], max: range[1] });
    });
  }
  build();
  new ResizeObserver(() => panel.plot.setSize({ width: Math.max(100, parent.clientWidth), height: Math.max(60, parent.clientHeight) })).observe(parent);
  onThemeChange(build);
  return panel;
}
