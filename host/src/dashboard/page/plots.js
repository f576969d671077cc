// How a drive went over time: speeds of the wheels, and how far the robot was beside its path.

import { element, shape } from './dom.js';

/** Samples { t, pose, wheels } from the lines of run.jsonl. */
export const readRun = (text) => text.split('\n').filter(Boolean).map((line) => JSON.parse(line));

/** How far a point is from a path, metres. */
export function beside([x, y], path) {
  let least = Infinity;
  for (let i = 0; i + 1 < path.length; i += 1) {
    const [[ax, ay], [bx, by]] = [path[i], path[i + 1]];
    const [dx, dy] = [bx - ax, by - ay];
    const length = dx * dx + dy * dy;
    const share = length > 0 ? Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / length, 0), 1) : 0;
    least = Math.min(least, Math.hypot(x - ax - share * dx, y - ay - share * dy));
  }
  return Number.isFinite(least) ? least : 0;
}

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [340, 96, 34, 16];
/** More points than pixels show nothing more. */
const MOST_POINTS = 300;

/** A round number at or above. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= value * 0.999);
}

function plot(title, unit, samples, series, least) {
  const every = Math.max(Math.ceil(samples.length / MOST_POINTS), 1);
  const shown = samples.filter((_, i) => i % every === 0 || i === samples.length - 1);
  const most = roundUp(Math.max(least, ...shown.flatMap((sample) => series.map(({ of }) => Math.abs(of(sample))))));
  const signed = shown.some((sample) => series.some(({ of }) => of(sample) < -0.02 * most));
  const [low, high] = [signed ? -most : 0, most];
  const end = shown.at(-1)?.t || 1;
  const x = (t) => LEFT + (t / end) * (WIDTH - LEFT - 6);
  const y = (value) => 6 + ((high - value) / (high - low)) * (HEIGHT - BOTTOM - 6);
  const lines = series.map(({ name, of, kind }) => shape('polyline', { class: `series ${kind}`, points: shown.map((sample) => `${x(sample.t).toFixed(1)},${y(of(sample)).toFixed(1)}`).join(' ') }, shape('title', {}, name)));
  const ticks = (signed ? [low, 0, high] : [0, high]).flatMap((value) => [
    shape('line', { class: 'tick', x1: LEFT, x2: WIDTH - 6, y1: y(value), y2: y(value) }),
    shape('text', { x: LEFT - 5, y: y(value) + 3.5, 'text-anchor': 'end' }, String(Number(value.toPrecision(2)))),
  ]);
  const times = [0, end].map((t) => shape('text', { x: x(t), y: HEIGHT - 3, 'text-anchor': t ? 'end' : 'start' }, `${t.toFixed(t ? 1 : 0)} s`));
  const key = series.length > 1 ? series.flatMap(({ name, kind }) => [element('i', { class: kind }), ` ${name} `]) : [];
  return element('figure', { class: 'plot' }, element('figcaption', {}, `${title}, ${unit} `, ...key),
    shape('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': `${title} over time, at most ${most} ${unit}` }, ...ticks, ...times, ...lines));
}

/** Both plots of a drive along `path`. */
export function plots(samples, path) {
  if (samples.length < 2) return element('div', { class: 'plots' });
  return element('div', { class: 'plots' },
    plot('Wheels', 'rad/s', samples, [{ name: 'left', kind: 'one', of: ({ wheels }) => wheels[0] }, { name: 'right', kind: 'two', of: ({ wheels }) => wheels[1] }], 0.5),
    plot('Beside the path', 'mm', samples, [{ name: 'beside', kind: 'one', of: ({ pose }) => 1000 * beside(pose, path) }], 1));
}
