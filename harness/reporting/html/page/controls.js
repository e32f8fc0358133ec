// Buttons: play, speed, what the replay shows, light and dark, print.

import { byId, element, rgba, themeColor } from "./dom.js";
import { putPlotsOnPaper } from "./paper.js";

/**
 * @param {{
 *   clock: import("./clock.js").Clock, scene: any, plots: import("./plots.js").Plots,
 *   drawFilm: () => void, hasPictures: boolean,
 * }} parts `scene` is null without WebGL2
 */
export function makeControls({ clock, scene, plots, drawFilm, hasPictures }) {
  const play = byId("play");
  play.addEventListener("click", () => clock.toggle());
  clock.onPlay((isPlaying) => {
    play.textContent = isPlaying ? "❚❚" : "▶";
    play.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  });
  byId("speed").addEventListener("change", (event) => clock.setSpeed(Number(event.target.value)));
  byId("unzoom").addEventListener("click", () => plots.zoom(0, clock.duration));
  byId("print").addEventListener("click", () => print());
  byId("help-button").addEventListener("click", () => byId("help").showModal());

  const again = () => clock.timeListeners.forEach((listener) => listener(clock.time));
  const tools = !scene ? [] : [
    ["path", "TCP path", true, (is) => (scene.marks.enabled.path = is)],
    ["plan", "plan", true, (is) => (scene.marks.enabled.plan = is)],
    ["raw", "unshortened", false, (is) => (scene.marks.enabled.raw = is)],
    ["frame", "tool frame", true, (is) => (scene.marks.enabled.frame = is)],
    ["goal", "goal", true, (is) => (scene.marks.enabled.goal = is)],
    ["contacts", "contacts", true, (is) => (scene.showsContacts = is)],
    ["ghosts", "planner's objects", true, (is) => (scene.replay.hidesGhosts = !is)],
    ["follow", "follow", false, (is) => (scene.follows = is)],
  ];
  if (hasPictures) tools.push(["cameras", "cameras", true, (is) => (byId("cameras").hidden = !is)]);
  for (const [id, title, isOn, set] of tools) {
    const button = element("button", { type: "button", "aria-pressed": isOn, id: `tool-${id}` }, title);
    button.addEventListener("click", () => {
      const is = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(is));
      set(is);
      again();
    });
    byId("tools").append(button);
  }

  const paint = () => {
    if (scene) {
      scene.viewer.background = rgba(themeColor("--sky")).slice(0, 3);
      scene.viewer.ambient = Number(themeColor("--ambient"));
      scene.replay.paintFloor(rgba(themeColor("--floor")));
      scene.viewer.redraw();
    }
    plots.redraw();
  };
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  byId("theme").addEventListener("click", () => {
    const isDark = root.dataset.theme ? root.dataset.theme === "dark" : dark.matches;
    root.dataset.theme = isDark ? "light" : "dark";
    paint();
    drawFilm();
  });
  dark.addEventListener("change", paint);
  putPlotsOnPaper(plots, paint);
  paint();
}
