// The inspector as the README shows it: pictures.mjs PAGE FOLDER, writes FOLDER/inspector_light.png and _dark.png
//
// A walk in the page through the museum, stopped at the same frame.
import assert from 'node:assert/strict';
import {statSync} from 'node:fs';
import {join} from 'node:path';
import {openBrowser, openPage, pageFile} from './browser.mjs';

const [pages, folder] = process.argv.slice(2);
const SECONDS = 72;
const browser = await openBrowser();
for (const colorScheme of ['light', 'dark']) {
  const {page} = await openPage(browser, pageFile(pages, '?play=0&scene=museum&controller=foresight&room=5x5&horizon=12'),
    {viewport: {width: 1440, height: 900}, colorScheme});
  await page.evaluate(async (seconds) => {
    const {walk} = inspector.player.source;
    for (let made = 1; made <= seconds * 90; made += 90) {
      inspector.player.source.reach(walk.duration + 1);
      inspector.seek(Infinity);
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    for (let i = walk.frameAt(seconds - 60); i < walk.length; i += 45) {
      inspector.seek(walk.time[i]);
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    inspector.seek(seconds);
    inspector.setSpan(Infinity);
  }, SECONDS);
  await page.waitForTimeout(6000);
  const file = join(folder, `inspector_${colorScheme}.png`);
  await page.screenshot({path: file});
  console.log(`${file}: ${(statSync(file).size / 1000).toFixed(0)} kB`);
  assert.ok(statSync(file).size < 300_000, 'small enough for a README');
  await page.close();
}
await browser.close();
