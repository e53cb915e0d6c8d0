// SPDX-License-Identifier: Apache-2.0
// The page before the real program: its demonstration, a tracker that is killed and comes back, a restart.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { belong, coloursOf, handle, look } from './number_looks.mjs';
import { fits, inTime, open, text, until, watchWord, word } from './page_tools.mjs';
import { arcPose, startTracker } from './tracker.mjs';

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const CURVATURE_PER_M = 24.57;
const CATHETER = `schema = 1
[catheter]
name = "arc"
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [${CURVATURE_PER_M}, 0.0, 0.0]
precurvature_sigma_per_m = [0.1, 0.1, 0.1]
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [0.0, 0.0, 0.0]
[[sensor]]
name = "tip"
kind = "pose"
arc_length_mm = 70.0
noise_mm = 0.28
noise_deg = 0.17
[[sensor]]
name = "shaft"
kind = "pose"
arc_length_mm = 65.3
noise_mm = 0.28
noise_deg = 0.17
[estimator]
method = "iekf"
state = ["force"]
`;

/** `palpate serve --json ...`: {address, port, end()}; what it says on stderr goes into the failure. */
async function serve(palpate, ...options) {
  const program = spawn(palpate, ['serve', '--json', '--openigtlink-port', '0', ...options], { stdio: ['ignore', 'pipe', 'pipe'] });
  let out = '', errors = '';
  program.stdout.on('data', (data) => { out += data; });
  program.stderr.on('data', (data) => { errors += data; });
  process.on('exit', () => program.kill('SIGKILL')); // also where the test fails
  const gone = new Promise((resolve) => program.on('exit', resolve));
  await until('first line of palpate serve', async () => out + errors, () => out.includes('\n'), 10_000);
  const said = JSON.parse(out.split('\n')[0]);
  return { address: said.dashboard_url, port: said.dashboard_port, end: async (signal = 'SIGTERM') => { program.kill(signal); await gone; } };
}
const calm = ({ complaints, others }) => {
  assert.deepEqual(complaints, []);
  assert.deepEqual(others(), []);
};

/**
 * Share of rows whose 95 % interval holds the truth. Over 90 s it was 94.4 %, and rows are nearly independent (1.3 of them
 * are worth one draw): 400 rows, as a busy machine shows in 15 s, have a standard deviation of 1.3 %, and the bound lies 2.6 of
 * them below. It catches sigmas that are a quarter too small or a force that is off by one sigma (86 % and 83 %), not less;
 * the estimator's own tests judge more finely.
 */
const LEAST_INSIDE = 0.91, LOOK_S = 15;

async function demonstration(browser, palpate, artifacts) {
  const program = await serve(palpate, '--demo', '--dashboard-port', '0');
  const seen = await open(browser, program.address, { settings: { window_s: 10 } }), { page } = seen;
  await word(page, 'LIVE', 10_000);
  assert.ok(!page.url().includes('token'), 'the token does not stay in the address');
  await sleep(1500); // the tissue comes
  const colours = await coloursOf(page), rows = await look(page, LOOK_S), inside = rows.filter(({ size_N, sigma_N, truth_N }) => Math.abs(size_N - truth_N) <= 1.959964 * sigma_N).length;
  assert.ok(rows.length > 10 * LOOK_S, `${rows.length} rows in ${LOOK_S} s`);
  assert.ok(Math.max(...rows.map(({ truth_N }) => truth_N)) > 0.05, 'the tip is pushed');
  const bands = belong(rows, 'g', colours);
  assert.ok(bands.size >= 2 && new Set(colours).size === 5, `bands ${[...bands]} in ${colours}`);
  const { latency_ms: latency, script_ms: script } = await page.evaluate(() => window.palpate.figures());
  console.log(`demonstration: truth inside 95 % interval in ${((100 * inside) / rows.length).toFixed(1)} % of ${rows.length} rows; bands ${[...bands].join(', ')}; socket to page p50 ${latency.p50.toFixed(1)} ms, p95 ${latency.p95.toFixed(1)} ms; script p50 ${script.p50.toFixed(1)} ms, p95 ${script.p95.toFixed(1)} ms`);
  assert.ok(inside >= LEAST_INSIDE * rows.length, `${inside} of ${rows.length} inside`);
  await handle(page, colours);
  assert.match(await text(page, 'footer'), /socket to page p50 \d.* ms, p95 \d.* ms/);
  await page.keyboard.press('n');
  await page.keyboard.type('from the page');
  await page.keyboard.press('Enter');
  await until('the note comes back', () => text(page, 'notes'), (said) => /\d\d:\d\d:\d\d from the page/.test(said));
  await word(page, 'LIVE', 10_000);
  await page.screenshot({ path: join(artifacts, 'dashboard_demo.png') }); // docs/figures/dashboard.png
  assert.deepEqual(seen.complaints, []);
  await until('the answer', () => page.evaluate(() => document.activeElement === document.body), Boolean);
  await page.keyboard.press('t');
  await page.keyboard.press('Tab'); // from the no to the yes
  await page.keyboard.press('Enter');
  await until('the refusal of the tare', () => text(page, 'notes'), (said) => said.includes('not tared: tare: the catheter file is sure'));
  await page.screenshot({ path: join(artifacts, 'dashboard_demo_refused.png') });
  await fits(page);
  seen.complaints.splice(0, 1, ...seen.complaints.slice(0, 1).filter((said) => !said.includes('409'))); // the browser's own word
  calm(seen);

  const late = await open(browser, program.address);
  await until('history', () => late.page.evaluate(() => window.palpate.store.lastTime() - window.palpate.store.firstTime()), (seconds) => seconds > 8);
  calm(late);
  await late.close();

  // Started anew on the same port: the old address is no longer good, and the page says so.
  await program.end('SIGKILL');
  await word(page, 'NO CONNECTION');
  assert.equal(await text(page, 'number'), '–');
  const again = await serve(palpate, '--demo', '--dashboard-port', String(program.port));
  await until('refused', () => text(page, 'health-reason'), (said) => /started anew: open the address that it printed/.test(said), 8000);
  await page.goto(again.address);
  await word(page, 'LIVE', 10_000);
  await seen.close();
  await again.end();
}

async function source(browser, palpate, artifacts) {
  const folder = mkdtempSync(join(tmpdir(), 'palpate-dashboard-')), catheter = join(folder, 'arc.toml');
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  writeFileSync(catheter, CATHETER);
  let seed = 1;
  const noise_mm = () => { seed = (seed * 1103515245 + 12345) % 2147483648; return 0.4 * (seed / 2147483648 - 0.5); };
  const tracker = await startTracker(() => ({ tip: arcPose(CURVATURE_PER_M, 70, noise_mm), shaft: arcPose(CURVATURE_PER_M, 65.3, noise_mm) }));
  const program = await serve(palpate, '--catheter', catheter, '--source', `127.0.0.1:${tracker.port}`, '--record', join(folder, 'a.palpate'), '--dashboard-port', '0');
  const seen = await open(browser, program.address, { width: 1024, height: 768, scheme: 'dark' }), { page } = seen;
  const rounds = [];
  for (let round = 0; round < 3; ++round) {
    await until('LIVE', () => text(page, 'health-word'), (said) => said === 'LIVE' || said === 'DEGRADED', 10_000);
    await sleep(1500);
    await until('LIVE still', () => text(page, 'health-word'), (said) => said === 'LIVE' || said === 'DEGRADED');
    if (round === 0) await page.screenshot({ path: join(artifacts, 'dashboard_source.png') });
    await watchWord(page);
    tracker.kill();
    await word(page, 'STALE');
    const stale = (await page.evaluate(() => window.changes)).findLast(({ word: said }) => said === 'STALE');
    assert.equal(stale.figures, '– – – –');
    rounds.push(stale);
    await until('why', () => text(page, 'health-reason'), (said) => /not connected/.test(said), 5000);
    assert.equal(await text(page, 'number'), '–');
    await page.screenshot({ path: join(artifacts, 'dashboard_source_stale.png') });
    const begin = Date.now();
    await tracker.start();
    await until('live again', () => text(page, 'number'), (said) => said !== '–', 5000);
    console.log(`source killed; a number again ${Date.now() - begin} ms after it came back`);
  }
  inTime(rounds);
  await page.click('#tare');
  await page.click('#tare-go');
  await until('the tare', () => text(page, 'notes'), (said) => /tared from \d+ frames/.test(said), 5000);
  await until('recorded', () => text(page, 'recording'), (said) => /● ?\d+ frames ?a\.palpate/.test(said));
  await page.screenshot({ path: join(artifacts, 'dashboard_source_tared.png') });
  await fits(page);
  calm(seen);
  await seen.close();
  tracker.kill();
  await program.end();
}

export const REAL_PARTS = { demonstration, source };
