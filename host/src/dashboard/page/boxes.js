// Step 2: what was recognised, and its correction.

import { element, fill, find, sentence, showProblem } from './dom.js';
import { withToken } from './api.js';
import { addObstacle, editScene, erase, recogniseHere, replan, undoEdit } from './actions.js';
import { bounds, centimetres, isBox, noMargin, round, share } from './floor.js';
import { changed, onChange, state } from './state.js';

/** A margin from which on its hatching is seen, metres. */
const SHOWN_MARGIN = 0.002;
const SIDES = ['box-x0', 'box-y0', 'box-x1', 'box-y1'];

for (const button of document.querySelectorAll('[data-add]')) {
  button.addEventListener('click', () => {
    state.adding = state.adding === button.dataset.add ? null : button.dataset.add;
    state.draft = [];
    state.selected = null;
    changed();
  });
}
find('afresh').addEventListener('click', () => recogniseHere(true));
find('erase-box').addEventListener('click', () => erase(state.selected));
find('undo').addEventListener('click', undoEdit);
find('to-plan').addEventListener('click', () => {
  state.step = 'plan';
  replan();
  changed();
});
find('box-fields').addEventListener('submit', (event) => event.preventDefault());
find('box-fields').addEventListener('change', () => {
  const box = SIDES.map((name) => find(name).valueAsNumber);
  if (box.some(Number.isNaN) || box[0] >= box[2] || box[1] >= box[3]) return changed();
  const replaced = (list, value) => list.map((old, index) => (index === state.selected ? value(old) : old));
  editScene(replaced(state.scene.obstacles, () => box), replaced(state.margins, () => noMargin(box)));
});

/** How large an obstacle is, for people: a turned rectangle by its own sides. */
function sizeOf(obstacle) {
  if (obstacle.circle) return `${centimetres(2 * obstacle.circle[2])} cm round`;
  const corners = obstacle.polygon ?? [];
  const side = (i) => Math.hypot(corners[i][0] - corners[(i + 1) % 4][0], corners[i][1] - corners[(i + 1) % 4][1]);
  if (corners.length === 4) return `${centimetres((side(0) + side(2)) / 2)} × ${centimetres((side(1) + side(3)) / 2)} cm, 4 corners`;
  const [x0, y0, x1, y1] = bounds(obstacle);
  return `${centimetres(x1 - x0)} × ${centimetres(y1 - y0)} cm${isBox(obstacle) ? '' : `, ${corners.length} corners`}`;
}

const numbers = (obstacle) => (isBox(obstacle) ? obstacle : obstacle.circle ?? obstacle.polygon.flat());

/** Whether two outlines are the same numbers, but for the last digits that writing and reading cost; metres. */
function isSame(one, other) {
  const [a, b] = [numbers(one), numbers(other)];
  return isBox(one) === isBox(other) && Boolean(one.circle) === Boolean(other.circle) && a.length === b.length && a.every((value, i) => Math.abs(value - b[i]) < 1e-6);
}

/** What was recognised and is an obstacle no more, with its margin: not what was only moved. */
export function noObstacles() {
  const { scene, detection } = state;
  if (!scene || !detection) return [];
  return detection.obstacles.map((obstacle, index) => [obstacle, detection.margins[index]])
    .filter(([obstacle]) => !scene.obstacles.some((own) => isSame(own, obstacle) || share(bounds(own), bounds(obstacle)) > 0.1));
}

function isDrawn(obstacle) {
  return Boolean(state.detection) && !state.detection.obstacles.some((seen) => isSame(seen, obstacle));
}

onChange(() => {
  const { scene, detection } = state;
  const erased = noObstacles();
  find('erased').hidden = erased.length === 0;
  find('erased').replaceChildren(...erased.map(([obstacle, margin]) => {
    const [x0, y0, x1, y1] = bounds(obstacle);
    const button = element('button', { type: 'button', class: 'quiet' }, 'It is one');
    button.addEventListener('click', () => addObstacle(obstacle, margin));
    return element('li', {}, `No obstacle at ${((x0 + x1) / 2).toFixed(2)}, ${((y0 + y1) / 2).toFixed(2)} m`, button);
  }));
  find('afresh').hidden = erased.length === 0 && !(scene?.obstacles ?? []).some(isDrawn);
  find('save-scene').hidden = !scene;
  find('save-scene').href = withToken('/api/scene');
  const list = scene?.obstacles ?? [];
  const seen = list.length === 1 ? '1 obstacle' : `${list.length} obstacles`;
  const robot = detection ? (detection.robot ? 'and the robot' : 'and no robot') : '';
  const unsure = state.margins.some((margin) => Math.max(...[margin].flat()) > SHOWN_MARGIN);
  const hatched = unsure ? ' Hatched: so far out an edge may still lie.' : '';
  find('seen').textContent = scene
    ? `${seen} ${robot}. Do the outlines lie over the boxes? Drag edges, erase what is none, add what is missing.${hatched}`
    : 'Nothing yet: take a photo first.';
  find('warnings').replaceChildren(...(detection?.warnings ?? []).map((text) => element('li', {}, sentence(text))));
  find('boxes').replaceChildren(...list.map((obstacle, index) => {
    const [x0, y0, x1, y1] = bounds(obstacle);
    const button = element('button', { type: 'button', 'aria-pressed': String(state.selected === index) },
      element('b', {}, String(index + 1)), `${sizeOf(obstacle)}${isDrawn(obstacle) ? ' ✎' : ''}`,
      element('i', {}, `at ${((x0 + x1) / 2).toFixed(2)}, ${((y0 + y1) / 2).toFixed(2)} m`));
    button.addEventListener('click', () => {
      state.selected = state.selected === index ? null : index;
      changed();
    });
    return element('li', {}, button);
  }));
  const box = list[state.selected];
  find('box-fields').hidden = !box || !isBox(box);
  if (box && isBox(box)) SIDES.forEach((name, side) => fill(find(name), String(round(box[side]))));
  for (const button of document.querySelectorAll('[data-add]')) {
    button.setAttribute('aria-pressed', String(state.adding === button.dataset.add));
    button.disabled = !scene;
  }
  find('erase-box').disabled = !box;
  find('erase-box').textContent = box && !isDrawn(box) ? 'Not an obstacle' : 'Erase';
  find('undo').disabled = state.undo.length === 0;
  find('to-plan').disabled = !scene;
  showProblem(find('boxes-problem'), state.problem.boxes);
}, ({ scene, detection, selected, adding, undo, problem }) =>
  [scene?.obstacles, detection?.obstacles, detection?.robot, detection?.warnings, selected, adding, undo.length, problem.boxes]);
