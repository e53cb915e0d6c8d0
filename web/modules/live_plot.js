// SPDX-License-Identifier: Apache-2.0
// The traces: |F| above, axial and lateral below, over a window that follows now until the person stops it.
import { choice, element } from './dom.js';
import { CHANNELS, Z_95 } from './force_curves.js';
import { createTracePanel } from './trace_panel.js';
import { createTraceView } from './trace_view.js';
import { fixed, format, timeOfDay } from './units.js';

export const WINDOWS = { 10: '10 s', 30: '30 s', 60: '1 min', 600: '10 min' };
/** The limit of silence where the program has not told it [s]. */
const GAP_S = 0.3, LEAST_DRAW_MS = 40, MOST_DRAW_MS = 250;

/**
 * `places`: {tools, legend, size, parts, note}: elements. `state`: as for a panel, besides now_s() and gap_s().
 * `onWindow(span_s)`: the person chose another window.
 */
export function createLivePlot(places, state, span_s, onWindow) {
  const view = createTraceView(span_s);
  const panels = [
    createTracePanel(places.size, ['size'], state, { timeAxis: false, named: true }),
    createTracePanel(places.parts, ['axial', 'lateral'], state, { timeAxis: true, named: false }),
  ];
  let drawn_ms = -Infinity, asked = true, waiting = null, box = places.size.getBoundingClientRect();

  const windows = choice('window of the traces', Object.fromEntries(Object.entries(WINDOWS).map(([key, label]) => [key, { label, title: `the latest ${label} (w: next)` }])), String(span_s), (key) => setSpan(Number(key)));
  const pause = element('button', { type: 'button', id: 'pause', title: 'stop or follow (space)', onclick: () => toggle() });
  const live = element('button', { type: 'button', id: 'live', title: 'back to now (l)', onclick: () => change(() => view.live()) }, 'live');
  places.tools.append(windows, pause, live);

  const change = (act) => {
    act();
    asked = true;
    sayPause();
  };
  const sayPause = () => {
    pause.textContent = view.follows ? 'pause' : 'paused';
    pause.setAttribute('aria-pressed', String(!view.follows));
    live.disabled = view.follows;
    for (const button of windows.children) button.setAttribute('aria-pressed', String(Number(button.dataset.key) === view.span_s));
  };
  const sayLegend = () => {
    const entry = (name, kind, text) => {
      const swatch = element('span', { class: `swatch ${kind}` });
      swatch.style.setProperty('--of', `var(${name})`);
      return element('span', { class: 'entry' }, swatch, text);
    };
    places.legend.replaceChildren(...['size', 'axial', 'lateral'].map((channel) => entry(CHANNELS[channel].colour, 'band', CHANNELS[channel].label)),
      element('span', { class: 'entry' }, `[${state.unit.name}], band: 95 %`), ...(state.simulated ? [entry('--truth', 'dashed', 'true')] : []), entry('--held', 'block', 'not measured'), entry('--ambiguous', 'block', 'ambiguous'));
  };
  const setSpan = (span) => change(() => { view.setSpan(span); onWindow(view.span_s); });
  const toggle = () => change(() => (view.follows ? view.pause(state.now_s()) : view.live()));
  const pan = (share) => change(() => view.pan(share, state.now_s()));
  const zoom = (factor, about_s) => change(() => {
    const { from_s, to_s } = view.window(state.now_s(), state.store.firstTime());
    view.zoom(factor, about_s ?? (from_s + to_s) / 2, state.now_s());
  });
  const nextWindow = () => {
    const spans = Object.keys(WINDOWS).map(Number);
    setSpan(spans.find((span) => span > view.span_s) ?? spans[0]);
  };

  for (const place of [places.size, places.parts]) {
    let from = null;
    place.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      from = event.clientX;
      place.setPointerCapture(event.pointerId);
    });
    place.addEventListener('pointermove', (event) => {
      if (from === null || event.clientX === from) return;
      pan((from - event.clientX) / box.width);
      from = event.clientX;
    });
    for (const end of ['pointerup', 'pointercancel']) place.addEventListener(end, () => { from = null; });
    place.addEventListener('wheel', (event) => {
      event.preventDefault();
      if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) return pan((event.deltaX || event.deltaY) / 1000);
      zoom(event.deltaY > 0 ? 1.25 : 0.8, panels.map(({ hovered }) => hovered).find(Number.isFinite));
    }, { passive: false });
  }
  new ResizeObserver(() => { box = places.size.getBoundingClientRect(); asked = true; }).observe(places.size);

  /** What stood at a moment, in words. */
  const told = (time_s) => {
    const { store, unit } = state, i = Math.min(store.lowerBound(time_s), store.length - 1);
    if (i < 0) return '';
    const at = (name) => store.at(name, i);
    if (at('shown') !== 1) return `${timeOfDay(at('time_s'), 1)}: ${state.statuses[at('status')] ?? 'nothing'}, no force`;
    return `${timeOfDay(at('time_s'), 1)}: ` + ['size', 'axial', 'lateral'].map((channel) =>
      `${CHANNELS[channel].label} ${format(at(`${channel}_N`), unit)} ± ${format(Z_95 * at(`sigma_${channel}_N`), unit)}`).join(', ') + ` ${unit.name}`;
  };
  const note = () => {
    const time_s = panels.map(({ hovered }) => hovered).find(Number.isFinite);
    if (time_s !== undefined && state.store.length) return told(time_s);
    return view.follows ? '' : `traces stand at ${timeOfDay(view.to_s)}, ${fixed(state.now_s() - view.to_s, 0)} s ago; the number goes on`;
  };

  /** Draws when there is something to see: a window of ten minutes moves by a pixel only now and then. One panel a frame,
   * so that none takes long. Returns whether it drew. */
  function frame(now_ms, stretch) {
    if (waiting) {
      panels[1].draw(waiting);
      waiting = null;
      return true;
    }
    const now_s = state.now_s(), wait = stretch * Math.min(MOST_DRAW_MS, Math.max(LEAST_DRAW_MS, (500 * view.span_s) / Math.max(1, box.width)));
    if (!Number.isFinite(now_s) || now_ms - drawn_ms < (asked ? LEAST_DRAW_MS / 2 : wait)) return false;
    drawn_ms = now_ms;
    asked = false;
    waiting = { ...view.window(now_s, state.store.firstTime()), span_s: view.span_s, now_s, gap_s: Math.max(GAP_S, state.gap_s() || 0) };
    panels[0].draw(waiting);
    const text = note();
    if (places.note.textContent !== text) places.note.textContent = text;
    return true;
  }
  /** The state is another: unit, colours, catheter. */
  function ask() {
    asked = true;
    sayLegend();
  }
  sayPause();
  return { frame, toggle, pan, zoom, nextWindow, live: () => change(() => view.live()), ask, view };
}
