// How fast the page plays ten recorded minutes at 90 Hz: speed.mjs PAGE NATIVE_RECORDING FOLDER [SECONDS]
//
// Prints pictures a second and the longest, which the processor draws here, and the page's own work in a frame beside
// them: what a frame costs where a graphics card draws. Asserts on that (processor time, so that a busy machine does not
// count), on no layout shift, and on a page that stays live while it reads; on pictures a second only where the machine
// has nothing else to do.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {loadavg, cpus} from 'node:os';
import {join} from 'node:path';
import {emptyFolder, openBrowser, openPage, openRecording, pageFile, quantile} from './browser.mjs';

const [pages, native, folder, seconds = '600'] = process.argv.slice(2);
const BUDGET = 1000 / 60;  // milliseconds
emptyFolder(folder);
execFileSync(native, [folder, seconds]);
const idle = loadavg()[0] < 0.5 * cpus().length;
const browser = await openBrowser();
const {page, errors} = await openPage(browser, pageFile(pages, '?play=0'), {viewport: {width: 1280, height: 800}});
const session = await page.context().newCDPSession(page);

/** What the page's frames cost while `body` runs: milliseconds between pictures, and processor time of each frame's script. */
async function measured(body) {
  const events = [];
  session.on('Tracing.dataCollected', ({value}) => {
    for (const event of value) if (event.name === 'FireAnimationFrame' && event.tdur !== undefined) events.push(event.tdur / 1000);
  });
  await session.send('Tracing.start', {traceConfig: {includedCategories: ['devtools.timeline']}, transferMode: 'ReportEvents'});
  await page.evaluate(() => { inspector.costs.count = 0; });
  const begin = Date.now();
  await body();
  const wall = (Date.now() - begin) / 1000;
  const complete = new Promise((resolve) => session.once('Tracing.tracingComplete', resolve));
  await session.send('Tracing.end');
  await complete;
  session.removeAllListeners('Tracing.dataCollected');
  const costs = await page.evaluate(() => {
    const {between, work, count} = inspector.costs;
    return {between: [...between.slice(1, count)], work: [...work.slice(0, count)]};
  });
  return {...costs, script: events, rate: costs.between.length / wall};
}

const print = (what, {between, work, script, rate}) => console.log(
  `${what}: ${between.length} pictures, ${rate.toFixed(1)} a second, longest ${Math.max(...between).toFixed(0)} ms; script ` +
  `median ${quantile(script, 0.5).toFixed(2)} ms, p99 ${quantile(script, 0.99).toFixed(2)} ms of processor, ` +
  `${quantile(work, 0.5).toFixed(2)} and ${quantile(work, 0.99).toFixed(2)} ms by the clock`);

await page.evaluate(() => {
  globalThis.shifts = 0;
  new PerformanceObserver((list) => { for (const entry of list.getEntries()) shifts += entry.value; })
    .observe({type: 'layout-shift', buffered: true});
});
const begin = Date.now();
const reading = await measured(() => openRecording(page, join(folder, 'museum.jsonl')));
const frames = await page.evaluate(() => inspector.player.source.walk.length);
console.log(`${frames} frames read in ${((Date.now() - begin) / 1000).toFixed(2)} s`);
print('reading', reading);

await page.waitForTimeout(1500);
const played = await measured(async () => {
  await page.evaluate(() => inspector.player.play(true));
  await page.waitForTimeout(20_000);
});
print('played', played);
const at = await page.evaluate(() => inspector.player.time);

await page.selectOption('#speed', '10');
await page.selectOption('#span', '60');
const fast = await measured(() => page.waitForFunction(() => !inspector.player.playing, null, {timeout: 180_000}));
print('the rest at ten times the speed, charts of a minute', fast);
assert.equal(await page.evaluate(() => inspector.player.frame), frames - 1, 'played to the end');

const shifts = await page.evaluate(() => shifts);
console.log(`layout shifts: ${shifts}; load of the machine before: ${loadavg()[0].toFixed(1)} on ${cpus().length} cores`);
assert.ok(frames >= 90 * Number(seconds) - 1);
assert.ok(at > 18 && at < 23, `20 s at the speed of life lead to ${at} s`);
assert.equal(shifts, 0);
assert.deepEqual(errors, []);
for (const run of [played, fast]) {
  assert.ok(run.script.length > 50);
  assert.ok(quantile(run.script, 0.99) < BUDGET, `script takes more than ${BUDGET.toFixed(1)} ms`);
}
if (idle) assert.ok(played.rate > 30, 'fewer than 30 pictures a second, drawn by the processor, on a machine with nothing else to do');
await browser.close();
