// Ties the pictures, the charts and the controls to one moment in time.
"use strict";

(function () {
  const find = (id) => document.getElementById(id);
  const data = JSON.parse(find("data").textContent);
  const scrollable = () => document.querySelectorAll(".scroll").forEach((box) => {
    const wide = box.scrollWidth > box.clientWidth + 1;
    box.classList.toggle("wide", wide);
    if (wide) box.tabIndex = 0; else box.removeAttribute("tabindex");
  });
  window.addEventListener("resize", scrollable);
  scrollable();
  if (!data.scenes.length) return;
  const state = { scene: null, runs: [], t: 0, playing: false, drawn: [], end: 1, whole: false };
  const STEP = 0.01;

  function option(select, labels, chosen) {
    select.replaceChildren(...labels.map((label, i) => new Option(label, i, false, i === chosen)));
  }

  function showScene(index) {
    state.scene = openScene(data.scenes[index]);
    const labels = state.scene.runs.map((run) => run.label);
    option(find("run-a"), labels, Math.max(labels.indexOf("passive"), 0));
    option(find("run-b"), labels, state.scene.best);
    state.t = state.scene.start;
    showRuns();
    state.spectrum = spectrum(find("spectrum"), state.scene);
  }

  function showRuns() {
    state.runs = [find("run-a"), find("run-b")].map((select) => state.scene.runs[select.value]);
    const [a, b] = state.runs;
    for (const [dot, run] of [[find("dot-a"), a], [find("dot-b"), b]]) dot.style.background = run.colour;
    state.end = Math.min(a.end, b.end);
    find("scrub").max = Math.floor(state.end / STEP);
    state.seeing = [b, a].find((run) => run.looks.length);
    document.querySelector(".stage").classList.toggle("blind", !state.seeing);
    if (state.seeing) {
      find("camera-note").textContent = `${state.seeing.label}: ${state.seeing.frames}`;
      loadImages(state.seeing, draw);
    }
    find("ahead-note").textContent = b.p
      ? `Road ahead: grey as it is, in colour as ${b.label} believes it (pale: in doubt).`
      : `Road ahead; ${b.label} is told nothing of it.`;
    state.drawn = timeCharts(find("charts"), state.scene, state.runs, seek);
    zoom(state.whole);
    draw();
  }

  function zoom(whole) {
    state.whole = whole;
    find("zoom").textContent = whole ? "Show the event" : "Show the whole drive";
    const [min, max] = whole ? [0, state.end] : state.scene.event;
    for (const chart of state.drawn) chart.setScale("x", { min, max: Math.min(max, state.end) });
  }

  function draw() {
    const [a, b] = state.runs;
    find("scrub").value = Math.round(state.t / STEP);
    find("clock").textContent = `${state.t.toFixed(2)} s`;
    if (state.seeing) drawCamera(find("camera"), state.scene, state.seeing, state.t);
    drawCars(find("cars"), state.scene, [a, b], state.t);
    drawAhead(find("ahead"), state.scene, b, state.t);
    for (const chart of state.drawn) {
      placeCursor(chart, state.t);
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

  function faster(by) {
    const speed = find("speed");
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex - by, 0), speed.options.length - 1);
  }

  function resize() {
    state.drawn.forEach((chart) => chart.setSize({ width: width(find("charts")), height: 160 }));
    state.spectrum.setSize({ width: width(find("spectrum")), height: 320 });
    draw();
  }

  document.addEventListener("keydown", (event) => {
    if (event.target.tagName === "SELECT" || event.ctrlKey || event.metaKey || event.altKey) return;
    const stride = event.shiftKey ? 10 * STEP : STEP;
    const moves = {
      ArrowLeft: () => seek(state.t - stride), ArrowRight: () => seek(state.t + stride),
      Home: () => seek(0), End: () => seek(state.end), e: () => seek(state.scene.start),
      "+": () => faster(1), "=": () => faster(1), "-": () => faster(-1),
    };
    const boxed = event.target.classList && event.target.classList.contains("scroll");
    if (event.key === " " && event.target.tagName !== "BUTTON" && event.target.tagName !== "SUMMARY") moves[" "] = () => play(!state.playing);
    if (!moves[event.key] || (boxed && event.key !== " ")) return;
    event.preventDefault();
    moves[event.key]();
  });
  find("play").addEventListener("click", () => play(!state.playing));
  find("back").addEventListener("click", () => seek(state.t - STEP));
  find("on").addEventListener("click", () => seek(state.t + STEP));
  find("zoom").addEventListener("click", () => zoom(!state.whole));
  find("scrub").addEventListener("input", (event) => seek(event.target.value * STEP));
  find("scene").addEventListener("change", (event) => showScene(event.target.value));
  for (const id of ["run-a", "run-b"]) find(id).addEventListener("change", showRuns);
  window.addEventListener("resize", resize);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", resize);
  option(find("scene"), data.scenes.map((scene) => `${scene.title} · ${scene.vehicle} · seed ${scene.seed}`), 0);
  showScene(0);
  document.documentElement.dataset.ready = Math.round(performance.now());
})();
