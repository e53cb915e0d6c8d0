// SPDX-License-Identifier: Apache-2.0
// From the rows of an estimate to the curves of a plot.

export const CHANNELS = {
  size: { label: '|F|', title: 'size of the force', colour: '--size' },
  axial: { label: 'axial', title: 'along the tip, d3; pressing is negative', colour: '--z' },
  lateral: { label: 'lateral', title: 'across the tip, in the plane of d1 and d2', colour: '--lateral' },
  x: { label: 'Fx', title: 'along d1', colour: '--x' },
  y: { label: 'Fy', title: 'along d2', colour: '--y' },
  z: { label: 'Fz', title: 'along d3', colour: '--z' },
};

export const Z_95 = 1.959964;
const MEASURED = new Set(['UPDATED', 'RESEEDED']);
export const isMeasured = (rows, i) => MEASURED.has(rows.statuses[rows.status[i]]);

/** Value [N], its sigma, and the truth where there is one, of row `i`. `rows`: see the report's data, `curves`. */
export function at(rows, channel, i) {
  const of = (prefix) => {
    const [x, y, z] = ['x', 'y', 'z'].map((axis) => rows[`${prefix}${axis}_N`]?.[i] ?? NaN);
    return { size: Math.hypot(x, y, z), axial: z, lateral: Math.hypot(x, y), x, y, z }[channel];
  };
  const sigma = { size: rows.sigma_size_N, lateral: rows.sigma_lateral_N, axial: rows.sigma_z_N }[channel] ?? rows[`sigma_${channel}_N`];
  return { value: of('f'), sigma: sigma[i] ?? NaN, truth: of('truth_') };
}

/** Curves of the chosen channels in a unit: nothing where nothing was measured. */
export function forceCurves(rows, channels, unit) {
  const number = (value) => (Number.isFinite(value) ? value * unit.perNewton : null);
  return channels.flatMap((channel) => {
    const { label, colour } = CHANNELS[channel];
    const points = rows.time_s.map((_, i) => at(rows, channel, i));
    const shown = (i, value) => (isMeasured(rows, i) ? number(value) : null);
    const low = channel === 'size' || channel === 'lateral' ? 0 : -Infinity; // a size is never negative
    const estimate = {
      label, colour,
      values: points.map((p, i) => shown(i, p.value)),
      lower: points.map((p, i) => shown(i, Math.max(low, p.value - Z_95 * p.sigma))),
      upper: points.map((p, i) => shown(i, p.value + Z_95 * p.sigma)),
    };
    if (!rows.truth_x_N) return [estimate];
    // The truth lies below: where both are one they must not hide the estimate.
    return [{ label: `${label}, true`, colour: '--truth', dashed: true, width: 1.25, values: points.map((p) => number(p.truth)) }, estimate];
  });
}
