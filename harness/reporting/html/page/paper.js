// Plots on paper: pictures of them, in light colours, put into the summary while it is printed.

import { byId, element } from "./dom.js";
import { Plot } from "./plot.js";
import { short } from "./units.js";

const PAPER = { width: 340, height: 190 }; // of a plot, in CSS pixels
const SHARPNESS = 3;

/**
 * @param {import("./plots.js").Plots} plots
 * @param {() => void} repaint draws everything in the colours of the present theme
 */
export function putPlotsOnPaper(plots, repaint) {
  const root = document.documentElement;
  let theme;
  addEventListener("beforeprint", () => {
    theme = root.dataset.theme;
    root.dataset.theme = "light";
    plots.redraw();
    const pictures = plots.panels.map(({ plot, data }) => {
      const names = data.series.flatMap(({ name }, index) => {
        if (plot.hidden.has(index)) return [];
        return [element("span", {}, Plot.swatch(plot.colors[index]), short(name)), " "];
      });
      return element(
        "figure", {},
        element("img", { src: plot.pictureOf(PAPER.width, PAPER.height, SHARPNESS), alt: plot.canvas.getAttribute("aria-label") }),
        element("figcaption", {}, element("b", {}, data.unit ? `${data.title} [${data.unit}]` : data.title), " ", ...names),
      );
    });
    byId("paper-plots").replaceChildren(...pictures);
  });
  addEventListener("afterprint", () => {
    if (theme) root.dataset.theme = theme;
    else delete root.dataset.theme;
    byId("paper-plots").replaceChildren();
    repaint();
  });
}
