// SPDX-License-Identifier: Apache-2.0
// What the page says where it cannot know the force of now: silence, a slow connection, frames without a force.
import assert from 'node:assert/strict';
import { hello, startMock } from './mock_server.mjs';
import { fits, inTime, open, text, until, watchWord, word } from './page_tools.mjs';
import { alive, calm, demo, play, sleep } from './played.mjs';

const EIGHT = ['tip', ...Array.from({ length: 7 }, (_, i) => `shaft_${i + 1}`)];

/** Never an old number: by the program's word, and by the page's own judgement. */
async function silence(browser, web) {
  const mock = await startMock(web, { greeting: () => hello({ catheters: [demo, { ...demo, name: 'second', sensors: EIGHT, simulated: false, wall_normal: null }] }) }), seen = await open(browser, mock.address), { page } = seen;
  let stop = () => {};
  const rounds = [];
  for (let round = 0; round < 5; ++round) {
    stop();
    stop = play(mock);
    await word(page, 'LIVE');
    await sleep(300);
    await word(page, 'LIVE'); // a busy machine may have been silent meanwhile
    await watchWord(page);
    stop();
    stop = alive(mock);
    await word(page, 'STALE');
    await sleep(50);
    const stale = (await page.evaluate(() => window.changes)).findLast(({ word: said }) => said === 'STALE');
    assert.equal(stale.figures, '– – – –');
    assert.equal(await text(page, 'number-word'), 'STALE');
    rounds.push(stale);
  }
  inTime(rounds);
  assert.equal(await page.isVisible('.marker'), false);
  // A row of silence that still says contact.
  mock.row({ state: 3, status: 6, shown: 0, size_N: NaN, contact: 1, stale_after_s: 9 });
  await until('the row', () => page.evaluate(() => window.palpate.link.row.get('state')), (state) => state === 3);
  await sleep(200);
  assert.match(await text(page, 'figures'), /^contact–/, 'no contact that is not of now');
  await until('there is nothing to tare from', () => page.isDisabled('#tare'), Boolean);
  await page.keyboard.press('t');
  assert.equal(await page.isVisible('#tare-dialog'), false);
  assert.match(await text(page, 'notes'), /no tare: nothing is heard/);

  for (const [fields, said] of [[{ status: 2 }, 'AMBIGUOUS'], [{ status: 4 }, 'NOT MEASURED'], [{ state: 3 }, 'STALE'], [{ state: 0 }, 'WAITING']]) {
    mock.row({ size_N: 0.1, stale_after_s: 9 });
    await until('a number', () => text(page, 'number'), (number) => number === '10.2');
    mock.row({ ...fields, shown: 0, size_N: NaN, stale_after_s: 9 });
    await until(said, () => text(page, 'number-word'), (reason) => reason === said);
    assert.equal(await text(page, 'number'), '–');
    await word(page, said);
  }
  mock.row({ state: 2, stale_after_s: 9, axial_hidden: 1 });
  await word(page, 'DEGRADED');
  await until('axial', () => text(page, 'parts'), (said) => said.includes('axial not observable'));
  assert.match(await text(page, 'number'), /^\d+\.\d$/);

  // Another catheter: its rows alone, and its name in what is done.
  await page.keyboard.press('2');
  await until('watch', () => mock.heard.filter(({ watch }) => watch !== undefined).length, (n) => n === 1);
  await word(page, 'WAITING');
  mock.row({ size_N: 0.3, stale_after_s: 9 }, 0);
  mock.row({ size_N: 0.2, stale_after_s: 9 }, 1);
  await until('the second', () => text(page, 'number'), (number) => number === '20.4');
  assert.equal(await page.evaluate(() => window.palpate.store.length), 1);
  assert.equal(await page.locator('.sensor').count(), 8);
  await fits(page);
  calm(seen);

  // The program gone, back, silent, and started anew.
  stop();
  for (const client of mock.clients) client.drop();
  await word(page, 'NO CONNECTION');
  await until('connected again', () => mock.clients.size, (n) => n === 1);
  await until('the second again', () => mock.heard.filter(({ watch }) => watch === 1).length, (n) => n === 2);
  stop = alive(mock);
  mock.row({ size_N: 0.2, stale_after_s: 9 }, 1);
  await word(page, 'LIVE');
  stop();
  mock.mute = true;
  await word(page, 'NO CONNECTION');
  assert.equal(await text(page, 'number'), '–');
  mock.mute = false;
  mock.refuse = true;
  for (const client of mock.clients) client.drop();
  await until('refused', () => text(page, 'health-reason'), (said) => /started anew: open the address that it printed/.test(said), 6000);
  const { refused } = mock;
  await sleep(5000);
  assert.ok(mock.refused <= refused + 2, `a page that was refused asks rarely: ${mock.refused - refused} times in 5 s`);
  mock.refuse = false;
  stop = alive(mock);
  await page.reload();
  await word(page, 'WAITING', 6000);
  assert.deepEqual(seen.complaints.filter((said) => !/WebSocket connection|401/.test(said)), []);
  await seen.close();
  stop();
  mock.close();
}

/** A connection that lags: rows that were long on their way are not of now, whether it lagged from its beginning or not. */
async function lag(browser, web) {
  const mock = await startMock(web);
  mock.lag_ms = 1500;
  const seen = await open(browser, mock.address), { page } = seen, stop = play(mock);
  const numbers = () => page.evaluate(() => new Promise((resolve) => {
    const begin = performance.now(), said = new Set();
    const frame = () => {
      said.add(document.getElementById('number').textContent);
      if (performance.now() - begin < 2500) requestAnimationFrame(frame);
      else resolve([...said]);
    };
    frame();
  }));
  await until('rows', () => page.evaluate(() => window.palpate.link.rows), (n) => n > 0, 6000);
  assert.deepEqual(await numbers(), ['–'], 'not even before the clocks are known');
  await until('too slow', () => text(page, 'health-reason'), (said) => /connection is too slow to tell/.test(said), 6000);
  assert.equal(await text(page, 'health-word'), 'STALE');
  mock.lag_ms = 0;
  await until('a number', () => text(page, 'number'), (said) => said !== '–', 6000);

  // Slower and slower, so that it is never silent; answered so often that a memory of the latest answers holds late ones only.
  mock.answers = 40;
  for (; mock.lag_ms < 1500; mock.lag_ms += 15) await sleep(30);
  await sleep(4500);
  assert.equal(await page.evaluate(() => window.palpate.link.connections), 1);
  assert.deepEqual(await numbers(), ['–'], 'a force of 1.5 s ago is none of now');
  assert.equal(await text(page, 'health-word'), 'STALE');
  calm(seen);
  await seen.close();
  stop();
  mock.close();
}

/** Frames with and without a force in turn: the words tell of both, the number is that of the former. */
async function mixed(browser, web) {
  const mock = await startMock(web), seen = await open(browser, mock.address), { page } = seen, stop = alive(mock);
  await until('a client', () => mock.clients.size, (n) => n === 1);
  for (const [hiddenOf5, said, share] of [[1, 'LIVE', /^AMBIGUOUS in (1|2)\d % of the latest second/], [4, 'AMBIGUOUS', /^AMBIGUOUS in (7|8)\d % of the latest second · another force fits as well/]]) {
    let i = 0;
    const rows = setInterval(() => mock.row(i++ % 5 < hiddenOf5 ? { status: 2, shown: 0, size_N: NaN, stale_after_s: 1 } : { size_N: 0.1, stale_after_s: 1 }), 25);
    await sleep(1500);
    const { words, numbers, reasons } = await page.evaluate(() => new Promise((resolve) => {
      const begin = performance.now(), words = new Set(), numbers = new Set(), reasons = new Set();
      const frame = () => {
        for (const [set, id] of [[words, 'health-word'], [numbers, 'number'], [reasons, 'health-reason']]) set.add(document.getElementById(id).textContent);
        if (performance.now() - begin < 2000) requestAnimationFrame(frame);
        else resolve({ words: [...words], numbers: [...numbers], reasons: [...reasons] });
      };
      frame();
    }));
    clearInterval(rows);
    assert.deepEqual(words, [said]);
    assert.deepEqual(numbers.sort(), ['10.2', '–'].sort());
    assert.deepEqual(reasons.filter((reason) => !share.test(reason)), []);
  }
  // A frame that was old when it came.
  mock.row({ shown: 0, size_N: NaN, stale_after_s: 9 });
  await word(page, 'STALE');
  assert.equal(await text(page, 'health-reason'), 'the latest frame came late');
  calm(seen);
  await seen.close();
  stop();
  mock.close();
}

export const DOUBT_PARTS = { silence, lag, mixed };
