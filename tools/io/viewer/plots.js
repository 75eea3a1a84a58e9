// The plots over time: makePlot(plot, seek) gives a function that moves the plot's cursor; a click
// in the plot calls seek(t).

const SERIES_COLORS = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00',
                       '#52606d', '#b8a800'];
const WIDTH = 440;
const HEIGHT = 116;
const LEFT = 52;
const RIGHT = 16;
const TOP = 6;
const BOTTOM = 20;
const xOf = (t) => LEFT + (WIDTH - LEFT - RIGHT) * (duration > 0 ? t / duration : 0);

function svg(name, attributes, text) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

function ticks(low, high) {
  const step = niceStep((high - low) / 5);
  const list = [];
  for (let i = Math.ceil(low / step); i * step <= high; ++i) list.push(i * step);
  return list;
}

// The largest share of a limit that a series takes; 0 without limits.
function shareOfLimit({ values, lower, upper }) {
  if (!isNumber(upper)) return 0;
  const middle = isNumber(lower) ? (lower + upper) / 2 : 0;
  return values.filter(isNumber).reduce(
    (most, v) => Math.max(most, Math.abs(v - middle) / (upper - middle)), 0);
}

function rangeOf(plot, shown) {
  const values = plot.levels.map((level) => level.value);
  for (const series of shown) {
    if (plot.hasLimits) values.push(series.lower, series.upper);
    for (const value of series.values) values.push(value);
  }
  const numbers = values.filter(isNumber);
  let low = numbers.reduce((m, v) => Math.min(m, v), Infinity);
  let high = numbers.reduce((m, v) => Math.max(m, v), -Infinity);
  if (!(low <= high)) [low, high] = [0, 1];
  const pad = high > low ? 0.05 * (high - low) : 1;
  return [low - pad, high + pad];
}

// One value per time, or one per step between them: then it is constant over the step.
function pathOf(series, yOf) {
  let path = '';
  let pen = 'M';
  const isStep = series.values.length < times.length;
  for (const [i, value] of series.values.entries()) {
    if (!isNumber(value)) { pen = 'M'; continue; }
    path += `${pen}${xOf(times[i]).toFixed(2)} ${yOf(value).toFixed(2)}`;
    if (isStep) path += `H${xOf(times[i + 1]).toFixed(2)}`;
    pen = 'L';
  }
  return path;
}

function addGrid(root, low, high, yOf) {
  for (const y of ticks(low, high)) {
    root.append(
      svg('line', { x1: LEFT, x2: WIDTH - RIGHT, y1: yOf(y), y2: yOf(y), stroke: '#e4e7eb' }),
      svg('text', { x: LEFT - 4, y: yOf(y) + 4, 'text-anchor': 'end', 'font-size': 11 },
          String(Number(y.toPrecision(6)))));
  }
  for (const t of duration > 0 ? ticks(0, duration) : []) {
    root.append(svg('text', { x: xOf(t), y: HEIGHT - 6, 'text-anchor': 'middle',
                              'font-size': 11 }, `${Number(t.toPrecision(6))} s`));
  }
}

function addLevel(root, value, color, yOf) {
  if (!isNumber(value)) return;
  root.append(svg('line', { x1: LEFT, x2: WIDTH - RIGHT, y1: yOf(value), y2: yOf(value),
                            stroke: color, 'stroke-dasharray': '5 4', class: 'limit' }));
}

function drawPlot(plot, root, cursor) {
  const shown = plot.series.filter((series) => !series.hidden);
  const [low, high] = rangeOf(plot, shown);
  const yOf = (v) => TOP + (HEIGHT - TOP - BOTTOM) * (high - v) / (high - low);
  root.replaceChildren();
  addGrid(root, low, high, yOf);
  for (const level of plot.levels) addLevel(root, level.value, '#c62828', yOf);
  for (const series of shown) {
    if (plot.hasLimits) {
      addLevel(root, series.lower, series.color, yOf);
      addLevel(root, series.upper, series.color, yOf);
    }
    root.append(svg('path', { d: pathOf(series, yOf), fill: 'none', stroke: series.color,
                              'stroke-width': 1.6 }));
  }
  root.append(cursor);
}

// At time t: on the line between two values, or the step's.
function valueAt(series, t) {
  const { low, high, share } = locate(t);
  const a = series.values[low];
  if (series.values.length < times.length) return a;
  const b = series.values[high];
  return isNumber(a) && isNumber(b) ? a + share * (b - a) : null;
}

function addButton(parent, text, color, onclick) {
  const button = document.createElement('button');
  button.textContent = text;
  button.style.color = color;
  button.onclick = onclick;
  parent.append(button);
  return button;
}

// Limits far beyond the curves would flatten them; the button shows them.
function addLimits(plot, title, redraw) {
  const most = plot.series.reduce((share, series) => Math.max(share, shareOfLimit(series)), 0);
  plot.hasLimits = most > 0.6;
  if (most === 0) return;
  const note = document.createElement('small');
  note.textContent = `up to ${Math.round(100 * most)} % of a limit`;
  title.append(note);
  const toggle = addButton(note, 'limits', '#52606d', () => {
    plot.hasLimits = !plot.hasLimits;
    toggle.classList.toggle('off', !plot.hasLimits);
    redraw();
  });
  toggle.classList.toggle('off', !plot.hasLimits);
}

function makePlot(plot, seek) {
  const root = svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}` });
  const cursor = svg('line', { y1: TOP, y2: HEIGHT - BOTTOM, stroke: '#1f2933' });
  const redraw = () => drawPlot(plot, root, cursor);
  const title = document.createElement('h2');
  title.textContent = plot.unit ? `${plot.title} [${plot.unit}]` : plot.title;
  addLimits(plot, title, redraw);
  const legend = document.createElement('div');
  legend.className = 'legend';
  for (const [i, series] of plot.series.entries()) {
    series.color = SERIES_COLORS[i % SERIES_COLORS.length];
    series.button = addButton(legend, series.name, series.color, () => {
      series.hidden = !series.hidden;
      series.button.classList.toggle('off', series.hidden);
      redraw();
    });
  }
  for (const level of plot.levels) {
    const label = document.createElement('span');
    label.textContent = `- - ${level.name} ${Number(level.value.toPrecision(3))}`;
    legend.append(label);
  }
  const seekTo = (event) => {
    const box = root.getBoundingClientRect();
    const x = (event.clientX - box.left) / box.width * WIDTH;
    seek((x - LEFT) / (WIDTH - LEFT - RIGHT) * duration);
  };
  root.onpointerdown = seekTo;
  root.onpointermove = (event) => { if (event.buttons & 1) seekTo(event); };
  const section = document.createElement('section');
  section.append(title, root, legend);
  element('plots').append(section);
  redraw();
  const decimals = plot.unit === 'm' ? 3 : 2;
  return (t) => {
    cursor.setAttribute('x1', xOf(t));
    cursor.setAttribute('x2', xOf(t));
    for (const series of plot.series) {
      const value = valueAt(series, t);
      series.button.textContent = isNumber(value) ? `${series.name} ${value.toFixed(decimals)}`
                                                  : series.name;
    }
  };
}
