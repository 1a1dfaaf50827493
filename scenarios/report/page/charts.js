// The charts over time with their common cursor, and the spectrum.
"use strict";

const PANELS = [
  { name: "acc", title: "body acceleration (m/s²)", factor: 1 },
  { name: "damping", title: "front damper (kN·s/m)", factor: 1e-3 },
  { name: "force", title: "front damper force (kN)", factor: 1e-3 },
];

function axis(extra) {
  return Object.assign({ stroke: () => colour("faint"), grid: { stroke: () => colour("grid"), width: 1 }, ticks: { show: false }, font: "11px system-ui" }, extra);
}

function width(place) { return Math.max(place.clientWidth, 240); }

// Draws the panels of two runs into `place`; `seek` is called with a time when a chart is clicked.
function timeCharts(place, scene, runs, now, seek) {
  place.replaceChildren();
  const length = Math.min(...runs.map((run) => run.s.x.length));
  const time = Float64Array.from({ length }, (_, i) => i / scene.rate);
  const sync = uPlot.sync("time");
  const panels = PANELS.concat(runs.some((run) => run.s.active && run.s.active.some((v) => v)) ? [{ name: "active", title: "front actuator force (kN)", factor: 1e-3 }] : []);
  return panels.map((panel) => {
    const values = runs.map((run) => Float64Array.from(run.s[panel.name].subarray(0, length), (v) => v * panel.factor));
    const chart = new uPlot({
      width: width(place), height: 150, title: "", cursor: { sync: { key: sync.key }, drag: { x: true, y: false } },
      scales: { x: { time: false } },
      axes: [axis({ size: 24 }), axis({ label: panel.title, labelSize: 18, labelFont: "11px system-ui", size: 40 })],
      series: [{ label: "time (s)", value: (_, v) => (v == null ? "" : v.toFixed(3)) }].concat(
        runs.map((run, i) => ({ label: run.label, stroke: () => colour(i ? "b" : "a"), width: 1.4, value: (_, v) => (v == null ? "" : v.toFixed(2)) }))),
      hooks: {
        draw: [(chart) => cursorAt(chart, now(), runs)],
        ready: [(chart) => chart.over.addEventListener("click", (event) => seek(chart.posToVal(event.offsetX, "x")))],
      },
    }, [time, ...values], place);
    return chart;
  });
}

function cursorAt(chart, t, runs) {
  const pen = chart.ctx, { left, top, width, height } = chart.bbox;
  const mark = (time, ink, wide) => {
    const x = chart.valToPos(time, "x", true);
    if (x < left || x > left + width) return;
    pen.save();
    pen.strokeStyle = ink; pen.lineWidth = wide; pen.beginPath(); pen.moveTo(x, top); pen.lineTo(x, top + height); pen.stroke();
    pen.restore();
  };
  for (const time of runs[runs.length - 1].fallbacks) mark(time, colour("warn"), 1);
  mark(t, colour("hole"), 1.5 * (window.devicePixelRatio || 1));
}

function spectrum(place, scene) {
  place.replaceChildren();
  const inks = ["a", "bump", "good", "b", "hole", "warn", "road"];
  const f = unpack(scene.psd.f), values = scene.psd.density.map(unpack), wk = unpack(scene.psd.wk);
  return new uPlot({
    width: width(place), height: 300,
    scales: { x: { time: false, distr: 3 }, y: { distr: 3, range: (_, low, high) => [Math.max(low, high * 1e-6), high * 2] }, wk: { distr: 1, range: [0, 1.2] } },
    axes: [axis({ label: "frequency (Hz)", labelSize: 20, size: 30, labelFont: "11px system-ui" }), axis({ label: "(m/s²)²/Hz", labelSize: 20, size: 54, values: (_, ticks) => ticks.map((v) => (v == null ? "" : String(Number(v.toPrecision(1))))), labelFont: "11px system-ui" }), axis({ scale: "wk", side: 1, label: "|Wk|", labelSize: 18, grid: { show: false }, labelFont: "11px system-ui" })],
    series: [{ label: "Hz", value: (_, v) => (v == null ? "" : v.toFixed(1)) }]
      .concat(scene.runs.map((run, i) => ({ label: run.label, stroke: () => colour(runInk(scene, run, inks, i)), width: 1.5, value: (_, v) => (v == null ? "" : v.toExponential(1)) })))
      .concat([{ label: "|Wk|", scale: "wk", stroke: () => colour("faint"), dash: [6, 5], width: 1.5, value: (_, v) => (v == null ? "" : v.toFixed(2)) }]),
  }, [f, ...values, wk], place);
}

function runInk(scene, run, inks, index) {
  if (run.label === "passive") return "a";
  if (index === scene.runs.length - 1) return "b";
  return ["bump", "good", "hole", "warn", "road"][index % 5];
}
