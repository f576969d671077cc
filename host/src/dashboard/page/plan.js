// Step 3: start, goal and the way between them; or why there is none.

import { element, figures, fill, find, showProblem } from './dom.js';
import { drive, replan } from './actions.js';
import { centimetres, degrees, radians, round } from './floor.js';
import { changed, onChange, state } from './state.js';

const ENDS = { start: ['start-x', 'start-y', 'start-h'], goal: ['goal-x', 'goal-y', 'goal-h'] };

for (const name of ['ends', 'how']) find(name).addEventListener('submit', (event) => event.preventDefault());

find('ends').addEventListener('change', (event) => {
  const [end, names] = Object.entries(ENDS).find(([, own]) => own.includes(event.target.id));
  const [x, y, heading] = names.map((name) => find(name).valueAsNumber);
  // Half a place is none yet.
  if (Number.isNaN(x) || Number.isNaN(y)) return;
  state[end] = [x, y, Number.isNaN(heading) ? (end === 'goal' ? null : 0) : radians(heading)];
  changed();
  replan();
});

find('how').addEventListener('change', () => {
  const margin = find('margin').valueAsNumber;
  state.planner = find('planner').value;
  state.cost = find('cost').value;
  state.margin = Number.isNaN(margin) ? null : margin / 1000;
  changed();
  replan();
});

find('drive-now').addEventListener('click', drive);

find('preview').addEventListener('input', (event) => {
  state.preview = event.target.valueAsNumber;
  changed();
});

/** What would have to move, if a gap is too narrow. */
function advice(problem) {
  const gap = problem?.gap;
  if (!gap || gap.need <= gap.width) return [];
  const names = gap.between.map((index) => (index === null ? 'the border' : `obstacle ${index + 1}`));
  const short = Math.ceil((gap.need - gap.width) * 1000 - 1e-6) / 10;
  return [element('p', {}, `Move ${names[0] === 'the border' ? names[1] : names[0]} ${short.toFixed(1)} cm away from ${names[0] === 'the border' ? names[0] : names[1]} and it fits.`)];
}

onChange(() => {
  for (const [end, names] of Object.entries(ENDS)) {
    const place = state[end];
    const texts = place ? [round(place[0]), round(place[1]), place[2] === null ? '' : round(degrees(place[2]), 1)] : ['', '', ''];
    names.forEach((name, index) => fill(find(name), String(texts[index])));
  }
  fill(find('planner'), state.planner);
  fill(find('cost'), state.cost);
  find('cost').disabled = state.planner !== 'exact';
  const { plan } = state;
  figures(find('figures'), plan ? [
    ['Length', plan.length.toFixed(2), 'm'], ['Time', plan.duration.toFixed(1), 's'], ['Legs', String(plan.legs.length)],
    ['To obstacles', centimetres(plan.clearance - plan.scene.robot_radius), 'cm'], ['Margin kept', (plan.margin * 1000).toFixed(0), 'mm'],
  ] : []);
  find('preview-field').hidden = !plan;
  if (plan) {
    find('preview').max = plan.duration;
    find('preview-time').textContent = `${(state.preview ?? 0).toFixed(1)} s`;
  }
  showProblem(find('plan-problem'), state.planProblem ?? state.problem.plan, ...advice(state.planProblem));
  find('drive-now').disabled = !plan || state.planning || !state.online || !state.base?.connected || Boolean(state.drive?.active);
}, ({ start, goal, planner, cost, plan, planning, preview, planProblem, online, base, drive: status }) =>
  [planning, start, goal, planner, cost, plan, preview, planProblem, online, base?.connected, status?.active]);
