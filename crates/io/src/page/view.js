// The page: one frame is shown everywhere.

const take = readTake();
const element = (id) => document.getElementById(id);
const made = (name, text = "", attributes = {}) => {
  const node = document.createElement(name);
  node.textContent = text;
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  return node;
};
const state = { frame: 0, start: take.time[0] ?? 0, end: take.time[take.count - 1] ?? 1, playing: false };
const hand = new HandView(element("hand-canvas"), take);
const curves = [];
const labels = [];

function describe(frame) {
  const doubts = take.doubts.get(frame);
  const parts = [`frame ${take.index[frame]}`, `${take.time[frame].toFixed(3)} s`];
  if (!take.found(frame)) parts.push("no hand");
  if (Number.isFinite(take.quality[frame])) parts.push(`quality ${take.quality[frame].toFixed(2)}`);
  const without = take.without(frame);
  if (without.length) parts.push(`without ${without.join(", ")}`);
  return [parts.join(" · "), doubts ? `doubted: ${doubts.join(", ")}` : ""];
}

function show(frame) {
  if (!take.count) return;
  state.frame = Math.max(0, Math.min(take.count - 1, frame));
  const time = take.time[state.frame];
  const span = state.end - state.start;
  if (time < state.start || time > state.end) [state.start, state.end] = [time - span / 2, time + span / 2];
  draw();
}

function draw() {
  if (!take.count) return;
  const { frame, start, end } = state;
  const [text, doubt] = describe(frame);
  element("frame").value = frame;
  element("frame").setAttribute("aria-valuetext", `${text} ${doubt}`);
  element("now").replaceChildren(text);
  if (doubt) element("now").append(" · ", made("span", doubt, { class: "doubted" }));
  hand.show(take.poseOf(frame));
  element("hand-canvas").style.opacity = take.doubted[frame] ? 0.55 : 1;
  for (const curve of curves) curve.draw(start, end, frame);
  for (const label of labels) label(frame);
}

function addCurves() {
  const watcher = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      target.curve.visible = isIntersecting;
      if (isIntersecting) target.curve.draw(state.start, state.end, state.frame);
    }
  }, { rootMargin: "200px" });
  const add = (canvas, series) => {
    canvas.curve = new Curve(canvas, take, series, show);
    curves.push(canvas.curve);
    watcher.observe(canvas);
  };
  add(element("quality"), { value: (frame) => take.quality[frame], std: () => NaN, low: 0, high: 1, unit: "" });
  take.dofs.forEach(({ name, unit, positive }, dof) => {
    const [low, high] = bounds(take, dof, unit);
    const box = made("div", "", { class: "angle", "data-group": name.split(".")[0] });
    const title = made("h3", name);
    title.append(made("span", `+ ${positive}`, { class: "positive" }));
    const value = title.appendChild(made("span"));
    const canvas = made("canvas", "", { class: "curve", role: "img" });
    box.append(title, canvas);
    element("curves").append(box);
    add(canvas, { value: (f) => take.pose[28 * f + dof], std: (f) => take.std[28 * f + dof], low, high, unit: UNITS[unit] });
    canvas.setAttribute("aria-label", `${name}, positive ${positive}, along time, from ${low} to ${high}${UNITS[unit]}`);
    labels.push((frame) => {
      const std = take.std[28 * frame + dof];
      const spread = Number.isFinite(std) ? ` ± ${number(std, unit)}` : take.found(frame) ? ", not estimated" : "";
      value.textContent = number(take.pose[28 * frame + dof], unit) + spread;
    });
  });
}

function addPictures() {
  element("views").hidden = take.pictures.length === 0;
  for (const view of take.pictures) {
    const figure = made("figure");
    const image = figure.appendChild(made("img", "", { alt: "" }));
    const canvas = figure.appendChild(made("canvas", "", { "aria-hidden": "true" }));
    const caption = made("figcaption");
    element("pictures").append(made("div"));
    element("pictures").lastChild.append(figure, caption);
    [canvas.width, canvas.height] = [view.width, view.height];
    const joints = new Float32Array(bytes(view.joints));
    let shown = -1;
    labels.push((frame) => {
      // The last picture up to the frame.
      let k = view.frames.findLastIndex((pictured) => pictured <= frame);
      k = Math.max(0, k);
      if (k === shown) return;
      shown = k;
      image.src = view.data[k];
      image.alt = `What ${view.name} saw in frame ${take.index[view.frames[k]]}, with the estimated hand`;
      caption.textContent = [view.name, `frame ${take.index[view.frames[k]]}`, ...agreement(view.name, view.frames[k])].join(", ");
      const context = canvas.getContext("2d");
      context.clearRect(0, 0, view.width, view.height);
      drawOutline(context, new Float32Array(bytes(view.outlines[k])), view.width);
      drawJoints(context, joints.subarray(42 * k, 42 * k + 42), view.width);
    });
  }
}

// How well a frame agrees with what a camera saw, in words.
function agreement(name, frame) {
  const at = take.views.length * frame + take.views.indexOf(name);
  const why = take.whyWithout(at);
  const overlap = take.overlap[at];
  return [why && `left out (${why})`, Number.isFinite(overlap) && `overlap ${overlap.toFixed(2)}`].filter(Boolean);
}

// The outline of the estimated hand; a point that is none ends a piece.
function drawOutline(context, points, width) {
  const size = Math.max(1, width / 320);
  context.beginPath();
  let begun = false;
  for (let k = 0; k < points.length; k += 2) {
    const isPoint = Number.isFinite(points[k]);
    if (isPoint && begun) context.lineTo(points[k], points[k + 1]);
    else if (isPoint) context.moveTo(points[k], points[k + 1]);
    begun = isPoint;
  }
  for (const [line, colour] of [[3 * size, "#000a"], [1.5 * size, "#ff5fc8"]]) {
    [context.lineWidth, context.strokeStyle] = [line, colour];
    context.stroke();
  }
}

// The 21 joints as lines over a picture, where they are in it.
function drawJoints(context, joints, width) {
  const size = Math.max(1, width / 320);
  for (const [line, colour] of [[4 * size, "#000a"], [2 * size, "#4ff0a0"]]) {
    context.strokeStyle = colour;
    context.lineWidth = line;
    for (let digit = 0; digit < 5; digit++) {
      context.beginPath();
      for (const joint of [0, 1, 2, 3, 4].map((k) => (k ? 4 * digit + k : 0))) {
        const [x, y] = [joints[2 * joint], joints[2 * joint + 1]];
        if (Number.isFinite(x) && Number.isFinite(y)) context.lineTo(x, y);
      }
      context.stroke();
    }
  }
}

// What doubts mean, which are written as CODE or CODE:CAMERA.
const DOUBTS = {
  "no-hand": "no camera shows a hand",
  "poor-fit": "that camera was used, but shows something else than the estimated hand",
  "poor-landmarks": "the landmarks of that camera are of something else than the estimated hand",
  "other-side": "a hand of the other side explains the recording better",
  "exchanged": "these two cameras seem to have each other's pictures",
  "other-end": "the hand may be at the other end of the arm",
  "open": "the cameras leave the pose open: it has no deviations",
  "cut-off": "part of the hand is beyond the border of that camera's picture, and no two cameras show all of it",
};

function addDoubts() {
  const most = 500;
  const doubted = [...take.doubts.keys()].sort((a, b) => a - b);
  const counts = new Map();
  for (const codes of take.doubts.values()) for (const code of codes) counts.set(code, (counts.get(code) ?? 0) + 1);
  const each = [...counts].map(([code, count]) => `${code} (${count})`).join(", ");
  const cut = doubted.length > most ? `; the first ${most} are listed` : "";
  element("doubts-note").textContent = doubted.length ? `${doubted.length} of ${take.count} frames: ${each}${cut}.` : "None.";
  const known = new Set([...counts.keys()].map((code) => code.split(":")[0]).filter((code) => Object.hasOwn(DOUBTS, code)));
  for (const code of known) element("doubt-words").append(made("dt", code), made("dd", DOUBTS[code]));
  for (const frame of doubted.slice(0, most)) {
    const item = made("li");
    const button = item.appendChild(made("button", describe(frame).join(" · "), { type: "button" }));
    button.addEventListener("click", () => show(frame));
    element("doubts").append(item);
  }
}

function addRange() {
  const { notes, columns, rows } = take.range;
  element("range-note").textContent = notes;
  if (!rows.length) return (element("range").hidden = true);
  const head = made("tr");
  for (const column of ["angle", ...columns]) head.append(made("th", column, { scope: "col" }));
  element("range").tHead.append(head);
  for (const [name, ...cells] of rows) {
    const row = made("tr");
    row.append(made("th", name, { scope: "row" }), ...cells.map((cell) => made("td", cell)));
    element("range").tBodies[0].append(row);
  }
}

function zoom(factor) {
  const [first, last] = [take.time[0], take.time[take.count - 1]];
  const shortest = Math.min(0.2, last - first);
  const span = Math.max(shortest, Math.min(last - first, (state.end - state.start) * factor));
  const middle = take.time[state.frame];
  state.start = Math.max(first, Math.min(middle - span / 2, last - span));
  state.end = state.start + span;
  draw();
}

let clock = null;
function play(playing) {
  state.playing = playing && take.count > 1;
  element("play").setAttribute("aria-pressed", state.playing);
  element("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  element("play").textContent = state.playing ? "❚❚ Pause" : "▶ Play";
  if (!state.playing) return;
  if (state.frame === take.count - 1) show(0);
  clock = { at: performance.now(), time: take.time[state.frame] };
  requestAnimationFrame(step);
}

function step(at) {
  if (!state.playing) return;
  const time = clock.time + ((at - clock.at) / 1000) * Number(element("speed").value);
  const frame = frameAt(take, time);
  if (frame !== state.frame) show(frame);
  if (frame >= take.count - 1) return play(false);
  requestAnimationFrame(step);
}

function theme(name) {
  const system = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  document.documentElement.dataset.theme = name === "system" ? system : name;
  document.documentElement.dataset.choice = name;
  element("theme").textContent = `Colours: ${name}`;
  element("theme").setAttribute("aria-label", `Colours: ${name}`);
  draw();
}

function listen() {
  const click = (id, action) => element(id).addEventListener("click", action);
  element("frame").max = Math.max(0, take.count - 1);
  element("frame").addEventListener("input", (event) => show(Number(event.target.value)));
  click("previous", () => show(state.frame - 1));
  click("next", () => show(state.frame + 1));
  click("play", () => play(!state.playing));
  element("speed").addEventListener("change", () => play(state.playing));
  click("zoom-in", () => zoom(0.5));
  click("zoom-out", () => zoom(2));
  click("zoom-all", () => zoom(Infinity));
  click("view-back", () => hand.look(Math.PI, 1.5));
  click("view-palm", () => hand.look(Math.PI, -1.5));
  click("view-thumb", () => hand.look(take.side === "left" ? -Math.PI / 2 : Math.PI / 2, 0.1));
  click("nearer", () => hand.move(0.85));
  click("farther", () => hand.move(1 / 0.85));
  element("group").addEventListener("change", ({ target }) => {
    for (const box of document.querySelectorAll(".angle")) box.hidden = target.value !== "all" && box.dataset.group !== target.value;
    draw();
  });
  const choices = ["system", "light", "dark"];
  click("theme", () => theme(choices[(choices.indexOf(document.documentElement.dataset.choice) + 1) % 3]));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => theme(document.documentElement.dataset.choice));
  addEventListener("resize", draw);
  addEventListener("beforeprint", () => {
    for (const curve of curves) curve.visible = true;
    draw();
  });
  addEventListener("keydown", (event) => {
    if (/^(INPUT|SELECT|BUTTON)$/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const moves = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -Infinity, End: Infinity };
    if (event.key in moves) show(state.frame + moves[event.key]);
    else if (event.key === " ") play(!state.playing);
    else return;
    event.preventDefault();
  });
}

element("about").textContent = take.about;
if (!hand.gl) element("hand-note").textContent = "This browser cannot draw the hand (it has no WebGL2).";
addPictures();
addCurves();
addDoubts();
addRange();
listen();
theme("system");
