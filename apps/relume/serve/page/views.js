// Buttons, buffers, bookmarks, messages, and who steers.

import { KEYS } from "./input.js";

const TOLD_MS = 5000;

/// A new element. Attributes: "text" sets its text; false leaves an attribute out.
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "text") element.textContent = value;
    else if (value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children);
  return element;
}

const byId = (id) => document.getElementById(id);

/// Updates the children of `element` to match the items. Children with the same key are reused, so a change of the list
/// keeps the focus and a held mouse button. `create` makes a child, `refresh` shows what may change in it.
function arrange(element, items, { key, create, refresh = () => {} }) {
  const old = new Map([...element.children].map((child) => [child.dataset.key, child]));
  const uses = new Map();
  const children = items.map((item) => {
    const use = uses.get(key(item)) ?? 0; // of equal keys
    uses.set(key(item), use + 1);
    const name = `${key(item)}\n${use}`;
    const child = old.get(name) ?? create(item);
    old.delete(name);
    child.dataset.key = name;
    refresh(child, item);
    return child;
  });
  for (const child of old.values()) child.remove();
  children.forEach((child, i) => {
    if (element.children[i] !== child) element.insertBefore(child, element.children[i] ?? null);
  });
}

export class Views {
  constructor(link, screenshot) {
    this.link = link;
    this.reported = [];
    this.told = null;
    this.tabs();
    this.tools(screenshot);
    byId("keys").append(make("dl", {}, ...KEYS.flatMap(([key, meaning]) => [make("dt", { text: key }), make("dd", { text: meaning })])));
    this.buffers = make("div", { class: "list" });
    byId("buffers").append(this.buffers);
    this.roleText = make("span");
    this.roleButtons = make("span", { class: "role-buttons" });
    byId("steering").append(this.roleText, this.roleButtons);
    this.bookmarks = make("div", { class: "list" });
    const store = this.button("Store this view", () => this.link.input({ do: "bookmark", verb: "store", slot: 63 }));
    this.place = make("p");
    byId("camera").append(make("h2", { text: "Bookmarks" }), this.bookmarks, store, make("h2", { text: "Camera" }), this.place);
  }

  button(text, click, attributes = {}) {
    const button = make("button", { type: "button", text, ...attributes });
    button.addEventListener("click", click);
    return button;
  }

  tabs() {
    const names = ["settings", "buffers", "camera", "keys"];
    const choose = (name) => {
      for (const other of names) byId(other).hidden = other !== name;
      for (const tab of byId("tabs").children) tab.setAttribute("aria-selected", String(tab.dataset.tab === name));
    };
    const title = (name) => name[0].toUpperCase() + name.slice(1);
    byId("tabs").append(...names.map((name) => this.button(title(name), () => choose(name), { role: "tab", "data-tab": name, "aria-controls": name })));
    choose("settings");
  }

  tools(screenshot) {
    const press = (button, text, title) => this.button(text, () => this.link.input({ do: "press", button }), { "data-press": button, title });
    this.toggles = {
      split: press("split", "Compare A and B", "Renders two sets of settings in alternation [B]"),
      orbits: press("orbit", "Orbit", "Drag orbits the scene; otherwise it looks around [O]"),
      paused: press("pause", "Pause", "Pauses rendering [Space]"),
      animating: press("animate", "Animate", "Plays the animation [P]"),
    };
    byId("tools").append(...Object.values(this.toggles), press("home", "Scene's camera", "Returns to it [Home]"),
      press("frame", "Frame", "Frames the whole scene [F]"),
      this.button("Screenshot", screenshot, { id: "screenshot", title: "Downloads the shown image as PNG [F9]" }));
  }

  /// Buffers to inspect.
  showBuffers(buffers, chosen) {
    const all = [{ name: "", help: "Accumulated mean radiance, exposed and tone-mapped" }, ...buffers];
    arrange(this.buffers, all, {
      key: ({ name }) => name || "image",
      create: ({ name }) => this.button(name || "image", () => this.link.input({ do: "buffer", name }), { "data-buffer": name || "image" }),
      refresh: (button, { name, help }) => {
        button.title = help;
        button.setAttribute("aria-pressed", String(name === chosen));
      },
    });
  }

  /// A bookmark's slot changes when an earlier one is removed.
  showBookmarks(names) {
    arrange(this.bookmarks, names.map((name, slot) => ({ name, slot })), {
      key: ({ name }) => name,
      create: ({ name }) => {
        const pair = make("span", { class: "pair" });
        const use = (verb) => this.link.input({ do: "bookmark", verb, slot: Number(pair.firstChild.dataset.bookmark) });
        pair.append(this.button(name, () => use("go")), this.button("×", () => use("remove"), { "aria-label": `Remove ${name}` }));
        return pair;
      },
      refresh: (pair, { slot }) => { pair.firstChild.dataset.bookmark = String(slot); },
    });
  }

  showStatus(status) {
    for (const [name, button] of Object.entries(this.toggles)) button.setAttribute("aria-pressed", String(Boolean(status[name])));
    this.showBookmarks(status.bookmarks);
    const numbers = (list) => list.map((x) => x.toFixed(2)).join(", ");
    this.place.textContent = status.eye ? `eye ${numbers(status.eye)} m; speed ${status.speed.toFixed(2)} m/s` : "";
    this.reported = [...(status.preparing ?? []).map((text) => ({ text, problem: false })), ...status.messages];
    this.showMessages();
  }

  /// The lines of the last status, and the server's answer to this viewer.
  showMessages() {
    const lines = this.told ? [...this.reported, { text: this.told, problem: true }] : this.reported;
    arrange(byId("messages"), lines, {
      key: ({ text, problem }) => `${problem} ${text}`,
      create: ({ text, problem }) => make("li", { text, class: problem ? "problem" : false }),
    });
  }

  /// Shows the server's answer to this viewer at once, whether or not a status follows.
  tell(text) {
    this.told = text;
    this.showMessages();
    clearTimeout(this.telling);
    this.telling = setTimeout(() => {
      this.told = null;
      this.showMessages();
    }, TOLD_MS);
  }

  /// Who steers. Viewers that do not cannot change anything.
  showRole(role) {
    const steers = role.viewer === role.steerer;
    const others = role.viewers - 1;
    const count = others === 0 ? "" : ` ${others} other${others === 1 ? "" : "s"} watch${others === 1 ? "es" : ""}.`;
    const waits = role.requests.includes(role.viewer);
    this.roleText.textContent = (steers ? "You steer." : "Another viewer steers.") + count;
    arrange(this.roleButtons, steers ? role.requests : [role.viewer], {
      key: (viewer) => `${steers ? "grant" : "steer"} ${viewer}`,
      create: (viewer) => (steers
        ? this.button(`Let viewer ${viewer} steer`, () => this.link.send({ do: "grant", viewer }), { "data-grant": String(viewer) })
        : this.button("", () => this.link.send({ do: "steer" }), { id: "steer" })),
      refresh: (button) => {
        if (steers) return;
        button.textContent = waits ? "Asked to steer" : "Ask to steer";
        button.disabled = waits;
      },
    });
    for (const id of ["settings", "buffers", "camera"]) byId(id).inert = !steers;
    for (const button of byId("tools").querySelectorAll("[data-press]")) button.disabled = !steers;
  }

  showState(sentence) {
    byId("notice").textContent = sentence;
    byId("notice").hidden = !sentence;
  }
}
