// Draws the scenes of scene.py on a canvas: panels with axes, layers on the panels.

const INK = "#222222";
const MARGIN = { left: 62, right: 14, top: 10, bottom: 46 };
const NARROW = 600; // below this width panels stand one above the other

// Each layer knows how to draw itself: `at(x, y)` gives the pixel of a point of the axes.
const LAYERS = {
  cells(ctx, at, layer, numbers) {
    const n = numbers[0];
    const sizes = numbers.subarray(1, 1 + n);
    const colors = numbers.subarray(1 + n, 1 + 2 * n);
    const paths = layer.palette.map(() => new Path2D());
    let k = 1 + 2 * n;
    for (let i = 0; i < n; i++) {
      const path = paths[colors[i]];
      path.moveTo(...at(numbers[k], numbers[k + 1]));
      for (const end = k + 2 * sizes[i]; k < end; k += 2) path.lineTo(...at(numbers[k], numbers[k + 1]));
      path.closePath();
    }
    const [left, right, bottom, top] = layer.within;
    const [x0, y0] = at(left, bottom);
    const [x1, y1] = at(right, top);
    ctx.beginPath();
    ctx.rect(x0, y0, x1 - x0, y1 - y0);
    ctx.clip();
    ctx.strokeStyle = "white";
    ctx.lineWidth = layer.border / 0.75;
    // A color's borders before the next color: so what is drawn later can cover them.
    paths.forEach((path, color) => {
      ctx.fillStyle = layer.palette[color];
      ctx.fill(path);
      if (layer.border) ctx.stroke(path);
    });
  },

  points(ctx, at, layer, numbers) {
    ctx.beginPath();
    for (let k = 0; k < numbers.length; k += 2) {
      const [x, y] = at(numbers[k], numbers[k + 1]);
      ctx.moveTo(x + layer.radius, y);
      ctx.arc(x, y, layer.radius, 0, 2 * Math.PI);
    }
    ctx.fillStyle = ctx.strokeStyle = layer.color;
    ctx.lineWidth = 1.3;
    layer.hollow ? ctx.stroke() : ctx.fill();
  },

  line(ctx, at, layer, numbers) {
    ctx.beginPath();
    for (let k = 0, begin = true; k < numbers.length; k += 2) {
      const lifted = Number.isNaN(numbers[k]); // the pen: the line goes on elsewhere
      if (!lifted) ctx[begin ? "moveTo" : "lineTo"](...at(numbers[k], numbers[k + 1]));
      begin = lifted;
    }
    ctx.strokeStyle = layer.color;
    ctx.lineWidth = layer.width;
    ctx.setLineDash(layer.dashed ? [5, 4] : []);
    ctx.stroke();
  },

  text(ctx, at, layer, numbers) {
    ctx.fillStyle = layer.color;
    ctx.textAlign = layer.align;
    ctx.textBaseline = "middle";
    ctx.fillText(layer.text, ...at(numbers[0], numbers[1]));
  },

  picture(ctx, at, layer, numbers) {
    const { buffer, byteOffset, byteLength } = numbers; // four bytes a pixel, no floats
    const pixels = new ImageData(new Uint8ClampedArray(buffer, byteOffset, byteLength), layer.columns);
    const sheet = new OffscreenCanvas(pixels.width, pixels.height);
    sheet.getContext("2d").putImageData(pixels, 0, 0);
    const [left, right, bottom, top] = layer.within;
    const [x0, y0] = at(left, top);
    const [x1, y1] = at(right, bottom);
    ctx.imageSmoothingEnabled = layer.smooth;
    ctx.drawImage(sheet, x0, y0, x1 - x0, y1 - y0);
  },
};

// The way from a point of a panel's axes to a pixel of its box, and back.
function axesOf(panel, box) {
  const axis = (name, [from, to]) => {
    const same = (value) => value;
    const [scale, unscale] = panel.log.includes(name) ? [Math.log, Math.exp] : [same, same];
    const [start, length] = [scale(from), scale(to) - scale(from)];
    return {
      share: (value) => (scale(value) - start) / length,
      value: (share) => unscale(start + share * length),
    };
  };
  const [across, up] = [axis("x", panel.xlim), axis("y", panel.ylim)];
  return {
    at: (x, y) => [
      box.x + box.width * across.share(x),
      box.y + box.height * (1 - up.share(y)),
    ],
    back: (x, y) => [
      across.value((x - box.x) / box.width),
      up.value(1 - (y - box.y) / box.height),
    ],
  };
}

function drawPanel(ctx, panel, numbers, box, ratio, ink = INK) {
  const { at } = axesOf(panel, box);
  // Thin lines are sharp where they run through the middle of the screen's own pixels.
  const sharp = (value) => (Math.round(value * ratio) + 0.5) / ratio;

  for (const layer of panel.layers) {
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.x - 1, box.y - 1, box.width + 2, box.height + 2);
    if (layer.kind !== "text") ctx.clip();
    LAYERS[layer.kind](ctx, at, layer, numbers.subarray(layer.start, layer.start + layer.length));
    ctx.restore();
  }

  if (panel.bare) return;
  const [left, foot] = [sharp(box.x), sharp(box.y + box.height)];
  ctx.beginPath();
  ctx.moveTo(left, box.y);
  ctx.lineTo(left, foot);
  ctx.lineTo(box.x + box.width, foot);
  ctx.fillStyle = ctx.strokeStyle = ink;
  ctx.lineWidth = 1;
  ctx.textAlign = "center";
  ctx.textBaseline = "top";
  for (const [tick, label] of panel.xticks) {
    const x = sharp(at(tick, panel.ylim[0])[0]);
    ctx.moveTo(x, foot);
    ctx.lineTo(x, foot + 4);
    ctx.fillText(label, x, foot + 7);
  }
  ctx.fillText(panel.xlabel, box.x + box.width / 2, foot + 27);
  ctx.textAlign = "right";
  ctx.textBaseline = "middle";
  for (const [tick, label] of panel.yticks) {
    const y = sharp(at(panel.xlim[0], tick)[1]);
    ctx.moveTo(left, y);
    ctx.lineTo(left - 4, y);
    ctx.fillText(label, left - 7, y);
  }
  ctx.stroke();
  ctx.save();
  ctx.translate(box.x - MARGIN.left + 9, box.y + box.height / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.textAlign = "center";
  ctx.fillText(panel.ylabel, 0, 0);
  ctx.restore();
}

// The size follows the width alone, so that the page never jumps when the scene changes.
function arrange(panels, width) {
  const stacked = width < NARROW;
  const total = panels.reduce((sum, panel) => sum + panel.width, 0);
  const height = stacked
    ? Math.round(Math.min(360, Math.max(260, 0.8 * width)))
    : Math.round(Math.min(430, 0.52 * width));
  let x = 0;
  let y = 0;
  const boxes = panels.map((panel) => {
    const share = stacked ? width : (width * panel.width) / total;
    const box = panel.bare
      ? fitted(panel, { x, y, width: share, height })
      : {
          x: x + MARGIN.left,
          y: y + MARGIN.top,
          width: share - MARGIN.left - MARGIN.right,
          height: height - MARGIN.top - MARGIN.bottom,
        };
    if (stacked) y += height;
    else x += share;
    return box;
  });
  return [boxes, stacked ? y : height];
}

// A bare panel has one scale for both directions.
function fitted(panel, box) {
  const [across, up] = [panel.xlim, panel.ylim].map(([from, to]) => Math.abs(to - from));
  const scale = Math.min(box.width / across, box.height / up);
  const [width, height] = [scale * across, scale * up];
  return { x: box.x + (box.width - width) / 2, y: box.y + (box.height - height) / 2, width, height };
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };

// A page for a projector draws all larger: it sets this property.
const scaleOf = (el) => Number(getComputedStyle(el).getPropertyValue("--arkaq-scale")) || 1;

// Tells the kernel of drags and of the arrow keys, once a frame at most. While the kernel is busy
// the manager keeps the newest message alone: so each holds all there is to know since the drag
// began, and keys are counted, not sent.
function takeInput(model, canvas, panelAt) {
  let drag = null;
  let frame = 0;
  const tell = (name, value) => {
    model.set(name, value);
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      model.save_changes();
    });
  };
  const pixel = (event) => {
    const { left, top } = canvas.getBoundingClientRect();
    const scale = scaleOf(canvas);
    return [(event.clientX - left) / scale, (event.clientY - top) / scale];
  };
  const move = (event, phase) => {
    tell("drag", { ...drag.told, to: drag.back(...pixel(event)), phase });
  };
  const on = {
    pointerdown(event) {
      const place = panelAt(...pixel(event));
      if (!place || event.button !== 0) return;
      const number = (model.get("drag").number ?? 0) + 1;
      drag = { back: place.back, told: { number, panel: place.panel, from: place.back(...pixel(event)) } };
      canvas.setPointerCapture(event.pointerId);
      move(event, "begin");
    },
    pointermove(event) {
      if (drag) move(event, "move");
      else canvas.style.cursor = panelAt(...pixel(event)) ? "grab" : "";
    },
    pointerup(event) {
      if (drag) move(event, "end");
      drag = null;
    },
    keydown(event) {
      const step = ARROWS[event.key];
      if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault(); // the page stays where it is
      const [x, y] = model.get("arrows");
      tell("arrows", [x + step[0], y + step[1]]);
    },
  };
  on.pointercancel = on.pointerup;
  for (const [name, act] of Object.entries(on)) canvas.addEventListener(name, act);
  canvas.tabIndex = 0;
  canvas.setAttribute("aria-keyshortcuts", Object.keys(ARROWS).join(" "));
  canvas.dataset.lmSuppressShortcuts = "true"; // JupyterLab has other plans for arrow keys
  canvas.classList.add("arkaq-draggable");
}

// A canvas of that size with its pixels, the number of these in one of the page, and whether it is
// blank now.
function prepared(canvas, el, width, height) {
  const scale = scaleOf(el);
  const ratio = window.devicePixelRatio * scale;
  const size = [Math.round(width * ratio), Math.round(height * ratio)];
  // Giving a canvas a size, even the one it has, costs a new buffer.
  const fresh = canvas.width !== size[0] || canvas.height !== size[1];
  if (fresh) [canvas.width, canvas.height] = size;
  canvas.style.width = `${width * scale}px`;
  canvas.style.height = `${height * scale}px`;
  const ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.font = `12px ${getComputedStyle(el).fontFamily}`;
  return { ctx, ratio, fresh };
}

// What ipywidgets leaves undone around the canvas: its sliders have no name and say a rounded
// value, and a key pressed on them is also a shortcut of JupyterLab.
function befriend(root) {
  const tell = () => {
    // On each of them: JupyterLab's shortcuts look at what has the focus before they look above it.
    for (const control of root.querySelectorAll("button, select, input, [role=slider]")) {
      control.dataset.lmSuppressShortcuts = "true";
    }
    for (const row of root.querySelectorAll(".widget-hslider, .widget-play")) {
      const handle = row.querySelector("[role=slider]");
      handle?.setAttribute("aria-label", row.querySelector(".widget-label").textContent);
      handle?.setAttribute("aria-valuetext", row.querySelector(".widget-readout").textContent);
      const tip = row.querySelector("[title]")?.title;
      if (tip) handle?.setAttribute("aria-description", tip);
    }
    for (const button of root.querySelectorAll("button")) {
      button.setAttribute("aria-disabled", button.classList.contains("arkaq-off"));
      if (button.matches(".widget-toggle-button")) {
        button.setAttribute("aria-pressed", button.classList.contains("mod-active"));
      }
    }
  };
  const watch = new MutationObserver(tell);
  watch.observe(root, { subtree: true, childList: true, characterData: true, attributeFilter: ["class"] });
  tell();
  return watch;
}

function render({ model, el }) {
  const fact = document.createElement("div");
  fact.className = "arkaq-fact";
  fact.setAttribute("role", "status");
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  el.classList.add("arkaq-canvas");
  el.replaceChildren(fact, canvas);

  let places = []; // of the panels on which a drag may begin, as they were last painted
  const panelAt = (x, y) =>
    places.find(
      ({ box }) => x >= box.x && x <= box.x + box.width && y >= box.y && y <= box.y + box.height,
    );
  const draggable = model.get("draggable");
  if (draggable.length) takeInput(model, canvas, panelAt);

  function paint() {
    const scene = model.get("scene");
    const scale = scaleOf(el);
    const width = Math.min(Math.floor(el.clientWidth / scale), 860);
    if (!width || !scene.panels) return;
    const bytes = model.get("numbers");
    const numbers = new Float32Array(
      bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength),
    );
    const [boxes, height] = arrange(scene.panels, width);
    const { ctx, ratio } = prepared(canvas, el, width, height);
    ctx.fillStyle = "white";
    ctx.fillRect(0, 0, width, height);
    scene.panels.forEach((panel, i) => drawPanel(ctx, panel, numbers, boxes[i], ratio));
    places = draggable.map((panel) => {
      const box = boxes[panel];
      return { panel, box, back: axesOf(scene.panels[panel], box).back };
    });
    fact.textContent = scene.fact;
    canvas.setAttribute("aria-label", scene.fact);
  }

  let frame = 0;
  const repaint = () => {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(paint);
  };
  let screen = null;
  const watchScreen = () => {
    screen?.removeEventListener("change", watchScreen);
    screen = window.matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`);
    screen.addEventListener("change", watchScreen);
    repaint();
  };
  let friend = null; // known once the canvas stands in the page, among the controls
  const room = new ResizeObserver(() => {
    const root = el.closest(".arkaq-explorer");
    if (root) friend ??= befriend(root);
    repaint();
  });
  room.observe(el);
  model.on("change:scene change:numbers", repaint);
  watchScreen();
  return () => {
    room.disconnect();
    friend?.disconnect();
    screen.removeEventListener("change", watchScreen);
    model.off("change:scene change:numbers", repaint);
    cancelAnimationFrame(frame);
  };
}

export default { render };
