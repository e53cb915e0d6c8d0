// SPDX-License-Identifier: Apache-2.0
// The socket to the program: greeting, rows, history, status; pings; and coming back when it was lost.
import { createClockOffset } from './clock_offset.js';
import { FIRST_ANSWERS, SILENT_MS } from './judge.js';
import { MESSAGE, createRow, readMessage, rowLayout } from './row_layout.js';

const FIRST_WAIT_MS = 250, LONGEST_WAIT_MS = 2000, REFUSED_WAIT_MS = 30_000, CONNECT_MS = 3000, PING_MS = 1000;

/**
 * `events`: {hello(greeting), row(row), history(fields, rows, numbers, step_s), status(status), event(event)}; rows and
 * history are those of the watched catheter. Nothing that comes is trusted to fit: what does not is counted and left.
 */
export function createLiveLink(address, events) {
  const link = {
    open: false, refused: false, heard_ms: -Infinity, connections: 0, rows: 0, unread: 0, watched: 0,
    hello: null, status: null, row: null, arrived_ms: NaN, script_ms: 0, clock: createClockOffset(), watch, close,
  };
  let socket = null, wait_ms = FIRST_WAIT_MS, retry = 0, began_ms = 0, pinged_ms = -Infinity, pings = 0, wanted = null, ended = false;

  function connect() {
    if (ended) return;
    began_ms = performance.now();
    const made = (socket = new WebSocket(address));
    made.binaryType = 'arraybuffer';
    made.onmessage = ({ data }) => made === socket && hear(data);
    made.onclose = () => made === socket && lost();
  }
  function hear(data) {
    const now_ms = (link.heard_ms = performance.now());
    try {
      if (typeof data === 'string') hearText(JSON.parse(data), now_ms);
      else if (link.hello) hearNumbers(data, now_ms);
    } catch (error) {
      if (!(error instanceof SyntaxError)) throw error;
      ++link.unread;
    }
    link.script_ms += performance.now() - now_ms;
  }
  function hearText(message, now_ms) {
    if (message.type === 'hello') greet(message);
    else if (message.type === 'pong') link.clock.answer(message.ping, now_ms, message.server_ms);
    else if (message.type === 'status') events.status((link.status = message));
    else if (message.type === 'event') events.event(message);
    else ++link.unread;
  }
  function greet(hello) {
    const layout = rowLayout(hello.row);
    const again = hello.catheters.findIndex(({ name }) => name === wanted);
    Object.assign(link, { hello, open: true, refused: false, watched: again < 0 ? hello.watched : again, row: null, arrived_ms: NaN, status: null });
    link.next = createRow(layout);
    link.clock.forget();
    ++link.connections;
    wait_ms = FIRST_WAIT_MS;
    pings = 0;
    ping(performance.now()); // before anything that takes time: until the answer no force is shown
    events.hello(hello);
    if (link.watched !== hello.watched) watch(link.watched);
  }
  function hearNumbers(buffer, now_ms) {
    const message = readMessage(buffer, link.next.layout, link.hello.history.length);
    if (!message) ++link.unread;
    else if (message.catheter !== link.watched) return;
    else if (message.kind === MESSAGE.HISTORY) events.history(link.hello.history, message.rows, message.body, link.hello.history_step_s);
    else {
      (link.row = link.next).numbers.set(message.body);
      if (link.row.get('state') !== 3) link.arrived_ms = now_ms;
      ++link.rows;
      events.row(link.row);
    }
  }
  function lost() {
    socket = null;
    link.open = false;
    clearTimeout(retry);
    retry = setTimeout(connect, wait_ms);
    wait_ms = Math.min(2 * wait_ms, LONGEST_WAIT_MS);
    askWhy();
  }
  /** A socket does not tell that it was refused for its token; a request does. */
  async function askWhy() {
    try {
      const { status } = await fetch('/api/health', { cache: 'no-store', signal: AbortSignal.timeout(CONNECT_MS) });
      link.refused = status === 401 && !link.open;
      if (!link.refused || socket) return;
      clearTimeout(retry); // the program counts each attempt as a stranger's, and none will do
      retry = setTimeout(connect, REFUSED_WAIT_MS);
    } catch {
      link.refused = false;
    }
  }
  function drop() {
    const dead = socket;
    socket = null;
    dead?.close();
    lost();
  }
  const turn = setInterval(() => {
    const now_ms = performance.now();
    if (!socket) return;
    if (!link.open) return now_ms - began_ms > CONNECT_MS ? drop() : undefined;
    if (now_ms - link.heard_ms > SILENT_MS) return drop();
    if (now_ms - pinged_ms < (pings < FIRST_ANSWERS ? 100 : PING_MS) || socket.readyState !== WebSocket.OPEN) return;
    ping(now_ms);
  }, 50);
  function ping(now_ms) {
    ++pings;
    pinged_ms = now_ms;
    socket.send(JSON.stringify({ ping: now_ms }));
  }
  function watch(index) {
    if (!link.open || !link.hello.catheters[index]) return;
    wanted = link.hello.catheters[index].name;
    Object.assign(link, { watched: index, row: null, arrived_ms: NaN });
    link.next.numbers.fill(NaN);
    socket.send(JSON.stringify({ watch: index }));
  }
  function close() {
    ended = true;
    clearInterval(turn);
    clearTimeout(retry);
    socket?.close();
  }
  connect();
  return link;
}
