// What is in a photo: turned boxes, tags, what is uncertain; large ones, and ones that are given up.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { onPage, the } from './suite.mjs';
import { TAGGED, TURNED, plainPhoto, taggedPhoto, turnedBoxPhoto } from './pictures.mjs';
import { openSample, open, planTo, serve, shot, state, until } from './browser.mjs';

async function lay(page, name, bytes, [width, height]) {
  const mimeType = name.endsWith('png') ? 'image/png' : 'image/jpeg';
  await page.setInputFiles('#file', { name, mimeType, buffer: bytes });
  await until(page, () => window.wmr.state.photo && !window.wmr.state.working);
  await page.fill('#width', String(width));
  await page.fill('#height', String(height));
}

async function recognise(page) {
  await page.click('#recognise');
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
}

onPage('a photo with a turned box is outlined as it was drawn', async (page) => {
  await lay(page, 'photo.jpg', await turnedBoxPhoto(page), TURNED.arena);
  await recognise(page);
  const { scene } = await state(page);
  assert.equal(scene.obstacles.length, 2, JSON.stringify(scene.obstacles));
  const box = scene.obstacles.find(Array.isArray);
  const { polygon } = scene.obstacles.find((obstacle) => !Array.isArray(obstacle));
  TURNED.upright.forEach((side, edge) => assert.ok(Math.abs(side - box[edge]) < 0.01, `${box}`));
  const { middle: [x, y], size: [a, b], angle } = TURNED.turned;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  for (const [i, j] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
    const corner = [x + (i * a * cos - j * b * sin) / 2, y + (i * a * sin + j * b * cos) / 2];
    const away = Math.min(...polygon.map((at) => Math.hypot(at[0] - corner[0], at[1] - corner[1])));
    assert.ok(away < 0.015, `${corner} is ${away} m from ${JSON.stringify(polygon)}`);
  }
  await shot(page, '2-turned');
});

onPage('what is uncertain of an outline is hatched, and what a person draws is certain', async (page) => {
  await lay(page, 'photo.jpg', await turnedBoxPhoto(page), TURNED.arena);
  await recognise(page);
  const { margins } = await state(page);
  const wide = margins.map((margin) => Math.max(...[margin].flat()));
  assert.ok(Math.max(...wide) > 0.002, `${wide}`);
  assert.equal(await page.locator('.uncertain').count(), wide.filter((margin) => margin > 0).length);
  assert.match(await page.locator('#seen').innerText(), /Hatched/);
  const [reach, own] = await Promise.all(['.uncertain', '.obstacle'].map((name) => page.locator(name).first().boundingBox()));
  assert.ok(reach.width > own.width - 4 && reach.x <= own.x + 2, 'it lies around the outline');
  const before = await page.locator('.uncertain').count();
  await page.focus('[data-box="0"]');
  await page.keyboard.press('Shift+ArrowUp');
  await until(page, (count) => document.querySelectorAll('.uncertain').length === count - 1, before);
});

onPage('where no border shows the corners are put by hand', async (page) => {
  await lay(page, 'tags.png', await taggedPhoto(page), TAGGED.arena);
  await page.click('#recognise');
  await page.waitForSelector('#photo-problem:not([hidden])');
  assert.match(await page.locator('#photo-problem').innerText(), /put the corners there by hand/);
  assert.doesNotMatch(await page.locator('#photo-problem').innerText(), /--/);
  await page.click('#corners-place');
  const [w, h] = TAGGED.arena.map((side) => side * 400);
  for (const [index, wanted] of [[100, 100 + h], [100 + w, 100 + h], [100 + w, 100], [100, 100]].entries()) {
    await until(page, () => !window.wmr.state.working);
    const [from, to] = await page.evaluate(([at, [x, y]]) => {
      const { corners } = window.wmr.state;
      const matrix = document.getElementById('view').getScreenCTM();
      return [corners[at], [x, y]].map(([u, v]) => new DOMPoint(u, v).matrixTransform(matrix)).map((point) => [point.x, point.y]);
    }, [index, wanted]);
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 4 });
    await page.mouse.up();
    await until(page, ([at, [x, y]]) => Math.hypot(window.wmr.state.corners[at][0] - x, window.wmr.state.corners[at][1] - y) < 1.5, [index, wanted]);
  }
  await recognise(page);
  const { scene, problem } = await state(page);
  assert.equal(problem.photo, null);
  const box = scene.obstacles.find((obstacle) => Array.isArray(obstacle) && Math.abs(obstacle[0] - TAGGED.box[0]) < 0.05);
  TAGGED.box.forEach((side, edge) => assert.ok(Math.abs(side - box[edge]) < 0.01, `${box}`));
});

onPage('tags stand for a border, the robot and the goal, and are shown', async (page) => {
  await lay(page, 'tags.png', await taggedPhoto(page), TAGGED.arena);
  await page.click('#reading-details summary');
  await page.selectOption('#tags', 'outer');
  await until(page, () => !window.wmr.state.working && window.wmr.state.detection);
  await page.fill('#robot-tag', '7');
  await page.press('#robot-tag', 'Tab');
  await until(page, () => !window.wmr.state.working && window.wmr.state.detection.robot);
  await page.fill('#goal-tag', '5');
  await page.press('#goal-tag', 'Tab');
  await until(page, () => !window.wmr.state.working && window.wmr.state.goal);
  const { detection, scene, goal } = await state(page);
  assert.equal(scene.obstacles.length, 1, JSON.stringify(scene.obstacles));
  TAGGED.box.forEach((side, edge) => assert.ok(Math.abs(side - scene.obstacles[0][edge]) < 0.01, `${scene.obstacles[0]}`));
  for (const [place, wanted] of [[detection.robot, TAGGED.robot], [goal, TAGGED.goal]]) {
    assert.ok(Math.hypot(place[0] - wanted[0], place[1] - wanted[1]) < 0.01, `${place}`);
  }
  await page.click('[data-step=boxes]');
  await page.waitForSelector('.tag-mark');
  assert.equal(await page.locator('.tag-mark').count(), 6);
  const names = await page.locator('#view text').allTextContents();
  assert.deepEqual(names.filter((name) => name.startsWith('tag ')), ['tag 0', 'tag 1', 'tag 2', 'tag 3', 'tag 7', 'tag 5']);
  await shot(page, '2-tags');
});

onPage('what is wrong with a photo is said before anybody looks at it', async (page) => {
  const said = async (bytes) => {
    await lay(page, 'photo.jpg', bytes, TURNED.arena);
    await until(page, () => document.getElementById('photo-note').hidden === !window.wmr.state.photo.note);
    return page.locator('#photo-note').innerText();
  };
  assert.equal(await said(await turnedBoxPhoto(page)), '');
  assert.match(await said(await turnedBoxPhoto(page, 6)), /blurred/);
  assert.match(await said(await plainPhoto(page, [640, 480], '#070707')), /black/);
  await shot(page, '1-note');
});

onPage('a photo of 40 megapixels is read, a larger one refused in words', async (page) => {
  await lay(page, 'large.jpg', await plainPhoto(page, [8000, 5000]), [1, 1]);
  assert.deepEqual((({ width, height }) => [width, height])((await state(page)).photo), [8000, 5000]);
  await page.setInputFiles('#file', { name: 'larger.jpg', mimeType: 'image/jpeg', buffer: await plainPhoto(page, [8000, 5001]) });
  await page.waitForSelector('#photo-problem:not([hidden])');
  assert.match(await page.locator('#photo-problem').innerText(), /40000000/);
  assert.equal((await state(page)).photo.width, 8000, 'the one before stays');
});

onPage('what takes long is given up by a button, and asked for again', async (page) => {
  await openSample(page);
  await page.click('[data-step=photo]');
  let held;
  await page.route('**/api/detect', (route) => { held = route; });
  await page.click('#recognise');
  await page.click('#cancel');
  await until(page, () => !window.wmr.state.working);
  const { step, problem, scene } = await state(page);
  assert.deepEqual([step, problem.photo], ['photo', null]);
  assert.ok(scene, 'what was seen before is still there');
  assert.equal(await page.locator('#cancel').isHidden(), true);
  await held.abort().catch(() => null);
  await page.unroute('**/api/detect');
  await recognise(page);
});

test('wmr demo --page shows the mission of wmr demo, ready to drive', async () => {
  await the.server.kill();
  the.server = await serve({ demo: true });
  const page = await open(the.server);
  await until(page, () => window.wmr.state.step === 'plan' && window.wmr.state.plan);
  const { plan, planner, goal } = await state(page);
  assert.deepEqual([plan.planner, planner, plan.legs.length, goal], ['grid', 'grid', 6, [0.996, 0.229, null]]);
  await page.click('#drive-now');
  await page.waitForSelector('#result', { timeout: 60_000 });
  const { run } = await state(page);
  assert.equal(run.report.reached, true);
  assert.ok(run.report.error.position < 0.02);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

onPage('a search tree is shown where the planner grew one', async (page) => {
  await openSample(page);
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  assert.equal(await page.locator('.branch').count(), 0);
  await page.selectOption('#planner', 'tree');
  await page.waitForSelector('.branch');
  const { plan } = await state(page);
  assert.ok(plan.tree.length > 10);
  const [x, y] = plan.waypoints[0];
  assert.ok(plan.tree.some(([x0, y0]) => Math.hypot(x0 - x, y0 - y) < 1e-3), 'it grows from the start');
  await shot(page, '3-tree');
});
