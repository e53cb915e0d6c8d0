// SPDX-License-Identifier: Apache-2.0
// What stands in the picture of a shape. Every mesh is made once; a moment writes places, turns and sizes.
import {
  CircleGeometry, Color, ConeGeometry, CylinderGeometry, DoubleSide, GridHelper, Group, Matrix4, Mesh, MeshLambertMaterial, RingGeometry, SphereGeometry, Vector3,
} from 'three';
import { colour } from './theme.js';
import { createTube } from './tube.js';

const MOST_SENSORS = 8, UP = new Vector3(0, 1, 0), Z = new Vector3(0, 0, 1);
const finite = (flat, at = 0, count = 3) => {
  for (let i = at; i < at + count; ++i) if (!Number.isFinite(flat[i])) return false; // null, undefined and NaN are none
  return flat.length >= at + count;
};

/** `scale`: millimetres of arrow a newton. Returns {group, show(moment, measured), paint()}; moments: see shape_view.js. */
export function createShapeThings(scale) {
  const group = new Group(), paints = [];
  const lit = (name, more = {}) => {
    const material = new MeshLambertMaterial(more);
    paints.push(() => material.color.set(new Color(colour(name))));
    return material;
  };
  const add = (geometry, material, parent = group) => {
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    parent.add(mesh);
    return mesh;
  };
  const ball = new SphereGeometry(1, 32, 20), rod = new CylinderGeometry(1, 1, 1, 16), cone = new ConeGeometry(1, 1, 20);
  const tube = createTube(1.15), shaft = add(tube.geometry, lit('--shaft'));
  const inside = lit('--sensor-model'), seen = lit('--sensor', { transparent: true, opacity: 0.6 });
  const models = Array.from({ length: MOST_SENSORS }, () => add(ball, inside)), tracked = Array.from({ length: MOST_SENSORS }, () => add(ball, seen));
  for (const mesh of models) mesh.scale.setScalar(1.45);
  for (const mesh of tracked) mesh.scale.setScalar(2.1);
  const axes = ['--x', '--y', '--z'].map((name) => add(rod, lit(name)));
  const measuredInk = lit('--size'), heldInk = lit('--held-ink', { transparent: true, opacity: 0.5 });
  const measuredRegion = lit('--size', { transparent: true, opacity: 0.3, depthWrite: false }), heldRegion = lit('--held-ink', { transparent: true, opacity: 0.12, depthWrite: false });
  const stem = add(rod, measuredInk), head = add(cone, measuredInk), region = add(ball, measuredRegion);
  region.matrixAutoUpdate = false;
  const wall = createWall(lit, add);
  group.add(wall.group);

  const at = new Vector3(), direction = new Vector3(), tip = new Vector3();
  const semi = [new Vector3(), new Vector3(), new Vector3()], basis = new Matrix4();
  const stretch = (mesh, from, along, length, radius) => {
    mesh.quaternion.setFromUnitVectors(UP, along);
    mesh.position.copy(from).addScaledVector(along, length / 2);
    mesh.scale.set(radius, length, radius);
  };
  const places = (meshes, flat) => meshes.forEach((mesh, i) => {
    mesh.visible = finite(flat, 3 * i);
    if (mesh.visible) mesh.position.fromArray(flat, 3 * i);
  });
  const showForce = (moment, measured) => {
    const known = finite(moment.force) && finite(moment.contact);
    stem.visible = head.visible = region.visible = known;
    if (!known) return;
    stem.material = head.material = measured ? measuredInk : heldInk;
    region.material = measured ? measuredRegion : heldRegion;
    at.fromArray(moment.contact);
    direction.fromArray(moment.force).multiplyScalar(scale);
    const length = direction.length(), point = Math.min(5, 0.4 * length);
    region.visible = showRegion(moment);
    stem.visible = head.visible = length > 0.5;
    if (length <= 0.5) return;
    direction.divideScalar(length);
    stretch(stem, at, direction, length - point, 0.55);
    stretch(head, at.addScaledVector(direction, length - point), direction, point, 0.42 * point);
  };
  const showRegion = ({ ellipsoid }) => {
    if (!finite(ellipsoid, 0, 9)) return false;
    semi.forEach((axis, i) => axis.fromArray(ellipsoid, 3 * i).multiplyScalar(scale));
    for (const axis of semi) if (axis.length() < 0.05) axis.setLength(0.05);
    if (semi.some((axis) => !(axis.lengthSq() > 0))) return false;
    if (basis.makeBasis(...semi).determinant() < 0) semi[2].negate();
    region.matrix.makeBasis(...semi).setPosition(at.x + direction.x, at.y + direction.y, at.z + direction.z);
    return true;
  };
  const show = (moment, measured) => {
    const count = moment.shaft.length;
    shaft.visible = finite(moment.shaft, 0, count);
    if (shaft.visible) tube.set(moment.shaft);
    places(models, moment.sensors);
    places(tracked, moment.seen);
    const framed = shaft.visible && finite(moment.R, 0, 9);
    if (framed) tip.fromArray(moment.shaft, count - 3);
    axes.forEach((mesh, axis) => {
      mesh.visible = framed;
      if (framed) stretch(mesh, tip, direction.fromArray(moment.R, 3 * axis), 9, 0.3);
    });
    showForce(moment, measured);
    wall.show(moment.wall, moment.wallNormal, framed ? tip : null);
  };
  return { group, show, paint: () => paints.forEach((paint) => paint()) };
}

export const WALL_MM = 15; // radius of the piece that is shown

/** A round piece of a plane with rings 5 mm apart, around the point of it that is nearest to the tip. */
function createWall(lit, add) {
  const group = new Group(), sheer = { transparent: true, side: DoubleSide, depthWrite: false };
  add(new CircleGeometry(WALL_MM, 48), lit('--wall', { ...sheer, opacity: 0.22 }), group);
  for (const radius of [5, 10, WALL_MM]) add(new RingGeometry(radius - 0.12, radius + 0.12, 64), lit('--wall', { ...sheer, opacity: 0.6 }), group);
  const normal = new Vector3(), at = new Vector3();
  const show = (point, along, tip) => {
    group.visible = Boolean(point && along) && finite(point) && finite(along);
    if (!group.visible) return;
    normal.fromArray(along).normalize();
    at.fromArray(point);
    if (tip) {
      const ahead = at.sub(tip).dot(normal);
      at.copy(tip).addScaledVector(normal, ahead);
    }
    group.position.copy(at);
    group.quaternion.setFromUnitVectors(Z, normal);
  };
  return { group, show };
}

/** The clamp and its plane, 10 mm a square. Returns {group, paint()}. */
export function createGround() {
  const group = new Group(), material = new MeshLambertMaterial();
  const clamp = new Mesh(new CylinderGeometry(2.6, 2.6, 6, 24), material);
  clamp.rotation.x = Math.PI / 2;
  clamp.position.z = -3;
  let grid = null;
  const paint = () => {
    material.color.set(new Color(colour('--held-ink')));
    grid?.dispose();
    if (grid) group.remove(grid);
    grid = new GridHelper(100, 10, new Color(colour('--grid-strong')), new Color(colour('--grid')));
    grid.rotation.x = Math.PI / 2;
    group.add(grid);
  };
  group.add(clamp);
  return { group, paint };
}
