// SPDX-License-Identifier: Apache-2.0
// Colours live in the style sheet; canvases read them here.

/** The value of a custom property, as '--axis' is. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** '#rrggbb' with an opacity. */
export const faded = (hex, alpha) => hex + Math.round(255 * alpha).toString(16).padStart(2, '0');

const listeners = new Set();
const dark = matchMedia('(prefers-color-scheme: dark)');

export const isDark = () => (document.documentElement.dataset.theme ?? (dark.matches ? 'dark' : 'light')) === 'dark';

/** Calls back whenever the colours have changed. Returns what undoes it. */
export function onThemeChange(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  for (const listener of listeners) listener();
}

dark.addEventListener('change', () => listeners.forEach((listener) => listener()));
// Paper is white: a page in dark colours is printed in light ones.
let before;
addEventListener('beforeprint', () => {
  before = document.documentElement.dataset.theme;
  setTheme('light');
});
addEventListener('afterprint', () => {
  if (before) setTheme(before);
  else {
    delete document.documentElement.dataset.theme;
    listeners.forEach((listener) => listener());
  }
});
