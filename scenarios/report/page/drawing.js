// The three pictures of the replay: camera view, side view of both cars, road ahead.
"use strict";

const ENLARGED = 4;

function colour(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); }

// Number with a fixed count of decimals, without the sign of a zero.
function fixed(value, digits) {
  if (value == null) return "–";
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

function sheet(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = "12px system-ui, sans-serif";
  return { pen, width, height };
}

// Decodes the images of a run; `ready` is called for each.
function loadImages(run, ready) {
  for (const look of run.looks) {
    if (!look.image || look.picture) continue;
    look.picture = new Image();
    look.picture.onload = ready;
    look.picture.src = look.image;
  }
}

// The newest exposure until t whose image, if it has one, is decoded: image and boxes are of one exposure.
function exposureAt(run, t) {
  let index = lastBefore(run.looks.length, (i) => run.looks[i].t, t);
  const waits = (look) => look.image && !(look.picture && look.picture.complete && look.picture.naturalWidth);
  while (index >= 0 && waits(run.looks[index])) index--;
  return run.looks[index];
}

function drawCamera(canvas, scene, run, t) {
  const { pen, width, height } = sheet(canvas);
  const look = exposureAt(run, t), scale = width / scene.image[0];
  if (!look) {
    pen.fillStyle = colour("faint");
    pen.textAlign = "center";
    pen.fillText("before the first exposure", width / 2, height / 2);
    return;
  }
  if (look.picture) pen.drawImage(look.picture, 0, 0, width, height);
  for (const track of look.tracks) {
    pen.strokeStyle = colour(scene.inks[scene.classes.indexOf(track.class.replace("_", " "))]);
    pen.setLineDash(track.confirmed ? [] : [4, 4]);
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(track.line[0] * scale, track.line[1] * scale);
    pen.lineTo(track.line[2] * scale, track.line[3] * scale);
    pen.stroke();
  }
  pen.setLineDash([]);
  look.boxes.forEach((box, i) => drawBox(pen, box.map((v) => v * scale), `${scene.classes[look.classes[i]]} ${look.scores[i].toFixed(2)}`, colour(scene.inks[look.classes[i]]), width));
  const told = `exposed at ${look.t.toFixed(2)} s`;
  tag(pen, told, width - pen.measureText(told).width - 10, height - 8, "#ffffff", "#000000a0");
}

function drawBox(pen, [left, top, right, bottom], name, ink, width) {
  pen.strokeStyle = ink;
  pen.lineWidth = 2;
  pen.strokeRect(left, top, right - left, bottom - top);
  const room = pen.measureText(name).width + 8;
  tag(pen, name, Math.max(Math.min(left + 4, width - room), 4), top < 24 ? bottom + 16 : top - 7, "#000000", ink);
}

// Text on a ground of its own, legible on any image.
function tag(pen, text, x, y, ink, ground) {
  pen.textAlign = "left";
  pen.fillStyle = ground;
  pen.fillRect(x - 4, y - 12, pen.measureText(text).width + 8, 16);
  pen.fillStyle = ink;
  pen.fillText(text, x, y);
}

const BODY = [[2.05, 0.32], [2.0, 0.72], [1.0, 0.86], [0.45, 1.38], [-0.95, 1.42], [-1.75, 1.0], [-2.1, 0.9], [-2.1, 0.34]];
const GLASS = [[0.85, 0.88], [0.42, 1.3], [-0.9, 1.34], [-1.45, 0.97]];

function drawCars(canvas, scene, runs, t) {
  const { pen, width, height } = sheet(canvas);
  runs.forEach((run, i) => drawCar(pen, scene, run, t, width, (i * height) / runs.length, height / runs.length));
}

function drawCar(pen, scene, run, t, width, top, height) {
  const scale = Math.min(width / 8.5, height * 0.42), span = width / scale, x = at(scene, run, "x", t);
  const column = (forward) => (forward + 0.42 * span) * scale, ground = top + height * 0.8;
  const row = (up) => ground - up * scale;
  pen.save();
  pen.beginPath(); pen.rect(0, top, width, height); pen.clip();
  pen.beginPath();
  pen.moveTo(0, top + height);
  for (let px = 0; px <= width; px += 2) pen.lineTo(px, row(ENLARGED * roadHeight(scene, x + px / scale - 0.42 * span)));
  pen.lineTo(width, top + height);
  pen.fillStyle = colour("ground");
  pen.fill();
  // A quarter car has one wheel, at its centre: the body is drawn around it as around a front wheel.
  const single = scene.axles.length === 1, axles = single ? [0, -2.7] : scene.axles, shift = single ? -1.3 : 0;
  const heave = at(scene, run, "heave", t) * ENLARGED, angle = at(scene, run, "pitch", t) * ENLARGED;
  const shape = (points, fill) => {
    pen.beginPath();
    for (const [px, pz] of points) {
      const bx = px * Math.cos(angle) + (pz - 0.5) * Math.sin(angle) + shift;
      const bz = 0.5 + (pz - 0.5) * Math.cos(angle) - px * Math.sin(angle) + heave;
      pen.lineTo(column(bx), row(bz));
    }
    pen.closePath(); pen.fillStyle = fill; pen.fill();
  };
  shape(BODY, run.colour);
  shape(GLASS, colour("card"));
  axles.forEach((axle, i) => {
    const lift = single && i ? 0 : at(scene, run, i ? "rear" : "front", t) * ENLARGED;
    for (const [share, fill] of [[1, "tyre"], [0.55, "road"]]) {
      pen.beginPath();
      pen.arc(column(axle), row(scene.radius + lift), share * scene.radius * scale, 0, 2 * Math.PI);
      pen.fillStyle = colour(fill); pen.fill();
    }
  });
  pen.fillStyle = colour("ink");
  pen.textAlign = "left";
  pen.fillText(run.label, 8, top + height - 6);
  pen.textAlign = "right";
  pen.fillText(`${fixed(at(scene, run, "acc", t), 1)} m/s²`, width - 8, top + height - 6);
  pen.restore();
}

// Step of an axis: 1, 2 or 5 times a power of ten, at most `most` of them over the span.
function roundStep(span, most) {
  const raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((v) => v * power).find((v) => v >= raw - 1e-12);
}

function drawAhead(canvas, scene, run, t) {
  const { pen, width, height } = sheet(canvas);
  const from = -1, to = 10, left = 44, bottom = height - 34, wheel = at(scene, run, "x", t) + frontAxle(scene);
  const column = (d) => left + ((d - from) / (to - from)) * (width - left - 12);
  const [low, high] = scene.z.reduce(([least, most], z) => [Math.min(least, z), Math.max(most, z)], [0, 0]);
  const room = 0.3 * Math.max(high - low, 0.03), least = low - room, most = high + room;
  const row = (z) => 4 + ((bottom - 8) * (most - z)) / (most - least);
  pen.strokeStyle = colour("grid"); pen.fillStyle = colour("faint"); pen.lineWidth = 1;
  pen.textAlign = "center";
  for (let d = 0; d <= to; d += 2) {
    pen.beginPath(); pen.moveTo(column(d), 0); pen.lineTo(column(d), bottom); pen.stroke();
    pen.fillText(`${d}`, column(d), bottom + 14);
  }
  pen.fillText(scene.names.ahead, (left + width) / 2, height - 5);
  pen.textAlign = "right";
  const step = roundStep(most - least, 5);
  for (let k = Math.ceil(least / step); k * step <= most; k++) {
    pen.beginPath(); pen.moveTo(left, row(k * step)); pen.lineTo(width - 12, row(k * step)); pen.stroke();
    pen.fillText(`${Math.round(1000 * k * step)}`, left - 5, row(k * step) + 4);
  }
  pen.save(); pen.translate(12, bottom / 2); pen.rotate(-Math.PI / 2); pen.textAlign = "center";
  pen.fillText("height (mm)", 0, 0); pen.restore();
  pen.save();
  pen.beginPath(); pen.rect(left, 0, width - left - 12, bottom); pen.clip();
  pen.strokeStyle = colour("road"); pen.lineWidth = 3; pen.beginPath();
  for (let px = left; px <= width; px += 1.5) pen.lineTo(px, row(roadHeight(scene, wheel + from + ((px - left) / (width - left - 12)) * (to - from))));
  pen.stroke();
  drawBelief(pen, scene, run, t, wheel, column, row);
  pen.restore();
}

function drawBelief(pen, scene, run, t, wheel, column, row) {
  const p = run.p, index = p ? lastBefore(p.t.length, (i) => p.t[i], t) : -1;
  if (index < 0) return;
  const n = p.distance.length, moved = wheel - (at(scene, run, "x", p.t[index]) + frontAxle(scene));
  pen.strokeStyle = pen.fillStyle = run.colour;
  for (let i = 1; i < n; i++) {
    const k = index * n + i;
    pen.globalAlpha = 0.3 + 0.7 * Math.max(p.existence[k], p.existence[k - 1]);
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(column(p.distance[i - 1] - moved), row(p.height[k - 1]));
    pen.lineTo(column(p.distance[i] - moved), row(p.height[k]));
    pen.stroke();
    if (Math.abs(p.height[k]) > 0.01 && p.sigma[k] > 0) {
      pen.globalAlpha = 0.12;
      pen.fillRect(column(p.distance[i] - moved - p.sigma[k]), row(Math.max(p.height[k], 0)), column(2 * p.sigma[k]) - column(0), Math.abs(row(p.height[k]) - row(0)));
    }
  }
}
