// Axes: round values and how they read.
function ticks(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= rough * (1 - 1e-12));
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i <= Math.floor(high / step + 1e-9); i++) found.push(i * step);
  return { values: found, decimals: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function fixed(value, decimals) {
  const text = value.toFixed(Math.min(20, decimals));
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

// Decimals for reading a value off an axis: a thousandth of what it spans.
function finer(low, high) {
  return Math.max(0, Math.min(6, Math.ceil(-Math.log10((high - low) / 1000 || 1))));
}

function linear(low, high, from, to) {
  const factor = (to - from) / (high - low);
  const place = (value) => from + (value - low) * factor;
  place.back = (pixel) => low + (pixel - from) / factor;
  return Object.assign(place, { low, high, from, to });
}
