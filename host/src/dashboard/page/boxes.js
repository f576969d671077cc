// Step 2: what was recognised, and its correction.

import { element, fill, find, showProblem } from './dom.js';
import { editScene, erase, replan, undoEdit } from './actions.js';
import { bounds, centimetres, isBox, noMargin, round } from './floor.js';
import { changed, onChange, state } from './state.js';

const SIDES = ['box-x0', 'box-y0', 'box-x1', 'box-y1'];

find('add-box').addEventListener('click', () => {
  state.adding = !state.adding;
  state.selected = null;
  changed();
});
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

function kind(obstacle) {
  if (isBox(obstacle)) return '';
  return obstacle.circle ? ' round' : ` ${obstacle.polygon.length} corners`;
}

onChange(() => {
  const { scene, detection } = state;
  const list = scene?.obstacles ?? [];
  const seen = list.length === 1 ? '1 obstacle' : `${list.length} obstacles`;
  const robot = detection ? (detection.robot ? 'and the robot' : 'and no robot') : '';
  find('seen').textContent = scene
    ? `${seen} ${robot}. Do the outlines lie over the boxes? Drag edges, erase what is none, add what is missing.`
    : 'Nothing yet: take a photo first.';
  find('warnings').replaceChildren(...(detection?.warnings ?? []).map((text) => element('li', {}, text)));
  find('boxes').replaceChildren(...list.map((obstacle, index) => {
    const [x0, y0, x1, y1] = bounds(obstacle);
    const button = element('button', { type: 'button', 'aria-pressed': String(state.selected === index) },
      element('b', {}, String(index + 1)), `${centimetres(x1 - x0)} × ${centimetres(y1 - y0)} cm${kind(obstacle)}`,
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
  find('add-box').setAttribute('aria-pressed', String(state.adding));
  find('add-box').disabled = !scene;
  find('erase-box').disabled = !box;
  find('undo').disabled = state.undo.length === 0;
  find('to-plan').disabled = !scene;
  showProblem(find('boxes-problem'), state.problem.boxes);
}, ({ scene, detection, selected, adding, undo, problem }) =>
  [scene?.obstacles, detection?.robot, detection?.warnings, selected, adding, undo.length, problem.boxes]);
