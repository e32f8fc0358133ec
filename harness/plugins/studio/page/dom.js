// Elements by id, and new ones; text goes in as text, never as HTML.

export const $ = (id) => document.getElementById(id);

export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key === "class") made.className = value;
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** One of the page's icons. */
export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const use = document.createElementNS("http://www.w3.org/2000/svg", "use");
  use.setAttribute("href", `#i-${name}`);
  svg.append(use);
  return svg;
}

export function options(select, values, first = []) {
  const chosen = select.value;
  select.replaceChildren(...[...first, ...values.map((v) => [v, v])].map(([value, text]) => element("option", { value }, text)));
  if ([...select.options].some((o) => o.value === chosen)) select.value = chosen;
}

export const list = (id, values) => $(id).replaceChildren(...values.map((value) => element("option", { value })));

export const numbers = (text) => text.trim().split(/[\s,]+/).map(Number);

/** Buttons of which one is pressed. */
export function segments(box, values, chosen, onChoose) {
  box.hidden = values.length < 2;
  box.replaceChildren(...values.map((value) => element("button", { "aria-pressed": String(value === chosen), onclick: () => onChoose(value) }, value)));
}

export function log(kind, text) {
  const line = element("div", { class: `entry ${kind}` }, text);
  $("log").prepend(line);
  while ($("log").childElementCount > 60) $("log").lastElementChild.remove();
}
