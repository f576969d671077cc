// What a person corrects by hand, and how the photo is read.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { onPage, the } from './suite.mjs';
import { SAMPLE, clickFloor, dragFloor, onScreen, openSample, planTo, post, shot, state, until } from './browser.mjs';

const COUNT = SAMPLE.obstacles.length;
const count = (page, wanted) => until(page, (number) => !window.wmr.state.working && window.wmr.state.scene?.obstacles.length === number, wanted);
const near = (one, other, within) => one.every((value, i) => Math.abs(value - other[i]) < within);

/** Another look at the same photo. */
async function lookAgain(page) {
  await page.click('[data-step=photo]');
  await page.click('#recognise');
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
}

async function drawPolygon(page, corners) {
  await page.click('#add-polygon');
  for (const corner of corners) await clickFloor(page, corner);
  await clickFloor(page, corners[0]);
}

onPage('a polygon and a disc are drawn, shaped, kept through another look, and saved', async (page) => {
  await openSample(page);
  const corners = [[1.08, 0.8], [1.18, 0.8], [1.2, 0.9], [1.1, 0.95]];
  await drawPolygon(page, corners);
  await count(page, COUNT + 1);
  let drawn = (await state(page)).scene.obstacles.at(-1);
  assert.ok(drawn.polygon.length === 4 && near(drawn.polygon.flat(), corners.flat(), 0.006), JSON.stringify(drawn));
  // A corner is dragged, and another one moved by keys.
  await dragFloor(page, corners[2], [1.24, 0.88]);
  await until(page, () => Math.abs(window.wmr.state.scene.obstacles.at(-1).polygon[2][0] - 1.24) < 0.006);
  await page.focus('[data-vertex="0"]');
  await page.keyboard.press('ArrowLeft');
  await until(page, (x) => Math.abs(window.wmr.state.scene.obstacles.at(-1).polygon[0][0] - x + 0.005) < 1e-6, drawn.polygon[0][0]);
  await shot(page, '2-polygon');

  await page.click('#add-disc');
  await dragFloor(page, [0.88, 0.25], [0.93, 0.25]);
  await count(page, COUNT + 2);
  const disc = (await state(page)).scene.obstacles.at(-1);
  assert.ok(near(disc.circle, [0.88, 0.25, 0.05], 0.006), JSON.stringify(disc));
  await dragFloor(page, [0.93, 0.25], [0.95, 0.25]);
  await until(page, () => Math.abs(window.wmr.state.scene.obstacles.at(-1).circle[2] - 0.07) < 0.006);
  await until(page, () => window.wmr.state.revision.scene > 0);

  const before = (await state(page)).scene.obstacles;
  await lookAgain(page);
  const after = (await state(page)).scene.obstacles;
  assert.deepEqual(after.slice(-2), before.slice(-2), 'what was drawn is still there');
  const file = page.waitForEvent('download');
  await page.click('#save-scene');
  const saved = JSON.parse(readFileSync(await (await file).path(), 'utf8'));
  assert.deepEqual(saved.obstacles, after);
  await page.click('#afresh');
  await count(page, COUNT);
});

onPage('what is no obstacle stays none, and becomes one again when a person says so', async (page) => {
  await openSample(page);
  const [first] = (await state(page)).scene.obstacles;
  await page.click('#boxes li:first-child button');
  await until(page, () => document.getElementById('erase-box').textContent === 'Not an obstacle');
  await page.click('#erase-box');
  await count(page, COUNT - 1);
  await lookAgain(page);
  await count(page, COUNT - 1);
  assert.equal(await page.locator('.no-obstacle').count(), 1);
  // Another page sees the same, and so does a program that was started again.
  assert.equal((await (await fetch(`http://${the.server.host}/api/state`)).json()).erased.length, 1);
  await page.click('#erased button');
  await count(page, COUNT);
  assert.deepEqual((await state(page)).scene.obstacles.at(-1), first);
  await page.click('#undo');
  await count(page, COUNT - 1);
});

onPage('a scene file that was saved corrects the photo once more', async (page) => {
  await openSample(page);
  assert.equal(await page.locator('#afresh').isHidden(), true, 'nothing is corrected yet');
  const { scene, margins } = await state(page);
  const corrected = { ...scene, obstacles: scene.obstacles.slice(1), margins: margins.slice(1) };
  await page.setInputFiles('#file', { name: 'scene.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(corrected)) });
  await count(page, COUNT - 1);
  await lookAgain(page);
  await count(page, COUNT - 1);
});

onPage('nothing is an obstacle in a place that is ignored', async (page) => {
  await openSample(page);
  await page.click('[data-step=photo]');
  await page.click('#reading-details summary');
  await page.click('#ignore-place');
  await dragFloor(page, [0.62, 0.756], [0.72, 0.756]);
  await count(page, COUNT - 1);
  assert.equal(await page.locator('.ignored').count(), 1);
  await page.click('#ignored button');
  await count(page, COUNT);
});

onPage('tags and a camera file are asked for, and nonsense is refused with a reason', async (page) => {
  await openSample(page);
  await page.click('[data-step=photo]');
  await page.click('#reading-details summary');
  await page.selectOption('#tags', 'outer');
  await page.waitForSelector('#photo-problem:not([hidden])');
  assert.match(await page.locator('#photo-problem').innerText(), /tag/i);
  await page.selectOption('#tags', '');
  await until(page, () => !window.wmr.state.working && !window.wmr.state.problem.photo);
  const file = (text) => ({ name: 'camera.json', mimeType: 'application/json', buffer: Buffer.from(text) });
  await page.setInputFiles('#camera-file', file('{"a": 1}'));
  await page.waitForSelector('#photo-problem:not([hidden])');
  assert.match(await page.locator('#photo-problem').innerText(), /no camera file/);
  assert.equal((await state(page)).reading.camera, null);
  // Straight above the middle of the arena, three metres up: x to the right, y down in the picture.
  const [width, height] = SAMPLE.arena;
  const f = 3 * (await page.evaluate(() => { const [a, b] = window.wmr.state.detection.corners_px; return Math.hypot(b[0] - a[0], b[1] - a[1]); })) / width;
  const centre = await page.evaluate(() => [0, 1].map((axis) => window.wmr.state.detection.corners_px.reduce((sum, at) => sum + at[axis] / 4, 0)));
  const main = { model: 'perspective', image_size: [640, 480], K: [[f, 0, centre[0]], [0, f, centre[1]], [0, 0, 1]], k1: 0, R: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], t: [-width / 2, height / 2, 3] };
  await page.setInputFiles('#camera-file', file(JSON.stringify({ main })));
  await until(page, () => !window.wmr.state.working && window.wmr.state.reading.camera);
  assert.match(await page.locator('#camera-note').innerText(), /640 × 480/);
  assert.equal((await state(page)).problem.photo, null);
});

onPage('a magnifier shows where a corner goes', async (page) => {
  await openSample(page);
  await page.click('[data-step=photo]');
  const handle = await page.locator('[data-corner="2"] .handle').boundingBox();
  await page.mouse.move(handle.x + handle.width / 2, handle.y + handle.height / 2);
  await page.mouse.down();
  await page.mouse.move(handle.x, handle.y + 30, { steps: 3 });
  await page.waitForSelector('#magnifier');
  const lens = await page.locator('.lens-rim').boundingBox();
  assert.ok(lens.x + lens.width < handle.x || lens.y > handle.y + 45, 'it does not cover the corner');
  await shot(page, '1-magnifier');
  await page.mouse.up();
  await until(page, () => window.wmr.state.corners && !window.wmr.state.working);
  assert.equal(await page.locator('#magnifier').count(), 0);
});

onPage("the paper's steps are shown one by one, and STOP stays in reach", async (page) => {
  await openSample(page);
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  await page.click('[data-panel=plan] [data-steps]');
  await page.waitForSelector('#steps-dialog[open]');
  const number = await page.locator('#steps-list li').count();
  assert.ok(number >= 12, `${number}`);
  for (let i = 0; i < number; i += 1) {
    await until(page, () => { const picture = document.getElementById('steps-picture'); return picture.complete && picture.naturalWidth > 0; });
    assert.match(await page.locator('#steps-text').innerText(), /^[A-Z].*\.$/);
    if (i === 7) await shot(page, '6-steps');
    if (i < number - 1) await page.click('#steps-next');
  }
  assert.equal(await page.locator('#steps-next').isDisabled(), true);
  await page.click('#stop');
  await until(page, () => window.wmr.state.base.state === 'stopped');
  await page.click('#steps-close');
});

onPage('a cell of the mini-matrix and its area light each other', async (page) => {
  await openSample(page);
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  await page.click('#grid-details summary');
  const { plan } = await state(page);
  const { xs, ys } = plan.grid_lines;
  assert.deepEqual([plan.mini_matrix.length, plan.mini_matrix[0].length], [ys.length - 1, xs.length - 1]);
  // The start and the goal lie in the areas with a 2.
  for (const [x, y] of [plan.waypoints[0], plan.waypoints.at(-1)]) {
    const column = xs.findIndex((line) => line > x) - 1;
    const row = ys.length - 1 - ys.findIndex((line) => line > y);
    assert.equal(plan.mini_matrix[row][column], 2);
    await page.hover(`[data-cell="${row},${column}"]`);
    await page.waitForSelector(`.area.lit[data-area="${row},${column}"]`);
  }
  const free = plan.mini_matrix[2].indexOf(1);
  await page.mouse.move(...(await onScreen(page, [(xs[free] + xs[free + 1]) / 2, (ys[ys.length - 3] + ys[ys.length - 4]) / 2])));
  await page.waitForSelector(`td.lit[data-cell="2,${free}"]`);
  await page.focus(`[data-cell="0,0"]`);
  await page.keyboard.press('ArrowDown');
  await page.waitForSelector('.area.lit[data-area="1,0"]');
  await shot(page, '3-matrix');
});

onPage('obstacles are added by keys alone', async (page) => {
  await openSample(page);
  for (const [index, kind] of ['box', 'polygon', 'disc'].entries()) {
    await page.focus(`#add-${kind}`);
    await page.keyboard.press('Enter');
    await count(page, COUNT + index + 1);
    await page.focus(`[data-box="${COUNT + index}"]`);
    await page.keyboard.press('Shift+ArrowRight');
  }
  await page.keyboard.press('Delete');
  await count(page, COUNT + 2);
  assert.equal((await post(the.server, 'detect', {})).status, 200);
});
