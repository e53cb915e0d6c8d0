// SPDX-License-Identifier: Apache-2.0
// The shaft in space: sensors, tip frame, force and the region that holds it with 95 %.
import { AmbientLight, Box3, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { WALL_MM, createGround, createShapeThings } from './shape_things.js';
import { onThemeChange } from './theme.js';

/** Does this browser draw in three dimensions? */
function hasWebGL() {
  try {
    return Boolean(document.createElement('canvas').getContext('webgl2'));
  } catch {
    return false;
  }
}

/**
 * `scale`: millimetres of arrow a newton; `keep`: the picture can be read back; `far`: how far away one stands. Moments, flat arrays in the base frame:
 * {shaft, sensors, seen: millimetres, contact, R: tip frame column by column, force [N], ellipsoid: semi-axes [N] column by
 * column, wall, wallNormal}; what is no number is not shown, the wall may be left out.
 * Returns {show(moment, measured), frame(moments), goHome, destroy}, or null where the browser cannot draw it.
 */
export function createShapeView(parent, { scale, keep = true, far = 1 }) {
  if (!hasWebGL()) return null;
  const renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: keep });
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
  const things = createShapeThings(scale), ground = createGround();
  scene.add(things.group, ground.group);
  things.group.visible = false; // until there is a moment
  let home = null;

  const render = () => renderer.render(scene, camera);
  const show = (moment, measured) => {
    things.show(moment, measured);
    things.group.visible = true;
    render();
  };
  const paint = () => {
    ground.paint();
    things.paint();
    render();
  };
  /** Puts all moments' shapes into the picture. */
  const frame = (moments) => {
    const box = new Box3(new Vector3(-6, -6, -4), new Vector3(6, 6, 0));
    for (const { shaft, contact, force, wallNormal } of moments) {
      for (let i = 0; i < shaft.length; i += 3) box.expandByPoint(new Vector3().fromArray(shaft, i));
      const end = new Vector3().fromArray(contact).addScaledVector(new Vector3().fromArray(force), scale);
      if (Number.isFinite(end.x + end.y + end.z)) box.expandByPoint(end);
      if (wallNormal) box.union(new Box3().setFromCenterAndSize(new Vector3().fromArray(contact), new Vector3().setScalar(1.4 * WALL_MM)));
    }
    box.expandByScalar(3);
    const middle = box.getCenter(new Vector3()), radius = (far * box.getSize(new Vector3()).length()) / 2;
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
  return { show, frame, goHome, destroy() { resized.disconnect(); forget(); controls.dispose(); renderer.dispose(); renderer.domElement.remove(); } };
}
