// Plots on paper: pictures of them, in light colours, put into the summary while it is printed.

import { byId, element } from "./dom.js";

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
      const names = data.series.map((series) => series.name).join(", ");
      return element(
        "figure", {},
        element("img", { src: plot.canvas.toDataURL(), alt: `${data.title}: ${names}` }),
        element("figcaption", {}, `${data.title} ${data.unit && `[${data.unit}]`}`),
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
