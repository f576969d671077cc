// What the pointer and the arrow keys do on the stage.

import { find } from './dom.js';
import { clamp, moved, noMargin, round } from './floor.js';
import { ignore } from './reading.js';
import { addObstacle, editScene, erase, rememberScene, replan, useCorners } from './actions.js';
import { currentCorners, currentMap, showCorners } from './stage.js';
import { changed, state } from './state.js';
import { setDown } from './watch.js';

const view = find('view');
/** No box is smaller, metres. */
const LEAST_BOX = 0.01;
/** What is dragged less far stays where it is set down, metres. */
const LEAST_ROLL = 0.03;

let drag = null;
/** Corners that are not yet said to the server. */
let places = null;

function pictureAt(event) {
  const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(view.getScreenCTM().inverse());
  return [point.x, point.y];
}

function onFloor(at) {
  const [ox, oy] = state.scene?.origin ?? [0, 0];
  const { width, height } = state.scene?.arena ?? state.arena;
  return [clamp(at[0], ox, ox + width), clamp(at[1], oy, oy + height)].map((value) => round(value, 4));
}

view.addEventListener('pointerdown', (event) => {
  if (event.button !== 0 || !currentMap()) return;
  const target = event.target.closest('[data-corner],[data-sides],[data-vertex],[data-rim],[data-box],[data-start],[data-heading],[data-goal]');
  const begin = begins[state.step];
  drag = begin ? begin(target?.dataset ?? {}, pictureAt(event), currentMap().toFloor(pictureAt(event))) : null;
  if (!drag) return;
  event.preventDefault();
  target?.focus?.({ preventScroll: true });
  view.setPointerCapture(event.pointerId);
});

view.addEventListener('pointermove', (event) => {
  if (!drag) return;
  const at = pictureAt(event);
  drag.move(at, currentMap().toFloor(at));
});

for (const name of ['pointerup', 'pointercancel']) {
  view.addEventListener(name, () => {
    const done = drag;
    drag = null;
    done?.end?.();
  });
}

export const isDragging = () => drag !== null;

const begins = {
  photo: (target, at, floor) => {
    if (state.adding === 'ignore') return beginDisc(floor, (disc) => ignore(disc));
    if (target.corner === undefined) return null;
    const index = Number(target.corner);
    const before = currentCorners().map((corner) => [...corner]);
    const off = [before[index][0] - at[0], before[index][1] - at[1]];
    return {
      move: (now) => moveCorner(before, index, [now[0] + off[0], now[1] + off[1]]),
      end: finishCorners,
    };
  },
  boxes: (target, at, floor) => {
    if (state.adding === 'box') return beginBox(floor);
    if (state.adding === 'disc') return beginDisc(floor, (disc) => addObstacle({ circle: disc }));
    if (state.adding === 'polygon') return addCorner(floor, at);
    if (target.sides !== undefined) return beginSides([...target.sides].map(Number));
    if (target.vertex !== undefined) return beginVertex(Number(target.vertex));
    if (target.rim !== undefined) return beginRim();
    if (target.box === undefined) {
      state.selected = null;
      changed();
      return null;
    }
    return beginMove(Number(target.box), floor);
  },
  drive: (target, at, floor) => {
    if (state.adding !== 'thing') return null;
    const from = onFloor(floor);
    let to = from;
    state.draft = [from];
    changed();
    return {
      move: (now, place) => {
        to = onFloor(place);
        state.draft = [from, to];
        changed();
      },
      end: () => setDown(from, Math.hypot(to[0] - from[0], to[1] - from[1]) > LEAST_ROLL ? to : null),
    };
  },
  plan: (target, at, floor) => {
    if (target.heading !== undefined) return { move: (now, place) => turnStart(place) };
    if (target.start !== undefined) return beginPlace('start', floor);
    if (target.goal !== undefined) return beginPlace('goal', floor);
    if (!state.start) {
      state.start = [...onFloor(floor), 0];
      changed();
      return { move: (now, place) => turnStart(place), end: replan };
    }
    state.goal = [...onFloor(floor), state.goal?.[2] ?? null];
    changed();
    replan();
    return beginPlace('goal', floor);
  },
};

function moveCorner(before, index, place) {
  places = before.map((corner, i) => (i === index ? place : corner));
  places.dragged = index;
  showCorners(places);
}

let cornerTimer = 0;
async function finishCorners() {
  if (!places) return;
  clearTimeout(cornerTimer);
  const done = places;
  await useCorners(done.map((point) => point.map((value) => round(value, 2))));
  if (places !== done) return;
  places = null;
  showCorners(null);
}

function beginPlace(what, floor) {
  const before = [...state[what]];
  return {
    move: (now, place) => {
      const [x, y] = onFloor([before[0] + place[0] - floor[0], before[1] + place[1] - floor[1]]);
      state[what] = [x, y, before[2]];
      changed();
      replan();
    },
  };
}

function turnStart([x, y]) {
  const [dx, dy] = [x - state.start[0], y - state.start[1]];
  if (Math.hypot(dx, dy) < 0.01) return;
  state.start = [state.start[0], state.start[1], round(Math.atan2(dy, dx), 4)];
  changed();
  replan();
}

function replaceBox(index, box) {
  const list = state.scene.obstacles.map((old, i) => (i === index ? box : old));
  // What a person has drawn is where it is.
  const margins = state.margins.map((margin, i) => (i === index ? noMargin(box) : margin));
  editScene(list, margins, false);
}

function beginSides(sides) {
  const index = state.selected;
  rememberScene();
  return {
    move: (now, place) => {
      const box = [...state.scene.obstacles[index]];
      const at = onFloor(place);
      for (const side of sides) {
        const axis = side % 2;
        box[side] = side < 2 ? Math.min(at[axis], box[axis + 2] - LEAST_BOX) : Math.max(at[axis], box[axis] + LEAST_BOX);
      }
      replaceBox(index, box.map((value) => round(value, 4)));
    },
  };
}

function beginVertex(vertex) {
  const index = state.selected;
  rememberScene();
  return {
    move: (now, place) => {
      const box = state.scene.obstacles[index];
      replaceBox(index, { ...box, polygon: box.polygon.map((at, i) => (i === vertex ? onFloor(place) : at)) });
    },
  };
}

function beginRim() {
  const index = state.selected;
  rememberScene();
  return {
    move: (now, place) => {
      const box = state.scene.obstacles[index];
      const [x, y] = box.circle;
      const radius = Math.max(Math.hypot(place[0] - x, place[1] - y), LEAST_BOX);
      replaceBox(index, { ...box, circle: [x, y, round(radius, 4)] });
    },
  };
}

function beginMove(index, floor) {
  state.selected = index;
  changed();
  const before = state.scene.obstacles[index];
  let remembered = false;
  return {
    move: (now, place) => {
      const [dx, dy] = [round(place[0] - floor[0], 4), round(place[1] - floor[1], 4)];
      if (!remembered && Math.hypot(dx, dy) < 0.004) return;
      if (!remembered) rememberScene();
      remembered = true;
      replaceBox(index, moved(before, dx, dy));
    },
  };
}

function beginBox(floor) {
  const from = onFloor(floor);
  const index = state.scene.obstacles.length;
  const add = (to) => {
    const box = [Math.min(from[0], to[0]), Math.min(from[1], to[1]), Math.max(from[0], to[0]), Math.max(from[1], to[1])];
    if (box[2] - box[0] < LEAST_BOX || box[3] - box[1] < LEAST_BOX) return;
    const isNew = state.scene.obstacles.length === index;
    editScene([...state.scene.obstacles.slice(0, index), box], [...state.margins.slice(0, index), noMargin(box)], isNew);
    state.selected = index;
  };
  return {
    move: (now, place) => add(onFloor(place)),
    end: () => {
      state.adding = null;
      changed();
    },
  };
}

/** A disc from its middle to where the pointer is let go. */
function beginDisc(floor, add) {
  const [x, y] = onFloor(floor);
  const radius = (place) => round(Math.max(Math.hypot(place[0] - x, place[1] - y), LEAST_BOX), 4);
  return {
    move: (now, place) => {
      state.draft = { circle: [x, y, radius(place)] };
      changed();
    },
    end: () => {
      const drawn = state.draft.circle;
      state.adding = null;
      state.draft = [];
      changed();
      if (drawn) add(drawn);
    },
  };
}

/** So near to the first corner a click closes a polygon, pixels on the screen. */
const CLOSES = 14;

/** One more corner of a polygon; null, since nothing is dragged. */
function addCorner(floor, at) {
  const [first] = state.draft;
  const scale = view.getScreenCTM().a;
  const [x, y] = first ? currentMap().toPicture(first) : [Infinity, 0];
  if (state.draft.length >= 3 && Math.hypot(at[0] - x, at[1] - y) * scale < CLOSES) return closePolygon();
  state.draft = [...state.draft, onFloor(floor)];
  changed();
  return null;
}

function closePolygon() {
  const corners = state.draft;
  state.adding = null;
  state.draft = [];
  changed();
  if (corners.length >= 3) addObstacle({ polygon: corners });
  return null;
}

addEventListener('keydown', (event) => {
  if (state.adding !== 'polygon' || event.target.closest?.('input,select,dialog')) return;
  if (event.key === 'Enter' && state.draft.length >= 3) {
    event.preventDefault();
    closePolygon();
  } else if (event.key === 'Backspace') {
    event.preventDefault();
    state.draft = state.draft.slice(0, -1);
    changed();
  }
}, { capture: true });

/** What is drawn where somebody has only keys: in the middle of the arena, to be moved and sized from there. */
export function addInTheMiddle(kind) {
  const [ox, oy] = state.scene.origin ?? [0, 0];
  const { width, height } = state.scene.arena;
  const [x, y] = [round(ox + width / 2, 3), round(oy + height / 2, 3)];
  const r = round(Math.min(width, height) / 20, 3);
  const made = {
    box: [x - r, y - r, x + r, y + r].map((value) => round(value, 4)),
    disc: { circle: [x, y, r] },
    polygon: { polygon: [[x - r, y - r], [x + r, y - r], [x, y + r]].map((point) => point.map((value) => round(value, 4))) },
  };
  state.adding = null;
  addObstacle(made[kind]);
}
for (const button of document.querySelectorAll('[data-add]')) {
  button.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' && event.key !== ' ') return;
    event.preventDefault();
    addInTheMiddle(button.dataset.add);
  });
}

/** A corner of a polygon or the rim of a disc by the arrow keys. */
function moveHandle(event, target) {
  const way = ARROWS[event.key];
  if (!way) return;
  event.preventDefault();
  const [dx, dy] = way.map((value) => value * (event.shiftKey ? 0.05 : 0.005));
  const shape = state.scene.obstacles[state.selected];
  rememberScene();
  if (target.rim !== undefined) {
    const [x, y, radius] = shape.circle;
    replaceBox(state.selected, { ...shape, circle: [x, y, round(Math.max(radius + dx + dy, LEAST_BOX), 4)] });
  } else {
    const index = Number(target.vertex);
    replaceBox(state.selected, { ...shape, polygon: shape.polygon.map((at, i) => (i === index ? onFloor([at[0] + dx, at[1] + dy]) : at)) });
  }
}

// The arrow keys.

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

view.addEventListener('keydown', (event) => {
  const target = event.target.closest('[data-key]')?.dataset;
  if (!target || !currentMap()) return;
  if (target.vertex !== undefined || target.rim !== undefined) return moveHandle(event, target);
  if ((event.key === 'Delete' || event.key === 'Backspace') && target.box !== undefined) {
    event.preventDefault();
    return erase(Number(target.box));
  }
  if ((event.key === 'Enter' || event.key === ' ') && target.box !== undefined) {
    event.preventDefault();
    state.selected = Number(target.box);
    return changed();
  }
  const way = ARROWS[event.key];
  if (!way) return;
  event.preventDefault();
  const [dx, dy] = way.map((value) => value * (event.shiftKey ? 0.05 : 0.01));
  if (target.corner !== undefined) {
    const index = Number(target.corner);
    const [x, y] = currentCorners()[index];
    moveCorner(currentCorners(), index, [x + way[0] * (event.shiftKey ? 10 : 1), y - way[1] * (event.shiftKey ? 10 : 1)]);
    clearTimeout(cornerTimer);
    cornerTimer = setTimeout(finishCorners, 600);
  } else if (target.box !== undefined) {
    const index = Number(target.box);
    rememberScene();
    replaceBox(index, moved(state.scene.obstacles[index], dx, dy));
  } else if (target.heading !== undefined) {
    const turned = state.start[2] - way[0] * (event.shiftKey ? 0.26 : 0.0873);
    state.start[2] = round(Math.atan2(Math.sin(turned), Math.cos(turned)), 4);
    changed();
    replan();
  } else {
    const what = target.goal !== undefined ? 'goal' : 'start';
    state[what] = [...onFloor([state[what][0] + dx, state[what][1] + dy]), state[what][2]];
    changed();
    replan();
  }
});
