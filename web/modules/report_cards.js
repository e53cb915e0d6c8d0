// SPDX-License-Identifier: Apache-2.0
import { element, table } from './dom.js';
import { clock, fixed, format } from './units.js';

const percent = (share) => `${fixed(100 * share, share > 0 && share < 0.001 ? 2 : 1)} %`;

/** The figures to see first: [{label, value, note}] as tiles. */
export function tiles({ figures, health }, unit) {
  const sum = (key) => figures.contacts.reduce((total, contact) => total + contact[key], 0);
  const measured = (health.by_status.UPDATED ?? 0) + (health.by_status.RESEEDED ?? 0);
  const tile = (label, value, note) => element('div', { class: 'tile' }, element('span', { class: 'label' }, label), element('span', { class: 'figure' }, value), element('span', { class: 'note' }, note));
  const { peak, contacts } = figures;
  const sigma = 1.959964 * sum('integral_sigma_Ns');
  return [
    tile('largest force', peak ? `${format(peak.size_N, unit)} ${unit.name}` : '–', peak ? `± ${format(1.959964 * peak.sigma_N, unit)} (95 %), at ${clock(peak.time_s)}` : 'nothing was measured'),
    tile('contacts', String(contacts.length), `${clock(sum('duration_s'))} together`),
    tile('force-time integral', `${format(sum('integral_Ns'), unit)} ${unit.integral}`, `of all contacts, ± ${format(sigma, unit)}`),
    tile('measured', percent(health.frames ? measured / health.frames : 0), `${measured} of ${health.frames} frames`),
    tile('NIS / dof', health.innovation ? fixed(health.innovation.mean_nis_per_dof, 2) : '–', health.innovation ? `expected 1; ${percent(health.innovation.share_inside_95)} inside 95 %` : 'not in the estimate'),
  ];
}

const MEANINGS = {
  UPDATED: 'used', RESEEDED: 'used, after the search began again elsewhere', AMBIGUOUS: 'used, another force fits as well',
  REJECTED: 'the frame contradicts itself', HELD: 'no usable sensor', NOT_CONVERGED: 'no answer within the bounded work', STALE: 'nothing came for too long',
};

export function healthCard({ health, estimate }, card) {
  const statuses = Object.entries(health.by_status).filter(([, count]) => count > 0);
  const share = (count, of) => (of ? percent(count / of) : '–');
  const warnings = [...health.warnings, ...health.events.map(({ text }) => text).filter((text) => !health.warnings.some((warning) => warning.includes(text)))];
  for (const { from_s, to_s } of health.gaps.slice(0, 20)) warnings.push(`no frames from ${clock(from_s, 2)} to ${clock(to_s, 2)}`);
  if (health.gaps.length > 20) warnings.push(`and ${health.gaps.length - 20} more stretches without frames`);
  return card('Health',
    table('What became of the frames', [{ title: 'status' }, { title: 'frames', number: true }, { title: 'share', number: true }, { title: 'meaning' }],
      statuses.map(([status, count]) => [status, String(count), share(count, health.frames), MEANINGS[status] ?? ''])),
    table('Sensors', [{ title: 'sensor' }, { title: 'usable', number: true }, { title: 'not usable, and why' }],
      health.sensors.map(({ name, frames, usable, reasons }) => [name, share(usable, frames), Object.entries(reasons ?? {}).map(([reason, count]) => `${reason}: ${count}`).join(', ') || '–'])),
    element('h3', {}, 'What can be known'),
    health.words ? element('pre', { class: 'words' }, health.words.trim()) : element('p', { class: 'note' }, `The estimate was read from ${estimate}, which does not say what it could not observe: without --estimate the report does.`),
    element('h3', {}, 'Warnings'),
    warnings.length ? element('ul', {}, warnings.map((text) => element('li', {}, text))) : element('p', {}, 'None.'));
}

export function catheterCard({ catheter, recording, estimate, truth, version }, card) {
  const plus = (value, sigma) => `${value}${sigma ? ` (σ ${sigma})` : ''}`;
  const [EI1, EI2, GJ] = catheter.stiffness_Nm2;
  const rows = [
    ['catheter', catheter.name],
    ['length', `${catheter.length_mm} mm`],
    ['EI1, EI2, GJ', `${[EI1, EI2, GJ].map((value) => fixed(value * 1e6, 1)).join(', ')} N mm², σ ${catheter.stiffness_sigma_percent} %`],
    ['precurvature k1, k2, τ', catheter.precurvature_per_m.map((value, i) => plus(value, catheter.precurvature_sigma_per_m[i])).join(', ') + ' 1/m'],
    ...catheter.sensors.map(({ name, kind, arc_length_mm, noise_mm, noise_deg }) => [`sensor ${name}`, `${kind} at ${arc_length_mm} mm, noise ${[...new Set(noise_mm)].join(', ')} mm${kind === 'position' ? '' : `, ${noise_deg}°`}`]),
    ['method', `${catheter.method} on ${catheter.measurement}, force as ${catheter.force_model}`],
    ['estimated beside the force', [catheter.estimates_stiffness && 'stiffness', catheter.estimates_precurvature && 'precurvature'].filter(Boolean).join(', ') || 'nothing'],
    ["the file's sigmas", catheter.considers_uncertainty ? 'widen those of the force' : 'left out'],
    ['recording', recording],
    ['estimate', estimate ?? 'made for this report'],
    ['truth', truth ?? 'none'],
    ['palpate', version],
  ];
  if (estimate) rows.push(['note', 'the settings are those of the catheter file; the estimate may have been made with others']);
  return card('Catheter and settings', table(null, [{ title: '' }, { title: '' }], rows),
    element('details', {}, element('summary', {}, `Catheter file ${catheter.source}`), element('pre', {}, catheter.text)));
}
