// Ties the pictures, the charts and the controls to one moment in time.
"use strict";

(function () {
  const find = (id) => document.getElementById(id);
  const data = JSON.parse(find("data").textContent);
  if (!data.scenes.length) return;
  const state = { scene: null, runs: [], t: 0, playing: false, drawn: [], end: 1 };
  const STEP = 0.01;

  function option(select, labels, chosen) {
    select.replaceChildren(...labels.map((label, i) => new Option(label, i, false, i === chosen)));
  }

  function showScene(index) {
    state.scene = openScene(data.scenes[index]);
    const labels = state.scene.runs.map((run) => run.label);
    const first = Math.max(labels.indexOf("passive"), 0);
    option(find("run-a"), labels, first);
    option(find("run-b"), labels, state.scene.best);
    state.t = state.scene.start;
    showRuns();
    state.spectrum = spectrum(find("spectrum"), state.scene);
  }

  function showRuns() {
    state.runs = [find("run-a"), find("run-b")].map((select) => state.scene.runs[select.value]);
    state.end = Math.min(...state.runs.map((run) => run.end));
    find("scrub").max = Math.floor(state.end / STEP);
    const seen = state.runs[1];
    find("camera-note").textContent = seen.frames;
    find("ahead-note").textContent = seen.p
      ? "Road ahead of the right front wheel: grey as it is, blue as the controller believes it (pale: in doubt)."
      : "Road ahead of the right front wheel; this controller is told nothing of it.";
    state.drawn = timeCharts(find("charts"), state.scene, state.runs, () => state.t, seek);
    draw();
  }

  function draw() {
    const [a, b] = state.runs;
    find("scrub").value = Math.round(state.t / STEP);
    find("clock").textContent = `${state.t.toFixed(2)} s`;
    drawCamera(find("camera"), state.scene, b, state.t);
    drawCars(find("cars"), state.scene, [a, b], state.t);
    drawAhead(find("ahead"), state.scene, b, state.t);
    for (const chart of state.drawn) {
      chart.redraw(false, false);
      chart.setLegend({ idx: Math.min(Math.round(state.t * state.scene.rate), chart.data[0].length - 1) });
    }
  }

  function seek(t) {
    state.t = Math.min(Math.max(t, 0), state.end);
    draw();
  }

  function play(on) {
    if (on && state.t >= state.end) state.t = 0;
    state.playing = on;
    find("play").textContent = on ? "❚❚" : "▶";
    let last = performance.now();
    const step = (now) => {
      if (!state.playing) return;
      seek(state.t + ((now - last) / 1000) * Number(find("speed").value));
      last = now;
      if (state.t >= state.end) play(false); else requestAnimationFrame(step);
    };
    if (on) requestAnimationFrame(step);
  }

  function resize() {
    state.drawn.forEach((chart) => chart.setSize({ width: width(find("charts")), height: 150 }));
    state.spectrum.setSize({ width: width(find("spectrum")), height: 300 });
    draw();
  }

  document.addEventListener("keydown", (event) => {
    if (event.target.tagName === "SELECT" || event.ctrlKey || event.metaKey || event.altKey) return;
    const stride = event.shiftKey ? 10 * STEP : STEP;
    const moves = { ArrowLeft: () => seek(state.t - stride), ArrowRight: () => seek(state.t + stride), Home: () => seek(0), End: () => seek(state.end) };
    if (event.key === " " && event.target.tagName !== "BUTTON" && event.target.tagName !== "SUMMARY") moves[" "] = () => play(!state.playing);
    if (!moves[event.key]) return;
    event.preventDefault();
    moves[event.key]();
  });
  find("play").addEventListener("click", () => play(!state.playing));
  find("scrub").addEventListener("input", (event) => seek(event.target.value * STEP));
  find("scene").addEventListener("change", (event) => showScene(event.target.value));
  for (const id of ["run-a", "run-b"]) find(id).addEventListener("change", showRuns);
  window.addEventListener("resize", resize);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", resize);
  option(find("scene"), data.scenes.map((scene) => `${scene.title} · ${scene.vehicle} · seed ${scene.seed}`), 0);
  showScene(0);
  document.documentElement.dataset.ready = Math.round(performance.now());
})();
