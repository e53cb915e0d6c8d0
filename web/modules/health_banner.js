// SPDX-License-Identifier: Apache-2.0
// Health in one large word, with a sign whose form differs too, and the reason.
import { createSteady } from './judge.js';

const SIGNS = { live: '●', degraded: '▲', stale: '■', lost: '✕', waiting: '○', hidden: '◆' };

/** Elsewhere there are no frames to speak of. */
const MIXED = new Set(['live', 'degraded', 'hidden']);

export function createHealthBanner(find) {
  const banner = find('health'), sign = find('health-sign'), word = find('health-word'), reason = find('health-reason'), steady = createSteady();
  return {
    /** `mix`: in how many of the latest frames there was no force; `usual`: said where there is nothing to complain of. */
    draw(verdict, now_ms, mix, usual) {
      const held = steady(verdict, now_ms), mixed = MIXED.has(held.kind) ? mix : '', text = [mixed, held.reason].filter(Boolean).join(' · ') || usual;
      if (banner.dataset.kind !== held.kind || !sign.textContent) {
        banner.dataset.kind = held.kind;
        sign.textContent = SIGNS[held.kind];
      }
      if (word.textContent !== held.word) word.textContent = held.word;
      if (reason.textContent !== text) reason.textContent = reason.title = text;
    },
  };
}
