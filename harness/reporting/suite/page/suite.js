// Filters, sorts and groups the rows that the page already has. The address keeps the query.

(() => {
  const body = document.querySelector("tbody");
  const rows = [...body.rows];
  const search = document.querySelector("#search input");
  const order = document.querySelector("#order select");
  const outcomes = [...document.querySelectorAll("#filters button")];
  const causes = [...document.querySelectorAll("#causes button")];
  const count = document.getElementById("count");

  const pressed = (buttons, key) =>
    buttons.filter((button) => button.getAttribute("aria-pressed") === "true").map((button) => button.dataset[key]);

  /** @param {HTMLElement} row whether it matches the query */
  function isMatch(row, words, kinds, groups) {
    return (!kinds.length || kinds.includes(row.dataset.outcome))
      && (!groups.length || groups.includes(row.dataset.cause))
      && words.every((word) => row.dataset.words.includes(word));
  }

  const compare = {
    index: (a, b) => a.dataset.index - b.dataset.index,
    share: (a, b) => a.dataset.share - b.dataset.share,
    time: (a, b) => b.dataset.time - a.dataset.time,
    name: (a, b) => a.dataset.name.localeCompare(b.dataset.name),
    cause: (a, b) => (a.dataset.cause === "") - (b.dataset.cause === "") || a.dataset.cause.localeCompare(b.dataset.cause),
  };

  /** A heading over the rows of one cause. @param {string} cause @param {number} number */
  function heading(cause, number) {
    const row = document.createElement("tr");
    row.className = "group";
    const cell = row.insertCell();
    cell.colSpan = document.querySelectorAll("thead th").length;
    cell.textContent = `${cause || "passed"} (${number})`;
    return row;
  }

  function show() {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kinds = pressed(outcomes, "outcome"), groups = pressed(causes, "cause");
    const key = compare[order.value] ? order.value : "index";
    const matches = rows.filter((row) => isMatch(row, words, kinds, groups));
    matches.sort((a, b) => compare[key](a, b) || compare.index(a, b));
    const shown = [];
    for (const row of matches) {
      if (key === "cause" && row.dataset.cause !== shown.at(-1)?.dataset.cause) {
        shown.push(heading(row.dataset.cause, matches.filter((each) => each.dataset.cause === row.dataset.cause).length));
      }
      shown.push(row);
    }
    body.replaceChildren(...shown);
    count.textContent = matches.length === rows.length ? `${rows.length}` : `${matches.length} of ${rows.length}`;
    remember(words, kinds, groups, key);
  }

  function remember(words, kinds, groups, key) {
    const query = new URLSearchParams();
    if (words.length) query.set("search", words.join(" "));
    kinds.forEach((kind) => query.append("outcome", kind));
    groups.forEach((group) => query.append("cause", group));
    if (key !== "index") query.set("sort", key);
    history.replaceState(null, "", query.size ? `#${query}` : location.pathname + location.search);
  }

  function recall() {
    const query = new URLSearchParams(location.hash.slice(1));
    search.value = query.get("search") ?? "";
    order.value = compare[query.get("sort")] ? query.get("sort") : "index";
    for (const [buttons, key] of [[outcomes, "outcome"], [causes, "cause"]]) {
      const chosen = query.getAll(key);
      buttons.forEach((button) => button.setAttribute("aria-pressed", String(chosen.includes(button.dataset[key]))));
    }
  }

  for (const button of [...outcomes, ...causes]) {
    button.addEventListener("click", () => {
      button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
      show();
    });
  }
  for (const button of document.querySelectorAll("[data-rate]")) {
    button.addEventListener("click", () => {
      search.value = button.dataset.rate;
      show();
      body.closest("section").scrollIntoView();
    });
  }
  search.addEventListener("input", show);
  order.addEventListener("change", show);
  addEventListener("hashchange", () => { recall(); show(); });
  document.body.classList.add("scripted");
  document.documentElement.dataset.ready = "yes";
  recall();
  show();
})();
