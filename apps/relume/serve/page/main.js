// The page of `relume serve`: connects, shows frames, and passes input on.

import { Input } from "./input.js";
import { Link } from "./link.js";
import { Settings } from "./settings.js";
import { Rate, showTimes, statusLine } from "./timing.js";
import { Views } from "./views.js";

const SETTLE_MS = 200;
const STORE = "relume-token";

/// The token of the address's fragment. It is kept for reloads of this tab, and leaves the address bar.
function takeToken() {
  const given = location.hash.slice(1);
  if (!given) return sessionStorage.getItem(STORE) ?? "";
  sessionStorage.setItem(STORE, given);
  history.replaceState(null, "", location.pathname);
  return given;
}

const canvas = document.getElementById("image");
const context = canvas.getContext("2d");
const link = new Link(takeToken());
const state = { role: null, status: null, values: null, frame: null, pending: null, frames: 0, changed: 0 };
const received = new Rate();
const drawn = new Rate();
const arrived = [];

function screenshot() {
  link.send({ do: "screenshot" });
}

/// Rectangle of the image within the canvas.
function area() {
  const box = canvas.getBoundingClientRect();
  const scale = Math.min(box.width / canvas.width, box.height / canvas.height);
  const [width, height] = [canvas.width * scale, canvas.height * scale];
  return { left: box.left + (box.width - width) / 2, top: box.top + (box.height - height) / 2, width, height };
}

const split = () => (state.status?.split ? state.status.split_at : null);
const views = new Views(link, screenshot);
const settings = new Settings(link, document.getElementById("settings"));
const input = new Input(link, canvas, { area, split, screenshot });

const texts = {
  role: (role) => {
    state.role = role;
    views.showRole(role);
    if (role.viewer === role.steerer) sendSize();
  },
  notice: (notice) => views.tell(notice.text),
  declarations: (declarations) => settings.declare(declarations),
  values: (values) => {
    state.values = values;
    settings.show(values);
    views.showBuffers(values.buffers, state.status?.buffer ?? "");
  },
  status: (status) => {
    state.status = status;
    document.title = status.scene ? `relume ${status.scene}` : "relume";
    settings.split(status.split);
    views.showStatus(status);
    if (state.values) views.showBuffers(state.values.buffers, status.buffer);
    showTimes(status, settings.side, rates());
    document.getElementById("status").textContent = statusLine(status);
  },
};

function rates() {
  const now = performance.now();
  while (arrived.length && now - arrived[0].at > 1000) arrived.shift();
  return {
    received: received.hz, drawn: drawn.hz, level: state.frame?.level ?? 0, latency: link.latencies.at(-1) ?? null,
    bytesPerSecond: arrived.reduce((sum, { bytes }) => sum + bytes, 0),
  };
}

link.addEventListener("text", ({ detail }) => texts[detail.kind]?.(detail));
link.addEventListener("state", ({ detail }) => views.showState(detail));
link.addEventListener("frame", async ({ detail: frame }) => {
  received.count();
  arrived.push({ at: performance.now(), bytes: frame.bytes });
  try {
    frame.bitmap = await createImageBitmap(frame.blob);
  } finally {
    link.acknowledge(frame);
  }
  if (state.pending && state.pending.number > frame.number) return frame.bitmap.close();
  state.pending?.bitmap.close();
  state.pending = frame;
});
link.addEventListener("png", ({ detail }) => {
  const address = URL.createObjectURL(detail.blob);
  const anchor = document.createElement("a");
  anchor.href = address;
  const scene = (state.status?.scene ?? "image").split("/").pop().replace(/\.[^.]*$/, "");
  anchor.download = `relume-${scene}.png`;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
});

/// Draws the newest frame. Runs at the rate of the screen.
function draw() {
  drawn.count();
  input.flush();
  const frame = state.pending;
  if (frame) {
    state.pending = null;
    // A frame with fewer pixels covers the same area.
    if (canvas.width !== frame.width || canvas.height !== frame.height) Object.assign(canvas, { width: frame.width, height: frame.height });
    context.drawImage(frame.bitmap, 0, 0, frame.width, frame.height);
    frame.bitmap.close();
    state.frame = frame;
    state.frames += 1;
    link.shown(frame.input);
  }
  const at = split();
  const divider = document.getElementById("divider");
  divider.hidden = at === null;
  if (at !== null) divider.style.left = `${area().left - canvas.getBoundingClientRect().left + at * area().width}px`;
  requestAnimationFrame(draw);
}

function sendSize() {
  const box = document.getElementById("viewport").getBoundingClientRect();
  const size = (length) => Math.max(1, Math.min(16384, Math.round(length * devicePixelRatio)));
  link.send({ do: "resize", width: size(box.width), height: size(box.height) });
}

let settles = 0;
new ResizeObserver(() => {
  clearTimeout(settles);
  settles = setTimeout(sendSize, SETTLE_MS);
}).observe(document.getElementById("viewport"));

// For tests.
globalThis.relume = { link, state, rates };

link.open();
requestAnimationFrame(draw);
