// The page of `harness run --live`: which case is shown, where it stands, and what was judged.

import { request, connect, on, stop } from "./connection.js";
import { $, element } from "./dom.js";
import "./scene.js";
import "./verdicts.js";

let listed = "";

on("watch", (message) => {
  const shown = message.cases.find((each) => each.number === message.shown);
  $("clock").textContent = `${message.time.toFixed(3)} s`;
  const place = shown ? `${shown.name}: ${shown.status || `${message.steps_done} of ${message.step_count} steps; ${message.doing}`}` : "waiting for the first case";
  $("status").textContent = message.has_ended ? `The run has ended. ${place}` : place;
  const now = JSON.stringify(message.cases) + message.chosen;
  if (now !== listed) {
    listed = now;
    const names = message.cases.map((each) => [each.number, `${each.name} (${each.status || "running"})`]);
    $("case").replaceChildren(...[[0, "the latest"], ...names].map(([value, text]) => element("option", { value }, text)));
    $("case").value = message.chosen;
    $("cases").replaceChildren(...message.cases.toReversed().map((each) => element("div", { class: `entry ${each.status.replace(/ /g, "-")}` }, `${each.name}: ${each.status || "running"}`)));
  }
  if (message.has_ended) stop();
});
on("lost", () => { $("status").textContent = "The run has ended, or the connection was lost."; });
$("case").addEventListener("change", () => request("choose", { number: Number($("case").value) }));
connect();
