// Buttons: play, speed, light and dark, print.

import { byId, rgba, themeColor } from "./dom.js";
import { putPlotsOnPaper } from "./paper.js";

/**
 * @param {{
 *   clock: import("./clock.js").Clock, scene: any, plots: import("./plots.js").Plots,
 *   drawFilm: () => void,
 * }} parts `scene` is null without WebGL2
 */
export function makeControls({ clock, scene, plots, drawFilm }) {
  const play = byId("play");
  play.addEventListener("click", () => clock.toggle());
  clock.onPlay((isPlaying) => {
    play.textContent = isPlaying ? "❚❚" : "▶";
    play.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  });
  byId("speed").addEventListener("change", (event) => clock.setSpeed(Number(event.target.value)));
  byId("print").addEventListener("click", () => print());
  byId("help-button").addEventListener("click", () => byId("help").showModal());

  const paint = () => {
    if (scene) {
      scene.viewer.background = rgba(themeColor("--sky")).slice(0, 3);
      scene.viewer.ambient = Number(themeColor("--ambient"));
      scene.viewer.outline = Number(themeColor("--outline"));
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
