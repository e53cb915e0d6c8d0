// SPDX-License-Identifier: Apache-2.0
// A program that says whatever a test wants: the page's files, the interface, and the socket (RFC 6455, unfragmented).
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { HISTORY, ROW, STATUSES } from './page_schema.mjs';
import { rowLayout } from '../modules/row_layout.js';

const layout = rowLayout(ROW);
const CSP = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

export function hello(more = {}) {
  return {
    type: 'hello', version: '0.1.0', row: ROW, history: HISTORY, history_step_s: 0.1, history_s: 600, statuses: STATUSES, states: ['WAITING', 'LIVE', 'DEGRADED', 'STALE'],
    catheters: [{ name: 'demo', sensors: ['tip', 'shaft'], tracked_base: false, length_mm: 70, rigid_tip_mm: 0, simulated: true, wall_normal: [0.4, 0.3, -0.86], estimates: ['force'] }],
    bands_g: [5, 10, 30, 40], unit: 'g', contact_rule: '|F| above 2 g', recording: null, watched: 0, server_ms: Date.now(), ...more,
  };
}

/** A row's numbers from what a test says; the rest is a bent shaft that is pushed with `size_N`. */
export function rowNumbers(fields) {
  const numbers = new Float64Array(layout.size).fill(NaN), now_ms = Date.now();
  const size = fields.size_N ?? 0.1, sigma = 0.008, along = [0.3 * size, 0.25 * size, -0.92 * size];
  const bend = 24.57e-3, point = (s) => [(1 - Math.cos(bend * s)) / bend, 0, Math.sin(bend * s) / bend];
  const shaft = Array.from({ length: 25 }, (_, i) => point((70 * i) / 24)).flat(), tip = shaft.slice(-3), angle = bend * 70;
  const R = [Math.cos(angle), 0, -Math.sin(angle), 0, 1, 0, Math.sin(angle), 0, Math.cos(angle)];
  const base = [0, 1, 2].map((k) => R[k] * along[0] + R[3 + k] * along[1] + R[6 + k] * along[2]);
  const all = {
    time_s: now_ms / 1000, received_ms: now_ms - 1, sent_ms: now_ms, state: 1, status: 0, shown: 1, stale_after_s: 0.1,
    size_N: size, sigma_size_N: sigma, axial_N: along[2], sigma_axial_N: 0.012, lateral_N: Math.hypot(along[0], along[1]), sigma_lateral_N: 0.005,
    angle_rad: 0.4, sigma_angle_rad: 0.05, force_tip_N: along, sigma_tip_N: [0.005, 0.005, 0.012], force_base_N: base,
    ellipsoid_base_N: [0.03, 0, 0, 0, 0.012, 0, 0, 0, 0.012], axial_hidden: 0, lateral_hidden: 0, stiffness_on_prior: 0, contact: Number(size > 0.02),
    contact_s: 12.3, contact_integral_Ns: 1.4, contact_integral_sigma_Ns: 0.06, contact_largest_N: 0.29, integral_Ns: 3.2, integral_sigma_Ns: 0.1, measured_s: 60, unmeasured_s: 0.4,
    beats_per_min: 70, beat_strength: 0.82, stiffness_Nm2: [0.26e-3, 0.167e-3, 0.165e-3], sigma_stiffness_Nm2: [0.01e-3, 0.01e-3, 0.02e-3], nis: 12, dof: 12,
    R_base_tip: R, contact_mm: tip, shaft_mm: shaft, sensors_mm: [...tip, ...point(65.3)], seen_mm: [tip[0] + 0.3, tip[1] + 0.2, tip[2], ...point(65.1)],
    truth_tip_N: along.map((x) => 1.03 * x), truth_size_N: 1.03 * size, wall_mm: [tip[0] + 2, tip[1] + 2, tip[2] - 4], ...fields,
  };
  for (const [name, value] of Object.entries(all)) [value].flat().forEach((x, i) => { if (i < layout.count[name]) numbers[layout.place[name] + i] = x; });
  return numbers;
}

export function status(more = {}, catheter = {}) {
  return {
    type: 'status', latency: { count: 1000, p50_s: 0.0004, p99_s: 0.0011 },
    catheters: [{ catheter: 'demo', state: 'LIVE', words: [], status: 'UPDATED', rate_hz: 40, frames: 100, sensors: { tip: { usable: Math.round(Date.now() / 25) % 1e6 }, shaft: { usable: Math.round(Date.now() / 25) % 1e6 } }, sensors_now: { tip: 'usable', shaft: 'usable' }, ...catheter }], ...more,
  };
}

/** Serves until close(). Clients: {send(object or numbers), drop()}; `calls`: what was posted; `heard`: what they said.
 * `lag_ms`: how long all that is sent is on its way; `answers`: pongs to each ping; `refused`: how often
 * it did. */
export async function startMock(web, { greeting = () => hello(), answer = () => [200, {}] } = {}) {
  const clients = new Set(), calls = [], heard = [], mock = { clients, calls, heard, refuse: false, refused: 0, mute: false, lag_ms: 0, answers: 1 };
  const FILES = { '/': ['dashboard.html', 'text/html'], '/dashboard.js': ['dashboard.js', 'text/javascript'], '/dashboard.css': ['dashboard.css', 'text/css'] };
  const server = createServer((request, response) => {
    const path = new URL(request.url, 'http://x').pathname, file = FILES[path];
    response.setHeader('Content-Security-Policy', CSP);
    if (mock.refuse) ++mock.refused;
    if (mock.refuse) return response.writeHead(401).end('{"error":"token"}');
    if (file) return response.writeHead(200, { 'Content-Type': file[1] }).end(readFileSync(join(web, file[0])));
    let body = '';
    request.on('data', (part) => { body += part; }).on('end', () => {
      if (request.method === 'POST') calls.push([path, JSON.parse(body)]);
      const [code, said] = request.method === 'POST' ? answer(path) : [200, {}];
      response.writeHead(code, { 'Content-Type': 'application/json' }).end(JSON.stringify(said));
    });
  });
  server.on('upgrade', (request, socket) => {
    if (mock.refuse) ++mock.refused;
    if (mock.refuse) return socket.end('HTTP/1.1 401 Unauthorized\r\nConnection: close\r\n\r\n');
    const key = createHash('sha1').update(request.headers['sec-websocket-key'] + '258EAFA5-E914-47DA-95CA-C5AB0DC85B11').digest('base64');
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key}\r\n\r\n`);
    socket.setNoDelay(true);
    const write = (bytes) => socket.writable && socket.write(bytes);
    let due_ms = 0;
    const send = (what) => {
      const bytes = frame(what), now_ms = performance.now();
      due_ms = Math.max(due_ms, now_ms + mock.lag_ms); // a lag that becomes less does not change the order
      if (due_ms > now_ms) setTimeout(write, due_ms - now_ms, bytes);
      else write(bytes);
    };
    const client = { send, drop: () => socket.destroy() };
    socket.on('data', (data) => texts(data).forEach((said) => {
      heard.push(said);
      if (said.ping !== undefined && !mock.mute) for (let i = 0; i < mock.answers; ++i) client.send({ type: 'pong', ping: said.ping, server_ms: Date.now() });
      mock.onSaid?.(client, said);
    }));
    socket.on('close', () => clients.delete(client)).on('error', () => {});
    client.send(greeting());
    clients.add(client);
    mock.onClient?.(client);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return Object.assign(mock, {
    address: `http://127.0.0.1:${server.address().port}/?token=0123456789abcdef`,
    send: (what) => clients.forEach((client) => client.send(what)),
    row: (fields, catheter = 0) => mock.send(Float64Array.from([1, catheter, ...rowNumbers(fields)])),
    close: () => { clients.forEach((client) => client.drop()); server.close(); },
  });
}

function frame(what) {
  const text = !(what instanceof Float64Array), body = text ? Buffer.from(JSON.stringify(what)) : Buffer.from(what.buffer, what.byteOffset, what.byteLength);
  const head = Buffer.alloc(body.length < 126 ? 2 : body.length < 65536 ? 4 : 10);
  head[0] = text ? 0x81 : 0x82;
  head[1] = head.length === 2 ? body.length : head.length === 4 ? 126 : 127;
  if (head.length === 4) head.writeUInt16BE(body.length, 2);
  if (head.length === 10) head.writeBigUInt64BE(BigInt(body.length), 2);
  return Buffer.concat([head, body]);
}

/** The short masked texts that a browser sends. */
function texts(data) {
  const found = [];
  for (let at = 0; at + 6 <= data.length; ) {
    const length = data[at + 1] & 127, mask = data.subarray(at + 2, at + 6), body = Buffer.from(data.subarray(at + 6, at + 6 + length));
    for (let i = 0; i < body.length; ++i) body[i] ^= mask[i % 4];
    if ((data[at] & 15) === 1) found.push(JSON.parse(body.toString()));
    at += 6 + length;
  }
  return found;
}
