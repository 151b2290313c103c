// What the parts of the page share.
"use strict";
const relume = { blocks: {}, viewers: [] };

/// An element: make("td", {class: "value", text: "3"}, child, …). Attributes that are functions listen to events.
relume.make = function (tag, attributes, ...children) {
  const svg = ["svg", "g", "path", "line", "rect", "text", "circle", "title"].includes(tag) && relume.make.svg;
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name === "text") element.textContent = value;
    else if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
};

/// The same for SVG.
relume.draw = function (tag, attributes, ...children) {
  relume.make.svg = true;
  const element = relume.make(tag, attributes, ...children);
  relume.make.svg = false;
  return element;
};

/// Text as children of an element; what stands between backquotes is code.
relume.prose = (text) => (text || "").split("`").map((part, i) => (i % 2 === 1 ? relume.make("code", { text: part }) : part));

relume.color = (index) => (index === undefined || index < 0 ? "var(--c-none)" : `var(--c${index % 9})`);
relume.dot = (index) => relume.coloredDot(relume.color(index));
relume.coloredDot = (color) => relume.make("span", { class: "dot", style: `--dot: ${color}`, "aria-hidden": "true" });

/// As many different colours: those of contenders while they last, otherwise equally spaced hues of alternating lightness,
/// in an order in which successive ones are far apart.
relume.distinctColors = function (count) {
  if (count <= 9) return Array.from({ length: count }, (_, i) => relume.color(i));
  const divisor = (a, b) => (b === 0 ? a : divisor(b, a % b));
  let step = Math.round(count * 0.382);
  while (divisor(step, count) !== 1) ++step;
  return Array.from({ length: count }, (_, i) => (i * step) % count).map((slot) => `hsl(${Math.round((360 * slot) / count)} 62% var(--hue-${slot % 2}))`);
};

/// Three significant digits: "0.0123", "1.23e-5", "1 234".
relume.format = function (x) {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-3) return x.toExponential(2).replace("e+", "e").replace("-", "−").replace("e-", "e−");
  if (size >= 1000) return Math.round(x).toLocaleString("en").replace(/,/g, "\u202f");
  return String(Number(x.toPrecision(3))).replace("-", "−");
};

/// Buttons of which one is pressed. `choose(index)` is called with the one.
relume.choice = function (label, names, index, choose) {
  const buttons = names.map((name, i) => relume.make("button", {
    type: "button", text: name, "data-choice": name, "aria-pressed": String(i === index), click: () => group.select(i),
  }));
  const group = relume.make("span", { class: "group", role: "group", "aria-label": label }, ...buttons);
  group.select = (i) => {
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(k === i)));
    choose(i);
  };
  return group;
};

relume.section = function (block, className) {
  const section = relume.make("section", { class: className, id: block.id });
  if (block.title) section.append(relume.make("h2", { text: block.title }));
  if (block.text) section.append(relume.make("p", {}, ...relume.prose(block.text)));
  return section;
};
