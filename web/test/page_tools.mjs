// SPDX-License-Identifier: Apache-2.0
// A headless browser that keeps what a page complains of and whom it asks.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { join } from 'node:path';

export async function launch(web, chromium) {
  const { chromium: browserType } = createRequire(join(web, 'package.json'))('playwright-core');
  return browserType.launch({
    executablePath: chromium, headless: true,
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
      '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--js-flags=--expose-gc', '--enable-precise-memory-info'],
  });
}

/** A page at `address`: {page, complaints, others(): requests to another host}. PALPATE_PAGE: a folder whose script and
 * style are taken instead of those of the program, so that a change is seen without building it. */
export async function open(browser, address, { width = 1920, height = 1080, scheme = 'light', settings = {}, before } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme });
  const page = await context.newPage(), complaints = [], asked = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text())) complaints.push(message.text()); });
  page.on('pageerror', (error) => complaints.push(String(error.stack)));
  page.on('request', (request) => { if (!request.url().startsWith('data:')) asked.push(request.url()); });
  page.on('websocket', (socket) => asked.push(socket.url()));
  await page.addInitScript((kept) => { if (!localStorage.length) localStorage.setItem('palpate.dashboard', JSON.stringify(kept)); }, settings);
  const own = process.env.PALPATE_PAGE;
  if (own) await page.route(/\/dashboard\.(js|css)$/, (route) => route.fulfill({ path: join(own, new URL(route.request().url()).pathname) }));
  if (before) await page.addInitScript(before);
  await page.goto(address);
  await page.waitForSelector('html[data-ready=yes]');
  const host = new URL(address).host;
  return { page, complaints, others: () => asked.filter((url) => new URL(url).host !== host), close: () => context.close() };
}

export const text = (page, id) => page.textContent(`#${id}`);

/** Waits until `read()` fits; says what it was otherwise. */
export async function until(what, read, fits, limit_ms = 3000) {
  const end = Date.now() + limit_ms;
  for (let last; ; await new Promise((resolve) => setTimeout(resolve, 20))) {
    last = await read();
    if (fits(last)) return last;
    assert.ok(Date.now() < end, `${what}: ${JSON.stringify(last)}`);
  }
}
export const word = (page, wanted, limit_ms) => until(`health ${wanted}`, () => text(page, 'health-word'), (said) => said === wanted, limit_ms);

/** Nothing of the page lies outside the screen, and no card hides a part of what it holds. */
export async function fits(page) {
  const wrong = await page.evaluate(() => {
    const { scrollWidth, scrollHeight } = document.documentElement, found = [];
    if (scrollWidth > innerWidth || scrollHeight > innerHeight) found.push(`page ${scrollWidth}x${scrollHeight}`);
    for (const card of document.querySelectorAll('.card, .sensors, #health, header, footer')) {
      const { right, bottom } = card.getBoundingClientRect();
      if (right > innerWidth + 1 || bottom > innerHeight + 1) found.push(`${card.className || card.id} outside`);
      if (card.scrollHeight > card.clientHeight + 2 || card.scrollWidth > card.clientWidth + 2) found.push(`${card.className || card.id}: ${card.scrollWidth}x${card.scrollHeight} in ${card.clientWidth}x${card.clientHeight}`);
    }
    for (const value of document.querySelectorAll('.tile .value, #number, #interval, #health-word, .research'))
      if (value.scrollWidth > value.clientWidth + 1 && getComputedStyle(value).display !== 'inline') found.push(`cut: ${value.textContent}`);
    return found;
  });
  assert.deepEqual(wrong, []);
}

/**
 * From now on the page notes when its health word changes, how old the latest row was then [ms], and by how much a timer of
 * 10 ms was late since that row: that is the machine's, and no page can be faster.
 */
export const watchWord = (page) => page.evaluate(() => {
  const EVERY_MS = 10, place = document.getElementById('health-word'), ticks = [];
  const figures = () => [...document.querySelectorAll('#number, #parts .value')].map((value) => value.textContent).join(' ');
  const lateness = (since_ms, now_ms) => ticks.concat(now_ms).reduce((worst, at, i) => (i > 0 && at > since_ms ? Math.max(worst, at - Math.max(ticks[i - 1], since_ms) - EVERY_MS) : worst), 0);
  clearInterval(window.watch?.timer);
  window.watch?.observer.disconnect();
  window.changes = [];
  const timer = setInterval(() => { if (ticks.push(performance.now()) > 300) ticks.shift(); }, EVERY_MS);
  const observer = new MutationObserver(() => {
    const now_ms = performance.now(), { arrived_ms } = window.palpate.link;
    window.changes.push({ word: place.textContent, figures: figures(), after_ms: now_ms - arrived_ms, late_ms: lateness(arrived_ms, now_ms) });
  });
  observer.observe(place, { childList: true, characterData: true, subtree: true });
  window.watch = { timer, observer };
});

/** A silence is told within 200 ms, each time, on a machine that is itself in time. `rounds`: of `changes`. */
export function inTime(rounds) {
  console.log(`  STALE ${rounds.map(({ after_ms, late_ms }) => `${after_ms.toFixed(0)} (timers late by ${late_ms.toFixed(0)})`).join(', ')} ms after the last row`);
  for (const { after_ms, late_ms } of rounds) assert.ok(after_ms <= 200 + late_ms && after_ms < 1000, `STALE after ${after_ms} ms, timers late by ${late_ms} ms`);
}
