// One stretch of time and one cursor for all charts of the page.
const charts = [];
const view = { span: null, cursor: null, pending: false };
const CLOSEST = 0.002;

function spanOf(chart) {
  return view.span || chart.span;
}

function wholeSpan() {
  return [Math.min(...charts.map((chart) => chart.span[0])), Math.max(...charts.map((chart) => chart.span[1]))];
}

function look(start, end) {
  const [first, last] = wholeSpan(), width = Math.max(end - start, CLOSEST);
  if (width >= last - first) { view.span = null; } else {
    const from = clamp(start, first, last - width);
    view.span = [from, from + width];
  }
  schedule();
}

function lookAtAll() {
  view.span = null;
  schedule();
}

// Zoom by a factor and keep the instant `about` where it is on the screen.
function zoom(chart, factor, about) {
  const [start, end] = spanOf(chart);
  look(about - (about - start) * factor, about + (end - about) * factor);
}

function schedule() {
  if (view.pending) return;
  view.pending = true;
  requestAnimationFrame(() => {
    view.pending = false;
    drawAll();
  });
}

function drawAll(width) {
  for (const chart of charts) {
    draw(chart, width || Math.max(280, Math.round(chart.frame.clientWidth)), ...spanOf(chart));
    showCursor(chart);
  }
  const reset = document.getElementById("reset-zoom");
  if (reset) reset.disabled = view.span === null;
}

function moveCursor(t) {
  view.cursor = t;
  for (const chart of charts) showCursor(chart);
}

function showCursor(chart) {
  const { x, y, unit } = chart.place, t = view.cursor, inside = t !== null && t >= x.low && t <= x.high;
  chart.overlay.replaceChildren();
  chart.instant.textContent = inside ? `t = ${fixed(t, finer(x.low, x.high))} s` : "";
  if (inside) element(chart.overlay, "path", { class: "cursor", d: `M${x(t)} ${y.to}V${y.from}` });
  for (const one of chart.series) {
    if (one.kind === "level" || !one.output) continue;
    const value = inside && one.shown ? valueAt(one, t) : null;
    one.output.textContent = value === null ? "" : reading(chart, value);
    if (value === null || one.kind !== "line") continue;
    const at = clamp(y(unit.of(value)), y.to, y.from);
    element(chart.overlay, "circle", { class: "dot " + one.style, cx: x(t), cy: at, r: 3.5 });
  }
}

function reading(chart, value) {
  const { y, unit } = chart.place;
  return `${fixed(unit.of(value), finer(y.low, y.high))} ${unit.unit}`.trim();
}

// The cursor in words, for those who do not see it.
function spoken(chart) {
  const parts = chart.series.filter((one) => one.output && one.output.textContent)
    .map((one) => `${one.label} ${one.output.textContent}`);
  return `${chart.instant.textContent}: ${parts.join(", ") || "no samples"}`;
}
