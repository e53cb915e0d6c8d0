// SPDX-License-Identifier: Apache-2.0
// node report_page.mjs PALPATE DEMO WEB_FOLDER CHROMIUM ARTIFACTS: makes a ten-minute recording and its report, opens the
// report in a headless browser from its file, and looks at it as a reader would.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [palpate, demo, web, chromium, artifacts] = process.argv.slice(2);
const { chromium: browserType } = createRequire(join(web, 'package.json'))('playwright-core');

const folder = mkdtempSync(join(tmpdir(), 'palpate-report-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
mkdirSync(artifacts, { recursive: true });
const file = (name) => join(folder, name);

// --------------------------------------------------------------------------------------- the report, and what it is of
execFileSync(demo, [folder, '600']);
const recording = [file('demo.tracker.csv'), '--catheter', file('demo.catheter.toml')];
execFileSync(palpate, ['estimate', ...recording, '--out', file('demo.estimate.csv')]);
const title = 'Ten minutes </script><img src=x onerror="boom()"> & more';
const page_file = file('report.html');
const summary = JSON.parse(execFileSync(palpate, ['report', ...recording, '--estimate', file('demo.estimate.csv'),
  '--truth', file('demo.force.csv'), '--title', title, '--out', page_file, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }));

const csv = readFileSync(file('demo.estimate.csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
const column = (name) => csv[0].indexOf(name);
const rows = csv.slice(1).map((row) => ({
  time: Number(row[0]), force: row.slice(1, 4).map(Number), status: row[column('status')],
}));
const measured = rows.filter(({ status }) => status === 'UPDATED' || status === 'RESEEDED');
const largest = measured.reduce((best, row) => (Math.hypot(...row.force) > Math.hypot(...best.force) ? row : best));
assert.equal(rows.length, 24000);
assert.ok(measured.length < rows.length, 'the recording has frames that were not measured');

const bytes = statSync(page_file).size;
console.log(`report: ${(bytes / 1e6).toFixed(2)} MB`);
assert.ok(bytes < 3e6, `${bytes} bytes`);
assert.equal(summary.bytes, bytes);

// ------------------------------------------------------------------------------------------------------------ the page
const browser = await browserType.launch({
  executablePath: chromium, headless: true,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const complaints = [], requests = [];
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, colorScheme: 'light' });
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text())) complaints.push(message.text()); });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => { if (!request.url().startsWith('data:')) requests.push(request.url()); });
  const address = pathToFileURL(page_file).href;
  await page.goto(address);
  await page.waitForSelector('html[data-ready=yes]');

  const data = await page.evaluate(() => JSON.parse(document.getElementById('data').textContent));
  const { curves, figures, shapes } = data;

  // No peak is lost: the largest force, and the extremes of every component in each stretch of 0.6 s.
  const at = curves.time_s.indexOf(largest.time);
  assert.ok(at >= 0, 'the row of the largest force is in the page');
  assert.deepEqual([curves.fx_N[at], curves.fy_N[at], curves.fz_N[at]], largest.force);
  assert.ok(Math.abs(figures.peak.size_N - Math.hypot(...largest.force)) < 1e-15); // a root, rounded twice
  const shown = curves.time_s.map((time, i) => ({ time, force: [curves.fx_N[i], curves.fy_N[i], curves.fz_N[i]], status: curves.statuses[curves.status[i]] }))
    .filter(({ status }) => status === 'UPDATED' || status === 'RESEEDED');
  assert.ok(shown.length < measured.length, 'the rows were thinned');
  for (const k of [0, 1, 2]) {
    const extremes = (list) => { const found = new Map(); for (const { time, force } of list) { const bin = Math.floor(Math.round(time * 40) / 24); const [low, high] = found.get(bin) ?? [Infinity, -Infinity]; found.set(bin, [Math.min(low, force[k]), Math.max(high, force[k])]); } return found; };
    assert.deepEqual(extremes(shown), extremes(measured));
  }
  assert.ok(shapes.moments.some(({ t }) => t === largest.time), 'the shape of the largest force is in the page');
  assert.ok(shapes.moments.length > 200 && shapes.moments.length < 1000);
  const in_bands = figures.bands.seconds.reduce((a, b) => a + b, figures.bands.not_measured_s);
  assert.ok(Math.abs(in_bands - 599.975) < 1e-6, `${in_bands} s in bands`);
  assert.equal(curves.spans.reduce((sum, { frames }) => sum + frames, 0), rows.length - measured.length);

  // Text stays text.
  assert.equal(await page.textContent('h1'), title);
  assert.equal(await page.title(), title);
  assert.equal(await page.locator('img').count(), 0);
  assert.ok((await page.textContent('body')).includes('not for clinical use'));

  // Pixels: curves and shape are there, and move when told to.
  const colours = (selector) => page.evaluate((s) => {
    const canvas = document.querySelector(s), copy = document.createElement('canvas');
    copy.width = canvas.width; copy.height = canvas.height;
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, copy.width, copy.height);
    let painted = 0, blue = 0, sum = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] > 0) ++painted;
      if (pixels[i + 3] > 100 && pixels[i + 2] > pixels[i] + 60) ++blue;
      sum = (sum * 31 + pixels[i] + 7 * pixels[i + 1] + 13 * pixels[i + 2]) % 1000003;
    }
    return { painted, blue, sum };
  }, selector);
  const plot = '#force-plot canvas', solid = '#shape canvas';
  const first = { plot: await colours(plot), solid: await colours(solid) };
  assert.ok(first.plot.blue > 2000, `force curve: ${JSON.stringify(first.plot)}`);
  assert.ok(first.solid.painted > 3000 && first.solid.blue > 200, `shape: ${JSON.stringify(first.solid)}`);
  assert.ok((await colours('#nis-plot canvas')).blue > 1000, 'innovation drawn');
  await page.screenshot({ path: join(artifacts, 'report_light.png') });
  await page.screenshot({ path: join(artifacts, 'report_light_whole.png'), fullPage: true });

  // Unit switch: the largest force in each unit.
  const tile = () => page.textContent('.tile .figure');
  const newtons = Math.hypot(...largest.force);
  assert.equal(await tile(), `${(newtons / 9.80665e-3).toFixed(1)} g`);
  await page.click('button[data-key=N]');
  assert.equal(await tile(), `${newtons.toFixed(4)} N`);
  assert.notEqual((await colours(plot)).sum, first.plot.sum, 'the axis has other numbers');
  await page.click('button[data-key=g]');

  // Keyboard: moment, zoom and turning.
  const readout = () => page.textContent('.readout');
  const before = await readout();
  await page.focus('#force-plot');
  await page.keyboard.press('ArrowRight');
  assert.notEqual(await readout(), before, 'arrow right moves the moment');
  const whole = (await colours(plot)).sum;
  for (let i = 0; i < 8; ++i) await page.keyboard.press('+');
  await page.waitForTimeout(100);
  assert.notEqual((await colours(plot)).sum, whole, 'plus zooms');
  await page.screenshot({ path: join(artifacts, 'report_zoomed.png') });
  await page.keyboard.press('0');
  await page.waitForTimeout(100);
  assert.equal((await colours(plot)).sum, whole, '0 shows all again');
  const standing = (await colours(solid)).sum;
  await page.focus(solid);
  await page.keyboard.press('ArrowLeft');
  assert.notEqual((await colours(solid)).sum, standing, 'arrow left turns the shape');
  await page.keyboard.press('0');
  await page.focus('#moment');
  await page.keyboard.press('Home');
  assert.ok((await readout()).startsWith('0.000 s'), await readout());
  assert.notEqual((await colours(solid)).sum, standing, 'the slider moves the shape');

  // What was not measured says so, and is a gap in the curve.
  const held = curves.status.findIndex((status) => curves.statuses[status] === 'HELD' || curves.statuses[status] === 'REJECTED');
  await page.evaluate((row) => { const slider = document.getElementById('moment'); slider.value = String(row); slider.dispatchEvent(new Event('input')); }, held);
  assert.match(await readout(), /predicted, not measured/);

  // Components with the truth, in the dark.
  await page.keyboard.press('End');
  await page.click('button[data-key="x y z"]');
  await page.click('#theme');
  await page.waitForTimeout(100);
  assert.ok((await colours(plot)).painted > 2000);
  await page.screenshot({ path: join(artifacts, 'report_components_dark.png') });
  await page.click('button[data-key=size]');
  await page.click('.link >> nth=0'); // the first contact
  await page.waitForTimeout(100);
  await page.screenshot({ path: join(artifacts, 'report_dark.png') });
  await page.emulateMedia({ media: 'print' });
  await page.pdf({ path: join(artifacts, 'report.pdf'), format: 'A4' });

  assert.deepEqual(complaints, []);
  assert.deepEqual([...new Set(requests)], [address]);
} finally {
  await browser.close();
}
console.log(`screenshots: ${artifacts}`);
