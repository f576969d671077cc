// What the person does, carried out at the server. Every action leaves the state right and says `changed`.

import { getPhoto, getState, post, sendPhoto } from './api.js';
import { noMargin } from './floor.js';
import { changed, state } from './state.js';

/** Takes over everything that lies on the server's desk. */
export function takeState(document) {
  // An answer that was overtaken by a newer one.
  if (['photo', 'scene', 'plan'].some((name) => document.revision[name] < state.revision[name])) return;
  const sameScene = state.revision.scene === document.revision.scene;
  Object.assign(state, {
    photo: document.photo,
    corners: document.corners_px,
    detection: document.detection,
    reading: document.reading,
    faults: document.faults,
    camera: document.camera,
    scene: document.scene,
    margins: document.scene?.margins ?? document.scene?.obstacles.map(noMargin) ?? [],
    run: document.run,
    base: document.base,
    drive: document.drive,
    radius: document.robot_radius,
    revision: { ...document.revision, run: document.run.revision },
  });
  if (document.arena) state.arena = document.arena;
  const failed = document.plan?.error ?? null;
  state.plan = document.plan && !failed ? document.plan : null;
  state.planProblem = failed;
  if (state.plan) {
    state.planner = state.plan.planner ?? state.planner;
    const legs = state.plan.legs;
    const last = state.plan.scene.goal;
    state.start = state.plan.scene.start ?? legs[0]?.start ?? state.start;
    if (last) state.goal = [last[0], last[1], last[2] ?? null];
  } else if (!sameScene) {
    state.start = document.scene?.start ?? null;
    const goal = document.scene?.goal;
    state.goal = goal ? [goal[0], goal[1], goal[2] ?? null] : null;
  }
  if (!sameScene) {
    state.selected = null;
    state.draft = [];
  }
  changed();
}

/** The photo as it was sent: a program that is started again knows nothing of it. */
let photoBlob = null;

/** Counts what the person changes: an answer that was asked for before a change says nothing about it. */
let edits = 0;

/** Fetches everything again, unless the person changes something meanwhile. */
export async function refresh() {
  const before = edits;
  const document = await getState();
  if (before === edits) takeState(document);
}

async function working(what, where, action) {
  state.working = what;
  state.problem[where] = null;
  changed();
  try {
    return await action();
  } catch (error) {
    if (error.code !== 'http.cancelled') state.problem[where] = error.message ? error : { message: String(error), help: '' };
    return null;
  } finally {
    state.working = '';
    changed();
  }
}

/** Something quick; what goes wrong is said in the panel of that name. */
export async function attempt(where, action) {
  state.problem[where] = null;
  try {
    return await action();
  } catch (error) {
    state.problem[where] = error.message ? { message: error.message, help: error.help ?? '' } : { message: String(error), help: '' };
    return null;
  } finally {
    changed();
  }
}

export async function useSample() {
  const done = await working('Reading the sample …', 'photo', async () => {
    takeState(await post('photo', { sample: 'demo' }));
    photoBlob = await getPhoto();
    state.undo = [];
    return true;
  });
  if (done) await recognise();
}

/** The newest frame of the camera over the arena. */
export async function useLiveFrame() {
  await working('Taking the live frame …', 'photo', async () => {
    const { camera } = state;
    if (!camera.source) await post('camera', { source: camera.sources[0] });
    takeState(await post('photo', { sample: 'camera' }));
    photoBlob = await getPhoto();
    state.undo = [];
  });
}

export async function usePhoto(blob) {
  state.step = 'photo';
  if (blob.name?.endsWith('.json')) return useScene(blob);
  await working('Reading the photo …', 'photo', async () => {
    takeState(await sendPhoto(blob));
    photoBlob = blob;
    state.undo = [];
  });
}

async function useScene(file) {
  await working('Reading the scene …', 'photo', async () => {
    let document = JSON.parse(await file.text());
    if (document.format?.startsWith('wmr-plan')) document = document.scene;
    takeState(await post('scene', document));
    state.undo = [];
    state.step = 'boxes';
  });
  await replan();
}

/** Gives a program that was started again what this page shows. */
export async function restore(corners) {
  const scene = state.scene && { ...state.scene, margins: state.margins, start: state.start ?? undefined, goal: undefined };
  const { start, goal, undo, reading } = state;
  // The program has no plan to drive until this is done.
  state.planning = true;
  await working('', 'photo', async () => {
    if (photoBlob) {
      await sendPhoto(photoBlob);
      if (corners) await post('corners', { corners_px: corners });
      // What was recognised tells what the person has corrected.
      if (scene) await post('detect', { arena: scene.arena, robot_radius: state.radius, reading });
    }
    if (scene) await post('scene', scene);
    await refresh();
  });
  Object.assign(state, { start, goal, undo, planning: false });
  await replan();
}

/** Looks at the photo, in an arena of that size; what was corrected stays so unless it is to be looked at afresh. */
export function recogniseHere(afresh = false) {
  return working('Looking at the photo …', 'photo', async () => {
    // What a person has corrected can be had back.
    if (state.undo.length && state.scene) rememberScene();
    await post('detect', { arena: state.arena, robot_radius: state.radius, reading: state.reading, afresh });
    await refresh();
    return true;
  });
}

export async function recognise() {
  if (await recogniseHere()) {
    state.step = 'boxes';
    changed();
  }
}

export async function useCorners(corners) {
  await working('Looking at the photo …', 'photo', async () => {
    const isSeen = Boolean(state.detection);
    takeState(await post('corners', { corners_px: corners }));
    // All four are put where they are before anybody looks.
    if (!isSeen) return;
    await post('detect', { arena: state.arena, robot_radius: state.radius, reading: state.reading });
    await refresh();
  });
}

/** Puts corners into the photo that can be dragged to where they are. */
export function placeCorners() {
  const { width, height } = state.photo;
  const [left, right, top, bottom] = [0.2 * width, 0.8 * width, 0.2 * height, 0.8 * height];
  return useCorners([[left, bottom], [right, bottom], [right, top], [left, top]]);
}

/** Plans in the scene of an earlier drive, from its start to its goal. */
export async function planAgain(plan) {
  state.past = null;
  await working('', 'drive', async () => {
    takeState(await post('scene', plan.scene));
    state.undo = [];
    state.step = 'plan';
    const { start, goal } = plan.scene;
    state.start = start ?? state.start;
    state.goal = goal ? [goal[0], goal[1], goal[2] ?? null] : null;
  });
  await replan();
}

/** Adds an obstacle, which is selected then. */
export function addObstacle(obstacle, margin = noMargin(obstacle)) {
  const index = state.scene.obstacles.length;
  editScene([...state.scene.obstacles, obstacle], [...state.margins, margin]);
  state.selected = index;
}

/** Takes an obstacle away. */
export function erase(index) {
  if (index === null || !state.scene?.obstacles[index]) return;
  const without = (list) => list.filter((_, i) => i !== index);
  state.selected = null;
  editScene(without(state.scene.obstacles), without(state.margins));
}

/** Changes the obstacles; what was there before can be had back. */
export function editScene(obstacles, margins, keepUndo = true) {
  if (keepUndo) rememberScene();
  state.scene.obstacles = obstacles;
  state.margins = margins;
  sceneEdited();
}

export function rememberScene() {
  state.undo.push(JSON.stringify([state.scene.obstacles, state.margins]));
  if (state.undo.length > 100) state.undo.shift();
}

export function undoEdit() {
  const last = state.undo.pop();
  if (!last) return;
  [state.scene.obstacles, state.margins] = JSON.parse(last);
  state.selected = null;
  sceneEdited();
}

function sceneEdited() {
  changed();
  replan();
}

let underWay = false;
let again = false;
export const isPlanning = () => underWay;
/** How long the last plan took from here and back, milliseconds. */
export const timing = { plan: [] };

/** Plans with what is wanted now; while one plan is under way, only the newest wish counts. */
export async function replan() {
  if (!state.scene) return;
  edits += 1;
  if (underWay) {
    again = true;
    return;
  }
  underWay = true;
  state.planning = true;
  do {
    again = false;
    await planOnce();
  } while (again);
  underWay = false;
  state.planning = false;
  changed();
}

async function planOnce() {
  const scene = { ...state.scene, margins: state.margins };
  delete scene.start;
  delete scene.goal;
  const began = performance.now();
  try {
    if (!state.start || !state.goal) {
      const document = await post('scene', { ...scene, start: state.start ?? undefined });
      state.revision.scene = document.revision.scene;
      state.revision.plan = document.revision.plan;
      state.plan = null;
      state.planProblem = null;
    } else {
      const goal = state.goal[2] === null ? state.goal.slice(0, 2) : state.goal;
      const wish = { scene, start: state.start, goal, planner: state.planner, cost: state.cost };
      if (state.margin !== null) wish.margin = state.margin;
      state.plan = await post('plan', wish);
      Object.assign(state.revision, state.plan.revision);
      state.planProblem = null;
    }
  } catch (error) {
    Object.assign(state.revision, error.revision);
    state.plan = null;
    state.planProblem = error;
  }
  timing.plan.push(performance.now() - began);
  if (timing.plan.length > 200) timing.plan.shift();
  changed();
}

export async function drive() {
  state.step = 'drive';
  state.past = null;
  state.adding = null;
  await working(state.camera?.source ? 'Looking at the floor …' : '', 'drive', () => post('drive', { plan: state.revision.plan, unattended: state.unattended }));
}

export const pause = () => working('', 'drive', () => post('pause'));
export const resume = () => working('', 'drive', () => post('resume'));

/** Stops the robot; tries again and again until the server has heard. */
export async function stop() {
  for (let attempt = 0; attempt < 20; attempt += 1) {
    try {
      await post('stop');
      state.problem.drive = null;
      return changed();
    } catch (error) {
      state.problem.drive = error;
      changed();
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
  }
}
