// Drawing a chart as SVG, as the static one is drawn, for the stretch of time that is looked at.
const SVG = "http://www.w3.org/2000/svg";
const WIDE = 640;

function element(parent, name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

// The names at the lines' ends take what they need, as in the static chart.
function margins(width, chart) {
  if (width < WIDE) return { left: 46, right: 10, top: 56, bottom: 46 };
  const names = chart.series.filter((one) => one.kind === "line").map((one) => 30 + 6.6 * one.label.length);
  return { left: 58, right: clamp(Math.max(...names), 116, 250), top: 56, bottom: 46 };
}

function shownUnit(chart) {
  const [factor, unit, zero] = chart.scales[settings.units];
  return { factor, unit, zero, of: (value) => factor * value + zero };
}

// The value axis in SI: as the static chart has it while the whole is seen, else what fits the data in view.
function valueSpan(chart, start, end) {
  const whole = start <= chart.span[0] && end >= chart.span[1];
  if (whole && chart.series.every((one) => one.shown)) return chart.values;
  let low = Infinity, high = -Infinity;
  const believed = chart.series.some((one) => one.shown && one.kind === "line" && !one.faint);
  for (const one of chart.series) {
    if (!one.shown || one.kind === "level" || (one.faint && believed)) continue;
    const [bottom, top] = extent(one, start, end);
    low = Math.min(low, bottom);
    high = Math.max(high, top);
  }
  if (!(low <= high)) return chart.values;
  if (whole) { low = Math.max(low, chart.values[0]); high = Math.min(high, chart.values[1]); }
  const air = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - air, high + air];
}

function draw(chart, width, start, end) {
  const m = margins(width, chart), height = chart.height, unit = shownUnit(chart);
  const [bottom, top] = valueSpan(chart, start, end).map(unit.of);
  const x = linear(start, end, m.left, width - m.right);
  const y = linear(bottom, top, height - m.bottom, m.top);
  const svg = chart.svg;
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  for (const child of [...svg.children]) if (!["title", "desc"].includes(child.tagName)) child.remove();
  chart.place = { x, y, m, width, height, unit };
  drawPhases(chart, svg);
  drawAxes(chart, svg);
  drawEvents(chart, svg);
  for (const one of chart.series) if (one.shown) drawSeries(chart, svg, one);
  namePhases(chart, svg);
  if (width >= WIDE) nameEnds(chart, svg);
  chart.overlay = element(svg, "g", { class: "overlay", "aria-hidden": "true" });
}

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

function drawPhases(chart, svg) {
  const { x, m, height } = chart.place;
  for (const phase of chart.phases) {
    const left = clamp(x(phase.start), x.from, x.to), right = clamp(x(phase.end), x.from, x.to);
    if (right <= left) continue;
    element(svg, "rect", { class: "phase " + phase.kind, x: left, y: m.top, width: right - left,
      height: height - m.bottom - m.top });
  }
}

function namePhases(chart, svg) {
  const { x, m } = chart.place;
  for (const phase of chart.phases) {
    const left = clamp(x(phase.start), x.from, x.to), right = clamp(x(phase.end), x.from, x.to);
    if (right - left <= 6.6 * phase.name.length + 6) continue;
    element(svg, "text", { class: "phase-name", x: (left + right) / 2, y: m.top + 15, "text-anchor": "middle" },
      phase.name);
  }
}

// As many as fit beside each other: the times of a log may have ten digits.
function mostTicks(x) {
  const letters = Math.max(String(Math.round(x.low)).length, String(Math.round(x.high)).length) + 3;
  return clamp(Math.floor((x.to - x.from) / (letters * 8 + 16)), 2, 12);
}

function drawAxes(chart, svg) {
  const { x, y, m, width, height, unit } = chart.place;
  const rows = ticks(y.low, y.high, 6), columns = ticks(x.low, x.high, mostTicks(x));
  for (const value of rows.values) {
    element(svg, "path", { class: "grid", d: `M${x.from} ${y(value)}H${x.to}` });
    element(svg, "text", { class: "tick y-tick", x: m.left - 8, y: y(value) + 4, "text-anchor": "end" },
      fixed(value, rows.decimals));
  }
  for (const value of columns.values) {
    element(svg, "path", { class: "axis", d: `M${x(value)} ${height - m.bottom}v5` });
    element(svg, "text", { class: "tick x-tick", x: x(value), y: height - m.bottom + 19, "text-anchor": "middle" },
      fixed(value, columns.decimals));
  }
  element(svg, "path", { class: "axis", d: `M${x.from} ${m.top}V${height - m.bottom}H${x.to}` });
  element(svg, "text", { class: "label", x: (x.from + x.to) / 2, y: height - 8, "text-anchor": "middle" }, chart.label);
  element(svg, "text", { class: "label y-label", x: 4, y: 11, "text-anchor": "start" },
    `${chart.quantity} [${unit.unit || "\u2013"}]`);
}

function drawEvents(chart, svg) {
  const { x, m, height } = chart.place, ends = [-Infinity, -Infinity, -Infinity];
  const seen = chart.events.filter((event) => event.time >= x.low && event.time <= x.high);
  for (const event of seen.sort((a, b) => a.time - b.time)) {
    const at = x(event.time), half = 3.3 * event.name.length + 3, spread = x(event.time + 1.96 * event.std) - at;
    let row = ends.findIndex((end) => end < at - half);
    if (row < 0) row = ends.length - 1;
    ends[row] = at + half;
    const group = element(svg, "g", {});
    element(group, "title", {}, `${event.name} = ${fixed(event.time, 3)} s \u00b1 ${fixed(event.std, 3)} s`);
    element(group, "rect", { class: "event-band", x: at - spread, y: m.top, width: 2 * spread,
      height: height - m.bottom - m.top });
    element(group, "path", { class: "event", d: `M${at} ${m.top}V${height - m.bottom}` });
    element(svg, "text", { class: "event-name", x: at, y: m.top - 6 - 13 * row, "text-anchor": "middle" }, event.name);
  }
}

function drawSeries(chart, svg, one) {
  const { x, y, unit } = chart.place, style = one.css;
  if (one.kind === "level") {
    const at = y(unit.of(one.level));
    if (at >= y.to && at <= y.from) element(svg, "path", { class: "level " + style, d: `M${x.from} ${at}H${x.to}` });
    return;
  }
  const columns = reduce(one, x);
  if (one.kind === "band" || columns.spread) element(svg, "path", { class: "band " + style, d: bandPath(chart, columns) });
  if (one.kind === "line") element(svg, "path", { class: "line " + style, d: linePath(chart, columns) });
}

// Samples in view, in no more points than the screen has columns: mean, lowest and highest of each column.
function reduce(one, x) {
  const first = Math.max(0, indexAt(one.time, x.low) - 1), last = Math.min(one.time.length, indexAt(one.time, x.high) + 1);
  const step = Math.max(1, (last - first) / (x.to - x.from));
  const out = { time: [], mean: [], low: [], high: [], spread: step > 1.5 || one.low !== one.mean };
  if (step <= 1.5) {
    for (let i = first; i < last; i++) push(out, one.time[i], one.mean[i], one.low[i], one.high[i]);
    return out;
  }
  for (let start = first; start < last; start += step) {
    column(one, out, Math.floor(start), Math.min(last, Math.floor(start + step)));
  }
  return out;
}

function push(out, time, mean, low, high) {
  out.time.push(time);
  out.mean.push(mean);
  out.low.push(low);
  out.high.push(high);
}

// A column that holds a hole of the series is as many as the stretches beside it, or the line would go across.
function column(one, out, from, to) {
  let start = from;
  for (let i = from; i <= to; i++) {
    if (i < to && Number.isFinite(one.mean[i])) continue;
    if (i > start) stretch(one, out, start, i);
    if (i < to) push(out, one.time[i], NaN, NaN, NaN);
    start = i + 1;
  }
}

function stretch(one, out, from, to) {
  let sum = 0, low = Infinity, high = -Infinity;
  for (let i = from; i < to; i++) {
    sum += one.mean[i];
    if (one.low[i] < low) low = one.low[i];
    if (one.high[i] > high) high = one.high[i];
  }
  const middle = 0.5 * (one.time[from] + one.time[to - 1]), mean = sum / (to - from);
  if (one.kind === "band") push(out, middle, mean, mean, high);
  else push(out, middle, mean, low, high);
}

function runs(values) {
  const found = [];
  let from = -1;
  for (let i = 0; i <= values.length; i++) {
    const known = i < values.length && Number.isFinite(values[i]);
    if (known && from < 0) from = i;
    if (!known && from >= 0) { found.push([from, i]); from = -1; }
  }
  return found;
}

// Points outside the chart go to its edge; those before and after it in time are cut where the line crosses the edge.
function point(chart, time, value) {
  const { x, y, unit } = chart.place;
  return `${clamp(x(time), x.from, x.to).toFixed(1)} ${clamp(y(unit.of(value)), y.to, y.from).toFixed(1)}`;
}

function linePath(chart, c) {
  return runs(c.mean).map(([from, to]) => {
    const points = [];
    for (let i = from; i < to; i++) points.push(point(chart, c.time[i], c.mean[i]));
    return "M" + points.join("L");
  }).join("");
}

function bandPath(chart, c) {
  return runs(c.mean).map(([from, to]) => {
    const there = [], back = [];
    for (let i = from; i < to; i++) {
      there.push(point(chart, c.time[i], c.high[i]));
      back.unshift(point(chart, c.time[i], c.low[i]));
    }
    return "M" + there.concat(back).join("L") + "Z";
  }).join("");
}

function nameEnds(chart, svg) {
  const { x, y, unit, m, height } = chart.place;
  const ends = [];
  for (const one of chart.series) {
    if (one.kind !== "line" || !one.shown) continue;
    const last = lastValue(one, x.low, x.high);
    if (last !== null) ends.push({ at: clamp(y(unit.of(last)), y.to, y.from), one });
  }
  ends.sort((a, b) => a.at - b.at);
  for (let i = 1; i < ends.length; i++) ends[i].at = Math.max(ends[i].at, ends[i - 1].at + 15);
  for (let i = ends.length - 1; i >= 0; i--) {
    ends[i].at = Math.min(ends[i].at, i === ends.length - 1 ? height - m.bottom : ends[i + 1].at - 15);
  }
  for (const { at, one } of ends) {
    element(svg, "path", { class: `line ${one.css}`, d: `M${x.to + 8} ${at}h12` });
    const name = one.label.length > 33 ? one.label.slice(0, 32) + "\u2026" : one.label;
    element(svg, "text", { class: "end-name", x: x.to + 25, y: at + 4, "text-anchor": "start" }, name);
  }
}

function lastValue(one, start, end) {
  for (let i = Math.min(one.time.length, indexAt(one.time, end) + 1) - 1; i >= 0 && one.time[i] >= start; i--) {
    if (Number.isFinite(one.mean[i])) return one.mean[i];
  }
  return null;
}
