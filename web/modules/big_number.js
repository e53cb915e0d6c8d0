// SPDX-License-Identifier: Apache-2.0
// The number to be read across the room: |F|, its interval, and where it lies among the bands.
import { bandNames, bandOf, shadeOf, tickText } from './band_names.js';
import { element } from './dom.js';
import { Z_95 } from './force_curves.js';
import { UNITS, fixed } from './units.js';

/** Digits of the large number: no more than its sigma can mean. */
export const DIGITS = { g: 1, mN: 0, N: 3 };
export const numberText = (value_N, unit) => fixed(value_N * unit.perNewton, DIGITS[unit.name]);

/** '95 %: 10.9 – 13.8 g'; a size is never negative. */
export function intervalText(value_N, sigma_N, unit) {
  if (!(sigma_N >= 0)) return '95 %: not known';
  const low = Math.max(0, value_N - Z_95 * sigma_N);
  return `95 %: ${numberText(low, unit)} – ${numberText(value_N + Z_95 * sigma_N, unit)} ${unit.name}`;
}

const put = (place, text) => { if (place.textContent !== text) place.textContent = text; };

/** Returns {draw(verdict, row), setBands(edges_g), setUnit(unit), drawn: what stands on the page}. */
export function createBigNumber(find) {
  const number = find('number'), unitPlace = find('number-unit'), word = find('number-word'), interval = find('interval'), band = find('band'), scale = find('scale'), card = find('force');
  const marker = element('div', { class: 'marker' }), reach = element('div', { class: 'reach' }), bar = element('div', { class: 'scale-bar' }), ticks = element('div', { class: 'ticks' });
  scale.append(element('div', { class: 'pointer' }, reach, marker), bar, ticks);
  let unit = UNITS.g, edges_g = [5, 10, 30, 40], names = [], top_g = 50, width = scale.clientWidth, inBand = null;
  let said = { word: '', reason: '' };
  const drawn = { size_N: NaN, sigma_N: NaN, time_s: NaN, shown: false };
  new ResizeObserver(() => { width = scale.clientWidth; }).observe(scale);

  function layOut() {
    names = bandNames(edges_g, unit);
    top_g = 1.25 * edges_g[edges_g.length - 1];
    const ends = [0, ...edges_g, top_g];
    bar.replaceChildren(...names.map((name, i) => {
      const part = element('div', { class: 'part', title: name });
      part.style.flexGrow = String(ends[i + 1] - ends[i]);
      part.style.background = `var(--band-${shadeOf(i, names.length)})`;
      return part;
    }));
    ticks.replaceChildren(...[0, ...edges_g].map((edge) => {
      const tick = element('span', {}, tickText(edge, unit));
      tick.style.left = `${(100 * edge) / top_g}%`;
      return tick;
    }));
    put(unitPlace, unit.name);
    inBand = null;
  }
  function sayBand(i) {
    if (i === inBand) return;
    inBand = i;
    band.dataset.band = i < 0 ? 'none' : String(shadeOf(i, names.length));
    put(band, i < 0 ? 'no force shown' : names[i]);
  }
  const place = (force_N) => (Math.min(Math.max(force_N * UNITS.g.perNewton, 0), top_g) / top_g) * width;
  function draw(verdict, row) {
    const shown = verdict.shown;
    said = verdict;
    drawn.shown = shown;
    drawn.size_N = shown ? row.get('size_N') : NaN;
    drawn.sigma_N = shown ? row.get('sigma_size_N') : NaN;
    drawn.time_s = row ? row.get('time_s') : NaN;
    write();
  }
  /** What is drawn, in the unit of now. */
  function write() {
    const { shown } = drawn;
    card.classList.toggle('blank', !shown);
    marker.hidden = reach.hidden = !shown;
    const text = shown ? numberText(drawn.size_N, unit) : '–';
    put(number, text);
    if (card.dataset.digits !== String(text.length)) card.dataset.digits = String(text.length);
    put(word, shown ? '' : said.word);
    put(interval, shown ? intervalText(drawn.size_N, drawn.sigma_N, unit) : said.reason.split(' · ')[0]);
    sayBand(shown ? bandOf(drawn.size_N, edges_g) : -1);
    if (!shown) return;
    marker.style.transform = `translateX(${place(drawn.size_N).toFixed(1)}px)`;
    const low = place(drawn.size_N - Z_95 * drawn.sigma_N), high = place(drawn.size_N + Z_95 * drawn.sigma_N);
    reach.hidden = !(high >= low);
    if (!reach.hidden) reach.style.transform = `translateX(${low.toFixed(1)}px) scaleX(${Math.max(1, high - low).toFixed(1)})`;
  }
  layOut();
  return {
    draw, drawn,
    setBands(edges) { edges_g = edges; layOut(); write(); },
    /** At once: digits of one unit never stand beside the name of another. */
    setUnit(next) { unit = next; layOut(); write(); },
  };
}
