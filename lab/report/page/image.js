// An image of the page: decoded when it is first shown.
relume.PageImage = class {
  constructor(data) {
    this.name = data.name;
    this.color = data.color;
    this.note = data.note || "";
    this.layers = data.layers;
    this.values = data.values;
    this.images = new Map();
  }

  /// The decoded image of a layer, or of the first where there is none of that name; undefined until it is loaded.
  image(label, whenLoaded) {
    const layer = this.layers.find((l) => l.label === label) || this.layers[0];
    let entry = this.images.get(layer.label);
    if (!entry) {
      entry = { image: new Image(), waiting: new Set(), loaded: false };
      entry.image.onload = () => {
        entry.loaded = true;
        entry.waiting.forEach((tell) => tell());
        entry.waiting.clear();
      };
      entry.image.src = `data:image/png;base64,${layer.png}`;
      this.images.set(layer.label, entry);
    }
    if (entry.loaded) return entry.image;
    entry.waiting.add(whenLoaded);
    return undefined;
  }

  /// [R, G, B] of a pixel; undefined until the values are loaded, null if the page does not have them.
  value(x, y, whenLoaded) {
    if (!this.values) return null;
    if (!this.halves) {
      this.halves = [null, null];
      this.values.forEach((png, i) => {
        const image = new Image();
        image.onload = () => {
          const canvas = relume.make("canvas", { width: image.naturalWidth, height: image.naturalHeight });
          const context = canvas.getContext("2d", { willReadFrequently: true });
          context.drawImage(image, 0, 0);
          this.halves[i] = context.getImageData(0, 0, canvas.width, canvas.height);
          if (this.halves[0] && this.halves[1]) whenLoaded();
        };
        image.src = `data:image/png;base64,${png}`;
      });
    }
    if (!this.halves[0] || !this.halves[1]) return undefined;
    const at = 4 * (y * this.halves[0].width + x);
    return [0, 1, 2].map((c) => relume.halfToNumber((this.halves[0].data[at + c] << 8) | this.halves[1].data[at + c]));
  }
};

/// IEEE 754 binary16.
relume.halfToNumber = function (bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const mantissa = bits & 1023;
  if (exponent === 0) return sign * mantissa * 2 ** -24;
  if (exponent === 31) return mantissa ? NaN : sign * Infinity;
  return sign * (1 + mantissa / 1024) * 2 ** (exponent - 15);
};
