// The page of a suite: its rows, what narrows them down, and the map of what varies.

import { drawCampaign } from "./campaign.js";
import { copying } from "./comparing.js";
import { unpack } from "./payload.js";
import { startQuery } from "./query.js";
import { startTable } from "./table.js";

(async () => {
  const payload = await unpack(document.getElementById("data"));
  document.body.classList.add("scripted");
  const table = startTable(payload);
  startQuery(payload.run.rows, table.show);
  drawCampaign();
  document.querySelectorAll("code[data-copy]").forEach((code) => code.after(copying(code)));
  document.documentElement.dataset.ready = "yes";
})();
