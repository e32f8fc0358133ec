// The verdicts: what is decided with its margin, and how what is not decided stands.

import { on } from "./connection.js";
import { $, element } from "./dom.js";
import { amount } from "./quantities.js";

const OPEN = { passed: "holds so far", failed: "does not hold yet", "not reached": "waits for its step" };

on("verdicts", (message) => {
  const decided = message.verdicts.filter((v) => !v.open).length;
  const head = element("div", { class: `outcome ${message.outcome}`, title: message.digest, "data-digest": message.digest },
    message.digest ? `${message.outcome} · digest ${message.digest.slice(0, 16)}`
      : message.outcome ? `${message.outcome}; only a whole run has a digest`
        : `${decided} of ${message.verdicts.length} expectations are decided`);
  if (!message.outcome && !message.verdicts.length) return $("verdicts").replaceChildren();
  const line = (tone, number, text, ...more) => element("div", { class: `verdict ${tone.replace(/[ _]/g, "-")}` },
    element("i", {}), element("span", {}, text), element("span", { class: "line", title: "line of the file" }, number ? `line ${number}` : ""), ...more.filter(Boolean).map((each) => element("span", {}, each)));
  $("verdicts").replaceChildren(head,
    ...message.steps.map((step) => line(step.status, step.line, step.summary)),
    ...message.verdicts.map((v) => line(v.open ? "open" : v.status, v.line, v.text,
      [v.open ? OPEN[v.status] ?? "open" : v.status, v.margin === null ? "" : `margin ${amount(v.margin, v.unit)}`].filter(Boolean).join(", "),
      v.reason && v.status !== "passed" && !v.open && v.reason)));
});
