// Step 4: the drive, and what came of it.

import { withToken } from './api.js';
import { element, figures, find, showProblem } from './dom.js';
import { drive, pause, resume } from './actions.js';
import { plots, readRun } from './plots.js';
import { downloads } from './runs.js';
import { degrees } from './floor.js';
import { onChange, state } from './state.js';

find('drive').addEventListener('click', drive);
find('unattended').addEventListener('change', () => { state.unattended = find('unattended').checked; });
find('pause').addEventListener('click', () => (state.drive?.pause_wanted ? resume() : pause()));

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
  if (done.watch) rows.push(['New paths', String(done.watch.replans)], ['Waits', String(done.watch.waits)]);
  const list = element('dl', { class: 'figures' });
  figures(list, run.error ? rows.slice(2) : rows);
  const files = ['run.jsonl', 'report.json', 'plan.json', 'scene.json', '15_motion.svg', ...(state.photo ? ['photo'] : [])];
  const kept = run.kept ? downloads(run.kept, files) : element('a', { href: withToken('/api/run.jsonl'), download: 'run.jsonl' }, 'Download the run');
  return element('div', { class: `result${ended ? '' : ' missed'}`, id: 'result' }, element('strong', {}, title), list, kept,
    run.not_kept ? element('p', { class: 'note' }, `This drive is not kept: ${run.not_kept}`) : null);
}

// The plots of the drive under way, from what the socket says; of one that has ended, from all that the robot said.

let live = { run: -1, samples: [] };
let drawn = 0;

function follow() {
  const { drive: status, base } = state;
  // Before it has the plan, the robot does not know where it stands.
  if (!status?.active || !base?.pose || !(status.time > 0)) return;
  if (live.run !== status.revision) live = { run: status.revision, samples: [] };
  if (live.samples.at(-1)?.t !== status.time) live.samples.push({ t: status.time, pose: base.pose, wheels: base.wheels });
}

function showPlots() {
  follow();
  const now = performance.now();
  if (state.step !== 'drive' || !state.drive?.active || state.past || now - drawn < 400) return;
  drawn = now;
  find('plots').replaceChildren(plots(live.samples, planPath()));
}

const planPath = () => state.plan?.waypoints ?? [];

async function showAllPlots() {
  const samples = readRun(await (await fetch(withToken('/api/run.jsonl'))).text());
  if (!state.drive?.active) find('plots').replaceChildren(...(samples.length > 1 ? [plots(samples, planPath())] : []));
}

onChange(showPlots);

let shownRun = -1;
onChange(() => {
  const { drive: status, run, base } = state;
  const active = Boolean(status?.active);
  find('drive').disabled = active || state.planning || !state.plan || !state.online || !base?.connected;
  find('drive').textContent = run?.report && !active ? 'Drive again' : 'Drive';
  find('pause').disabled = !active;
  find('pause').textContent = status?.pause_wanted ? 'Resume' : 'Pause';
  // A move by hand has no way that one could follow.
  const follows = active && status.legs > 0 && state.step === 'drive';
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
  if (run && shownRun !== run.revision) {
    shownRun = run.revision;
    const shown = report(run);
    find('report').hidden = !shown;
    if (shown) showAllPlots();
    else if (!active) find('plots').replaceChildren();
    find('report').replaceChildren(...(shown ? [shown] : []));
  }
});
