// SPDX-License-Identifier: Apache-2.0
// The page of `palpate report`: puts the modules together around the data that the program wrote into it.
import 'uplot/dist/uPlot.min.css';
import './theme.css';
import './report.css';
import { bandsView, contactsView } from './modules/bands.js';
import { choice, element } from './modules/dom.js';
import { CHANNELS, at, forceCurves, isMeasured } from './modules/force_curves.js';
import { catheterCard, healthCard, tiles } from './modules/report_cards.js';
import { createShapeView } from './modules/shape_view.js';
import { isDark, setTheme } from './modules/theme.js';
import { createTimePlot } from './modules/time_plot.js';
import { UNITS, fixed, format } from './modules/units.js';

const data = JSON.parse(document.getElementById('data').textContent);
const rows = data.curves;
// Frames whose time is no number, or does not increase, have no place on a time axis.
const onAxis = [];
for (let i = 0, last = -Infinity; i < rows.time_s.length; ++i)
  if (rows.time_s[i] !== null && rows.time_s[i] > last) { onAxis.push(i); last = rows.time_s[i]; }
if (onAxis.length < rows.time_s.length)
  for (const [name, column] of Object.entries(rows))
    if (Array.isArray(column) && !['spans', 'statuses'].includes(name)) rows[name] = onAxis.map((i) => column[i]);

const state = { unit: UNITS.g, channels: ['size'], row: firstRow() };

/** The largest force is what a reader looks for first. */
function firstRow() {
  const peak = data.figures.peak?.time_s;
  return peak === undefined ? 0 : Math.max(0, rows.time_s.indexOf(Number(peak.toPrecision(9))));
}

const nearest = (times, time_s) => {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time_s) low = middle;
    else high = middle;
  }
  return time_s - times[low] <= times[high] - time_s ? low : high;
};

const card = (title, ...content) => element('section', { class: 'card', 'aria-label': title }, element('h2', {}, title), content);

// ---------------------------------------------------------------------------------------------------------- skeleton

const forcePlace = element('div', { class: 'plot', id: 'force-plot', role: 'application', 'aria-label': 'Force over time. Left and right move the moment, plus and minus zoom, page up and down pan, 0 shows all.' });
const nisPlace = element('div', { class: 'plot', id: 'nis-plot', role: 'application', 'aria-label': 'Normalised innovation over time' });
const shapePlace = element('div', { class: 'shape', id: 'shape' });
const legend = element('div', { class: 'legend' });
const readout = element('div', { class: 'readout', 'aria-live': 'polite' });
const bandsPlace = element('div'), contactsPlace = element('div'), tilesPlace = element('div', { class: 'tiles' });
const shapeCaption = element('p', { class: 'note' });
const slider = element('input', { type: 'range', id: 'moment', min: 0, max: Math.max(0, rows.time_s.length - 1), step: 1, 'aria-label': 'moment', oninput: () => setRow(Number(slider.value)) });

const channelChoices = {
  size: { label: '|F|', title: 'size of the force' },
  'axial lateral': { label: 'axial and lateral', title: 'along the tip (d3, pressing is negative) and across it' },
  'x y z': { label: 'components', title: 'along d1, d2, d3 of the tip' },
  'size axial lateral': { label: 'all three', title: 'size, axial and lateral' },
};
const unitChoices = Object.fromEntries(Object.entries(UNITS).map(([key, unit]) => [key, { label: unit.name, title: unit.long }]));

document.getElementById('report').append(
  element('header', {},
    element('div', {}, element('h1', {}, data.title), element('p', { class: 'soft' }, `${data.catheter.name} · ${data.recording}`)),
    element('div', { class: 'tools' },
      choice('unit', unitChoices, 'g', (key) => { state.unit = UNITS[key]; drawAll(); }),
      element('button', { type: 'button', id: 'theme', onclick: () => setTheme(isDark() ? 'light' : 'dark') }, 'light / dark'),
      element('button', { type: 'button', onclick: () => print() }, 'print'))),
  element('p', { class: 'warning-line', role: 'note' }, 'Research software: not for clinical use'),
  tilesPlace,
  element('main', {},
    element('div', { class: 'views' },
      card('Force of the tissue on the tip',
        element('div', { class: 'row' }, choice('curves', channelChoices, 'size', (key) => { state.channels = key.split(' '); drawForce(); }),
          element('span', { class: 'grow' }),
          element('button', { type: 'button', title: 'zoom in (+)', 'aria-label': 'zoom in', onclick: () => forcePlot.zoom(0.5) }, '+'),
          element('button', { type: 'button', title: 'zoom out (-)', 'aria-label': 'zoom out', onclick: () => forcePlot.zoom(2) }, '−'),
          element('button', { type: 'button', title: 'the whole run (0)', onclick: () => forcePlot.zoom(Infinity) }, 'all')),
        legend, forcePlace,
        element('p', { class: 'note screen' }, 'Drag to zoom, double-click for all, shift and drag to pan, click to choose a moment. With the plot in focus: ← → moment, + − zoom, Page ↑ ↓ pan, 0 all.', rows.time_s.length < rows.frames ? ` Drawn: ${rows.time_s.length} of ${rows.frames} frames, every peak among them; all figures are of all frames.` : '')),
      card('Shape', shapePlace, shapeCaption)),
    element('div', { class: 'moment card' }, slider, readout),
    element('div', { class: 'pair' }, card('Time in force bands', bandsPlace), card('Contacts', element('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'table of contacts' }, contactsPlace), element('p', { class: 'note' }, data.figures.contact_rule, ' The integral is that of |F|; ± takes one error to last through the whole contact.'))),
    data.health.innovation ? card('Innovation: does the filter believe its own noise?', nisPlace,
      element('p', { class: 'note' }, 'Normalised innovation squared by its degrees of freedom, one point a frame; shaded: where 95 % of them belong. Points beyond the axis are drawn at its end.')) : null,
    element('div', { class: 'pair' }, healthCard(data, card), catheterCard(data, card))),
  element('footer', {}, `Made by palpate ${data.version}. One file, complete in itself: it loads nothing. Research software: not for clinical use.`));

// -------------------------------------------------------------------------------------------------------------- plots

const spans = rows.spans.map((span) => ({ ...span, kind: span.status === 'AMBIGUOUS' ? '--ambiguous' : '--held' }));
for (const gap of data.health.gaps) spans.push({ from: gap.from_s, to: gap.to_s, status: 'no frames', kind: '--held' });

const plotEvents = (other) => ({
  onMoment: (time_s) => setRow(nearest(rows.time_s, time_s)),
  onStep: (steps) => setRow(Math.min(Math.max(state.row + steps, 0), rows.time_s.length - 1)),
  onRange: (from, to) => other()?.setRange(from, to),
});
const forcePlain = () => ({
  time_s: rows.time_s,
  curves: forceCurves(rows, state.channels, state.unit),
  spans, height: 330, x_label: 'time [min:s]', y_label: `force [${state.unit.name}]`,
});
const nisPlain = () => {
  const limit = (k) => rows.dof.map((dof) => rows.nis_bands[dof]?.[k] ?? null);
  return {
    time_s: rows.time_s,
    curves: [
      { label: '95 %', colour: '--held', values: rows.time_s.map(() => null), lower: limit(0), upper: limit(1) },
      { label: 'NIS / dof', colour: '--size', onlyPoints: true, values: rows.nis_per_dof.map((value) => (value === null ? null : Math.min(value, NIS_TOP))) },
    ],
    spans, height: 170, x_label: 'time [min:s]', y_label: 'NIS / dof', range: () => [0, NIS_TOP],
  };
};
const NIS_TOP = 4;
const forcePlot = createTimePlot(forcePlace, forcePlain(), plotEvents(() => nisPlot));
const nisPlot = data.health.innovation ? createTimePlot(nisPlace, nisPlain(), plotEvents(() => forcePlot)) : null;

// -------------------------------------------------------------------------------------------------------------- shape

// Where the tracker saw no sensor there is no place.
const moments = data.shapes.moments.map((moment) => ({ ...moment, seen: moment.seen.flatMap((at) => at ?? [NaN, NaN, NaN]) }));
const momentTimes = moments.map(({ t }) => t);
const sizes = moments.map(({ force }) => Math.hypot(...force)).filter(Number.isFinite).sort((a, b) => a - b);
const scale = sizes.length && sizes[sizes.length - 1] > 0 ? (0.45 * data.shapes.length_mm) / sizes[Math.floor(0.98 * (sizes.length - 1))] : 100;
const shape = moments.length ? createShapeView(shapePlace, { scale: Number.isFinite(scale) ? scale : 100 }) : null;
if (shape) shape.frame(moments);
else shapePlace.append(element('p', {}, 'The shape needs a browser with WebGL.'));

function drawShape() {
  if (!moments.length) return;
  const i = nearest(momentTimes, rows.time_s[state.row]), moment = moments[i];
  const measured = ['UPDATED', 'RESEEDED'].includes(rows.statuses[moment.status]);
  shape?.show(moment, measured);
  const key = (name, text) => element('span', { class: 'entry' }, swatch(name), text);
  shapeCaption.replaceChildren(
    key('--sensor-model', 'sensor on the shaft'), key('--sensor', 'sensor as tracked'), key('--x', 'd1'), key('--y', 'd2'), key('--z', 'd3'),
    key(measured ? '--size' : '--held-ink', measured ? 'force, 95 % region' : 'force predicted, not measured'),
    element('span', { class: 'entry' }, `at ${fixed(moment.t, 3)} s · 10 mm of arrow are ${format(10 / scale, state.unit)} ${state.unit.name} · grid 10 mm · drag to turn`));
}

// ------------------------------------------------------------------------------------------------------------ drawing

function swatch(name, kind = 'line') {
  const made = element('span', { class: `swatch ${kind}` });
  made.style.setProperty('--of', `var(${name})`);
  return made;
}

function drawForce() {
  forcePlot.set(forcePlain());
  const entry = (name, kind, text) => element('span', { class: 'entry' }, swatch(name, kind), text);
  legend.replaceChildren(
    ...state.channels.map((channel) => entry(CHANNELS[channel].colour, 'band', `${CHANNELS[channel].label}: ${CHANNELS[channel].title}, with 95 % band`)),
    ...(rows.truth_x_N ? [entry('--truth', 'dashed', 'force sensor (truth)')] : []),
    ...(spans.some(({ kind }) => kind === '--held') ? [entry('--held', 'block', 'not measured (held, rejected, no frames)')] : []),
    ...(spans.some(({ kind }) => kind === '--ambiguous') ? [entry('--ambiguous', 'block', 'ambiguous: another force fits as well')] : []));
}

function drawReadout() {
  const { row, unit } = state, measured = isMeasured(rows, row), status = rows.statuses[rows.status[row]];
  const value = (channel) => {
    const { value: force, sigma, truth } = at(rows, channel, row);
    const text = `${format(force, unit)} ± ${format(1.959964 * sigma, unit)}`;
    return element('span', { class: 'value' }, element('b', {}, CHANNELS[channel].label), ` ${text}`, Number.isFinite(truth) && channel.length > 1 ? element('span', { class: 'soft' }, ` (true ${format(truth, unit)})`) : '');
  };
  readout.classList.toggle('unmeasured', !measured);
  readout.replaceChildren(
    element('span', { class: 'value' }, element('b', {}, `${fixed(rows.time_s[row], 3)} s`)),
    ...['size', 'axial', 'lateral', 'x', 'y'].map(value), element('span', { class: 'soft' }, `${unit.name}, ± 95 %`),
    element('span', { class: 'status' }, measured ? status : status === 'AMBIGUOUS' ? 'AMBIGUOUS: another force fits as well' : `${status}: predicted, not measured`));
}

function setRow(row) {
  state.row = row;
  slider.value = String(row);
  slider.setAttribute('aria-valuetext', `${fixed(rows.time_s[row], 3)} s`);
  forcePlot.setMoment(rows.time_s[row]);
  nisPlot?.setMoment(rows.time_s[row]);
  drawReadout();
  drawShape();
}

function drawAll() {
  tilesPlace.replaceChildren(...tiles(data, state.unit));
  bandsPlace.replaceChildren(bandsView(data.figures.bands, state.unit));
  contactsPlace.replaceChildren(contactsView(data.figures.contacts, state.unit, (contact) => {
    const room = Math.max(0.25 * contact.duration_s, 0.25);
    forcePlot.setRange(contact.from_s - room, contact.to_s + room);
    nisPlot?.setRange(contact.from_s - room, contact.to_s + room);
    setRow(nearest(rows.time_s, contact.max_at_s));
    forcePlace.focus();
  }));
  drawForce();
  setRow(state.row);
}

if (rows.time_s.length) drawAll();
document.documentElement.dataset.ready = 'yes';
