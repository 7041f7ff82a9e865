// The page's simulated person: node vr_walker.mjs BUILD
//
// Ways are the shortest and stay on the floor; walks follow the tour, stay in the room, and repeat to the bit.
import assert from 'node:assert/strict';
import {building, buildingIds, library, source} from './vr_source.mjs';

const build = process.argv[2];
const {Walker, Ways, uniformNumbers} = await source(build, 'walker.ts', 'ways.ts');
const forewalk = await library(build);
const lengthOf = (points) => points.slice(1).reduce((sum, p, i) =>
  sum + Math.hypot(p[0] - points[i][0], p[2] - points[i][2]), 0);
const apart = (a, b) => Math.hypot(a[0] - b[0], a[2] - b[2]);

// Ways: as short as the library's taut paths, there and back alike, never off the floor.
for (const id of buildingIds) {
  const {navmesh, start} = building(build, forewalk, id);
  const tight = new Ways(navmesh.polygons(), 0), polite = new Ways(navmesh.polygons());
  const session = navmesh.session({controller: 'none', alwaysPredict: true, horizon: 25, start, resets: false});
  session.frame([0, 1.65, 0], [0, 0, 0, 1], 0);
  let compared = 0, worst = 0, mean = 0;
  for (const node of session.graph().nodes.slice(1)) {
    const from = tight.locate(start.floor), to = tight.locate(node.position);
    assert.ok(apart(to.floor, node.position) < 1e-3);
    const there = [from.floor, ...tight.route(from, to)];
    const back = [to.floor, ...tight.route(to, from)];
    const ratio = lengthOf(there) / Math.max(node.distance, 0.1);
    worst = Math.max(worst, ratio);
    mean += ratio;
    ++compared;
    assert.ok(Math.abs(lengthOf(there) - lengthOf(back)) < 0.05 * lengthOf(there) + 1e-3, 'there and back alike');
    const wide = [from.floor, ...polite.route(from, to)];
    assert.ok(lengthOf(wide) > lengthOf(there) - 1e-3, 'a margin never shortens a way');
    let y = wide[0][1];  // between corners the floor may rise and fall: followed step by step
    for (let i = 1; i < wide.length; ++i) {
      const steps = Math.ceil(apart(wide[i - 1], wide[i]) / 0.1) + 1;
      for (let step = 0; step <= steps; ++step) {
        const at = wide[i - 1].map((v, axis) => v + step / steps * (wide[i][axis] - v));
        const place = tight.locate([at[0], y, at[2]]);
        assert.ok(place && apart(place.floor, at) < 2e-3, `${id}: the way to ${node.position} leaves the floor`);
        y = place.floor[1];
      }
    }
  }
  console.log(`${id}: ${compared} ways, ${(mean / compared).toFixed(4)} times the library's taut length, ` +
    `at worst ${worst.toFixed(3)}`);
  assert.ok(compared > 0 && mean / compared < 1.01 && worst < 1.25);
  session.release();
}

// Walks. `turned` rotates the room about its origin, and the body with it.
function walk(id, {controller = 'foresight', room = {width: 5, depth: 5}, turned = 0, metres = 60, seed = 1,
  wander = false}) {
  const {navmesh, start, tour} = building(build, forewalk, id);
  const inRoom = (x, y) => ({
    right: x * Math.cos(turned) - y * Math.sin(turned), forward: x * Math.sin(turned) + y * Math.cos(turned),
  });
  const square = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) =>
    Object.values(inRoom(x * room.width / 2, y * room.depth / 2)));
  const session = navmesh.session({controller, border: square, start, horizon: 10, likelihoods: true});
  const walker = new Walker(navmesh, {
    ...wander ? {graph: () => session.graph()} : {tour}, seed,
    body: {...inRoom(0.7, 0.4), heading: turned},
  });
  const ways = new Ways(navmesh.polygons());
  const trail = [];
  let virtual = 0, outside = -Infinity, off = 0, resetting = 0, resets = 0, before = null, last = [0, 0, 0];
  for (let i = 0; virtual < metres && !walker.finished && i < 90 * 600; ++i) {
    const frame = session.frame(walker.position, walker.orientation, i / 90);
    if (before) virtual += apart(frame.position, last);
    last = Array.from(frame.position);
    before = frame;
    resets = frame.resetCount;
    resetting += frame.resetting ? 1 : 0;
    if (i % 30 === 0) {
      const floor = [last[0], last[1] - walker.position[1], last[2]];
      const place = ways.locate(floor);
      off = Math.max(off, place ? apart(place.floor, floor) : Infinity);
    }
    const {right, forward} = walker.body;
    const x = right * Math.cos(turned) + forward * Math.sin(turned);
    const y = forward * Math.cos(turned) - right * Math.sin(turned);
    outside = Math.max(outside, Math.abs(x) - room.width / 2, Math.abs(y) - room.depth / 2);
    trail.push(last[0], last[2]);
    walker.advance(1 / 90, frame);
  }
  const result = {virtual, walked: walker.walked, outside, off, resets, resetting: resetting / 90,
    seconds: trail.length / 180, trail, finished: walker.finished};
  session.release();
  navmesh.release();
  return result;
}

for (const id of buildingIds) {
  const result = walk(id, {});
  console.log(`${id}: ${result.virtual.toFixed(1)} m in ${result.seconds.toFixed(0)} s, ${result.resets} resets ` +
    `(${result.resetting.toFixed(0)} s), never nearer than ${(-1000 * result.outside).toFixed(0)} mm to the border, ` +
    `${(1000 * result.off).toFixed(0)} mm beside the floor`);
  assert.ok(result.virtual >= 60 || result.finished);
  // Who sets off toward a border that is near is stopped late (rdw/reset.h): up to a few millimetres late.
  assert.ok(result.outside < 0.01, 'never outside the room');
  assert.ok(result.off < 0.05, 'never off the floor');
  assert.ok(result.resets > 2 && result.resets < 20);
  assert.ok(result.seconds - result.resetting < 2.5 * result.virtual, 'somebody who is not being reset walks');
}

// The same walk again, to the bit; wandering too, and another seed is another walk.
assert.deepEqual(walk('office', {metres: 30}), walk('office', {metres: 30}));
const wandering = walk('museum', {metres: 40, wander: true, seed: 3});
assert.deepEqual(wandering, walk('museum', {metres: 40, wander: true, seed: 3}));
assert.notDeepEqual(wandering.trail, walk('museum', {metres: 40, wander: true, seed: 4}).trail);
assert.ok(wandering.virtual >= 40 && wandering.outside < 0 && wandering.off < 0.05);

// Unsteered, somebody walks as far as they see themselves walk. A room that is turned, with the body in it, makes no
// difference beyond rounding.
const free = walk('museum', {controller: 'none', room: {width: 200, depth: 200}});
assert.ok(Math.abs(free.virtual - free.walked) < 0.02 && free.resets === 0);
for (const turned of [0.5 * Math.PI, 1.1]) {
  const straight = walk('museum', {controller: 's2c', metres: 8});
  const other = walk('museum', {controller: 's2c', metres: 8, turned});
  const count = Math.min(straight.trail.length, other.trail.length, 2 * 90 * 4);
  for (let i = 0; i < count; ++i) assert.ok(Math.abs(straight.trail[i] - other.trail[i]) < 5e-3);
}

// Uniform numbers are uniform, and whoever has nowhere to go hears of it.
const numbers = uniformNumbers(5);
const tenths = new Array(10).fill(0);
for (let i = 0; i < 20000; ++i) ++tenths[Math.floor(10 * numbers())];
assert.ok(tenths.every((count) => Math.abs(count - 2000) < 200));
const {navmesh} = building(build, forewalk, 'museum');
assert.throws(() => new Walker(navmesh, {}), /give a tour to follow, or a graph/);
assert.throws(() => new Walker(navmesh, {tour: [[1e3, 0, 0]]}),
  /place 1 of the tour, 1000, 0, 0, is not within a metre/);
assert.throws(() => new Walker(navmesh, {tour: [[21.5, 0, 34]], speed: 0}), /speed is 0/);
console.log('walks repeat to the bit, in turned rooms as well');
