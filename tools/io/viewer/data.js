// What the other scripts share: the page's data, as tools/io/html_page.h describes it, and its
// times.
'use strict';

const data = JSON.parse(document.getElementById('data').textContent);
const element = (id) => document.getElementById(id);
const times = data.times_s;
const duration = times.length > 0 ? times[times.length - 1] : 0;

// The frame before time t and the share of the way to the next.
function locate(t) {
  let low = 0;
  let high = Math.max(0, times.length - 1);
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const step = times[high] - times[low];
  return { low, high, share: step > 0 ? Math.min(1, Math.max(0, (t - times[low]) / step)) : 0 };
}

const isNumber = (v) => typeof v === 'number';

// The least of 1, 2, 5 times a power of ten that is not less.
function niceStep(raw) {
  const unit = 10 ** Math.floor(Math.log10(raw));
  return unit * [1, 2, 5, 10].find((s) => s * unit >= raw * (1 - 1e-9));
}
