// Two replays in one view: over each other, each in its colour where they are apart, or next to each other.

import { byId, rgba, themeColor } from "./dom.js";
import { Apart } from "./apart.js";
import { Orbit } from "./orbit.js";
import { controlOrbit } from "./pointer.js";
import { Replay } from "./replay.js";
import { makeView } from "./scene.js";

const TINTS = [[0.15, 0.39, 0.92], [0.98, 0.55, 0.1]]; // of A and of B
const SHARE = 0.7; // of the tint in a body's colour
const OPACITY = 0.6; // of B

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
  const [first, second] = replays;
  const colors = new Map(replays.flatMap(({ bodies }) => bodies.flatMap(({ pieces }) => pieces.map(({ surface }) => [surface, surface.color]))));

  /** Whether a body is at the same place in both runs, so that it is drawn once, as it looks. */
  const coincides = ({ name }) => {
    const [a, b] = [first.byName.get(name), second.byName.get(name)];
    return Boolean(a?.isThere && b?.isThere) && Apart.coincide(a.pose, b.pose);
  };

  /** What of a run is seen. Over each other, bodies that are apart have the colour of their run, and B's can be seen through. */
  const show = (index, is, isOver) => {
    for (const body of replays[index].bodies) {
      if (body.fixed && !body.isLink) {
        for (const { surface } of body.pieces) surface.visible = is && body.isThere && !(isOver && index === 1);
        continue;
      }
      const isTinted = isOver && !coincides(body);
      for (const { surface } of body.pieces) {
        surface.visible = is && body.isThere && (isTinted || !isOver || index === 0);
        const color = colors.get(surface);
        surface.color = isTinted ? [...TINTS[index].map((tint, i) => SHARE * tint + (1 - SHARE) * color[i]), index ? OPACITY : color[3]] : color;
        surface.castsShadow = index === 0 || !isTinted;
      }
    }
    paths[index].visible = is;
  };
  const showBoth = () => [0, 1].forEach((index) => show(index, shown[index], shown[0] && shown[1]));

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
      byId("view").classList.toggle("halves", is);
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
