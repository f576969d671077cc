// The paper's steps from the photo to the path, one picture with a sentence each; and the mini-matrix, whose
// cells and the areas that they stand for light each other.

import { post, withToken } from './api.js';
import { element, find } from './dom.js';
import { attempt } from './actions.js';
import { changed, onChange, state } from './state.js';

const dialog = find('steps-dialog');
let steps = [];
let at = 0;

async function open() {
  const done = await attempt(state.step, async () => {
    ({ steps } = await post('steps'));
    return steps.length > 0;
  });
  if (!done) return;
  at = Math.min(at, steps.length - 1);
  find('steps-list').replaceChildren(...steps.map(({ title }, index) => {
    const button = element('button', { type: 'button' }, element('span', {}, String(index + 1)), title);
    button.addEventListener('click', () => show(index));
    return element('li', {}, button);
  }));
  // Not modal: STOP stays in reach.
  dialog.show();
  show(at);
  find('steps-next').focus();
}

function show(index) {
  at = Math.min(Math.max(index, 0), steps.length - 1);
  const { name, title, text } = steps[at];
  find('steps-title').textContent = `${at + 1}. ${title}`;
  find('steps-text').textContent = text;
  const picture = find('steps-picture');
  picture.src = withToken(`/api/steps/${name}?${Date.now()}`);
  picture.alt = `${title}: ${text}`;
  find('steps-back').disabled = at === 0;
  find('steps-next').disabled = at === steps.length - 1;
  [...find('steps-list').querySelectorAll('button')].forEach((button, i) => {
    if (i === at) button.setAttribute('aria-current', 'step');
    else button.removeAttribute('aria-current');
  });
  find('steps-list').children[at].scrollIntoView({ block: 'nearest', inline: 'nearest' });
}

for (const button of document.querySelectorAll('[data-steps]')) button.addEventListener('click', open);
find('steps-back').addEventListener('click', () => show(at - 1));
find('steps-next').addEventListener('click', () => show(at + 1));
find('steps-close').addEventListener('click', () => dialog.close());
dialog.addEventListener('keydown', (event) => {
  if (event.key === 'Escape') dialog.close();
  const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (way) show(at + way);
});

// The mini-matrix.

const MEANS = ['closed', 'free', 'start or goal'];

function showMatrix(matrix) {
  find('grid-details').hidden = !matrix;
  if (!matrix) return;
  const rows = matrix.map((row, i) => element('tr', {}, ...row.map((cell, j) =>
    element('td', { class: `m${cell}`, 'data-cell': `${i},${j}`, tabindex: -1, 'aria-label': `row ${i + 1}, column ${j + 1}: ${MEANS[cell]}` }, String(cell)))));
  find('matrix').replaceChildren(element('table', {}, element('tbody', {}, ...rows)));
}

function light(name) {
  if (state.lit === name) return;
  state.lit = name;
  changed();
}

const cellOf = (event) => event.target.closest?.('[data-cell]')?.dataset.cell ?? null;
find('matrix').addEventListener('pointerover', (event) => light(cellOf(event)));
find('matrix').addEventListener('pointerleave', () => light(null));
find('matrix').addEventListener('focusin', (event) => light(cellOf(event)));
find('matrix').addEventListener('focusout', () => light(null));
// A pointer that rests is over another element whenever the stage is drawn again, and means nothing by it.
let pointer = '';
find('view').addEventListener('pointermove', (event) => {
  const place = `${event.clientX},${event.clientY}`;
  if (!state.showsGrid || place === pointer) return;
  pointer = place;
  light(event.target.dataset?.area ?? null);
});
find('view').addEventListener('pointerleave', () => light(null));
find('matrix').addEventListener('keydown', (event) => {
  const way = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
  const cell = cellOf(event)?.split(',').map(Number);
  if (!way || !cell) return;
  event.preventDefault();
  find('matrix').querySelector(`[data-cell="${cell[0] + way[0]},${cell[1] + way[1]}"]`)?.focus();
});
find('grid-details').addEventListener('toggle', () => {
  state.showsGrid = find('grid-details').open;
  changed();
});

onChange(() => {
  showMatrix(state.plan?.mini_matrix);
  // The table is one stop of the Tab key; arrow keys lead on.
  find('matrix').querySelector('[data-cell]')?.setAttribute('tabindex', 0);
}, ({ plan }) => plan?.mini_matrix);
onChange(() => {
  for (const cell of find('matrix').querySelectorAll('.lit')) cell.classList.remove('lit');
  if (state.lit) find('matrix').querySelector(`[data-cell="${state.lit}"]`)?.classList.add('lit');
}, ({ lit, plan }) => [lit, plan?.mini_matrix]);
