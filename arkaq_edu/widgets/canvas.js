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
    paths.forEach((path, color) => {
      ctx.fillStyle = layer.palette[color];
      ctx.fill(path);
    });
    ctx.strokeStyle = "white";
    ctx.lineWidth = layer.border / 0.75;
    for (const path of paths) ctx.stroke(path);
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
    for (let k = 0; k < numbers.length; k += 2) ctx.lineTo(...at(numbers[k], numbers[k + 1]));
    ctx.strokeStyle = layer.color;
    ctx.lineWidth = layer.width;
    ctx.setLineDash(layer.dashed ? [5, 4] : []);
    ctx.stroke();
  },

  text(ctx, at, layer, numbers) {
    ctx.fillStyle = layer.color;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    ctx.fillText(layer.text, ...at(numbers[0], numbers[1]));
  },
};

function drawPanel(ctx, panel, numbers, box, ratio) {
  const scale = panel.log ? Math.log : (value) => value;
  const place = (value, [from, to]) => (scale(value) - scale(from)) / (scale(to) - scale(from));
  const at = (x, y) => [
    box.x + box.width * place(x, panel.xlim),
    box.y + box.height * (1 - place(y, panel.ylim)),
  ];
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

  const [left, foot] = [sharp(box.x), sharp(box.y + box.height)];
  ctx.beginPath();
  ctx.moveTo(left, box.y);
  ctx.lineTo(left, foot);
  ctx.lineTo(box.x + box.width, foot);
  ctx.fillStyle = ctx.strokeStyle = INK;
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
    const box = {
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

function render({ model, el }) {
  const fact = document.createElement("div");
  fact.className = "arkaq-fact";
  fact.setAttribute("role", "status");
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  el.classList.add("arkaq-canvas");
  el.replaceChildren(fact, canvas);

  function paint() {
    const scene = model.get("scene");
    const width = Math.min(Math.floor(el.clientWidth), 860);
    if (!width || !scene.panels) return;
    const bytes = model.get("numbers");
    const numbers = new Float32Array(
      bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength),
    );
    const ratio = window.devicePixelRatio;
    const [boxes, height] = arrange(scene.panels, width);
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    // Giving a canvas a size, even the one it has, costs a new buffer.
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    const ctx = canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.fillStyle = "white";
    ctx.fillRect(0, 0, width, height);
    ctx.font = `12px ${getComputedStyle(el).fontFamily}`;
    scene.panels.forEach((panel, i) => drawPanel(ctx, panel, numbers, boxes[i], ratio));
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
  const room = new ResizeObserver(repaint);
  room.observe(el);
  model.on("change:scene change:numbers", repaint);
  watchScreen();
  return () => {
    room.disconnect();
    screen.removeEventListener("change", watchScreen);
    model.off("change:scene change:numbers", repaint);
    cancelAnimationFrame(frame);
  };
}

export default { render };
