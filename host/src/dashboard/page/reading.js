// How the photo is read: tags, the camera's file, and places where nothing is an obstacle.

import { element, fill, find } from './dom.js';
import { attempt, recogniseHere } from './actions.js';
import { centimetres } from './floor.js';
import { changed, onChange, state } from './state.js';

const number = (name) => (Number.isNaN(find(name).valueAsNumber) ? null : find(name).valueAsNumber);

find('reading').addEventListener('submit', (event) => event.preventDefault());
find('reading').addEventListener('change', (event) => {
  if (event.target.type === 'file') return;
  use({ ...state.reading, tags: find('tags').value || null, robot_tag: number('robot-tag'), goal_tag: number('goal-tag') });
});

/** Reads the photo in this way from now on, unless the program knows no such way. */
async function use(reading) {
  const before = state.reading;
  state.reading = reading;
  changed();
  if (!state.photo || !state.arena || await recogniseHere()) return;
  if (state.problem.photo?.code === 'http.request') state.reading = before;
  changed();
}

find('camera-file').addEventListener('change', (event) => {
  const [file] = event.target.files;
  event.target.value = '';
  if (!file) return;
  attempt('photo', async () => {
    const { main } = JSON.parse(await file.text());
    if (!main) throw { message: 'this is no camera file', help: 'wmr calibrate camera writes one' };
    return { main };
  }).then((camera) => camera && use({ ...state.reading, camera }));
});
find('camera-forget').addEventListener('click', () => {
  use({ ...state.reading, camera: null });
});
find('camera-pick').addEventListener('click', () => find('camera-file').click());
find('ignore-place').addEventListener('click', () => {
  state.adding = state.adding === 'ignore' ? null : 'ignore';
  changed();
});

/** One more place in which nothing is an obstacle. */
export function ignore(disc) {
  use({ ...state.reading, ignore: [...state.reading.ignore, disc] });
}

onChange(() => {
  const { reading, adding, photo, detection } = state;
  fill(find('tags'), reading.tags ?? '');
  fill(find('robot-tag'), String(reading.robot_tag ?? ''));
  fill(find('goal-tag'), String(reading.goal_tag ?? ''));
  const size = reading.camera?.main.image_size;
  find('camera-note').textContent = size ? `A camera of ${size[0]} × ${size[1]} pixels is known.` : 'Without a camera file boxes are taken as flat.';
  find('camera-forget').hidden = !size;
  find('ignore-place').setAttribute('aria-pressed', String(adding === 'ignore'));
  find('ignore-place').disabled = !photo || !detection;
  find('ignored').replaceChildren(...reading.ignore.map(([x, y, radius], index) => {
    const button = element('button', { type: 'button', class: 'quiet' }, 'Look there again');
    button.addEventListener('click', () => {
      use({ ...state.reading, ignore: reading.ignore.filter((_, i) => i !== index) });
    });
    return element('li', {}, `${centimetres(2 * radius)} cm at ${x.toFixed(2)}, ${y.toFixed(2)} m`, button);
  }));
}, ({ reading, adding, photo, detection }) => [reading, adding, Boolean(photo), Boolean(detection)]);
