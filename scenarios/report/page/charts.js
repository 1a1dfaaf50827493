// The charts over time with their common cursor, and the spectrum.
"use strict";

const FONT = "11px system-ui, sans-serif";

function axis(extra) {
  return Object.assign({ stroke: () => colour("faint"), grid: { stroke: () => colour("grid"), width: 1 }, ticks: { show: false }, font: FONT, labelFont: FONT, labelSize: 18 }, extra);
}

function width(place) { return Math.max(place.clientWidth, 240); }

function series(run, digits) {
  return { label: run.label, stroke: run.colour, dash: run.dash.length ? run.dash : undefined, width: 1.6, value: (_, v) => fixed(v, digits) };
}

const LEGEND = { markers: { fill: (chart, index) => chart.series[index].stroke(chart, index), width: 0 } };

function panelsOf(scene, runs) {
  const panels = [
    { name: "acc", title: `${scene.names.acceleration} (m/s²)`, factor: 1 },
    { name: "damping", title: `${scene.names.damping} (kN·s/m)`, factor: 1e-3 },
    { name: "force", title: `${scene.names.force} (kN)`, factor: 1e-3 },
  ];
  const active = runs.some((run) => run.s.active && run.s.active.some((v) => v));
  return active ? panels.concat([{ name: "active", title: `${scene.names.active} (kN)`, factor: 1e-3 }]) : panels;
}

// Draws the panels of two runs into `place`; `seek` is called with a time when a chart is clicked.
function timeCharts(place, scene, runs, seek) {
  place.replaceChildren();
  const length = Math.min(...runs.map((run) => run.s.x.length));
  const time = Float64Array.from({ length }, (_, i) => i / scene.rate);
  const sync = uPlot.sync("time");
  return panelsOf(scene, runs).map((panel) => {
    const values = runs.map((run) => Float64Array.from(run.s[panel.name].subarray(0, length), (v) => v * panel.factor));
    const title = document.createElement("h3");
    title.textContent = panel.title;
    place.append(title);
    return new uPlot({
      width: width(place), height: 160, legend: LEGEND, cursor: { sync: { key: sync.key }, drag: { x: true, y: false } },
      scales: { x: { time: false, range: (_, low, high) => [low, high] } },
      axes: [axis({ size: 22, label: "time (s)" }), axis({ size: 42 })],
      series: [{ label: "time (s)", value: (_, v) => fixed(v, 3) }].concat(runs.map((run) => series(run, 2))),
      hooks: {
        draw: [(chart) => markFallbacks(chart, runs)],
        setScale: [(chart) => placeCursor(chart)],
        ready: [(chart) => {
          chart.now = chart.over.appendChild(document.createElement("div"));
          chart.now.className = "now";
          chart.over.addEventListener("click", (event) => seek(chart.posToVal(event.offsetX, "x")));
        }],
      },
    }, [time, ...values], place);
  });
}

// The moment of the replay is an element above the chart, so that moving it leaves the chart untouched.
function placeCursor(chart, time = chart.time) {
  chart.time = time;
  if (!chart.now || time === undefined) return;
  const x = chart.valToPos(time, "x");
  chart.now.hidden = x < 0 || x > chart.over.clientWidth;
  chart.now.style.left = `${x}px`;
}

function markFallbacks(chart, runs) {
  const pen = chart.ctx, { left, top, width, height } = chart.bbox;
  pen.save();
  pen.strokeStyle = colour("warn");
  for (const time of runs[runs.length - 1].fallbacks) {
    const x = chart.valToPos(time, "x", true);
    if (x < left || x > left + width) continue;
    pen.beginPath(); pen.moveTo(x, top); pen.lineTo(x, top + height); pen.stroke();
  }
  pen.restore();
}

const HERTZ = [0.5, 1, 2, 5, 10, 20, 50];

function decades(_, index, low, high) {
  const from = Math.ceil(Math.log10(low) - 1e-9), to = Math.floor(Math.log10(high) + 1e-9);
  return Array.from({ length: Math.max(to - from + 1, 0) }, (_, i) => 10 ** (from + i));
}

function spectrum(place, scene) {
  place.replaceChildren();
  const f = unpack(scene.psd.f), values = scene.psd.density.map(unpack), wk = unpack(scene.psd.wk);
  const power = (v) => (v == null ? "–" : v.toExponential(1));
  const title = document.createElement("h3");
  title.textContent = `${scene.names.acceleration}: power spectral density ((m/s²)²/Hz)`;
  place.append(title);
  return new uPlot({
    width: width(place), height: 320, legend: LEGEND,
    scales: { x: { time: false, distr: 3 }, y: { distr: 3, range: (_, low, high) => [Math.max(low, high * 1e-5), high * 2] }, wk: { distr: 1, range: [0, 2.2] } },
    axes: [
      axis({ size: 24, label: "frequency (Hz)", splits: () => HERTZ, filter: (_, splits) => splits, values: (_, ticks) => ticks.map(String) }),
      axis({ size: 44, splits: decades, filter: (_, splits) => splits, values: (_, ticks) => ticks.map((v) => `1e${Math.round(Math.log10(v))}`) }),
      axis({ scale: "wk", side: 1, size: 34, label: "|Wk| (shaded)", splits: () => [0, 0.5, 1], values: (_, ticks) => ticks.map(String), grid: { show: false } }),
    ],
    series: [{ label: "frequency (Hz)", value: (_, v) => fixed(v, 1) }]
      .concat([{ label: "|Wk|", scale: "wk", stroke: () => colour("faint"), fill: () => colour("shade"), width: 1, value: (_, v) => fixed(v, 2) }])
      .concat(scene.runs.map((run) => Object.assign(series(run, 3), { value: (_, v) => power(v) }))),
  }, [f, wk, ...values], place);
}
