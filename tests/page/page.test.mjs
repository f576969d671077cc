// What a person does on the page, in a browser, with the real program behind it.

import assert from 'node:assert/strict';
import { request } from 'node:http';
import { test } from 'node:test';
import { onPage, the } from './suite.mjs';
import {
  SAMPLE, clickFloor, dragFloor, onScreen, open, openSample, planTo, post, readmeShot, serve, shot, state, until,
} from './browser.mjs';

/** The box of the truth that an outline lies over, within 6 mm on each side: the picture's pixel is 3.7 mm. */
function matching(outline) {
  return SAMPLE.obstacles.findIndex((box) => box.every((side, index) => Math.abs(side - outline[index]) < 0.006));
}

onPage('the sample is outlined as it was drawn, planned and driven, in four clicks', async (page) => {
  await page.click('#try-sample');
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
  const seen = (await state(page)).scene.obstacles;
  assert.deepEqual(seen.map(matching).sort(), SAMPLE.obstacles.map((_, index) => index));
  assert.equal(await page.locator('.obstacle').count(), SAMPLE.obstacles.length);
  const robot = (await state(page)).start;
  assert.ok(Math.hypot(robot[0] - SAMPLE.robot[0], robot[1] - SAMPLE.robot[1]) < 0.01, `${robot}`);
  await shot(page, '2-recognised');

  await page.click('#to-plan');
  assert.equal(await page.locator('#drive-now').isDisabled(), true, 'no plan, no drive');
  await clickFloor(page, SAMPLE.goal);
  await page.waitForSelector('#path');
  // A look ahead: at its end the ghost stands on the goal.
  await page.fill('#preview', String((await state(page)).plan.duration - 0.05));
  await page.waitForSelector('#ghost');
  const [ghost, ring] = await Promise.all(['#ghost', '.goal-ring'].map((name) => page.locator(name).boundingBox()));
  assert.ok(Math.hypot(ghost.x - ring.x, ghost.y - ring.y) < 8, 'the ghost arrives');
  await page.fill('#preview', '6');
  await shot(page, '3-plan');
  await page.click('#drive-now');
  await until(page, () => window.wmr.state.drive.leg >= 4);
  // Where the plan wants it: a robot that slips nowhere is there, but for the time that words take.
  const { drive, base } = await state(page);
  assert.ok(Math.hypot(drive.reference[0] - base.pose[0], drive.reference[1] - base.pose[1]) < 0.03, `${drive.reference} ${base.pose}`);
  await page.waitForSelector('#reference');
  const [trail, path] = await Promise.all(['.trail', '#path'].map((name) => page.locator(name).evaluate(({ points: [{ x, y }] }) => [x, y])));
  assert.ok(Math.hypot(trail[0] - path[0], trail[1] - path[1]) < 3, 'the trail begins where the path does');
  await shot(page, '4-drive');
  await readmeShot(page);
  await page.waitForSelector('#result');
  await page.mouse.move(0, 0);
  await shot(page, '5-report');
  const { run, goal } = await state(page);
  assert.equal(run.report.reached, true);
  assert.equal(run.report.collisions, 0);
  const [x, y] = run.report.true_pose;
  assert.ok(Math.hypot(x - goal[0], y - goal[1]) < 0.02, 'within 2 cm of the click');
  assert.ok(Math.hypot(goal[0] - SAMPLE.goal[0], goal[1] - SAMPLE.goal[1]) < 0.006, 'the click is where it was meant');

  // The next way begins where the robot stands.
  await page.click('[data-step=plan]');
  assert.ok(Math.hypot((await state(page)).start[0] - x, (await state(page)).start[1] - y) < 0.001);
});

onPage('STOP stops from a field, by key and by click, and the robot drives again', async (page) => {
  await openSample(page);
  for (const how of ['key', 'click']) {
    await planTo(page);
    await until(page, () => window.wmr.state.plan);
    await page.click('#drive-now');
    await until(page, () => window.wmr.state.base.state === 'driving' && window.wmr.state.drive.time > 1);
    await page.click('[data-step=plan]');
    await page.focus('#goal-x');
    if (how === 'key') await page.keyboard.press('Escape');
    else await page.click('#stop');
    await until(page, () => window.wmr.state.run.error && window.wmr.state.base.state === 'stopped');
    const { run, base } = await state(page);
    assert.equal(run.error.code, 'robot.stopped');
    assert.equal(run.report.reached, false);
    assert.deepEqual(base.wheels, [0, 0]);
    await page.click('[data-step=boxes]');
  }
});

onPage('STOP is heard within 0.3 s of the robot from any focus, and while a photo is on its way', async (page) => {
  await openSample(page);
  const get = async (what) => fetch(`http://${the.server.host}/api/${what}?t=${the.server.token}`);
  // A photo that never comes to its end.
  const upload = request({
    host: '127.0.0.1', port: the.server.host.split(':')[1], method: 'POST', path: '/api/photo',
    headers: { 'content-type': 'image/png', 'content-length': 1e6, authorization: `Bearer ${the.server.token}` },
  });
  upload.on('error', () => null);
  upload.write(Buffer.alloc(1000));
  for (const focus of ['#goal-x', '#planner', '#preview', '[data-steps]']) {
    await page.click('[data-step=boxes]');
    await planTo(page);
    await until(page, () => !document.getElementById('drive-now').disabled);
    await page.click('#drive-now');
    await until(page, () => window.wmr.state.drive.active && window.wmr.state.drive.time > 0.4);
    await page.click('[data-step=plan]');
    await page.locator(`[data-panel=plan] ${focus}`).focus();
    const { drive } = await (await get('state')).json();
    await page.keyboard.press('Escape');
    await until(page, () => window.wmr.state.base.state === 'stopped' && !window.wmr.state.drive.active);
    const words = (await (await get('run.jsonl')).text()).trim().split('\n').map((line) => JSON.parse(line));
    const heard = words.findLast(({ state: name }) => name === 'driving').t;
    assert.ok(heard - drive.time < 0.3, `${focus}: after ${heard - drive.time} s`);
  }
  upload.destroy();
}, { speed: 0.5 });

onPage('a box added by hand is planned around, and no longer when it is erased', async (page) => {
  await openSample(page);
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  const before = (await state(page)).plan;
  // Beside the way, where there is room for the robot on its other side.
  const middle = [0.88, 0.62];
  await page.click('[data-step=boxes]');
  await page.click('#add-box');
  await dragFloor(page, [middle[0] - 0.02, middle[1] - 0.02], [middle[0] + 0.02, middle[1] + 0.02]);
  await until(page, (length) => window.wmr.state.plan && Math.abs(window.wmr.state.plan.length - length) > 1e-4, before.length);
  const around = await state(page);
  assert.equal(around.scene.obstacles.length, SAMPLE.obstacles.length + 1);
  const box = around.scene.obstacles.at(-1);
  assert.ok(box[0] < middle[0] && middle[0] < box[2] && box[1] < middle[1] && middle[1] < box[3], `${box}`);
  assert.ok(around.plan.length > before.length);
  await page.click('[data-step=plan]');
  await page.click('#drive-now');
  await page.waitForSelector('#result');
  assert.equal((await state(page)).run.report.collisions, 0);
  assert.equal((await state(page)).run.report.reached, true);

  await page.click('[data-step=boxes]');
  assert.equal((await state(page)).selected, SAMPLE.obstacles.length, 'what was added is selected');
  await page.click('#erase-box');
  await until(page, (length) => window.wmr.state.plan && Math.abs(window.wmr.state.plan.length - length) < 1e-9, before.length);
  await page.click('#undo');
  await until(page, () => window.wmr.state.scene.obstacles.length === 9);
});

onPage('an edge that is dragged moves, and every step is planned again', async (page) => {
  await openSample(page);
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  const { plan } = await state(page);
  await page.click('[data-step=boxes]');
  const seen = (await state(page)).scene.obstacles;
  const index = seen.findIndex((box) => matching(box) === SAMPLE.obstacles.findIndex((drawn) => drawn[0] === 0.57));
  await page.click(`#boxes li:nth-child(${index + 1}) button`);
  const [x0, , x1, y1] = seen[index];
  await dragFloor(page, [(x0 + x1) / 2 + 0.02, y1], [(x0 + x1) / 2 + 0.02, y1 - 0.04]);
  await until(page, (length) => window.wmr.state.plan && window.wmr.state.plan.length !== length, plan.length);
  const after = await state(page);
  assert.ok(Math.abs(after.scene.obstacles[index][3] - (y1 - 0.04)) < 0.006, `${after.scene.obstacles[index]}`);
  assert.ok(Math.abs(after.scene.obstacles[index][0] - x0) < 1e-3, 'the other edges stay');
  assert.deepEqual(after.margins[index], [0, 0, 0, 0], 'a person is sure');
  await until(page, (at) => {
    const { plan, scene } = window.wmr.state;
    return plan?.scene.obstacles[at][3] === scene.obstacles[at][3];
  }, index);
});

onPage('a scene with shapes is shown, and a goal that cannot be reached names the gap', async (page) => {
  const scene = {
    format: 'wmr-scene/1', arena: { width: 2, height: 1 },
    obstacles: [[0.9, 0, 1.1, 0.3], [0.9, 0.41, 1.1, 0.7], [0.9, 0.76, 1.1, 1]],
  };
  await page.setInputFiles('#file', { name: 'wall.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(scene)) });
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
  await page.click('#to-plan');
  // Where it stands and looks, then where it is to go.
  await dragFloor(page, [0.3, 0.5], [0.3, 0.8], [2, 1]);
  await clickFloor(page, [1.7, 0.5], [2, 1]);
  await until(page, () => window.wmr.state.planProblem);
  const { planProblem, start } = await state(page);
  assert.ok(Math.abs(start[2] - Math.PI / 2) < 0.05, `${start}`);
  assert.equal(planProblem.code, 'plan.no_path');
  const words = await page.locator('#plan-problem').innerText();
  assert.match(words, /11\.0 cm/);
  assert.match(words, /15\.0 cm/);
  assert.match(words, /Move obstacle 1 4\.0 cm/);
  assert.equal(await page.locator('.obstacle.blocking').count(), 2);
  assert.equal(await page.locator('#drive-now').isDisabled(), true);
  await shot(page, '3-no-way');
});

onPage('polygons and circles are drawn, changed and planned around', async (page) => {
  const scene = {
    format: 'wmr-scene/2', arena: { width: 2, height: 1 }, start: [0.2, 0.5, 0], goal: [1.8, 0.5],
    obstacles: [[0.1, 0.1, 0.3, 0.3], { polygon: [[0.6, 0.3], [0.9, 0.4], [0.7, 0.7]] }, { circle: [1.4, 0.5, 0.2] }],
  };
  await page.setInputFiles('#file', { name: 'shapes.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(scene)) });
  await page.waitForSelector('.obstacle');
  const corners = await page.locator('.obstacle').evaluateAll((shapes) => shapes.map((shape) => shape.points.numberOfItems));
  assert.deepEqual([corners[0], corners[1]], [4, 3]);
  assert.ok(corners[2] > 20, 'a circle is round');
  assert.match(await page.locator('#boxes').innerText(), /3 corners/);

  await until(page, () => window.wmr.state.plan?.inflation === 'disc');
  const { length } = (await state(page)).plan;
  await page.click('#boxes li:nth-child(3) button');
  await page.waitForSelector('[data-rim]');
  await dragFloor(page, [1.6, 0.5], [1.5, 0.5], [2, 1]);
  await until(page, () => Math.abs(window.wmr.state.plan?.scene.obstacles[2].circle[2] - 0.1) < 0.005);
  await page.click('#boxes li:nth-child(2) button');
  await page.waitForSelector('[data-vertex]');
  await dragFloor(page, [0.7, 0.7], [0.7, 0.5], [2, 1]);
  await until(page, () => Math.abs(window.wmr.state.plan?.scene.obstacles[1].polygon[2][1] - 0.5) < 0.005);
  assert.ok((await state(page)).plan.length < length, 'smaller obstacles, a shorter way');
  await page.click('[data-step=plan]');
  await page.waitForSelector('.grown');
  await shot(page, '3-shapes');
  await page.click('#drive-now');
  await page.waitForSelector('#result');
  assert.equal((await state(page)).run.report.collisions, 0);
});

onPage('what is no photo is refused in words, a large and a turned one are read', async (page) => {
  await page.setInputFiles('#file', { name: 'photo.png', mimeType: 'image/png', buffer: Buffer.from('a text') });
  await page.waitForSelector('#photo-problem:not([hidden])');
  assert.match(await page.locator('#photo-problem').innerText(), /no photo/i);
  assert.equal((await state(page)).photo, null);

  const drawn = await page.evaluate(async () => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [1000, 700];
    const draw = canvas.getContext('2d');
    const fill = (colour, ...rect) => { draw.fillStyle = colour; draw.fillRect(...rect); };
    fill('#d8d4cc', 0, 0, 1000, 700);
    fill('#222', 80, 80, 840, 540);
    fill('#d8d4cc', 100, 100, 800, 500);
    fill('#2a3440', 300, 220, 120, 200);
    fill('#2a3440', 640, 380, 160, 100);
    const blob = await new Promise((resolve) => { canvas.toBlob(resolve, 'image/jpeg', 0.95); });
    return [...new Uint8Array(await blob.arrayBuffer())];
  });
  // The same picture lying on its side, with an EXIF head that says so: 8 is a quarter turn to the left.
  await page.setInputFiles('#file', { name: 'photo.jpg', mimeType: 'image/jpeg', buffer: turned(Buffer.from(drawn), 8) });
  await until(page, () => window.wmr.state.photo);
  assert.deepEqual((({ width, height }) => [width, height])((await state(page)).photo), [700, 1000]);
  const shown = await page.locator('#view image').evaluate(async (node) => {
    const picture = new Image();
    picture.src = node.getAttribute('href');
    await picture.decode();
    return [picture.naturalWidth, picture.naturalHeight];
  });
  assert.deepEqual(shown, [700, 1000], 'the browser turns it the same way');

  await page.setInputFiles('#file', { name: 'photo.jpg', mimeType: 'image/jpeg', buffer: Buffer.from(drawn) });
  await until(page, () => window.wmr.state.photo?.width === 1000);
  await page.fill('#width', '1.6');
  await page.fill('#height', '1.0');
  await page.click('#recognise');
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
  const { scene, margins } = await state(page);
  assert.equal(scene.obstacles.length, 2);
  for (const box of [[0.4, 0.36, 0.64, 0.76], [1.08, 0.24, 1.4, 0.44]]) {
    const index = scene.obstacles.findIndex((outline) => Math.abs(outline[0] - box[0]) < 0.1);
    // An edge may lie as far out as its margin says; 5 mm more are two pixels.
    box.forEach((side, edge) => assert.ok(Math.abs(side - scene.obstacles[index][edge]) < 0.005 + margins[index][edge], `${scene.obstacles[index]}`));
  }
});

function turned(jpeg, orientation) {
  const exif = Buffer.from([0x45, 0x78, 0x69, 0x66, 0, 0, 0x4d, 0x4d, 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0, 0, 0, 0, 0]);
  const head = Buffer.from([0xff, 0xe1, 0, exif.length + 2]);
  return Buffer.concat([jpeg.subarray(0, 2), head, exif, jpeg.subarray(2)]);
}

onPage('corners are dragged to where the floor ends', async (page) => {
  await openSample(page);
  await page.click('[data-step=photo]');
  const before = (await state(page)).detection.corners_px;
  const handle = await page.locator('[data-corner="2"] .handle').boundingBox();
  const centre = [handle.x + handle.width / 2, handle.y + handle.height / 2];
  await page.mouse.move(...centre);
  await page.mouse.down();
  await page.mouse.move(centre[0] - 12, centre[1] + 12, { steps: 4 });
  await page.mouse.up();
  await until(page, () => window.wmr.state.corners && !window.wmr.state.working);
  const { corners } = await state(page);
  assert.ok(corners[2][0] < before[2][0] - 2 && corners[2][1] > before[2][1] + 2, `${corners[2]}`);
  assert.deepEqual(corners[0].map(Math.round), before[0].map(Math.round), 'the others stay');
  await page.focus('[data-corner="2"]');
  await page.keyboard.press('ArrowRight');
  await until(page, (x) => window.wmr.state.corners?.[2][0] > x + 0.5 && !window.wmr.state.working, corners[2][0]);
  await page.click('#corners-auto');
  await until(page, () => !window.wmr.state.corners && !window.wmr.state.working);
});

onPage('a camera takes the photo', async (page) => {
  await page.click('#use-camera');
  await until(page, () => document.getElementById('camera-view').videoWidth > 0);
  await page.click('#camera-take');
  await until(page, () => window.wmr.state.photo);
  assert.ok((await state(page)).photo.width >= 320);
});

test('a program that is gone is veiled, and one that is back goes on', async () => {
  const page = await open(the.server);
  await openSample(page);
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  await the.server.kill();
  await page.waitForSelector('#veil:not([hidden])');
  assert.match(await page.locator('#veil').innerText(), /No word from the program/);
  await shot(page, '4-veil');
  the.server = await serve({ address: the.server.host });
  await page.waitForSelector('#veil', { state: 'hidden' });
  await until(page, () => window.wmr.state.plan && !window.wmr.state.working);
  assert.equal((await state(page)).scene.obstacles.length, SAMPLE.obstacles.length);
  await page.click('#drive-now');
  await page.waitForSelector('#result');
  assert.equal((await state(page)).run.report.reached, true);
  assert.deepEqual(page.errors, []);
});

test('two pages show one state, and the robot pauses when the last is closed', async () => {
  const [first, second] = [await open(the.server), await open(the.server)];
  await openSample(first);
  await planTo(first);
  await until(first, () => window.wmr.state.plan);
  const { plan } = await state(first);
  await until(second, (length) => window.wmr.state.plan?.length === length, plan.length);
  await first.click('#drive-now');
  await until(second, () => window.wmr.state.base.state === 'driving');
  await first.context().close();
  await second.context().close();
  let live;
  do live = await (await fetch(`http://${the.server.host}/api/state`)).json(); while (live.base.state !== 'paused');
  const third = await open(the.server);
  await third.click('[data-step=drive]');
  await third.click('#pause');
  await third.waitForSelector('#result');
  assert.equal((await state(third)).run.report.reached, true);
});

test('a robot that is told to drives on when the last page is closed', async () => {
  const page = await open(the.server);
  await openSample(page);
  await planTo(page);
  await until(page, () => !document.getElementById('drive-now').disabled);
  await page.click('[data-step=drive]');
  await page.check('#unattended');
  await page.click('#drive');
  await until(page, () => window.wmr.state.base.state === 'driving');
  await page.context().close();
  const live = async () => (await fetch(`http://${the.server.host}/api/state`)).json();
  let now;
  do now = await live(); while (now.drive.active && now.base.state !== 'paused');
  assert.equal(now.run.report?.reached, true, now.base.state);
});

test('other origins, other names and strangers are refused', async () => {
  assert.equal((await post(the.server, 'stop', undefined, { origin: 'http://evil.example' })).status, 403);
  assert.equal((await post(the.server, 'stop', undefined, { authorization: '' })).status, 401);
  const page = await open(the.server);
  // A page of another origin in the same browser: it can neither stop the robot nor read its state.
  const refused = await page.evaluate(async (host) => {
    const frame = document.createElement('iframe');
    frame.sandbox = 'allow-scripts';
    const asked = new Promise((resolve) => { addEventListener('message', (message) => resolve(message.data)); });
    frame.srcdoc = `<script>fetch('http://${host}/api/stop', { method: 'POST', headers: { 'content-type': 'text/plain' }, body: 'x' })
      .then((answer) => parent.postMessage('answered ' + answer.status, '*'), () => parent.postMessage('refused', '*'))<\/script>`;
    document.body.append(frame);
    return Promise.race([asked, new Promise((resolve) => { setTimeout(resolve, 3000, 'silent'); })]);
  }, the.server.host);
  assert.ok(['refused', 'silent'].includes(refused), refused);
  assert.notEqual((await state(page)).base.state, 'stopped');
  await page.context().close();
});

onPage('keys alone lead from the photo to the goal', async (page) => {
  const press = async (selector, key = 'Enter') => { await page.focus(selector); await page.keyboard.press(key); };
  await press('#try-sample');
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
  await press('#to-plan');
  await page.waitForSelector('[data-panel=plan]:not([hidden])');
  await page.focus('#goal-x');
  await page.keyboard.type('0.98');
  await page.keyboard.press('Tab');
  await page.keyboard.type('0.25');
  await page.keyboard.press('Tab');
  await page.waitForSelector('[data-goal]');
  await page.focus('[data-goal]');
  await page.keyboard.press('ArrowRight');
  await until(page, () => window.wmr.state.plan?.waypoints.at(-1)[0] === 0.99);
  assert.equal(await page.evaluate(() => document.activeElement.dataset.key), 'goal', 'the focus stays');
  await press('#drive-now');
  await page.waitForSelector('#result');
  assert.equal((await state(page)).run.report.reached, true);
});
