// SPDX-License-Identifier: Apache-2.0
// Ranges of the size of a force, whose edges are in grams-force: their names, their shades, and which one holds a force.
import { UNITS, fixed } from './units.js';

const countDecimals = (value) => Math.min(3, (String(value).split('.')[1] ?? '').length);

/** An edge in the reader's unit, as exact as it was given. */
export const edgeText = (edge_g, unit) =>
  fixed((edge_g / UNITS.g.perNewton) * unit.perNewton, unit === UNITS.g ? countDecimals(edge_g) : unit === UNITS.N ? 3 : 0);

/** The same beside a scale, where there is little room. */
export const tickText = (edge_g, unit) => (edge_g === 0 ? '0' : unit === UNITS.N ? fixed(edge_g / UNITS.g.perNewton, 2) : edgeText(edge_g, unit));

/** Names of the bands between edges in grams-force. */
export function bandNames(edges_g, unit) {
  const edge = (value_g) => edgeText(value_g, unit);
  return [
    `< ${edge(edges_g[0])}`,
    ...edges_g.slice(1).map((upper, i) => `${edge(edges_g[i])}–${edge(upper)}`),
    `≥ ${edge(edges_g[edges_g.length - 1])}`,
  ].map((name) => `${name} ${unit.name}`);
}

/** Index of the band that holds a force; an edge belongs to the band above it. -1 where there is no force. */
export function bandOf(force_N, edges_g) {
  if (!Number.isFinite(force_N)) return -1;
  const force_g = force_N * UNITS.g.perNewton;
  let band = 0;
  while (band < edges_g.length && force_g >= edges_g[band]) ++band;
  return band;
}

/** Which of the style sheet's five shades band `i` of `count` has: light to dark in one hue, so that the order shows
 * without colour vision. Names stand beside. */
export const shadeOf = (i, count) => Math.round((count > 1 ? i / (count - 1) : 0) * 4);
