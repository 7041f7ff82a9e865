// The page as the daemon serves it, walking there: daemon.mjs PAGE FOREWALK SCENE FOLDER [SECONDS]
//
// It walks for a while and shows what the daemon recorded; the daemon is killed, the page says so and keeps what it has;
// another daemon with the same key takes its place, and the walk goes on without a jump. Then the same with an access
// token, which the page asks for.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {readdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {createInterface} from 'node:readline';
import {emptyFolder, jsonLines, openBrowser, openPage} from './browser.mjs';

const [pages, forewalk, scene, folder, seconds = '30'] = process.argv.slice(2);
emptyFolder(folder);
writeFileSync(join(folder, 'key'), '0123456789abcdef0123456789abcdef\n');
writeFileSync(join(folder, 'token'), 'let-me-in-please-0123456789\n');

async function serve(port, more = []) {
  const child = spawn(forewalk, ['serve', scene, '--port', String(port), '--inspector', pages, '--key-file',
    join(folder, 'key'), '--record', folder, '--log', 'warning', ...more], {stdio: ['ignore', 'pipe', 'inherit']});
  for await (const line of createInterface({input: child.stdout})) return {child, address: line, port: Number(line.split(':').pop())};
  throw new Error('forewalk serve did not start');
}
const ended = (child) => new Promise((resolve) => child.once('exit', resolve));
const walkOf = (page) => page.evaluate(() => {
  const {walk} = inspector.player.source;
  return {length: walk.length, duration: walk.duration, session: walk.head.session, virtual: walk.walkedVirtual[walk.length - 1]};
});

const browser = await openBrowser();
let daemon = await serve(0);
try {
  const {page, errors} = await openPage(browser, `${daemon.address}/?play=1`);
  assert.equal(await page.inputValue('#scene'), 'daemon', 'walks at the daemon of itself');
  const least = 0.5 * Number(seconds);  // a machine that does other things too walks slower
  await page.waitForTimeout(1000 * Number(seconds));
  await page.waitForFunction((time) => inspector.player.source.walk.duration > time, least, {timeout: 60_000});
  const before = await walkOf(page);
  console.log(`walked ${before.virtual.toFixed(1)} m in ${before.length} frames at the daemon, ${seconds} s by the clock`);
  assert.ok(before.virtual > 0.3 * least);
  assert.deepEqual(errors, []);

  daemon.child.kill('SIGKILL');
  await ended(daemon.child);
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice p'), /daemon is gone.*stays/);
  const kept = await walkOf(page);
  assert.ok(kept.length >= before.length);
  // What it has can be looked at meanwhile.
  await page.evaluate(() => { inspector.player.play(false); inspector.seek(5); });
  await page.waitForFunction(() => inspector.graph?.nodes.length > 1 && Math.abs(inspector.player.time - 5) < 0.02);

  daemon = await serve(daemon.port);
  await page.click('#notice button:first-child');
  await page.waitForSelector('#notice', {state: 'hidden'});
  await page.evaluate(() => { inspector.seek(Infinity); inspector.player.play(true); });
  await page.waitForFunction((length) => inspector.player.source.walk.length > length + 90, kept.length, {timeout: 30_000});
  const steps = await page.evaluate((from) => {
    const {walk} = inspector.player.source;
    let longest = 0;
    for (let i = from; i < from + 90; ++i) {
      longest = Math.max(longest, Math.hypot(walk.virtual[7 * i] - walk.virtual[7 * i - 7], walk.virtual[7 * i + 2] - walk.virtual[7 * i - 5]));
    }
    return longest;
  }, kept.length - 10);
  console.log(`killed and reconnected: the walk goes on from frame ${kept.length}, no step longer than ${(1000 * steps).toFixed(0)} mm`);
  assert.ok(steps < 0.05);
  assert.equal((await walkOf(page)).session, kept.session, 'and the session keeps its name');

  // What the page shows is what the daemon recorded: a killed one loses at most its last 100 ms.
  await page.evaluate(() => inspector.player.play(false));
  const recorded = readdirSync(folder).filter((name) => name.startsWith(kept.session) && name.endsWith('-0.jsonl'));
  assert.equal(recorded.length, 1);
  const lines = jsonLines(join(folder, recorded[0])).slice(1);
  const same = await page.evaluate((answers) => answers.filter((answer, i) => {
    const {walk} = inspector.player.source;
    return answer.position.every((value, k) => Math.fround(value) === walk.virtual[7 * i + k]) &&
      Math.fround(answer.gains.rotation) === walk.rotation[i] && answer.reset.count === walk.resets[i];
  }).length, lines.map((line) => line.out));
  console.log(`${same} of ${lines.length} recorded frames are those that the page has`);
  assert.equal(same, lines.length);
  assert.ok(lines.length > kept.length - 30);
  await page.close();
  daemon.child.kill('SIGTERM');
  await ended(daemon.child);

  daemon = await serve(0, ['--token-file', join(folder, 'token')]);
  const guarded = await browser.newPage();
  await guarded.goto(`${daemon.address}/?play=1`);
  await guarded.waitForSelector('#access[open]');
  await guarded.fill('#access-token', 'let-me-in-please-0123456789');
  await guarded.click('#access button[value="use"]');
  await guarded.waitForFunction(() => globalThis.inspector?.player.source?.walk.length > 90, null, {timeout: 30_000});
  assert.equal(await guarded.inputValue('#scene'), 'daemon');
  console.log('with the access token it walks, too');
} finally {
  daemon.child.kill('SIGKILL');
  await browser.close();
}
