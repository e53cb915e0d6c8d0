// SPDX-License-Identifier: Apache-2.0
// Newtons inside, the reader's unit on the screen.

const NEWTONS_PER_GRAM_FORCE = 9.80665e-3;

/** Units a force can be shown in: `perNewton` converts, `integral` names force times time. */
export const UNITS = {
  g: { name: 'g', long: 'grams-force', perNewton: 1 / NEWTONS_PER_GRAM_FORCE, integral: 'g s', digits: 1 },
  mN: { name: 'mN', long: 'millinewtons', perNewton: 1e3, integral: 'mN s', digits: 1 },
  N: { name: 'N', long: 'newtons', perNewton: 1, integral: 'N s', digits: 4 },
};

/** A force or force-time integral as text, without its unit; a dash where there is none. */
export function format(value_N, unit, digits = unit.digits) {
  return Number.isFinite(value_N) ? fixed(value_N * unit.perNewton, digits) : '–';
}

/** A number with a true minus sign; no "-0.0". */
export function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? Math.abs(Number(text)).toFixed(digits) : text.replace('-', '−');
}

/** Seconds as m:ss.s. */
export function minutes(time_s, digits = 1) {
  const rounded = Number(Math.abs(time_s).toFixed(digits));
  const whole = Math.trunc(rounded / 60);
  const seconds = (rounded - 60 * whole).toFixed(digits);
  return `${time_s < 0 ? '−' : ''}${whole}:${seconds.padStart(digits ? 3 + digits : 2, '0')}`;
}

/** The same only where they are many. */
export function clock(time_s, digits = 1) {
  if (!Number.isFinite(time_s)) return '–';
  return Math.abs(time_s) < 60 ? `${fixed(time_s, digits)} s` : minutes(time_s, digits);
}

/** Time of day, here, of a moment in seconds since 1970: 14:03:07 or, with digits, 14:03:07.25. */
export function timeOfDay(time_s, digits = 0) {
  if (!Number.isFinite(time_s)) return '–';
  const date = new Date(1000 * time_s), two = (value) => String(value).padStart(2, '0');
  const seconds = Math.floor((date.getSeconds() + date.getMilliseconds() / 1000) * 10 ** digits) / 10 ** digits;
  return `${two(date.getHours())}:${two(date.getMinutes())}:${seconds.toFixed(digits).padStart(digits ? 3 + digits : 2, '0')}`;
}
