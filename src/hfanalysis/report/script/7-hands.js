// Mouse, finger and keyboard.
const WHEEL = 1.25, DRAG = 5, STEPS = 100;
let scrolled = false;

function timeAt(chart, event) {
  if (!chart.place) refresh(chart, widthOf(chart));
  const box = chart.svg.getBoundingClientRect(), { x, width } = chart.place;
  return clamp(x.back((event.clientX - box.left) * width / box.width), x.low, x.high);
}

// While the page scrolls past under a resting pointer, charts leave the wheel alone.
addEventListener("scroll", () => { scrolled = true; }, { passive: true });

function listen(chart) {
  const frame = chart.frame;
  let from = null;
  frame.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    from = { t: timeAt(chart, event), clientX: event.clientX };
    frame.setPointerCapture(event.pointerId);
  });
  frame.addEventListener("pointermove", (event) => {
    scrolled = false;
    moveCursor(chart, timeAt(chart, event));
    if (from) showSelection(chart, from.t, timeAt(chart, event));
  });
  frame.addEventListener("pointerup", (event) => {
    const to = timeAt(chart, event), start = from;
    from = null;
    if (start && Math.abs(event.clientX - start.clientX) > DRAG) look(chart, Math.min(start.t, to), Math.max(start.t, to));
  });
  frame.addEventListener("pointercancel", () => { from = null; showCursor(chart); });
  frame.addEventListener("pointerleave", () => { if (!from) moveCursor(chart, null); });
  frame.addEventListener("dblclick", lookAtAll);
  frame.addEventListener("wheel", (event) => wheel(chart, event), { passive: false });
  frame.addEventListener("keydown", (event) => key(chart, event));
  frame.addEventListener("blur", () => moveCursor(chart, null));
}

function showSelection(chart, a, b) {
  const { x, y } = chart.place;
  element(chart.overlay, "rect", { class: "selection", x: Math.min(x(a), x(b)), y: y.to, width: Math.abs(x(b) - x(a)),
    height: y.from - y.to });
}

// Zooming out of the whole is scrolling the page.
function wheel(chart, event) {
  const out = event.deltaY > 0;
  if (scrolled || !event.deltaY || (out && viewOf(chart).span === null)) return;
  event.preventDefault();
  zoom(chart, out ? WHEEL : 1 / WHEEL, timeAt(chart, event));
}

function key(chart, event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (!chart.place) refresh(chart, widthOf(chart));
  const [start, end] = spanOf(chart), step = (end - start) / STEPS * (event.shiftKey ? 10 : 1);
  const at = viewOf(chart).cursor, cursor = at === null ? (start + end) / 2 : clamp(at, start, end);
  const moves = {
    ArrowLeft: () => cursor - step, ArrowRight: () => cursor + step, Home: () => start, End: () => end,
  };
  const zooms = {
    "+": () => zoom(chart, 1 / 1.5, cursor), "=": () => zoom(chart, 1 / 1.5, cursor),
    "-": () => zoom(chart, 1.5, cursor), "0": lookAtAll, Escape: () => moveCursor(chart, null),
  };
  if (moves[event.key]) {
    moveTo(chart, moves[event.key](), end - start);
    say(spoken(chart));
  } else if (zooms[event.key]) {
    zooms[event.key]();
  } else {
    return;
  }
  event.preventDefault();
}

// A cursor that leaves the stretch in view takes it along.
function moveTo(chart, t, width) {
  const view = viewOf(chart), [first, last] = view.span ? wholeSpan(chart) : chart.span, at = clamp(t, first, last);
  const [start, end] = spanOf(chart);
  if (view.span && (at < start || at > end)) {
    const from = at < start ? at : at - width;
    look(chart, from, from + width);
    view.cursor = at;
    drawAll();
  } else {
    moveCursor(chart, at);
  }
}

function say(text) {
  document.getElementById("spoken").textContent = text;
}
