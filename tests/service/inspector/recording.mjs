// The page opened from disk, without a server, shows recordings: recording.mjs PAGE NATIVE_RECORDING FOLDER FOREWALK
//
// The graphs that it draws are those that the native library predicted when the walk was made, at every fifth second; a
// click on the floor names the polygon that the native library found there. What is no recording is refused in a
// sentence; what the page saves reads back to the same numbers, and a walk of its own is replayed by forewalk.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {emptyFolder, jsonLines, openBrowser, openPage, openRecording, pageFile} from './browser.mjs';

const [pages, native, folder, forewalk] = process.argv.slice(2);
emptyFolder(folder);
process.stdout.write(execFileSync(native, [folder, '60']));
const browser = await openBrowser();
const {page, errors, requests} = await openPage(browser, pageFile(pages, '?play=0'));

/** Shows a frame, and returns it with its graph's nodes. */
const show = (frame) => page.evaluate(async (wanted) => {
  const {walk} = inspector.player.source;
  inspector.seek(walk.time[wanted]);
  const drawn = () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  await drawn();
  return {
    frame: inspector.player.frame,
    nodes: inspector.graph?.nodes.map(({position, polygon}) => [...position, polygon]) ?? [],
  };
}, frame);

for (const name of ['museum', 'office', 'two_storey']) {
  const lines = jsonLines(join(folder, `${name}.jsonl`));
  await openRecording(page, join(folder, `${name}.jsonl`));
  assert.equal(await page.evaluate(() => inspector.player.source.walk.length), lines.length - 1);
  let nodes = 0, farthest = 0;
  // Backwards too: the graph depends on where the user is, not on how the page came there.
  const graphs = jsonLines(join(folder, `${name}.graphs.jsonl`));
  for (const graph of [...graphs, ...[...graphs].reverse()]) {
    const shown = await show(graph.frame);
    assert.equal(shown.frame, graph.frame);
    assert.equal(shown.nodes.length, graph.nodes.length, `${name}: nodes at frame ${graph.frame}`);
    shown.nodes.forEach((node, i) => {
      assert.equal(node[3], graph.nodes[i][3], `${name}: polygon of node ${i} at frame ${graph.frame}`);
      farthest = Math.max(farthest, ...[0, 1, 2].map((k) => Math.abs(node[k] - graph.nodes[i][k])));
    });
    nodes += graph.nodes.length;
  }
  console.log(`${name}: ${2 * graphs.length} graphs with ${nodes} nodes, the native ones within ${farthest.toExponential(1)} m`);
  assert.ok(graphs.length >= 6 && nodes > 6 * graphs.length && farthest <= 1e-4);

  // The page's numbers are the file's.
  const at = Math.floor(lines.length / 2);
  const {out} = lines[at + 1];
  const frame = await page.evaluate((i) => {
    const {walk} = inspector.player.source;
    return {
      position: [...walk.virtual.subarray(7 * i, 7 * i + 3)], gains: [walk.translation[i], walk.rotation[i], walk.curvature[i]],
      resets: walk.resets[i], border: walk.border[i], physical: [...walk.physical.subarray(7 * i, 7 * i + 3)],
    };
  }, at);
  assert.deepEqual(frame.position, out.position.map(Math.fround));
  assert.deepEqual(frame.gains, [out.gains.translation, out.gains.rotation, out.gains.curvature].map(Math.fround));
  assert.equal(frame.resets, out.reset.count);
  const [x, , z] = frame.physical;
  assert.ok(Math.abs(frame.border - Math.min(2.5 - Math.abs(x), 2.5 - Math.abs(z))) < 1e-5, 'in a room of 5 m x 5 m');

  // Clicks on the floor, where nodes in sight are.
  let clicks = 0;
  const {nodes: [user, ...others]} = await show(graphs[2].frame);
  // The camera follows: wait until it rests.
  for (let before = '', now = '-'; before !== now;) {
    before = now;
    await page.waitForTimeout(250);
    now = await page.evaluate(() => inspector.building.place([0, 0, 0]).join());
  }
  for (const [px, py, pz, polygon] of others) {
    if (Math.abs(py - user[1]) > 1) continue;  // on another storey, under this floor
    const spot = await page.evaluate(([x, y, z]) => {
      const canvas = document.getElementById('building-canvas');
      const box = canvas.getBoundingClientRect();
      const [right, up] = inspector.building.place([x, y, z]);
      const place = {x: box.left + (right + 1) / 2 * box.width, y: box.top + (1 - up) / 2 * box.height};
      return document.elementFromPoint(place.x, place.y) === canvas ? place : null;
    }, [px, py, pz]);
    if (!spot) continue;
    await page.mouse.click(spot.x, spot.y);
    const said = await page.textContent('#picked');
    // Ways by fronts part and end at walls, cut ways on edges: who clicks there may hear of the neighbour, or of none.
    if (said === 'No walkable floor here.' && name === 'office') continue;
    if (said.startsWith(`Polygon ${polygon} `)) ++clicks;
    assert.match(said, /^Polygon \d+ at .*portal/);
    const named = Number(said.split(' ')[1]);
    assert.ok(named === polygon || said.includes(`to ${polygon} (`), `${name}: ${said} but ${polygon} or a neighbour of it`);
  }
  console.log(`${name}: ${clicks} clicks name the node's polygon`);
  assert.ok(clicks >= 3);
}

// Scrubbing by the slider and by the keys.
await page.locator('#scrub').fill('12.5');
await page.waitForTimeout(100);
const scrubbed = await page.evaluate(() => [inspector.player.frame, inspector.player.source.walk.frameAt(12.5)]);
assert.equal(scrubbed[0], scrubbed[1]);
await page.locator('#scrub').blur();
await page.keyboard.press('ArrowRight');
await page.keyboard.press('ArrowRight');
await page.keyboard.press('ArrowLeft');
assert.equal(await page.evaluate(() => inspector.player.frame), scrubbed[0] + 1);

// What is saved is read back to the same numbers.
const saved = join(folder, 'saved.jsonl');
const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
await download.saveAs(saved);
const columns = () => page.evaluate(() => {
  const {walk} = inspector.player.source;
  let hash = 2166136261;
  for (const name of ['clock', 'physical', 'virtual', 'flags', 'translation', 'rotation', 'curvature', 'bending', 'injectedYaw',
    'injected', 'turning', 'instruction', 'remaining', 'turned', 'resets', 'nodes']) {
    const column = walk[name];
    const bytes = new Uint8Array(column.buffer, 0, column.byteLength / walk.time.length * walk.length);
    for (const byte of bytes) hash = Math.imul(hash ^ byte, 16777619);
  }
  return [walk.length, hash >>> 0];
});
const before = await columns();
await openRecording(page, saved);
assert.deepEqual(await columns(), before);
console.log(`saved and opened again: ${before[0]} frames, hash ${before[1].toString(16)} twice`);

// A walk of the page's own, as forewalk replays it.
await page.selectOption('#scene', 'museum');
await page.waitForFunction(() => inspector.player.source.live);
await page.evaluate(() => { for (let second = 1; second <= 20; ++second) inspector.player.source.reach(second); });
const [own] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
await own.saveAs(join(folder, 'own.jsonl'));
const scene = fileURLToPath(new URL('../../../assets/scenes/museum.obj', import.meta.url));
const replayed = spawnSync(forewalk, ['replay', join(folder, 'own.jsonl'), scene, '--answers', join(folder, 'answers.jsonl')]);
const answers = jsonLines(join(folder, 'answers.jsonl'));
const walked = jsonLines(join(folder, 'own.jsonl')).slice(1).map((line) => line.out);
assert.equal(answers.length, walked.length);
const off = Math.max(...walked.map((out, i) => Math.max(...[0, 1, 2].map((k) => Math.abs(out.position[k] - answers[i].position[k])))));
console.log(`walked in the page, replayed by forewalk: ${walked.length} frames, at most ${off.toExponential(1)} m off` +
  `${replayed.status === 0 ? ', all the same to the last bit' : ''}`);
assert.ok(walked.length > 1700 && off <= 1e-4);

// What is no recording.
const sentence = async (name, text) => {
  writeFileSync(join(folder, name), text);
  await page.setInputFiles('#file', join(folder, name));
  await page.waitForSelector('#notice:not([hidden])');
  const said = await page.textContent('#notice p');
  await page.click('#notice button:last-child');
  return said;
};
const whole = readFileSync(join(folder, 'office.jsonl'), 'utf8').split('\n');
assert.match(await sentence('walk.csv', 't,virtual_x\n0,1\n'), /^walk\.csv:1: this is not JSON: t,virtual_x/);
assert.match(await sentence('other.jsonl', '{"format":"forewalk.prediction/1"}\n'), /^other\.jsonl:1: .*forewalk\.prediction\/1.*forewalk\.session\/1/);
assert.match(await sentence('empty.jsonl', ''), /^empty\.jsonl: it is empty/);
assert.match(await sentence('head.jsonl', `${whole[0]}\n`), /^head\.jsonl: .*no frame/);
assert.match(await sentence('torn.jsonl', [...whole.slice(0, 3), '{"in":', ...whole.slice(4)].join('\n')), /^torn\.jsonl:4: this is not JSON/);
assert.match(await sentence('lacks.jsonl', `${whole[0]}\n{"in":{"seconds":0},"out":{}}\n`), /^lacks\.jsonl:2: this frame lacks/);
const elsewhere = JSON.parse(whole[0]);
elsewhere.scene = 'castle.obj';
elsewhere.navmesh = '0123456789abcdef';
assert.match(await sentence('castle.jsonl', [JSON.stringify(elsewhere), ...whole.slice(1, 9)].join('\n')),
  /castle\.obj.*Open its navmesh.*forewalk build/);
// A last line that is cut off is left out.
writeFileSync(join(folder, 'cut.jsonl'), whole.slice(0, 101).join('\n') + '\n{"in":{"sequ');
await openRecording(page, join(folder, 'cut.jsonl'));
assert.equal(await page.evaluate(() => inspector.player.source.walk.length), 100);

assert.deepEqual(errors, []);
assert.deepEqual(requests.filter((url) => !url.startsWith('file:') && !url.startsWith('blob:') && !url.startsWith('data:')), [], 'no server is asked');
console.log('7 files refused in a sentence; nothing was asked of a server; no error in the console');
await browser.close();
