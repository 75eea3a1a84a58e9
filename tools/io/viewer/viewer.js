// Shows one plan: time, player and what follows it (scene.js, plots.js).

const observers = [];
let now = 0;
let playing = false;

function show(t) {
  now = Math.min(duration, Math.max(0, t));
  element('scrub').value = duration > 0 ? 1000 * now / duration : 0;
  element('time').textContent = `${now.toFixed(2)} / ${duration.toFixed(2)} s`;
  for (const observer of observers) observer(now);
}

function setPlaying(value) {
  playing = value && duration > 0;
  element('play').textContent = playing ? 'pause' : 'play';
  if (!playing) return;
  if (now >= duration) show(0);
  let last = performance.now();
  const tick = (stamp) => {
    if (!playing) return;
    show(now + Math.max(0, stamp - last) / 1000 * Number(element('speed').value));
    last = stamp;
    if (now >= duration) setPlaying(false); else requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

function seek(t) {
  setPlaying(false);
  show(t);
}

document.title = data.title;
element('title').textContent = data.title;
element('facts').textContent = data.facts;
element('failure').textContent = data.failure;
element('player').hidden = data.frames.length === 0;
element('plots').hidden = data.plots.length === 0;
for (const plot of data.plots) observers.push(makePlot(plot, seek));
try {
  observers.push(makeView());
} catch (error) {
  element('message').textContent = `The scene cannot be drawn: ${error.message}`;
}
element('scrub').oninput = (event) => seek(event.target.value / 1000 * duration);
element('play').onclick = () => setPlaying(!playing);
document.onkeydown = (event) => {
  if (event.code !== 'Space' || event.target.tagName === 'BUTTON') return;
  event.preventDefault();
  setPlaying(!playing);
};
show(0);
