// Images side by side or in place, with one pan and zoom; maps of the error; values under the cursor; crops.
relume.Viewer = class {
  constructor(block) {
    this.block = block;
    this.section = relume.section(block, "viewer-block");
    this.layout = "grid";
    this.layer = block.layers[0].label;
    this.current = 0;
    this.last = 0;
    this.zoom = 0; // image pixels to CSS pixels; 0: fit
    this.center = null;
    this.pixel = null;
    this.pinned = false;
    this.ownCrops = [];
    this.build();
    this.showView(0);
    relume.viewers.push(this);
  }

  build() {
    const { make, choice } = relume;
    this.layoutChoice = choice("Layout", ["Side by side", "In place"], 0, (i) => this.setLayout(i === 0 ? "grid" : "single"));
    this.layerChoice = choice("Layer", this.block.layers.map((l) => l.label), 0, (i) => this.setLayer(i));
    this.imageBar = make("span", { class: "bar", style: "margin: 0", role: "group", "aria-label": "Image shown in place" });
    const zoomButton = (text, label, action) => make("button", { type: "button", text, "aria-label": label, "data-action": label, click: action });
    const zoomBar = make("span", { class: "group", role: "group", "aria-label": "Zoom" },
      zoomButton("−", "Zoom out", () => this.zoomBy(1 / 1.5)), zoomButton("Fit", "Fit", () => this.fit()),
      zoomButton("1:1", "One to one", () => this.zoomTo(1)), zoomButton("+", "Zoom in", () => this.zoomBy(1.5)));
    this.zoomText = make("output", { class: "num subtitle", "aria-label": "Zoom" });
    const bar = make("div", { class: "bar" });
    if (this.block.views.length > 1) {
      const select = make("select", { "data-action": "view", change: () => this.showView(select.selectedIndex) }, ...this.block.views.map((view) => make("option", { text: view.label })));
      bar.append(make("label", {}, "View ", select));
    }
    bar.append(this.layoutChoice, this.layerChoice, zoomBar, this.zoomText);
    this.ramp = make("span", { class: "ramp" });
    this.panes = make("div", { class: "panes" });
    this.frame = make("div", { class: "viewer", tabindex: "0", role: "group", "aria-label": "Images. Keys: 1 to 9 choose an image, G side by side, M next layer, arrows move, plus and minus zoom, F fits." }, this.panes);
    this.status = make("p", { class: "visually-hidden", role: "status" });
    this.inspector = make("div", { class: "inspector" });
    this.crops = make("div", { class: "crops" });
    const cropButton = make("button", { type: "button", text: "Add the visible part", "data-action": "Add crop", click: () => this.addCrop() });
    this.section.append(bar, make("div", { class: "bar" }, this.imageBar, this.ramp), this.frame, this.status,
      make("div", { class: "under" },
        make("div", {}, make("h3", { text: "Values" }), this.inspector),
        make("div", {}, make("div", { class: "bar" }, make("h3", { text: "Crops", style: "margin: 0" }), cropButton), this.crops)),
      relume.keyHelp());
    this.frame.addEventListener("pointerdown", () => (relume.activeViewer = this));
    this.frame.addEventListener("focus", () => (relume.activeViewer = this));
    new ResizeObserver(() => this.resize()).observe(this.panes);
  }

  showView(index) {
    const before = this.view;
    this.view = this.block.views[index];
    if (before && (before.width !== this.view.width || before.height !== this.view.height)) {
      this.zoom = 0;
      this.center = this.pixel = null;
      this.pinned = false;
      this.ownCrops = [];
    }
    this.view.decoded = this.view.decoded || this.view.images.map((p) => new relume.PageImage(p));
    this.images = this.view.decoded;
    this.current = Math.min(this.current, this.images.length - 1);
    if (!this.center) this.center = [this.view.width / 2, this.view.height / 2];
    const { make } = relume;
    this.imageButtons = this.images.map((item, i) => make("button", { type: "button", "data-image": item.name, click: () => this.choose(i) }, relume.dot(item.color), i < 9 ? `${i + 1}  ${item.name}` : item.name));
    this.imageBar.replaceChildren(...this.imageButtons);
    this.paneList = this.images.map((item, i) => this.makePane(item, i));
    this.panes.replaceChildren(...this.paneList.map((pane) => pane.figure));
    this.setLayout(this.layout);
    this.showCrops();
    this.inspect();
  }

  makePane(item, index) {
    const { make } = relume;
    const canvas = make("canvas", { role: "img", "aria-label": item.name });
    const caption = make("figcaption", {}, make("span", {}, relume.dot(item.color), item.name, index < 9 ? make("kbd", { text: String(index + 1) }) : null), item.note ? make("span", { class: "num", text: item.note }) : null);
    const figure = make("figure", { class: "pane", style: "margin: 0", "data-pane": item.name }, canvas, caption);
    const pane = { figure, canvas, item };
    this.listen(pane);
    return pane;
  }

  listen(pane) {
    const canvas = pane.canvas;
    const pointers = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      pane.moved = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return this.hover(pane, event);
      const dx = event.clientX - before[0];
      const dy = event.clientY - before[1];
      const apart = () => {
        const [a, b] = [...pointers.values()];
        return Math.hypot(a[0] - b[0], a[1] - b[1]);
      };
      const distance = pointers.size === 2 ? apart() : 0;
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      pane.moved += Math.abs(dx) + Math.abs(dy);
      pane.figure.classList.add("dragging");
      const scale = this.scale();
      this.center = [this.center[0] - dx / scale / pointers.size, this.center[1] - dy / scale / pointers.size];
      if (pointers.size === 2 && distance > 0) this.zoom = this.limit((scale * apart()) / distance);
      this.redraw();
    });
    const release = (event) => {
      if (pointers.has(event.pointerId) && event.type === "pointerup" && pane.moved < 4) {
        this.pinned = false;
        this.hover(pane, event);
        this.pinned = true;
        this.inspect();
      }
      pointers.delete(event.pointerId);
      pane.figure.classList.remove("dragging");
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("pointerleave", () => !pointers.size && this.redraw());
    canvas.addEventListener("dblclick", () => (this.pinned = false));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoomAround(this.toImage(pane, event), Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0016)));
    }, { passive: false });
  }

  fitScale() {
    const canvas = this.visiblePanes()[0].canvas;
    return Math.min(canvas.clientWidth / this.view.width, canvas.clientHeight / this.view.height) || 1;
  }
  scale() { return this.zoom || this.fitScale(); }
  limit(zoom) { return Math.min(64, Math.max(Math.min(this.fitScale() * 0.5, 1), zoom)); }

  /// Image coordinates under the pointer.
  toImage(pane, event) {
    const bounds = pane.canvas.getBoundingClientRect();
    return [this.center[0] + (event.clientX - bounds.left - bounds.width / 2) / this.scale(), this.center[1] + (event.clientY - bounds.top - bounds.height / 2) / this.scale()];
  }

  zoomAround(point, factor) {
    const before = this.scale();
    this.zoom = this.limit(before * factor);
    const kept = before / this.zoom;
    this.center = [point[0] + (this.center[0] - point[0]) * kept, point[1] + (this.center[1] - point[1]) * kept];
    this.redraw();
  }
  zoomBy(factor) { this.zoomAround(this.center, factor); }
  zoomTo(scale) { this.zoomBy(scale / this.scale()); }
  fit() {
    this.zoom = 0;
    this.center = [this.view.width / 2, this.view.height / 2];
    this.redraw();
  }
  moveBy(dx, dy) {
    this.center = [this.center[0] + dx / this.scale(), this.center[1] + dy / this.scale()];
    this.redraw();
  }

  setLayout(layout) {
    this.layout = layout;
    this.layoutChoice.querySelectorAll("button").forEach((button, i) => button.setAttribute("aria-pressed", String((i === 0) === (layout === "grid"))));
    this.imageBar.hidden = false;
    this.choose(this.current, layout === "grid");
  }

  /// Shows one image in place of the others.
  choose(index, keepLayout) {
    if (index >= this.images.length) return;
    if (index !== this.current) this.last = this.current;
    this.current = index;
    if (!keepLayout && this.layout === "grid") return this.setLayout("single");
    this.imageButtons.forEach((button, i) => button.setAttribute("aria-pressed", String(this.layout === "single" && i === index)));
    this.paneList.forEach((pane, i) => (pane.figure.hidden = this.layout === "single" && i !== index));
    if (this.layout === "single") this.status.textContent = `${this.images[index].name}, ${this.layer}`;
    this.resize();
  }

  setLayer(index) {
    const layer = this.block.layers[index];
    this.layer = layer.label;
    this.layerChoice.querySelectorAll("button").forEach((button, i) => button.setAttribute("aria-pressed", String(i === index)));
    this.ramp.replaceChildren(...(layer.ramp ? [relume.make("span", { text: layer.low }), relume.make("i", { class: layer.ramp, "aria-hidden": "true" }), relume.make("span", { text: layer.high })] : []));
    this.status.textContent = this.layer;
    this.redraw();
    this.showCrops();
  }
  nextLayer() { this.setLayer((this.block.layers.findIndex((l) => l.label === this.layer) + 1) % this.block.layers.length); }

  visiblePanes() { return this.paneList.filter((pane) => !pane.figure.hidden); }

  resize() {
    const count = this.visiblePanes().length;
    const width = this.panes.clientWidth;
    if (!width) return;
    const aspect = this.view.height / this.view.width;
    const most = Math.max(240, window.innerHeight * 0.8);
    let columns = count === 1 ? 1 : Math.min(count, Math.max(1, Math.floor(width / 330)));
    if (count > columns) columns = Math.ceil(count / Math.ceil(count / columns));
    const height = Math.min(most, ((width - 8 * (columns - 1)) / columns) * aspect);
    this.panes.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    for (const pane of this.visiblePanes()) {
      pane.figure.style.height = `${height}px`;
      pane.canvas.width = Math.round(pane.figure.clientWidth * devicePixelRatio);
      pane.canvas.height = Math.round(height * devicePixelRatio);
    }
    this.drawAll();  // at once, since the new size has cleared the canvases
  }

  drawAll() {
    for (const pane of this.visiblePanes()) this.draw(pane);
    this.zoomText.textContent = `${Math.round(this.scale() * 100)} %`;
  }

  /// Soon, and once however often it is called.
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.drawAll();
    });
  }

  draw(pane) {
    const context = pane.canvas.getContext("2d");
    const ratio = devicePixelRatio;
    const scale = this.scale() * ratio;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, pane.canvas.width, pane.canvas.height);
    context.setTransform(scale, 0, 0, scale, pane.canvas.width / 2 - this.center[0] * scale, pane.canvas.height / 2 - this.center[1] * scale);
    context.imageSmoothingEnabled = scale < 1.5;
    context.imageSmoothingQuality = "high";
    const image = pane.item.image(this.layer, () => this.redraw());
    if (image) context.drawImage(image, 0, 0);
    if (!this.pixel) return;
    const size = Math.max(1, 9 / scale);
    const x = this.pixel[0] + 0.5 - size / 2;
    const y = this.pixel[1] + 0.5 - size / 2;
    for (const [color, line] of [["#000c", 3], [this.pinned ? "#ffd23f" : "#fff", 1.4]]) {
      context.strokeStyle = color;
      context.lineWidth = (line * ratio) / scale;
      context.strokeRect(x, y, size, size);
    }
  }

  hover(pane, event) {
    if (this.pinned) return;
    const [x, y] = this.toImage(pane, event).map(Math.floor);
    const inside = x >= 0 && y >= 0 && x < this.view.width && y < this.view.height;
    this.pixel = inside ? [x, y] : null;
    this.inspect();
    this.redraw();
  }

  inspect() {
    const { make, format } = relume;
    if (!this.pixel) {
      this.inspector.replaceChildren(make("p", { class: "subtitle", text: "Point at an image to read linear radiance; click to pin a pixel, double-click to release it. Enter pins the pixel in the centre." }));
      return;
    }
    const [x, y] = this.pixel;
    const values = this.images.map((item) => item.value(x, y, () => this.inspect()));
    const luminance = (v) => 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
    const reference = values[this.view.reference];
    const rows = this.images.map((item, i) => {
      const v = values[i];
      const cells = v ? v.map(format) : v === null ? ["left out", "", ""] : ["…", "", ""];
      const apart = v && reference && i !== this.view.reference ? `${format((100 * (luminance(v) - luminance(reference))) / (luminance(reference) + 0.01))} %` : "";
      return make("tr", {}, make("th", { scope: "row" }, relume.dot(item.color), item.name), ...cells.map((text) => make("td", { class: "value", text })), make("td", { class: "value", text: apart }));
    });
    this.inspector.replaceChildren(
      make("p", { class: "num", style: "margin: 0 0 .3rem", "data-pixel": `${x},${y}`, text: `Pixel ${x}, ${y}${this.pinned ? " (held)" : ""}` }),
      make("div", { class: "scroll" }, make("table", {}, make("thead", {}, make("tr", {}, ...["", "R", "G", "B", "luminance off by"].map((text) => make("th", { text })))), make("tbody", {}, ...rows))));
  }
  pinCenter() {
    if (this.pinned) {
      this.pinned = false;
      this.pixel = null;
    } else {
      this.pinned = true;
      this.pixel = [Math.min(this.view.width - 1, Math.max(0, Math.floor(this.center[0]))), Math.min(this.view.height - 1, Math.max(0, Math.floor(this.center[1])))];
    }
    this.inspect();
    this.redraw();
  }

  addCrop() {
    const canvas = this.visiblePanes()[0].canvas;
    const size = Math.max(8, Math.round(Math.min(canvas.clientWidth, canvas.clientHeight) / this.scale() / 2));
    this.ownCrops.push([Math.round(this.center[0] - size / 2), Math.round(this.center[1] - size / 2), size]);
    this.showCrops();
  }

  showCrops() {
    const { make } = relume;
    const rows = this.view.crops.concat(this.ownCrops).map((crop) => make("div", { class: "crop" }, ...this.images.map((item) => make("figure", {}, this.makeShot(item, crop), make("figcaption", { text: item.name })))));
    this.crops.replaceChildren(...rows);
  }

  makeShot(item, [x, y, size]) {
    const { make } = relume;
    const canvas = make("canvas", { width: 184, height: 184 });
    const paint = () => {
      const image = item.image(this.layer, paint);
      if (!image) return;
      const context = canvas.getContext("2d");
      context.imageSmoothingEnabled = false;
      context.drawImage(image, x, y, size, size, 0, 0, 184, 184);
    };
    paint();
    return make("button", { type: "button", class: "shot", "aria-label": `Zoom to ${item.name} at ${x}, ${y}`, click: () => {
      this.center = [x + size / 2, y + size / 2];
      const shown = this.visiblePanes()[0].canvas;
      this.zoom = this.limit(Math.min(shown.clientWidth, shown.clientHeight) / size);
      this.redraw();
    } }, canvas);
  }

  /// Whether the key meant something.
  key(key) {
    const step = 60;
    const actions = {
      g: () => this.setLayout("grid"), m: () => this.nextLayer(), f: () => this.fit(), "+": () => this.zoomBy(1.5), "=": () => this.zoomBy(1.5),
      "-": () => this.zoomBy(1 / 1.5), o: () => this.zoomTo(1), Enter: () => this.pinCenter(), " ": () => this.choose(this.last),
      ArrowLeft: () => this.moveBy(-step, 0), ArrowRight: () => this.moveBy(step, 0), ArrowUp: () => this.moveBy(0, -step), ArrowDown: () => this.moveBy(0, step),
    };
    if (/^[1-9]$/.test(key) && Number(key) <= this.images.length) this.choose(Number(key) - 1);
    else if (actions[key]) actions[key]();
    else return false;
    return true;
  }
};

relume.keyHelp = function () {
  const { make } = relume;
  const keys = [["1 … 9", "image, in place"], ["Space", "previous image"], ["G", "side by side"], ["M", "next layer"], ["+ −", "zoom"], ["F", "fit"], ["O", "one to one"], ["← ↑ → ↓", "move"], ["Enter", "pin a pixel"], ["wheel, drag", "zoom, move"]];
  return make("details", {}, make("summary", { text: "Keys and mouse" }), make("ul", { class: "keys" }, ...keys.map(([key, text]) => make("li", {}, make("kbd", { text: key }), ` ${text}`))));
};

/// Keys that scroll or press something elsewhere count only while the images have the focus.
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || !relume.viewers.length) return;
  const target = event.target;
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
  const viewer = relume.activeViewer || relume.viewers[0];
  const moves = event.key.startsWith("Arrow") || event.key === " " || event.key === "Enter";
  if (moves && target !== viewer.frame) return;
  if (viewer.key(event.key.length === 1 ? event.key.toLowerCase() : event.key)) event.preventDefault();
});

relume.blocks.viewer = (block) => new relume.Viewer(block).section;
