// Keys and mouse over the image, the same as in the window.

const FLY = {
  KeyD: ["x", 1], KeyA: ["x", -1], KeyE: ["y", 1], KeyQ: ["y", -1], KeyS: ["z", 1], KeyW: ["z", -1],
};
const PRESS = {
  Space: "pause", Home: "home", KeyB: "split", KeyO: "orbit", KeyF: "frame", KeyP: "animate", BracketLeft: "darker",
  BracketRight: "brighter",
};
const REPEAT_MS = 300;
const HANDLE_PX = 8;
const WHEEL_PX = 100;

export const KEYS = [
  ["drag", "orbit, or look around (O switches)"], ["right drag, Shift + drag", "move parallel to the image"],
  ["wheel", "orbit: nearer or farther; fly: speed"], ["W A S D, Q E", "fly; Shift: faster"],
  ["F", "frame the whole scene"], ["O", "orbit or fly"], ["Home", "the scene's camera"],
  ["1 … 9", "go to a bookmark; with Shift: store it"], ["Space, P", "pause rendering; play the animation"],
  ["B", "compare A and B; drag the line"], ["[ ]", "exposure"], ["F9", "image as PNG"],
];

export class Input {
  /// `area()`: rectangle of the image on the page. `split()`: position of the line, or null.
  constructor(link, canvas, { area, split, screenshot }) {
    Object.assign(this, { link, canvas, area, split, screenshot });
    this.held = new Set();
    this.fast = false;
    this.moves = { turn: [0, 0], pan: [0, 0], notches: 0 };
    this.drag = null;
    addEventListener("keydown", (event) => this.key(event, true));
    addEventListener("keyup", (event) => this.key(event, false));
    addEventListener("blur", () => this.release());
    setInterval(() => this.held.size && this.fly(), REPEAT_MS);
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", () => { this.drag = null; });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  key(event, pressed) {
    const edits = event.target.matches?.("input, select, textarea");
    if (edits && pressed) return;
    if (event.key === "Shift") {
      this.fast = pressed;
      if (this.held.size) this.fly();
    }
    if (FLY[event.code] && !event.ctrlKey && !event.altKey && !event.metaKey) {
      const before = this.held.size;
      const had = this.held.has(event.code);
      if (pressed) this.held.add(event.code); else this.held.delete(event.code);
      if (had !== this.held.has(event.code) || before !== this.held.size) this.fly();
      return;
    }
    if (pressed && !event.repeat && !event.ctrlKey && !event.altKey && !event.metaKey) this.command(event);
  }

  command(event) {
    const onButton = event.target.matches?.("button, summary") && event.code === "Space";
    const digit = /^Digit([1-9])$/.exec(event.code);
    if (digit) {
      this.link.input({ do: "bookmark", verb: event.shiftKey ? "store" : "go", slot: Number(digit[1]) - 1 });
    } else if (event.code === "F9") {
      this.screenshot();
    } else if (PRESS[event.code] && !onButton) {
      this.link.input({ do: "press", button: PRESS[event.code] });
    } else {
      return;
    }
    event.preventDefault();
  }

  release() {
    if (!this.held.size) return;
    this.held.clear();
    this.fly();
  }

  fly() {
    const axes = { x: 0, y: 0, z: 0 };
    for (const code of this.held) axes[FLY[code][0]] += FLY[code][1];
    this.link.input({ do: "fly", ...axes, fast: this.fast });
  }

  down(event) {
    this.canvas.focus();
    this.canvas.setPointerCapture(event.pointerId);
    const area = this.area();
    const line = this.split() === null ? Infinity : area.left + this.split() * area.width;
    const pans = event.button !== 0 || event.shiftKey;
    this.drag = !pans && Math.abs(event.clientX - line) < HANDLE_PX ? "split" : pans ? "pan" : "turn";
    this.last = [event.clientX, event.clientY];
    event.preventDefault();
  }

  move(event) {
    if (!this.drag) return;
    const area = this.area();
    if (this.drag === "split") {
      this.moves.split = Math.min(1, Math.max(0, (event.clientX - area.left) / area.width));
    } else {
      this.moves[this.drag][0] += (event.clientX - this.last[0]) / area.height;
      this.moves[this.drag][1] += (event.clientY - this.last[1]) / area.height;
    }
    this.last = [event.clientX, event.clientY];
  }

  wheel(event) {
    event.preventDefault();
    const scale = [1, 16, 400][event.deltaMode] ?? 1;
    this.moves.notches -= event.deltaY * scale / WHEEL_PX;
  }

  /// Sends the moves since the last call: once per frame of the page.
  flush() {
    const clamped = (value, most) => Math.min(most, Math.max(-most, value));
    for (const kind of ["turn", "pan"]) {
      const [x, y] = this.moves[kind];
      if (x || y) this.link.input({ do: "drag", pan: kind === "pan", x: clamped(x, 10), y: clamped(y, 10) });
    }
    if (this.moves.notches) this.link.input({ do: "wheel", notches: clamped(this.moves.notches, 50) });
    if (this.moves.split !== undefined) this.link.input({ do: "split-at", at: this.moves.split });
    this.moves = { turn: [0, 0], pan: [0, 0], notches: 0 };
  }
}
