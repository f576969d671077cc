// Step 1: the photo, the arena's size and corners.

import { find, fill, sentence, showProblem } from './dom.js';
import { placeCorners, recognise, useCorners, useLiveFrame, usePhoto, useSample } from './actions.js';
import { openCamera } from './camera.js';
import { onChange, state } from './state.js';

const [width, height, radiusField] = ['width', 'height', 'radius'].map(find);
const REMEMBERED = 'wmr.size';

for (const button of document.querySelectorAll('[data-pick]')) button.addEventListener('click', () => find('file').click());
find('try-sample').addEventListener('click', useSample);
find('use-sample').addEventListener('click', useSample);
find('use-live').addEventListener('click', useLiveFrame);
find('use-camera').addEventListener('click', () => openCamera(usePhoto));
find('corners-auto').addEventListener('click', () => useCorners(null));
find('corners-place').addEventListener('click', placeCorners);
find('file').addEventListener('change', (event) => {
  const [file] = event.target.files;
  if (file) usePhoto(file);
  event.target.value = '';
});

const stage = find('stage');
for (const name of ['dragover', 'dragleave', 'drop']) {
  document.addEventListener(name, (event) => {
    if (![...(event.dataTransfer?.types ?? [])].includes('Files')) return;
    event.preventDefault();
    stage.classList.toggle('dropping', name === 'dragover');
    const [file] = name === 'drop' ? event.dataTransfer.files : [];
    if (file) usePhoto(file);
  });
}

const CORNERS = {
  found: 'The corners were found by themselves. Drag one to where the floor really ends.',
  unknown: 'The floor\'s corners are found by themselves where its border shows. Else put them there by hand.',
};

function takeSize() {
  if (!find('size').checkValidity()) return false;
  state.arena = { width: width.valueAsNumber, height: height.valueAsNumber };
  state.radius = radiusField.valueAsNumber / 100;
  localStorage.setItem(REMEMBERED, JSON.stringify(state.arena));
  return true;
}

find('size').addEventListener('submit', (event) => {
  event.preventDefault();
  if (takeSize()) recognise();
});
find('size').addEventListener('input', takeSize);

if (!state.arena) {
  try {
    state.arena = JSON.parse(localStorage.getItem(REMEMBERED));
  } catch {
    state.arena = null;
  }
}

onChange(() => {
  if (state.arena) {
    fill(width, String(state.arena.width));
    fill(height, String(state.arena.height));
  }
  fill(radiusField, String(Number((state.radius * 100).toFixed(2))));
  const note = state.photo?.note;
  find('photo-note').hidden = !note;
  if (note) find('photo-note').textContent = `${sentence(note.message)} ${sentence(note.help)}`;
  find('recognise').disabled = !state.photo || Boolean(state.working);
  find('recognise').textContent = state.working || 'Recognise';
  find('corners-tools').hidden = !state.photo;
  find('corners-note').textContent = state.corners ? 'The corners are where you put them.' : CORNERS[state.detection ? 'found' : 'unknown'];
  find('corners-place').hidden = Boolean(state.detection || state.corners);
  find('corners-auto').hidden = !state.corners;
  showProblem(find('photo-problem'), state.problem.photo);
}, ({ arena, radius, photo, working, detection, corners, problem }) =>
  [arena, radius, photo, working, Boolean(detection), corners, problem.photo]);
