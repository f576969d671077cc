// Whether program and page keep their size over hours of the simulated robot with the page open:
//   WMR_PROGRAM=target/release/wmr node tests/page/memory.mjs [HOURS [SPEED]]
// A drive begins every five minutes. Says each hour's sizes, and how far the last is from the first.

import { readFileSync } from 'node:fs';
import { SAMPLE, close, launch, open, openSample, planTo, serve } from './browser.mjs';

const [hours, speed] = [Number(process.argv[2] ?? 8), Number(process.argv[3] ?? 40)];
/** Simulated seconds from drive to drive, and from look to look. */
const [PERIOD, LOOK] = [300, 1800];

const server = await serve({ speed });
await launch();
const page = await open(server);
const devtools = await page.context().newCDPSession(page);
await openSample(page);
await planTo(page, SAMPLE.goal);
await page.waitForFunction(() => window.wmr.state.plan);

async function sizes() {
  await devtools.send('HeapProfiler.collectGarbage');
  const { usedSize } = await devtools.send('Runtime.getHeapUsage');
  const resident = Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server.pid}/status`, 'utf8'))[1]);
  return [resident / 1000, usedSize / 1e6];
}

const began = performance.now();
const elapsed = () => ((performance.now() - began) / 1000) * speed;
let drives = 0;
let driven = 0;
let first = null;
for (let look = 1; look * LOOK <= hours * 3600; look += 1) {
  while (elapsed() < look * LOOK) {
    await page.click('[data-step=plan]');
    await page.evaluate(async ([x, y, heading]) => {
      const { replan } = await import('/page/actions.js');
      window.wmr.state.start = [x, y, heading];
      window.wmr.state.goal = [0.996, 0.229, null];
      await replan();
    }, SAMPLE.robot);
    await page.waitForFunction(() => !document.getElementById('drive-now').disabled);
    await page.click('#drive-now');
    await page.waitForFunction((last) => window.wmr.state.run.revision > last && window.wmr.state.run.report, await page.evaluate(() => window.wmr.state.run.revision));
    driven += await page.evaluate(() => window.wmr.state.run.report.duration);
    drives += 1;
    await page.waitForTimeout(Math.max(1000 * (drives * PERIOD - elapsed()) / speed, 0));
  }
  const now = await sizes();
  // What is made once (caches, the browser's code) is there after the first hour.
  if (look * LOOK === 3600 || !first) first = now;
  console.log(`${(elapsed() / 3600).toFixed(1)} h, ${drives} drives of ${(driven / 60).toFixed(0)} min in all: program ${now[0].toFixed(1)} MB (${(100 * (now[0] / first[0] - 1)).toFixed(1)} %), page ${now[1].toFixed(2)} MB (${(100 * (now[1] / first[1] - 1)).toFixed(1)} %)`);
}
await close();
await server.kill();
