// Making elements; text is always text, never markup.

/**
 * @param {string} tag with classes: `div.step.failed`
 * @param {Record<string, any>} [properties] attributes; `on...` are listeners
 * @param {...(Node | string | number | null | undefined | false)} children
 * @returns {any}
 */
export function element(tag, properties = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const made = document.createElement(name);
  if (classes.length) made.className = classes.join(" ");
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && (value !== false || key.startsWith("aria-"))) made.setAttribute(key, String(value));
  }
  made.append(...children.filter((child) => child !== null && child !== undefined && child !== false).map(asNode));
  return made;
}

function asNode(child) {
  return child instanceof Node ? child : String(child);
}

const LONG = 18; // characters of a word that may be broken where its parts meet

/** Text whose long names break where their parts meet. @param {string} text @returns {any[]} children of an element */
export function breakable(text) {
  const parts = text.split(/(\s+)/).flatMap((word) => (word.length > LONG ? word.split(/(?<=[_:/]|\.(?=[a-z]))(?=\w)/) : [word]));
  return parts.flatMap((part, index) => (index ? [document.createElement("wbr"), part] : [part]));
}

/** @param {string} id @returns {any} */
export function byId(id) {
  return document.getElementById(id);
}

/** Scroll a list, and only the list, so far that an item is seen. */
export function scrollInto(list, item) {
  if (!item || list.scrollHeight <= list.clientHeight) return;
  const [top, bottom] = [item.offsetTop - list.offsetTop, item.offsetTop - list.offsetTop + item.offsetHeight];
  if (top < list.scrollTop) list.scrollTop = top;
  else if (bottom > list.scrollTop + list.clientHeight) list.scrollTop = bottom - list.clientHeight;
}

/** Scroll a list, and only the list, so far that an item begins at its top. */
export function scrollToTop(list, item) {
  if (item) list.scrollTop = item.offsetTop - list.offsetTop;
}

/** The value of a colour of the style sheet, as it is in the present theme. @param {string} name `--accent` */
export function themeColor(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** `#rrggbb` as numbers from 0 to 1, and an opacity. @param {string} hex @param {number} [alpha] */
export function rgba(hex, alpha = 1) {
  return [...[1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16) / 255), alpha];
}
