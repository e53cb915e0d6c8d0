// SPDX-License-Identifier: Apache-2.0
// The smaller figures: components and angle, what the contact was like, rhythm, stiffness.
import { element } from './dom.js';
import { Z_95 } from './force_curves.js';
import { clock, fixed, format, timeOfDay } from './units.js';

const put = (place, text) => { if (place.textContent !== text) place.textContent = text; };
const tile = (label, title) => {
  const value = element('span', { class: 'value' }, '–'), note = element('span', { class: 'note' });
  const box = element('div', { class: 'tile', title }, element('span', { class: 'label' }, label), value, note);
  return {
    box, label: box.firstChild,
    say(text, beneath = '', grey = false) {
      put(value, text);
      put(note, beneath);
      box.classList.toggle('grey', grey);
    },
  };
};

/** What was summed up since a moment: differences of the program's own sums. */
export function sinceMark(row, mark) {
  const of = (name) => row.get(name) - (mark?.[name] ?? 0);
  const measured_s = of('measured_s'), unmeasured_s = of('unmeasured_s'), total_s = measured_s + unmeasured_s;
  return { integral_Ns: of('integral_Ns'), sigma_Ns: of('integral_sigma_Ns'), unmeasured: total_s > 0 ? unmeasured_s / total_s : NaN };
}
/** Events after which the force has another zero. */
const ZEROS = new Set(['tare', 'base']);
const MARKED = ['integral_Ns', 'integral_sigma_Ns', 'measured_s', 'unmeasured_s'];

/** `onMark`: the key press that the integral counts from. Returns {draw(verdict, row, unit), mark(row), hear(event, link), setCatheter}. */
export function createFiguresPanel(find, onMark) {
  const axial = tile('axial', 'along the tip, d3; pressing is negative'), lateral = tile('lateral', 'across the tip'), angle = tile('contact angle', 'between the push of the tissue and the axis of the tip: 0° head-on, 90° from the side');
  find('parts').append(...[axial, lateral, angle].map(({ box }) => element('div', { class: 'card' }, box)));
  const contact = tile('contact', 'how long the tip has touched'), largest = tile('largest of the contact', 'largest |F| of this contact, or of the latest one');
  const integral = tile('∫ since contact', 'force-time integral of this contact, or of the latest one'), marked = tile('∫ since start', 'force-time integral since the start, or since the key i');
  const rhythm = tile('rhythm', 'of the force in the latest ten seconds'), stiffness = tile('EI1 EI2 GJ [N mm²]', 'stiffness as estimated, ± 95 %');
  const heart = element('span', { class: 'heart', 'aria-hidden': 'true' }, '♥'), zero = element('button', { type: 'button', class: 'small', id: 'mark', title: 'count from now (i)', onclick: onMark }, 'zero');
  rhythm.label.append(' ', heart);
  marked.box.append(zero);
  stiffness.box.classList.add('wide');
  find('figures').append(...[contact, largest, integral, marked, rhythm, stiffness].map(({ box }) => box));
  let mark = null, beat = 0, tared_s = NaN, within = false;

  const force = (place, value_N, sigma_N, unit, hidden, words) => {
    if (!Number.isFinite(value_N)) return place.say('–', '', true);
    place.say(`${format(value_N, unit, unit.name === 'N' ? 3 : 1)}`, hidden ? words : `± ${format(Z_95 * sigma_N, unit, unit.name === 'N' ? 3 : 1)} ${unit.name}`, hidden);
  };
  const sum = (place, value_Ns, sigma_Ns, unit, grey, more = '') => {
    const digits = unit.name === 'N' ? 3 : 0;
    if (!Number.isFinite(value_Ns)) place.say('–', more, true);
    else place.say(`${format(value_Ns, unit, digits)} ${unit.integral}`, `± ${format(Z_95 * sigma_Ns, unit, digits)}${more}`, grey);
  };
  const showRhythm = (beats, strength) => {
    const known = Number.isFinite(beats) && Number.isFinite(strength);
    rhythm.say(known ? `${fixed(beats, 0)} /min` : '–', known ? `strength ${fixed(strength, 2)}` : 'none found', !known);
    const next = known ? Math.round(beats) : 0;
    if (Math.abs(next - beat) < 2 && Boolean(next) === Boolean(beat)) return;
    beat = next; // told anew only when it differs: each time the blinking begins anew
    heart.style.animationDuration = beat ? `${(60 / beat).toFixed(3)}s` : '';
    heart.classList.toggle('beats', beat > 0);
  };
  const showStiffness = (row, live) => {
    const values = row.part('stiffness_Nm2'), sigmas = row.part('sigma_stiffness_Nm2'), known = live && values && values.every(Number.isFinite);
    const text = known ? Array.from(values, (value) => fixed(value * 1e6, value < 1e-5 ? 2 : 0)).join('  ') : '–';
    const wide = known ? `± ${Array.from(sigmas, (sigma) => (Number.isFinite(sigma) ? fixed(Z_95 * sigma * 1e6, sigma < 1e-5 ? 1 : 0) : '–')).join('  ')}` : '';
    const prior = known && row.get('stiffness_on_prior') === 1;
    stiffness.say(text, wide + (prior ? ' · rests on prior' : ''), !known || prior);
    stiffness.box.classList.toggle('prior', prior);
  };
  function draw(verdict, row, unit) {
    const live = verdict.shown, of = (name) => (live ? row.get(name) : NaN), said = (name) => (row ? row.get(name) : NaN);
    force(axial, of('axial_N'), of('sigma_axial_N'), unit, said('axial_hidden') === 1, 'axial not observable');
    force(lateral, of('lateral_N'), of('sigma_lateral_N'), unit, said('lateral_hidden') === 1, 'lateral not observable');
    const angle_deg = (of('angle_rad') * 180) / Math.PI, sigma_deg = (of('sigma_angle_rad') * 180) / Math.PI;
    const angleHidden = said('axial_hidden') === 1 || said('lateral_hidden') === 1;
    angle.say(Number.isFinite(angle_deg) ? `${fixed(angle_deg, 0)}°` : '–', Number.isFinite(sigma_deg) ? (angleHidden ? 'angle not observable' : `± ${fixed(Math.min(180, Z_95 * sigma_deg), Z_95 * sigma_deg < 2 ? 1 : 0)}°`) : '', !Number.isFinite(angle_deg) || angleHidden);
    const touches = said('contact') === 1;
    contact.say(live && touches ? clock(said('contact_s'), 1) : live ? 'none' : '–', live && touches ? 'touching now' : '', !live || !touches);
    largest.say(Number.isFinite(said('contact_largest_N')) ? `${format(said('contact_largest_N'), unit, unit.name === 'N' ? 3 : 1)} ${unit.name}` : '–', touches && live ? 'this contact' : 'latest contact', !live || !touches);
    if (touches) within = row.get('time_s') - row.get('contact_s') < tared_s;
    sum(integral, said('contact_integral_Ns'), said('contact_integral_sigma_Ns'), unit, !live || !touches, within ? ' · tared within' : '');
    if (row && mark && row.get('integral_Ns') < mark.integral_Ns) forget(); // the program was started anew
    const since = row ? sinceMark(row, mark) : { integral_Ns: NaN };
    sum(marked, since.integral_Ns, since.sigma_Ns, unit, !live, since.unmeasured > 0 ? ` · ${fixed(100 * since.unmeasured, since.unmeasured < 0.1 ? 1 : 0)} % not measured` : '');
    showRhythm(of('beats_per_min'), of('beat_strength'));
    if (!stiffness.box.hidden && row) showStiffness(row, live);
  }
  function forget() {
    mark = null;
    put(marked.label, '∫ since start');
  }
  function markAt(row, what = '') {
    if (!row || !Number.isFinite(row.get('integral_Ns'))) return false;
    mark = Object.fromEntries(MARKED.map((name) => [name, row.get(name)]));
    put(marked.label, `∫ since ${what}${timeOfDay(row.get('time_s'))}`);
    return true;
  }
  return {
    draw,
    mark: (row) => markAt(row),
    /** Force counts from another zero: the page's own sum begins anew, that of a contact which it falls into says so. */
    hear({ event, catheter }, { watched, row }) {
      if (!ZEROS.has(event) || catheter !== watched || !row) return;
      tared_s = row.get('time_s');
      markAt(row, 'tare ');
    },
    /** `rule`: what counts as contact, in words. */
    setCatheter({ estimates }, rule) {
      stiffness.box.hidden = !estimates?.includes('stiffness');
      contact.box.title = `how long the tip has touched: ${rule}`;
      tared_s = NaN;
      within = false;
      forget();
    },
  };
}
