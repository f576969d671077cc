// A camera over the arena: live frames under the outlines, what is known of the pose, why the robot waits, and a
// camera that is dark. The simulated world waits for its camera, so a slow computer changes no outcome.

import assert from 'node:assert/strict';
import { assertLegible, clickFloor, dragFloor, openSample, planTo, post, shot, state, until as within } from './browser.mjs';
import { onPage, the } from './suite.mjs';

/** A floor of 1.6 x 1.2 m with two boxes beside the way from the left to the right. */
const HALL = {
  format: 'wmr-scene/2', arena: { width: 1.6, height: 1.2 }, robot_radius: 0.075,
  obstacles: [[0.6, 0.9, 0.8, 1.2], [1.2, 0, 1.4, 0.2]], start: [0.3, 0.55, 0],
};
const [GOAL, SIZE] = [[1.3, 0.55], [1.6, 1.2]];
/** A watched drive of an unoptimised program on a busy computer, milliseconds. */
const LONG = { speed: 1, patience: 300_000 };

const until = (page, condition, argument) => within(page, condition, argument, LONG.patience);

/** The hall with a plan through it. */
async function openHall(page, goal = GOAL) {
  await page.setInputFiles('#file', { name: 'hall.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(HALL)) });
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
  await planTo(page, goal, SIZE);
  await until(page, () => window.wmr.state.plan && !window.wmr.state.planning);
}

/** Presses a key on what is shown: what is hidden still takes no focus. */
async function pressOn(page, selector, key) {
  await page.waitForSelector(`${selector}:visible:enabled`);
  await page.focus(selector);
  await page.keyboard.press(key);
}

async function switchOn(page) {
  await page.click('[data-step=drive]');
  await page.check('#watch');
  await page.waitForSelector('#live', { state: 'attached' });
}

/** Waits for the end of a drive; its report. */
async function ended(page) {
  await until(page, () => window.wmr.state.run?.report && !window.wmr.state.drive.active);
  const { run } = await state(page);
  return run;
}

async function assertReached(page) {
  const { report, error } = await ended(page);
  assert.equal(error, null);
  assert.deepEqual([report.reached, report.collisions], [true, 0], JSON.stringify(report));
  return report;
}

onPage('the camera of the sample arena shows its floor and watches the drive across it', async (page) => {
  await openSample(page);
  // A camera sees edges to a few millimetres, which is more room than the sample's narrowest gaps leave.
  for (const [x, y] of [[0.62, 0.76], [0.16, 0.51], [0.235, 1.445]]) {
    await clickFloor(page, [x, y]);
    await page.click('#erase-box');
  }
  await planTo(page);
  await until(page, () => window.wmr.state.plan && !window.wmr.state.planning);
  await switchOn(page);
  const first = (await state(page)).live.number;
  await until(page, (number) => window.wmr.state.live?.number >= number + 3, first);
  await page.click('#drive');
  await page.waitForSelector('#pose-ellipse', { state: 'attached' });
  const { drive, camera } = await state(page);
  assert.ok(drive.view.way.length >= 2 && drive.view.things.length >= 5, JSON.stringify(drive.view));
  assert.equal(camera.problem, null);
  const boxes = await page.locator('[data-thing]').count();
  assert.equal(boxes, drive.view.things.length);
  // Both at one moment: they are drawn anew with every sight.
  const [ellipse, body] = await page.evaluate(() =>
    ['pose-ellipse', 'robot'].map((id) => document.getElementById(id).getBoundingClientRect().width));
  assert.ok(ellipse > 0.5 && ellipse < body, `${ellipse} in ${body}`);
  await page.waitForTimeout(1500);
  await shot(page, '9-watched');
  const report = await assertReached(page);
  assert.ok(report.watch.used > 20, JSON.stringify(report.watch));
  assert.match(await page.locator('#result').innerText(), /Goal reached/);
}, LONG);

onPage('a box that rolls into the way is seen, said and not touched', async (page) => {
  await openHall(page);
  await switchOn(page);
  // One by hand, out of the way: dragging lets it roll.
  await page.click('#set-down');
  await until(page, () => document.getElementById('hint').textContent.includes('drag to let it roll'));
  await dragFloor(page, [0.12, 1.08], [0.3, 1.08], SIZE);
  await until(page, () => window.wmr.state.adding === null);
  await page.click('#drive');
  await until(page, () => window.wmr.state.drive.view?.pose[0] > 0.4);
  assert.equal((await post(the.server, 'things', { at: [1.0, 0.9], to: [1.0, 0.55], speed: 0.3 })).status, 200);
  await page.waitForSelector('.predicted', { state: 'attached', timeout: LONG.patience });
  await shot(page, '9-rolls');
  await until(page, () => window.wmr.state.drive.told.some(({ event }) => ['held', 'rerouted'].includes(event)));
  await until(page, () => document.querySelectorAll('#told li').length > 0);
  assert.match(await page.locator('#told').innerText(), /in(to)? the way|new path/i);
  const report = await assertReached(page);
  assert.ok(report.watch.replans + report.watch.waits >= 1, JSON.stringify(report.watch));
}, LONG);

onPage('a box that is set down in the way is waited for or gone round', async (page) => {
  await openHall(page);
  await switchOn(page);
  await page.click('#drive');
  await until(page, () => window.wmr.state.drive.view?.pose[0] > 0.35);
  await page.click('#set-ahead');
  await until(page, () => window.wmr.state.drive.told.some(({ event }) => event === 'rerouted'));
  await shot(page, '9-round');
  await assertReached(page);
}, LONG);

onPage('where no way is left the page says why the robot waits, and STOP ends it', async (page) => {
  await openHall(page);
  await switchOn(page);
  await page.click('#drive');
  await until(page, () => window.wmr.state.drive.view);
  // A wall from one side to the other.
  for (const y of [0.4, 1]) assert.equal((await post(the.server, 'things', { at: [1, y], size: [0.1, 0.8] })).status, 200);
  await until(page, () => /The robot waits: no way/.test(document.getElementById('watch-words').textContent));
  assert.ok((await page.locator('#hint').innerText()).length > 20);
  for (const colorScheme of ['dark', 'light']) {
    await page.emulateMedia({ colorScheme });
    await assertLegible(page, `9-waits-1280-${colorScheme}`);
  }
  const began = Date.now();
  await page.keyboard.press('Escape');
  await until(page, () => !window.wmr.state.drive.active && ['stopped', 'idle'].includes(window.wmr.state.base.state));
  assert.ok(Date.now() - began < 3000, `${Date.now() - began} ms`);
  await until(page, () => window.wmr.state.run.error?.code === 'robot.stopped');
}, LONG);

onPage('a camera that is dark, moved or silent is said in words', async (page) => {
  await openHall(page);
  await switchOn(page);
  const says = (words) => until(page, (text) => document.getElementById('watch-words').textContent.includes(text), words);
  await says('shows the floor');
  await post(the.server, 'faults', { camera: 'dark' });
  await says('black');
  await shot(page, '9-dark');
  await page.click('#drive');
  await page.waitForSelector('#drive-problem:not([hidden])');
  assert.match(await page.locator('#drive-problem').innerText(), /black/);
  await post(the.server, 'faults', {});
  await says('shows the floor');
  await page.click('#drive');
  await until(page, () => window.wmr.state.drive.view);
  await post(the.server, 'faults', { camera: 'moved' });
  await says('the camera has moved');
  await page.click('#stop');
  await until(page, () => !window.wmr.state.drive.active);
  await post(the.server, 'faults', { camera: 'silent' });
  await says('No picture for');
  await page.uncheck('#watch');
  await says('Off');
  assert.equal(await page.locator('#live').count(), 0);
}, LONG);

onPage('on a phone, in the dark and by keyboard', async (page) => {
  await openHall(page);
  await pressOn(page, '[data-step=drive]', 'Enter');
  await pressOn(page, '#watch', 'Space');
  await page.waitForSelector('#live', { state: 'attached' });
  await pressOn(page, '#drive', 'Enter');
  await until(page, () => window.wmr.state.drive.view?.pose[0] > 0.35);
  await pressOn(page, '#set-ahead', 'Enter');
  await until(page, () => window.wmr.state.drive.told.length > 0);
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    await assertLegible(page, `9-watched-360-${colorScheme}`);
  }
  await assertReached(page);
}, { ...LONG, width: 360, height: 740, colorScheme: 'dark' });
