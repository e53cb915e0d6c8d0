// SPDX-License-Identifier: Apache-2.0
import { bandNames, shadeOf } from './band_names.js';
import { element, table } from './dom.js';
import { clock, fixed, format } from './units.js';

const shade = (i, count) => `var(--band-${shadeOf(i, count)})`;

/** `bands`: {edges_g, seconds, not_measured_s, total_s}. Returns a bar and a table. */
export function bandsView(bands, unit) {
  const names = [...bandNames(bands.edges_g, unit), 'not measured'];
  const seconds = [...bands.seconds, bands.not_measured_s];
  const share = (value) => (bands.total_s > 0 ? (100 * value) / bands.total_s : 0);
  const fill = (i) => (i < bands.seconds.length ? shade(i, bands.seconds.length) : 'repeating-linear-gradient(45deg, var(--held) 0 3px, transparent 3px 7px)');
  const parts = seconds.map((value, i) => {
    const part = element('div', { class: 'part', title: `${names[i]}: ${fixed(value, 1)} s, ${fixed(share(value), 1)} %` });
    part.style.flexGrow = String(value);
    part.style.background = fill(i);
    return part;
  });
  const rows = seconds.map((value, i) => {
    const key = element('span', { class: 'key' });
    key.style.background = fill(i);
    return [element('span', {}, key, names[i]), clock(value), `${fixed(share(value), 1)} %`];
  });
  const words = names.map((name, i) => `${name}: ${fixed(share(seconds[i]), 1)} %`).join(', ');
  return element('div', { class: 'bands' },
    element('div', { class: 'bar', role: 'img', 'aria-label': `Share of time by size of force. ${words}` }, parts),
    table(null, [{ title: 'size of the force' }, { title: 'time', number: true }, { title: 'share', number: true }], rows));
}

/** `contacts`: [{from_s, to_s, duration_s, mean_N, max_N, integral_Ns, integral_sigma_Ns, bridged_s}]. */
export function contactsView(contacts, unit, onChoose) {
  const columns = ['contact', 'start', 'end', 'duration', `mean [${unit.name}]`, `max [${unit.name}]`, `integral [${unit.integral}]`, '± 95 %', 'not measured'];
  const rows = contacts.map((contact, i) => [
    element('button', { type: 'button', class: 'link', title: 'show this contact', onclick: () => onChoose(contact) }, String(i + 1)),
    clock(contact.from_s, 2), clock(contact.to_s, 2), `${fixed(contact.duration_s, 2)} s`,
    format(contact.mean_N, unit), format(contact.max_N, unit), format(contact.integral_Ns, unit),
    format(1.959964 * contact.integral_sigma_Ns, unit), contact.bridged_s > 0 ? `${fixed(contact.bridged_s, 2)} s` : '–',
  ]);
  if (rows.length === 0) return element('p', {}, 'No contact.');
  return table(null, columns.map((title, i) => ({ title, number: i > 0 })), rows);
}
