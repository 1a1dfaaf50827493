// The three pictures of the replay: camera view, side view of both cars, road ahead.
"use strict";

const ENLARGED = 4;

function colour(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); }

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

function drawCamera(canvas, scene, run, t) {
  const { pen, width, height } = sheet(canvas);
  const index = run ? lastBefore(run.looks.length, (i) => run.looks[i].t, t) : -1;
  if (index < 0) {
    pen.fillStyle = colour("faint");
    pen.textAlign = "center";
    pen.fillText(run && run.looks.length ? "before the first exposure" : "this run drove without a camera", width / 2, height / 2);
    return;
  }
  const look = run.looks[index], scale = width / scene.image[0];
  const picture = imageOf(run, index, () => drawCamera(canvas, scene, run, t));
  if (picture) pen.drawImage(picture, 0, 0, width, height);
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
  look.boxes.forEach((box, i) => {
    pen.strokeStyle = pen.fillStyle = colour(scene.inks[look.classes[i]]);
    pen.lineWidth = 1.5;
    pen.strokeRect(box[0] * scale, box[1] * scale, (box[2] - box[0]) * scale, (box[3] - box[1]) * scale);
    pen.fillText(`${scene.classes[look.classes[i]]} ${look.scores[i].toFixed(2)}`, box[0] * scale + 2, Math.max(box[1] * scale - 4, 12));
  });
}

// The newest stored image at or before an exposure, decoded when first wanted.
function imageOf(run, index, ready) {
  while (index >= 0 && !run.looks[index].image) index--;
  if (index < 0) return null;
  const look = run.looks[index];
  if (!look.picture) {
    look.picture = new Image();
    look.picture.onload = ready;
    look.picture.src = look.image;
  }
  return look.picture.complete && look.picture.naturalWidth ? look.picture : null;
}

const BODY = [[2.05, 0.32], [2.0, 0.72], [1.0, 0.86], [0.45, 1.38], [-0.95, 1.42], [-1.75, 1.0], [-2.1, 0.9], [-2.1, 0.34]];
const GLASS = [[0.85, 0.88], [0.42, 1.3], [-0.9, 1.34], [-1.45, 0.97]];

function drawCars(canvas, scene, runs, t) {
  const { pen, width, height } = sheet(canvas);
  runs.forEach((run, i) => drawCar(pen, scene, run, t, width, (i * height) / runs.length, height / runs.length, i ? "b" : "a"));
}

function drawCar(pen, scene, run, t, width, top, height, ink) {
  const span = width > 560 ? 13 : 8.5, scale = width / span, x = at(scene, run, "x", t);
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
  shape(BODY, colour(ink));
  shape(GLASS, colour("card"));
  axles.forEach((axle, i) => {
    const lift = single && i ? 0 : at(scene, run, i ? "rear" : "front", t) * ENLARGED;
    for (const [share, fill] of [[1, "ink"], [0.55, "road"]]) {
      pen.beginPath();
      pen.arc(column(axle), row(scene.radius + lift), share * scene.radius * scale, 0, 2 * Math.PI);
      pen.fillStyle = colour(fill); pen.fill();
    }
  });
  pen.fillStyle = colour("ink");
  pen.textAlign = "left";
  pen.fillText(run.label, 8, top + height - 6);
  pen.textAlign = "right";
  pen.fillText(`${at(scene, run, "acc", t).toFixed(1)} m/s²`, width - 8, top + height - 6);
  pen.restore();
}

function drawAhead(canvas, scene, run, t) {
  const { pen, width, height } = sheet(canvas);
  const from = -1, to = 10, wheel = at(scene, run, "x", t) + frontAxle(scene);
  const column = (d) => ((d - from) / (to - from)) * width;
  const reach = Math.max(0.06, 1.7 * scene.z.reduce((most, z) => Math.max(most, Math.abs(z)), 0));
  const row = (z) => height * 0.46 - (z / reach) * height * 0.4;
  pen.strokeStyle = colour("grid"); pen.fillStyle = colour("faint"); pen.textAlign = "center";
  for (let d = 0; d <= to; d += 2) {
    pen.beginPath(); pen.moveTo(column(d), 0); pen.lineTo(column(d), height - 16); pen.stroke();
    pen.fillText(`${d} m`, Math.min(column(d), width - 14), height - 4);
  }
  pen.strokeStyle = colour("road"); pen.lineWidth = 2; pen.beginPath();
  for (let px = 0; px <= width; px += 1.5) pen.lineTo(px, row(roadHeight(scene, wheel + from + (px / width) * (to - from))));
  pen.stroke();
  const p = run.p, index = p ? lastBefore(p.t.length, (i) => p.t[i], t) : -1;
  if (index < 0) return;
  const n = p.distance.length, moved = wheel - (at(scene, run, "x", p.t[index]) + frontAxle(scene));
  pen.strokeStyle = colour("b");
  for (let i = 1; i < n; i++) {
    const k = index * n + i;
    pen.globalAlpha = 0.3 + 0.7 * Math.max(p.existence[k], p.existence[k - 1]);
    pen.lineWidth = 2.5;
    pen.beginPath();
    pen.moveTo(column(p.distance[i - 1] - moved), row(p.height[k - 1]));
    pen.lineTo(column(p.distance[i] - moved), row(p.height[k]));
    pen.stroke();
    if (Math.abs(p.height[k]) > 0.01 && p.sigma[k] > 0) {
      pen.globalAlpha = 0.12;
      pen.fillStyle = colour("b");
      pen.fillRect(column(p.distance[i] - moved - p.sigma[k]), row(Math.max(p.height[k], 0)), column(2 * p.sigma[k]) - column(0), Math.abs(row(p.height[k]) - row(0)));
    }
  }
  pen.globalAlpha = 1;
}
