// The table of a class: a click on a heading sorts it, and a search keeps the rows that have all its words.

const table = document.querySelector("#submissions table"), body = table.tBodies[0], rows = [...body.rows];
const heads = [...table.tHead.rows[0].cells], find = document.getElementById("find");

/** What a cell is sorted by: its number where it has one. @param {HTMLTableRowElement} row @param {number} column */
function value(row, column) {
  const cell = row.cells[column];
  return cell.dataset.value === undefined ? cell.innerText.trim().toLowerCase() : Number(cell.dataset.value);
}

/** @param {number} column */
function sort(column) {
  const isUp = heads[column].ariaSort !== "ascending";
  heads.forEach((head) => head.removeAttribute("aria-sort"));
  heads[column].ariaSort = isUp ? "ascending" : "descending";
  const compare = (a, b) => (typeof a === "number" ? a - b : a.localeCompare(b));
  body.append(...rows.sort((a, b) => (isUp ? 1 : -1) * compare(value(a, column), value(b, column))));
}

heads.forEach((head, column) => {
  const button = document.createElement("button");
  button.type = "button";
  button.append(...head.childNodes);
  button.addEventListener("click", () => sort(column));
  head.append(button);
});

const input = find.querySelector("input"), count = find.querySelector("output");
input.addEventListener("input", () => {
  const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
  for (const row of rows) row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
  count.textContent = words.length ? `${rows.filter((row) => !row.hidden).length} of ${rows.length}` : "";
});
find.hidden = false;
