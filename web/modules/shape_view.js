// SPDX-License-Identifier: Apache-2.0
// The shaft in space: sensors, tip frame, force and the region that holds it with 95 %.
import {
  AmbientLight, Box3, CatmullRomCurve3, Color, ConeGeometry, CylinderGeometry,
  DirectionalLight, GridHelper, Group, Matrix4, Mesh, MeshLambertMaterial,
  PerspectiveCamera, Scene, SphereGeometry, TubeGeometry, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { colour, onThemeChange } from './theme.js';

const points = (flat) => Array.from({ length: flat.length / 3 }, (_, i) => new Vector3().fromArray(flat, 3 * i));

/** Does this browser draw in three dimensions? */
function hasWebGL() {
  try {
    return Boolean(document.createElement('canvas').getContext('webgl2'));
  } catch {
    return false;
  }
}

/**
 * `scale`: millimetres of arrow a newton. Moments: {shaft, sensors: flat millimetres in the base frame, seen: [[x, y, z] or
 * null], contact, R: tip frame column by column, force [N], ellipsoid: semi-axes [N] column by column}.
 * Returns {show(moment, measured), frame(moments), destroy}, or null where the browser cannot draw it.
 */
export function createShapeView(parent, { scale }) {
  if (!hasWebGL()) return null;
  const renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(2, devicePixelRatio));
  renderer.domElement.tabIndex = 0;
  renderer.domElement.setAttribute('role', 'img');
  renderer.domElement.setAttribute('aria-label', 'Shape of the catheter with force arrow. Arrow keys turn it, + and - zoom, 0 resets.');
  parent.append(renderer.domElement);
  const scene = new Scene();
  const camera = new PerspectiveCamera(35, 1, 0.5, 5000);
  camera.up.set(0, 0, 1); // e3 along the straight shaft stands upright
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.enableDamping = false;
  scene.add(new AmbientLight(0xffffff, 1.6));
  const lamp = new DirectionalLight(0xffffff, 1.8);
  camera.add(lamp);
  lamp.position.set(1, 2, 3);
  scene.add(camera);
  const things = new Group(), ground = new Group();
  scene.add(things, ground);
  let last = null, home = null;

  const render = () => renderer.render(scene, camera);
  const show = (moment, measured) => {
    last = [moment, measured];
    clear(things);
    const ink = (name) => new Color(colour(name));
    const lit = (name, more = {}) => new MeshLambertMaterial({ color: ink(name), ...more });
    const ball = (at, radius, material) => {
      const made = new Mesh(new SphereGeometry(radius, 20, 14), material);
      made.position.copy(at);
      return made;
    };
    const tube = new TubeGeometry(new CatmullRomCurve3(points(moment.shaft)), 60, 1.15, 12);
    things.add(new Mesh(tube, lit('--shaft')));
    for (const at of points(moment.sensors)) things.add(ball(at, 1.45, lit('--sensor-model')));
    for (const at of moment.seen) if (at) things.add(ball(new Vector3().fromArray(at), 2.1, lit('--sensor', { transparent: true, opacity: 0.6 })));
    const tip = new Vector3().fromArray(moment.shaft, moment.shaft.length - 3);
    ['--x', '--y', '--z'].forEach((name, axis) => things.add(stick(tip, new Vector3().fromArray(moment.R, 3 * axis), 9, 0.3, lit(name))));
    addForce(moment, measured, lit);
    render();
  };
  const addForce = (moment, measured, lit) => {
    if (moment.force.some((value) => value === null)) return;
    const from = new Vector3().fromArray(moment.contact), force = new Vector3().fromArray(moment.force).multiplyScalar(scale);
    const name = measured ? '--size' : '--held-ink', faint = measured ? {} : { transparent: true, opacity: 0.5 };
    const length = force.length();
    if (length > 0.5) things.add(arrow(from, force.clone().normalize(), length, lit(name, faint)));
    if (moment.ellipsoid.some((value) => value === null)) return;
    const axes = points(moment.ellipsoid).map((axis) => axis.multiplyScalar(scale));
    for (const axis of axes) if (axis.length() < 0.05) axis.setLength(0.05);
    if (axes.some((axis) => !(axis.lengthSq() > 0))) return;
    if (new Matrix4().makeBasis(...axes).determinant() < 0) axes[2].negate();
    const region = new Mesh(new SphereGeometry(1, 32, 20), lit(name, { transparent: true, opacity: measured ? 0.3 : 0.12, depthWrite: false }));
    region.matrixAutoUpdate = false;
    region.matrix.makeBasis(...axes).setPosition(from.add(force));
    things.add(region);
  };
  const paint = () => {
    clear(ground);
    const grid = new GridHelper(100, 10, new Color(colour('--grid-strong')), new Color(colour('--grid')));
    grid.rotation.x = Math.PI / 2; // the plane of the clamp, 10 mm a square
    const clamp = new Mesh(new CylinderGeometry(2.6, 2.6, 6, 24), new MeshLambertMaterial({ color: new Color(colour('--held-ink')) }));
    clamp.rotation.x = Math.PI / 2;
    clamp.position.z = -3;
    ground.add(grid, clamp);
    if (last) show(...last);
  };
  /** Puts all moments' shapes into the picture. */
  const frame = (moments) => {
    const box = new Box3(new Vector3(-6, -6, -4), new Vector3(6, 6, 0));
    for (const { shaft, contact, force } of moments) {
      for (const at of points(shaft)) box.expandByPoint(at);
      box.expandByPoint(new Vector3().fromArray(contact).addScaledVector(new Vector3().fromArray(force), scale));
    }
    box.expandByScalar(3);
    const middle = box.getCenter(new Vector3()), radius = box.getSize(new Vector3()).length() / 2;
    // Across the mean plane of the bend: there the shape is seen unshortened.
    const bend = moments.reduce((sum, { shaft }) => sum.add(new Vector3().fromArray(shaft, shaft.length - 3)), new Vector3()).setZ(0);
    const across = bend.lengthSq() > 1e-6 ? new Vector3(-bend.y, bend.x, 0).normalize() : new Vector3(1, 0, 0);
    const aside = bend.lengthSq() > 1e-6 ? bend.normalize() : new Vector3(0, 1, 0);
    home = { target: middle, position: middle.clone().addScaledVector(across, radius * 2.5).addScaledVector(aside, radius * 0.9).add(new Vector3(0, 0, radius * 0.8)) };
    goHome();
  };
  const goHome = () => {
    controls.target.copy(home.target);
    camera.position.copy(home.position);
    controls.update();
    render();
  };
  const turn = (about, up) => {
    const arm = camera.position.clone().sub(controls.target);
    arm.applyAxisAngle(camera.up, about);
    const side = new Vector3().crossVectors(camera.up, arm).normalize();
    const turned = arm.clone().applyAxisAngle(side, up);
    if (Math.abs(turned.clone().normalize().dot(camera.up)) < 0.995) arm.copy(turned);
    camera.position.copy(controls.target).add(arm);
    controls.update();
    render();
  };
  const nearer = (factor) => {
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    render();
  };
  renderer.domElement.addEventListener('keydown', (event) => {
    const actions = { ArrowLeft: () => turn(-0.15, 0), ArrowRight: () => turn(0.15, 0), ArrowUp: () => turn(0, -0.15), ArrowDown: () => turn(0, 0.15), '+': () => nearer(0.85), '=': () => nearer(0.85), '-': () => nearer(1.18), '0': () => home && goHome() };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  });
  controls.addEventListener('change', render);
  const resize = () => {
    const { clientWidth: width, clientHeight: height } = parent;
    if (!width || !height) return;
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    render();
  };
  const resized = new ResizeObserver(resize);
  resized.observe(parent);
  const forget = onThemeChange(paint);
  paint();
  resize();
  return { show, frame, goHome, destroy() { resized.disconnect(); forget(); controls.dispose(); renderer.dispose(); } };
}

function clear(group) {
  group.traverse((thing) => {
    thing.geometry?.dispose();
    for (const material of [thing.material].flat()) material?.dispose();
  });
  group.clear();
}

function stick(from, direction, length, radius, material) {
  const made = new Mesh(new CylinderGeometry(radius, radius, length, 12), material);
  made.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
  made.position.copy(from).addScaledVector(direction, length / 2);
  return made;
}

function arrow(from, direction, length, material) {
  const head = Math.min(5, 0.4 * length), made = new Group();
  const cone = new Mesh(new ConeGeometry(0.42 * head, head, 20), material);
  cone.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
  cone.position.copy(from).addScaledVector(direction, length - head / 2);
  made.add(stick(from, direction, length - head, 0.55, material), cone);
  return made;
}
