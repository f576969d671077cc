// The page: its steps in the order of the work, and the state from the server.

import { giveUp, listen } from './api.js';
import { find } from './dom.js';
import { isPlanning, refresh, replan, restore, timing } from './actions.js';
import { isDragging } from './hands.js';
import { currentCorners, followRobot } from './stage.js';
import './bar.js';
import './photo.js';
import './boxes.js';
import './plan.js';
import './drive.js';
import { followFrames } from './live.js';
import { waitHint } from './watch.js';
import './reading.js';
import './steps.js';
import './runs.js';
import './calibrate.js';
import { letGo } from './base.js';
import { changed, onChange, state } from './state.js';

const STEPS = ['photo', 'boxes', 'plan', 'drive', 'base'];
const DRAWING = {
  box: 'Drag a rectangle over the box',
  disc: 'Drag from the middle of the obstacle to its rim',
  polygon: 'Click the corners one by one; a click on the first, or Enter, closes it',
  ignore: 'Drag from the middle of the place to its rim',
};
const HINTS = {
  photo: () => DRAWING[state.adding] ?? '',
  boxes: () => DRAWING[state.adding] ?? '',
  plan: () => (!state.start ? 'Click where the robot stands, and drag to where it looks' : !state.goal ? 'Click where it is to go' : ''),
  drive: waitHint,
  base: () => '',
};

for (const button of document.querySelectorAll('[data-step]')) {
  button.addEventListener('click', () => {
    letGo();
    state.step = button.dataset.step;
    state.adding = null;
    state.draft = [];
    if (state.step === 'plan') startFromTheEnd();
    changed();
  });
}

/** After a drive the robot stands somewhere else: the next way begins there. */
function startFromTheEnd() {
  const run = state.run;
  if (!run?.report || startFromTheEnd.done === run.revision) return;
  startFromTheEnd.done = run.revision;
  const pose = run.report.true_pose ?? run.report.pose;
  state.start = pose.map((value) => Number(value.toFixed(4)));
  state.goal = null;
  replan();
}

onChange(() => {
  const reached = { photo: Boolean(state.photo || state.scene), boxes: Boolean(state.scene), plan: Boolean(state.plan), drive: Boolean(state.run?.report?.reached), base: false };
  for (const button of document.querySelectorAll('[data-step]')) {
    const { step } = button.dataset;
    const here = step === state.step;
    if (here) button.setAttribute('aria-current', 'step');
    else button.removeAttribute('aria-current');
    button.classList.toggle('done', reached[step] && !here);
    const before = STEPS[STEPS.indexOf(step) - 1];
    button.disabled = !here && step !== 'drive' && step !== 'base' && Boolean(before) && !reached[before] && !(step === 'plan' && state.scene);
  }
  for (const panel of document.querySelectorAll('[data-panel]')) panel.hidden = panel.dataset.panel !== state.step;
  document.body.dataset.shows = state.step;
  find('hint').textContent = state.photo || state.scene ? state.working || HINTS[state.step]() : '';
});

// What takes long can be given up.
const LONG = 500;
let waiting = 0;
find('cancel').addEventListener('click', giveUp);
onChange(() => {
  clearTimeout(waiting);
  if (state.working) waiting = setTimeout(() => { find('cancel').hidden = !state.working; }, LONG);
  else find('cancel').hidden = true;
}, ({ working }) => working);

/** A page that is opened when there is something to see already begins there. */
function beginThere() {
  if (state.step !== 'photo') return;
  if (state.drive?.active) state.step = 'drive';
  else if (state.plan) state.step = 'plan';
  else if (state.scene) state.step = 'boxes';
}

let refreshing = false;
let isFirst = true;
async function takeLive(live) {
  const first = isFirst;
  isFirst = false;
  state.heard = performance.now();
  state.base = live.base;
  state.drive = live.drive;
  state.camera = live.camera;
  followFrames();
  followRobot();
  changed();
  const own = state.revision;
  const old = ['photo', 'scene', 'plan', 'run'].some((name) => live.revision[name] > own[name]);
  if (!old || refreshing || isPlanning() || isDragging() || state.working) return;
  refreshing = true;
  try {
    await refresh();
    if (first && !state.working) beginThere();
    followRobot();
  } catch {
    // The next state tries again.
  }
  refreshing = false;
}

listen(takeLive, (online, isNew) => {
  state.online = online;
  if (isNew && state.scene) {
    restore(currentCorners());
  } else if (online) {
    // It may be the first time, or another page may have changed something meanwhile.
    state.revision = { photo: -1, scene: -1, plan: -1, run: -1 };
  }
  changed();
});

// For tests and for people with a console: what the page shows, and how long plans took.
window.wmr = { state, timing };
changed();
