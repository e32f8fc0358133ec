// The table of cases. Rows are made as far as the page is scrolled.

import { comparing, runCommand } from "./comparing.js";
import { element } from "./dom.js";
import { outcomeBar } from "./query.js";

const NEARLY_USED = 90; // [%] of an allowance, from which a bar warns
const STRETCH = 100; // rows that are made at a time: two screens of them

/** @param {import("./payload.js").Payload} payload */
export function startTable(payload) {
  const body = document.querySelector("#cases tbody"), count = document.getElementById("count");
  const more = document.querySelector("#cases .more"), columns = document.querySelectorAll("#cases thead th").length;
  const total = payload.run.rows.length, pictures = new Map();
  const isOneFile = total > 1 && payload.run.rows.every(({ file, case: name, tags }) => name && file === payload.run.rows[0].file && String(tags) === String(payload.run.rows[0].tags));
  const titles = new Map();
  for (const { name } of payload.run.rows) titles.set(name, (titles.get(name) ?? 0) + 1);
  /** The title; where others have the same, with the name of its case or file. */
  const titled = (row) => (titles.get(row.name) > 1 ? `${row.name} · ${row.case || row.file.split("/").at(-1).replace(".scenario.yaml", "")}` : row.name);
  let waiting = [], folded = new Set();

  /** The address of a row's picture, which is made once. */
  function picture(name) {
    if (!pictures.has(name)) {
      pictures.set(name, URL.createObjectURL(new Blob([payload.buffer(name)], { type: "image/webp" })));
    }
    return pictures.get(name);
  }

  function show(matches, groups) {
    count.textContent = matches.length === total ? `${total}` : `${matches.length} of ${total}`;
    body.replaceChildren();
    waiting = groups ? groups.flatMap((group) => [group, ...(folded.has(group.name) ? [] : group.rows)]) : matches;
    extend();
    showHeads = () => show(matches, groups);
  }
  let showHeads = () => {};

  function extend() {
    const next = waiting.slice(0, STRETCH);
    waiting = waiting.slice(STRETCH);
    body.append(...next.map((each) => (each.rows ? heading(each) : caseRow(each))));
    more.hidden = !waiting.length;
    more.textContent = `${waiting.length} more`;
  }

  function heading(group) {
    const isOpen = !folded.has(group.name);
    const toggle = () => {
      if (isOpen) folded.add(group.name); else folded.delete(group.name);
      showHeads();
    };
    return element("tr.group", {}, element("td", { colspan: columns },
      element("button.fold", { type: "button", "aria-expanded": String(isOpen), onclick: toggle },
        element("span.name", {}, group.name), outcomeBar(group.counts),
        element("span.number", {}, `${group.counts.passed ?? 0} of ${group.rows.length} passed`))));
  }

  function caseRow(row) {
    const shown = isOneFile ? row.case : titled(row); // the title, the file and its tags are the same in every row
    const link = row.link && withSuite(row.link);
    const name = link ? element("a", { href: link }, shown) : shown;
    const still = row.picture && element("img", { src: picture(row.picture), alt: `${row.outcome === "passed" ? "the end" : "the moment that decided"}: ${row.name}`, loading: "lazy" });
    const made = element(`tr.case`, { "data-outcome": row.outcome, "data-share": row.share },
      element("td", {}, element(`i.sign.${row.outcome}`), element(row.outcome === "passed" ? "span.hidden" : "span.quiet", {}, row.outcome)),
      element("td.still", {}, link && still ? element("a", { href: link, tabindex: -1 }, still) : still),
      element("td.about", {},
        element("span.title", {}, name, ...(isOneFile ? [] : row.tags).map((tag) => element("span.tag", {}, tag))),
        element("div.quiet", {}, ...(isOneFile ? [] : breakable(row.file)), ...row.pages.map(({ name, link }) => element("a.page", { href: link }, name)), row.drawn && " ", row.drawn && element("span.drawn", {}, row.drawn), row.why ? "" : why(row)),
        row.why && why(row)),
      element("td.nearest", {}, ...(hasNearest(row) ? [allowance(row), element("div.quiet", {}, inDegrees(row.expectation))] : [element("span.quiet", {}, withoutNearest(row))])),
      payload.run.history && element("td.history", {}, spark(row.shares)),
      element("td.number", { title: `${row.simulated.toFixed(1)} s simulated` }, row.wall ? `${row.wall.toFixed(1)} s` : "–"));
    return made;
  }

  /** The cause in a line; a click shows everything that is known. */
  function why(row) {
    if (!row.why) return element("details.more-of", {}, element("summary", { "aria-label": `details of ${row.name}` }, "details"), facts(row));
    return element("details.why", {}, element("summary", {}, inDegrees(row.why)),
      ...row.details.map((text) => element("pre", {}, inDegrees(text))), facts(row));
  }

  function facts(row) {
    return element("div.facts", {}, `simulated ${row.simulated.toFixed(2)} s · seed ${row.seed}`,
      row.digest && ` · digest ${row.digest}`, " · ", ...runCommand(row), comparing(row, payload.run.rows));
  }

  return { show: watched(more, extend, show) };
}


/** The address of a run's page, which has a link back to this one. */
function withSuite(link) {
  const [path, place] = link.split("#"), depth = path.split("/").length - 1;
  if (!depth || path.startsWith("..") || !path.endsWith("report.html")) return link;
  return `${path}#${place ? `${place}&` : ""}suite=${"../".repeat(depth)}index.html`;
}

/** A path that breaks after its folders. */
function breakable(path) {
  return path.split(/(?<=\/)/).flatMap((part) => [part, element("wbr")]);
}

/** Whether a margin says something of the outcome: one that holds says nothing of a failure. */
function hasNearest({ margin, holds, outcome }) {
  return margin && (holds === (outcome === "passed"));
}

/** Why a row says nothing of a margin. */
function withoutNearest({ outcome, expects, expected, margin }) {
  if (outcome === "invalid" || outcome === "error") return "not judged";
  if (!expects) return expected ? `${expected === 1 ? "a step" : `${expected} steps`} failed as expected` : "expects nothing";
  return outcome === "failed" && margin ? "a step failed; what was judged holds" : "judged without a margin";
}

/** Angles as the pages of runs show them. @param {string} text */
function inDegrees(text) {
  return text.replace(/(?<=[\d)]) deg\b/g, "°");
}

/** How much of the allowance was used, and the margin. */
function allowance(row) {
  const margin = element("span.number", {}, inDegrees(row.margin));
  if (row.used === null) return element("span", { title: "no bar: its limit is 0, of which nothing is a share" }, margin);
  const percent = Math.round(100 * row.used);
  const tone = !row.holds ? "bad" : percent >= NEARLY_USED ? "warn" : "good";
  const text = `${percent} % of the allowance used${tone === "warn" ? ": nearly all of it" : ""}`;
  return element("span", {},
    element("span.bar", { role: "img", "aria-label": text, title: text },
      element(`i.${tone}`, { style: `width:${Math.min(100, Math.max(2, percent))}%` })), margin);
}

/**
 * Worst margins over runs, as shares of their limits; null where there are fewer than two. An expectation
 * flips in the middle of the height. Heights are square roots: what happens near the middle is what matters.
 *
 * @param {(number | null)[]} shares
 */
function spark(shares) {
  const known = [...shares.entries()].filter(([, share]) => share !== null);
  if (known.length < 2) return null;
  const make = (name, properties) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(properties)) made.setAttribute(key, value);
    return made;
  };
  const text = `worst margin in ${known.length} runs, now ${Math.round(100 * known.at(-1)[1])}% of its limit`;
  const points = known.map(([index, share]) => `${90 * index / (shares.length - 1)},${10 * (1 - Math.sign(share) * Math.sqrt(Math.abs(share)))}`).join(" ");
  const svg = make("svg", { class: "spark", role: "img", "aria-label": text, viewBox: "-2 -2 94 24", width: 90, height: 20 });
  svg.append(make("line", { x1: 0, x2: 90, y1: 10, y2: 10 }), make("polyline", { points }));
  return svg;
}

/** Makes more rows when the end of the table comes near. */
function watched(more, extend, show) {
  more.addEventListener("click", extend);
  new IntersectionObserver((seen) => seen.some((each) => each.isIntersecting) && extend(), { rootMargin: "600px" }).observe(more);
  return show;
}
