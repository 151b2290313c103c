// The connection to the server: messages out, texts and frames in.

const PROTOCOL_SOCKET = "/socket";
const STILL_MS = 10000;
const LEAST_RETRY_MS = 250;
const MOST_RETRY_MS = 8000;
const HEADER_BYTES = 20;
const PNG = 1;
const POLICY = 1008;
const BUSY = 1013;

/// Reasons for which another attempt would fail, too.
const FINAL = {
  [POLICY]: "The server refused this page. Open the address that it printed, with its token.",
};

export class Link extends EventTarget {
  /// Events: "text" (an object by the server), "frame" and "png" ({ bytes, ... }), "state" (a sentence, or "").
  constructor(token) {
    super();
    this.token = token;
    this.number = 0;
    this.sentAt = new Map();
    this.latencies = [];
    this.retryMs = LEAST_RETRY_MS;
    setInterval(() => this.send({ do: "still" }), STILL_MS);
  }

  open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}${PROTOCOL_SOCKET}`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      socket.send(JSON.stringify({ do: "hello", token: this.token }));
    };
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => this.closed(event.code);
  }

  closed(code) {
    const final = FINAL[code];
    const sentence = final ?? (code === BUSY ? "The server has as many viewers as it permits." : "The server is not reachable.");
    this.emit("state", sentence);
    if (final) return;
    setTimeout(() => this.open(), this.retryMs);
    this.retryMs = Math.min(2 * this.retryMs, MOST_RETRY_MS);
  }

  emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  get connected() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  send(message) {
    if (this.connected) this.socket.send(JSON.stringify(message));
  }

  /// Sends input, and measures the time until a frame follows it.
  input(message) {
    this.number += 1;
    this.sentAt.set(this.number, performance.now());
    if (this.sentAt.size > 1000) this.sentAt.clear();
    this.send({ ...message, n: this.number });
    return this.number;
  }

  receive(data) {
    if (typeof data === "string") {
      this.retryMs = LEAST_RETRY_MS; // admitted: a full server closes the connection before
      this.emit("state", "");
      return this.emit("text", JSON.parse(data));
    }
    const view = new DataView(data);
    const frame = {
      number: view.getUint32(4, true), input: view.getUint32(8, true), width: view.getUint32(12, true),
      height: view.getUint32(16, true), level: view.getUint8(1), bytes: data.byteLength,
      blob: new Blob([data.slice(HEADER_BYTES)], { type: view.getUint8(0) === PNG ? "image/png" : "image/jpeg" }),
    };
    this.emit(view.getUint8(0) === PNG ? "png" : "frame", frame);
  }

  acknowledge(frame) {
    this.send({ do: "ack", frame: frame.number });
  }

  /// Records that the screen shows what follows this input.
  shown(input) {
    for (const [number, at] of this.sentAt) {
      if (number > input) continue;
      this.sentAt.delete(number);
      this.latencies.push(performance.now() - at);
    }
    this.latencies.splice(0, Math.max(0, this.latencies.length - 200));
  }
}
