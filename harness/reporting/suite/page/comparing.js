// The commands of a case: to run it again, and to compare its run with that of another case.

import { element } from "./dom.js";

/** @param {any} row @returns {(HTMLElement | string)[]} what runs it again; of a run of a search what shows the same failure, if it failed */
export function runCommand({ file, case: name, again, options, link }) {
  const words = ["harness", ...(again ?? ["run", file, ...(name ? ["--case", name] : []), ...options])];
  if (again) return again.length ? ["the smallest change that fails in this way: ", command(words)] : [];
  return [link ? "" : "no report was kept; this writes one: ", command(words)];
}

/** @param {any} row @param {any[]} rows of the page @returns {HTMLElement | null} a button that opens the choice of another case; null where a run is missing */
export function comparing(row, rows) {
  const isPossible = row.report && rows.some((each) => each.report && each !== row);
  return isPossible ? element("button.compare", { type: "button", onclick: ({ target }) => target.replaceWith(choice(row, rows)) }, "compare with…") : null;
}

/** Another case, of ten thousand perhaps, and the command. */
function choice(row, rows) {
  const others = rows.filter((each) => each.report && each !== row).sort((a, b) => distance(row, a) - distance(row, b));
  const place = element("span");
  const show = (other) => place.replaceChildren(command(["harness", "compare", other.report, row.report]));
  const list = element("select", { "aria-label": `compare ${row.name} with`, onchange: ({ target }) => show(others[target.selectedIndex]) },
    ...others.map(({ name, outcome }) => element("option", {}, `${name} (${outcome})`)));
  show(others[0]);
  return element("div.compared", {}, "compare with ", list, place);
}

/** Cases of the same file come first, then those that share most words of title, tags and folder; of equals the ones that passed. */
function distance(row, other) {
  const words = ({ name, tags, folder }) => new Set([...tags, ...`${name} ${folder}`.toLowerCase().split(/[^\w-]+/).filter((word) => word.length > 3)]);
  const [own, others] = [words(row), words(other)];
  return (row.file === other.file ? 0 : 2 + 2 / (1 + [...own].filter((word) => others.has(word)).length)) + (other.outcome !== "passed") * 0.01;
}

/** A command for a shell, and a button that copies it. */
function command(words) {
  const code = element("code", {}, words.map((word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`)).join(" "));
  return element("span.command", {}, code, copying(code));
}

/** @param {HTMLElement} code @returns {HTMLElement} a button that copies its text */
export function copying(code) {
  const text = code.textContent;
  const button = element("button.copy", { type: "button", "aria-label": `copy ${text}`, onclick: copy }, "copy");
  return button;

  async function copy() {
    getSelection().selectAllChildren(code); // where the clipboard is refused, a key copies it
    await navigator.clipboard?.writeText(text);
    button.textContent = "copied";
  }
}
