// SPDX-License-Identifier: Apache-2.0
// The live row in space: the shape view is told what the row holds, some twenty times a second.
import { createShapeView } from './shape_view.js';
import { UNITS, format } from './units.js';

const LEAST_DRAW_MS = 50;
const EMPTY = [];

/** Returns {setCatheter(catheter, edges_g), frame(verdict, row, now_ms, unit, stretch)}; the
 * latter says whether it drew. */
export function createLiveShape(place, note) {
  let view = null, scale = 100, normal = null, framed = false, drawn_ms = -Infinity, drawn = null, shown = null;
  const moment = {};
  const take = (row) => {
    const part = (name) => row.part(name) ?? EMPTY;
    Object.assign(moment, { shaft: part('shaft_mm'), sensors: part('sensors_mm'), seen: part('seen_mm'), contact: part('contact_mm'), R: part('R_base_tip'), force: part('force_base_N'), ellipsoid: part('ellipsoid_base_N'), wall: part('wall_mm'), wallNormal: normal });
  };
  return {
    setCatheter(catheter, edges_g) {
      view?.destroy();
      framed = false;
      normal = catheter.wall_normal;
      scale = (0.45 * catheter.length_mm) / (edges_g[edges_g.length - 1] / UNITS.g.perNewton);
      view = createShapeView(place, { scale, keep: false, far: 0.95 });
      if (!view) place.textContent = 'The shape needs a browser with WebGL. All else works without.';
    },
    frame(verdict, row, now_ms, unit, stretch) {
      const text = view ? `10 mm of arrow: ${format(10 / scale, unit, unit.name === 'N' ? 3 : 1)} ${unit.name}` : '';
      if (note.textContent !== text) note.textContent = text;
      if (!view || !row || now_ms - drawn_ms < stretch * LEAST_DRAW_MS) return false;
      const time_s = row.get('time_s');
      if (time_s === drawn && verdict.shown === shown) return false;
      take(row);
      if (!verdict.shown) moment.force = EMPTY;
      if (!framed && moment.shaft.length && moment.shaft.every(Number.isFinite)) {
        view.frame([{ ...moment, force: row.part('force_base_N') ?? EMPTY }]);
        framed = true;
      }
      view.show(moment, true);
      drawn_ms = now_ms;
      drawn = time_s;
      shown = verdict.shown;
      return true;
    },
  };
}
