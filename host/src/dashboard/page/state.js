// What the page shows: one object, and who wants to know when it changes. Metres and radians.

export const state = {
  step: 'photo',
  /** From the server: photo {width, height}, detection, scene, plan, run, base, drive. */
  photo: null,
  arena: null,
  radius: 0.075,
  corners: null,
  detection: null,
  scene: null,
  margins: [],
  plan: null,
  planProblem: null,
  /** Whether a newer plan is on its way: what is shown is not driven then. */
  planning: false,
  run: null,
  base: null,
  drive: null,
  /** The camera over the arena, and its newest frame {number, url, width, height} if it is shown. */
  camera: null,
  live: null,
  revision: { photo: -1, scene: -1, plan: -1, run: -1 },
  /** How the photo is read, as POST /api/detect has it. */
  reading: { tags: null, robot_tag: null, goal_tag: null, ignore: [], camera: null },
  /** What goes wrong with the simulated robot. */
  faults: null,
  /** A drive of earlier that is looked at. */
  past: null,
  /** The mini-matrix: whether its areas are shown, and the one that is lit, as "row,column". */
  showsGrid: false,
  lit: null,
  /** What the person wants: [x, y, heading] and [x, y, heading or null]. */
  start: null,
  goal: null,
  planner: 'exact',
  cost: 'length',
  margin: null,
  /** Whether the robot is to drive on when the last page is closed. */
  unattended: false,
  /** The moment of the plan that is looked at, seconds; null for none. */
  preview: null,
  /** What the person is doing. */
  selected: null,
  /** What is being drawn: box, disc, polygon, ignore, thing or null; corners of a polygon that are there already. */
  adding: null,
  draft: [],
  undo: [],
  working: '',
  problem: { photo: null, boxes: null, plan: null, drive: null, base: null },
  online: false,
  heard: performance.now(),
};

const listeners = [];
let due = false;

/** Calls `listener` after a change, at most once a frame; with `on` only if what that gives has changed: what
 * stays as it is must not be made again under the pointer. */
export function onChange(listener, on = null) {
  let last = null;
  listeners.push(() => {
    const now = on && JSON.stringify(on(state));
    if (on && now === last) return;
    last = now;
    listener(state);
  });
}

export function changed() {
  if (due) return;
  due = true;
  requestAnimationFrame(() => {
    due = false;
    for (const listener of listeners) listener();
  });
}
