// The scenario's text: marked mistakes, completion and descriptions, all of them from the program.

import { request, on } from "./connection.js";
import { $, element } from "./dom.js";

/* global ace */
let editor = null, session = null, timer = 0, setting = false, sent = null, stepLines = [], done = 0;
export const SUFFIX = ".scenario.yaml";
const STAND_IN = { none: "There is no robot yet: correct the marked lines.", robot: "The robot alone, until the marked lines are correct." };

export const text = () => editor.getValue();
export const line = () => editor.getCursorPosition().row + 1;

function showSaved(isSaved) {
  $("file").classList.toggle("unsaved", !isSaved);
  document.body.classList.toggle("unsaved-work", !isSaved);
}

function theme() {
  const dark = document.documentElement.dataset.theme === "dark" || matchMedia("(prefers-color-scheme: dark)").matches;
  editor.setTheme(dark ? "ace/theme/tomorrow_night" : "ace/theme/textmate");
}

export function start() {
  ace.config.set("basePath", "/ace");
  ace.config.set("loadWorkerFromBlob", false);
  editor = ace.edit("editor", { mode: "ace/mode/yaml", useWorker: false, tabSize: 2, useSoftTabs: true,
    enableBasicAutocompletion: true, enableLiveAutocompletion: true, showPrintMargin: false, fontSize: 13, wrap: true });
  session = editor.session;
  theme();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", theme);
  editor.textInput.getElement().setAttribute("aria-label", "Scenario text");
  editor.completers = [{
    identifierRegexps: [/[\w./-]/],
    getCompletions: (_e, _s, at, _prefix, callback) =>
      request("complete", { text: text(), line: at.row, column: at.column }).then((reply) =>
        callback(null, (reply.options ?? []).map((each, index) => ({
          caption: each.text, value: each.kind === "key" ? `${each.text}: ` : each.text,
          meta: each.kind, docText: each.help, score: 1000 - index }))))
  }];
  editor.commands.addCommand({ name: "leave", bindKey: "Escape", exec: () => $("after-text").focus() });
  session.on("change", () => {
    if (setting) return;
    showSaved(false);
    clearTimeout(timer);
    timer = setTimeout(check, 200);
  });
  editor.on("mousemove", hover);
  editor.on("guttermousedown", (event) => {
    if (!event.domEvent.target.classList.contains("ace_gutter-cell")) return;
    toggleBreakpoint(event.getDocumentPosition().row);
    event.stop();
  });
}

export function toggleBreakpoint(row) {
  if (session.getBreakpoints()[row]) session.clearBreakpoint(row);
  else session.setBreakpoint(row);
}

/** The line before the next step with a breakpoint that is not the very next one; the last line without one. */
export function breakpoint() {
  const marked = Object.keys(session.getBreakpoints()).filter((row) => session.getBreakpoints()[row]).map((row) => Number(row) + 1);
  const steps = marked.map((line) => stepLines.filter((first) => first <= line).length - 1).filter((step) => step > done);
  return steps.length ? stepLines[Math.min(...steps)] - 1 : session.getLength();
}

async function check() {
  sent = text();
  const reply = await request("edit", { text: sent });
  if (reply.document && text() === sent) show(reply.document);
  else if (reply.error) $("problems").textContent = reply.error;
}

/** Sends a change that the page has not sent yet. */
export async function flush() {
  if (sent !== text()) { clearTimeout(timer); await check(); }
}

function show(message) {
  $("stand-in").textContent = STAND_IN[message.scene] ?? "";
  stepLines = message.step_lines;
  showSaved(message.is_saved);
  session.setAnnotations(message.problems.map((p) => ({ row: Math.max(0, p.line - 1), column: p.column,
    text: p.hint ? `${p.text}\n${p.hint}` : p.text, type: "error" })));
  for (const id of Object.keys(session.getMarkers())) if (session.getMarkers()[id].clazz === "mistake") session.removeMarker(id);
  const Range = ace.require("ace/range").Range;
  for (const p of message.problems) {
    if (p.line) session.addMarker(new Range(p.line - 1, p.column - 1, p.line - 1, p.column - 1 + p.length), "mistake", "text");
  }
  $("problems").replaceChildren(...message.problems.map((p) => element("button", { class: "mistake-line",
    onclick: () => { if (p.line) editor.gotoLine(p.line, p.column - 1); editor.focus(); } },
  `${p.line ? `${p.line}:${p.column}: ` : ""}${p.text}${p.hint ? ` (${p.hint})` : ""}`)));
}

let hovering = 0;
function hover(event) {
  clearTimeout(hovering);
  const at = event.getDocumentPosition();
  hovering = setTimeout(async () => {
    const reply = await request("hover", { text: text(), line: at.row, column: at.column });
    editor.container.title = reply.text ?? "";
  }, 250);
}

export function showDone(count) {
  done = count;
  stepLines.forEach((first, index) => session[index < count ? "addGutterDecoration" : "removeGutterDecoration"](first - 1, "done"));
  for (let row = 0; row < session.getLength(); row++) {
    if (!stepLines.slice(0, count).includes(row + 1)) session.removeGutterDecoration(row, "done");
  }
}

on("document", (message) => {
  if (!editor) return;
  if (text() !== message.text) {
    setting = true;
    const at = editor.getCursorPosition();
    session.setValue(message.text);
    editor.moveCursorToPosition(at);
    setting = false;
  }
  sent = message.text;
  if (document.activeElement !== $("file")) $("file").value = message.file.replace(SUFFIX, "");
  $("file").title = message.file;
  show(message);
});
