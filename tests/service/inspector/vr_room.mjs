// Rooms, rigs and prompts of Enter VR, without a page: node vr_room.mjs BUILD
//
// Scans close to rings with their furniture inside; free floors keep their distance whichever way a room is turned;
// rigs take the tracked head to the virtual one; every phase of a reset has its words.
import assert from 'node:assert/strict';
import {readdirSync, readFileSync} from 'node:fs';
import {building, library, packageFile, packageOf, source} from './vr_source.mjs';

const build = process.argv[2];
const {
  areaOf, chainOfWalls, freeFloor, nearestBorder, problemOf, promptOf, rectangularRoom, Redirection, roomFromBounds,
  roomFromCapture,
} = await source(build, 'room.ts', 'vr/room.ts', 'vr/scan.ts', 'vr/prompt.ts', 'vr/redirection.ts');
const {Quaternion, Vector3} = packageOf('three');
const near = (a, b, off, what) => assert.ok(Math.abs(a - b) <= off, `${what}: ${a}, not ${b}`);
const inside = (room, [x, z]) => nearestBorder(room, x, z, {}).distance;

// Scans.
const captures = packageFile('@iwer/sem/captures');
const rooms = readdirSync(captures).map((file) => {
  const capture = JSON.parse(readFileSync(`${captures}/${file}`));
  const room = roomFromCapture(file, capture);
  const {walls, gap} = chainOfWalls(capture);
  const {extent} = capture.spatialEntities.find((entity) => entity.semanticLabel_META === 'FLOOR').bounded2D_META;
  const area = Math.abs(areaOf(room.border)), box = extent.width * extent.height;
  const free = freeFloor(room);
  console.log(`${file}: ${walls.length} walls, ends at most ${gap.toFixed(3)} m apart, ${area.toFixed(1)} m^2 of a ` +
    `floor that measures ${box.toFixed(1)}; ${room.obstacles.length} obstacles, ${free.area.toFixed(1)} m^2 free`);
  assert.ok(gap < 0.3 && walls.length >= 4);
  assert.ok(area > 0.7 * box && area < 1.05 * box, 'walls enclose the floor, niches aside');
  assert.equal(problemOf(room.border), null);
  for (const obstacle of room.obstacles) {
    const middle = [0, 1].map((axis) => obstacle.reduce((sum, p) => sum + p[axis], 0) / obstacle.length);
    assert.ok(inside({border: room.border, holes: []}, middle) > 0, 'furniture stands in the room');
  }
  assert.ok(free.area < area && free.clearance > 0.4);
  return room;
});
assert.equal(rooms.length, 5);
assert.throws(() => roomFromCapture('two walls', {spatialEntities: []}), /two walls: 0 walls/);
{
  const capture = JSON.parse(readFileSync(`${captures}/office_small.json`));
  const wall = capture.spatialEntities.find((entity) => entity.semanticLabel_META === 'WALL_FACE');
  wall.locatable_META.position.x += 1;
  assert.throws(() => roomFromCapture('pulled apart', capture), /walls that should meet are [0-9.]+ m apart/);
  // The order in which walls were scanned makes no difference to the room.
  const again = JSON.parse(readFileSync(`${captures}/music_room.json`));
  const forward = roomFromCapture('', again);
  again.spatialEntities.reverse();
  near(Math.abs(areaOf(roomFromCapture('', again).border)), Math.abs(areaOf(forward.border)), 1e-6, 'area');
}

// Free floors: everywhere at least the margin from walls and furniture; as large in turned, moved and mirrored rooms.
const moved = (room, turn, [dx, dz], mirror = 1) => {
  const cos = Math.cos(turn), sin = Math.sin(turn);
  const place = ([x, z]) => [mirror * x * cos - z * sin + dx, mirror * x * sin + z * cos + dz];
  return {...room, border: room.border.map(place), obstacles: room.obstacles.map((ring) => ring.map(place))};
};
for (const room of [...rooms, rectangularRoom(5, 5)]) {
  const free = freeFloor(room);
  const walls = {border: room.border, holes: room.obstacles};
  for (const ring of [free.border, ...free.holes]) {
    ring.forEach(([x, z], i) => {
      const [u, v] = ring[(i + 1) % ring.length];
      for (const share of [0, 0.25, 0.5, 0.75]) {
        const off = inside(walls, [x + share * (u - x), z + share * (v - z)]);
        assert.ok(off > 0.1 - 1e-3, `${room.name}: ${off} m from a wall`);
      }
    });
  }
  near(inside(free, free.middle), free.clearance, 0.05, 'the middle is as free as it says');
  const others = [moved(room, 0.7, [1, -2]), moved(room, 0, [0, 0], -1), {...room, border: [...room.border].reverse()}];
  for (const other of others) {
    near(freeFloor(other).area, free.area, 0.02, `${room.name}, free floor`);
  }
  assert.ok(freeFloor(room, 0).area > free.area);
}
near(freeFloor(rectangularRoom(5, 4)).area, 4.8 * 3.8, 1e-6, 'a rectangle less a hand on each side');
near(freeFloor({...rectangularRoom(5, 4), obstacles: [rectangularRoom(1, 1).border]}).area, 4.8 * 3.8 - 1.2 * 1.2, 1e-6,
  'less a table');
assert.throws(() => freeFloor({...rectangularRoom(2, 2), name: 'hall', obstacles: [rectangularRoom(1.6, 1.6).border]}),
  /hall: too little of the floor is free/);

// What can't be walked in is said.
assert.equal(problemOf(rectangularRoom(3, 3).border), null);
assert.match(problemOf([[0, 0], [1, 1]]), /2 corners; at least 3/);
assert.match(problemOf([[-2, -2], [2, 2], [2, -2], [-2, 2]]), /Two walls cross/);
assert.match(problemOf([[0, 0], [4, 0], [4, 99], [0, 3]]),
  /A corner lies 4\.00 m right, -99\.00 m ahead; give metres within 50/);
assert.match(problemOf([[0, 0], [4, 0], [4, NaN]]), /A corner lies/);
assert.match(problemOf([[0, 0], [9, 0], [9, 0.6], [0, 0.6]]), /too narrow: its widest place is 0\.30 m/);
assert.match(roomFromBounds(undefined).problem, /says no bounds/);
assert.match(roomFromBounds([{x: 0, z: 0}, {x: 1.6, z: 0}, {x: 1.6, z: 3}, {x: 0, z: 3}]).problem,
  /measure 1\.6 m x 3\.0 m; 2 m are needed/);
assert.deepEqual(roomFromBounds([{x: 0, z: 0}, {x: 3, z: 0}, {x: 3, z: 3}]).border, [[0, 0], [3, 0], [3, 3]]);

// The rig: at first at the start; then the tracked head is at the virtual one, upright, whatever the head does.
const forewalk = await library(build);
const {navmesh, start} = building(build, forewalk, 'museum');
{
  const redirection = new Redirection(navmesh, 's2c', freeFloor(rectangularRoom(5, 5)), start);
  assert.deepEqual(redirection.place(), start);
  const head = new Vector3(0.4, 1.62, -0.3), gaze = new Quaternion();
  redirection.step(head, gaze, 0);
  const place = redirection.place();
  near(Math.hypot(place.floor[0] - start.floor[0], place.floor[2] - start.floor[2]), 0, 1e-3, 'begins at the start');
  near(Math.cos(place.heading - start.heading), 1, 1e-6, 'facing as the start does');
  const axis = new Vector3();
  for (let i = 1; i < 900; ++i) {
    const t = i / 90;
    head.set(0.4 + 0.3 * Math.sin(0.5 * t), 1.62 + 0.1 * Math.sin(t), -0.3 - 0.3 * Math.sin(0.7 * t));
    gaze.setFromAxisAngle(axis.set(0.2 * Math.sin(t), 1, 0.1).normalize(), 2 * Math.sin(0.6 * t));
    const frame = redirection.step(head, gaze, t);
    const seen = head.clone().applyMatrix4(redirection.rig);
    near(seen.distanceTo(new Vector3().fromArray(frame.position)), 0, 1e-4, 'the head where it is seen');
    const turned = new Quaternion().setFromRotationMatrix(redirection.rig).multiply(gaze);
    near(Math.abs(turned.dot(new Quaternion().fromArray(frame.orientation))), 1, 1e-6, 'looking where it looks');
    assert.equal(redirection.rig.elements[5], 1);
  }
  // Who was away and comes back elsewhere goes on where they were; who comes back to the same place has not moved.
  const before = redirection.place();
  redirection.away();
  redirection.step(head, gaze, 40);
  near(Math.hypot(...redirection.place().floor.map((v, i) => v - before.floor[i])), 0, 0.02, 'back at the same place');
  redirection.away();
  redirection.step(head.set(-1.9, 1.62, 1.9), gaze, 80);
  near(Math.hypot(...redirection.place().floor.map((v, i) => v - before.floor[i])), 0, 0.05, 'back at another place');
  redirection.release();
}

// Words: one prompt for every phase that asks something, none for the others; left and right are mirror images.
const frame = (resetPhase, instruction = 'none', resetRemaining = 2, resetTurned = 0, resetBack = 0) =>
  ({resetPhase, instruction, resetRemaining, resetTurned, resetBack});
assert.equal(promptOf(frame('none')), null);
assert.equal(promptOf(frame('near')), null);
assert.deepEqual(promptOf(frame('outside')),
  {text: 'Walk back into your room', detail: 'toward the light', side: 0, angle: null});
assert.deepEqual(promptOf(frame('backward', 'step-back', 2, 0, 0.42)),
  {text: 'Please step back', detail: '0.4 m', side: 0, angle: null});
const left = promptOf(frame('turn', 'turn-left')), right = promptOf(frame('turn', 'turn-right'));
assert.deepEqual([left.text, left.side, right.text, right.side], ['Please turn left', 1, 'Please turn right', -1]);
assert.equal(promptOf(frame('turn', 'turn-around')).text, 'Please turn around');
assert.equal(promptOf(frame('turning', 'keep-turning', 1, 0.8)).text, 'Keep turning left');
assert.equal(promptOf(frame('turning', 'keep-turning', 1, -0.8)).text, 'Keep turning right');
assert.equal(promptOf(frame('turning', 'keep-turning', Math.PI / 2, -0.8)).detail, '90\u00b0');
assert.equal(promptOf(frame('turning', 'keep-turning', 0.01, -0.8)).detail, '5\u00b0');
console.log('rooms, rigs and prompts keep their laws');
