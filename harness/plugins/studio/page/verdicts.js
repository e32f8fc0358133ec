// The verdicts: what is decided with its margin, and how what is not decided stands.

import { on } from "./connection.js";
import { $, element } from "./dom.js";

const OPEN = { passed: "holds so far", failed: "does not hold yet", "not reached": "waits for its step" };

on("verdicts", (message) => {
  const decided = message.verdicts.filter((v) => !v.open).length;
  const head = element("div", { class: `outcome ${message.outcome}`, title: message.digest, "data-digest": message.digest },
    message.digest ? `${message.outcome} · digest ${message.digest.slice(0, 16)}`
      : message.outcome ? `${message.outcome}; only a whole run has a digest`
        : `${decided} of ${message.verdicts.length} expectations are decided`);
  const margin = (v) => (v.margin === null ? "" : ` (margin ${Number(v.margin.toPrecision(3))} ${v.unit})`);
  if (!message.outcome && !message.verdicts.length) head.textContent = "";
  $("verdicts").replaceChildren(head,
    ...message.steps.map((step) => element("div", { class: `verdict ${step.status.replace(/[ _]/g, "-")}` }, `${step.line}: ${step.summary}: ${step.status.replace("_", " ")}`)),
    ...message.verdicts.map((v) => element("div", { class: `verdict ${v.open ? "open" : v.status.replace(/[ _]/g, "-")}` },
      `${v.line}: ${v.text}: ${v.open ? OPEN[v.status] ?? "open" : v.status}${margin(v)}${v.reason && v.status !== "passed" && !v.open ? `: ${v.reason}` : ""}`)));
});
