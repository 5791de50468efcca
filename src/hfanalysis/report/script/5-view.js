// One stretch of time and one cursor for all charts that share a clock: the test's, the flight's.
const charts = [];
const views = {};
const CLOSEST = 0.002;
const AT_A_TIME = 30;  // [ms] of drawing before hands are listened to again
let pending = false;

function viewOf(chart) {
  return views[chart.clock] ||= { span: null, cursor: null };
}

function spanOf(chart) {
  return viewOf(chart).span || chart.span;
}

function sharing(chart) {
  return charts.filter((other) => other.clock === chart.clock);
}

function wholeSpan(chart) {
  const spans = sharing(chart).map((other) => other.span);
  return [Math.min(...spans.map((span) => span[0])), Math.max(...spans.map((span) => span[1]))];
}

function look(chart, start, end) {
  const [first, last] = wholeSpan(chart), width = Math.max(end - start, CLOSEST), view = viewOf(chart);
  if (width >= last - first) { view.span = null; } else {
    const from = clamp(start, first, last - width);
    view.span = [from, from + width];
  }
  schedule();
}

function lookAtAll() {
  for (const view of Object.values(views)) view.span = null;
  schedule();
}

// Zoom by a factor and keep the instant `about` where it is on the screen.
function zoom(chart, factor, about) {
  const [start, end] = spanOf(chart);
  look(chart, about - (about - start) * factor, about + (end - about) * factor);
}

function schedule() {
  if (pending) return;
  pending = true;
  requestAnimationFrame(() => {
    pending = false;
    drawAll();
  });
}

// What is on the screen is drawn at once, the others a few at a time while nothing else is to be done.
function drawAll() {
  for (const chart of charts) chart.stale = true;
  root.dataset.busy = "";
  for (const [chart, width] of withWidths(charts.filter((chart) => !isFolded(chart) && onScreen(chart)))) {
    refresh(chart, width);
  }
  setTimeout(drawNext, 50);
  const reset = document.getElementById("reset-zoom");
  if (reset) reset.disabled = Object.values(views).every((view) => view.span === null);
}

function drawNext() {
  const waiting = charts.filter((chart) => chart.stale && !isFolded(chart));
  if (!waiting.length) { delete root.dataset.busy; return; }
  if (pending) return;
  const until = performance.now() + AT_A_TIME;
  for (const [chart, width] of withWidths(waiting)) {
    refresh(chart, width);
    if (performance.now() > until) break;
  }
  setTimeout(drawNext, 0);
}

// All widths are asked for before anything is drawn: each question after a change has the page laid out anew.
function withWidths(asked) {
  return asked.map((chart) => [chart, widthOf(chart)]);
}

// What is folded away is drawn when it is opened.
function isFolded(chart) {
  return chart.folds.some((fold) => !fold.open);
}

function drawForPaper() {
  for (const chart of charts) refresh(chart, chart.frame.closest(".beside") ? 560 : 960);
}

function refresh(chart, width) {
  chart.stale = false;
  draw(chart, width, ...spanOf(chart));
  showCursor(chart);
}

function widthOf(chart) {
  return Math.max(280, Math.round(chart.frame.clientWidth));
}

function onScreen(chart) {
  const box = chart.frame.getBoundingClientRect();
  return box.bottom > -200 && box.top < innerHeight + 200;
}

function moveCursor(chart, t) {
  viewOf(chart).cursor = t;
  for (const other of sharing(chart)) showCursor(other);
}

function showCursor(chart) {
  if (!chart.place) return;
  const { x, y, unit } = chart.place, t = viewOf(chart).cursor, inside = t !== null && t >= x.low && t <= x.high;
  chart.overlay.replaceChildren();
  chart.instant.textContent = inside ? `${chart.across[0]} = ${fixed(t, finer(x.low, x.high))} ${chart.across[1]}`.trim() : "";
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
