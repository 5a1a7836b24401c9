// The frame: pan and zoom to its pixels, marks to be chosen, greys to be chosen.

function startPicture() {
  const { width_px: width, height_px: height, softening, streams } = data.image;
  if (!streams.length) return;
  let { pictures } = streams[0];
  const home = byId("picture");
  const canvas = home.querySelector("canvas");
  const pen = canvas.getContext("2d");
  const regreyed = document.createElement("canvas"); // the preview in other greys than its own
  const told = home.querySelector(".readout"), scale = home.querySelector(".scale");
  let preview = null, drawn = null; // as it came, and what is drawn of it
  let levels = null; // of the preview, once they are asked for
  let wide = 1, high = 1; // of the canvas: asked of the page, each would lay it out anew
  let curve = "asinh", stops = 0;
  let zoom = 1, left = 0, top = 0, fitted = true;

  function size() {
    const ratio = globalThis.devicePixelRatio || 1;
    wide = home.clientWidth;
    high = Math.min(wide * height / width, 0.8 * globalThis.innerHeight);
    canvas.style.height = `${high}px`;
    canvas.width = Math.round(wide * ratio);
    canvas.height = Math.round(high * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (fitted) fit();
    draw();
  }

  function fit() {
    zoom = Math.min(wide / width, high / height);
    left = 0.5 * (wide - zoom * width);
    top = 0.5 * (high - zoom * height);
    fitted = true;
    canvas.style.touchAction = "pan-y";
  }

  function zoomBy(factor, x = 0.5 * wide, y = 0.5 * high) {
    const least = Math.min(wide / width, high / height);
    const next = Math.min(Math.max(zoom * factor, least), 64);
    left = x - (x - left) * next / zoom;
    top = y - (y - top) * next / zoom;
    zoom = next;
    fitted = zoom === least;
    if (fitted) fit();
    else canvas.style.touchAction = "none";
    draw();
  }

  function pan(x, y) {
    left += x;
    top += y;
    fitted = false;
    draw();
  }

  // The preview's levels undone to shares of full well, then the curve chosen.
  function regrey() {
    drawn = preview;
    if (!preview || (curve === "asinh" && stops === 0)) return;
    const top8 = Math.asinh(1 / softening);
    const curves = {
      asinh: (x) => Math.asinh(x / softening) / top8,
      linear: (x) => x,
      root: Math.sqrt,
      log: (x) => Math.log1p(1000 * x) / Math.log1p(1000),
    };
    const table = new Uint8ClampedArray(256);
    for (let k = 0; k < 256; k++) {
      const share = softening * Math.sinh(k / 255 * top8) * 2 ** stops;
      table[k] = Math.round(255 * curves[curve](Math.min(1, share)));
    }
    const own = levelsNow(), out = new ImageData(own.width, own.height);
    for (let k = 0; k < own.data.length; k += 4) {
      out.data[k] = table[own.data[k]];
      out.data[k + 1] = table[own.data[k + 1]];
      out.data[k + 2] = table[own.data[k + 2]];
      out.data[k + 3] = 255;
    }
    regreyed.width = own.width;
    regreyed.height = own.height;
    regreyed.getContext("2d").putImageData(out, 0, 0);
    drawn = regreyed;
  }

  function levelsNow() {
    if (!levels) {
      const canvas = made("canvas", { width: preview.naturalWidth, height: preview.naturalHeight });
      const own = canvas.getContext("2d", { willReadFrequently: true });
      own.drawImage(preview, 0, 0);
      levels = own.getImageData(0, 0, canvas.width, canvas.height);
    }
    return levels;
  }

  function load() {
    const place = shown.place;
    if (!pictures[place]) {
      preview = drawn = levels = null;
      canvas.dataset.frame = data.frames[place].frame;
      draw();
      return;
    }
    const image = new Image(), from = pictures;
    image.onload = () => {
      if (place !== shown.place || from !== pictures) return;
      preview = image;
      levels = null;
      regrey();
      canvas.dataset.frame = data.frames[place].frame;
      draw();
    };
    image.src = `data:image/jpeg;base64,${pictures[place]}`;
  }

  function draw() {
    pen.fillStyle = "#000000";
    pen.fillRect(0, 0, wide, high);
    if (drawn) {
      pen.imageSmoothingEnabled = zoom * width / preview.naturalWidth < 1;
      pen.drawImage(drawn, left, top, zoom * width, zoom * height);
    } else {
      pen.fillStyle = "#c9d1d8";
      pen.font = "14px sans-serif";
      pen.fillText("no picture of this frame in the page", 14, 26);
    }
    const marks = drawLayers(pen, (u, v) => [left + (u + 0.5) * zoom, top + (v + 0.5) * zoom]);
    canvas.dataset.layers = marks.join(" ");
    canvas.dataset.image = streams.find((each) => each.pictures === pictures).name;
    canvas.dataset.zoom = zoom.toFixed(4);
    canvas.setAttribute("aria-label",
      `The ${canvas.dataset.image} of ${data.frames[shown.place].title}, with ${marks.join(", ") || "no marks"}`);
    const each = preview ? width / preview.naturalWidth : 1;
    put(scale, each > 1
      ? `A pixel here is ${digits(each)} of the camera's; all of them: rvbench show DIR ${data.frames[shown.place].frame}.`
      : preview ? "Every pixel is here." : "");
  }

  function read(x, y) {
    const u = (x - left) / zoom - 0.5, v = (y - top) / zoom - 0.5;
    if (u < -0.5 || v < -0.5 || u >= width - 0.5 || v >= height - 0.5 || !preview) return "";
    const own = levelsNow();
    const column = Math.floor((u + 0.5) * own.width / width);
    const row = Math.floor((v + 0.5) * own.height / height);
    const level = own.data[4 * (row * own.width + column)];
    const share = softening * Math.sinh(level / 255 * Math.asinh(1 / softening));
    return `u ${u.toFixed(1)}, v ${v.toFixed(1)} px: ${digits(100 * share)} % of full well`;
  }

  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    if (!fitted) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    put(told, read(event.offsetX, event.offsetY));
    if (!held || event.buttons === 0 || fitted) return;
    pan(event.clientX - held[0], event.clientY - held[1]);
    held = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointerup", () => { held = null; });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls
    event.preventDefault();
    zoomBy(Math.exp(-0.002 * event.deltaY), event.offsetX, event.offsetY);
  }, { passive: false });
  canvas.addEventListener("dblclick", (event) => zoomBy(2, event.offsetX, event.offsetY));
  const keys = {
    "+": () => zoomBy(1.5), "=": () => zoomBy(1.5), "-": () => zoomBy(1 / 1.5),
    0: () => { fit(); draw(); },
    ArrowLeft: () => pan(40, 0), ArrowRight: () => pan(-40, 0),
    ArrowUp: () => pan(0, 40), ArrowDown: () => pan(0, -40),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!(event.key in keys) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });

  const names = new Set();
  for (const layers of [data.true_layers, ...Object.values(data.pipelines).map((p) => p.layers)]) {
    for (const layer of layers.flat()) {
      names.add(layer.name);
      if (layer.labels.length) names.add("labels");
    }
  }
  if (streams.length > 1) {
    home.querySelector(".choices").append(choice("image", streams.map(({ name }, k) =>
      [k, k ? name : `${name} (of the marks)`]), (value) => { ({ pictures } = streams[value]); load(); }));
  }
  const order = ["detections", "tracks", "reprojections", "truth", "labels"].filter((x) => names.has(x));
  const bar = home.querySelector(".choices");
  bar.append(...order.map((name) => toggle(name, true, (on) => {
    layerIsOn[name] = on;
    draw();
  })));
  bar.append(choice("greys", [["asinh", "asinh"], ["linear", "linear"], ["root", "square root"],
    ["log", "logarithm"]], (value) => { curve = value; regrey(); draw(); }));
  const gain = made("input", { type: "range", min: -2, max: 8, step: 0.5, value: 0 });
  gain.addEventListener("input", () => { stops = Number(gain.value); regrey(); draw(); });
  bar.append(made("label", {}, "brighter ", gain));
  bar.append(button("+", () => zoomBy(1.5)), button("−", () => zoomBy(1 / 1.5)),
    button("1:1", () => zoomBy(1 / zoom)), button("fit", () => { fit(); draw(); }));
  bar.querySelectorAll("button").forEach((each, k) =>
    each.setAttribute("aria-label", ["zoom in", "zoom out", "one to one", "whole frame"][k]));
  home.hidden = false;
  let last = -1;
  follow(() => {
    if (last !== shown.place) load();
    else draw();
    last = shown.place;
  });
  new ResizeObserver(size).observe(home);
}
