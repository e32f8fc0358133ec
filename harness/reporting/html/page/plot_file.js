// Plots as files: what is drawn on the canvas, as a picture or as SVG.

import { element } from "./dom.js";

const SHARPNESS = 2; // pixels of a PNG in one of CSS

/** Offer a file to the reader. @param {string} address of its content @param {string} name */
export function download(address, name) {
  element("a", { href: address, download: name }).click();
}

/** @param {any} panel of the plots */
export function savePng({ plot, data }) {
  download(plot.pictureOf(plot.canvas.clientWidth, plot.canvas.clientHeight, SHARPNESS), `${data.title}.png`);
}

/** @param {any} panel of the plots */
export function saveSvg({ plot, data }) {
  const { clientWidth, clientHeight } = plot.canvas;
  const pen = new SvgPen(clientWidth, clientHeight);
  plot.paint(pen, clientWidth, clientHeight);
  const text = pen.text(data.unit ? `${data.title} [${data.unit}]` : data.title);
  download(`data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`, `${data.title}.svg`);
}

const NAMESPACE = ["http:", "", "www.w3.org", "2000", "svg"].join("/"); // a name, which nothing fetches
const ANCHORS = { left: "start", center: "middle", right: "end" };
const BASELINES = { top: "hanging", middle: "central", alphabetic: "auto" };

/** What plots use of a canvas's pen, written down as SVG. */
export class SvgPen {
  /** @param {number} width @param {number} height in CSS pixels */
  constructor(width, height) {
    Object.assign(this, { width, height, parts: [], path: "", dash: "", clipped: 0, lineWidth: 1, textAlign: "left", textBaseline: "alphabetic" });
  }

  /** The whole file. @param {string} title */
  text(title) {
    const head = `<svg xmlns="${NAMESPACE}" viewBox="0 0 ${this.width} ${this.height}" width="${this.width}" height="${this.height}">`;
    return `${head}<title>${escaped(title)}</title>${this.parts.join("\n")}${"</g>".repeat(this.clipped)}</svg>\n`;
  }

  setTransform() {}
  save() {}

  restore() {
    if (this.clipped) this.parts.push("</g>");
    this.clipped = 0;
  }

  beginPath() {
    this.path = "";
  }

  moveTo(x, y) {
    this.path += `M${short(x)} ${short(y)}`;
  }

  lineTo(x, y) {
    this.path += `L${short(x)} ${short(y)}`;
  }

  rect(x, y, width, height) {
    this.path = `M${short(x)} ${short(y)}h${short(width)}v${short(height)}h${short(-width)}z`;
  }

  clip() {
    this.clipped = 1;
    this.parts.push(`<clipPath id="inside"><path d="${this.path}"/></clipPath><g clip-path="url(#inside)">`);
  }

  stroke() {
    this.parts.push(`<path d="${this.path}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"${this.dash}/>`);
  }

  fillRect(x, y, width, height) {
    this.parts.push(`<rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}" fill="${this.fillStyle}"/>`);
  }

  fillText(text, x, y) {
    const place = `x="${short(x)}" y="${short(y)}" text-anchor="${ANCHORS[this.textAlign]}" dominant-baseline="${BASELINES[this.textBaseline]}"`;
    this.parts.push(`<text ${place} font-family="system-ui, sans-serif" font-size="11" fill="${this.fillStyle}">${escaped(text)}</text>`);
  }

  setLineDash(lengths) {
    this.dash = lengths.length ? ` stroke-dasharray="${lengths.join(" ")}"` : "";
  }
}

function short(value) {
  return Number(value.toFixed(2));
}

function escaped(text) {
  return String(text).replace(/[&<>"]/g, (character) => `&#${character.charCodeAt(0)};`);
}
