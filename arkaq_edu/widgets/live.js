// Draws the live robot of robot.py. It follows canvas.js in one module, whose functions it uses.
//
// The stage is what stays the same: the field, the actions and their colors, the axes of the map.
// A frame is one cycle of the robot: a movement, then the look and the decision at its end.
//
//   edits            how many pushes by hand are already in it
//   title            who drives, and with what success
//   words, brief     what happens, in a sentence and in a few words
//   outcome, over    how the episode ended, or ""; whether it has
//   motion           rows [t, x, y, heading, pan, ball x, ball y (, paw x, paw y)]: s, mm, rad.
//                    One row alone begins an episode
//   eye              the camera's picture: base64 of uint16, color (of stage.palette), length, ...
//   mark             where the sighting shows in it: [column, row, radius], for a goal without the
//                    radius, or null
//   seen, estimate   the sighting (or null) and the belief, on the map
//   belief, ghost    the filter's two sigma, as a line on the map and as a line on the field
//   cell             the number of the present cell on the map, or null
//   values, action   its values, or null; the number of the action that is taken next, or null
//   automaton, state, passed    its states, the present one, and those that have worked since
//
// and, only where they have changed since the frame before (`follow` carries them over):
//
//   map              the cells: the corners of each, [x, y, x, y, ...]
//   best             the best action in each cell, or []
//   curve            the mean reward of an episode: [[episodes, reward], ...]
//
// `drawLive(ctx, stage, lanes, width, look)` draws it on a canvas of any page. A lane is
// { before, frame, t }: two frames after `follow`, and the seconds since the movement began. There
// is one, or there are two for a race; `held` may say where a hand holds { ball, robot }. `look` is { ink, ratio }. `liveHeight` tells its height.

const [GAP, EDGE] = [14, 5];
const CARPET = "#3a7d4b";
const CHALK = "#f0f0eb";
const ORANGE = "#f06928";

// The frame with all that it leaves out because it is as in the one before.
function follow(before, frame) {
  const [row] = frame.motion.slice(-1);
  const trail = before && frame.motion.length > 1 ? before.trail : [];
  return { ...before, ...frame, trail: [...trail, [row[1], row[2]]] };
}

const lasts = (frame) => (frame.motion.length > 1 ? frame.motion.at(-1)[0] : 0);

// Where everything is t seconds after a movement began.
function rowAt(motion, t) {
  const next = motion.findIndex((row) => row[0] > t); // -1: it is over
  if (next === -1) return motion.at(-1);
  if (next === 0) return motion[0];
  const [from, to] = [motion[next - 1], motion[next]];
  const share = (t - from[0]) / (to[0] - from[0]);
  return from.map((value, i) => value + share * ((to[i] ?? value) - value));
}

// The same, where a hand may hold the ball or the robot.
function rowOf({ frame, t, held }) {
  const row = [...rowAt(frame.motion, t)];
  if (held?.robot) row.splice(1, 2, ...held.robot);
  if (held?.ball) row.splice(5, 2, ...held.ball);
  return row;
}

// Where each part stands, by the width alone. Around it is room for the outline of the focus.
function livePlan(full, lanes) {
  const wide = full >= NARROW;
  const width = full - 2 * EDGE;
  const box = (x, y, w, h) => ({ x: x + EDGE, y: y + EDGE, width: w, height: h });
  const axes = (x, y, w, h) =>
    box(x + MARGIN.left, y + MARGIN.top, w - MARGIN.left - MARGIN.right, h - MARGIN.top - MARGIN.bottom);
  if (lanes > 1) {
    const w = wide ? Math.floor((width - GAP) / 2) : width;
    const [field, below] = [Math.round((w * 2) / 3), 170];
    const height = field + below + 2 * GAP;
    const plans = [0, 1].map((i) => {
      const [x, y] = wide ? [i * (w + GAP), 0] : [0, i * height];
      const map = Math.round(0.62 * w);
      return {
        field: box(x, y, w, field),
        map: axes(x, y + field, map, below + GAP),
        values: box(x + map + GAP, y + field + GAP + 16, w - map - GAP, below - 46),
      };
    });
    return { plans, height: (wide ? height : 2 * height) + 2 * EDGE };
  }
  if (!wide) {
    const field = Math.round((width * 2) / 3);
    const half = Math.floor((width - GAP) / 2);
    const eye = Math.round((half * 160) / 208);
    const [low, map] = [field + 2 * GAP + 6, 280];
    const plan = {
      field: box(0, 0, width, field),
      eye: box(0, low, half, eye),
      values: box(half + GAP, low, half, eye),
      map: axes(0, low + eye, width, map),
      automaton: box(0, low + eye + map + GAP, width, 84),
      curve: axes(0, low + eye + map + GAP + 84, width, 150),
    };
    return { plans: [plan], height: low + eye + map + GAP + 84 + 150 + 2 * EDGE };
  }
  const field = Math.round(0.585 * width);
  const [x, tall] = [field + GAP, Math.round((field * 2) / 3)];
  const rest = width - x;
  const eye = Math.round(0.5 * rest);
  const low = Math.round((eye * 160) / 208) + 18;
  const height = tall + 118;
  const left = Math.round(0.44 * field);
  const plan = {
    field: box(0, 0, field, tall),
    automaton: box(0, tall + GAP, left, height - tall - GAP),
    curve: axes(left, tall, field - left, height - tall),
    eye: box(x, 18, eye, low - 18),
    values: box(x + eye + GAP, 18, rest - eye - GAP, low - 18),
    map: axes(x, low + 4, rest, height - low - 4),
  };
  return { plans: [plan], height: height + 2 * EDGE };
}

const liveHeight = (width, lanes) => livePlan(width, lanes).height;

function drawLive(ctx, stage, lanes, width, look) {
  const { plans, height } = livePlan(width, lanes.length);
  ctx.clearRect(0, 0, width, height);
  lanes.forEach(({ before, frame, t }, i) => {
    const seen = t < lasts(frame) ? before : frame; // it looks when it has moved
    const plan = plans[i];
    if (plan.eye) drawEye(ctx, stage, seen, plan.eye, look);
    if (plan.automaton) drawAutomaton(ctx, stage, seen, plan.automaton, look);
    if (plan.curve) drawCurve(ctx, stage, frame, plan.curve, look);
    drawValues(ctx, stage, seen, plan.values, look);
    drawMap(ctx, stage, seen, plan.map, look);
  });
  drawFields(ctx, stage, lanes, width);
  return plans;
}

// The part that moves between two looks.
function drawFields(ctx, stage, lanes, width) {
  const { plans } = livePlan(width, lanes.length);
  lanes.forEach((lane, i) => drawField(ctx, stage, lane, plans[i].field));
}

function drawField(ctx, stage, { before, frame, t, held }, box) {
  const [left, right, bottom, top] = stage.extent;
  const scale = box.width / (right - left);
  const row = rowOf({ frame, t, held });
  const moving = t < lasts(frame);
  const seen = moving ? before : frame;
  ctx.save();
  ctx.beginPath();
  ctx.roundRect(box.x, box.y, box.width, box.height, 6);
  ctx.clip();
  ctx.fillStyle = CARPET;
  ctx.fill();
  ctx.translate(box.x, box.y + box.height);
  ctx.scale(scale, -scale); // from here on in mm, y upward
  ctx.translate(-left, -bottom);
  ctx.lineCap = ctx.lineJoin = "round";

  const stroke = (points, color, width, dash = []) => {
    ctx.beginPath();
    points.forEach(([x, y], i) => ctx[i ? "lineTo" : "moveTo"](x, y));
    ctx.strokeStyle = color;
    ctx.lineWidth = width;
    ctx.setLineDash(dash);
    ctx.stroke();
    ctx.setLineDash([]);
  };
  const disc = (x, y, radius, color) => {
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 2 * Math.PI);
    ctx.fillStyle = color;
    ctx.fill();
  };

  for (const [x1, y1, x2, y2] of stage.lines) stroke([[x1, y1], [x2, y2]], CHALK, stage.line);
  ctx.beginPath();
  ctx.arc(0, 0, stage.circle, 0, 2 * Math.PI);
  ctx.stroke();
  for (const [x1, y1, x2, y2, , color] of stage.walls) {
    stroke([[x1, y1], [x2, y2]], stage.palette[color], 40);
  }
  for (const [x, y, radius, , color] of stage.posts) disc(x, y, radius, stage.palette[color]);

  // What the camera can see.
  const [, x, y, heading, pan, ballX, ballY, pawX, pawY] = row;
  const gaze = heading + pan;
  ctx.beginPath();
  ctx.moveTo(x, y);
  ctx.arc(x, y, stage.reach, gaze - stage.sight / 2, gaze + stage.sight / 2);
  ctx.closePath();
  ctx.fillStyle = "rgba(255, 255, 255, 0.13)";
  ctx.fill();

  const trail = moving ? [...before.trail, [x, y]] : frame.trail;
  stroke(trail, "rgba(255, 255, 255, 0.75)", 22);
  if (moving) {
    // Not from the first row: before a kick the supervisor puts the ball there.
    const rolled = frame.motion.slice(1).filter(([when]) => when <= t);
    stroke([...rolled.map((each) => each.slice(5, 7)), [ballX, ballY]], "rgba(255, 214, 180, 0.8)", 18);
  }

  // Where the robot believes the ball, or the goal, to be.
  ctx.beginPath();
  seen.ghost.forEach(([gx, gy], i) => ctx[i ? "lineTo" : "moveTo"](gx, gy));
  ctx.closePath();
  ctx.fillStyle = "rgba(255, 225, 250, 0.35)";
  ctx.fill();
  ctx.strokeStyle = "#ffe1fa";
  ctx.lineWidth = Math.max(14, 1.6 / scale);
  ctx.stroke();

  disc(ballX + 10, ballY - 14, stage.ball + 14, "rgba(0, 0, 0, 0.28)");
  disc(ballX, ballY, stage.ball + 12, "#782d0a"); // with a rim: on this scale it is a dot
  disc(ballX, ballY, stage.ball, ORANGE);
  drawRobot(ctx, stage, x, y, heading, pan, moving ? t : 0);
  if (pawX !== undefined && moving) disc(pawX, pawY, 32, "#c4c8ce");
  ctx.restore();

  const caption = (words, at, fill) => {
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    const shown = fitting(ctx, words, box.width - 32);
    const wide = ctx.measureText(shown).width + 16;
    ctx.fillStyle = fill;
    ctx.beginPath();
    ctx.roundRect(box.x + 8, at - 11, wide, 22, 11);
    ctx.fill();
    ctx.fillStyle = "white";
    ctx.fillText(shown, box.x + 16, at + 0.5);
  };
  caption(seen.title, box.y + 19, "rgba(20, 40, 26, 0.72)");
  if (!moving && frame.outcome) caption(frame.outcome, box.y + box.height - 19, stage.ours);
}

function fitting(ctx, words, width) {
  if (ctx.measureText(words).width <= width) return words;
  let n = words.length;
  while (n > 1 && ctx.measureText(`${words.slice(0, n)}…`).width > width) n--;
  return `${words.slice(0, n)}…`;
}

// The robot from above; while it walks, diagonal legs move together.
function drawRobot(ctx, stage, x, y, heading, pan, t) {
  const [length, width] = [stage.robot[0] / 2, stage.robot[1] / 2];
  const part = (color, ...shape) => {
    ctx.beginPath();
    ctx.roundRect(...shape);
    ctx.fillStyle = color;
    ctx.fill();
  };
  const disc = (ahead, left, radius, color) => {
    ctx.beginPath();
    ctx.arc(ahead, left, radius, 0, 2 * Math.PI);
    ctx.fillStyle = color;
    ctx.fill();
  };
  ctx.save();
  ctx.translate(x, y);
  ctx.rotate(heading);
  part("rgba(0, 0, 0, 0.22)", -length - 12, -width - 20, 2 * length - 8, 2 * width + 28, 40);
  const swing = 26 * Math.sin((2 * Math.PI * t) / 0.64);
  for (const [ahead, left, way] of [[55, width - 28, 1], [55, -width - 2, -1], [-125, width - 28, -1], [-125, -width - 2, 1]]) {
    part("#bec2c8", ahead + way * swing, left, 62, 30, 10);
  }
  part("#2c2e34", -190, -8, 85, 16, 8);
  part("#f6f6f8", -125, -58, 195, 116, 30);
  disc(70, 0, 58, "#f6f6f8");
  part("#2c2e34", -100, -38, 90, 76, 16);
  ctx.translate(70, 0);
  ctx.rotate(pan);
  disc(52, 0, 56, "#bec2c8");
  disc(52, 0, 50, "#f6f6f8");
  part("#2c2e34", 8, 42, 42, 22, 10);
  part("#2c2e34", 8, -64, 42, 22, 10);
  disc(80, 0, 24, "#2c2e34");
  ctx.restore();
}

function title(ctx, words, box, ink) {
  ctx.fillStyle = ink;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText(fitting(ctx, words, box.width), box.x, box.y - 9);
}

function drawEye(ctx, stage, frame, box, { ink }) {
  title(ctx, "what the camera sees", box, ink);
  const [columns, rows] = stage.picture;
  const bytes = Uint8Array.from(atob(frame.eye), (letter) => letter.charCodeAt(0));
  const runs = new Uint16Array(bytes.buffer);
  const [across, up] = [box.width / columns, box.height / rows];
  ctx.save();
  ctx.beginPath();
  ctx.roundRect(box.x, box.y, box.width, box.height, 6);
  ctx.clip();
  let at = 0;
  for (let k = 0; k < runs.length; k += 2) {
    ctx.fillStyle = stage.palette[runs[k]];
    for (let left = runs[k + 1]; left > 0; ) {
      const column = at % columns;
      const n = Math.min(left, columns - column);
      const down = column === 0 && left >= columns ? Math.floor(left / columns) : 1;
      const size = down > 1 ? down * columns : n;
      // A little larger than it is: so no seams show.
      ctx.fillRect(box.x + column * across, box.y + Math.floor(at / columns) * up, n * across + 0.6, down * up + 0.6);
      at += size;
      left -= size;
    }
  }
  if (frame.mark) {
    const [column, row, radius] = frame.mark;
    const [x, y] = [box.x + column * across, box.y + row * up];
    ctx.beginPath();
    if (radius === undefined) {
      ctx.moveTo(x, y - 12);
      ctx.lineTo(x, y + 12);
    } else ctx.arc(x, y, Math.max(6, radius * across), 0, 2 * Math.PI);
    ctx.lineWidth = 4;
    ctx.strokeStyle = "white";
    ctx.stroke();
    ctx.lineWidth = 1.8;
    ctx.strokeStyle = INK;
    ctx.stroke();
  } else {
    ctx.fillStyle = "rgba(20, 20, 20, 0.6)";
    ctx.fillRect(box.x, box.y + box.height - 20, box.width, 20);
    ctx.fillStyle = "white";
    ctx.textAlign = "center";
    ctx.fillText("no sighting", box.x + box.width / 2, box.y + box.height - 9.5);
  }
  ctx.restore();
}

function drawValues(ctx, stage, frame, box, { ink }) {
  title(ctx, frame.cell === null ? "no state yet" : `Q of state ${frame.cell}`, box, ink);
  const least = Math.min(0, ...(frame.values ?? []));
  const most = Math.max(1e-9, ...(frame.values ?? []), least + 1e-9);
  const room = box.width - 52;
  const at = (value) => (room * (value - least)) / (most - least);
  const each = box.height / stage.actions.length;
  ctx.textBaseline = "middle";
  stage.actions.forEach((name, i) => {
    const y = box.y + 3 + i * each;
    const chosen = i === frame.action;
    ctx.save();
    if (chosen) ctx.font = ctx.font.replace(/^/, "bold ");
    ctx.fillStyle = ink;
    ctx.textAlign = "left";
    ctx.fillText(chosen ? `▸ ${name}` : name, box.x, y + 8);
    const bar = Math.min(18, each - 22);
    ctx.globalAlpha = 0.12;
    ctx.fillRect(box.x, y + 18, room, bar);
    ctx.globalAlpha = 1;
    if (frame.values) {
      const [from, to] = [at(0), at(frame.values[i])];
      ctx.fillStyle = stage.colors[i];
      ctx.fillRect(box.x + Math.min(from, to), y + 18, Math.max(1, Math.abs(to - from)), bar);
      ctx.strokeStyle = ink;
      ctx.lineWidth = chosen ? 1.6 : 0.5;
      ctx.strokeRect(box.x + Math.min(from, to), y + 18, Math.max(1, Math.abs(to - from)), bar);
      ctx.fillStyle = ink;
      ctx.textAlign = "right";
      ctx.fillText(frame.values[i].toFixed(1).replace("-", "−"), box.x + box.width, y + 18 + bar / 2);
    }
    ctx.restore();
  });
}

// A panel of canvas.js from layers that hold their own numbers as `data`.
function drawLayers(ctx, axes, layers, box, { ink, ratio }) {
  const numbers = Float32Array.from(layers.flatMap((layer) => Array.from(layer.data)));
  let start = 0;
  const placed = layers.map((layer) => {
    const from = start;
    start += layer.data.length;
    return { ...layer, start: from, length: layer.data.length };
  });
  drawPanel(ctx, { ...axes, layers: placed }, numbers, box, ratio, ink);
}

const line = (points, color, width, dashed = false) => ({
  kind: "line", data: points.flat(), color, width, dashed,
});
const dot = (point, radius, color, hollow = false) => ({
  kind: "points", data: point, radius, color, hollow,
});

function drawMap(ctx, stage, frame, box, look) {
  const { axes } = stage;
  const layers = [];
  if (frame.map.length) {
    const colors = frame.best.length ? frame.best : frame.map.map(() => stage.actions.length);
    const sizes = frame.map.map((corners) => corners.length / 2);
    const high = axes.ylim[0] === 0 && axes.ylim[1] < 2 ? 1 : stage.reach;
    layers.push({
      kind: "cells",
      data: [frame.map.length, ...sizes, ...colors, ...frame.map.flat()],
      palette: [...stage.pale, stage.unknown],
      within: [axes.xlim[0], axes.xlim[1], axes.ylim[0], high],
      border: frame.map.length > 200 ? 0.5 : 1,
    });
  }
  if (frame.cell !== null) {
    const corners = frame.map[frame.cell];
    layers.push(line([corners, corners.slice(0, 2)], INK, 2.2));
  }
  layers.push(line(frame.belief, stage.ours, 1.8), dot(frame.estimate, 3.5, stage.ours));
  if (frame.seen) layers.push(dot(frame.seen, 5.5, INK, true));
  drawLayers(ctx, axes, layers, box, look);
}

function drawCurve(ctx, stage, frame, box, look) {
  const rewards = frame.curve.map(([, reward]) => reward);
  const [low, high] = [Math.min(0, ...rewards), Math.max(100, ...rewards)];
  const last = Math.max(10, frame.curve.at(-1)?.[0] ?? 0);
  const tick = (value) => [value, value.toLocaleString("en").replace("-", "−")];
  const axes = {
    xlabel: "episodes", ylabel: "reward", xlim: [0, last], ylim: [Math.min(low, -0.02 * high), 1.08 * high],
    xticks: [tick(0), tick(last)], yticks: low < 0 ? [tick(-100), tick(0), tick(100)] : [tick(0), tick(100)], log: "",
  };
  const layers = [line(frame.curve, stage.ours, 2)];
  if (frame.curve.length) layers.push(dot(frame.curve.at(-1), 3.5, stage.ours));
  drawLayers(ctx, axes, layers, box, look);
}

function drawAutomaton(ctx, stage, frame, box, { ink }) {
  ctx.fillStyle = ink;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText("the automaton", box.x, box.y + 8);
  let [x, y] = [box.x, box.y + 22];
  for (const name of frame.automaton) {
    const wide = ctx.measureText(name).width + 18;
    if (x + wide > box.x + box.width) [x, y] = [box.x, y + 27];
    const here = name === frame.state;
    ctx.beginPath();
    ctx.roundRect(x + 0.5, y + 0.5, wide, 21, 10.5);
    ctx.fillStyle = stage.ours;
    if (here) ctx.fill();
    ctx.globalAlpha = here || frame.passed.includes(name) ? 1 : 0.35;
    ctx.strokeStyle = here || frame.passed.includes(name) ? stage.ours : ink;
    ctx.lineWidth = 1.4;
    ctx.stroke();
    ctx.globalAlpha = here || frame.passed.includes(name) ? 1 : 0.6;
    ctx.fillStyle = here ? "white" : ink;
    ctx.fillText(name, x + 9, y + 11.5);
    ctx.globalAlpha = 1;
    x += wide + 7;
  }
}

// How long a picture stands before the next movement begins (s): an end longer than a start.
const holds = (frame) => (frame.over ? 1.4 : frame.motion.length === 1 ? 0.5 : 0);
const AHEAD = 0.2; // s before a movement ends the next one is asked for: so a push is seen soon
const SLICE = 0.1; // s that the kernel works for each picture where it goes as fast as it can
const SILENCE = 5000; // ms between two sentences for a screen reader while the robot goes

// The page asks for every frame, when it is about to need it. So nothing runs while it is hidden,
// scrolled away or gone, and there is no timer anywhere that could stay behind.
function renderLive({ model, el }) {
  const stage = model.get("stage");
  const make = (kind, className, properties = {}) =>
    Object.assign(document.createElement(kind), { className }, properties);
  const fact = make("div", "arkaq-fact", { ariaHidden: "true" });
  const canvas = make("canvas", "arkaq-draggable", { tabIndex: 0 });
  const spoken = make("div", "arkaq-spoken", { role: "status" });
  const help = make("div", "arkaq-help", { textContent: model.get("help") });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-description", help.textContent);
  canvas.setAttribute("aria-keyshortcuts", "Space . ArrowLeft ArrowRight ArrowUp ArrowDown");
  canvas.dataset.lmSuppressShortcuts = "true";
  el.classList.add("arkaq-canvas");
  el.replaceChildren(fact, canvas, help, spoken);

  let lanes = [];
  let number = 0; // of the newest frames
  const queue = [];
  let asked = false;
  let plans = [];
  let stale = true; // more than the field must be drawn again
  let visible = false;
  let [frame, last, painted, saidAt] = [0, 0, 0, 0];

  const speed = () => model.get("speed");
  const ends = () => Math.max(...lanes.map((lane) => lasts(lane.frame)));
  const pause = () => Math.max(...lanes.map((lane) => holds(lane.frame)));
  const waits = () => ends() + (model.get("playing") ? pause() : 0);
  const t = () => lanes[0]?.t ?? 0;
  const going = () => model.get("playing") || queue.length > 0 || t() < ends();

  function ask() {
    if (asked || queue.length || !model.get("playing")) return;
    if (speed() && (waits() - t()) / speed() > AHEAD) return;
    asked = true;
    model.send({ kind: "next", after: number, seconds: speed() ? 0 : SLICE });
  }

  function advance(seconds) {
    const rate = speed() || Infinity;
    for (const lane of lanes) lane.t = Math.min(lane.t + (rate === Infinity ? 60 : rate * seconds), 600);
    if (queue.length && t() >= waits()) {
      const late = Math.min(t() - waits(), 0.05);
      queue.shift().forEach((sent, i) => {
        const lane = lanes[i];
        lane.before = lane.frame;
        // Who has arrived before the other one waits where he is.
        lane.frame = sent ? follow(lane.frame, sent) : { ...lane.frame, motion: lane.frame.motion.slice(-1) };
        if (sent?.edits >= lane.held?.edits) lane.held = null;
        lane.t = rate === Infinity ? 600 : late;
      });
      stale = true;
    }
    ask();
  }

  function paint() {
    const scale = scaleOf(el);
    const width = Math.min(Math.floor(el.clientWidth / scale), 900);
    if (!width || !lanes.length) return;
    const height = liveHeight(width, lanes.length);
    const { ctx, ratio, fresh } = prepared(canvas, el, width, height);
    const ink = getComputedStyle(el).color;
    if (stale || fresh) plans = drawLive(ctx, stage, lanes, width, { ink, ratio });
    else drawFields(ctx, stage, lanes, width);
    stale = false;
    canvas.dataset.painted = ++painted;
    tell();
  }

  function tell() {
    const seen = lanes.map(({ before, frame, t }) => (t < lasts(frame) ? before : frame));
    const say = (each) => (lanes.length > 1 ? `${each.title}; ${each.brief}` : each.words);
    const words = seen.map(say).join(" | ");
    if (fact.textContent !== words) fact.textContent = words;
    const soon = performance.now() > saidAt + SILENCE || seen.some((each) => each.outcome);
    if ((model.get("playing") && !soon) || spoken.textContent === words) return;
    spoken.textContent = words;
    canvas.setAttribute("aria-label", words);
    saidAt = performance.now();
  }

  function tick(now) {
    frame = 0;
    const seconds = Math.min((now - last) / 1000, 0.25);
    last = now;
    const moving = t() < ends();
    if (visible) advance(seconds);
    if (moving && t() >= ends()) stale = true; // it has arrived, and looks
    paint();
    if (visible && going()) frame = requestAnimationFrame(tick);
  }
  function wake() {
    if (frame || !lanes.length) return; // out of view it is painted, but does not go
    last = performance.now();
    frame = requestAnimationFrame(tick);
  }
  const repaint = () => {
    stale = true;
    wake();
  };
  const begin = () => {
    asked = false; // what was asked before may have failed
    wake();
  };

  function receive({ kind, ...sent }) {
    if (kind === "whole") {
      [number, asked, queue.length] = [sent.number, false, 0];
      lanes = sent.frames.map((each) => {
        const whole = follow(null, each);
        return { before: whole, frame: whole, t: lasts(whole), held: null };
      });
      repaint();
    } else if (kind === "frames") {
      if (!lanes.length) return;
      [number, asked] = [sent.number, false];
      queue.push(sent.frames);
      wake();
    } else if (kind === "glance" && lanes.length) {
      sent.glances.forEach(({ row, edits, ...look }, i) => {
        const lane = lanes[i];
        for (const each of [lane.before, lane.frame]) Object.assign(each, look);
        if (going()) lane.held = { ...lane.held, edits, ball: row.slice(5, 7) };
        else [lane.frame.motion, lane.held] = [[row], hand?.lane === i ? lane.held : null];
      });
      repaint();
    }
  }

  // By hand: the pointer takes the ball or the robot along, keys push them.
  let hand = null;
  let toSend = 0;
  const pixel = (event) => {
    const { left, top } = canvas.getBoundingClientRect();
    const scale = scaleOf(canvas);
    return [(event.clientX - left) / scale, (event.clientY - top) / scale];
  };
  const fieldAt = (i, [x, y]) => {
    const [left, right, bottom, top] = stage.extent;
    const box = plans[i].field;
    return [
      left + ((x - box.x) / box.width) * (right - left),
      bottom + ((box.y + box.height - y) / box.height) * (top - bottom),
    ];
  };
  const thingAt = (at) => {
    for (const [i, lane] of lanes.entries()) {
      if (!plans[i]) return null;
      const place = fieldAt(i, at);
      const row = rowOf(lane);
      const near = (18 * (stage.extent[1] - stage.extent[0])) / plans[i].field.width;
      const far = { ball: [row[5], row[6]], robot: [row[1], row[2]] };
      for (const what of stage.moves) {
        const reach = what === "ball" ? near : Math.max(near, 200);
        if (Math.hypot(far[what][0] - place[0], far[what][1] - place[1]) < reach) return { lane: i, what };
      }
    }
    return null;
  };
  const send = () => {
    toSend = 0;
    if (hand?.to) model.send({ kind: "put", what: hand.what, lane: hand.lane, to: hand.to });
  };
  const on = {
    pointerdown(event) {
      hand = event.button === 0 ? thingAt(pixel(event)) : null;
      if (hand) canvas.setPointerCapture(event.pointerId);
    },
    pointermove(event) {
      if (!hand) {
        canvas.style.cursor = thingAt(pixel(event)) ? "grab" : "";
        return;
      }
      hand.to = fieldAt(hand.lane, pixel(event));
      const held = { ...lanes[hand.lane].held, edits: Infinity, [hand.what]: hand.to };
      lanes[hand.lane].held = held;
      toSend ||= setTimeout(send, 50);
      repaint();
    },
    pointerup() {
      if (hand?.to) {
        clearTimeout(toSend);
        send();
      }
      hand = null;
    },
    keydown(event) {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const way = ARROWS[event.key];
      if (event.key === " ") {
        model.set("playing", !model.get("playing"));
        model.save_changes();
      } else if (event.key === ".") model.send({ kind: "step" });
      else if (way) {
        const what = event.shiftKey ? "robot" : stage.moves[0];
        model.send({ kind: "push", what, lane: 0, way });
      } else return;
      event.preventDefault();
    },
  };
  on.pointercancel = on.pointerup;
  for (const [name, act] of Object.entries(on)) canvas.addEventListener(name, act);

  const watch = new IntersectionObserver(([entry]) => {
    visible = entry.isIntersecting;
    repaint();
  });
  watch.observe(canvas);
  let friend = null;
  const room = new ResizeObserver(() => {
    const root = el.closest(".arkaq-explorer");
    if (root) friend ??= befriend(root);
    repaint();
  });
  room.observe(el);
  model.on("msg:custom", receive);
  model.on("change:playing change:speed", begin);
  model.send({ kind: "hello" });
  return () => {
    visible = false;
    cancelAnimationFrame(frame);
    clearTimeout(toSend);
    watch.disconnect();
    room.disconnect();
    friend?.disconnect();
    model.off("msg:custom", receive);
    model.off("change:playing change:speed", begin);
  };
}

export default { render: renderLive };
