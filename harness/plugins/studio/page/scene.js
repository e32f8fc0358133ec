// The cell in three dimensions, with the viewer of the report page: bodies, ghosts of goals and plans, lines.

import { surfacesOf } from "/view/bodies.js";
import { Labels } from "/view/labels.js";
import { creased } from "/view/normals.js";
import { Orbit, SIDES } from "/view/orbit.js";
import { controlOrbit } from "/view/pointer.js";
import { square } from "/view/shapes.js";
import { multiply, poseMatrix } from "/view/vectors.js";
import { Viewer } from "/view/viewer.js";
import { rgba, themeColor } from "/view/dom.js";
import { on } from "./connection.js";
import { $, element } from "./dom.js";
import { amount } from "./quantities.js";

const CREASE = 0.76; // cosine of the largest angle of a mesh that is smoothed
const FLOOR = 12; // half the side of the floor of a world without one [m]
const SOLID = 0.78, FAINT = 0.16; // opacity of ghosts
const SAME = { position: 0.003, turn: 0.99998 }; // a ghost's link so near to the robot's is not drawn [m], cosine of half an angle
const MOVING = 150; // [ms] after a pose in which the picture is drawn in fewer pixels where that is slow
const CHOSEN = 0.3; // glow of what is selected

/** What is drawn; `viewer` is null where the browser has no WebGL2. */
export const scene = { viewer: null, orbit: null, labels: null, links: [], objects: new Map(), selected: "", onSelect: () => {}, onDrawn: () => {}, onBodies: () => {} };

let movedAt = 0, resting = 0;
let ghosts = [], hovered = -1, plan = null, copies = [], path = null, gap = null, floor = null, isDirty = false;

/** Make the canvas, once what it frames is known. */
function makeViewer(message) {
  try {
    scene.viewer = new Viewer($("view"), message.bounds);
  } catch {
    $("view").append(element("p", { class: "no-view" }, "This browser has no WebGL2: the cell is not drawn, everything else works."));
    return;
  }
  const { viewer } = scene;
  scene.orbit = new Orbit(message.focus, () => { markSide(); viewer.redraw(); });
  viewer.canvas.tabIndex = 0;
  viewer.canvas.setAttribute("role", "img");
  viewer.canvas.setAttribute("aria-label", "The robot cell; arrow keys turn it, plus and minus zoom, enter selects what is in the middle");
  controlOrbit(viewer.canvas, scene.orbit, (x, y) => scene.onSelect(bodyAt(x, y)));
  scene.labels = new Labels(viewer, scene.orbit);
  const place = viewer.onDrawn;
  viewer.onDrawn = () => { place(); scene.onDrawn(); };
  viewer.onChange = draw;
  path = viewer.addLine([], { width: 3, onTop: true });
  gap = viewer.addLine([], { width: 2, onTop: true });
  const { positions, indices } = square(FLOOR);
  floor = viewer.addSurface(creased(positions, indices, 0), [1, 1, 1, 1], { grid: 1, castsShadow: false, isUntouchable: true, model: poseMatrix([0, 0, -0.001, 1, 0, 0, 0]) });
  $("sides")?.replaceChildren(...Object.keys(SIDES).map((side) => element("button", { "aria-pressed": "false", onclick: () => scene.orbit.look(side) }, side)));
  markSide();
  paint();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
}

function markSide() {
  for (const button of $("sides")?.children ?? []) button.setAttribute("aria-pressed", button.textContent === scene.orbit?.side);
}

function draw() {
  if (isDirty) return;
  isDirty = true;
  requestAnimationFrame(() => {
    isDirty = false;
    const isMoving = scene.orbit.isHeld || Date.now() - movedAt < MOVING;
    scene.viewer.draw(scene.orbit, isMoving);
    clearTimeout(resting);
    if (isMoving) resting = setTimeout(draw, MOVING); // then with all its pixels
  });
}

/** The colours of the scheme. */
function paint() {
  const { viewer } = scene;
  viewer.background = rgba(themeColor("--sky")).slice(0, 3);
  viewer.zenith = rgba(themeColor("--zenith")).slice(0, 3);
  viewer.ambient = Number(themeColor("--ambient"));
  viewer.outline = Number(themeColor("--outline"));
  const color = rgba(themeColor("--floor"));
  for (const { surface } of [...scene.objects.values()].flatMap((body) => body.pieces)) if (surface.grid) surface.color = color;
  floor.color = color;
  path.color = rgba(themeColor("--plan"));
  gap.color = rgba(themeColor("--warn"));
  showGhosts();
  viewer.moved();
}

const numbersOf = (text, Type) => new Type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);

function bodiesOf(message) {
  const meshes = message.meshes.map(({ positions, indices }) => creased(numbersOf(positions, Float32Array), numbersOf(indices, Uint32Array), CREASE));
  return message.bodies.map((body) => ({ ...body, pose: null, pieces: body.shapes.flatMap((shape) => surfacesOf(scene.viewer, shape, meshes, body.isGhost)) }));
}

const dispose = (bodies) => { for (const body of bodies) for (const { surface } of body.pieces) scene.viewer.removeSurface(surface); };

on("links", (message) => {
  if (!scene.viewer && !$("view").querySelector(".no-view")) makeViewer(message);
  if (!scene.viewer) { scene.links = message.bodies; return; }
  dispose(scene.links);
  for (const copy of copies) dispose(copy);
  copies = [];
  scene.links = bodiesOf(message);
  scene.viewer.cover(message.bounds);
  Object.assign(scene.orbit.focus, message.focus);
  scene.orbit.look("iso");
});

on("objects", (message) => {
  if (!scene.viewer) { scene.objects = new Map(message.bodies.map((body) => [body.name, body])); return; }
  dispose(scene.objects.values());
  scene.objects = new Map(bodiesOf(message).map((body) => [body.name, body]));
  floor.visible = ![...scene.objects.values()].some((body) => body.pieces.some(({ surface }) => surface.grid));
  paint();
  scene.onBodies();
});

on("frame", (message) => {
  message.links.forEach((pose, index) => put(scene.links[index], pose));
  for (const body of scene.objects.values()) put(body, message.objects[body.name] ?? null);
  if (!scene.viewer) return;
  if (copies.length) showGhosts();
  movedAt = Date.now();
  scene.viewer.moved();
});

/** Put a body at a pose; without one it is not there. */
export function put(body, pose) {
  if (!body) return;
  body.pose = pose;
  if (!body.pieces) return;
  const matrix = pose && poseMatrix(pose);
  for (const { surface, local } of body.pieces) {
    surface.visible = Boolean(pose);
    if (pose) surface.model = multiply(matrix, local);
  }
}

/** Let something glow. */
export function select(name) {
  scene.selected = name;
  for (const body of [...scene.links, ...scene.objects.values()]) {
    for (const { surface } of body.pieces ?? []) if (!surface.grid) surface.glow = body.name === name ? CHOSEN : 0;
  }
  scene.viewer?.redraw();
}

/** The body at a place of the canvas: a link or an object; null for none, or the floor. */
export function bodyAt(x, y) {
  const surface = scene.viewer.pick(scene.orbit, x, y);
  if (!surface || surface.grid) return null;
  return [...scene.links, ...scene.objects.values()].find((body) => body.pieces.some((piece) => piece.surface === surface)) ?? null;
}

// -- ghosts ---------------------------------------------------------------------------------

on("ghosts", (message) => { ghosts = message.ghosts; hovered = -1; showGhosts(); });

/** Show one of the ways alone, while its button is under the pointer; -1 for none. */
export function previewWay(way) {
  hovered = way;
  showGhosts();
}

/** Show the plan at some positions of the links; null takes it away. */
export function showPlanned(poses, points) {
  plan = poses && { poses, tone: "--plan", solid: true, way: -1 };
  if (path && points !== undefined) scene.viewer.setPoints(path, (points ?? []).flat());
  showGhosts();
}

function showGhosts() {
  if (!scene.viewer) return;
  const chosen = hovered >= 0 ? ghosts.filter(({ way }) => way === hovered) : ghosts.toSorted((a, b) => b.solid - a.solid);
  const shown = plan && hovered < 0 ? [plan] : chosen;
  const drawn = scene.links.map((link) => [link.pose]); // a surface is drawn once at a place: two would flicker
  while (copies.length < shown.length) copies.push(scene.links.map(copyOf));
  const tones = new Map();
  copies.forEach((bodies, number) => {
    const ghost = shown[number];
    const opacity = hovered >= 0 || ghost?.solid ? SOLID : FAINT;
    if (ghost && !tones.has(ghost.tone)) tones.set(ghost.tone, rgba(themeColor(ghost.tone)).slice(0, 3));
    bodies.forEach((body, index) => {
      const pose = ghost?.poses[index];
      const isNew = pose && !drawn[index].some((other) => isSame(pose, other));
      put(body, isNew ? pose : null);
      if (isNew) drawn[index].push(pose);
      if (ghost) for (const { surface } of body.pieces) surface.color = [...tones.get(ghost.tone), opacity];
    });
  });
  scene.viewer.redraw();
}

function copyOf(body) {
  return { pieces: body.pieces.map(({ surface, local }) => ({ local, surface: scene.viewer.addCopy(surface, { castsShadow: false, isUntouchable: true, recedes: true, glow: 0 }) })) };
}

/** Whether two poses are so near that surfaces of one would flicker through those of the other. */
function isSame(a, b) {
  if (!b) return false;
  const apart = Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  const turn = Math.abs(a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6]);
  return apart < SAME.position && turn > SAME.turn;
}

// -- lines ----------------------------------------------------------------------------------

on("clearance", ({ points }) => {
  if (!scene.viewer) return;
  scene.viewer.setPoints(gap, points ? points.flat() : []);
  const [a, b] = points ?? [];
  scene.labels.show(points ? [{ point: a.map((each, i) => (each + b[i]) / 2), text: amount(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), "m") }] : []);
});
