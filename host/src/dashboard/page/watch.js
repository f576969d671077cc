// Step 4 under a camera: which one watches, what it says, and things set down under a simulated one.

import { post } from './api.js';
import { element, find, sentence } from './dom.js';
import { attempt } from './actions.js';
import { centimetres } from './floor.js';
import { moves, reach } from './seen.js';
import { changed, onChange, state } from './state.js';

/** A picture that is older is no live one, seconds. */
const OLD = 3;
/** How far ahead of the robot something is set down in its way, metres. */
const AHEAD = 0.5;

const name = (source) => (source === 'sim' ? 'a simulated camera' : source);

find('watch').addEventListener('change', () => {
  const { sources } = state.camera;
  const wanted = find('watch-source').value || sources[0];
  attempt('drive', async () => {
    state.camera = (await post('camera', { source: find('watch').checked ? wanted : null })).camera;
  });
});
find('watch-source').addEventListener('change', () => {
  if (!state.camera?.source) return;
  attempt('drive', async () => { state.camera = (await post('camera', { source: find('watch-source').value })).camera; });
});

find('set-down').addEventListener('click', () => {
  state.adding = state.adding === 'thing' ? null : 'thing';
  state.draft = [];
  changed();
});
find('set-ahead').addEventListener('click', () => {
  const at = pointAhead(state.drive?.view?.way ?? state.plan?.waypoints ?? []);
  if (at) setDown(at, null);
});

/** Sets a box down, and lets it roll if it is to be elsewhere. */
export function setDown(at, to) {
  state.adding = null;
  state.draft = [];
  changed();
  return attempt('drive', () => post('things', { at, to }));
}

/** The point so far along a way; its end if it is shorter. */
function pointAhead(way) {
  let left = AHEAD;
  for (let i = 1; i < way.length; i += 1) {
    const [from, to] = [way[i - 1], way[i]];
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (length >= left) return [0, 1].map((axis) => from[axis] + (left / length) * (to[axis] - from[axis]));
    left -= length;
  }
  return way.at(-1) ?? null;
}

/** What the camera and the robot under it do, in a kind and words. */
export function watchWords() {
  const { camera, drive } = state;
  if (!camera?.source) return ['off', 'Off: the robot drives by its wheels alone.'];
  if (camera.problem) return ['trouble', `The camera is of no use now: ${sentence(camera.problem).replace(/^./, (first) => first.toLowerCase())}`];
  if (camera.frame === null) return ['off', state.scene?.start || camera.source !== 'sim' ? 'Waiting for its first picture.' : 'Say on Plan where the robot stands: then it shows that floor.'];
  const view = drive?.active ? drive.view : null;
  if (view?.held) return ['waits', `The robot waits: ${sentence(view.held).replace(/^./, (first) => first.toLowerCase())}`];
  if (camera.age > OLD) return ['trouble', `No picture for ${camera.age.toFixed(0)} s.`];
  if (!view) return ['sees', 'It shows the floor, and watches the next drive.'];
  const moving = view.things.filter(moves).length;
  const count = `${view.things.length} ${view.things.length === 1 ? 'thing' : 'things'}`;
  return ['sees', `It sees ${count}${moving ? `, ${moving} of them moving` : ''}; the robot is known to ${centimetres(reach(view.covariance))} cm.`];
}

/** For the stage: why the robot waits, as it was said once; what changes with each picture would be read out again
 * and again. */
export function waitHint() {
  if (state.adding === 'thing') return 'Click where a box is set down; drag to let it roll';
  const { drive } = state;
  if (!drive?.active || !drive.view?.held) return '';
  return sentence(drive.told.find(({ event }) => event === 'held')?.text ?? drive.view.held);
}

onChange(() => {
  const { camera, drive } = state;
  const sources = camera?.sources ?? [];
  find('watching').hidden = !sources.length && !camera?.source;
  find('watch').checked = Boolean(camera?.source);
  find('watch').disabled = Boolean(drive?.active) || !state.online;
  const choice = find('watch-source');
  choice.hidden = sources.length < 2;
  choice.disabled = Boolean(drive?.active);
  const shown = [...choice.options].map((option) => option.value);
  if (shown.join() !== sources.join()) choice.replaceChildren(...sources.map((source) => element('option', { value: source }, name(source))));
  if (camera?.source && document.activeElement !== choice) choice.value = camera.source;
  const [kind, words] = watchWords();
  const said = find('watch-words');
  said.dataset.kind = kind;
  if (said.textContent !== words) said.textContent = words;
  find('set-tools').hidden = camera?.source !== 'sim' || camera.frame === null;
  find('set-down').setAttribute('aria-pressed', state.adding === 'thing');
  find('use-live').hidden = !camera || (camera.frame === null && !sources.some((source) => source !== 'sim'));
}, ({ camera, drive, online, adding, scene }) => [camera, drive?.active, drive?.view, online, adding, scene?.start]);

onChange(() => {
  const told = state.drive?.told ?? [];
  find('told').replaceChildren(...told.map(({ time, text }) =>
    element('li', {}, element('time', {}, `${time.toFixed(1)} s`), element('span', {}, sentence(text)))));
}, ({ drive }) => drive?.told);
