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

/** The page of the suite that a run was opened from, which its links name. @param {string} hash @returns {string} a relative address; empty for none */
function suiteOf(hash) {
  const suite = new URLSearchParams(hash.replace(/^#/, "")).get("suite") ?? "";
  return /^(\.\.\/){1,20}index\.html$/.test(suite) ? suite : "";
}

const REST = 250; // [ms] without another time before the address shows it: a browser allows few changes a second

/** Keeps the address at the time and the selection that the page shows, without new entries in the history. */
export class Address {
  /** @param {import("./clock.js").Clock} clock */
  constructor(clock) {
    this.clock = clock;
    this.suite = suiteOf(location.hash);
    const back = document.getElementById("suite"); // a page of two runs has none
    if (this.suite && back instanceof HTMLAnchorElement) [back.hidden, back.href] = [false, this.suite];
    /** @type {Record<string, string | number>} */
    this.place = {};
    let due = 0;
    let isFirst = true;
    clock.onTime(() => {
      if (isFirst) return void (isFirst = false);
      clearTimeout(due);
      due = setTimeout(() => this.#write(), REST);
    });
  }

  /** @param {Record<string, string | number>} place step or verdict that is shown now */
  select(place) {
    this.place = place;
    this.#write();
  }

  #write() {
    const values = Object.entries({ t: this.clock.time.toFixed(2), ...this.place, ...(this.suite && { suite: this.suite }) });
    const hash = `#${values.map(([name, value]) => `${name}=${value}`).join("&")}`;
    if (location.hash !== hash) history.replaceState(null, "", hash);
  }
}
