// SPDX-License-Identifier: Apache-2.0
// Keys, and the page's own list of them.
import { element } from './dom.js';

/** `keys`: [{keys: ['t'], shown, does, act(event)}]. A key that a field, a dialog or the focused thing needs stays theirs. */
export function createKeyboard(keys) {
  const rows = keys.filter(({ does }) => does).map(({ shown, does }) => element('div', {}, element('kbd', {}, shown), element('span', {}, does)));
  const dialog = element('dialog', { id: 'help', 'aria-label': 'keys' }, element('h2', {}, 'Keys'), element('div', { class: 'keys' }, rows),
    element('p', { class: 'soft' }, 'With the shape in focus, arrows turn it, + and − zoom, 0 resets. Traces: drag to scroll back, wheel to zoom.'),
    element('div', { class: 'row' }, element('span', { class: 'grow' }), element('button', { type: 'button', onclick: () => dialog.close() }, 'close')));
  document.body.append(dialog);
  const help = () => (dialog.open ? dialog.close() : dialog.showModal());

  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.target.closest?.('input, textarea, select')) return;
    if (event.key === '?') return help();
    if (document.querySelector('dialog[open]')) return;
    if ((event.key === ' ' || event.key === 'Enter') && event.target.closest?.('button')) return;
    const found = keys.find((entry) => entry.keys.includes(event.key));
    if (!found) return;
    event.preventDefault();
    found.act(event);
  });
  // A button that was clicked does not keep the keyboard: space means pause again.
  addEventListener('click', (event) => { if (event.detail > 0) event.target.closest?.('button')?.blur(); });
  return { help };
}
