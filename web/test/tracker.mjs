// SPDX-License-Identifier: Apache-2.0
// A tracker that speaks OpenIGTLink 1 (TRANSFORM messages) to whoever connects, as a PLUS server does.
import { createServer } from 'node:net';

const POLYNOMIAL = 0x42f0e1eba9ea3693n, MASK = (1n << 64n) - 1n;
const TABLE = Array.from({ length: 256 }, (_, byte) => {
  let remainder = BigInt(byte) << 56n;
  for (let bit = 0; bit < 8; ++bit) remainder = ((remainder << 1n) ^ (remainder >> 63n ? POLYNOMIAL : 0n)) & MASK;
  return remainder;
});
/** CRC-64 of ECMA-182. */
export const crc64 = (bytes) => bytes.reduce((crc, byte) => TABLE[Number(crc >> 56n) ^ byte] ^ ((crc << 8n) & MASK), 0n);

/** `columns`: d1, d2, d3, place [mm], three numbers each. */
function transform(device, time_s, columns) {
  const body = Buffer.alloc(48), head = Buffer.alloc(58);
  columns.flat().forEach((value, i) => body.writeFloatBE(value, 4 * i));
  head.writeUInt16BE(1, 0);
  head.write('TRANSFORM', 2, 'latin1');
  head.write(device, 14, 'latin1');
  head.writeUInt32BE(Math.floor(time_s), 34);
  head.writeUInt32BE(Math.floor((time_s % 1) * 2 ** 32), 38);
  head.writeBigUInt64BE(48n, 42);
  head.writeBigUInt64BE(crc64(body), 50);
  return Buffer.concat([head, body]);
}

/** A shaft without load that is bent to an arc of `curvature_per_m` about d1: pose at `arc_mm`. */
export function arcPose(curvature_per_m, arc_mm, noise_mm = () => 0) {
  const k = curvature_per_m * 1e-3, angle = k * arc_mm, c = Math.cos(angle), s = Math.sin(angle);
  const place = [0, -(1 - c) / k, s / k].map((x) => x + noise_mm());
  return [[1, 0, 0], [0, c, s], [0, -s, c], place];
}

/** `poses()`: {device: columns}, asked for each frame. {port, start(), kill()}: kill() closes all, also the port. */
export async function startTracker(poses, rate_hz = 40, port = 0) {
  const sockets = new Set(), tracker = { port, sent: 0 };
  let server = null, timer = 0;
  tracker.kill = () => {
    clearInterval(timer);
    for (const socket of sockets) socket.resetAndDestroy();
    server.close();
  };
  tracker.start = async () => {
    server = createServer((socket) => {
      socket.setNoDelay(true);
      sockets.add(socket);
      socket.on('error', () => {}).on('data', () => {}).on('close', () => sockets.delete(socket));
    });
    await new Promise((resolve) => server.listen(tracker.port, '127.0.0.1', resolve));
    tracker.port = server.address().port;
    timer = setInterval(() => {
      const time_s = Date.now() / 1000, frame = Buffer.concat(Object.entries(poses()).map(([device, columns]) => transform(device, time_s, columns)));
      for (const socket of sockets) socket.write(frame);
      ++tracker.sent;
    }, 1000 / rate_hz);
  };
  await tracker.start();
  return tracker;
}
