// SPDX-License-Identifier: Apache-2.0
// The page of `palpate serve`: puts the modules together around the socket to the program.
import 'uplot/dist/uPlot.min.css';
import './theme.css';
import './dashboard.css';
import { createActions } from './modules/actions.js';
import { createBigNumber } from './modules/big_number.js';
import { choice, element } from './modules/dom.js';
import { createFiguresPanel } from './modules/figures_panel.js';
import { createHealthBanner } from './modules/health_banner.js';
import { createHiddenShare } from './modules/hidden_share.js';
import { judge, whyHidden } from './modules/judge.js';
import { createKeyboard } from './modules/keyboard.js';
import { createLiveLink } from './modules/live_link.js';
import { createLivePlot } from './modules/live_plot.js';
import { createLiveShape } from './modules/live_shape.js';
import { createPace } from './modules/pace.js';
import { createPageFooter } from './modules/page_footer.js';
import { createRowStore } from './modules/row_store.js';
import { createSettings } from './modules/settings.js';
import { createCatheterSelector, createRecordingPanel, createSensorsPanel } from './modules/state_panel.js';
import { colour, isDark, onThemeChange, setTheme } from './modules/theme.js';
import { UNITS, fixed } from './modules/units.js';

// The token came with the address and is a cookie by now: it need not stand where others read it.
if (location.search) history.replaceState(null, '', location.pathname);

const find = (id) => document.getElementById(id);
const settings = createSettings({ unit: 'g', window_s: 30, theme: '' });
if (settings.get('theme')) setTheme(settings.get('theme'));
const store = createRowStore(), pace = createPace(), hiddenShare = createHiddenShare();

// --------------------------------------------------------------------------------------------------------- the parts

const number = createBigNumber(find), banner = createHealthBanner(find), figures = createFiguresPanel(find, () => mark());
const sensors = createSensorsPanel(find('sensors')), recording = createRecordingPanel(find('recording')), footer = createPageFooter(find('footer'));
const selector = createCatheterSelector(find('catheters'), (i) => watch(i)), shape = createLiveShape(find('shape'), find('shape-note'));
const catheter = () => link.hello?.catheters[link.watched];
const actions = createActions(find('notes'), () => ({ catheter: catheter()?.name ?? '', all: link.hello?.catheters.map(({ name }) => name) ?? [] }), timeOf, colour);

const state = {
  store, unit: UNITS.g, statuses: [], simulated: false, marks: actions.marks, edges_g: [5, 10, 30, 40], least_N: 12 / UNITS.g.perNewton,
  /** Now, on the clock of the rows: the latest one's time, and what has passed since. */
  now_s: () => (store.length ? store.lastTime() + (performance.now() - stored_ms) / 1000 : NaN),
  gap_s: () => link.row?.get('stale_after_s'),
};
let stored_ms = NaN, fresh = false;
const traces = createLivePlot({ tools: find('trace-tools'), legend: find('trace-legend'), size: find('trace-size'), parts: find('trace-parts'), note: find('trace-note') }, state, settings.get('window_s'), (span) => settings.set('window_s', span));

const unitChoice = choice('unit', Object.fromEntries(Object.entries(UNITS).map(([key, { name, long }]) => [key, { label: name, title: `${long} (u: next)` }])), settings.get('unit'), setUnit);
find('tools').append(unitChoice,
  element('button', { type: 'button', id: 'theme', title: 'light or dark (d)', onclick: () => turnTheme() }, 'light / dark'),
  element('button', { type: 'button', id: 'keys', title: 'keys (?)', onclick: () => keyboard.help() }, 'keys ?'));

// ------------------------------------------------------------------------------------------------------ what one does

function setUnit(key) {
  settings.set('unit', key);
  useUnit(key);
}
function useUnit(key) {
  state.unit = UNITS[key] ?? UNITS.g;
  for (const button of unitChoice.children) button.setAttribute('aria-pressed', String(button.dataset.key === state.unit.name));
  number.setUnit(state.unit);
  traces.ask();
}
const nextUnit = () => setUnit({ g: 'mN', mN: 'N', N: 'g' }[state.unit.name]);
const turnTheme = () => {
  setTheme(isDark() ? 'light' : 'dark');
  settings.set('theme', document.documentElement.dataset.theme);
};
const mark = () => figures.mark(link.row);
function watch(i) {
  if (!link.hello?.catheters[i] || i === link.watched) return;
  link.watch(i);
  settle();
}

const keyboard = createKeyboard([
  { keys: [' '], shown: 'space', does: 'stop or follow the traces', act: () => traces.toggle() },
  { keys: ['ArrowLeft', 'ArrowRight'], shown: '← →', does: 'scroll back and forth (with shift: half a window)', act: (event) => traces.pan((event.key === 'ArrowLeft' ? -1 : 1) * (event.shiftKey ? 0.5 : 0.1)) },
  { keys: ['+', '='], shown: '+ −', does: 'zoom', act: () => traces.zoom(0.7) }, { keys: ['-'], act: () => traces.zoom(1 / 0.7) },
  { keys: ['l', 'End'], shown: 'l', does: 'back to now', act: () => traces.live() }, { keys: ['w'], shown: 'w', does: 'next window', act: () => traces.nextWindow() },
  { keys: ['u'], shown: 'u', does: 'next unit', act: nextUnit }, { keys: ['i'], shown: 'i', does: 'count the integral from now', act: mark },
  { keys: ['n'], shown: 'n', does: 'note', act: () => actions.focusNote() }, { keys: ['t'], shown: 't', does: 'tare', act: () => actions.askTare() },
  { keys: '123456789'.split(''), shown: '1 – 9', does: 'catheter', act: (event) => watch(Number(event.key) - 1) },
  { keys: ['d'], shown: 'd', does: 'light or dark', act: turnTheme }, { keys: [], shown: '?', does: 'this list', act: () => {} },
]);

// --------------------------------------------------------------------------------------------------- what the program says

function timeOf(server_ms) {
  return link.row && store.length ? store.lastTime() + (server_ms - link.row.get('received_ms')) / 1000 : server_ms / 1000;
}
/** Another catheter, or the program anew: what belonged to the one before is gone. */
function settle() {
  store.clear();
  hiddenShare.forget();
  actions.forgetMarks();
  figures.setCatheter(catheter(), link.hello.contact_rule);
  state.simulated = catheter().simulated;
  sensors.setCatheter(catheter());
  shape.setCatheter(catheter(), state.edges_g);
  traces.ask();
}
let before = '';
const link = createLiveLink(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/live`, {
  hello(hello) {
    state.statuses = hello.statuses;
    if (hello.bands_g?.length) number.setBands((state.edges_g = hello.bands_g));
    if (!settings.has('unit')) useUnit(hello.unit);
    selector.set(hello.catheters);
    const now = JSON.stringify([hello.catheters, hello.watched]);
    if (now !== before) settle(); // the same program again: its rows go on where they ended
    before = now;
  },
  row(row) {
    fresh = true;
    hiddenShare.add(link.heard_ms, whyHidden(row, state.statuses)?.word ?? '');
    if (store.push(row)) stored_ms = link.heard_ms;
  },
  history(fields, rows, numbers, step_s) {
    const empty = store.length === 0;
    store.merge(fields, rows, numbers, step_s);
    if (empty) stored_ms = performance.now();
    traces.ask();
  },
  status() {},
  event: (event) => [footer, figures, actions].forEach((part) => part.hear(event, link)), // each what is its own
});

// --------------------------------------------------------------------------------------------------------- the drawing

const mine = () => link.status?.catheters?.[link.watched];
function verdictNow(now_ms) {
  const verdict = judge({ now_ms, link, row: link.row, arrived_ms: link.arrived_ms, clock: link.clock, statuses: state.statuses, words: mine()?.words ?? [] });
  const gone = (link.status?.sources ?? []).find(({ connected }) => connected === false);
  if (gone && ['stale', 'waiting'].includes(verdict.kind)) verdict.reason += ` · source ${gone.server} not connected${gone.error ? `: ${gone.error}` : ''}`;
  const failing = link.open && link.status?.recording?.failing ? ['RECORDING FAILING'] : [];
  verdict.reason = (verdict.shown ? [...failing, verdict.reason] : [verdict.reason, ...failing]).filter(Boolean).join(' · ');
  return verdict;
}
const usual = () => [Number.isFinite(mine()?.rate_hz) ? `${fixed(mine().rate_hz, 1)} frames/s` : '', state.simulated ? 'simulated' : ''].filter(Boolean).join(' · ');

let verdict = verdictNow(performance.now()), turn = 0, ticked_ms = performance.now(), slow_ms = -Infinity, footer_ms = -Infinity, lively_ms = -Infinity, late_ms = NaN;
const painted = new MessageChannel(); // its message comes after the frame was drawn
painted.port1.onmessage = () => { if (Number.isFinite(late_ms)) footer.late(performance.now(), link.clock.host(performance.now()) - late_ms); late_ms = NaN; };

function drawFigures(now_ms) {
  const heard = link.open, stale = verdict.kind === 'stale';
  slow_ms = now_ms;
  figures.draw(verdict, link.row, state.unit);
  sensors.draw(mine(), now_ms, heard, stale);
  recording.draw(link.status?.recording, heard && link.status !== null);
  selector.draw(link.status?.catheters, link.watched, heard, stale);
}
function draw(now_ms) {
  const shown = verdict.shown;
  verdict = verdictNow(now_ms);
  banner.draw(verdict, now_ms, hiddenShare.words(now_ms), usual());
  number.draw(verdict, link.row);
  if (verdict.shown || verdict.kind === 'hidden') lively_ms = now_ms;
  actions.setLive(now_ms - lively_ms < 1000); // a tare takes the latest second
  if (verdict.shown !== shown) drawFigures(now_ms); // no figure outlives the number
}
function frame() {
  requestAnimationFrame(frame);
  const now_ms = performance.now();
  if (!wakes(now_ms)) {
    draw(now_ms);
    if (fresh && verdict.shown) painted.port2.postMessage((late_ms = link.row.get('received_ms')));
    fresh = false;
    if (now_ms - slow_ms > 95) drawFigures(now_ms);
  }
  pace.frame(now_ms);
  // Of the two large things one a frame, in turn.
  const large = [() => traces.frame(now_ms, pace.stretch()), () => shape.frame(verdict, link.row, now_ms, state.unit, pace.stretch())];
  if (!large[turn % 2]()) large[(turn + 1) % 2]();
  ++turn;
  if (now_ms - footer_ms > 995) footer.draw((footer_ms = now_ms), link);
  footer.script(performance.now(), performance.now() - now_ms + link.script_ms);
  link.script_ms = 0;
}
/** A page that was held up has rows that wait for it: they are heard first, or all would look old. */
const wakes = (now_ms) => now_ms - ticked_ms > 60 && !document.hidden;
// Frames may be rare, silence must not wait for one.
setInterval(() => {
  const now_ms = performance.now(), judges = verdict.shown && !wakes(now_ms);
  ticked_ms = now_ms;
  if (judges && !verdictNow(now_ms).shown) draw(now_ms);
}, 20);
addEventListener('visibilitychange', () => draw(performance.now())); // what stood there while nobody looked is old
onThemeChange(() => { actions.repaint(); traces.ask(); });
useUnit(settings.get('unit'));
requestAnimationFrame(frame);
window.palpate = { store, link, traces: traces.view, marks: actions.marks, drawn: number.drawn, verdict: () => verdict, figures: (latest_ms) => footer.figures(performance.now(), latest_ms) };
document.documentElement.dataset.ready = 'yes';
