// SPDX-License-Identifier: Apache-2.0
// node web/build.mjs FOLDER: bundles the pages into FOLDER, whose node_modules hold what package-lock.json lists.
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = process.argv[2];
const here = dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(join(folder, 'package.json'))('esbuild');

// The licences of what is bundled ask to travel with it.
const licences = ['three', 'uplot']
  .map((name) => `${name}\n\n${readFileSync(join(folder, 'node_modules', name, 'LICENSE'), 'utf8').trim()}`)
  .join('\n\n');

await esbuild.build({
  entryPoints: { report: join(here, 'report.js'), dashboard: join(here, 'dashboard.js') },
  outdir: folder,
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['es2020'],
  charset: 'ascii',
  nodePaths: [join(folder, 'node_modules')],
  banner: { js: `/*! Palpate's page contains:\n\n${licences.replaceAll('*/', '* /')}\n*/` },
  logLevel: 'warning',
});

copyFileSync(join(here, 'dashboard.html'), join(folder, 'dashboard.html'));

// What ends the element that the bundle is put into would break every page.
for (const [name, end] of [['report.js', /<\/script|<!--/i], ['report.css', /<\/style/i]])
  if (end.test(readFileSync(join(folder, name), 'utf8'))) throw new Error(`${name} contains ${end}`);
writeFileSync(join(folder, 'bundle.stamp'), '');
