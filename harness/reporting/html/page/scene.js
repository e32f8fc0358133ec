// The 3D view with everything in it, posed at a time.

import { Contacts } from "./contacts.js";
import { byId, element } from "./dom.js";
import { Marks } from "./marks.js";
import { Orbit } from "./orbit.js";
import { indexAt, valueAt } from "./payload.js";
import { Replay } from "./replay.js";
import { Viewer } from "./viewer.js";

const HARD = 20; // a force [N] at which a body in collision glows fully

/** Null where the browser has no WebGL2. @param {import("./payload.js").Payload} payload */
export function makeScene(payload) {
  const { run } = payload;
  let viewer;
  try {
    viewer = new Viewer(byId("view"), run.bounds);
  } catch {
    byId("view").append(element("p.no-view", {}, "This browser has no WebGL2: the 3D replay is off, everything else works."));
    return null;
  }
  const orbit = new Orbit(run.focus, () => viewer.redraw());
  const film = new Orbit({ ...run.focus, radius: 0.75 * run.focus.radius }, () => {});
  orbit.control(viewer.canvas);
  viewer.canvas.tabIndex = 0;
  viewer.canvas.setAttribute("role", "img");
  viewer.canvas.setAttribute("aria-label", "3D replay of the run; arrow keys turn it, plus and minus zoom");
  const replay = new Replay(payload, viewer);
  const marks = new Marks(payload, viewer);
  const arrows = new Contacts(payload, viewer);
  const collisions = new Map(
    run.contacts.filter(({ isCollision }) => isCollision).map(({ first, second }) => [`${first} and ${second}`, [first, second]]),
  );
  return {
    viewer, orbit, film, replay, marks, arrows,
    toolPosition(time) {
      const { times, path } = marks.tcp;
      const index = 3 * indexAt(times, time);
      return [path[index], path[index + 1], path[index + 2]];
    },
    pose(time, step, contacts) {
      replay.pose(time);
      const colliding = new Map();
      for (const series of contacts?.series ?? []) {
        const force = valueAt(series, time);
        if (!(force > 0.01)) continue;
        for (const name of collisions.get(series.name) ?? []) {
          colliding.set(name, Math.max(colliding.get(name) ?? 0, Math.min(1, 0.25 + force / HARD)));
        }
      }
      replay.glow(this.showsContacts ? colliding : new Map());
      arrows.show(time, this.showsContacts);
      const tool = replay.byName.get(run.toolBody);
      replay.showState(marks.enabled.goal ? run.steps[step]?.nearest?.bodies : null);
      marks.show(time, step, tool ? [...this.toolPosition(time), ...replay.poseOf(tool, time).slice(3)] : null);
      if (this.follows) {
        orbit.target = this.toolPosition(time);
        viewer.redraw();
      }
    },
    showsContacts: true,
    follows: false,
  };
}
