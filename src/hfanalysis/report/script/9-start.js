// From the static page to the one that answers: legends become switches, charts listen.
function legendButton(chart, one, item) {
  const button = document.createElement("button"), output = document.createElement("output");
  button.type = "button";
  button.className = "key";
  button.setAttribute("aria-pressed", "true");
  button.append(...item.childNodes);
  button.addEventListener("click", () => {
    one.shown = !one.shown;
    button.setAttribute("aria-pressed", String(one.shown));
    schedule();
  });
  output.setAttribute("aria-live", "off");
  item.append(button, output);
  return output;
}

function startChart(figure, about) {
  const chart = readChart(figure.dataset.chart, about);
  chart.frame = figure.querySelector(".plot");
  chart.folds = [figure.closest("details.fold"), figure.closest("details.more")].filter(Boolean);
  chart.svg = chart.frame.querySelector("svg");
  chart.instant = figure.querySelector(".instant");
  const items = figure.querySelectorAll(".legend li");
  chart.series.forEach((one, i) => { if (items[i]) one.output = legendButton(chart, one, items[i]); });
  figure.querySelector(".save-csv")?.addEventListener("click", () => save(chart));
  charts.push(chart);
  listen(chart);
}

// What the chart holds in the stretch in view, in SI: a column for each line, a row for each of its instants.
function csv(chart) {
  const lines = chart.series.filter((one) => one.kind === "line"), [start, end] = spanOf(chart);
  const times = [...new Set(lines.flatMap((one) => [...one.time.filter((t) => t >= start && t <= end)]))];
  const quoted = (text) => '"' + text.replaceAll('"', '""') + '"';
  const rows = times.sort((a, b) => a - b).map((t) => [t.toFixed(6), ...lines.map((one) => {
    const i = indexAt(one.time, t);
    return one.time[i] === t && Number.isFinite(one.mean[i]) ? one.mean[i] : "";
  })].join(","));
  return [[chart.label, ...lines.map((one) => `${one.label} [${chart.si}]`)].map(quoted).join(","), ...rows, ""].join("\n");
}

function save(chart) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([csv(chart)], { type: "text/csv" }));
  link.download = `${chart.key}.csv`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function start() {
  offer("units", showUnits, schedule);
  offer("theme", showTheme, () => {});
  for (const control of document.querySelectorAll(".controls")) control.hidden = false;
  root.classList.add("alive");
  const store = document.getElementById("chart-data");
  const known = store ? JSON.parse(store.textContent).charts : {};
  for (const figure of document.querySelectorAll("figure[data-chart]")) {
    if (known[figure.dataset.chart]) startChart(figure, known[figure.dataset.chart]);
  }
  startFolds();
  startTables();
  if (!charts.length) return;
  drawAll();
  document.getElementById("reset-zoom")?.addEventListener("click", lookAtAll);
  new ResizeObserver(schedule).observe(document.querySelector("main"));
  addEventListener("beforeprint", drawForPaper);
  addEventListener("afterprint", () => drawAll());
}

start();
