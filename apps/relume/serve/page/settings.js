// The panel of settings, generated from the server's declarations.

import { make } from "./views.js";

const numeric = new Set(["integer", "number"]);

export class Settings {
  constructor(link, panel) {
    Object.assign(this, { link, panel });
    this.side = 0;
    this.rows = [];
    this.values = null;
  }

  /// Builds the panel. A new connection to the same server leaves it as it is.
  declare(declarations) {
    const text = JSON.stringify(declarations);
    if (this.declared === text) return;
    this.declared = text;
    this.build(declarations);
  }

  build({ groups, essential, presets }) {
    this.rows = [];
    const all = groups.flatMap((group) => group.settings);
    this.edited = make("span", { class: "choices", role: "group", "aria-label": "Edited side" });
    for (const [side, name] of ["edit A", "edit B"].entries()) this.edited.append(this.sideButton(side, name));
    this.edited.append(this.button("Copy A to B", "copy"), this.button("Swap", "swap"));
    this.edited.hidden = true;
    const preset = make("select", { "aria-label": "Preset" }, make("option", { value: "", text: "Apply a preset…" }),
      ...presets.map(({ name, summary }) => make("option", { value: name, text: name, title: summary })));
    preset.addEventListener("change", () => {
      if (preset.value) this.link.input({ do: "preset", side: this.side, name: preset.value });
      preset.value = "";
    });
    const search = make("input", { type: "search", placeholder: `Search ${all.length} settings`, "aria-label": "Search settings" });
    search.addEventListener("input", () => this.filter(search.value));
    const first = make("div", { class: "essential" }, ...essential.map((name) => this.row(all.find((s) => s.name === name))));
    const rest = groups.map((group) => make("details", { open: group.role === "slots", title: group.summary },
      make("summary", { text: group.title }), ...group.settings.map((setting) => this.row(setting))));
    this.panel.replaceChildren(this.edited, preset, search, first, ...rest);
    if (this.values) this.show(this.values);
  }

  sideButton(side, name) {
    const button = make("button", { type: "button", text: name, "aria-pressed": String(side === this.side) });
    button.addEventListener("click", () => this.edit(side));
    return button;
  }

  button(text, action) {
    const button = make("button", { type: "button", text });
    button.addEventListener("click", () => this.link.input({ do: "press", button: action }));
    return button;
  }

  edit(side) {
    this.side = side;
    this.edited.querySelectorAll("[aria-pressed]").forEach((b, i) => b.setAttribute("aria-pressed", String(i === side)));
    if (this.values) this.show(this.values);
  }

  /// Shows or hides the choice of the side.
  split(on) {
    if (!this.edited || this.edited.hidden === !on) return;
    this.edited.hidden = !on;
    if (!on) this.edit(0);
  }

  row(setting) {
    const widget = this.widget(setting);
    widget.dataset.setting = setting.name;
    widget.setAttribute("aria-label", setting.name);
    widget.addEventListener("change", () => this.change(setting, widget.type === "checkbox" ? String(widget.checked) : widget.value));
    const reset = make("button", { type: "button", class: "reset", text: "↺", "aria-label": `Reset ${setting.name}`, title: `Reset to ${setting.default || "empty"}` });
    reset.addEventListener("click", () => this.change(setting, setting.default));
    const element = make("div", { class: "row" }, make("label", { text: setting.name }), widget, reset);
    const help = `${setting.help}\n\n--${setting.name}: ${setting.about}; default ${setting.default || "empty"}` +
      (setting.resets ? "\nA change discards the accumulated frames." : "") + (setting.biases ? "\nSome values bias the image." : "");
    this.rows.push({ setting, widget, element, help });
    return element;
  }

  widget(setting) {
    if (setting.type === "flag") return make("input", { type: "checkbox" });
    if (setting.type === "choice") return make("select", {}, ...setting.choices.map((name) => make("option", { value: name, text: name })));
    if (!numeric.has(setting.type)) return make("input", { type: "text", spellcheck: "false" });
    const bounds = Object.fromEntries(["min", "max"].filter((key) => key in setting).map((key) => [key, String(setting[key])]));
    return make("input", { type: "number", step: setting.type === "integer" ? "1" : "any", ...bounds });
  }

  change(setting, value) {
    this.link.input({ do: "set", side: this.side, name: setting.name, value });
  }

  /// Shows the values of the edited side.
  show(values) {
    this.values = values;
    const own = values.sides[this.side];
    for (const { setting, widget, element, help } of this.rows) {
      const value = own[setting.name];
      if (widget.type === "checkbox") widget.checked = value === "true";
      else if (document.activeElement !== widget || setting.type === "choice") widget.value = value;
      const inactive = values.inactive[this.side][setting.name];
      element.classList.toggle("changed", value !== setting.default);
      element.classList.toggle("inactive", inactive !== undefined);
      element.title = inactive ? `${help}\n${inactive}` : help;
      if (setting.type !== "choice") continue;
      const refused = values.refused[this.side][setting.name] ?? {};
      for (const option of widget.options) {
        option.disabled = option.value in refused && option.value !== value;
        option.title = refused[option.value] ?? "";
      }
    }
  }

  filter(query) {
    const words = query.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { setting, element } of this.rows) {
      const text = `${setting.name} ${setting.help} ${(setting.choices ?? []).join(" ")}`.toLowerCase();
      element.hidden = !words.every((word) => text.includes(word));
    }
    for (const group of this.panel.querySelectorAll("details")) {
      group.hidden = !group.querySelector(".row:not([hidden])");
      if (words.length) group.open = true;
    }
    this.panel.querySelector(".essential").hidden = words.length > 0;
  }
}
