// Drives that have ended: listed, opened again, downloaded.

import { getJson, withToken } from './api.js';
import { element, figures, find } from './dom.js';
import { attempt, planAgain } from './actions.js';
import { plots, readRun } from './plots.js';
import { changed, onChange, state } from './state.js';

const when = new Intl.DateTimeFormat(undefined, { dateStyle: 'medium', timeStyle: 'short' });

async function list() {
  await attempt('drive', async () => {
    const { runs, folder } = await getJson('runs');
    find('runs').replaceChildren(...runs.map((run) => {
      const end = run.reached ? 'goal reached' : run.error ?? 'beside the goal';
      const button = element('button', { type: 'button', 'data-run': run.name }, element('b', { class: run.reached ? 'good' : 'bad', 'aria-hidden': 'true' }, run.reached ? '✓' : '–'),
        element('span', {}, when.format(run.ended * 1000), element('small', {}, end)), element('i', {}, `${run.duration.toFixed(1)} s`));
      button.addEventListener('click', () => openRun(run.name));
      return element('li', {}, button);
    }));
    find('runs-note').textContent = runs.length ? `Kept in ${folder}.` : 'No drive has ended yet.';
  });
}

async function openRun(name) {
  await attempt('drive', async () => {
    const run = await getJson(`runs/${name}`);
    run.samples = readRun(await (await fetch(withToken(`/api/runs/${name}/run.jsonl`))).text());
    state.past = run;
    changed();
  });
  find('past').scrollIntoView({ block: 'nearest' });
}

/** The files of a run to download. */
export function downloads(name, files) {
  const titles = { 'run.jsonl': 'Run', 'report.json': 'Report', 'plan.json': 'Plan', 'scene.json': 'Scene', '15_motion.svg': 'Motion', photo: 'Photo' };
  const known = Object.keys(titles).filter((file) => files.includes(file));
  return element('p', { class: 'downloads' }, 'Download ', ...known.map((file) =>
    element('a', { href: withToken(`/api/runs/${name}/${file}`), download: `${name}-${file}` }, titles[file])));
}

function showPast() {
  const { past } = state;
  find('past').hidden = !past;
  if (!past) return;
  const { report, plan } = past;
  const rows = element('dl', { class: 'figures' });
  figures(rows, [
    ['From goal', (report.error.position * 1000).toFixed(1), 'mm'], ['Time', report.duration.toFixed(1), 's'], ['Length', plan.length.toFixed(2), 'm'],
  ]);
  const back = element('button', { type: 'button', id: 'past-close' }, 'Back to now');
  const again = element('button', { type: 'button', id: 'past-again' }, 'Plan this again');
  back.addEventListener('click', () => {
    state.past = null;
    changed();
  });
  again.addEventListener('click', () => planAgain(plan));
  find('past').replaceChildren(element('strong', {}, `${past.name}: ${report.reached ? 'goal reached' : report.problem?.message ?? 'ended beside the goal'}`),
    rows, plots(past.samples, plan.waypoints), downloads(past.name, past.files), element('div', { class: 'row' }, back, again));
}

find('runs-details').addEventListener('toggle', () => { if (find('runs-details').open) list(); });
onChange(() => { if (find('runs-details').open) list(); }, ({ run }) => run?.revision);
onChange(showPast, ({ past }) => past?.name);
