// Times by pass, rates, and the line over the image.

import { make } from "./views.js";

const COLORS = ["#5694d6", "#f2a65a", "#5cb88e", "#d66e8a", "#a68cdc", "#d4c862", "#60c4ce", "#be8c6a"];

function bytes(count) {
  const units = ["B", "KiB", "MiB", "GiB"];
  const unit = Math.min(units.length - 1, Math.floor(Math.log2(Math.max(count, 1)) / 10));
  return `${(count / 1024 ** unit).toFixed(unit ? 1 : 0)} ${units[unit]}`;
}

/// Rate of events over the last second.
export class Rate {
  constructor() {
    this.times = [];
  }

  count(now = performance.now()) {
    this.times.push(now);
    while (now - this.times[0] > 1000) this.times.shift();
  }

  get hz() {
    const now = performance.now();
    return this.times.filter((time) => now - time <= 1000).length;
  }
}

/// Shows the times of a side, and the page's own rates.
export function showTimes(status, side, page) {
  const times = status.times[Math.min(side, status.times.length - 1)];
  const table = document.getElementById("passes");
  table.replaceChildren(...times.passes.map(({ name, ms }, i) => {
    const mark = make("i");
    mark.style.background = COLORS[i % COLORS.length];
    return make("tr", {}, make("td", {}, mark, name), make("td", { text: `${ms.toFixed(2)} ms` }));
  }));
  drawGraph(times.frames_ms, 1000 / status.target_hz);
  const rows = {
    frames: `${status.frames_per_s.toFixed(1)} per second`, received: `${page.received} per second`,
    interface: `${page.drawn} Hz`, latency: page.latency === null ? "–" : `${page.latency.toFixed(0)} ms`,
    link: `${bytes(page.bytesPerSecond)}/s, level ${page.level}`, rays: `${((status.rays_per_s ?? 0) * 1e-6).toFixed(2)} M per second`,
    memory: bytes(status.bytes ?? 0),
  };
  document.getElementById("numbers").replaceChildren(...Object.entries(rows).flatMap(([name, value]) => [make("dt", { text: name }), make("dd", { text: value })]));
}

function drawGraph(frames, target) {
  const canvas = document.getElementById("graph");
  const scale = devicePixelRatio;
  canvas.width = canvas.clientWidth * scale;
  canvas.height = canvas.clientHeight * scale;
  const context = canvas.getContext("2d");
  context.scale(scale, scale);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const top = 1.1 * Math.max(1.2 * target, ...frames);
  const bar = width / 120;
  context.fillStyle = COLORS[0];
  frames.forEach((ms, i) => context.fillRect(width - bar * (frames.length - i), height * (1 - ms / top), Math.max(bar - 0.5, 1), height * ms / top));
  const line = height * (1 - target / top);
  context.fillStyle = "rgb(255 255 255 / 45%)";
  context.fillRect(0, line, width, 1);
  context.font = "11px system-ui, sans-serif";
  context.fillText(`${target.toFixed(1)} ms`, 4, Math.max(12, line - 3));
  context.textAlign = "right";
  context.fillText(top < 1000 ? `${top.toPrecision(3)} ms` : `${(top / 1000).toPrecision(3)} s`, width - 4, 12);
}

/// The line over the image.
export function statusLine(status) {
  if (!status.width) return "";
  const percent = Math.round(100 * status.width / Math.max(status.full_width, 1));
  const samples = status.samples < 10 ? Number(status.samples.toFixed(1)) : Math.round(status.samples);
  const parts = [`${status.width}×${status.height}${percent < 100 ? ` (${percent} %)` : ""}`, `${samples} sample${samples === 1 ? "" : "s"} per pixel`,
    `${status.frames_per_s.toFixed(1)} frames/s`];
  if (status.paused) parts.push("paused");
  if (status.done) parts.push("done");
  if (status.shown_buffer) parts.push(status.shown_buffer);
  return parts.join("  ·  ");
}
