// What the page shows and how it is changed: by mouse, fingers and keys.

const element = id => document.getElementById(id);
const canvas = element('view');
const state = {slider: 0.5, mode: 'shaded', size: 1, strays: true, slab: [0, 0, 0], slabAt: 0, slabHalf: kSlabless,
  frame: 40,  // milliseconds: while something moves as many points are drawn as there is time for, and all when it rests
  every: 1    // of so many points one was drawn last
};

async function start() {
  const gl = canvas.getContext('webgl2', {alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true});
  if (!gl || !window.DecompressionStream) return;
  element('sorry').hidden = true;
  element('stage').hidden = element('controls').hidden = false;
  let points, painter;
  try {
    points = decoded(await unpacked(element('points').textContent));
    painter = new Painter(gl, points);
  } catch (error) {
    element('wait').textContent = 'The points cannot be shown: ' + error.message;
    return;
  }
  element('wait').hidden = true;

  /** Every so many points: enough to know where the cloud is. */
  const some = [];
  const every = Math.max(1, Math.floor(about.shown / 20000));
  for (const block of about.blocks)
    for (let i = 0; i < block.count && block.kind === kSurface; i += every)
      some.push(block.origin.map((x, axis) => x + block.step * points.place[4 * (block.first + i) + axis]));
  if (some.length === 0) some.push(about.blocks[0].origin);

  const kRest = 250;  // milliseconds
  let dense = 1, waiting = false, resting = 0, thinned = about.shown > 1e5 ? kMostThinned : 1;
  function paint() {
    waiting = false;
    dense = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * dense)), height = Math.max(1, Math.round(canvas.clientHeight * dense));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    painter.resize(width, height);
    state.every = resting ? thinned : 1;
    const wanted = state.every * painter.draw(state, dense) / state.frame;
    thinned = Math.max(1, Math.min(2 ** Math.ceil(Math.log2(wanted)), kMostThinned));
    element('slider').style.left = 100 * state.slider + '%';
    element('slider').setAttribute('aria-valuenow', Math.round(100 * state.slider));
  }
  function repaint() {
    if (!waiting) requestAnimationFrame(paint);
    waiting = true;
  }
  /** The same for what goes on moving. */
  function move() {
    clearTimeout(resting);
    resting = setTimeout(() => { resting = 0; repaint(); }, kRest);
    repaint();
  }

  function home() {
    camera.home(some, canvas.clientWidth, canvas.clientHeight);
    move();
  }
  function slide(share) {
    state.slider = Math.max(0, Math.min(1, share));
    move();
  }
  function show(mode) {
    const input = document.querySelector(`input[value=${mode}]`);
    if (input.disabled) return;
    input.checked = true;
    state.mode = mode;
    repaint();
  }

  /** The slab of the cross-section: `section` across an axis turns the view along it. */
  let slabRange = [0, 0];
  function section(choice) {
    const along = {x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1], here: camera.axes().toward}[choice];
    for (const id of ['place', 'thickness']) element(id).disabled = !along;
    state.slab = along || [0, 0, 0];
    if (along) {
      const heights = Float64Array.from(some, p => dot(p, along)).sort();
      slabRange = [heights[0], heights[heights.length - 1]];
      element('place').value = 0;
    }
    cut();
    if (!along || choice === 'here') return;
    camera.look(along[1] ? [0, -1, 0] : along);
    const inside = some.filter(p => Math.abs(dot(p, along) - state.slabAt) <= state.slabHalf);
    camera.fit(inside.length ? inside : some, canvas.clientWidth, canvas.clientHeight);
  }
  function cut() {
    const [low, high] = slabRange, half = (high - low) / 2;
    const off = element('section').value === 'none';
    state.slabAt = (low + high) / 2 + half * Number(element('place').value);
    state.slabHalf = off ? kSlabless : Math.max(half * 2 ** Number(element('thickness').value), 1e-6 * about.radius);
    move();
  }

  for (const input of document.querySelectorAll('input[name=mode]')) input.addEventListener('change', () => show(input.value));
  document.querySelector('input[value=colors]').disabled = !about.colors;
  const strays = about.blocks.some(block => block.kind !== kSurface);
  document.querySelector('input[value=outliers]').disabled = element('strays').disabled = !strays;
  element('strays').addEventListener('change', event => { state.strays = event.target.checked; repaint(); });
  element('size').addEventListener('input', event => { state.size = 2 ** Number(event.target.value); move(); });
  element('section').addEventListener('change', event => section(event.target.value));
  element('place').addEventListener('input', cut);
  element('thickness').addEventListener('input', cut);
  element('home').addEventListener('click', home);
  element('controls').addEventListener('submit', event => event.preventDefault());

  const slider = element('slider');
  slider.addEventListener('pointerdown', event => { slider.setPointerCapture(event.pointerId); slider.focus(); event.preventDefault(); });
  slider.addEventListener('pointermove', event => {
    if (!slider.hasPointerCapture(event.pointerId)) return;
    const box = canvas.getBoundingClientRect();
    slide((event.clientX - box.left) / box.width);
  });

  // One pointer turns, or shifts with Shift or another button; of two the middle shifts and the distance goes nearer.
  const pointers = new Map();
  const middle = () => [0, 1].map(k => [...pointers.values()].reduce((sum, p) => sum + p[k], 0) / pointers.size);
  const apart = () => {
    const [a, b] = [...pointers.values()];
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  };
  const fromMiddle = (x, y) => {
    const box = canvas.getBoundingClientRect();
    return [x - box.left - box.width / 2, y - box.top - box.height / 2];
  };
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'])
    canvas.addEventListener(end, event => pointers.delete(event.pointerId));
  canvas.addEventListener('pointermove', event => {
    if (!pointers.has(event.pointerId)) return;
    const [x, y] = middle(), was = apart();
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const [nowX, nowY] = middle();
    if (pointers.size > 1 || event.shiftKey || event.buttons & 6) {
      camera.shift(nowX - x, nowY - y);
      if (was > 0) camera.near(apart() / was, ...fromMiddle(nowX, nowY));
    } else {
      turn(nowX - x, nowY - y);
    }
    move();
  });
  function turn(x, y) {
    camera.turn -= x / 200;
    camera.tilt = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, camera.tilt + y / 200));
  }
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    camera.near(Math.exp(-event.deltaY * (event.deltaMode ? 0.03 : 0.001)), ...fromMiddle(event.clientX, event.clientY));
    move();
  }, {passive: false});

  const modes = ['shaded', 'colors', 'moves', 'outliers'];
  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches('input, select, button, summary')) return;
    const key = event.key, arrow = arrows[key];
    if (arrow && event.target === slider) slide(state.slider + 0.02 * (arrow[0] - arrow[1]));
    else if (arrow && event.shiftKey) camera.shift(20 * arrow[0], 20 * arrow[1]);
    else if (arrow) turn(20 * arrow[0], 20 * arrow[1]);
    else if (key === '+' || key === '=') camera.near(1.2, 0, 0);
    else if (key === '-') camera.near(1 / 1.2, 0, 0);
    else if (key === '[') slide(state.slider - 0.02);
    else if (key === ']') slide(state.slider + 0.02);
    else if (key === '0') home();
    else if (modes[key - 1]) show(modes[key - 1]);
    else return;
    event.preventDefault();
    move();
  });
  new ResizeObserver(repaint).observe(canvas);

  home();
  window.rfsmooth = {about, points, state, camera, coordinates: side => coordinates(points, side), paint};
}
start();
