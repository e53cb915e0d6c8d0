// SPDX-License-Identifier: Apache-2.0
// What all plots over time have in common.
import { colour } from './theme.js';

/** Steps between the marks of a time axis [s]. */
export const SECONDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];

export const axisInk = (font = '12px system-ui, sans-serif') =>
  ({ stroke: colour('--ink-soft'), grid: { stroke: colour('--grid'), width: 1 }, ticks: { stroke: colour('--grid') }, font, labelFont: font });
