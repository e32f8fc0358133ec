// Two replays in one view: over each other, the second one tinted, or next to each other.

import { rgba, themeColor } from "./dom.js";
import { Orbit } from "./orbit.js";
import { controlOrbit } from "./pointer.js";
import { Replay } from "./replay.js";
import { makeView } from "./scene.js";

const TINT = [0.98, 0.55, 0.1];
const OPACITY = 0.6;

/** Null where the browser has no WebGL2. @param {any[]} payloads of both runs @param {import("./two_runs.js").Alignment} alignment */
export function makeTwoScenes(payloads, alignment) {
  const runs = payloads.map(({ run }) => run);
  const focus = { points: runs.flatMap((run) => run.focus.points), arm: Math.max(...runs.map((run) => run.focus.arm)) };
  const opening = runs.flatMap((run) => run.opening ?? []);
  const view = makeView({ ...runs[0], focus, opening: opening.length ? opening : null });
  if (!view) return null;
  const { viewer, orbit } = view;
  const film = new Orbit(focus, () => {});
  controlOrbit(viewer.canvas, orbit, () => {});
  const replays = payloads.map((payload) => new Replay(payload, viewer));
  const paths = payloads.map((payload, index) => {
    const color = rgba(themeColor(index ? "--raw" : "--accent"), 0.8);
    return viewer.addLine(new Float32Array(payload.buffer("tcp")), { color, width: 2.5, dash: index ? 0.03 * focus.arm : 0 });
  });
  const shown = [true, true];
  const isNextTo = () => Boolean(viewer.halves);
  const second = replays[1];
  const colors = new Map(second.bodies.flatMap(({ pieces }) => pieces.map(({ surface }) => [surface, surface.color])));

  /** What of a run is seen: over the other one, the second run's own bodies that move, tinted. */
  const show = (index, is, isTinted) => {
    for (const body of replays[index].bodies) {
      const isDrawn = is && body.isThere && !(isTinted && body.fixed && !body.isLink);
      for (const { surface } of body.pieces) {
        surface.visible = isDrawn;
        if (index === 0) continue;
        const color = colors.get(surface);
        surface.color = isTinted ? [...TINT.map((tint, i) => 0.65 * tint + 0.35 * color[i]), OPACITY] : color;
        surface.castsShadow = !isTinted && color[3] > 0.99;
      }
    }
    paths[index].visible = is;
  };
  const showBoth = () => [0, 1].forEach((index) => show(index, shown[index], index === 1 && shown[0]));

  return {
    viewer, orbit, film, shown,
    replay: { paintFloor: (color) => replays.forEach((replay) => replay.paintFloor(color)) },
    pose(time) {
      replays[0].pose(time);
      second.pose(alignment.ofSecond(time));
      if (!isNextTo()) showBoth();
    },
    /** @param {boolean} is whether the runs stand next to each other */
    putNextTo(is) {
      viewer.halves = is ? [0, 1].map((side) => () => [0, 1].forEach((index) => show(index, index === side, false))) : null;
      if (!is) showBoth();
      viewer.moved();
    },
    showBoth() {
      if (!isNextTo()) showBoth();
      viewer.moved();
    },
  };
}
