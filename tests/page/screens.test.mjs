// Every screen, large and small, light and dark: for all to read, nothing too wide, STOP in view.

import { onPage } from './suite.mjs';
import { assertLegible, openSample, planTo, until } from './browser.mjs';

for (const colorScheme of ['light', 'dark']) {
  for (const [width, height] of [[1440, 900], [768, 1024], [360, 740]]) {
    onPage(`every step is legible to all at ${width} pixels, ${colorScheme}`, async (page) => {
      const check = (name) => assertLegible(page, `${name}-${width}-${colorScheme}`);
      await check('0-welcome');
      await openSample(page);
      await page.click('#boxes li:first-child button');
      await check('2-recognised');
      await page.click('[data-step=photo]');
      await page.click('#reading-details summary');
      await check('1-photo');
      await page.click('[data-step=boxes]');
      await planTo(page);
      await until(page, () => window.wmr.state.plan);
      await page.click('#grid-details summary');
      await check('3-plan');
      await page.click('#drive-now');
      await page.waitForSelector('#progress:not([hidden])');
      await check('4-drive');
      await page.waitForSelector('#result');
      await check('5-report');
      await page.click('#runs-details summary');
      await page.click('[data-run]');
      await page.waitForSelector('#past:not([hidden])');
      await check('8-past');
      await page.click('[data-step=base]');
      await check('7-base');
      for (const name of ['numbers', 'calibrate', 'faults', 'frames']) await page.click(`#${name}-details summary`);
      await page.waitForSelector('[data-number]');
      await check('7-base-open');
      await page.click('[data-step=boxes]');
      await page.click('[data-panel=boxes] [data-steps]');
      await page.waitForSelector('#steps-dialog[open]');
      await check('6-steps');
    }, { width, height, colorScheme });
  }
}
