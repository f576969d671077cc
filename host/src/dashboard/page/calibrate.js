// Calibration of the base as a walk-through: six courses, each driven and its end measured.

import { post } from './api.js';
import { element, find, showProblem } from './dom.js';
import { degrees, radians, round } from './floor.js';
import { onChange, state } from './state.js';

const COURSES = [
  (side) => `straight ahead for ${side} m`, () => 'five turns on the spot', (side) => `a square of ${side} m to the left`,
  (side) => `a square of ${side} m to the right`, (side) => `a square of ${side} m to the left`, (side) => `a square of ${side} m to the right`,
];

let ends = [];
/** The run that drives the course, and what the robot believes at its end. */
let under = null;
let believed = null;
let found = null;
let problem = null;

const side = () => find('calibrate-side').valueAsNumber || 1;

async function attemptHere(action) {
  problem = null;
  try {
    await action();
  } catch (error) {
    problem = error;
  }
  show();
}

find('calibrate-drive').addEventListener('click', () => attemptHere(async () => {
  if (ends.length === COURSES.length) {
    found = await post('calibrate', { side: side(), ends, keep: true });
    return;
  }
  believed = null;
  under = (await post('course', { index: ends.length, side: side() })).run;
}));
find('calibrate-again').addEventListener('click', () => {
  [ends, under, believed, found, problem] = [[], null, null, null, null];
  show();
});
find('measured').addEventListener('submit', (event) => {
  event.preventDefault();
  const [x, y, angle] = ['measured-x', 'measured-y', 'measured-angle'].map((name) => find(name).valueAsNumber);
  take([x / 1000, y / 1000, radians(angle)]);
  find('measured').reset();
});

function take(measured) {
  ends.push({ believed, measured });
  believed = null;
  show();
}

/** A course that has ended on the way to its end. */
function follow() {
  const { run, drive } = state;
  if (under === null || !run || run.revision <= under || drive?.active) return;
  under = null;
  problem = run.error;
  if (run.course) {
    believed = run.course.believed;
    if (run.course.measured) take(run.course.measured);
  }
  show();
}

function show() {
  const next = ends.length;
  const driving = under !== null;
  find('calibrate-list').replaceChildren(...COURSES.map((describe, index) => {
    const end = ends[index]?.measured;
    const place = end ? `${round(end[0] * 1000, 0)}, ${round(end[1] * 1000, 0)} mm, ${round(degrees(end[2]), 1)}°` : '';
    return element('li', index === next && !found ? { 'aria-current': 'step' } : {}, `${end ? '✓' : index + 1}. ${describe(side())}`, element('small', {}, place));
  }));
  find('calibrate-side').disabled = next > 0 || driving;
  const button = find('calibrate-drive');
  button.hidden = Boolean(believed) || Boolean(found);
  button.disabled = driving || !state.base?.connected;
  button.textContent = driving ? `Driving course ${next + 1} …` : next < COURSES.length ? `Drive course ${next + 1} of ${COURSES.length}` : 'Give the lengths to the robot';
  find('measured').hidden = !believed;
  find('calibrate-again').hidden = next === 0 && !found;
  showProblem(find('calibrate-problem'), problem);
  find('calibrate-found').hidden = !found;
  if (!found) return;
  const row = (name, key, factor, unit, places) => element('tr', {}, element('th', { scope: 'row' }, name),
    ...['before', 'after'].map((when) => element('td', {}, `${(found[when][key] * factor).toFixed(places)} ${unit}`)));
  find('calibrate-found').replaceChildren(element('caption', {}, `Calibration ${found.calibration}, kept in the robot`),
    element('thead', {}, element('tr', {}, element('td', {}), element('th', { scope: 'col' }, 'before'), element('th', { scope: 'col' }, 'after'))),
    element('tbody', {}, row('Wheel radius', 'wheel_radius', 1000, 'mm', 3), row('Right over left', 'wheel_ratio', 1, '', 5), row('Track', 'track', 1000, 'mm', 2), row('Ends missed by', 'rms', 1000, 'mm', 1)));
}

onChange(follow);
onChange(show, ({ base }) => base?.connected);
find('calibrate-side').addEventListener('change', show);
