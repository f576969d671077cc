// A program, a browser and a page for each test, and how to point at the floor.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const root = fileURLToPath(new URL('../../', import.meta.url));
export const PROGRAM = resolve(process.env.WMR_PROGRAM ?? `${root}target/debug/wmr`);
/** The firmware as firmware/build leaves it. */
export const ELF = `${root}target/firmware/pico.elf`;
const shots = `${root}target/page/`;
mkdirSync(shots, { recursive: true });

/** The demo's photo: its arena, its obstacles as they were drawn, and a goal in it; metres. */
export const SAMPLE = {
  arena: [1.3, 1.55],
  obstacles: [
    [0.313, 0.233, 0.638, 0.653],
    [1.011, 0.505, 1.184, 0.664],
    [0.57, 0.704, 0.673, 0.808],
    [1.043, 1.094, 1.3, 1.374],
    [0.064, 0.855, 0.391, 1.276],
    [0.73, 0.991, 0.801, 1.469],
    [0.117, 0.439, 0.209, 0.582],
    [0.115, 1.363, 0.355, 1.527],
  ],
  robot: [0.163, 0.696, 1.521],
  goal: [0.996, 0.229],
};

/** Starts `wmr serve` with a simulated robot, at a free address or at `address`. */
export async function serve({ speed = 5, address = '127.0.0.1:0', port = 'sim', demo = false } = {}) {
  const log = mkdtempSync(`${tmpdir()}/wmr-page-`);
  const own = ['serve', '--addr', address, '--no-open', '--port', port, '--sim-speed', String(speed), '--log', log];
  // No desktop: nothing is to be opened on the computer of whoever runs the tests.
  const env = { ...process.env, DISPLAY: undefined, WAYLAND_DISPLAY: undefined };
  const child = spawn(PROGRAM, demo ? ['demo', '--page'] : own, { cwd: log, env });
  const ended = once(child, 'exit');
  let text = '';
  const url = await new Promise((resolve, reject) => {
    child.stderr.on('data', (data) => {
      text += data;
      const found = /http:\/\/\S+/.exec(text);
      if (found) resolve(found[0]);
    });
    ended.then(() => reject(new Error(`wmr serve has ended: ${text}`)));
  });
  const { host, searchParams } = new URL(url);
  return {
    url, host, token: searchParams.get('t'), pid: child.pid,
    kill: async () => { child.kill('SIGKILL'); await ended; rmSync(log, { recursive: true, force: true }); },
    stop: async () => { child.kill('SIGINT'); await ended; },
  };
}

let browser = null;
export async function launch() {
  browser = await chromium.launch({
    executablePath: process.env.WMR_CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream'],
  });
}
export const close = () => browser?.close();

/** Opens the page, fails on any error in it, and notes every request that leaves for elsewhere. */
export async function open(server, { width = 1280, height = 860, colorScheme = 'light' } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, hasTouch: width < 500, reducedMotion: 'reduce' });
  const page = await context.newPage();
  page.errors = [];
  page.foreign = [];
  page.on('pageerror', (error) => page.errors.push(error.stack));
  page.on('request', (request) => {
    const url = new URL(request.url());
    if (!['data:', 'blob:'].includes(url.protocol) && url.host !== server.host) page.foreign.push(request.url());
  });
  await page.goto(server.url);
  await page.waitForFunction(() => window.wmr?.state.base?.connected);
  return page;
}

export const shot = (page, name) => page.screenshot({ path: `${shots}${name}.png` });

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Whether all can read what is shown, nothing is too wide, and STOP is in view; with a screenshot. */
export async function assertLegible(page, name) {
  await page.evaluate(axe);
  const found = await page.evaluate(() => window.axe.run({ resultTypes: ['violations'] }));
  const serious = found.violations.filter(({ impact }) => ['serious', 'critical'].includes(impact));
  assert.deepEqual(serious.map(({ id, nodes }) => `${name}: ${id} ${nodes.map(({ html }) => html.slice(0, 120)).join(' | ')}`), []);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(wide <= 0, `${name} is ${wide} pixels too wide`);
  const stop = await page.locator('#stop').boundingBox();
  assert.ok(stop.x >= 0 && stop.x + stop.width <= page.viewportSize().width && stop.y >= 0, `${name}: STOP is in view`);
  await shot(page, name);
}

/** The README's picture. */
export const readmeShot = (page) => page.screenshot({ path: `${shots}readme.jpg`, type: 'jpeg', quality: 82 });

/** What the page shows. */
export const state = (page) => page.evaluate(() => structuredClone({ ...window.wmr.state }));

/** Waits for a condition, a function; says what the page shows if it does not hold in time, milliseconds. */
export async function until(page, condition, argument, timeout = 20_000) {
  // The page forbids text to be run, and a text that is looked at twice would be.
  assert.equal(typeof condition, 'function');
  try {
    await page.waitForFunction(condition, argument, { timeout });
  } catch (error) {
    const { step, start, goal, plan, planProblem, problem, base, drive, working, scene } = await state(page);
    const shown = { step, start, goal, length: plan?.length, planProblem, problem, base, drive, working, obstacles: scene?.obstacles };
    throw new Error(`never: ${condition}\n${error.message}\n${JSON.stringify(shown)}`, { cause: error });
  }
}

/** From nothing to the sample's outlines. */
export async function openSample(page) {
  await page.click('#try-sample');
  await page.waitForSelector('[data-panel=boxes]:not([hidden])');
}

/** Where a point of the floor is on the screen, between the corners that are shown; pictures from straight
 * above only. */
export function onScreen(page, at, size = SAMPLE.arena) {
  return page.evaluate(async ([[x, y], [width, height]]) => {
    // A person sees what is drawn, which is at most a frame behind the state.
    for (let frame = 0; frame < 2; frame += 1) await new Promise(requestAnimationFrame);
    const [left, , top] = [...document.querySelector('.floor-edge, .plain-floor').points];
    const matrix = document.getElementById('view').getScreenCTM();
    const [a, b] = [left, top].map((corner) => new DOMPoint(corner.x, corner.y).matrixTransform(matrix));
    return [a.x + (x / width) * (b.x - a.x), a.y + (y / height) * (b.y - a.y)];
  }, [at, size]);
}

export async function clickFloor(page, point, arena) {
  await page.mouse.click(...(await onScreen(page, point, arena)));
}

export async function dragFloor(page, from, to, arena) {
  await page.mouse.move(...(await onScreen(page, from, arena)));
  await page.mouse.down();
  await page.mouse.move(...(await onScreen(page, to, arena)), { steps: 8 });
  await page.mouse.up();
}

/** From the outlines to a plan that leads to `goal`. */
export async function planTo(page, goal = SAMPLE.goal, arena = SAMPLE.arena) {
  if (await page.locator('#to-plan').isVisible()) await page.click('#to-plan');
  else await page.click('[data-step=plan]');
  await clickFloor(page, goal, arena);
}

/** A request as a program sends it. */
export async function post(server, what, body, heads = {}) {
  return fetch(`http://${server.host}/api/${what}`, {
    method: 'POST',
    headers: { 'content-type': 'application/json', authorization: `Bearer ${server.token}`, ...heads },
    body: body === undefined ? undefined : JSON.stringify(body),
  });
}
