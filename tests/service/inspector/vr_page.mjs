// The page in headless Chromium with an emulated headset, whose frames are stepped by hand.
//
// The emulator (iwer) draws its frames from the page's requestAnimationFrame and tells the time by performance.now:
// both are the test's, so that a simulated second is 90 frames whatever the machine.
import {readFileSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pageFile} from './browser.mjs';
import {bundle, packageFile} from './vr_source.mjs';

const clock = () => {
  const frames = window.requestAnimationFrame.bind(window), stop = window.cancelAnimationFrame.bind(window);
  const now = performance.now.bind(performance);
  let queue = [], next = 1, time = null;
  window.realNow = now;
  window.requestAnimationFrame = (callback) => {
    if (time === null) return frames(callback);
    queue.push([next, callback]);
    return -next++;
  };
  window.cancelAnimationFrame = (handle) => handle < 0 ? queue = queue.filter(([id]) => id !== -handle) : stop(handle);
  performance.now = () => time ?? now();
  window.clock = {
    take() { time = 1e5; },  // ever the same, so that walks repeat to the bit
    step(seconds) {
      time += 1000 * seconds;
      const due = queue;
      queue = [];
      for (const [, callback] of due) callback(time);
    },
  };
};

/** Opens the built page with a Quest 3 and what the tests need of the page's modules, as `window.parts`. */
export async function openPage(browser, build, {headset = true, side = 320, bounds = null} = {}) {
  const page = await browser.newPage({viewport: {width: side, height: side}});
  page.errors = [];
  page.on('pageerror', (error) => page.errors.push(error.message));
  page.on('console', (message) => {
    if (message.type() === 'error') page.errors.push(message.text());
  });
  if (headset) {
    await page.addInitScript(clock);
    await page.addInitScript(readFileSync(packageFile('iwer/build/iwer.min.js'), 'utf8'));
    await page.addInitScript(await bundle(build, 'parts', 'walker.ts', 'ways.ts', 'room.ts', 'vr/room.ts'));
    await page.addInitScript((corners) => {
      window.device = new IWER.XRDevice(IWER.metaQuest3);
      window.device.installRuntime({forceInstall: true});
      if (corners) {  // the emulator has bounded-floor, but no bounds
        const request = XRSession.prototype.requestReferenceSpace;
        XRSession.prototype.requestReferenceSpace = async function(type) {
          const space = await request.call(this, type);
          if (type === 'bounded-floor') space.boundsGeometry = corners.map(([x, z]) => ({x, y: 0, z, w: 1}));
          return space;
        };
      }
      document.addEventListener('forewalk:vr', ({detail}) => window.vr = detail);
      document.addEventListener('forewalk:notice', ({detail}) => window.notice = detail);
    }, bounds);
  }
  await page.goto(pageFile(resolve(build, 'inspector/page'), '?play=0'));
  await page.waitForSelector('html[data-ready]', {timeout: 60_000, state: 'attached'});
  return page;
}

/** Chooses as a person would, and starts. `room`: 'headset', 'drawn', or the name of a scan. */
export async function enter(page, {building = 'museum', controller = 'foresight', room = 'drawn', sides = null}) {
  await page.click('#enter-vr:enabled');
  await page.selectOption('#vr-building', building);
  await page.selectOption('#vr-controller', controller);
  if (sides) {
    await page.fill('#vr-width', `${sides[0]}`);
    await page.fill('#vr-depth', `${sides[1]}`);
    await page.click('#vr-rectangle');
  }
  if (room === 'headset' || room === 'drawn') await page.check(`input[value="${room}"]`);
  else await page.selectOption('#vr-scan', {label: room});
  await page.evaluate(() => {
    window.vr = undefined;
    clock.take();
  });
  await page.click('#vr-start');
  await page.waitForFunction(() => window.vr);
}

/**
 * Walks the building's tour in the headset for `metres` of virtual path, or `seconds`; looks at everything in every
 * frame. Every `drawn`-th frame is drawn; with `until` it stops early: 'prompt' in the middle of a turn,
 * 'marker' toward its end.
 */
export const walk = (page, settings) => page.evaluate((given) => {
  const {metres = Infinity, seconds = Infinity, drawn = 10, until = null} = given;
  const {Walker, Ways, nearestBorder} = parts;
  const {renderer, camera} = vr;
  const {choice, navmesh} = vr.prepared;
  const state = window.walking ??= (() => {
    const [x, z] = vr.redirection.room.middle;
    return {
      vr,
      walker: new Walker(navmesh, {tour: choice.building.tour, loop: true, body: {right: x, forward: -z, heading: 0}}),
      ways: new Ways(navmesh.polygons()),
    };
  })();
  const {walker, ways} = state;
  const walls = {border: choice.room.border, holes: choice.room.obstacles};
  const nearest = {x: 0, z: 0, distance: 0};
  const gains = {translation: [9, -9], rotation: [9, -9], curvature: [9, -9]};
  const told = {frames: 0, seconds: 0, resets: 0, inside: Infinity, beside: 0, prompts: 0, wrong: [], rig: 0, level: 0,
    eyes: 0, gridFar: 0, hash: 0, scripts: [], draws: [], calls: 0, triangles: 0, backs: 0};
  const wrong = (what) => told.wrong.length < 5 && told.wrong.push(`frame ${told.frames}: ${what}`);
  const render = renderer.render;
  const bits = new DataView(new ArrayBuffer(4));
  let drawing = true, spent = 0, framed = 0, before = 'none';
  const {frame: step} = vr;
  vr.frame = (...given) => {  // what is ours of a frame: all but the emulator and the drawing
    const begin = realNow();
    step.apply(vr, given);
    framed = realNow() - begin - spent;
  };
  renderer.render = (scene, seen) => {
    const begin = realNow();
    if (drawing) render.call(renderer, scene, seen);
    spent = realNow() - begin;
  };
  const from = vr.redirection.virtualMetres, began = realNow(), resetsBefore = vr.redirection.frame?.resetCount ?? 0;
  const head = camera.position.clone(), left = head.clone(), right = head.clone();
  while (vr.redirection.virtualMetres - from < metres && told.seconds < seconds && !walker.finished) {
    drawing = told.frames % drawn === 0;
    device.position.set(...walker.position);
    device.quaternion.set(...walker.orientation);
    clock.step(1 / 90);
    told.scripts.push(framed);
    if (drawing) told.draws.push(spent);
    ++told.frames;
    told.seconds += 1 / 90;
    const frame = vr.redirection.frame;
    told.resets = frame.resetCount - resetsBefore;
    for (const name in gains) {
      gains[name][0] = Math.min(gains[name][0], frame[name]);
      gains[name][1] = Math.max(gains[name][1], frame[name]);
    }
    told.inside = Math.min(told.inside, nearestBorder(walls, walker.position[0], walker.position[2], nearest).distance);
    const asked = frame.resetting || frame.resetPhase === 'outside';
    for (const value of frame.position) {  // FNV-1a over what was seen
      bits.setFloat32(0, value);
      told.hash = Math.imul(told.hash ^ bits.getInt32(0), 16777619) >>> 0;
    }
    if (vr.prompt.shown !== asked) wrong(`prompt ${vr.prompt.shown}, reset ${frame.resetting}, "${vr.prompt.text}"`);
    if (frame.resetting) ++told.prompts;
    const back = frame.resetPhase === 'backward';
    if (back && vr.prompt.text !== 'Please step back') wrong(`backward, but "${vr.prompt.text}"`);
    if (back && before !== 'backward') ++told.backs;
    before = frame.resetPhase;
    // The rig takes the tracked head to the session's virtual pose, and keeps the world level.
    head.set(...walker.position).applyMatrix4(vr.rig.matrix);
    told.rig = Math.max(told.rig, Math.hypot(...head.toArray().map((v, i) => v - frame.position[i])));
    told.level = Math.max(told.level, Math.abs(vr.rig.matrix.elements[5] - 1));
    if (told.frames % 10 === 1) {
      const floor = [frame.position[0], frame.position[1] - walker.position[1], frame.position[2]];
      const place = ways.locate(floor);
      const off = place ? Math.hypot(place.floor[0] - floor[0], place.floor[2] - floor[2]) : Infinity;
      told.beside = Math.max(told.beside, off);
    }
    if (drawing) {  // what three.js renders from: both eyes about the virtual head
      const [one, other] = renderer.xr.getCamera().cameras;
      left.setFromMatrixPosition(one.matrixWorld).lerp(right.setFromMatrixPosition(other.matrixWorld), 0.5);
      told.eyes = Math.max(told.eyes, Math.hypot(...left.toArray().map((v, i) => v - frame.position[i])));
      told.calls = Math.max(told.calls, renderer.info.render.calls);
      told.triangles = Math.max(told.triangles, renderer.info.render.triangles);
      if (nearest.distance > 1.6 && vr.grid.visible && vr.grid.material.uniforms.strength.value > 0.99) ++told.gridFar;
    }
    walker.advance(1 / 90, frame);
    if (until === 'prompt' && frame.resetPhase === 'turning' && Math.abs(frame.resetTurned) > 0.6) break;
    if (until === 'marker' && frame.resetPhase === 'turning' && frame.resetRemaining < 0.5) break;
  }
  renderer.render = render;
  delete vr.frame;
  const quantile = (values, share) => values.sort((a, b) => a - b)[Math.floor(share * (values.length - 1))] ?? 0;
  const {scripts, draws, ...rest} = told;
  return {...rest, gains, virtual: vr.redirection.virtualMetres - from, physical: vr.redirection.physicalMetres,
    wall: (realNow() - began) / 1000, script: [0.5, 0.95, 0.99, 1].map((share) => quantile(scripts, share)),
    draw: [0.5, 0.99].map((share) => quantile(draws, share)), finished: walker.finished};
}, settings);

/** What the headset shows, as a PNG: one more frame with the head where it is. */
export async function picture(page, file) {
  const url = await page.evaluate(() => {
    clock.step(1 / 90);
    return vr.renderer.domElement.toDataURL();
  });
  writeFileSync(file, Buffer.from(url.split(',')[1], 'base64'));
}
