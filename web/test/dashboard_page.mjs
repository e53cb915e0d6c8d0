// SPDX-License-Identifier: Apache-2.0
// node dashboard_page.mjs PALPATE WEB_FOLDER CHROMIUM ARTIFACTS [PART...]: looks at the page of `palpate serve` as a person
// at the table would, before a program that is played, then before the real one. PALPATE_LONG=1: memory over ten minutes.
import { mkdirSync } from 'node:fs';
import { DOUBT_PARTS } from './dashboard_doubt.mjs';
import { LOOK_PARTS } from './dashboard_looks.mjs';
import { MOCK_PARTS } from './dashboard_mock.mjs';
import { REAL_PARTS } from './dashboard_real.mjs';
import { launch } from './page_tools.mjs';

const [palpate, web, chromium, artifacts, ...chosen] = process.argv.slice(2);
mkdirSync(artifacts, { recursive: true });
const browser = await launch(web, chromium);
try {
  for (const [parts, first] of [[MOCK_PARTS, web], [DOUBT_PARTS, web], [LOOK_PARTS, web], [REAL_PARTS, palpate]])
    for (const [name, part] of Object.entries(parts)) {
      if (chosen.length && !chosen.includes(name)) continue;
      const begin = Date.now();
      await part(browser, first, artifacts);
      console.log(`${name}: passed in ${((Date.now() - begin) / 1000).toFixed(1)} s`);
    }
} finally {
  await browser.close();
}
console.log(`screenshots: ${artifacts}`);
process.exit(0);
