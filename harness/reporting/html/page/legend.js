// The legend of the 3D view, in which everything that is drawn can be switched off, and the sides to look from.

import { byId, element, rgba, themeColor } from "./dom.js";
import { SIDES } from "./orbit.js";

const ROOMY = 900; // [pixels]: a view in which the open legend hides nothing of the arm

/**
 * @typedef {object} Tool
 * @property {string} id @property {string} title
 * @property {string} look class of its swatch @property {boolean} isOn
 * @property {(isOn: boolean) => void} set
 */

/** What a run's view can show; nothing that this run does not have. @param {any} run @param {any} scene @param {boolean} hasPictures @returns {Tool[]} */
function toolsOf(run, scene, hasPictures) {
  const { marks, replay } = scene;
  const mark = (id, title, look, isOn = true) => ({ id, title, look, isOn, set: (is) => (marks.enabled[id] = is) });
  const tools = [
    mark("path", "TCP path", "stroke.accent"),
    mark("plan", "planned path", "stroke.plan.dashed"),
    run.steps.some(({ rawPlan }) => rawPlan) && mark("raw", "path before shortening", "stroke.raw.dashed", false),
    mark("frame", "TCP frame", "axes"),
    mark("goal", "goal, nearest state", "axes.large"),
    { id: "contacts", title: "contacts", look: "stroke.contact", isOn: true, set: (is) => (scene.showsContacts = is) },
    run.bodies.some(({ collisions }) => collisions.length) && {
      id: "collisions", title: "collision shapes", look: "fill.warn", isOn: false,
      set: (is) => replay.showHulls(is, rgba(themeColor("--warn"), 0.35)),
    },
    { id: "commanded", title: "robot as commanded", look: "fill.plan", isOn: false, set: (is) => (replay.showsPlan = is) },
    run.bodies.some(({ ghost }) => ghost) && {
      id: "ghosts", title: "planner's objects", look: "fill", isOn: true, set: (is) => (replay.hidesGhosts = !is),
    },
    hasPictures && { id: "cameras", title: "cameras", look: "fill.dark", isOn: true, set: (is) => (byId("cameras").hidden = !is) },
  ];
  return tools.filter(Boolean);
}

/** @param {any} run @param {any} scene @param {boolean} hasPictures @param {() => void} again draws the present moment anew */
export function makeLegend(run, scene, hasPictures, again) {
  const list = element("div.list");
  for (const { id, title, look, isOn, set } of toolsOf(run, scene, hasPictures)) {
    const button = element("button", { type: "button", "aria-pressed": isOn, id: `tool-${id}`, title: `Show ${title}` }, element(`i.${look}`), title);
    button.addEventListener("click", () => {
      const is = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(is));
      set(is);
      again();
    });
    list.append(button);
  }
  const isWide = byId("view").clientWidth > ROOMY;
  byId("tools").append(element("details", { open: isWide ? "" : null }, element("summary", {}, "legend"), list));
}

/** Buttons that look from a side, follow the TCP, or save the picture. @param {any} scene @param {() => number} now time [s] @param {string} title of the run @param {boolean} [canFollow] */
export function makeSides(scene, now, title, canFollow = true) {
  const { orbit, viewer } = scene;
  const follow = element("button", { type: "button", "aria-pressed": false, title: "Keep the TCP in the middle" }, "follow TCP");
  const setFollow = (is) => {
    scene.follows = is;
    follow.setAttribute("aria-pressed", String(is));
  };
  follow.addEventListener("click", () => {
    setFollow(!scene.follows);
    if (scene.follows) orbit.approach(scene.toolPosition(now()));
    else orbit.look("iso");
  });
  const sides = Object.keys(SIDES).map((side) =>
    element("button", { type: "button", title: `Look from ${side}`, onclick: () => (setFollow(false), orbit.look(side)) }, side),
  );
  const save = element("button", { type: "button", title: "Save this picture as PNG" }, "PNG");
  save.addEventListener("click", () => {
    const link = element("a", { href: viewer.canvas.toDataURL("image/png"), download: `${title} ${now().toFixed(2)} s.png` });
    link.click();
  });
  byId("sides").append(...sides, ...(canFollow ? [follow] : []), save);
}
