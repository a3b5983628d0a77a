// Brings the explorers of a page to life without a kernel. What an explorer shows at each of its
// stops is in a file of its own (arkaq_edu/site/living.py packs it); canvas.js draws it.

{
  const waiting = {}; // what asks for the data of an explorer, by its name

  // Each file of data calls this.
  window.arkaqLiving = (name, text) => waiting[name]?.(text);

  const loads = {};
  function load({ explorer: name, src }) {
    return (loads[name] ??= new Promise((done, fail) => {
      waiting[name] = done;
      const script = document.createElement("script");
      script.src = src;
      script.onerror = fail;
      document.head.append(script);
    }).then(unpack));
  }

  async function unpack(text) {
    const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(plain).arrayBuffer());
    const end = 4 + new DataView(bytes.buffer).getUint32(0, true);
    const told = JSON.parse(new TextDecoder().decode(bytes.subarray(4, end)));
    const n = (bytes.length - end) / 4;
    const joined = new Uint8Array(4 * n); // from four planes of bytes
    for (let plane = 0; plane < 4; plane++) {
      for (let i = 0, from = end + plane * n; i < n; i++) joined[4 * i + plane] = bytes[from + i];
    }
    return { ...told, numbers: new Float32Array(joined.buffer) };
  }

  // A scene as canvas.js takes it: the layout, and the numbers of its own layers alone.
  function sceneOf(data, id) {
    const [fact, ids] = data.scenes[id];
    const parts = [];
    let start = 0;
    const panels = ids.map((panel) => {
      const layers = data.panels[panel].layers.map((number) => {
        const layer = data.layers[number];
        parts.push(data.numbers.subarray(layer.start, layer.start + layer.length));
        start += layer.length;
        return { ...layer, start: start - layer.length };
      });
      return { ...data.panels[panel], layers };
    });
    const numbers = new Float32Array(start);
    let at = 0;
    for (const part of parts) {
      numbers.set(part, at);
      at += part.length;
    }
    return [{ fact, panels }, new Uint8Array(numbers.buffer)];
  }

  // Which settings there are. Where the one asked for is not there, the nearest one is: it keeps
  // what was just moved, and changes as few of the others as it can.
  function settingsOf(data) {
    const scenes = new Map(data.settings.map((row) => [row.slice(0, -1).join(), row.at(-1)]));
    const known = data.settings.map((row) => row.slice(0, -1));
    const distance = (a, b) =>
      a.reduce((sum, stop, i) => sum + (stop === b[i] ? 0 : 1000 + Math.abs(stop - b[i])), 0);
    return {
      scene: (setting) => scenes.get(setting.join()),
      nearest(setting, moved) {
        if (scenes.has(setting.join())) return setting;
        let best = null;
        for (const each of known) {
          if (each[moved] !== setting[moved]) continue;
          if (!best || distance(each, setting) < distance(best, setting)) best = each;
        }
        return best;
      },
      stops: (handle) => [...new Set(known.map((row) => row[handle]))].sort((a, b) => a - b),
    };
  }

  function make(tag, options = {}, ...children) {
    const made = Object.assign(document.createElement(tag), options);
    made.append(...children);
    return made;
  }

  let count = 0;

  // Each kind of handle: its element, and how it shows a stop. `go(stop)` moves it.
  const HANDLES = {
    slider(handle, stops, go) {
      const id = `arkaq-${count++}`;
      const input = make("input", { type: "range", id, min: 0, max: stops.length - 1, title: handle.tip ?? "" });
      const readout = make("output", { htmlFor: id });
      input.addEventListener("input", () => go(stops[input.value]));
      const row = make("div", { className: "arkaq-row" }, make("label", { htmlFor: id }, handle.label), input, readout);
      const show = (stop) => {
        input.value = stops.indexOf(stop);
        readout.textContent = handle.texts[stop];
        input.setAttribute("aria-valuetext", handle.texts[stop]);
      };
      return [row, show];
    },

    menu(handle, stops, go) {
      const options = stops.map((stop) => make("option", { value: stop }, handle.texts[stop]));
      const select = make("select", { title: handle.tip ?? "" }, ...options);
      select.addEventListener("change", () => go(Number(select.value)));
      const row = make("label", { className: "arkaq-row" }, make("span", {}, handle.label), select);
      return [row, (stop) => (select.value = stop)];
    },

    box(handle, stops, go) {
      const input = make("input", { type: "checkbox", title: handle.tip ?? "" });
      input.addEventListener("change", () => go(Number(input.checked)));
      return [make("label", { className: "arkaq-box" }, input, handle.label), (stop) => (input.checked = !!stop)];
    },

    presses(handle, stops, go, offered) {
      const place = make("div", { className: "arkaq-presses" });
      let now = handle.start;
      let shown = null;
      const press = (name) => {
        const next = name === handle.again ? handle.roots[handle.root[now]] : handle.after[now][name];
        if (next !== undefined && offered(next)) go(next);
      };
      const button = (name) => {
        const made = make("button", { type: "button" }, name);
        made.addEventListener("click", () => press(name));
        return made;
      };
      const build = (root) => {
        const first = make("div", { className: "arkaq-buttons" });
        if (handle.menu) {
          const select = make("select", { ariaLabel: "problem" }, ...handle.menu.map((name) => make("option", {}, name)));
          select.value = root;
          select.addEventListener("change", () => go(handle.roots[select.value]));
          first.append(select);
        }
        const rows = handle.rows[root].map(([label, names]) =>
          make("div", { className: "arkaq-buttons" }, ...(label ? [make("span", {}, label)] : []), ...names.map(button)),
        );
        (handle.menu ? first : rows[0]).append(button(handle.again));
        place.replaceChildren(...(handle.menu ? [first] : []), ...rows);
        shown = root;
      };
      const show = (stop) => {
        now = stop;
        if (shown !== handle.root[stop]) build(handle.root[stop]);
        for (const each of place.querySelectorAll("button")) {
          const name = each.textContent;
          const next = name === handle.again ? handle.roots[shown] : handle.after[stop][name];
          each.classList.toggle("arkaq-off", next === undefined || !offered(next));
        }
      };
      return [place, show];
    },
  };

  function bringToLife(place, data) {
    const settings = settingsOf(data);
    let setting = data.handles.map((handle) => handle.start);
    const shows = [];
    const rows = {};
    const model = modelOf(data);

    function show() {
      [model.values.scene, model.values.numbers] = sceneOf(data, settings.scene(setting));
      data.handles.forEach((handle, i) => shows[i](setting[i]));
      for (const [menu, hidden] of Object.entries(data.hidden)) {
        const stop = setting[data.handles.findIndex((handle) => handle.name === menu)];
        for (const [name, row] of Object.entries(rows)) row.hidden = hidden[stop].includes(name);
      }
      model.changed();
    }

    function go(handle, stop) {
      const asked = [...setting];
      asked[handle] = stop;
      const next = settings.nearest(asked, handle);
      if (next) setting = next;
      show();
    }

    const controls = make("div", { className: "arkaq-controls" });
    data.handles.forEach((handle, i) => {
      const stops = settings.stops(i);
      const offered = (stop) => stops.includes(stop);
      const [row, tell] = HANDLES[handle.kind](handle, stops, (stop) => go(i, stop), offered);
      if (stops.length === 1) row.hidden = true; // it needs the notebook
      rows[handle.name] = row;
      shows.push(tell);
      controls.append(row);
    });
    for (const drag of data.drag) follow(model, drag, data, settings, () => setting, go);

    const canvas = make("div");
    const note = make("p", { className: "arkaq-note" }, data.note);
    place.classList.add("arkaq-explorer");
    show();
    place.replaceChildren(controls, canvas, ...(data.note ? [note] : []));
    window.arkaqCanvas.render({ model, el: canvas });
  }

  // What canvas.js needs of a widget's model.
  function modelOf(data) {
    const listeners = [];
    const model = {
      values: { draggable: data.drag.length ? [0] : [], drag: {}, arrows: [0, 0] },
      told: () => {},
      get: (name) => model.values[name],
      set: (name, value) => (model.values[name] = value),
      on: (_, listener) => listeners.push(listener),
      off: (_, listener) => listeners.splice(listeners.indexOf(listener), 1),
      changed: () => listeners.forEach((listener) => listener()),
      save_changes: () => model.told(),
    };
    return model;
  }

  // Drags and arrow keys on the canvas move one or two handles, as in a notebook (explorer.Drag).
  function follow(model, drag, data, settings, now, go) {
    const numbers = drag.handles.map((name) => data.handles.findIndex((handle) => handle.name === name));
    const stops = numbers.map((handle) => settings.stops(handle));
    const value = (k) => drag.values[k][now()[numbers[k]]];
    const nearest = (k, target) =>
      stops[k].reduce((a, b) => (Math.abs(drag.values[k][b] - target) < Math.abs(drag.values[k][a] - target) ? b : a));
    let start = [];
    let number = null;
    let arrows = [0, 0];
    model.told = () => {
      const moved = model.values.drag;
      if (moved.number !== number) {
        number = moved.number;
        start = numbers.map((_, k) => value(k));
      }
      const keys = model.values.arrows.map((n, k) => n - arrows[k]);
      arrows = model.values.arrows;
      if (numbers.length === 1) keys[0] += keys[1]; // a single slider takes all four keys
      numbers.forEach((handle, k) => {
        const gain = drag.gain?.[k];
        let stop = null;
        if (keys[k]) {
          const at = stops[k].indexOf(now()[handle]) + keys[k] * Math.sign(gain ?? 1);
          stop = stops[k][Math.min(Math.max(at, 0), stops[k].length - 1)];
        } else if (moved.to) {
          stop = nearest(k, gain == null ? moved.to[k] : start[k] + gain * (moved.to[k] - moved.from[k]));
        }
        if (stop !== null && stop !== now()[handle]) go(handle, stop);
      });
      if (keys.some(Boolean)) model.values.drag = { number };
    };
  }

  const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16];

  // Plays what was recorded of a robot, or of two that race. It answers live.js as a kernel does
  // (widgets/live.py): with a whole frame each at first, then with one frame after the other.
  function playRobot(place, data) {
    const lanes = Number(place.dataset.lanes);
    const chosen = { seed: 0, vigilance: 0, speed: 2 };
    const drivers = Array.from({ length: lanes }, (_, i) => (i ? data.texts.driver.length - 1 : 0));
    const listeners = {};
    const fire = (name, sent) => (listeners[name] ?? []).forEach((listener) => listener(sent));
    const values = { stage: data.stage, help: data.help, playing: false, speed: 1 };
    let number = 0;
    let at = drivers.map(() => 0);

    const takes = () => drivers.map((driver) => data.takes[[driver, chosen.seed, chosen.vigilance].join()]);
    const frames = () =>
      takes().map((take, i) => {
        const frame = take[at[i]];
        return "map" in frame ? { ...frame, map: data.maps[frame.map] } : frame;
      });
    const tell = (kind, sent) => setTimeout(() => fire("msg:custom", { kind, number: ++number, frames: sent }));
    const restart = () => {
      at = drivers.map(() => 0);
      tell("whole", frames());
    };
    // Who has arrived before the other one waits; after the last episode comes the first.
    function step() {
      const over = takes().map((take, i) => take[at[i]].over);
      const moves = over.map((each) => !each || over.every(Boolean));
      at = at.map((now, i) => (moves[i] ? (now + 1) % takes()[i].length : now));
      tell("frames", frames().map((frame, i) => (moves[i] ? frame : null)));
    }

    const model = {
      get: (name) => values[name],
      set(name, value) {
        values[name] = value;
        play.setAttribute("aria-pressed", values.playing);
        play.textContent = values.playing ? "pause" : "play";
        fire(`change:${name}`);
      },
      on: (names, listener) => names.split(" ").forEach((name) => (listeners[name] ??= []).push(listener)),
      off: () => {},
      save_changes: () => {},
      send({ kind, after }) {
        if (kind === "hello") tell("whole", frames());
        else if (kind === "step" || (kind === "next" && after === number)) step();
      },
    };
    const button = (words, act) => {
      const made = make("button", { type: "button" }, words);
      made.addEventListener("click", act);
      return made;
    };
    const play = button("play", () => model.set("playing", !values.playing));
    const controls = make("div", { className: "arkaq-controls" });
    const handle = (kind, look, start, go) => {
      const stops = look.texts.map((_, i) => i);
      if (stops.length < 2) return;
      let tellIt = null;
      const [row, show] = HANDLES[kind](look, stops, (stop) => (go(stop), tellIt(stop)));
      (tellIt = show)(start);
      controls.append(row);
    };
    controls.append(make("div", { className: "arkaq-buttons" }, play, button("step", step), button("start again", restart)));
    drivers.forEach((driver, i) => {
      const label = lanes === 1 ? "at the wheel" : ["left", "right"][i];
      handle("menu", { label, texts: data.texts.driver }, driver, (stop) => ((drivers[i] = stop), restart()));
    });
    for (const name of ["seed", "vigilance"]) {
      handle("slider", { label: name, texts: data.texts[name] }, 0, (stop) => ((chosen[name] = stop), restart()));
    }
    const speeds = SPEEDS.map((speed) => `${speed} ×`);
    handle("slider", { label: "speed", texts: speeds }, chosen.speed, (stop) => model.set("speed", SPEEDS[stop]));
    const canvas = make("div");
    place.classList.add("arkaq-explorer");
    place.replaceChildren(controls, canvas);
    window.arkaqCanvas.renderLive({ model, el: canvas });
  }

  function begin() {
    const near = new IntersectionObserver(
      (entries) => {
        for (const { isIntersecting, target } of entries) {
          if (!isIntersecting) continue;
          near.unobserve(target);
          load(target.dataset).then((data) => (data.robot ? playRobot : bringToLife)(target, data));
        }
      },
      { rootMargin: "800px" },
    );
    for (const place of document.querySelectorAll(".arkaq-living[data-explorer]")) near.observe(place);
  }

  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", begin);
  else begin();
}
