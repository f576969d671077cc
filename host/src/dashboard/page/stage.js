// The stage: the photo with everything that lies over it, drawn again where something has changed.

import { withToken } from './api.js';
import { find, shape } from './dom.js';
import { bounds, circlePoints, floorMap, gapBetween, inflated, isBox, outline } from './floor.js';
import { noObstacles } from './boxes.js';
import { liveFrame } from './live.js';
import { things, uncertainty, wayAhead } from './seen.js';
import { changed, onChange, state } from './state.js';

const view = find('view');
/** Smaller obstacles bear no number unless it matters, pixels on the screen. */
const LEAST_NAMED = 15;
const CORNERS = ['lower left', 'lower right', 'upper right', 'upper left'];

let map = null;
/** Corners under way, until they are let go. */
let corners = null;
let trail = { run: -1, points: [] };
let unit = 1;

const points = (list) => list.map(([x, y]) => `${x.toFixed(2)},${y.toFixed(2)}`).join(' ');
const polygon = (floor, attributes) => shape('polygon', { points: points(floor.map(map.toPicture)), ...attributes });
const line = (floor, attributes) => shape('polyline', { points: points(floor.map(map.toPicture)), ...attributes });

/** From floor to picture and back, as drawn; null where nothing is. */
export const currentMap = () => map;

/** Shows the corners where they are dragged to; null shows where they were put. */
export function showCorners(places) {
  corners = places;
  changed();
}

export function currentCorners() {
  return corners ?? state.corners ?? state.detection?.corners_px ?? null;
}

/** The picture that is shown, and where the arena's corners are in it: the camera's newest, or the photo. */
function shownPicture() {
  const { photo } = state;
  return liveFrame() ?? (photo && { width: photo.width, height: photo.height, corners: currentCorners() });
}

/** What a camera tells while it watches a drive. */
const watchView = () => (state.step === 'drive' && state.drive?.active ? state.drive.view : null);

/** How seen.js draws on the floor, in whose frame the robot and its camera know nothing of a map's. */
const onFloor = {
  polygon: (floor, attributes) => polygon(floor.map(addOrigin), attributes),
  line: (floor, attributes) => line(floor.map(addOrigin), attributes),
  toPicture: (at) => map.toPicture(addOrigin(at)),
};

/** The part of the picture that is shown: all of it, or where the arena is. */
function frame(shown) {
  const all = shown ? [0, 0, shown.width, shown.height] : null;
  if (all && (state.step === 'photo' || !shown.corners)) return all;
  const [xs, ys] = [0, 1].map((axis) => map.corners.map((corner) => corner[axis]));
  const pad = 0.06 * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
  const box = [Math.min(...xs) - pad, Math.min(...ys) - pad, Math.max(...xs) + pad, Math.max(...ys) + pad];
  if (!all) return box;
  return [Math.max(box[0], 0), Math.max(box[1], 0), Math.min(box[2], all[2]), Math.min(box[3], all[3])];
}

/** Where the robot will be at the moment that is looked at. */
function ghost() {
  const poses = state.plan?.preview;
  if (state.step !== 'plan' || state.preview === null || !poses) return [];
  const pose = (poses.find(([time]) => time >= state.preview) ?? poses.at(-1))?.slice(1);
  if (!pose) return [];
  return [polygon(circlePoints(pose, state.scene.robot_radius || 0.05), { class: 'ghost', id: 'ghost' }), nose(pose)];
}

/** All that the drawing depends on. */
function shownState() {
  const { step, photo, revision, arena, scene, selected, adding, plan, planProblem, start, goal: end, run } = state;
  const { width, height } = view.getBoundingClientRect();
  const driving = ['drive', 'base'].includes(step) ? [trail.points.length, trail.points.at(-1), state.base?.pose, state.drive?.reference, run?.report !== null] : null;
  const { draft, reading, past, showsGrid, lit } = state;
  const live = liveFrame();
  return [live?.url, live?.corners, watchView(), draft, reading, state.margins, plan?.tree, past?.name, showsGrid, lit, plan?.mini_matrix, step, photo, revision.photo, arena, scene?.obstacles, scene?.arena, scene?.origin, currentCorners(), selected, adding,
    plan?.waypoints, plan?.margin, state.preview, planProblem?.gap, start, end, driving, width, height];
}

function draw() {
  const showsAnything = Boolean(state.photo || state.scene || (state.step === 'drive' && state.past));
  find('welcome').hidden = showsAnything;
  view.classList.toggle('idle', !showsAnything);
  if (state.step === 'drive' && state.past) return drawPast();
  if (!showsAnything) return view.replaceChildren();
  const arena = state.scene?.arena ?? state.arena ?? { width: 1, height: 1 };
  const picture = shownPicture();
  map = picture?.corners || !picture ? floorMap(arena, picture?.corners ?? null, state.scene?.origin) : null;
  const [x0, y0, x1, y1] = map ? frame(picture) : [0, 0, picture.width, picture.height];
  view.setAttribute('viewBox', `${x0} ${y0} ${x1 - x0} ${y1 - y0}`);
  const room = view.getBoundingClientRect();
  unit = 1 / Math.max(Math.min((room.width - 28) / (x1 - x0), (room.height - 28) / (y1 - y0)), 1e-3);
  const focused = document.activeElement?.dataset?.key;
  view.replaceChildren(...layers(picture).filter(Boolean));
  if (focused) view.querySelector(`[data-key="${focused}"]`)?.focus({ preventScroll: true });
}

function layers(seen) {
  const ground = seen
    ? picture(seen)
    : polygon(outline([0, 0, state.scene.arena.width, state.scene.arena.height]).map(addOrigin), { class: 'plain-floor', 'data-key': 'floor' });
  if (!map) return [ground];
  const floor = seen ? shape('polygon', { points: points(map.corners), class: 'floor-edge' }) : null;
  if (state.step === 'photo') return [ground, floor, ...ignored(), ...draft(), ...(state.photo && currentCorners() ? cornerHandles() : []), ...magnifier()];
  if (!state.scene) return [ground, floor];
  return [ground, floor, ...grown(), ...areas(), ...tree(), ...ignored(), ...erased(), ...uncertain(), ...obstacles(), ...gap(), ...way(), ...goal(), ...reference(), ...robot(), ...tags(), ...ghost(), ...boxHandles(), ...draft()];
}

const addOrigin = ([x, y]) => [x + (state.scene.origin?.[0] ?? 0), y + (state.scene.origin?.[1] ?? 0)];

let shown = { href: '', node: null };
let live = null;
function picture({ url, width, height }) {
  if (url) {
    live ??= shape('image', { id: 'live', x: -0.5, y: -0.5, preserveAspectRatio: 'none' });
    for (const [name, value] of Object.entries({ href: url, width, height })) live.setAttribute(name, value);
    return live;
  }
  const href = withToken(`/api/photo?revision=${state.revision.photo}`);
  if (shown.href !== href) shown = { href, node: shape('image', { href, x: -0.5, y: -0.5, width, height, preserveAspectRatio: 'none' }) };
  return shown.node;
}

function cornerHandles() {
  return currentCorners().map(([x, y], index) => {
    const reach = 13 * unit;
    return shape('g', { class: 'corner', 'data-corner': index, 'data-key': `corner-${index}`, tabindex: 0, role: 'button', 'aria-label': `Corner ${CORNERS[index]}; arrow keys move it` },
      shape('circle', { class: 'handle', cx: x, cy: y, r: reach }),
      shape('path', { class: 'corner-cross', d: `M${x - reach} ${y}h${2 * reach}M${x} ${y - reach}v${2 * reach}` }));
  });
}

/** By how much obstacles are grown: the robot's radius and the margin of the plan. */
const growth = () => (state.scene.robot_radius ?? 0.075) + (state.plan?.margin ?? 0);

function grown() {
  if (state.step !== 'plan') return [];
  const clip = shape('clipPath', { id: 'floor' }, shape('polygon', { points: points(map.corners) }));
  const square = state.plan?.inflation !== 'disc';
  const around = state.scene.obstacles.map((obstacle) => inflated(obstacle, growth(), square));
  // All lines lie under all areas, so that only the outline of the whole is seen.
  const layer = (kind) => around.map((list) => polygon(list, { class: kind }));
  return [clip, shape('g', { 'clip-path': 'url(#floor)', class: 'zone' }, ...layer('zone-line'), ...layer('grown'))];
}

/** Where the edges of what was recognised may still lie: hatched. */
function uncertain() {
  if (state.step !== 'boxes') return [];
  const side = 7 * unit;
  const hatch = shape('pattern', { id: 'hatch', patternUnits: 'userSpaceOnUse', width: side, height: side, patternTransform: 'rotate(45)' },
    shape('rect', { class: 'hatch-line', width: side / 2.4, height: side }));
  const bands = state.scene.obstacles.flatMap((obstacle, index) => {
    const margin = state.margins[index];
    if (!(Math.max(...[margin].flat()) > 0)) return [];
    const outer = isBox(obstacle) ? outline(obstacle.map((edge, i) => edge + (i < 2 ? -1 : 1) * margin[i])) : inflated(obstacle, margin, false);
    const ring = (list) => `M${points(list.map(map.toPicture))}Z`;
    return [shape('path', { class: 'uncertain', 'fill-rule': 'evenodd', d: ring(outer) + ring(outline(obstacle)) })];
  });
  return [hatch, ...bands];
}

/** Where tags were read: the arena's corners, the robot, the goal. */
function tags() {
  const { reading, detection, step, scene } = state;
  if (step !== 'boxes' || !detection) return [];
  const corners = reading.tags && !state.corners ? map.corners.map((at, index) => [at, `tag ${index}`]) : [];
  const of = (id, place) => (id !== null && place ? [[map.toPicture(place), `tag ${id}`]] : []);
  return [...corners, ...of(reading.robot_tag, detection.robot), ...of(reading.goal_tag, scene.goal)].flatMap(([[x, y], name]) => [
    shape('rect', { class: 'tag-mark', x: x - 6 * unit, y: y - 6 * unit, width: 12 * unit, height: 12 * unit }),
    shape('text', { class: 'tag', x, y: y + 17 * unit, 'font-size': 12 * unit }, name)]);
}

/** The tree of global paths. */
function tree() {
  if (state.step !== 'plan') return [];
  return (state.plan?.tree ?? []).map(([x0, y0, x1, y1]) => line([[x0, y0], [x1, y1]], { class: 'branch' }));
}

/** Where the plan wants the robot at this moment of the drive. */
function reference() {
  const at = state.step === 'drive' && state.drive?.active ? state.drive.reference : null;
  if (!at) return [];
  return [polygon(circlePoints(addOrigin(at), state.scene.robot_radius || 0.05), { class: 'reference', id: 'reference' })];
}

function obstacles() {
  const watched = watchView();
  if (watched) return things(watched, onFloor);
  const blocking = state.planProblem?.gap?.between ?? [];
  return state.scene.obstacles.map((obstacle, index) => {
    const floor = outline(obstacle);
    const editable = state.step === 'boxes';
    const picked = editable && state.selected === index;
    const kind = `obstacle${picked ? ' picked' : ''}${blocking.includes(index) ? ' blocking' : ''}${editable ? ' grab' : ''}`;
    const [x, y] = map.toPicture([(bounds(obstacle)[0] + bounds(obstacle)[2]) / 2, (bounds(obstacle)[1] + bounds(obstacle)[3]) / 2]);
    const access = editable
      ? { 'data-box': index, 'data-key': `box-${index}`, tabindex: 0, role: 'button', 'aria-pressed': picked, 'aria-label': `Obstacle ${index + 1}; arrow keys move it, Delete erases it` }
      : {};
    const [low, high] = [bounds(obstacle).slice(0, 2), bounds(obstacle).slice(2)].map(map.toPicture);
    const hasRoom = Math.min(Math.abs(high[0] - low[0]), Math.abs(high[1] - low[1])) > LEAST_NAMED * unit;
    const isNamed = blocking.includes(index) || (editable && (picked || hasRoom));
    return shape('g', access, polygon(floor, { class: 'halo' }), polygon(floor, { class: kind, 'data-obstacle': index }),
      isNamed ? shape('text', { class: 'tag', x, y, 'font-size': 15 * unit }, `${index + 1}`) : null);
  });
}

/** Edges and corners of the selected box, to be dragged. */
function boxHandles() {
  const box = state.scene.obstacles[state.selected];
  if (state.step !== 'boxes' || !box) return [];
  if (!isBox(box)) {
    const rim = box.circle && [box.circle[0] + box.circle[2], box.circle[1]];
    return (box.polygon ?? [rim]).map((at, index) => {
      const [cx, cy] = map.toPicture(at);
      const name = box.polygon ? 'vertex' : 'rim';
      const label = box.polygon ? `Corner ${index + 1}; arrow keys move it` : 'Rim; arrow keys make the disc larger and smaller';
      return shape('g', { [`data-${name}`]: index, 'data-key': `${name}-${index}`, tabindex: 0, role: 'button', 'aria-label': label },
        shape('circle', { class: 'handle', cx, cy, r: 7 * unit }));
    });
  }
  const [x0, y0, x1, y1] = box;
  const edges = [
    ['0', [x0, y0], [x0, y1], 'ew'], ['2', [x1, y0], [x1, y1], 'ew'], ['1', [x0, y0], [x1, y0], 'ns'], ['3', [x0, y1], [x1, y1], 'ns'],
  ].map(([sides, a, b, cursor]) => line([a, b], { class: `edge ${cursor}`, 'data-sides': sides }));
  const knobs = [['01', [x0, y0]], ['21', [x1, y0]], ['23', [x1, y1]], ['03', [x0, y1]]].map(([sides, at]) => {
    const [cx, cy] = map.toPicture(at);
    return shape('circle', { class: 'handle both', cx, cy, r: 6 * unit, 'data-sides': sides });
  });
  return [...edges, ...knobs];
}

/** What is being drawn. */
function draft() {
  const drawn = state.draft;
  if (drawn.circle) return [polygon(circlePoints(drawn.circle, drawn.circle[2]), { class: 'draft' })];
  if (!drawn.length) return [];
  const knobs = drawn.map(map.toPicture).map(([cx, cy], index) => shape('circle', { class: `draft-knob${index ? '' : ' first'}`, cx, cy, r: (index ? 4 : 7) * unit }));
  return [line(drawn, { class: 'draft' }), ...knobs];
}

/** Places in which nothing is an obstacle. */
function ignored() {
  if (!state.photo || !['photo', 'boxes'].includes(state.step)) return [];
  return state.reading.ignore.map((disc) => polygon(circlePoints(disc, disc[2]), { class: 'ignored' }));
}

/** What was recognised and is no obstacle. */
function erased() {
  if (state.step !== 'boxes') return [];
  return noObstacles().map(([obstacle]) => polygon(outline(obstacle), { class: 'no-obstacle' }));
}

/** The areas of the mini-matrix, whose first row is the uppermost. */
function areas() {
  const { grid_lines: lines, mini_matrix: matrix } = state.plan ?? {};
  if (state.step !== 'plan' || !state.showsGrid || !lines || !matrix) return [];
  const { xs, ys } = lines;
  return matrix.flatMap((row, i) => row.map((cell, j) => {
    const [low, high] = [ys[ys.length - 2 - i], ys[ys.length - 1 - i]];
    const name = `${i},${j}`;
    return polygon(outline([xs[j], low, xs[j + 1], high]), { class: `area a${cell}${state.lit === name ? ' lit' : ''}`, 'data-area': name });
  }));
}

/** How much larger the magnifier shows the photo, and its radius on the screen, pixels. */
const [MAGNIFIED, LENS] = [4, 74];

/** The photo around a corner that is dragged, away from the pointer. */
function magnifier() {
  if (!corners || corners.dragged === undefined || !state.photo) return [];
  const [x, y] = corners[corners.dragged];
  const { width, height } = state.photo;
  const [r, away] = [LENS * unit, LENS * 1.5 * unit];
  const cx = Math.min(Math.max(x + (x < width / 2 ? away : -away), r), width - r);
  const cy = Math.min(Math.max(y + (y < height / 2 ? away : -away), r), height - r);
  const reach = r / MAGNIFIED;
  const lens = shape('svg', { x: cx - r, y: cy - r, width: 2 * r, height: 2 * r, viewBox: `${x - reach} ${y - reach} ${2 * reach} ${2 * reach}` },
    shape('rect', { x: x - reach, y: y - reach, width: 2 * reach, height: 2 * reach, fill: '#222' }),
    picture(state.photo).cloneNode(), shape('polygon', { points: points(map.corners), class: 'floor-edge' }));
  const clip = shape('clipPath', { id: 'lens-clip' }, shape('circle', { cx, cy, r }));
  return [clip, shape('g', { 'clip-path': 'url(#lens-clip)', class: 'lens', id: 'magnifier' }, lens),
    shape('circle', { class: 'lens-rim', cx, cy, r }),
    shape('path', { class: 'corner-cross', d: `M${cx - r} ${cy}h${2 * r}M${cx} ${cy - r}v${2 * r}` })];
}

/** A drive of earlier: its scene, its path and where the robot was. */
function drawPast() {
  const { scene, waypoints } = state.past.plan;
  map = floorMap(scene.arena, null, scene.origin);
  const [xs, ys] = [0, 1].map((axis) => map.corners.map((corner) => corner[axis]));
  const pad = 0.04 * Math.max(...xs, ...ys);
  const size = [Math.max(...xs) + 2 * pad, Math.max(...ys) + 2 * pad];
  view.setAttribute('viewBox', `${-pad} ${-pad} ${size[0]} ${size[1]}`);
  const [ox, oy] = scene.origin ?? [0, 0];
  const floor = outline([ox, oy, ox + scene.arena.width, oy + scene.arena.height]);
  const driven = state.past.samples.map(({ pose }) => pose);
  const radius = scene.robot_radius || 0.05;
  const end = driven.at(-1);
  view.replaceChildren(polygon(floor, { class: 'plain-floor' }), ...scene.obstacles.map((obstacle) => polygon(outline(obstacle), { class: 'obstacle' })),
    line(waypoints, { class: 'path-under' }), line(waypoints, { class: 'path' }),
    ...(driven.length > 1 ? [line(driven, { class: 'trail' })] : []),
    ...(end ? [polygon(circlePoints(end, radius), { class: 'robot-body live' })] : []));
}

function gap() {
  const narrow = state.planProblem?.gap;
  if (!narrow || state.step === 'boxes') return [];
  const ends = gapBetween(narrow.between, state.scene);
  if (!ends) return [];
  const [a, b] = ends.map(map.toPicture);
  const upright = Math.abs(a[0] - b[0]) < Math.abs(a[1] - b[1]);
  const [x, y] = [(a[0] + b[0]) / 2 + (upright ? 36 * unit : 0), (a[1] + b[1]) / 2 - (upright ? 0 : 14 * unit)];
  return [line(ends, { class: 'gap' }), shape('text', { class: 'tag', x, y, 'font-size': 14 * unit }, `${(narrow.width * 100).toFixed(1)} cm`)];
}

function way() {
  const list = state.plan?.waypoints;
  const driven = trail.points.length > 1 && state.step === 'drive' ? line(trail.points.map(addOrigin), { class: 'trail' }) : null;
  const watched = watchView();
  if (watched) return [...wayAhead(watched, onFloor), driven];
  if (!list) return [driven];
  const old = state.run?.report && state.step === 'drive' ? ' old' : '';
  const stops = list.slice(1, -1).map((at) => {
    const [cx, cy] = map.toPicture(at);
    return shape('circle', { class: 'stop-point', cx, cy, r: 4 * unit });
  });
  return [line(list, { class: 'path-under' }), line(list, { class: `path${old}`, id: 'path' }), ...stops, driven];
}

function goal() {
  if (!state.goal) return [];
  const [x, y, heading] = state.goal;
  const [cx, cy] = map.toPicture([x, y]);
  const editable = state.step === 'plan';
  const access = editable ? { 'data-goal': '', 'data-key': 'goal', tabindex: 0, role: 'button', 'aria-label': 'Goal; arrow keys move it', class: 'grab' } : {};
  const ring = polygon(circlePoints([x, y], state.scene.robot_radius ?? 0.075), { class: 'goal-ring' });
  return [shape('g', access, ring, shape('circle', { class: 'goal-dot', cx, cy, r: 5 * unit }), heading === null ? null : nose([x, y, heading]))];
}

function nose([x, y, heading]) {
  const r = state.scene.robot_radius || 0.05;
  const at = (ahead, left) => [x + r * (ahead * Math.cos(heading) - left * Math.sin(heading)), y + r * (ahead * Math.sin(heading) + left * Math.cos(heading))];
  return line([at(0.05, 0.4), at(0.62, 0), at(0.05, -0.4)], { class: 'robot-nose' });
}

function robot() {
  // The robot knows nothing of a map's frame.
  const live = ['drive', 'base'].includes(state.step) && trail.points.length > 0 && state.base?.pose && [...addOrigin(state.base.pose), state.base.pose[2]];
  const watched = watchView();
  const pose = watched ? [...addOrigin(watched.pose), watched.pose[2]] : live || state.start;
  if (!pose) return [];
  const body = polygon(circlePoints(pose, state.scene.robot_radius || 0.05), { class: `robot-body${live || watched ? ' live' : ''}${watched?.held ? ' waits' : ''}`, id: 'robot' });
  if (state.step !== 'plan') return [body, nose(pose), ...(watched ? uncertainty(watched, onFloor) : [])];
  const [x, y, heading] = pose;
  const reach = Math.max((state.scene.robot_radius ?? 0.075) * 1.9, 0.02);
  const tip = [x + reach * Math.cos(heading), y + reach * Math.sin(heading)];
  const [cx, cy] = map.toPicture(tip);
  return [
    line([[x, y], tip], { class: 'stalk' }),
    shape('g', { 'data-start': '', 'data-key': 'start', tabindex: 0, role: 'button', class: 'grab', 'aria-label': 'Start; arrow keys move it' }, body),
    nose(pose),
    shape('g', { 'data-heading': '', 'data-key': 'heading', tabindex: 0, role: 'button', 'aria-label': 'Heading at the start; left and right arrow keys turn it' }, shape('circle', { class: 'handle', cx, cy, r: 7 * unit })),
  ];
}

/** Takes in where the robot is now. */
export function followRobot() {
  const { run, drive, base } = state;
  if (!drive) return;
  if (drive.active && trail.run !== drive.revision) trail = { run: drive.revision, points: [] };
  // The server knows all of it: for a page that was opened later, and at the end.
  const isNewer = trail.run !== run?.revision || run.trail.length > trail.points.length;
  if (run?.revision === drive.revision && isNewer) trail = { run: run.revision, points: [...run.trail] };
  // Before it has the plan, the robot does not know where it stands.
  if (!drive.active || !['driving', 'paused'].includes(base?.state)) return;
  const [x, y] = base.pose;
  const last = trail.points.at(-1);
  if (!last || Math.hypot(last[0] - x, last[1] - y) > 0.002) trail.points.push([x, y]);
}

onChange(draw, shownState);
new ResizeObserver(() => changed()).observe(view);
