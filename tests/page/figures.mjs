// The page's figures for the README, which a test is too short for:
//   cargo build --release && tests/page/run && WMR_PROGRAM=target/release/wmr node tests/page/figures.mjs

import { readFileSync, readdirSync, statSync } from 'node:fs';
import { loadavg } from 'node:os';
import { gzipSync } from 'node:zlib';
import { PROGRAM, SAMPLE, close, launch, open, openSample, planTo, post, serve } from './browser.mjs';

const say = (what, values) => console.log(`${what}: ${values}`);
const middle = (list) => [...list].sort((one, other) => one - other)[Math.floor(list.length / 2)];
const most = (list) => Math.max(...list);
const spread = (list) => `${middle(list).toFixed(0)} ms median, ${most(list).toFixed(0)} at most`;
const wait = (milliseconds) => new Promise((resolve) => { setTimeout(resolve, milliseconds); });

say('load of this computer before', loadavg()[0].toFixed(1));
const sources = new URL('../../host/src/dashboard/page/', import.meta.url);
const size = readdirSync(sources).reduce((sum, name) => sum + gzipSync(readFileSync(new URL(name, sources))).length, 0);
say('page, compressed', `${(size / 1000).toFixed(0)} kB`);
say('program', `${(statSync(PROGRAM).size / 1e6).toFixed(1)} MB`);

const server = await serve({ speed: 1 });
await launch();
const page = await open(server);
const usable = [];
for (let i = 0; i < 5; i += 1) {
  await page.reload();
  usable.push(await page.evaluate(() => performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd));
}
say('page usable after', spread(usable));

await openSample(page);
const looks = await page.evaluate(async (goal) => {
  const { recognise, replan, usePhoto } = await import('/page/actions.js');
  const { state } = window.wmr;
  const picture = await createImageBitmap(await (await fetch('/api/photo')).blob());
  const canvas = new OffscreenCanvas(1280, 960);
  canvas.getContext('2d').drawImage(picture, 0, 0, 1280, 960);
  const photo = await canvas.convertToBlob({ type: 'image/jpeg', quality: 0.95 });
  const times = [];
  for (let i = 0; i < 10; i += 1) {
    const began = performance.now();
    await usePhoto(photo);
    await recognise();
    const seen = performance.now() - began;
    state.goal = [...goal, null];
    await replan();
    times.push([seen, performance.now() - began]);
  }
  return times;
}, SAMPLE.goal);
say('photo of 1280 x 960 to outlines', spread(looks.map(([seen]) => seen)));
say('and to the path', spread(looks.map(([, planned]) => planned)));

const plans = await page.evaluate(async () => {
  const { replan, timing } = await import('/page/actions.js');
  const { state } = window.wmr;
  timing.plan.length = 0;
  const last = state.scene.obstacles.length - 1;
  const [x0, y0, x1, y1] = state.scene.obstacles[last];
  for (let i = 0; i < 200; i += 1) {
    state.scene.obstacles[last] = [x0 + i * 1e-4, y0, x1 + i * 1e-4, y1];
    await replan();
    await new Promise(requestAnimationFrame);
  }
  return timing.plan;
});
const within = plans.filter((time) => time <= 33).length / plans.length;
say('a box dragged, planned again', `${spread(plans)}, ${(100 * within).toFixed(0)} % within 33 ms`);

// Esc with the focus here and there, to the frame with the stop on the wire: the frames have the time of the
// simulated robot, which passes as the clock does; when theirs began is known from the latest one.
const live = async () => (await fetch(`http://${server.host}/api/state`)).json();
const frames = async () => (await (await fetch(`http://${server.host}/api/frames?t=${server.token}`)).json()).frames;
await page.evaluate(() => {
  addEventListener('keydown', ({ key }) => { if (key === 'Escape') window.pressed = Date.now(); }, { capture: true });
});
const [wire, said, ages] = [[], [], []];
const focuses = ['#stop', '#goal-x', '#planner', '#preview', '[data-step=photo]'];
for (let i = 0; i < 20; i += 1) {
  await page.click('[data-step=plan]');
  if (!(await live()).plan?.waypoints) await planTo(page);
  await page.waitForFunction(() => !document.getElementById('drive-now').disabled);
  await page.click('#drive-now');
  await page.waitForFunction(() => window.wmr.state.drive.active && window.wmr.state.drive.time > 0.5);
  for (let k = 0; k < 5; k += 1) {
    await page.waitForFunction((last) => window.wmr.state.drive.time !== last, await page.evaluate(() => window.wmr.state.drive.time));
    ages.push(1000 * await page.evaluate(() => window.wmr.state.base.age));
  }
  await page.click('[data-step=plan]');
  await page.focus(focuses[i % focuses.length]);
  let begin = Infinity;
  for (let k = 0; k < 20; k += 1) {
    const list = await frames();
    begin = Math.min(begin, Date.now() - 1000 * list.at(-1).t);
  }
  await page.keyboard.press('Escape');
  let stop;
  do stop = (await frames()).find(({ said: words, to_robot: out }) => out && words.startsWith('Stop')); while (!stop);
  wire.push(begin + 1000 * stop.t - await page.evaluate(() => window.pressed));
  let now;
  do now = await live(); while (now.base.state !== 'stopped' || now.drive.active);
  said.push(Date.now() - await page.evaluate(() => window.pressed));
}
say('Esc to the stop on the wire', spread(wire));
say('Esc to the word of the robot that it stops, drive over', spread(said));
say('pose on the page at 10 Hz, its age when it comes', spread(ages));

const used = () => {
  const [user, system] = readFileSync(`/proc/${server.pid}/stat`, 'utf8').split(' ').slice(13, 15).map(Number);
  return (user + system) * 10;
};
const share = async (seconds) => {
  const before = used();
  await wait(1000 * seconds);
  return (used() - before) / (10 * seconds);
};
const alone = await share(10);
await page.evaluate(([host, token]) => {
  window.many = Array.from({ length: 50 }, () => new WebSocket(`ws://${host}/ws?t=${token}`));
}, [server.host, server.token]);
await wait(1000);
const together = await share(20);
say('50 sockets at 10 Hz', `${together.toFixed(1)} % of a core, ${alone.toFixed(1)} % without them`);
say('load of this computer after', loadavg()[0].toFixed(1));
await close();
await server.stop();
