// The 3D view with everything in it, posed at a time.

import { Contacts } from "./contacts.js";
import { byId, element } from "./dom.js";
import { Inspector } from "./inspect.js";
import { Labels } from "./labels.js";
import { Marks } from "./marks.js";
import { Orbit } from "./orbit.js";
import { indexAt, valueAt } from "./payload.js";
import { controlOrbit } from "./pointer.js";
import { Replay } from "./replay.js";
import { Viewer } from "./viewer.js";
import { Why } from "./why.js";

const HARD = 20; // a force [N] at which a body in collision glows fully
const LEAST = 0.01; // [N]: what presses less does not touch
const CHOSEN = 0.45; // glow of the body that was clicked

/** The canvas and its camera, with names for keyboard and reader; null where the browser has no WebGL2. */
export function makeView(run, bounds = run.bounds) {
  let viewer;
  try {
    viewer = new Viewer(byId("view"), bounds);
  } catch {
    byId("view").append(element("p.no-view", {}, "This browser has no WebGL2: the 3D replay is off, everything else works."));
    return null;
  }
  const orbit = new Orbit(run.focus, () => viewer.redraw());
  if (run.opening) orbit.open(run.opening);
  viewer.canvas.tabIndex = 0;
  viewer.canvas.setAttribute("role", "img");
  viewer.canvas.setAttribute("aria-label", "3D replay of the run; arrow keys turn it, plus and minus zoom, enter shows what is in the middle");
  return { viewer, orbit };
}

/** Null where the browser has no WebGL2. @param {import("./payload.js").Payload} payload @param {() => any} contactData the plot group of contact forces */
export function makeScene(payload, contactData) {
  const { run } = payload;
  const view = makeView(run);
  if (!view) return null;
  const { viewer, orbit } = view;
  const film = new Orbit(run.focus, () => {});
  const replay = new Replay(payload, viewer);
  const marks = new Marks(payload, viewer);
  const arrows = new Contacts(payload, viewer);
  const labels = new Labels(viewer, orbit);
  const why = new Why(payload, viewer, labels, marks, replay);
  const pairs = new Map(run.contacts.map((contact) => [`${contact.first} and ${contact.second}`, contact]));
  const touching = (time) =>
    (contactData()?.series ?? []).flatMap((series) => {
      const [pair, force] = [pairs.get(series.name), valueAt(series, time)];
      return pair && force > LEAST ? [{ ...pair, force }] : [];
    });
  const inspector = new Inspector(run, arrows, touching);
  let now = 0;
  controlOrbit(viewer.canvas, orbit, (x, y) => inspector.choose(replay.bodyOf(viewer.pick(orbit, x, y)), now));

  const scene = {
    viewer, orbit, film, replay, marks, arrows, why, inspector,
    showsContacts: true,
    follows: false,
    toolPosition(time) {
      const { times, path } = marks.tcp;
      const index = 3 * indexAt(times, time);
      return [path[index], path[index + 1], path[index + 2]];
    },
    pose(time, step) {
      now = time;
      replay.pose(time);
      replay.glow(glows(time));
      arrows.show(time, this.showsContacts);
      const tool = replay.byName.get(run.toolBody);
      replay.showState(marks.enabled.goal ? run.steps[step]?.nearest?.bodies : null);
      marks.show(time, step, tool ? [...this.toolPosition(time), ...replay.poseOf(tool, time).slice(3)] : null);
      inspector.show(time);
      if (this.follows) orbit.follow(this.toolPosition(time));
    },
  };

  /** What shines, and how much: the pair that collides, what a verdict is about, the chosen body. */
  function glows(time) {
    const found = new Map(why.glows);
    const raise = (name, glow) => found.set(name, Math.max(found.get(name) ?? 0, glow));
    if (inspector.body) raise(inspector.body.name, CHOSEN);
    for (const { first, second, force, isCollision } of scene.showsContacts ? touching(time) : []) {
      if (isCollision) for (const name of [first, second]) raise(name, Math.min(1, 0.25 + force / HARD));
    }
    return found;
  }
  return scene;
}
