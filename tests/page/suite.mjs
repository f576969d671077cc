// A browser for a file of tests, and a program of its own for each of them.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { close, launch, open, serve } from './browser.mjs';

/** The program of the test under way. */
export const the = { server: null };

before(launch);
after(close);
beforeEach(async () => { the.server = await serve(); });
afterEach(() => the.server.kill());

/** A test on a page that must not fail or ask anybody else; `options` are those of the page, and the speed of the
 * simulated robot. */
export function onPage(name, body, options = {}) {
  test(name, async () => {
    if (options.speed) {
      await the.server.kill();
      the.server = await serve(options);
    }
    const page = await open(the.server, options);
    await body(page);
    assert.deepEqual(page.errors, []);
    assert.deepEqual(page.foreign, [], 'works without a network');
    await page.context().close();
  });
}
