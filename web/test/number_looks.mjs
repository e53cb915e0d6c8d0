// SPDX-License-Identifier: Apache-2.0
// The number as a person sees it go by: whether digits, unit, band and colour are those of the row, whatever is pressed.
import assert from 'node:assert/strict';
import { until } from './page_tools.mjs';
import { sleep } from './played.mjs';

/** Every number that stands on the page, with its band and the row it is of, for some seconds. */
export const look = (page, seconds) => page.evaluate((ms) => new Promise((resolve) => {
  const seen = [], begin = performance.now(), [place, unit, band] = ['number', 'number-unit', 'band'].map((id) => document.getElementById(id));
  const frame = () => {
    const { drawn, link } = window.palpate;
    if (drawn.shown && drawn.time_s !== seen[seen.length - 1]?.time_s && link.row.get('time_s') === drawn.time_s)
      seen.push({ ...drawn, text: place.textContent, unit: unit.textContent, band: band.textContent, colour: getComputedStyle(band).backgroundColor, truth_N: link.row.get('truth_size_N') });
    if (performance.now() - begin < ms) requestAnimationFrame(frame);
    else resolve(seen);
  };
  requestAnimationFrame(frame);
}), seconds * 1000);

const BANDS = { g: ['< 5 g', '5–10 g', '10–30 g', '30–40 g', '≥ 40 g'], mN: ['< 49 mN', '49–98 mN', '98–294 mN', '294–392 mN', '≥ 392 mN'] }, DIGITS = { g: 1, mN: 0 };
export const coloursOf = (page) => page.evaluate(() => [0, 1, 2, 3, 4].map((i) => {
  const probe = document.createElement('div');
  probe.style.background = `var(--band-${i})`;
  document.body.append(probe);
  const colour = getComputedStyle(probe).backgroundColor;
  probe.remove();
  return colour;
}));
/** Number, unit, band and colour are those of the row, at every look. Returns the bands that came by. */
export function belong(rows, unit, colours) {
  const wrong = rows.filter(({ size_N, ...page }) => {
    const grams = size_N / 9.80665e-3, band = [5, 10, 30, 40].filter((edge) => grams >= edge).length;
    const wanted = { text: (unit === 'g' ? grams : 1000 * size_N).toFixed(DIGITS[unit]), unit, band: BANDS[unit][band], colour: colours[band] };
    return Object.entries(wanted).some(([key, value]) => page[key] !== value);
  });
  assert.deepEqual(wrong, []);
  return new Set(rows.map(({ band }) => band));
}

/** What a person does with the traces and the unit while the force goes on. */
export async function handle(page, colours) {
  const view = () => page.evaluate(() => ({ ...window.palpate.traces })), picture = () => page.evaluate(() => document.querySelector('#trace-size canvas').toDataURL());
  await page.keyboard.press(' ');
  await sleep(600);
  const paused = await view(), still = await picture(), went = await look(page, 1);
  assert.equal(paused.follows, false);
  assert.ok((await picture()) === still, 'a paused trace stands');
  assert.ok(new Set(went.map(({ text: said }) => said)).size > 3, 'the number goes on');
  await page.keyboard.press('ArrowLeft');
  assert.ok(Math.abs(paused.to_s - (await view()).to_s - 1) < 1e-6, 'a tenth of the window');
  await until('the past', picture, (now) => now !== still);
  await page.keyboard.press('l');
  assert.equal((await view()).follows, true);
  await page.keyboard.press('u');
  belong(await look(page, 2), 'mN', colours);
  for (const key of 'uu') await page.keyboard.press(key);
  belong(await look(page, 0.5), 'g', colours);
}
