// What narrows the rows down, sorts and groups them. The address keeps it.

import { element } from "./dom.js";

const ORDER = ["error", "failed", "invalid", "passed"];

/** The most urgent first: failures, those that miss most first; of what passed, the smallest margin. */
function urgency(a, b) {
  return (a.outcome === "passed") - (b.outcome === "passed") || a.share - b.share || a.number - b.number;
}

const COMPARE = {
  urgency,
  number: (a, b) => a.number - b.number,
  share: (a, b) => a.share - b.share || a.number - b.number,
  name: (a, b) => a.name.localeCompare(b.name) || a.number - b.number,
  wall: (a, b) => b.wall - a.wall || a.number - b.number,
};

const KEYS = {
  folder: (row) => [row.folder],
  tag: (row) => (row.tags.length ? row.tags : ["no tag"]),
  file: (row) => [row.file],
  cause: (row) => [row.cause || "passed"],
};

/**
 * @typedef {{name: string, rows: any[], counts: Record<string, number>}} Group
 * @param {any[]} rows @param {(matches: any[], groups: Group[] | null) => void} show
 */
export function startQuery(rows, show) {
  const search = document.querySelector("#search input");
  const order = document.querySelector("#order select"), grouping = document.querySelector("#group select");
  const outcomes = [...document.querySelectorAll("#outcomes button")];
  const causes = [...document.querySelectorAll("#causes button")];

  const pressed = (buttons, key) =>
    buttons.filter((button) => button.getAttribute("aria-pressed") === "true").map((button) => button.dataset[key]);

  function refresh() {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kinds = pressed(outcomes, "outcome"), groups = pressed(causes, "cause");
    const matches = rows.filter((row) =>
      (!kinds.length || kinds.includes(row.outcome)) && (!groups.length || groups.includes(row.cause))
      && words.every((word) => row.words.includes(word)));
    matches.sort(COMPARE[order.value] ?? urgency);
    remember(words, kinds, groups);
    show(matches, KEYS[grouping.value] ? grouped(matches, KEYS[grouping.value]) : null);
  }

  function remember(words, kinds, groups) {
    const query = new URLSearchParams();
    if (words.length) query.set("search", words.join(" "));
    kinds.forEach((kind) => query.append("outcome", kind));
    groups.forEach((group) => query.append("cause", group));
    if (order.value !== "urgency") query.set("sort", order.value);
    if (grouping.value) query.set("group", grouping.value);
    history.replaceState(null, "", query.size ? `#${query}` : location.pathname + location.search);
  }

  function recall() {
    const query = new URLSearchParams(location.hash.slice(1));
    search.value = query.get("search") ?? "";
    order.value = COMPARE[query.get("sort")] ? query.get("sort") : "urgency";
    grouping.value = KEYS[query.get("group")] ? query.get("group") : "";
    for (const [buttons, key] of [[outcomes, "outcome"], [causes, "cause"]]) {
      const chosen = query.getAll(key);
      buttons.forEach((button) => button.setAttribute("aria-pressed", String(chosen.includes(button.dataset[key]))));
    }
  }

  for (const button of [...outcomes, ...causes]) {
    button.addEventListener("click", () => {
      button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
      refresh();
    });
  }
  for (const button of document.querySelectorAll("[data-search]")) {
    button.addEventListener("click", () => {
      search.value = button.dataset.search;
      refresh();
      document.getElementById("cases").scrollIntoView();
    });
  }
  search.addEventListener("input", refresh);
  order.addEventListener("change", refresh);
  grouping.addEventListener("change", refresh);
  addEventListener("hashchange", () => { recall(); refresh(); });
  recall();
  refresh();
}

/** Rows by a key of which a row may have several; groups with failures first. */
function grouped(rows, keysOf) {
  const found = new Map();
  for (const row of rows) {
    for (const name of keysOf(row)) {
      const group = found.get(name) ?? { name, rows: [], counts: {} };
      group.rows.push(row);
      group.counts[row.outcome] = (group.counts[row.outcome] ?? 0) + 1;
      found.set(name, group);
    }
  }
  const good = (group) => (group.counts.passed ?? 0) === group.rows.length;
  return [...found.values()].sort((a, b) => good(a) - good(b) || a.name.localeCompare(b.name));
}

/** A bar whose parts are as long as the outcomes are frequent. @param {Record<string, number>} counts */
export function outcomeBar(counts) {
  const present = ORDER.filter((name) => counts[name]);
  const text = present.map((name) => `${counts[name]} ${name}`).join(", ");
  return element("span.outcomes", { role: "img", "aria-label": text, title: text },
    ...present.map((name) => element(`i.${name}`, { style: `flex-grow:${counts[name]}` })));
}
