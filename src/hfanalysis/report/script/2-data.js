// Series: from base64 to numbers, and where in them an instant is found.
function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function readChart(key, about) {
  const clocks = about.clocks.map((text) => {
    const packed = unpacked(text), time = new Float64Array(packed.length);
    for (let i = 0; i < packed.length; i++) time[i] = packed[i] + about.span[0];
    return time;
  });
  const series = about.series.map((one) => {
    if (one.kind === "level") return { ...one, shown: true };
    const mean = unpacked(one.mean);
    const low = one.low ? unpacked(one.low) : mean, high = one.high ? unpacked(one.high) : mean;
    return { ...one, time: clocks[one.clock], mean, low, high, shown: true };
  });
  return { ...about, key, series };
}

// The first index whose time is not before t.
function indexAt(time, t) {
  let low = 0, high = time.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time[middle] < t) low = middle + 1; else high = middle;
  }
  return low;
}

// The sample nearest to t; null where t lies outside the series or in one of its gaps.
function valueAt(series, t) {
  const time = series.time, after = indexAt(time, t);
  if (!time.length || t < time[0] || t > time[time.length - 1]) return null;
  const nearest = after > 0 && t - time[after - 1] < time[Math.min(after, time.length - 1)] - t ? after - 1 : after;
  const value = series.mean[Math.min(nearest, time.length - 1)];
  return Number.isFinite(value) ? value : null;
}

// Lowest and highest value that a series shows between two instants.
function extent(series, start, end) {
  let low = Infinity, high = -Infinity;
  const last = Math.min(indexAt(series.time, end) + 1, series.time.length);
  for (let i = Math.max(0, indexAt(series.time, start) - 1); i < last; i++) {
    const bottom = series.kind === "band" ? series.mean[i] : series.low[i];
    if (bottom < low) low = bottom;
    if (series.high[i] > high) high = series.high[i];
  }
  return [low, high];
}
