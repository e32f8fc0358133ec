// Deep links: `#t=10.1`, `#expect=4`, `#step=3`, `#tab=source`; numbers count from 1.

/**
 * @typedef {object} Place
 * @property {number | null} time [s]
 * @property {number | null} expect index from 0
 * @property {number | null} step index from 0
 * @property {string | null} tab
 */

/** @param {string} hash @returns {Place} */
export function readAddress(hash) {
  const values = new URLSearchParams(hash.replace(/^#/, ""));
  const numeric = (name) => {
    const text = values.get(name);
    const value = Number(text);
    return text !== null && text !== "" && Number.isFinite(value) ? value : null;
  };
  const index = (name) => {
    const value = numeric(name);
    return value !== null && Number.isInteger(value) && value >= 1 ? value - 1 : null;
  };
  return { time: numeric("t"), expect: index("expect"), step: index("step"), tab: values.get("tab") };
}

/** Have the address say where the page is, without a new entry in the history. @param {Record<string, string | number | null>} place */
export function writeAddress(place) {
  const given = Object.entries(place).filter(([, value]) => value !== null && value !== undefined);
  const hash = `#${given.map(([name, value]) => `${name}=${value}`).join("&")}`;
  if (location.hash !== hash) history.replaceState(null, "", hash);
}
