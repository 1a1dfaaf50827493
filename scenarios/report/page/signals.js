// Numbers as they are packed in the page, and looking them up by time.
"use strict";

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function unpackAll(packed) {
  return Object.fromEntries(Object.entries(packed).map(([name, text]) => [name, unpack(text)]));
}

function openScene(scene) {
  if (scene.open) return scene;
  scene.z = unpack(scene.road.z);
  for (const run of scene.runs) {
    run.s = unpackAll(run.signals);
    run.end = (run.s.x.length - 1) / scene.rate;
    run.p = run.preview && unpackAll(run.preview);
  }
  scene.open = true;
  return scene;
}

// Value of a signal at time t (s), linear between samples.
function at(scene, run, name, t) {
  const values = run.s[name];
  if (!values) return 0;
  const place = Math.min(Math.max(t * scene.rate, 0), values.length - 1);
  const low = Math.floor(place), high = Math.min(low + 1, values.length - 1);
  return values[low] + (values[high] - values[low]) * (place - low);
}

function roadHeight(scene, x) {
  const place = Math.min(Math.max(x / scene.road.step, 0), scene.z.length - 1);
  const low = Math.floor(place), high = Math.min(low + 1, scene.z.length - 1);
  return scene.z[low] + (scene.z[high] - scene.z[low]) * (place - low);
}

// Index of the last entry of an ascending list whose key is not after t; -1 before the first.
function lastBefore(length, key, t) {
  let low = 0, high = length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (key(middle) <= t + 1e-6) low = middle + 1; else high = middle;
  }
  return low - 1;
}

function frontAxle(scene) { return scene.axles[0]; }
