// SPDX-License-Identifier: Apache-2.0
// What the page costs and how late it is, measured by the page.
import { createRate, createSamples } from './samples.js';
import { fixed } from './units.js';
import { element } from './dom.js';

const WINDOW_MS = 30_000;
const ms = (value) => (Number.isFinite(value) ? `${fixed(value, value < 10 ? 1 : 0)} ms` : '–');

/** Returns {late(now_ms, ms), script(now_ms, ms), hear(event), figures(now_ms, latest_ms), draw(now_ms, link)}. */
export function createPageFooter(place) {
  const latency = createSamples(2048, WINDOW_MS), script = createSamples(2048, WINDOW_MS), rate = createRate();
  const item = (label, title) => {
    const value = element('span', { class: 'value' }, '–');
    place.append(element('span', { title }, `${label} `, value));
    return (text) => { if (value.textContent !== text) value.textContent = text; };
  };
  const late = item('socket to page', 'from the frame at the host to the number on the page, latest 30 s'), rows = item('rows', 'that came, a second');
  const program = item('program', 'from the frame at the host to the estimate handed on: half of the frames, 99 % of them'), cost = item('script', "the page's own time a frame: half of them, 95 %");
  const strangers = element('span', { hidden: true });
  let refused = 0;
  const version = item('palpate', 'version of the program');
  place.append(strangers);
  const summary = (samples, now_ms, latest_ms) => ({ count: samples.sort(now_ms, latest_ms), p50: samples.percentile(0.5), p95: samples.percentile(0.95), most: samples.percentile(1) });
  return {
    late(now_ms, value) { if (Number.isFinite(value)) latency.add(now_ms, value); },
    script: (now_ms, value) => script.add(now_ms, value),
    /** Who asked without the token is refused; that happens by an old page too, and is no event of the examination. */
    hear({ event, data }) {
      if (event !== 'stranger refused') return;
      refused += Number.isFinite(data?.count) ? data.count : 1;
      strangers.hidden = false;
      strangers.textContent = `${refused} ${refused === 1 ? 'stranger' : 'strangers'} refused`;
      strangers.title = `asked for this program without its token, since this page was opened; the latest: ${data?.text ?? ''}`;
    },
    figures: (now_ms, latest_ms) => ({ latency_ms: summary(latency, now_ms, latest_ms), script_ms: summary(script, now_ms, latest_ms) }),
    draw(now_ms, link) {
      const { p50, p95 } = summary(latency, now_ms), of = summary(script, now_ms), said = link.status?.latency;
      late(`p50 ${ms(p50)}, p95 ${ms(p95)}`);
      const a_second = rate.tell(now_ms, link.rows);
      rows(Number.isFinite(a_second) ? `${fixed(a_second, 0)}/s` : '–');
      program(said ? `p50 ${ms(1000 * said.p50_s)}, p99 ${ms(1000 * said.p99_s)}` : '–');
      cost(`p50 ${ms(of.p50)}, p95 ${ms(of.p95)}`);
      version(link.hello?.version ?? '–');
    },
  };
}
