// SPDX-License-Identifier: Apache-2.0
// Sensors, recording and the state of every catheter, as the program's status tells them.
import { element } from './dom.js';
import { createRate } from './samples.js';
import { fixed } from './units.js';

const SIGNS = { LIVE: '●', DEGRADED: '▲', STALE: '■', WAITING: '○' };
const put = (place, text) => { if (place.textContent !== text) place.textContent = text; };

/** Returns {setCatheter({sensors}), draw(status of the catheter, now_ms, heard, stale)}; the rate is that of usable
 * readings. What was usable in the latest frame is silent where there are no frames. */
export function createSensorsPanel(place) {
  let lines = {};
  return {
    setCatheter({ sensors }) {
      lines = Object.fromEntries(sensors.map((name) => {
        const sign = element('span', { class: 'sign', 'aria-hidden': 'true' }), state = element('span', { class: 'now' }, '–'), rate = element('span', { class: 'rate' });
        return [name, { box: element('div', { class: 'sensor' }, sign, element('b', { title: name }, name), state, rate), sign, state, rate, counter: createRate() }];
      }));
      place.classList.toggle('many', sensors.length > 4);
      place.replaceChildren(element('h2', {}, 'Sensors'), element('div', { class: 'sensors' }, Object.values(lines).map(({ box }) => box)));
    },
    draw(said, now_ms, heard, stale) {
      for (const [name, line] of Object.entries(lines)) {
        const latest = heard ? said?.sensors_now?.[name] : undefined, now = stale && latest === 'usable' ? 'silent' : latest, usable = now === 'usable';
        put(line.sign, usable ? '●' : '◆');
        put(line.state, now ?? '–');
        line.box.classList.toggle('bad', !usable);
        const rate = heard && said?.sensors?.[name] ? line.counter.tell(now_ms, said.sensors[name].usable ?? 0) : NaN;
        put(line.rate, Number.isFinite(rate) && now !== 'silent' ? `${fixed(rate, rate < 10 ? 1 : 0)} Hz` : '');
      }
    },
  };
}

/** Where the frames are kept; a failure cannot be missed. */
export function createRecordingPanel(place) {
  const sign = element('span', { class: 'sign', 'aria-hidden': 'true' }), word = element('b', {}), note = element('span', { class: 'soft path' });
  place.append(element('h2', {}, 'Recording'), element('div', { class: 'recording' }, sign, word, note));
  return {
    draw(recording, heard) {
      const failing = heard && recording && (recording.failing || recording.dropped > 0);
      place.classList.toggle('failing', Boolean(failing));
      place.classList.toggle('on', Boolean(heard && recording && !failing));
      put(sign, !heard || !recording ? '○' : failing ? '✕' : '●');
      put(word, !heard ? '–' : !recording ? 'not recorded' : recording.failing ? 'FAILING' : recording.dropped > 0 ? `${recording.dropped} lost` : `${recording.committed_frames} frames`);
      const path = recording ? String(recording.path) : '';
      put(note, heard && recording ? [recording.failing ? recording.error : '', path.split('/').pop()].filter(Boolean).join(' · ') : '');
      note.title = path;
    },
  };
}

/** Buttons, one a catheter, each with its state; keys 1 to 9. */
export function createCatheterSelector(place, onChoose) {
  let buttons = [];
  return {
    set(catheters) {
      buttons = catheters.map(({ name }, i) => {
        const state = element('span', { class: 'state' });
        const button = element('button', { type: 'button', 'data-key': name, title: `${name} (${i + 1})`, onclick: () => onChoose(i) }, name, state);
        return { button, state };
      });
      place.replaceChildren(...buttons.map(({ button }) => button));
    },
    /** `stale`: what the page itself found of the one that is watched. */
    draw(said, watched, heard, stale) {
      buttons.forEach(({ button, state }, i) => {
        const word = !heard ? undefined : stale && i === watched ? 'STALE' : said?.[i]?.state;
        button.setAttribute('aria-pressed', String(i === watched));
        button.dataset.state = word ?? '';
        put(state, word ? ` ${SIGNS[word] ?? ''} ${word}` : '');
      });
    },
  };
}
