"use strict";
// Shows the pixels that the server sends, and sends it the view that the reader asks for.

const $ = (id) => document.getElementById(id);
const canvas = $("picture"), paper = canvas.getContext("2d");
let status = null;  // the last header of the server
let view = null;    // the view as the reader has moved it
let unsent = null, sending = false, acknowledged = 0;

function say(text) { $("message").textContent = text; }
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

// --- What the server sends -------------------------------------------------------------------------------

async function follow() {
  for (let version = 0, failures = 0; ;) {
    try {
      const answer = await fetch(`frame?since=${version}`);
      if (!answer.ok) throw new Error(await answer.text());
      const bytes = await answer.arrayBuffer();
      const size = new DataView(bytes).getUint32(0, true);
      const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, size)));
      version = header.version, failures = 0;
      show(header, bytes, 4 + size);
    } catch (error) {
      if (++failures > 1) showError("The viewer does not answer. Is `oktett view` still running?");
      await pause(1000);
    }
  }
}

function show(header, bytes, at) {
  if (canvas.width !== header.width || canvas.height !== header.height)
    canvas.width = header.width, canvas.height = header.height, $("mark").hidden = true;
  for (const [x, y, width, height, coarse] of header.tiles) {
    const tile = new ImageData(new Uint8ClampedArray(bytes, at, 4 * width * height), width, height);
    at += 4 * width * height;
    if (!coarse) paper.putImageData(tile, x, y);
    else stretch(tile);
  }
  status = header;
  // A view that the reader has moved on from since is no news.
  if (unsent === null && !sending && header.view >= acknowledged) view = header.state;
  showStatus();
}

function stretch(tile) {
  const small = document.createElement("canvas");
  small.width = tile.width, small.height = tile.height;
  small.getContext("2d").putImageData(tile, 0, 0);
  paper.clearRect(0, 0, canvas.width, canvas.height);
  paper.drawImage(small, 0, 0, canvas.width, canvas.height);
}

function showError(text) {
  if ($("error").textContent !== text) $("error").textContent = text;
  $("error").hidden = text === "";
}

function showStatus() {
  const s = status, settled = s.settled && s.shown === s.view;
  const text = `${s.width} × ${s.height}, ` +
    (settled ? "finished" : `${s.samples} of ${s.wanted} samples a pixel`);
  if ($("progress").textContent !== text) $("progress").textContent = text;
  document.body.dataset.view = s.view, document.body.dataset.edits = s.edits;
  document.body.dataset.settled = settled && unsent === null && !sending && s.view >= acknowledged;
  let error = "";
  if (s.error !== undefined) {
    const place = s.file && s.line ? `${s.file}:${s.line}` : s.file;
    error = (place && !s.error.includes(place) ? `${place}: ` : "") + s.error + (s.text ? `\n${s.text}` : "");
  }
  showError(error);
  showLayers(s.layers);
  if (document.activeElement !== $("exposure")) $("exposure").value = view.exposure;
  $("stops").textContent = String(view.exposure);
  if ($("tone").length === 0) for (const name of s.tones) $("tone").add(new Option(name));
  $("tone").value = view.tone;
}

function showLayers(names) {
  const box = $("layers");
  if (box.dataset.names !== names.join()) {
    box.dataset.names = names.join();
    box.replaceChildren(...names.map((name) => {
      const button = document.createElement("button");
      button.type = "button", button.textContent = name.replace(/^light_/, "light "), button.dataset.layer = name;
      button.addEventListener("click", () => change({layer: name}));
      return button;
    }));
  }
  for (const button of box.children) button.setAttribute("aria-pressed", button.dataset.layer === view.layer);
}

// --- What the reader asks for ----------------------------------------------------------------------------

function change(part) {
  if (view === null) return;
  view = {...view, ...part};
  unsent = {...unsent, ...part};
  document.body.dataset.settled = false;
  $("mark").hidden = true;
  send();
}

/// One request at a time: what changes meanwhile goes with the next.
async function send() {
  if (sending) return;
  sending = true;
  while (unsent !== null) {
    const lines = Object.entries(unsent).map(([key, value]) => `${key}=${Array.isArray(value) ? value.join(" ") : value}`);
    unsent = null;
    try {
      const answer = await fetch("view", {method: "POST", body: lines.join("\n"), headers: {"Content-Type": "application/x-oktett-view"}});
      if (answer.ok) acknowledged = (await answer.json()).view, say("");
      else say(await answer.text()), view = status.state;
    } catch (error) {
      say("The viewer does not answer.");
    }
  }
  sending = false;
  showLayers(status.layers);
}

function pixelOf(event) {
  const box = canvas.getBoundingClientRect();
  const inside = (at, size) => Math.max(0, Math.min(size - 1, Math.floor(at * size)));
  return [inside((event.clientX - box.left) / box.width, canvas.width),
    inside((event.clientY - box.top) / box.height, canvas.height)];
}

// Whether the scene counts from its own origin: the place is then the point, which is made of floats.
const isNear = (found) => found.place.every((x, k) => Math.fround(x) === Math.fround(found.point[k]));

async function pick(event) {
  const [x, y] = pixelOf(event);
  const answer = await fetch(`pick?x=${x}&y=${y}`);
  if (!answer.ok) { say(await answer.text()); return null; }
  const found = await answer.json();
  const rows = [["pixel", `${x}, ${y}`]];
  const list = (v, digits = 6) => v.map((n) => n === null ? "–" : Number(n.toPrecision(digits))).join(", ");
  if (!found.hit) rows.push(["meets", "nothing"]);
  else rows.push(["object", found.object_name ? `${found.object_name} (${found.object})` : found.object],
    ["surface", found.surface], ["material", found.material || "–"], ["primitive", found.primitive],
    ["point", list(found.place, isNear(found) ? 6 : 10)], ["normal", list(found.normal)],
    ["distance", found.t], ["depth", found.depth],
    ["u, v", list([found.u, found.v])]);
  $("pick").replaceChildren(...rows.flatMap(([name, value]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name, dd.textContent = value;
    return [dt, dd];
  }));
  const box = canvas.getBoundingClientRect(), stage = $("stage").getBoundingClientRect();
  $("mark").style.left = `${box.left - stage.left + (x + 0.5) * box.width / canvas.width}px`;
  $("mark").style.top = `${box.top - stage.top + (y + 0.5) * box.height / canvas.height}px`;
  $("mark").hidden = false;
  return found;
}

async function focusOn(event) {
  const found = await pick(event);
  if (found === null || !found.hit) return;
  change(view.lens ? {at: found.point, focus: found.depth} : {at: found.point});
}

// --- Pointers --------------------------------------------------------------------------------------------

const pointers = new Map();
let moved = 0;

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, [event.clientX, event.clientY]);
  moved = pointers.size > 1 ? 99 : 0;
});

canvas.addEventListener("pointermove", (event) => {
  const last = pointers.get(event.pointerId);
  if (last === undefined || view === null) return;
  const now = [event.clientX, event.clientY], dx = now[0] - last[0], dy = now[1] - last[1];
  moved += Math.hypot(dx, dy);
  if (moved < 4) return;
  const others = [...pointers].filter(([id]) => id !== event.pointerId);
  pointers.set(event.pointerId, now);
  const size = canvas.clientHeight;
  if (others.length > 0) {
    // Each of two fingers brings half of the move.
    const other = others[0][1], gap = (p) => Math.max(20, Math.hypot(p[0] - other[0], p[1] - other[1]));
    const panned = {...view, ...pan(view, -dx / size / 2, dy / size / 2)};
    change({from: panned.from, at: panned.at, ...zoom(panned, gap(last) / gap(now))});
  } else if (event.shiftKey || event.buttons & 6) {
    change(pan(view, -dx / size, dy / size));
  } else {
    change(orbit(view, -dx / size * 4, dy / size * 4));
  }
});

canvas.addEventListener("pointerup", (event) => {
  const clicked = pointers.delete(event.pointerId) && moved < 4 && event.button === 0;
  if (clicked) pick(event);
});
canvas.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("dblclick", focusOn);
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  const unit_of_wheel = [1, 16, 400][event.deltaMode];
  if (view !== null) change(zoom(view, Math.exp(Math.max(-400, Math.min(400, event.deltaY * unit_of_wheel)) * 0.0012)));
}, {passive: false});

// --- Keys and buttons ------------------------------------------------------------------------------------

const frameAll = () => change(frameBall(view, status.center, status.radius, canvas.width / canvas.height));
const goHome = () => {
  const {from, at, up, fov, height, orthographic} = status.home;
  change({from, at, up, ...(orthographic ? {height} : {fov})});
};

canvas.addEventListener("keydown", (event) => {
  if (view === null || event.ctrlKey || event.altKey || event.metaKey) return;
  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  const arrow = arrows[event.key];
  if (arrow) change(event.shiftKey ? pan(view, arrow[0] * 0.05, arrow[1] * 0.05) : orbit(view, arrow[0] * 0.1, arrow[1] * 0.1));
  else if (event.key === "+" || event.key === "=") change(zoom(view, 0.9));
  else if (event.key === "-") change(zoom(view, 1 / 0.9));
  else if (event.key === "f") frameAll();
  else if (event.key === "h") goHome();
  else return;
  event.preventDefault();
});

async function save(extension) {
  say("Saving as soon as the picture is finished");
  const answer = await fetch(`picture.${extension}`);
  if (!answer.ok) return say(await answer.text());
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = `picture.${extension}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  say(`Saved picture.${extension}`);
}

async function copyCamera() {
  const answer = await fetch("camera"), text = await answer.text();
  $("yaml").textContent = text, $("yaml").hidden = false;
  try {
    await navigator.clipboard.writeText(text);
    say("Copied; put it in place of the scene's camera");
  } catch (error) {
    say("The browser does not let this page copy; take it from here");
  }
}

$("frame").addEventListener("click", frameAll);
$("home").addEventListener("click", goHome);
$("camera").addEventListener("click", copyCamera);
$("png").addEventListener("click", () => save("png"));
$("exr").addEventListener("click", () => save("exr"));
$("exposure").addEventListener("input", () => change({exposure: Number($("exposure").value)}));
$("tone").addEventListener("change", () => change({tone: $("tone").value}));
follow();
