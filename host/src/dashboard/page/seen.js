// What the camera tells of a drive that it watches, drawn over the floor: things and where they will be, the way
// still to drive, and where the robot may be.

import { shape } from './dom.js';

/** How many standard deviations hold 95 of 100 places on a plane: the root of -2 ln 0.05. */
const NINETY_FIVE = 2.4477;
const SIDES = 36;

/** The ellipse that holds the robot's middle 95 times in 100, as points on the floor. */
export function ellipse([x, y], [[a, b], [, c]]) {
  const middle = (a + c) / 2;
  const spread = Math.hypot((a - c) / 2, b);
  const [long, short] = [middle + spread, Math.max(middle - spread, 0)].map((variance) => NINETY_FIVE * Math.sqrt(variance));
  const angle = Math.atan2(2 * b, a - c) / 2;
  const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
  return Array.from({ length: SIDES }, (_, i) => {
    const [along, across] = [long * Math.cos((2 * Math.PI * i) / SIDES), short * Math.sin((2 * Math.PI * i) / SIDES)];
    return [x + along * cos - across * sin, y + along * sin + across * cos];
  });
}

/** How far the robot's middle may be from where it is drawn, 95 times in 100, metres. */
export function reach([[a, b], [, c]]) {
  return NINETY_FIVE * Math.sqrt((a + c) / 2 + Math.hypot((a - c) / 2, b));
}

export const moves = ({ predicted }) => predicted.length > 1;

/** Where things stand, and where those that move will be; `polygon` and `line` draw what lies on the floor. */
export function things(view, { polygon, line }) {
  return view.things.flatMap((thing) => {
    const outline = [polygon(thing.outline, { class: 'halo' }), polygon(thing.outline, { class: `obstacle${moves(thing) ? ' mover' : ''}`, 'data-thing': '' })];
    if (!moves(thing)) return outline;
    const [from, to] = [thing.predicted[0], thing.predicted.at(-1)];
    const later = thing.outline.map(([x, y]) => [x + to[0] - from[0], y + to[1] - from[1]]);
    return [polygon(later, { class: 'later' }), ...outline, line(thing.predicted, { class: 'predicted' })];
  });
}

/** The way that is still to be driven. */
export function wayAhead(view, { line }) {
  if (view.way.length < 2) return [];
  return [line(view.way, { class: 'path-under' }), line(view.way, { class: 'path', id: 'path' })];
}

/** Where the robot's middle may be. */
export function uncertainty(view, { polygon, toPicture }) {
  const [cx, cy] = toPicture(view.pose);
  return [polygon(ellipse(view.pose, view.covariance), { class: 'ellipse', id: 'pose-ellipse' }), shape('circle', { class: 'pose-dot', cx, cy, r: 0.1 })];
}
