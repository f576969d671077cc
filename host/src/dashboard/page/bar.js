// The top bar: the robot's badge and STOP; and the veil over what is old.

import { find } from './dom.js';
import { stop } from './actions.js';
import { onChange, state } from './state.js';

find('stop').addEventListener('click', stop);
// Before anything else hears the key, whatever has the focus.
addEventListener('keydown', (event) => {
  if (event.key !== 'Escape') return;
  state.adding = null;
  state.draft = [];
  stop();
}, { capture: true });

const WORDS = { idle: 'ready', driving: 'driving', paused: 'paused', stopped: 'stopped', faulted: 'fault' };
/** Older than this is no longer live, seconds. */
const OLD = 1;

const since = () => (performance.now() - state.heard) / 1000;

function badge() {
  const { base } = state;
  const node = find('base');
  const lost = !state.online || !base?.connected;
  node.dataset.state = lost ? 'lost' : base.state ?? 'lost';
  find('base-name').textContent = base?.port ?? 'robot';
  const battery = base?.battery ? ` · ${base.battery.volts.toFixed(1)} V` : '';
  const age = base?.age > OLD ? ` · ${base.age.toFixed(0)} s old` : '';
  const words = lost ? (state.online ? 'no link' : 'program gone') : `${WORDS[base.state] ?? ''}${battery}${age}`;
  if (find('base-state').textContent !== words) find('base-state').textContent = words;
  const heard = base?.age === null || base?.age === undefined ? null : `last heard ${base.age.toFixed(1)} s ago`;
  node.title = [base?.name, base?.detail, base?.problem?.message, heard].filter(Boolean).join('; ');
}

function veil() {
  const { base, drive } = state;
  const silent = since() > OLD;
  const old = Boolean(drive?.active) && base?.age > OLD;
  const node = find('veil');
  node.hidden = !silent && !old;
  if (node.hidden) return;
  find('veil-what').textContent = silent ? `No word from the program for ${since().toFixed(0)} s` : `No word from the robot for ${base.age.toFixed(0)} s`;
  find('veil-more').textContent = silent
    ? 'The robot stops by itself. Start wmr serve again, and this page goes on.'
    : 'It stops by itself after 0.3 s of silence. Check its cable and battery.';
}

onChange(() => {
  badge();
  veil();
});
setInterval(veil, 250);
