// Enter VR in headless Chromium with an emulated headset: node vr.mjs BUILD
//
// A simulated person (src/walker.ts) wears the headset and walks, seeing only the session's virtual pose: 100 m of
// virtual path through the museum in 5 m x 5 m, and a while in each of the scanned rooms. The head never leaves the
// room, the virtual path never leaves the floor, prompts are there exactly during resets, and what three.js renders
// from is the session's pose.
import assert from 'node:assert/strict';
import {openBrowser} from './browser.mjs';
import {enter, openPage, walk} from './vr_page.mjs';

const [build, only = ''] = process.argv.slice(2);
const browser = await openBrowser();

function report(name, told) {
  const range = ([low, high]) => `${low.toFixed(2)} to ${high.toFixed(2)}`;
  const {gains, script, draw} = told;
  console.log(`${name}: ${told.virtual.toFixed(1)} m virtual, ${told.physical.toFixed(1)} m physical, ${told.resets} ` +
    `resets (${(100 * told.resets / told.virtual).toFixed(1)} per 100 m, ${told.backs} with steps back)`);
  console.log(`  never nearer than ${(1000 * told.inside).toFixed(0)} mm to a wall or furniture, ` +
    `${(1000 * told.beside).toFixed(1)} mm beside the floor; walk ${told.hash.toString(16)}`);
  console.log(`  gains: translation ${range(gains.translation)}, rotation ${range(gains.rotation)}, ` +
    `curvature ${range(gains.curvature)}`);
  console.log(`  ${told.frames} frames in ${told.wall.toFixed(0)} s, ` +
    `${(told.frames / told.wall).toFixed(0)} a second; ours of one: median ${script[0].toFixed(2)}, p99 ${script[2].toFixed(2)}, worst ${script[3].toFixed(0)} ms; ` +
    `drawing: median ${draw[0].toFixed(1)}, p99 ${draw[1].toFixed(1)} ms, ` +
    `${told.calls / 2} calls and ${told.triangles / 2} triangles an eye`);
}

function check(name, told, metres, most) {
  report(name, told);
  assert.deepEqual(told.wrong, [], `${name}: prompts are there exactly during resets`);
  assert.ok(told.virtual >= metres || told.finished, `${name}: walked`);
  assert.ok(told.inside > 0, `${name}: the head never leaves the room`);
  assert.ok(told.beside < 0.05, `${name}: the virtual path never leaves the floor`);
  assert.ok(told.rig < 1e-4 && told.eyes < 1e-4 && told.level === 0, `${name}: what is rendered is the session's pose`);
  assert.equal(told.gridFar, 0, `${name}: the border is shown where it is near`);
  assert.ok(told.resets > 0 && told.prompts > 0);
  assert.ok(told.resets < most / 100 * told.virtual, `${name}: nobody is stopped over and over in one place`);
  // Not the last percent: machines that do something else as well hold frames up.
  assert.ok(told.script[0] < 2 && told.script[1] < 1000 / 90, `${name}: frames leave time at 90 Hz`);
  assert.ok(told.calls / 2 <= 20);
}

const scenarios = {
  // Without a headset the button says why.
  async none() {
    const page = await openPage(browser, build, {headset: false});
    await page.waitForFunction(() => document.getElementById('enter-vr').title !== '');
    const {disabled, title} = await page.$eval('#enter-vr', ({disabled, title}) => ({disabled, title}));
    assert.ok(disabled && /No headset found\. .*emulator/.test(title), title);
    console.log(`without a headset: ${title}`);
    await page.close();
  },

  // A room drawn by keyboard and pointer: kept for the next time, and refused where it can't be walked in.
  async drawing() {
    const page = await openPage(browser, build, {side: 900});
    const state = () => page.textContent('.vr-dialog .state');
    const said = () => page.textContent('.room-said');
    await page.click('#enter-vr:enabled');
    await page.check('input[value="drawn"]');
    assert.match(await state(), /23\.0 m\u00b2/);
    await page.focus('.room-drawing');
    for (const key of ['n', 'Shift+ArrowRight', 'ArrowUp']) await page.keyboard.press(key);
    assert.match(await said(), /Corner 2 of 4: 3\.0 m right, 2\.4 m behind/);
    assert.match(await state(), /2[0-9.]+ m\u00b2/);
    await page.keyboard.press('Insert');
    assert.match(await said(), /Corner 3 of 5/);
    await page.keyboard.press('Delete');
    const box = await page.locator('.room-drawing').boundingBox();
    const at = (x, z) => [box.x + box.width * (0.5 + x / 7), box.y + box.height * (0.5 + z / 7)];  // 3.5 m to the edge
    await page.mouse.move(...at(0, -2.5));
    await page.mouse.down();  // on a wall: another corner, dragged across the room and out of it
    await page.mouse.move(...at(0, 3.2), {steps: 5});
    await page.mouse.up();
    assert.match(await said(), /of 5: 0\.0 m right, 3\.2 m behind/);
    assert.match(await state(), /Two walls cross/);
    assert.ok(await page.isDisabled('#vr-start'));
    await page.keyboard.press('Delete');
    assert.ok(await page.isEnabled('#vr-start'));
    const kept = await page.evaluate(() => JSON.parse(localStorage.getItem('forewalk.room')));
    assert.equal(kept.length, 4);
    await page.reload();
    await page.click('#enter-vr:enabled');
    await page.check('input[value="drawn"]');
    await page.focus('.room-drawing');
    await page.keyboard.press('p');
    assert.match(await said(), /Corner 4 of 4/);
    await page.fill('#vr-width', '0.2');
    await page.click('#vr-rectangle');
    assert.match(await state(), /1 to 50 m/);
    assert.deepEqual(page.errors, []);
    console.log('drawing a room: by keys and pointer, kept, refused where walls cross');
    await page.close();
  },

  async museum() {
    const page = await openPage(browser, build);
    await enter(page, {building: 'museum', room: 'drawn', sides: [5, 5]});
    check('museum, 5 m x 5 m', await walk(page, {metres: 100, drawn: 40}), 100, 25);
    assert.deepEqual(page.errors, []);
    await page.close();
  },

  // The headset's bounds, the headset put off and on, and the room set up anew.
  async bounds() {
    const border = [[-3, -2], [1.5, -2], [1.5, 0], [3, 0], [3, 2.5], [-3, 2.5]];
    const page = await openPage(browser, build, {bounds: border});
    await enter(page, {building: 'office', controller: 's2c-predictive', room: 'headset'});
    const area = await page.evaluate(() => vr.redirection.room.area);
    const said = 6 * 4.5 - 1.5 * 2 - 0.1 * 21;  // less a hand along 21 m of wall
    assert.ok(Math.abs(area - said) < 0.1, `the room is the headset's, less a margin: ${area} m^2`);
    await page.evaluate((corners) => vr.prepared.choice.room = {...vr.prepared.choice.room, border: corners}, border);
    check('office, an L of the headset', await walk(page, {metres: 15, drawn: 40}), 15, 60);

    const place = () => page.evaluate(() => vr.redirection.place());
    const apart = (a, b) => Math.hypot(a.floor[0] - b.floor[0], a.floor[2] - b.floor[2]);
    const before = await place();
    await page.evaluate(() => {
      device.updateVisibilityState('hidden');
      clock.step(1 / 90);
      device.position.set(-1.2, 1.65, 1.2);  // taken off, carried elsewhere, put on
      clock.step(20);
      device.updateVisibilityState('visible');
      clock.step(1 / 90);
    });
    assert.ok(apart(before, await place()) < 0.01, 'who puts the headset on elsewhere goes on where they were');
    const {same, black} = await page.evaluate(() => {
      const session = vr.redirection;
      device.recenter();
      clock.step(1 / 90);
      return {same: vr.redirection === session, black: vr.fade.visible};
    });
    assert.ok(!same && black, 'a room set up anew is another session, faded in');
    assert.ok(apart(before, await place()) < 0.5, 'at the same place of the building');

    // Lost tracking is black, and no walk; the session goes on when it is found again.
    const dark = await page.evaluate(() => {
      const {getViewerPose} = XRFrame.prototype;
      const shades = [], frame = vr.redirection.frame;
      for (let i = 0; i < 90; ++i) clock.step(1 / 90);
      shades.push(vr.fade.visible);
      XRFrame.prototype.getViewerPose = () => null;
      for (let i = 0; i < 45; ++i) clock.step(1 / 90);
      shades.push(vr.fade.material.opacity, vr.redirection.frame === frame);
      XRFrame.prototype.getViewerPose = getViewerPose;
      for (let i = 0; i < 45; ++i) clock.step(1 / 90);
      return [...shades, vr.fade.visible];
    });
    assert.deepEqual(dark, [false, 1, true, false]);

    // Where the headset says how the origin has moved, nobody sees anything, twice over; hands and controllers are in
    // the rig.
    const jumps = await page.evaluate(() => {
      const request = XRReferenceSpace.prototype.getOffsetReferenceSpace;
      XRReferenceSpace.prototype.getOffsetReferenceSpace = function({matrix}) {  // the emulator takes a matrix
        return request.call(this, matrix);
      };
      const base = vr.space;
      const own = Object.getOwnPropertySymbols(base).map((symbol) => base[symbol]).find((part) => part.offsetMatrix);
      const seen = [];
      let now = new XRRigidTransform();
      for (const [x, z, half] of [[0.7, -0.4, 0.5], [-0.3, 1.1, -1.2]]) {
        const before = Array.from(vr.redirection.frame.position);
        const transform = new XRRigidTransform({x, y: 0, z}, {x: 0, y: Math.sin(half), z: 0, w: Math.cos(half)});
        const matrix = vr.rig.matrix.clone().fromArray(now.matrix);
        matrix.multiply(vr.rig.matrix.clone().fromArray(transform.matrix));
        own.offsetMatrix.set(matrix.elements);
        now = {matrix: matrix.elements};
        base.dispatchEvent(new XRReferenceSpaceEvent('reset', {referenceSpace: base, transform}));
        clock.step(1 / 90);
        seen.push(Math.hypot(...before.map((value, i) => value - vr.redirection.frame.position[i])));
      }
      device.primaryInputMode = 'hand';
      for (let i = 0; i < 3; ++i) clock.step(1 / 90);
      const hands = vr.rig.getObjectByName('inputs').children.at(-1);
      return {seen, joints: hands.count, shown: hands.visible};
    });
    assert.ok(jumps.seen.every((metres) => metres < 1e-3), `moved origins are seen: ${jumps.seen}`);
    assert.deepEqual([jumps.joints, jumps.shown], [50, true]);
    await page.evaluate(() => vr.end());
    await page.waitForSelector('#enter-vr:enabled');
    assert.deepEqual(page.errors, []);
    await page.close();
  },

  // Bounds that can't be used are said, and the drawn room is walked in.
  async fallback() {
    const cases = [
      [null, /says no bounds/],
      [[[0, 0], [1.5, 0], [1.5, 4], [0, 4]], /1\.5 m x 4\.0 m; 2 m are needed/],
      [[[-2, -2], [2, 2], [2, -2], [-2, 2]], /Two walls cross/],
    ];
    for (const [bounds, reason] of cases) {
      const page = await openPage(browser, build, {bounds});
      await enter(page, {building: 'maze', controller: 's2c', room: 'headset', sides: [4, 3]});
      const {area, notice, text} = await page.evaluate(() => {
        clock.step(1 / 90);
        clock.step(1 / 90);
        return {area: vr.redirection.room.area, notice: window.notice, text: vr.prompt.text};
      });
      assert.ok(Math.abs(area - 3.8 * 2.8) < 0.01 && reason.test(notice) && reason.test(text), `${notice} | ${text}`);
      assert.deepEqual(page.errors, []);
      await page.close();
    }
    console.log('bounds that are absent, too small or crossing: said, and the drawn room is walked in');
  },
};
for (const room of ['living room', 'meeting room', 'music room', 'office large', 'office small']) {
  scenarios[room] = async () => {
    const page = await openPage(browser, build);
    await enter(page, {building: 'museum', room});
    check(`museum, ${room}`, await walk(page, {metres: 20, drawn: 60}), 20, 80);
    assert.deepEqual(page.errors, []);
    await page.close();
  };
}

try {
  for (const name of Object.keys(scenarios)) if (name.startsWith(only)) await scenarios[name]();
} finally {
  await browser.close();
}
