// Tabs as screen readers know them: arrow keys move between them.

import { byId, element } from "./dom.js";

/**
 * @param {{id: string, title: string, badge?: string, content: HTMLElement}[]} tabs
 * @returns {(id: string) => void} shows a tab
 */
export function makeTabs(tabs) {
  const list = byId("tabs");
  const buttons = tabs.map(({ id, title, badge }) =>
    element(
      "button",
      { type: "button", role: "tab", id: `tab-${id}`, "aria-controls": `panel-${id}`, onclick: () => show(id) },
      title, badge ? element("span.badge", {}, badge) : null,
    ),
  );
  const panels = tabs.map(({ id, content }) =>
    element("div.tab-panel", { role: "tabpanel", id: `panel-${id}`, "aria-labelledby": `tab-${id}`, tabindex: 0 }, content),
  );
  list.append(...buttons);
  byId("panels").append(...panels);
  list.addEventListener("keydown", (event) => {
    const move = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!move) return;
    event.preventDefault();
    event.stopPropagation();
    const current = buttons.findIndex((button) => button.getAttribute("aria-selected") === "true");
    const next = (current + move + tabs.length) % tabs.length;
    show(tabs[next].id);
    buttons[next].focus();
  });

  function show(id) {
    tabs.forEach((tab, index) => {
      const isShown = tab.id === id;
      buttons[index].setAttribute("aria-selected", String(isShown));
      buttons[index].tabIndex = isShown ? 0 : -1;
      panels[index].hidden = !isShown;
    });
  }
  show(tabs[0].id);
  return show;
}
