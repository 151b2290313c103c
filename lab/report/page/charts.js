// Curves and stacked bars as SVG.
relume.scale = function (values, low, high, logarithmic) {
  let from = Math.min(...values);
  let to = Math.max(...values);
  if (!Number.isFinite(from)) [from, to] = logarithmic ? [1, 10] : [0, 1];
  const transform = logarithmic ? Math.log10 : (x) => x;
  if (!logarithmic) from = Math.min(from, 0);
  let a = transform(from);
  let b = transform(to);
  if (b - a < 1e-9) [a, b] = [a - 0.5, b + 0.5];
  const margin = 0.04 * (b - a);
  b += margin;
  if (logarithmic || from < 0) a -= margin;
  const scale = (x) => low + ((transform(x) - a) / (b - a)) * (high - low);
  scale.ticks = [];
  if (logarithmic) {
    const few = b - a < 1.6;
    for (let e = Math.floor(a); e <= Math.ceil(b); ++e) {
      for (let m = 1; m < 10; ++m) {
        const x = m * 10 ** e;
        if (transform(x) < a || transform(x) > b) continue;
        scale.ticks.push({ x, major: m === 1, text: m === 1 || (few && (m === 2 || m === 5)) ? relume.tick(x) : "" });
      }
    }
  } else {
    const raw = (b - a) / 6;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw);
    for (let x = Math.ceil(a / step) * step; x <= b; x += step) scale.ticks.push({ x, major: true, text: relume.tick(Number(x.toPrecision(6))) });
  }
  return scale;
};

relume.tick = function (x) {
  if (x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5)) {
    const exponent = Math.floor(Math.log10(Math.abs(x)) + 1e-9);
    const digits = String(exponent).replace(/[-\d]/g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
    const mantissa = Number((x / 10 ** exponent).toPrecision(2));
    return mantissa === 1 ? `10${digits}` : `${mantissa}·10${digits}`;
  }
  return String(x);
};

relume.drawAxes = function (chart, x, y, box) {
  const axis = relume.draw("g", { class: "axis" });
  for (const tick of x.ticks) {
    axis.append(relume.draw("line", { x1: x(tick.x), x2: x(tick.x), y1: box.top, y2: box.bottom, class: tick.major ? "" : "minor" }));
    if (tick.text) axis.append(relume.draw("text", { x: x(tick.x), y: box.bottom + 20, "text-anchor": "middle", text: tick.text }));
  }
  for (const tick of y.ticks) {
    axis.append(relume.draw("line", { x1: box.left, x2: box.right, y1: y(tick.x), y2: y(tick.x), class: tick.major ? "" : "minor" }));
    if (tick.text) axis.append(relume.draw("text", { x: box.left - 8, y: y(tick.x) + 4, "text-anchor": "end", text: tick.text }));
  }
  axis.append(relume.draw("rect", { class: "frame", x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top }));
  axis.append(relume.draw("text", { class: "label", x: (box.left + box.right) / 2, y: box.bottom + 44, "text-anchor": "middle", text: chart.x_label }));
  axis.append(relume.draw("text", { class: "label", x: box.left, y: box.top - 12, text: chart.y_label }));
  return axis;
};

relume.drawCurve = function (curve, chart, x, y) {
  const group = relume.draw("g", { style: `--dot: ${relume.color(curve.color)}`, "data-curve": curve.name });
  const visible = curve.points.filter((p) => p[0] !== null && p[1] !== null && (!chart.log_x || p[0] > 0) && (!chart.log_y || p[1] > 0));
  const band = visible.filter((p) => p.length > 3 && p[2] !== null && p[3] !== null && (!chart.log_y || p[2] > 0));
  if (band.length > 1) {
    const upper = band.map((p) => `${x(p[0]).toFixed(1)},${y(p[3]).toFixed(1)}`);
    const lower = band.map((p) => `${x(p[0]).toFixed(1)},${y(p[2]).toFixed(1)}`).reverse();
    group.append(relume.draw("path", { class: "band", d: `M${upper.concat(lower).join("L")}Z` }));
  }
  group.append(relume.draw("path", { class: curve.dashed ? "curve dashed" : "curve", d: visible.length ? `M${visible.map((p) => `${x(p[0]).toFixed(1)},${y(p[1]).toFixed(1)}`).join("L")}` : "" }));
  if (!curve.dashed && visible.length <= 60) for (const p of visible) group.append(relume.draw("circle", { class: "point", cx: x(p[0]), cy: y(p[1]), r: 3.4 }));
  return group;
};

/// One chart; returns a function that draws it with some curves hidden.
relume.drawChart = function (host, chart, hidden) {
  const width = Math.max(420, Math.min(1100, host.clientWidth || 900));
  const height = Math.round(Math.min(460, Math.max(300, width * 0.45)));
  const box = { left: 74, right: width - 18, top: 34, bottom: height - 56 };
  const curves = chart.curves.filter((curve) => !hidden.has(curve.name));
  const points = curves.flatMap((curve) => curve.points);
  const positive = (v, log) => v !== null && Number.isFinite(v) && (!log || v > 0);
  const x = relume.scale(points.map((p) => p[0]).filter((v) => positive(v, chart.log_x)), box.left, box.right, chart.log_x);
  const y = relume.scale(points.flatMap((p) => [p[1], p[2], p[3]]).filter((v) => v !== undefined && positive(v, chart.log_y)), box.bottom, box.top, chart.log_y);
  const svg = relume.draw("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${chart.y_label} against ${chart.x_label}; the table below has the numbers` });
  svg.append(relume.drawAxes(chart, x, y, box));
  for (const curve of curves) svg.append(relume.drawCurve(curve, chart, x, y));
  const cursor = relume.draw("line", { class: "cursor", y1: box.top, y2: box.bottom, visibility: "hidden" });
  svg.append(cursor);
  const tip = relume.make("div", { class: "tip", hidden: true });
  svg.addEventListener("pointermove", (event) => {
    const bounds = svg.getBoundingClientRect();
    const at = ((event.clientX - bounds.left) / bounds.width) * width;
    const rows = curves.map((curve) => [curve, curve.points.reduce((best, p) => (best === null || Math.abs(x(p[0]) - at) < Math.abs(x(best[0]) - at) ? p : best), null)]).filter((row) => row[1]);
    if (!rows.length) return;
    const nearest = rows.reduce((a, b) => (Math.abs(x(a[1][0]) - at) <= Math.abs(x(b[1][0]) - at) ? a : b))[1];
    cursor.setAttribute("x1", x(nearest[0]));
    cursor.setAttribute("x2", x(nearest[0]));
    cursor.setAttribute("visibility", "visible");
    tip.replaceChildren(relume.make("table", {}, ...rows.map(([curve, p]) => relume.make("tr", {},
      relume.make("td", {}, relume.dot(curve.color), curve.name), relume.make("td", { text: relume.format(p[0]) }), relume.make("td", { text: relume.format(p[1]) })))));
    tip.hidden = false;
    const left = (x(nearest[0]) / width) * bounds.width;
    tip.style.left = left > bounds.width * 0.6 ? `${left - tip.offsetWidth - 12}px` : `${left + 12}px`;
    tip.style.top = "44px";
  });
  svg.addEventListener("pointerleave", () => {
    tip.hidden = true;
    cursor.setAttribute("visibility", "hidden");
  });
  host.replaceChildren(svg, tip);
};

relume.chartTable = function (chart) {
  const rows = chart.curves.flatMap((curve) => curve.points.map((p) => relume.make("tr", {},
    relume.make("th", { scope: "row", text: curve.name }), relume.make("td", { text: relume.format(p[0]) }), relume.make("td", { text: relume.format(p[1]) }))));
  return relume.make("div", { class: "scroll" }, relume.make("table", {},
    relume.make("thead", {}, relume.make("tr", {}, relume.make("th", { text: "curve" }), relume.make("th", { text: chart.x_label }), relume.make("th", { text: chart.y_label }))),
    relume.make("tbody", {}, ...rows)));
};

relume.blocks.chart = function (block) {
  const section = relume.section(block, "chart-block");
  const host = relume.make("div", { class: "chart" });
  const legend = relume.make("div", { class: "legend", role: "group", "aria-label": "Curves shown" });
  const table = relume.make("details", { toggle: () => fillTable() }, relume.make("summary", { text: "Values as a table" }));
  const hidden = new Set();
  let current = 0;
  const fillTable = () => {
    while (table.children.length > 1) table.lastChild.remove();
    if (table.open) table.append(relume.chartTable(block.charts[current]));
  };
  const redraw = () => relume.drawChart(host, block.charts[current], hidden);
  const show = (index) => {
    current = index;
    legend.replaceChildren(...block.charts[index].curves.map((curve) => {
      const button = relume.make("button", { type: "button", "aria-pressed": String(!hidden.has(curve.name)), click: () => {
        hidden.has(curve.name) ? hidden.delete(curve.name) : hidden.add(curve.name);
        button.setAttribute("aria-pressed", String(!hidden.has(curve.name)));
        redraw();
      } }, relume.dot(curve.color), curve.name);
      return button;
    }));
    redraw();
    fillTable();
  };
  if (block.charts.length > 1) section.append(relume.make("div", { class: "bar" }, relume.choice("Chart", block.charts.map((c) => c.label), 0, show)));
  section.append(legend, host, table);
  relume.whenSized(host, redraw);
  show(0);
  return section;
};

/// Calls `redraw` when the width of `host` changes.
relume.whenSized = function (host, redraw) {
  let width = 0;
  new ResizeObserver(() => {
    if (Math.abs(host.clientWidth - width) < 2) return;
    width = host.clientWidth;
    redraw();
  }).observe(host);
};

relume.drawBars = function (host, block, names) {
  const colors = relume.distinctColors(names.length);
  const width = Math.max(420, Math.min(1100, host.clientWidth || 900));
  const left = Math.min(190, 30 + 8 * Math.max(...block.bars.map((bar) => bar.name.length)));
  const row = 46;
  const largest = Math.max(...block.bars.map((bar) => bar.parts.reduce((sum, part) => sum + part[1], 0)), 1e-12);
  const scale = (width - left - 90) / largest;
  const svg = relume.draw("svg", { class: "bars", viewBox: `0 0 ${width} ${block.bars.length * row + 6}`, role: "img", "aria-label": `${block.title}; the table below has the numbers` });
  block.bars.forEach((bar, i) => {
    const y = i * row + 6;
    svg.append(relume.draw("text", { x: left - 10, y: y + 22, "text-anchor": "end", text: bar.name }));
    let x = left;
    for (const [name, value] of bar.parts) {
      const w = value * scale;
      const rect = relume.draw("rect", { x, y, width: Math.max(w, 0.5), height: 32, rx: 2, style: `fill: ${colors[names.indexOf(name)]}`, "data-part": name },
        relume.draw("title", { text: `${bar.name}, ${name}: ${relume.format(value)} ${block.unit}` }));
      svg.append(rect);
      x += w;
    }
    const total = bar.parts.reduce((sum, part) => sum + part[1], 0);
    svg.append(relume.draw("text", { class: "num", x: x + 8, y: y + 22, text: `${relume.format(total)} ${block.unit}` }));
  });
  host.replaceChildren(svg);
};

relume.blocks.bars = function (block) {
  const section = relume.section(block, "bars-block");
  const totals = new Map();
  for (const bar of block.bars) for (const [name, value] of bar.parts) totals.set(name, (totals.get(name) || 0) + value);
  const names = [...totals.keys()].sort((a, b) => totals.get(b) - totals.get(a));
  const colors = relume.distinctColors(names.length);
  const host = relume.make("div", { class: "chart" });
  const legend = relume.make("div", { class: "legend" }, ...names.map((name, i) => relume.make("span", { class: "key" }, relume.coloredDot(colors[i]), name)));
  const head = relume.make("tr", {}, relume.make("th", { text: "" }), ...names.map((name) => relume.make("th", { text: name })));
  const rows = block.bars.map((bar) => relume.make("tr", {}, relume.make("th", { scope: "row", text: bar.name }),
    ...names.map((name) => relume.make("td", { class: "value", text: relume.format((bar.parts.find((part) => part[0] === name) || [])[1]) }))));
  section.append(legend, host, relume.make("details", {}, relume.make("summary", { text: "Values as a table" }),
    relume.make("div", { class: "scroll" }, relume.make("table", {}, relume.make("thead", {}, head), relume.make("tbody", {}, ...rows)))));
  relume.whenSized(host, () => relume.drawBars(host, block, names));
  relume.drawBars(host, block, names);
  return section;
};
