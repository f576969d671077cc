// The base: moving by hand, its numbers, its faults, its frames; other robots; drives of earlier.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { test } from 'node:test';
import { onPage, the } from './suite.mjs';
import { ELF, PROGRAM, openSample, open, planTo, serve, shot, state, until } from './browser.mjs';

/** A goal a few decimetres from the robot, for robots that are not faster than the clock. */
const NEAR = [0.45, 0.76];

const toBase = (page) => page.click('[data-step=base]');
const atRest = (page) => until(page, () => !window.wmr.state.drive.active);

async function press(page, hold) {
  const button = await page.locator(`[data-hold=${hold}]`).boundingBox();
  await page.mouse.move(button.x + button.width / 2, button.y + button.height / 2);
  await page.mouse.down();
}

async function driveTo(page, wanted = '#result') {
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  await page.click('#drive-now');
  await page.waitForSelector(wanted);
}

onPage('the robot moves while a button is held, and stops when it is let go', async (page) => {
  await toBase(page);
  await press(page, 'ahead');
  // Further than a single move: it goes on as long as it is held.
  await until(page, () => window.wmr.state.base.pose[0] > 0.3);
  await page.mouse.up();
  await atRest(page);
  const { base } = await state(page);
  assert.deepEqual(base.wheels, [0, 0]);
  await page.focus('[data-hold=left]');
  await page.keyboard.down('Enter');
  await until(page, (heading) => window.wmr.state.base.pose[2] > heading + 0.3, base.pose[2]);
  await page.keyboard.up('Enter');
  await atRest(page);
  const turned = (await state(page)).base;
  assert.deepEqual(turned.wheels, [0, 0]);
  assert.ok(Math.hypot(turned.pose[0] - base.pose[0], turned.pose[1] - base.pose[1]) < 0.01, 'on the spot');
});

onPage('a page that can no longer say that a button is held lets it go, and STOP does not start again', async (page) => {
  await toBase(page);
  await press(page, 'ahead');
  await until(page, () => window.wmr.state.base.pose[0] > 0.05);
  await page.route('**/api/jog', (route) => route.abort());
  await atRest(page);
  assert.deepEqual((await state(page)).base.wheels, [0, 0]);
  await page.unroute('**/api/jog');
  await page.mouse.up();

  await press(page, 'back');
  await until(page, () => window.wmr.state.drive.active);
  await page.keyboard.press('Escape');
  await until(page, () => window.wmr.state.base.state === 'stopped' && !window.wmr.state.drive.active);
  const { pose } = (await state(page)).base;
  await page.waitForTimeout(600);
  assert.deepEqual((await state(page)).base.pose, pose, 'the button is still held, and the robot rests');
  await page.mouse.up();
});

onPage("the robot's numbers are shown with their ranges, changed, and drive the next way", async (page) => {
  await openSample(page);
  await toBase(page);
  await page.click('#numbers-details summary');
  await page.waitForSelector('[data-number=speed]');
  await page.fill('[data-number=speed]', '9999');
  await page.click('#numbers-form .primary');
  assert.equal(await page.evaluate(() => document.querySelector('[data-number=speed]').checkValidity()), false, 'out of its range');
  await page.fill('[data-number=speed]', '0.1');
  await page.fill('[data-number=track]', '121');
  await page.click('#numbers-form .primary');
  await page.click('#numbers-read');
  await until(page, () => document.querySelector('[data-number=track]').value === '121');
  await shot(page, '7-numbers');
  await planTo(page);
  await until(page, () => window.wmr.state.plan);
  await page.click('#drive-now');
  await page.waitForSelector('#result', { timeout: 60_000 });
  const { run, plan } = await state(page);
  assert.ok(run.report.duration > 0.8 * (plan.length / 0.1), 'no faster than it was told');
});

onPage('six courses calibrate the base, step by step', async (page) => {
  await toBase(page);
  await page.click('#calibrate-details summary');
  await page.fill('#calibrate-side', '0.5');
  for (let course = 1; course <= 6; course += 1) {
    await page.click(`#calibrate-drive >> text=Drive course ${course} of 6`);
    await page.waitForSelector(`#calibrate-list li:nth-child(${course}) small:not(:empty)`, { timeout: 60_000 });
  }
  await page.click('#calibrate-drive >> text=Give the lengths');
  await page.waitForSelector('#calibrate-found:not([hidden])');
  const rms = await page.locator('#calibrate-found tbody tr:last-child td').allInnerTexts();
  assert.ok(parseFloat(rms[1]) <= parseFloat(rms[0]), `${rms}`);
  await page.locator('#calibrate-found').scrollIntoViewIfNeeded();
  await shot(page, '7-calibrated');
}, { speed: 20 });

onPage('a wheel that is held fast ends the drive with a fault, and nothing moves the robot from there', async (page) => {
  await openSample(page);
  await toBase(page);
  await page.click('#faults-details summary');
  await page.selectOption('#fault-blocked', 'left');
  await page.waitForSelector('#faults-on:not([hidden])');
  await driveTo(page, '#drive-problem:not([hidden])');
  await atRest(page);
  assert.equal((await state(page)).run.report.reached, false);
  await toBase(page);
  await page.click('#faults-none');
  await page.waitForSelector('#faults-on', { state: 'hidden' });
  await driveTo(page, '#result:not(.missed)');
  assert.equal((await state(page)).run.report.reached, true);
});

onPage('frames on the link are shown as they are said and as bytes', async (page) => {
  await toBase(page);
  await page.click('#frames-details summary');
  await page.waitForSelector('#frames li');
  await until(page, () => /Telemetry/.test(document.getElementById('frames').textContent) && /Heartbeat/.test(document.getElementById('frames').textContent));
  await page.check('#frames-raw');
  await until(page, () => /^([0-9a-f]{2} )+00$/.test(document.querySelector('#frames span').textContent));
  await page.locator('#frames').scrollIntoViewIfNeeded();
  await shot(page, '7-frames');
});

onPage('past drives are listed, opened, downloaded and planned again', async (page) => {
  await openSample(page);
  await driveTo(page);
  const { run, plan } = await state(page);
  await page.click('#runs-details summary');
  await page.click('[data-run=run-0001]');
  await page.waitForSelector('#past:not([hidden])');
  const trail = await page.locator('.trail').evaluate(({ points }) => points.length);
  assert.ok(trail > 20, `${trail}`);
  assert.equal(await page.locator('#past .plot').count(), 2);
  await shot(page, '8-past');
  const download = page.waitForEvent('download');
  await page.click('#past .downloads a >> text=Report');
  const report = JSON.parse(readFileSync(await (await download).path(), 'utf8'));
  assert.deepEqual(report.pose, run.report.pose);
  await page.click('#past-close');
  await page.waitForSelector('#past', { state: 'hidden' });
  await page.click('[data-run=run-0001]');
  await page.click('#past-again');
  await until(page, (length) => window.wmr.state.step === 'plan' && Math.abs((window.wmr.state.plan?.length ?? 0) - length) < 1e-9, plan.length);
});

/** A robot in a process of its own, until its test is over. */
async function robotBehind(args, ready) {
  const robot = spawn(PROGRAM, ['sim', ...args]);
  const ended = once(robot, 'exit');
  let said = '';
  await new Promise((resolve, reject) => {
    robot.stderr.on('data', (data) => { said += data; if (ready(said)) resolve(); });
    ended.then(() => reject(new Error(`wmr sim has ended: ${said}`)));
  });
  return async () => { robot.kill('SIGKILL'); await ended; };
}

test('a robot behind a pseudo-terminal is connected and driven from the page', { skip: process.platform === 'win32' }, async () => {
  const folder = mkdtempSync(`${tmpdir()}/wmr-pty-`);
  const end = await robotBehind(['--pty', `${folder}/robot`], () => existsSync(`${folder}/robot`));
  await the.server.kill();
  the.server = await serve({ port: `${folder}/robot` });
  const page = await open(the.server);
  await openSample(page);
  await planTo(page, NEAR);
  await until(page, () => window.wmr.state.plan);
  await page.click('#drive-now');
  await page.waitForSelector('#result', { timeout: 60_000 });
  const { run, base } = await state(page);
  assert.equal(run.report.reached, true);
  assert.equal(run.report.true_pose, undefined, 'nobody knows it');
  assert.equal(base.port, `${folder}/robot`);
  // From there to the simulated one.
  await toBase(page);
  await page.selectOption('#port', 'sim');
  await page.click('#connect .primary');
  await until(page, () => window.wmr.state.base.port === 'sim' && window.wmr.state.base.connected);
  await page.context().close();
  await end();
  rmSync(folder, { recursive: true });
});

test('the flashed firmware in the emulator is driven from the page', { skip: existsSync(ELF) ? false : 'firmware/build has not been run' }, async () => {
  await the.server.kill();
  the.server = await serve({ port: `elf:${ELF}`, speed: 1 });
  const page = await open(the.server);
  await openSample(page);
  await planTo(page, NEAR);
  await until(page, () => window.wmr.state.plan);
  await page.click('#drive-now');
  await page.waitForSelector('#result', { timeout: 110_000 });
  const { run } = await state(page);
  assert.equal(run.report.reached, true);
  assert.equal(run.report.collisions, 0);
  await page.context().close();
});
