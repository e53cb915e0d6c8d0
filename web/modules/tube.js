// SPDX-License-Identifier: Apache-2.0
import { BufferAttribute, BufferGeometry, Vector3 } from 'three';

const RINGS = 61, SIDES = 12;

/** A round tube along points in space: one geometry whose numbers are written anew when the points move. */
export function createTube(radius) {
  const geometry = new BufferGeometry();
  const position = new BufferAttribute(new Float32Array(3 * RINGS * SIDES), 3), normal = new BufferAttribute(new Float32Array(3 * RINGS * SIDES), 3);
  const index = [];
  for (let ring = 0; ring + 1 < RINGS; ++ring)
    for (let side = 0; side < SIDES; ++side) {
      const a = ring * SIDES + side, b = ring * SIDES + ((side + 1) % SIDES), c = a + SIDES, d = b + SIDES;
      index.push(a, b, c, b, d, c);
    }
  geometry.setAttribute('position', position);
  geometry.setAttribute('normal', normal);
  geometry.setIndex(index);

  const at = new Vector3(), along = new Vector3(), across = new Vector3(), third = new Vector3(), out = new Vector3();
  /** `flat`: x, y, z of each point. The direction across is carried along, so that the tube does not twist. */
  const set = (flat) => {
    const last = flat.length / 3 - 1;
    across.set(1, 0, 0);
    for (let ring = 0; ring < RINGS; ++ring) {
      curve(flat, (ring / (RINGS - 1)) * last, last, at, along);
      along.normalize();
      across.addScaledVector(along, -across.dot(along));
      if (across.lengthSq() < 1e-6) across.set(along.y, along.z, along.x).cross(along);
      across.normalize();
      third.crossVectors(along, across);
      for (let side = 0; side < SIDES; ++side) {
        const angle = (2 * Math.PI * side) / SIDES, i = ring * SIDES + side;
        out.copy(across).multiplyScalar(Math.cos(angle)).addScaledVector(third, Math.sin(angle));
        normal.setXYZ(i, out.x, out.y, out.z);
        position.setXYZ(i, at.x + radius * out.x, at.y + radius * out.y, at.z + radius * out.z);
      }
    }
    position.needsUpdate = normal.needsUpdate = true;
  };
  return { geometry, set };
}

/** Catmull-Rom spline through points of equal distance: place and direction at parameter `s`, 0 to `last`. */
function curve(flat, s, last, at, along) {
  const i = Math.min(Math.floor(s), last - 1), t = s - i;
  const value = (k, axis) => flat[3 * Math.min(Math.max(k, 0), last) + axis];
  for (let axis = 0; axis < 3; ++axis) {
    const b = value(i, axis), c = value(i + 1, axis);
    const a = i > 0 ? value(i - 1, axis) : 2 * b - c, d = i + 2 <= last ? value(i + 2, axis) : 2 * c - b;
    const [p, q, r] = [(c - a) / 2, a - 2.5 * b + 2 * c - d / 2, (d - a) / 2 + 1.5 * (b - c)];
    at.setComponent(axis, b + t * (p + t * (q + t * r)));
    along.setComponent(axis, p + t * (2 * q + 3 * t * r));
  }
}
