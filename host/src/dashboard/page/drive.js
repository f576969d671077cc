// Step 4: the drive, and what came of it.

import { withToken } from './api.js';
import { element, figures, find, showProblem } from './dom.js';
import { drive, jog, pause, resume } from './actions.js';
import { degrees } from './floor.js';
import { onChange, state } from './state.js';

find('drive').addEventListener('click', drive);
find('pause').addEventListener('click', () => (state.drive?.pause_wanted ? resume() : pause()));

// A jog goes on as long as the button or key is held, and ends by itself when nothing asks again.
let held = null;
async function whileHeld(step) {
  held = step;
  while (held === step) {
    if (!state.drive?.active) await jog(step);
    await new Promise((resolve) => setTimeout(resolve, 60));
    if (state.problem.drive) held = null;
  }
}
for (const button of document.querySelectorAll('[data-jog]')) {
  const [distance, turn] = button.dataset.jog.split(',').map(Number);
  const step = distance ? { distance } : { turn };
  button.addEventListener('pointerdown', (event) => {
    button.setPointerCapture(event.pointerId);
    whileHeld(step);
  });
  button.addEventListener('keydown', (event) => {
    if ((event.key === 'Enter' || event.key === ' ') && held !== step) whileHeld(step);
  });
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture', 'keyup', 'blur']) button.addEventListener(name, () => { held = null; });
}
addEventListener('blur', () => { held = null; });

function report(run) {
  const done = run?.report;
  if (!done) return null;
  const ended = run.error ? null : done.reached;
  const title = run.error ? 'Ended on the way' : ended ? 'Goal reached' : 'Ended beside the goal';
  const rows = [
    ['From goal', (done.error.position * 1000).toFixed(1), 'mm'], ['Heading off', degrees(done.error.heading).toFixed(1), '°'],
    ['Time', done.duration.toFixed(1), 's'], ['Legs', String(done.legs.length)],
  ];
  if (done.collisions !== undefined) {
    rows.push(['Collisions', String(done.collisions)], ['Nearest', (done.min_clearance * 1000).toFixed(0), 'mm']);
  }
  const list = element('dl', { class: 'figures' });
  figures(list, run.error ? rows.slice(2) : rows);
  return element('div', { class: `result${ended ? '' : ' missed'}`, id: 'result' }, element('strong', {}, title), list,
    element('a', { href: withToken('/api/run.jsonl'), download: 'run.jsonl' }, 'Download the run'));
}

let shownRun = -1;
onChange(() => {
  const { drive: status, run, base } = state;
  const active = Boolean(status?.active);
  find('drive').disabled = active || !state.plan || !state.online || !base?.connected;
  find('drive').textContent = run?.report && !active ? 'Drive again' : 'Drive';
  find('pause').disabled = !active;
  find('pause').textContent = status?.pause_wanted ? 'Resume' : 'Pause';
  // A jog has no way that one could follow, and what is shown for it would push the buttons away.
  const follows = active && held === null;
  find('progress').hidden = !follows;
  if (follows) {
    const legs = Math.max(status.legs, 1);
    const bar = find('progress-bar');
    bar.setAttribute('aria-valuemax', legs);
    bar.setAttribute('aria-valuenow', status.leg);
    bar.firstElementChild.style.width = `${(100 * status.leg) / legs}%`;
    const beside = status.cross_track === null ? '–' : Math.abs(status.cross_track * 1000).toFixed(1);
    figures(find('drive-figures'), [
      ['Leg', `${Math.min(status.leg + 1, legs)} of ${legs}`], ['Time', status.time.toFixed(1), 's'], ['Beside the leg', beside, 'mm'],
    ]);
  }
  const error = state.problem.drive ?? (active ? null : run?.error);
  showProblem(find('drive-problem'), error);
  if (run && shownRun !== run.revision && held === null) {
    shownRun = run.revision;
    const shown = report(run);
    find('report').hidden = !shown;
    find('report').replaceChildren(...(shown ? [shown] : []));
  }
});
