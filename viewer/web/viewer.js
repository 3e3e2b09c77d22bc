// Sends user input to the server and shows the images that it renders.
'use strict';

const SEND_MS = 33;      // between two messages of user input
const HOLD_MS = 300;     // interval at which held keys are confirmed; the server releases them after 1 s
const STATE_MS = 500;
const MAX_EDGE = 4096;
const PLACE_MS = 200;    // between two requests of the point under the mouse
const JULIAN_DAY_OF_1970 = 2440587.5;

const element = (id) => document.getElementById(id);
const picture = element('picture');

let viewer = null;       // the key of this page's camera
let pending = {};        // user input that is not sent yet
let sending = false;
const held = new Set();  // codes of the keys that are down
let slow = false;        // Shift
let heldSent = 0;        // time at which the held keys were last sent
let shownState = null;
let askedSize = [0, 0];  // image size that the server was last sent
let saving = false;      // an image is being saved
const onJoined = [];     // functions that get the server's answer when the page joins

// Communication with the server.

async function ask(path, steering) {
  const options = steering === undefined ? {} : {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(steering),
  };
  const answer = await fetch(path, options);
  if (answer.ok) return answer.json();
  const failure = new Error((await answer.json().catch(() => ({}))).error || answer.statusText);
  failure.status = answer.status;
  throw failure;
}

const forViewer = (path) => `${path}?viewer=${viewer}`;

async function join() {
  viewer = null;
  askedSize = wantedSize();
  const welcome = await ask('viewers', {size: askedSize});
  viewer = welcome.viewer;
  offer('mode', welcome.modes);
  offer('style', welcome.styles);
  for (const listen of onJoined) listen(welcome);
  picture.src = forViewer('stream');
}

function offer(id, names) {
  element(id).replaceChildren(...names.map((name) => new Option(name, name)));
}

// Uses the image's size on the screen: after a rotation of a phone, the window's inner size is outdated for a while.
function wantedSize() {
  const {clientWidth: width, clientHeight: height} = picture;
  const scale = Math.min(window.devicePixelRatio || 1, MAX_EDGE / Math.max(width, height, 1));
  return [Math.max(1, Math.round(width * scale)), Math.max(1, Math.round(height * scale))];
}

// Called when the layout may have changed, and at each state request, because browsers omit some resize events.
function fit() {
  const size = wantedSize();
  const known = pending.size || askedSize;
  if (size[0] !== known[0] || size[1] !== known[1]) steer({size: askedSize = size});
}

// Adds movements up until they are sent; a new value of a setting replaces the previous one.
function steer(steering) {
  for (const [key, value] of Object.entries(steering)) {
    const adds = key === 'turn' || key === 'pan';
    if (adds && pending[key]) pending[key] = pending[key].map((v, i) => v + value[i]);
    else if (key === 'zoom' && pending.zoom) pending.zoom += value;
    else pending[key] = value;
  }
}

async function send() {
  if (!viewer || sending) return;
  if (held.size && performance.now() - heldSent > HOLD_MS) hold();
  if (!Object.keys(pending).length) return;
  const steering = pending;
  pending = {};
  sending = true;
  try {
    show(await ask(forViewer('steer'), steering));
  } catch (failure) {
    await lost(failure);
  }
  sending = false;
}

async function look() {
  try {
    if (!viewer) await join();
    fit();
    const state = await ask(forViewer('state'));
    show(state);
    tell(state, state.scene && !state.problem && !state.watching ? null : await ask('bake'));
  } catch (failure) {
    await lost(failure);
  }
  setTimeout(look, STATE_MS);
}

// After status 404 the page joins again, because a restarted server does not know the page's key.
async function lost(failure) {
  document.body.dataset.resting = 'false';
  if (failure.status === 404) viewer = null;
  message(failure.status ? failure.message : 'The server does not answer.');
}

// Display.

function show(state) {
  shownState = state;
  document.body.dataset.resting = String(state.resting);
  for (const id of ['mode', 'style'])
    if (document.activeElement !== element(id)) element(id).value = state[id];
  if (document.activeElement !== element('error')) element('error').value = Math.log2(state.pixel_error);
  for (const [i, id] of ['azimuth', 'elevation'].entries())
    if (document.activeElement !== element(id)) element(id).value = (state.sun[i] + (i === 0 ? 360 : 0)) % 360;
  for (const id of ['shadows', 'level_blend']) element(id).checked = state[id] === 'on';
  element('when').hidden = !state.has_place;
  element('stats').textContent = state.frame ? statsLine(state) : '';
  element('loading').textContent = loadingText(state);
}

// Returns the loading state; empty if the image is final.
function loadingText(state) {
  if (!state.scene || state.resting || state.problem) return '';
  if (!state.frame) return 'loading';
  if (state.frame.stats.complete) return '';
  return state.drawn > 0 ? `loading ${Math.floor(100 * state.drawn)} %` : 'loading';
}

function statsLine(state) {
  const {stats, size, frames_per_s: rate} = state.frame;
  const megabytes = (bytes) => (bytes / 1e6).toFixed(0);
  const allowed = stats.bytes_allowed === null ? '' : ` of ${megabytes(stats.bytes_allowed)}`;
  const parts = [`${size[0]}×${size[1]}`, `${(stats.total_s * 1000).toFixed(0)} ms`,
    `${megabytes(stats.bytes_held)}${allowed} MB`];
  if (rate > 0 && !state.resting) parts.push(`${rate.toFixed(1)} fps`);
  if (!stats.complete && stats.wanted) parts.push(`${stats.wanted} requested, ${stats.pages_loading} loading`);
  if (state.problems) parts.push(`${state.problems} shards damaged`);
  return parts.join(' · ');
}

function tell(state, bake) {
  const lines = [];
  if (!state.scene) lines.push(bake ? 'The scene is not baked yet.' : 'There is no scene yet.');
  if (bake && bake.line && !state.watching) lines.push(bake.line);
  element('bake').textContent = bake && state.watching ? bake.line : '';
  if (state.problem && (state.scene || !bake)) lines.push(state.problem);
  message(lines.join('\n'));
}

function message(text) {
  element('message').hidden = !text;
  element('message').textContent = text;
}

let noteTimer = 0;

function note(text, forMs) {
  element('note').hidden = !text;
  element('note').textContent = text;
  clearTimeout(noteTimer);
  if (forMs) noteTimer = setTimeout(() => note(''), forMs);
}

// Repeats the request while the server answers 504, which means that the image is not complete yet.
async function fetchPicture() {
  for (;;) {
    const answer = await fetch(forViewer('picture.png'));
    if (answer.ok) return answer.blob();
    if (answer.status !== 504) throw new Error((await answer.json()).error);
  }
}

async function save() {
  if (saving) return;
  saving = true;
  note('The image will be saved once it is complete.');
  try {
    const blob = await fetchPicture();
    const head = new DataView(await blob.slice(16, 24).arrayBuffer());  // a PNG's width and height
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = 'gigabake.png';
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    note(`Saved ${link.download}, ${head.getUint32(0)}×${head.getUint32(4)}, in the browser's downloads.`, 6000);
  } catch (failure) {
    note(`Not saved: ${failure.message}`, 10000);
  }
  saving = false;
}

// Mouse and touch.

const pointers = new Map();

function middle() {
  const all = [...pointers.values()];
  const mean = (k) => all.reduce((sum, p) => sum + p[k], 0) / all.length;
  const spread = all.length < 2 ? 0 : Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y);
  return {x: mean('x'), y: mean('y'), spread};
}

picture.addEventListener('pointerdown', (event) => {
  picture.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, {x: event.clientX, y: event.clientY, button: event.button});
  document.activeElement.blur();
  event.preventDefault();
});

picture.addEventListener('pointermove', (event) => {
  const pointer = pointers.get(event.pointerId);
  if (!pointer) return;
  const before = middle();
  pointer.x = event.clientX;
  pointer.y = event.clientY;
  const now = middle();
  const moved = [(now.x - before.x) / picture.clientHeight, (before.y - now.y) / picture.clientHeight];
  const pans = pointers.size > 1 || pointer.button !== 0 || event.shiftKey;
  steer(pans ? {pan: moved} : {turn: moved});
  if (before.spread > 0 && now.spread > 0) steer({zoom: Math.log(now.spread / before.spread) / Math.log(1 / 0.9)});
});

for (const end of ['pointerup', 'pointercancel'])
  picture.addEventListener(end, (event) => pointers.delete(event.pointerId));

picture.addEventListener('wheel', (event) => {
  const notches = event.deltaY / (event.deltaMode === 0 ? 100 : 3);
  steer({zoom: Math.max(-10, Math.min(10, -notches))});
  event.preventDefault();
}, {passive: false});

picture.addEventListener('contextmenu', (event) => event.preventDefault());

// The scene point under the mouse, and the distance between two such points.

let mouse = null;        // relative to the image, from 0 to 1; null outside the page
let over = null;         // the scene point under the mouse
let measuredFrom = null;

// Listens on the whole page, because a note may cover the image.
addEventListener('pointermove', (event) => {
  const box = picture.getBoundingClientRect();
  mouse = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
});
document.documentElement.addEventListener('pointerleave', () => { mouse = null; });

const inPicture = (share) => Math.min(1, Math.max(0, share));

async function lookAtPlace() {
  try {
    over = viewer && mouse && shownState && shownState.frame ?
      (await ask(`${forViewer('point')}&x=${inPicture(mouse[0])}&y=${inPicture(mouse[1])}`)).point : null;
    element('place').textContent = over ? placeText(over) : '';
  } catch (failure) {
    over = null;
  }
  setTimeout(lookAtPlace, PLACE_MS);
}

function placeText({scene, lat_lon_height: place, distance_m: distance}) {
  const metres = (v) => `${v.toFixed(2)} m`;
  const there = place ? `lat ${place[0].toFixed(7)}° lon ${place[1].toFixed(7)}° ${metres(place[2])}` :
    scene.map((v) => v.toFixed(2)).join(' ');
  return `${there}, ${metres(distance)} away`;
}

function measure() {
  if (!over) return note('Point at a surface to measure from it.', 4000);
  if (!measuredFrom) {
    measuredFrom = over;
    return note(`From ${placeText(over)}: press C at the other end.`);
  }
  const [east, north, up] = over.scene.map((v, i) => v - measuredFrom.scene[i]);
  const across = Math.hypot(east, north);
  note(`${Math.hypot(across, up).toFixed(2)} m: ${across.toFixed(2)} m horizontal, ${up.toFixed(2)} m vertical`, 20000);
  measuredFrom = null;
}

// Bookmarked views in this browser.

const keptAs = (digit) => `gigabake view ${digit} of ${location.pathname}`;

function keep(digit) {
  if (!shownState || !shownState.scene) return;
  localStorage.setItem(keptAs(digit), JSON.stringify([...shownState.eye, ...shownState.target]));
  note(`Saved as view ${digit}.`, 3000);
}

function goTo(digit) {
  const pose = localStorage.getItem(keptAs(digit));
  if (!pose) return note(`No view is saved as ${digit}: Shift ${digit} saves this one.`, 4000);
  for (const movement of ['turn', 'pan', 'zoom']) delete pending[movement];  // they would change the bookmarked pose
  steer({pose: JSON.parse(pose)});
}

// Keys.

const WALK = {KeyW: [1, 0, 0], KeyS: [-1, 0, 0], KeyD: [0, 1, 0], KeyA: [0, -1, 0], KeyE: [0, 0, 1], KeyQ: [0, 0, -1]};
const SWING = {ArrowRight: [0.3, 0], ArrowLeft: [-0.3, 0], ArrowUp: [0, 0.3], ArrowDown: [0, -0.3]};

function total(moves, zero) {
  return [...held].reduce((sum, code) => moves[code] ? sum.map((v, i) => v + moves[code][i]) : sum, zero)
      .map((v) => slow ? v / 5 : v);
}

function hold() {
  heldSent = performance.now();
  steer({walk: total(WALK, [0, 0, 0]), swing: total(SWING, [0, 0])});
}

function next(id) {
  const options = [...element(id).options].map((option) => option.value);
  steer({[id]: options[(options.indexOf(shownState ? shownState[id] : '') + 1) % options.length]});
}

function toggleHelp() {
  element('keys').hidden = !element('keys').hidden;
}

const ONCE = {
  KeyO: () => next('style'),
  KeyM: () => next('mode'),
  KeyH: () => steer({home: true}),
  KeyP: save,
  KeyC: measure,
  Slash: toggleHelp,
  Equal: () => halfLevels(1),
  NumpadAdd: () => halfLevels(1),
  Minus: () => halfLevels(-1),
  NumpadSubtract: () => halfLevels(-1),
};

// Makes the pixel error `coarser` half levels coarser, rounded to a power of √2. Equal numbers of steps in both
// directions therefore restore the same value.
function halfLevels(coarser) {
  const now = Math.round(2 * Math.log2(shownState ? shownState.pixel_error : 1));
  steer({pixel_error: 2 ** (Math.max(-32, Math.min(32, now + coarser)) / 2)});
}

addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target.tagName === 'SELECT' || ['datetime-local', 'number'].includes(event.target.type)) return;
  slow = event.shiftKey;
  if (WALK[event.code] || SWING[event.code]) {
    event.preventDefault();
    if (event.repeat) return;
    held.add(event.code);
    hold();
  } else if (ONCE[event.code] && !event.repeat) {
    ONCE[event.code]();
  } else if (/^Digit[1-9]$/.test(event.code)) {
    (event.shiftKey ? keep : goTo)(event.code.at(-1));
  }
});

addEventListener('keyup', (event) => {
  slow = event.shiftKey;
  if (held.delete(event.code)) hold();
});

addEventListener('blur', () => {
  held.clear();
  hold();
});

new ResizeObserver(fit).observe(picture);
addEventListener('resize', fit);  // a new pixel ratio does not change the layout

// The control bar.

element('mode').addEventListener('change', (event) => { steer({mode: event.target.value}); event.target.blur(); });
element('style').addEventListener('change', (event) => { steer({style: event.target.value}); event.target.blur(); });
element('error').addEventListener('input', (event) => steer({pixel_error: 2 ** Number(event.target.value)}));
element('error').addEventListener('change', (event) => event.target.blur());
for (const id of ['azimuth', 'elevation']) {
  element(id).addEventListener('input', () => steer({sun: ['azimuth', 'elevation'].map((axis) => Number(element(axis).value))}));
  element(id).addEventListener('change', (event) => event.target.blur());
}
element('time').addEventListener('input', (event) => {
  const milliseconds = Date.parse(event.target.value);  // in the browser's time zone
  if (!Number.isNaN(milliseconds)) steer({time: milliseconds / 86400000 + JULIAN_DAY_OF_1970});
});
for (const id of ['shadows', 'level_blend'])
  element(id).addEventListener('change', (event) => { steer({[id]: event.target.checked ? 'on' : 'off'}); event.target.blur(); });
element('home').addEventListener('click', () => steer({home: true}));
element('save').addEventListener('click', save);
element('help').addEventListener('click', toggleHelp);

if (location.search.includes('token=')) history.replaceState(null, '', location.pathname);
setInterval(send, SEND_MS);
look();
lookAtPlace();
