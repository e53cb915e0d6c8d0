// SPDX-License-Identifier: Apache-2.0
// The page before a program that says what the test wants: limits of the bands, and what a person does.
import assert from 'node:assert/strict';
import { hello, startMock } from './mock_server.mjs';
import { open, text, until, word } from './page_tools.mjs';
import { GRAM, alive, calm, history, play, sleep } from './played.mjs';

/** Colour, words and marker at each limit; a row stands for itself alone. */
async function bands(browser, web) {
  const mock = await startMock(web), stop = alive(mock), seen = await open(browser, mock.address), { page } = seen;
  await until('a client', () => mock.clients.size, (n) => n === 1);
  const colours = new Set(), places = [];
  for (const [g, band, name] of [[4.9, 0, '< 5 g'], [5.1, 1, '5–10 g'], [9.9, 1, '5–10 g'], [10.1, 2, '10–30 g'], [29.9, 2, '10–30 g'], [30.1, 3, '30–40 g'], [39.9, 3, '30–40 g'], [40.1, 4, '≥ 40 g']]) {
    mock.row({ size_N: g * GRAM, sigma_size_N: GRAM / 1.959964, stale_after_s: 9 });
    await until(`${g} g`, () => text(page, 'number'), (said) => said === g.toFixed(1));
    assert.equal(await text(page, 'band'), name);
    const [background, wanted, marker] = await page.evaluate((i) => {
      const probe = document.createElement('div');
      probe.style.background = `var(--band-${i})`;
      document.body.append(probe);
      const is = getComputedStyle(probe).backgroundColor;
      probe.remove();
      return [getComputedStyle(document.getElementById('band')).backgroundColor, is, document.querySelector('.marker').getBoundingClientRect().x];
    }, band);
    assert.equal(background, wanted);
    colours.add(background);
    places.push(marker);
    assert.equal(await text(page, 'interval'), `95 %: ${(g - 1).toFixed(1)} – ${(g + 1).toFixed(1)} g`);
  }
  assert.equal(colours.size, 5);
  assert.ok(places.every((x, i) => i === 0 || x > places[i - 1]), 'the marker moves on the scale');

  // Units, by button and by key; other bands.
  const stands = () => page.evaluate(() => ['number', 'number-unit', 'band'].map((id) => document.getElementById(id).textContent).join(' '));
  await page.click('#tools button[data-key=N]');
  await until('newtons', stands, (said) => said === '0.393 N ≥ 0.392 N');
  await page.keyboard.press('u');
  await until('grams', stands, (said) => said === '40.1 g ≥ 40 g');
  await page.keyboard.press('u');
  await until('millinewtons', stands, (said) => said === '393 mN ≥ 392 mN');
  const atOnce = await page.evaluate(() => {
    document.querySelector('#tools button[data-key=g]').click();
    const said = document.querySelector('.figure .value').textContent;
    document.querySelector('#tools button[data-key=mN]').click();
    return [said, document.querySelector('.figure .value').textContent];
  });
  assert.deepEqual(atOnce, ['40.1g', '393mN'], 'before the next frame, which may be late');
  await page.reload();
  await until('the unit is kept', () => text(page, 'number-unit'), (said) => said === 'mN');
  calm(seen);
  await seen.close();
  stop();
  mock.close();
}

/** The question of the tare, by key; where the machine was busy for a second the page had nothing to tare from. */
const ask = (page) => until('the question', async () => {
  if (!(await page.isVisible('#tare-dialog'))) await page.keyboard.press('t');
  return page.evaluate(() => [document.getElementById('tare-dialog').open, document.activeElement.id, document.querySelector('.answer').textContent]);
}, ([open, id]) => open && id === 'tare-cancel');

/** What one types without looking where it goes tares nothing. */
async function noAccident(page, mock) {
  const open = () => page.isVisible('#tare-dialog'), calls = mock.calls.length;
  await ask(page);
  assert.match(await text(page, 'tare-dialog'), /keep the tip free of contact/);
  await page.keyboard.press('Escape');
  for (const key of ['Enter', ' ']) {
    await ask(page);
    await page.keyboard.press(key);
    assert.ok(!(await open()), 'the no is in focus');
  }
  await page.keyboard.type('tip free');
  await page.keyboard.press('Escape');
  await ask(page);
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'tare-go');
  await page.keyboard.press(' ');
  assert.ok(await open());
  await page.keyboard.press('Escape');
  await sleep(200);
  assert.equal(mock.calls.length, calls, 'not without a yes');
}

/** Traces that stop, go back and return; notes, tare, keys. */
async function handling(browser, web) {
  const refusal = 'tare: the catheter file is sure of base and precurvature';
  const mock = await startMock(web, { answer: (path) => (path.endsWith('/tare') ? [409, { error: refusal }] : [200, { note: 'x' }]) });
  mock.onClient = (client) => client.send(history(120, 0.1));
  const seen = await open(browser, mock.address), { page } = seen, stop = play(mock);
  await word(page, 'LIVE');
  const view = () => page.evaluate(() => ({ ...window.palpate.traces, shown: document.getElementById('trace-note').textContent }));
  const picture = () => page.evaluate(() => document.querySelector('#trace-size canvas').toDataURL());
  await page.keyboard.press(' ');
  await sleep(600); // the latest rows before it are on their way
  const paused = await view(), still = await picture();
  assert.equal(paused.follows, false);
  await sleep(300);
  assert.equal((await view()).to_s, paused.to_s);
  assert.ok((await picture()) === still, 'a paused trace stands');
  await until('the number goes on', () => text(page, 'number'), (said) => said !== '–');
  await page.keyboard.press('ArrowLeft');
  assert.ok(Math.abs(paused.to_s - (await view()).to_s - 3) < 1e-6, 'a tenth of the window');
  const box = await page.locator('#trace-size').boundingBox();
  await page.mouse.move(box.x + 400, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 400 + box.width / 2, box.y + 100, { steps: 4 });
  await page.mouse.up();
  await until('dragged back by half a window', view, ({ to_s }) => Math.abs(paused.to_s - to_s - 18) < 0.2);
  assert.ok((await picture()) !== still);
  await page.mouse.move(box.x + 500, box.y + 90, { steps: 2 });
  await page.mouse.wheel(0, 200);
  await until('zoomed', view, ({ span_s }) => span_s > 37 && span_s < 38);
  await until('told what stood there', view, ({ shown }) => /\|F\| \d+\.\d ± \d/.test(shown));
  await page.mouse.move(5, 5);
  await page.keyboard.press('l');
  assert.equal((await view()).follows, true);
  await page.click('#trace-tools button[data-key="600"]');
  assert.equal((await view()).span_s, 600);

  await page.keyboard.press('n');
  await page.keyboard.type('touch 2');
  await page.keyboard.press('Enter');
  await until('the note', () => mock.calls.length, (n) => n === 1);
  assert.deepEqual(mock.calls[0], ['/api/notes', { text: 'touch 2' }]);
  mock.send({ type: 'event', catheter: -1, event: 'note', data: { text: 'touch <b>2</b>' }, server_ms: Date.now() });
  mock.send({ type: 'event', catheter: 0, event: 'live', data: null, server_ms: Date.now() });
  await until('in the list', () => text(page, 'notes'), (said) => said.includes('touch <b>2</b>'));
  const marks = () => page.evaluate(() => window.palpate.marks.length), before = await marks();
  for (const count of [1, 2]) mock.send({ type: 'event', catheter: -1, event: 'stranger refused', data: { text: 'GET / without token', count }, server_ms: Date.now() });
  await until('a count', () => text(page, 'footer'), (said) => said.includes('3 strangers refused'));
  assert.doesNotMatch(await text(page, 'notes'), /stranger/);
  assert.equal(await marks(), before, 'nor is it marked in the traces');
  await until('the field is left', () => page.evaluate(() => document.activeElement === document.body), Boolean);
  await noAccident(page, mock);
  await page.click('#tare');
  await page.click('#tare-go');
  await until('the refusal', () => text(page, 'notes'), (said) => said.includes(refusal));
  assert.deepEqual(mock.calls[1], ['/api/catheters/demo/tare', { seconds: 1 }]);
  await ask(page);
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await until('a tare by keys', () => mock.calls.length, (n) => n === 3);

  await page.keyboard.press('i');
  await until('the integral counts anew', () => text(page, 'figures'), (said) => /∫ since \d\d:\d\d:\d\d.*0 g s/.test(said));
  mock.send({ type: 'event', catheter: 0, event: 'tare', data: {}, server_ms: Date.now() });
  await until('another zero', () => text(page, 'figures'), (said) => /∫ since contact.* · tared within.*∫ since tare \d\d:\d\d:\d\d.*0 g s/.test(said));
  await page.keyboard.press('?');
  assert.equal(await page.isVisible('#help'), true);
  await page.keyboard.press('Escape');
  await page.focus('#shape canvas');
  await page.keyboard.press('ArrowLeft');
  assert.equal((await view()).follows, true, 'with the shape in focus arrows turn it');
  assert.equal(await page.getAttribute('#health-word', 'aria-live'), 'assertive');
  assert.equal(await page.getAttribute('#number', 'aria-live'), 'off');
  seen.complaints.splice(0, 2, ...seen.complaints.slice(0, 2).filter((said) => !said.includes('409'))); // the browser's own word on the refusals
  assert.match(await page.textContent('header'), /Research use only – not for clinical decisions/);
  calm(seen);
  await seen.close();

  const flat = await open(browser, mock.address, { before: () => { const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return kind.startsWith('webgl') ? null : get.call(this, kind, ...more); }; } });
  await word(flat.page, 'LIVE');
  assert.match(await text(flat.page, 'shape'), /needs a browser with WebGL/);
  calm(flat);
  await flat.close();
  stop();
  mock.close();
}

export const MOCK_PARTS = { bands, handling };
