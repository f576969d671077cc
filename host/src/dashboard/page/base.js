// The base: which robot, moving it by hand, its numbers, what goes wrong with a simulated one, its frames.

import { getJson, post } from './api.js';
import { element, fill, find, showProblem } from './dom.js';
import { attempt } from './actions.js';
import { changed, onChange, state } from './state.js';

const isShown = () => state.step === 'base';

// Ports.

export async function showPorts() {
  await attempt('base', async () => {
    const { ports } = await getJson('ports');
    find('port').replaceChildren(...ports.map(({ name, kind }) =>
      element('option', { value: name, selected: name === state.base?.port }, `${name} – ${kind}`)), element('option', { value: '' }, 'another address …'));
    showAddress();
  });
}

const showAddress = () => { find('address-field').hidden = find('port').value !== ''; };
find('port').addEventListener('change', showAddress);
find('connect').addEventListener('submit', (event) => {
  event.preventDefault();
  attempt('base', async () => {
    await post('connect', { port: find('port').value || find('address').value });
    numbers = null;
    changed();
  });
});
find('ports-again').addEventListener('click', showPorts);

// Moving while held: the program stops the robot unless it hears every 0.3 s that the button is held, and the
// robot stops unless it hears the program.

const SAY_AGAIN = 100;
let held = null;

async function whileHeld(hold) {
  held = hold;
  state.problem.base = null;
  try {
    await post('jog', { hold, begin: true });
    while (held === hold) {
      await new Promise((resolve) => setTimeout(resolve, SAY_AGAIN));
      if (held === hold && !(await post('jog', { hold })).held) held = null;
    }
  } catch (error) {
    held = null;
    state.problem.base = error;
    changed();
  }
}

export function letGo() {
  if (!held) return;
  held = null;
  // If this is lost, the silence says the same.
  post('jog', { hold: 'none' }).catch(() => {});
}

for (const button of document.querySelectorAll('[data-hold]')) {
  const { hold } = button.dataset;
  button.addEventListener('pointerdown', (event) => {
    button.setPointerCapture(event.pointerId);
    whileHeld(hold);
  });
  button.addEventListener('keydown', (event) => {
    if ((event.key === 'Enter' || event.key === ' ') && !event.repeat && held !== hold) whileHeld(hold);
  });
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture', 'keyup', 'blur']) button.addEventListener(name, letGo);
}
addEventListener('blur', letGo);
addEventListener('keydown', (event) => { if (event.key === 'Escape') held = null; }, { capture: true });

// Numbers.

const UNITS = { m: ['mm', 1000] };
let numbers = null;

const shownUnit = ({ unit }) => UNITS[unit] ?? [unit.replace('s2', 's²'), 1];

function showNumbers() {
  find('numbers').replaceChildren(...numbers.parameters.map((number) => {
    const [unit, factor] = shownUnit(number);
    const trim = (value) => String(Number((value * factor).toPrecision(7)));
    const input = element('input', { type: 'number', step: 'any', min: trim(number.least), max: trim(number.most), value: trim(number.value), 'data-number': number.name, required: true, 'aria-describedby': `range-${number.name}` });
    return element('label', {}, number.name.replaceAll('-', ' '), element('span', { class: 'unit' }, input, unit ? ` ${unit}` : null),
      element('small', { id: `range-${number.name}` }, `${trim(number.least)} to ${trim(number.most)}`));
  }));
  find('calibration-note').textContent = numbers.calibration ? `Calibration ${numbers.calibration}.` : 'Never calibrated: see below.';
}

async function askNumbers(wish) {
  await attempt('base', async () => {
    numbers = await post('parameters', wish);
    showNumbers();
  });
}

find('numbers-details').addEventListener('toggle', () => { if (find('numbers-details').open && !numbers) askNumbers({}); });
find('numbers-form').addEventListener('submit', (event) => {
  event.preventDefault();
  const values = {};
  for (const number of numbers?.parameters ?? []) {
    const [, factor] = shownUnit(number);
    const value = find('numbers').querySelector(`[data-number="${number.name}"]`).valueAsNumber / factor;
    if (Math.abs(value - number.value) > 1e-7 * Math.max(1, Math.abs(number.value))) values[number.name] = value;
  }
  askNumbers({ values, keep: find('keep-numbers').checked });
});
find('numbers-read').addEventListener('click', () => askNumbers({}));

// Faults of a simulated robot.

find('faults').addEventListener('submit', (event) => event.preventDefault());
find('faults').addEventListener('change', () => {
  const share = (name) => (find(name).valueAsNumber || 0) / 100;
  const encoder = find('fault-encoder').value;
  const wheel = find('fault-blocked').value;
  sendFaults({
    loss: share('fault-loss'), corruption: share('fault-damage'), latency: (find('fault-latency').valueAsNumber || 0) / 1000,
    slip: [share('fault-slip-left'), share('fault-slip-right')],
    blocked: [wheel === 'left', wheel === 'right'],
    camera: find('fault-camera').value,
    encoders: ['left', 'right'].map((side) => (encoder.endsWith(side) ? encoder.split(' ')[0] : 'counts')),
  });
});
find('faults-none').addEventListener('click', () => {
  find('faults').reset();
  sendFaults({});
});

const sendFaults = (wish) => attempt('base', async () => { state.faults = (await post('faults', wish)).faults; });

function areSome(faults) {
  if (!faults) return false;
  const { loss, corruption, latency, slip, blocked, encoders, camera } = faults;
  return [loss, corruption, latency, ...slip].some((share) => share > 0) || blocked.includes(true) || encoders.some((name) => name !== 'counts') || camera !== 'sees';
}

// Frames.

let watching = 0;
async function showFrames() {
  const { frames } = await getJson('frames').catch(() => ({ frames: [] }));
  const table = find('frames');
  const atEnd = table.scrollHeight - table.scrollTop - table.clientHeight < 40;
  table.replaceChildren(...frames.slice(-120).map(({ t, to_robot, bytes, said }) =>
    element('li', { title: bytes }, element('time', {}, t.toFixed(2)), element('b', { class: to_robot ? 'out' : 'in' }, to_robot ? '→ robot' : '← robot'), element('span', {}, find('frames-raw').checked ? bytes : said))));
  if (atEnd) table.scrollTop = table.scrollHeight;
}
find('frames-details').addEventListener('toggle', () => {
  clearInterval(watching);
  if (!find('frames-details').open) return;
  showFrames();
  watching = setInterval(() => { if (isShown() && !find('frames-hold').checked) showFrames(); }, 500);
});
find('frames-raw').addEventListener('change', showFrames);

let wasShown = false;
onChange(() => {
  const { base } = state;
  if (isShown() && !wasShown) showPorts();
  wasShown = isShown();
  const words = [base?.name, base?.connected ? 'connected' : 'no link', base?.detail].filter(Boolean).join(', ');
  if (find('base-line').textContent !== words) find('base-line').textContent = words;
  const simulated = base?.port === 'sim' || Boolean(base?.port?.startsWith('elf:'));
  find('faults-details').hidden = !simulated;
  find('faults-on').hidden = !areSome(state.faults);
  for (const button of document.querySelectorAll('[data-hold]')) button.disabled = !base?.connected || (Boolean(state.drive?.active) && !held);
  showProblem(find('base-problem'), state.problem.base ?? (base && !base.connected ? base.problem : null));
  if (!numbers && find('numbers-details').open && base?.connected && isShown() && !state.problem.base) askNumbers({});
}, ({ step, base, faults, drive, problem }) => [step, base?.name, base?.port, base?.connected, base?.detail, base?.problem, faults, drive?.active, problem.base]);
