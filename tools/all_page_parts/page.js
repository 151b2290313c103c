"use strict";
// Everything except the part at the end is free of the document, so that tests can run it alone.
const survey = {};

survey.isNumber = (x) => typeof x === "number" && Number.isFinite(x);

// Columns: title, value for sorting (undefined: missing), text.
survey.columns = [
  { title: "scene", value: (r) => r.scene.name, text: (r) => r.scene.name },
  { title: "technique", value: (r) => r.technique.name, text: (r) => r.technique.name },
  { title: "MSE", value: (r) => r.technique.mse, text: (r) => (survey.isNumber(r.technique.mse) ? survey.format(r.technique.mse) : survey.failure(r)) },
  { title: "/ path", value: (r) => r.relative },
  { title: "relMSE", value: (r) => r.technique.rel_mse },
  { title: "FLIP", value: (r) => r.technique.flip },
  { title: "bias²", value: (r) => r.technique.bias2, text: (r) => survey.withError(r.technique.bias2, r.technique.bias2_error) },
  { title: "variance", value: (r) => r.technique.variance },
  { title: "lag", value: (r) => survey.lag(r), text: (r) => survey.lagText(r) },
  { title: "ghosts, %", value: (r) => r.ghosts, text: (r) => survey.withError(r.ghosts, r.ghostsError) },
  { title: "rays", value: (r) => r.technique.rays },
  { title: "ms", value: (r) => r.technique.frame_ms },
  { title: "s", value: (r) => r.technique.time_s },
  { title: "MB", value: (r) => (survey.isNumber(r.technique.memory_bytes) ? r.technique.memory_bytes / 1e6 : undefined) },
];

survey.format = function (x) {
  if (!survey.isNumber(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-2 || size >= 1e4) return x.toExponential(2);
  return size < 1000 ? String(Number(x.toPrecision(3))) : x.toFixed(0);
};

survey.withError = function (value, error) {
  if (survey.isNumber(value) && survey.isNumber(error) && Math.abs(value) <= 2 * error) return "≈ 0";
  return survey.format(value);
};

// The error that ended the measurement of a technique.
survey.failure = (r) => (r.technique.failed ? `failed: ${r.technique.failed}` : "–");

// A technique that has not settled counts as one frame more than was measured.
survey.lag = (r) => (r.technique.keeps_state ? (survey.isNumber(r.technique.lag) ? r.technique.lag : r.frames + 1) : undefined);
survey.lagText = function (r) {
  if (r.technique.keeps_state) return survey.isNumber(r.technique.lag) ? String(r.technique.lag) : `> ${r.frames}`;
  return survey.isNumber(r.technique.mse) ? survey.failure(r) : "–"; // else the cell of the MSE has the error
};

survey.rows = function (data) {
  const rows = [];
  for (const scene of data.scenes) {
    const base = scene.techniques.find((t) => t.name === "path");
    for (const technique of scene.techniques) {
      const both = base && survey.isNumber(base.mse) && survey.isNumber(technique.mse) && base.mse > 0 && technique.mse > 0;
      const share = (x) => (survey.isNumber(x) && scene.mean_square > 0 ? (100 * x) / scene.mean_square : undefined);
      rows.push({
        scene, technique, frames: data.setup.frames, relative: both ? technique.mse / base.mse : undefined,
        ghosts: share(technique.ghost), ghostsError: share(technique.ghost_error),
      });
    }
  }
  return rows;
};

// Sorts a copy; missing values come last in both directions, and equal ones keep their order.
survey.sorted = function (rows, column, descending) {
  const value = survey.columns[column].value;
  const exists = (x) => typeof x === "string" || survey.isNumber(x);
  return [...rows].sort((a, b) => {
    const x = value(a);
    const y = value(b);
    if (!exists(x) || !exists(y)) return Number(exists(y)) - Number(exists(x));
    const order = typeof x === "string" ? x.localeCompare(y) : x - y;
    return descending ? -order : order;
  });
};

// `wanted`: scene, and choice by slot; "" means any.
survey.filtered = function (rows, wanted) {
  return rows.filter((r) => {
    if (wanted.scene && r.scene.name !== wanted.scene) return false;
    return Object.entries(wanted.slots).every(([slot, choice]) => !choice || r.technique.slots[slot] === choice);
  });
};

// Choices of each slot that occur, in the order of the run.
survey.choices = function (data) {
  const slots = {};
  for (const scene of data.scenes) {
    for (const technique of scene.techniques) {
      for (const [slot, choice] of Object.entries(technique.slots)) {
        slots[slot] ??= [];
        if (!slots[slot].includes(choice)) slots[slot].push(choice);
      }
    }
  }
  return slots;
};

survey.start = function (document, data) {
  const get = (id) => document.getElementById(id);
  const state = { column: 2, descending: false, wanted: { scene: data.scenes[0]?.name ?? "", slots: {} }, shown: [], chosen: null, reference: false, after: false };
  const all = survey.rows(data);

  const create = (tag, text, attributes = {}) => {
    const element = document.createElement(tag);
    element.textContent = text;
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
  };

  const showImage = () => {
    const row = state.chosen;
    if (!row) return;
    const source = state.reference ? row.scene : row.technique;
    const image = state.after ? source.image_after : source.image;
    get("shown").hidden = !image;
    get("no-image").hidden = Boolean(image);
    if (image) get("shown").src = image;
    const what = state.reference ? "reference" : row.technique.name;
    const when = state.after ? `, ${data.setup.ghost_frame} frames after the change: ${row.scene.change}` : "";
    const refused = !state.reference && row.technique.refused ? `, could not run: ${row.technique.refused}` : "";
    get("caption").textContent = `${row.scene.name}, ${what}${when}${refused}`;
    get("shown").alt = get("caption").textContent;
    get("reference").setAttribute("aria-pressed", String(state.reference));
    get("after").setAttribute("aria-pressed", String(state.after));
  };

  const mark = () => {
    [...get("table").tBodies[0].rows].forEach((tr, i) => tr.setAttribute("aria-current", String(state.shown[i] === state.chosen)));
  };

  const choose = (row) => {
    state.chosen = row;
    mark();
    showImage();
  };

  const drawHead = () => {
    const tr = document.createElement("tr");
    survey.columns.forEach((column, i) => {
      const th = create("th", "", { scope: "col", "aria-sort": i !== state.column ? "none" : state.descending ? "descending" : "ascending" });
      const button = create("button", column.title + (i !== state.column ? "" : state.descending ? " ↓" : " ↑"), { type: "button" });
      button.addEventListener("click", () => {
        state.descending = state.column === i && !state.descending;
        state.column = i;
        draw();
        get("table").tHead.rows[0].cells[i].firstChild.focus();
      });
      th.append(button);
      tr.append(th);
    });
    get("table").tHead.replaceChildren(tr);
  };

  const drawBody = () => {
    state.shown = survey.sorted(survey.filtered(all, state.wanted), state.column, state.descending);
    const body = state.shown.map((row) => {
      const tr = document.createElement("tr");
      for (const column of survey.columns) {
        const text = column.text ? column.text(row) : survey.format(column.value(row));
        const td = create("td", column.title === "technique" ? "" : text);
        // A button, so that the keyboard reaches every row.
        if (column.title === "technique") td.append(create("button", text, { type: "button" }));
        tr.append(td);
      }
      tr.addEventListener("click", () => choose(row));
      return tr;
    });
    get("table").tBodies[0].replaceChildren(...body);
  };

  const draw = () => {
    drawHead();
    drawBody();
    if (!state.shown.includes(state.chosen)) state.chosen = state.shown[0] ?? null;
    mark();
    showImage();
  };

  const addFilter = (label, names, chosen, apply) => {
    const select = document.createElement("select");
    select.append(create("option", "any", { value: "" }), ...names.map((name) => create("option", name, { value: name })));
    select.value = chosen;
    select.addEventListener("change", () => {
      apply(select.value);
      draw();
    });
    const element = create("label", `${label} `);
    element.append(select);
    get("filters").append(element);
  };

  const step = (by) => {
    if (state.shown.length === 0) return;
    const i = state.shown.indexOf(state.chosen);
    choose(state.shown[(i + by + state.shown.length) % state.shown.length]);
  };
  const toggle = (name) => {
    state[name] = !state[name];
    showImage();
  };

  addFilter("scene", data.scenes.map((s) => s.name), state.wanted.scene, (name) => (state.wanted.scene = name));
  for (const [slot, names] of Object.entries(survey.choices(data))) addFilter(slot, names, "", (name) => (state.wanted.slots[slot] = name));
  get("previous").addEventListener("click", () => step(-1));
  get("next").addEventListener("click", () => step(1));
  get("reference").addEventListener("click", () => toggle("reference"));
  get("after").addEventListener("click", () => toggle("after"));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
    const actions = { arrowleft: () => step(-1), arrowright: () => step(1), a: () => toggle("after"), r: () => toggle("reference") };
    const action = actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  });
  const machine = Object.entries(data.machine).map(([name, value]) => `${name}: ${value}`).join("; ");
  get("conditions").textContent = `${data.setup.size} pixels, ${data.setup.budget_s} s per image with every technique. ${machine}`;
  draw();
  document.documentElement.setAttribute("data-ready", "");
};

if (typeof document !== "undefined") survey.start(document, JSON.parse(document.getElementById("data").textContent));
if (typeof module !== "undefined") module.exports = survey;
