// The page's figures for the README, which a test is too short for:
//   cargo build --release && tests/page/run && WMR_PROGRAM=target/release/wmr node tests/page/figures.mjs

import { readFileSync, readdirSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { SAMPLE, close, launch, open, openSample, post, serve } from './browser.mjs';

const say = (what, values) => console.log(`${what}: ${values}`);
const middle = (list) => [...list].sort((one, other) => one - other)[Math.floor(list.length / 2)];
const most = (list) => Math.max(...list);
const wait = (milliseconds) => new Promise((resolve) => { setTimeout(resolve, milliseconds); });

const sources = new URL('../../host/src/dashboard/page/', import.meta.url);
const size = readdirSync(sources).reduce((sum, name) => sum + gzipSync(readFileSync(new URL(name, sources))).length, 0);
say('page, compressed', `${(size / 1000).toFixed(0)} kB`);

const server = await serve({ speed: 1 });
await launch();
const page = await open(server);
await page.reload();
say('page usable after', `${(await page.evaluate(() => performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd)).toFixed(0)} ms`);

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
say('photo of 1280 x 960 to outlines', `${middle(looks.map(([seen]) => seen)).toFixed(0)} ms`);
say('and to the path', `${middle(looks.map(([, planned]) => planned)).toFixed(0)} ms median, ${most(looks.map(([, planned]) => planned)).toFixed(0)} at most`);

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
say('a box dragged, planned anew', `${middle(plans).toFixed(0)} ms median, ${most(plans).toFixed(0)} at most`);

const live = async () => (await fetch(`http://${server.host}/api/state`)).json();
const stops = [];
for (let i = 0; i < 10; i += 1) {
  await post(server, 'drive', {});
  let now;
  do now = await live(); while (now.drive.time < 0.5 || !now.drive.active);
  const began = performance.now();
  await post(server, 'stop');
  do now = await live(); while (now.base.state !== 'stopped');
  stops.push(performance.now() - began);
  do now = await live(); while (now.drive.active);
}
say('STOP until the robot has said that it stops', `${middle(stops).toFixed(0)} ms median, ${most(stops).toFixed(0)} at most`);

const used = () => {
  const [user, system] = readFileSync(`/proc/${server.pid}/stat`, 'utf8').split(' ').slice(13, 15).map(Number);
  return (user + system) * 10;
};
await page.evaluate(([host, token]) => {
  window.many = Array.from({ length: 50 }, () => new WebSocket(`ws://${host}/ws?t=${token}`));
}, [server.host, server.token]);
await wait(1000);
const before = used();
await wait(20_000);
say('50 sockets at 10 Hz', `${((used() - before) / 200).toFixed(1)} % of a core`);
await close();
await server.stop();
