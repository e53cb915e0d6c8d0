// SPDX-License-Identifier: Apache-2.0

/** An element with attributes and children; text is never read as HTML. `class`, `on...` handlers and flags as usual. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

/** A table: `columns` are {title, number}, `rows` arrays of texts or nodes. */
export function table(caption, columns, rows) {
  const cell = (tag, column, content) =>
    element(tag, { class: column.number ? 'number' : null, scope: tag === 'th' ? 'col' : null }, content);
  return element(
    'table',
    {},
    caption ? element('caption', {}, caption) : null,
    element('thead', {}, element('tr', {}, columns.map((column) => cell('th', column, column.title)))),
    element('tbody', {}, rows.map((row) => element('tr', {}, row.map((text, i) => cell('td', columns[i], text))))),
  );
}

/** A row of buttons of which one is pressed. `choices`: {key: {label, title}}. */
export function choice(label, choices, pressed, onChoose) {
  const buttons = Object.entries(choices).map(([key, { label: text, title }]) =>
    element('button', { type: 'button', 'data-key': key, title, 'aria-pressed': String(key === pressed), onclick: () => choose(key) }, text));
  const choose = (key) => {
    for (const button of buttons) button.setAttribute('aria-pressed', String(button.dataset.key === key));
    onChoose(key);
  };
  return element('div', { class: 'choice', role: 'group', 'aria-label': label }, buttons);
}
