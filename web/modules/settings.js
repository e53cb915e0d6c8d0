// SPDX-License-Identifier: Apache-2.0
// What the person chose, kept by the browser; where it keeps nothing, for as long as the page is open.

const KEY = 'palpate.dashboard';

export function createSettings(defaults, storage = safeStorage()) {
  let kept = {};
  try {
    kept = JSON.parse(storage?.getItem(KEY) ?? '{}') ?? {};
  } catch { /* what is there is not ours: the defaults hold */ }
  const values = { ...defaults };
  for (const key of Object.keys(defaults)) if (typeof kept[key] === typeof defaults[key]) values[key] = kept[key];
  return {
    get: (key) => values[key],
    set(key, value) {
      values[key] = kept[key] = value;
      try {
        storage?.setItem(KEY, JSON.stringify(kept));
      } catch { /* full or forbidden */ }
    },
    /** Was it chosen before? */
    has: (key) => kept[key] !== undefined,
  };
}

function safeStorage() {
  try {
    return globalThis.localStorage;
  } catch {
    return null;
  }
}
