// SPDX-License-Identifier: Apache-2.0
// What the person tells the program: notes and the tare, with what the program answers; and what was said by others.
import { element } from './dom.js';
import { timeOfDay } from './units.js';

const KEPT = 200;
/** The traces show by themselves what these say. */
const QUIET = new Set(['live', 'stale', 'connected', 'disconnected']);
const SILENT = 'no tare: nothing is heard of the catheter now';
const COLOURS = { note: '--accent', tare: '--z', base: '--z', tendon: '--z' };

/** Posts JSON; {ok, body}: an error never throws. */
export async function post(path, body) {
  try {
    const answer = await fetch(path, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
    return { ok: answer.ok, body: await answer.json().catch(() => ({ error: `the program answered ${answer.status}` })) };
  } catch {
    return { ok: false, body: { error: 'no connection to the program' } };
  }
}

/** An event in few words. */
export function eventText({ event, data }) {
  const about = data?.text ?? data?.error ?? '';
  if (event === 'note') return String(about);
  return [event, about].filter(Boolean).join(': ');
}

/**
 * `names()`: {catheter, all: [names]}; `timeOf(server_ms)`: on the traces' clock. Returns {hear(event), marks, focusNote,
 * askTare, setLive, forgetMarks, repaint}.
 */
export function createActions(place, names, timeOf, ink) {
  const marks = [];
  const list = element('ol', { class: 'events', 'aria-label': 'notes and events' }), answer = element('p', { class: 'answer', role: 'status' });
  const input = element('input', { id: 'note', type: 'text', maxlength: 500, placeholder: 'note (n), then Enter', 'aria-label': 'note', autocomplete: 'off', onkeydown: (event) => noteKey(event) });
  const tare = element('button', { type: 'button', id: 'tare', disabled: true, title: 'zero-force tare (t)', onclick: () => askTare() }, 'tare…');
  const question = element('p', {}), go = element('button', { type: 'button', id: 'tare-go', class: 'main', onclick: () => doTare() }, 'tip is free: tare');
  const cancel = element('button', { type: 'button', id: 'tare-cancel', onclick: () => dialog.close() }, 'cancel');
  const dialog = element('dialog', { id: 'tare-dialog', 'aria-label': 'tare' }, element('h2', {}, 'Zero-force tare'), question,
    element('div', { class: 'row' }, element('span', { class: 'grow' }), cancel, go));
  // Space stops the traces and stands between words: who types it did not mean a tare.
  for (const kind of ['keydown', 'keyup']) go.addEventListener(kind, (event) => { if (event.key === ' ') event.preventDefault(); });
  let live = false;
  place.append(element('div', { class: 'row' }, element('h2', {}, 'Notes'), element('span', { class: 'grow' }), tare), input, answer, list);
  document.body.append(dialog);

  const say = (text, bad = false) => {
    answer.textContent = answer.title = text;
    answer.classList.toggle('bad', bad);
  };
  async function noteKey(event) {
    if (event.key === 'Escape') return input.blur();
    const text = input.value.trim();
    if (event.key !== 'Enter' || !text) return;
    const { all, catheter } = names();
    const { ok, body } = await post('/api/notes', all.length > 1 ? { text, catheter } : { text });
    if (ok) input.value = '';
    say(ok ? 'noted' : `not noted: ${body.error}`, !ok);
    if (ok) input.blur();
  }
  function askTare() {
    if (dialog.open) return;
    if (!live) return say(SILENT, true);
    question.textContent = `The latest second of ${names().catheter} is taken as "no force": keep the tip free of contact. Base and precurvature are corrected from it; all forces from then on count from there.`;
    dialog.showModal();
    cancel.focus(); // the yes is to be sought
  }
  async function doTare() {
    dialog.close();
    if (!live) return say(SILENT, true); // it fell silent meanwhile
    const { catheter } = names();
    say('taring …');
    const { ok, body } = await post(`/api/catheters/${encodeURIComponent(catheter)}/tare`, { seconds: 1 });
    const { frames, largest_change_sigmas: change } = body.tare ?? {};
    say(ok ? `tared from ${frames ?? '?'} frames${Number.isFinite(change) ? `, changed by ${change.toFixed(1)} σ` : ''}` : `not tared: ${body.error ?? 'refused'}`, !ok);
  }
  function hear(event) {
    if (event.event === 'stranger refused') return; // of no examination; the foot of the page counts them
    const text = eventText(event), time_s = timeOf(event.server_ms), { all, catheter } = names();
    const about = event.catheter >= 0 && all.length > 1 ? `${all[event.catheter]}: ` : '';
    const name = COLOURS[event.event] ?? '--ink-soft', short = text.length > 40 ? `${text.slice(0, 39)}…` : text;
    if (event.catheter < 0 || all[event.catheter] === catheter) marks.push({ time_s, text: short, name, colour: ink(name), quiet: QUIET.has(event.event) });
    if (marks.length > KEPT) marks.shift();
    list.prepend(element('li', { title: text }, element('time', {}, timeOfDay(event.server_ms / 1000)), ` ${about}${text}`));
    while (list.children.length > 30) list.lastChild.remove();
  }
  return {
    hear, marks, askTare,
    /** Whether frames come: without them there is nothing to tare from. */
    setLive(now) {
      if (now === live) return;
      live = now;
      tare.disabled = !live;
    },
    focusNote: () => input.focus(),
    /** Marks are of the catheter that is looked at. */
    forgetMarks() { marks.length = 0; },
    repaint() { for (const mark of marks) mark.colour = ink(mark.name); },
  };
}
