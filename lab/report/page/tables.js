// Text, tables, claims, details, and the page as a whole.
relume.blocks.text = function (block) {
  const section = relume.section(block, "lead");
  if (block.points && block.points.length) section.append(relume.make("ul", {}, ...block.points.map((point) => relume.make("li", {}, ...relume.prose(point)))));
  return section;
};

relume.cell = function (cell, isBest) {
  const td = relume.make("td", { class: `${cell.value === undefined && cell.text !== "–" ? "text" : "value"}${isBest ? " best" : ""}` }, cell.text);
  if (isBest) td.append(relume.make("span", { class: "visually-hidden", text: " (best)" }));
  const words = cell.note ? cell.note.split(" ") : [];
  if (cell.note) td.append(relume.make("span", { class: "note" }, ...words.flatMap((word, i) => [i > 0 ? " " : "", relume.make("span", { text: word })])));
  return td;
};

/// Indices of the rows with the best value of a column.
relume.bestRows = function (block, column) {
  if (!block.columns[column].better || block.columns[column].better === "none") return [];
  const values = block.rows.map((row) => (row.plain ? undefined : row.cells[column].value)).map((v) => (v === null ? undefined : v));
  const known = values.filter((v) => v !== undefined);
  if (known.length < 2) return [];
  const best = block.columns[column].better === "lower" ? Math.min(...known) : Math.max(...known);
  const rows = values.flatMap((v, i) => (v === best ? [i] : []));
  return rows.length === known.length ? [] : rows;
};

relume.blocks.table = function (block) {
  const section = relume.section(block, "table-block");
  const body = relume.make("tbody", {});
  const best = block.columns.map((_, column) => relume.bestRows(block, column));
  const rows = block.rows.map((row, i) => relume.make("tr", {},
    relume.make("th", { scope: "row" }, row.color === undefined ? null : relume.dot(row.color), row.name),
    ...row.cells.map((cell, column) => relume.cell(cell, best[column].includes(i)))));
  body.append(...rows);
  const heads = block.columns.map((column, index) => {
    const button = relume.make("button", { type: "button", text: column.title, click: () => {
      const descending = th.getAttribute("aria-sort") === "ascending";
      heads.forEach((head) => head.removeAttribute("aria-sort"));
      th.setAttribute("aria-sort", descending ? "descending" : "ascending");
      const key = (i) => (block.rows[i].cells[index].value ?? Infinity) * (descending ? -1 : 1);
      const known = (i) => Number.isFinite(key(i));
      const order = rows.map((_, i) => i).sort((a, b) => known(b) - known(a) || (known(a) && key(a) - key(b)) || a - b);
      body.append(...order.map((i) => rows[i]));
    } });
    const th = relume.make("th", { scope: "col", title: column.help }, button);
    return th;
  });
  section.append(relume.make("div", { class: "scroll" }, relume.make("table", {},
    relume.make("thead", {}, relume.make("tr", {}, relume.make("th", { scope: "col", text: block.row_title || "" }), ...heads)), body)));
  const explained = block.columns.filter((column) => column.help);
  if (explained.length) section.append(relume.make("details", {}, relume.make("summary", { text: "What the columns mean" }),
    relume.make("ul", {}, ...explained.map((column) => relume.make("li", {}, relume.make("b", { text: column.title }), `: ${column.help}`)))));
  return section;
};

relume.blocks.claims = function (block) {
  const section = relume.section(block, "claims-block");
  const kinds = { holds: "holds", "does not hold": "fails" };
  const rows = block.claims.map((claim) => relume.make("tr", { "data-claim": claim.id },
    relume.make("th", { scope: "row" }, claim.id, relume.make("div", { class: "note subtitle", text: claim.paper })),
    relume.make("td", {}, ...relume.prose(claim.claim)),
    relume.make("td", {}, ...relume.prose(claim.measured)),
    relume.make("td", {}, ...relume.prose(claim.threshold)),
    relume.make("td", {}, relume.make("span", { class: `verdict ${kinds[claim.verdict] || "open"}`, text: claim.verdict }))));
  section.append(relume.make("div", { class: "scroll" }, relume.make("table", { class: "claims" },
    relume.make("thead", {}, relume.make("tr", {}, ...["claim", "statement", "measured", "holds if", "verdict"].map((text) => relume.make("th", { scope: "col", text })))),
    relume.make("tbody", {}, ...rows))));
  return section;
};

relume.blocks.details = function (block) {
  const section = relume.section(block, "details-block");
  if (block.pairs && block.pairs.length) section.append(relume.make("div", { class: "scroll" }, relume.make("table", {}, relume.make("tbody", {},
    ...block.pairs.map(([name, value]) => relume.make("tr", {}, relume.make("th", { scope: "row", text: name }), relume.make("td", { class: "text" }, ...relume.prose(value))))))));
  for (const part of block.parts || []) section.append(relume.make("details", {}, relume.make("summary", { text: part.title }), relume.make("pre", { text: part.text })));
  return section;
};

relume.blocks.links = function (block) {
  const section = relume.section(block, "links-block");
  section.append(relume.make("ul", {}, ...block.links.map((link) => relume.make("li", {}, relume.make("a", { href: link.href, text: link.text }), link.note ? ` – ${link.note}` : null))));
  return section;
};

relume.setTheme = function (choice) {
  if (choice === "auto") document.documentElement.removeAttribute("data-theme");
  else document.documentElement.setAttribute("data-theme", choice);
  document.querySelectorAll("[data-theme-choice]").forEach((button) => button.setAttribute("aria-pressed", String(button.dataset.themeChoice === choice)));
  try {
    localStorage.setItem("relume-theme", choice);
  } catch (refused) {
    // Some browsers keep no storage for files; the choice then lasts as long as the page.
  }
};

relume.start = function () {
  const page = JSON.parse(document.getElementById("page-data").textContent);
  document.getElementById("page-title").textContent = page.title;
  document.getElementById("page-subtitle").textContent = page.subtitle;
  const main = document.getElementById("content");
  const nav = document.getElementById("page-nav");
  page.blocks.forEach((block, i) => {
    block.id = `part-${i + 1}`;
    main.append(relume.blocks[block.kind](block));
    if (block.title && page.blocks.length > 2) nav.append(relume.make("a", { href: `#${block.id}`, text: block.title }));
  });
  document.querySelectorAll("[data-theme-choice]").forEach((button) => button.addEventListener("click", () => relume.setTheme(button.dataset.themeChoice)));
  let theme = "auto";
  try {
    theme = localStorage.getItem("relume-theme") || "auto";
  } catch (refused) {
    // As above.
  }
  relume.setTheme(["auto", "light", "dark"].includes(theme) ? theme : "auto");
  document.documentElement.setAttribute("data-ready", "");
};

relume.start();
