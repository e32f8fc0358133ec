// viser's picture of the cell, in its frame.

import { page } from "./connection.js";
import { $, element } from "./dom.js";

export function showScene() {
  const frame = $("scene");
  frame.addEventListener("load", () => {
    const inside = frame.contentDocument;
    // viser's own panels have nothing in them: everything but the picture is hidden
    inside?.head.append(element("style", {}, "body *:not(:has(canvas)):not(canvas) { display: none !important; }"));
    inside?.addEventListener("keydown", (event) => document.dispatchEvent(new KeyboardEvent("keydown", event)));
  });
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  frame.src = `/scene/${page}${dark ? "?darkMode" : ""}`;
}
