// The WebAssembly package against the native library: node agreement.mjs PACKAGE NATIVE_WALK FOLDER
//
// native_walk writes walks with the native answers into FOLDER; here they are walked again. Prints the farthest
// that any frame's virtual pose lies off, and fails beyond 1e-4.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync, readdirSync, rmSync} from 'node:fs';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';

const [pack, nativeWalk, folder] = process.argv.slice(2);
const {emptyFrame, Flags, ForewalkError, load} = await import(pathToFileURL(join(pack, 'index.js')));
rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
process.stdout.write(execFileSync(nativeWalk, [folder]));
const forewalk = await load();
assert.equal(forewalk.version, JSON.parse(readFileSync(join(pack, 'package.json'))).version);

const walks = readdirSync(folder).filter((name) => name.endsWith('.jsonl'));
assert.ok(walks.length >= 3);
for (const file of walks) {
  const name = file.replace('.jsonl', '');
  const [head, ...frames] = readFileSync(join(folder, file), 'utf8').trim().split('\n').map((line) => JSON.parse(line));
  const navmesh = forewalk.navmesh(readFileSync(join(folder, `${name}.fwmesh`)));
  const session = navmesh.session(head);
  navmesh.release();  // the session keeps it
  let position = 0, orientation = 0, equal = 0, otherFlags = 0;
  const begin = process.cpuUsage().user;
  for (const line of frames) {
    const frame = session.frame(line.slice(1, 4), line.slice(4, 8), line[0]);
    const p = Math.max(...[0, 1, 2].map((i) => Math.abs(frame.position[i] - line[8 + i])));
    const q = Math.max(...[0, 1, 2, 3].map((i) => Math.abs(frame.orientation[i] - line[11 + i])));
    position = Math.max(position, p);
    orientation = Math.max(orientation, q);
    equal += p === 0 && q === 0 ? 1 : 0;
    otherFlags += frame.flags !== line[15] || frame.resetCount !== line[16] || frame.graphNodes !== line[17] ? 1 : 0;
  }
  const microseconds = (process.cpuUsage().user - begin) / frames.length;
  console.log(`${name}: ${frames.length} frames, at most ${position.toExponential(1)} m and ` +
    `${orientation.toExponential(1)} off, ${equal} the same to the bit, ${otherFlags} with other flags, resets or ` +
    `nodes; ${microseconds.toFixed(0)} us a frame`);
  assert.ok(frames.length > 1000);
  assert.ok(position <= 1e-4 && orientation <= 1e-4, `${name}: not within 1e-4`);
  assert.ok(frames.at(-1)[16] > 0, 'there were resets');

  const graph = session.graph();
  assert.equal(graph.nodes[0].kind, 'source');
  assert.ok(graph.nodes.every((node, i) => i === 0 ? node.prev === null : node.prev < graph.nodes.length));
  assert.ok(graph.edges.every((edge) => edge.path.length >= 2 && edge.path.flat().every(Number.isFinite)));
  assert.equal(graph.fronts.length > 0, head.method === 'front');
  // Filled anew, whatever it held: shorter lists grow, longer ones shrink.
  const other = structuredClone(graph);
  other.nodes.push({...other.nodes[0]});
  other.edges.length = 1;
  other.edges[0].path.push([9, 9, 9]);
  other.ways.push({id: 0, node: 0, likelihood: 0, born: false});
  assert.deepEqual(session.graph(other), graph);
  session.release();
  assert.throws(() => session.graph(), ForewalkError);
}

// Ways, gaze, a shared room, and what is refused.
const bytes = readFileSync(join(folder, 'office.fwmesh'));
const navmesh = forewalk.navmesh(bytes);
assert.ok(navmesh.polygonCount > 100);
const room = forewalk.space({width: 5, depth: 5, userLimit: 2});
const start = {floor: [7, 0, 12], heading: 0.4};
const one = navmesh.session({space: room, start, likelihoods: true, method: 'front'});
const two = navmesh.session({space: room, start});
one.setGaze([-1, 0, 0]);
const frame = one.frame([0, 1.7, 0], [0, 0, 0, 1], 0, emptyFrame());
assert.equal(frame.flags & Flags.firstFrame, Flags.firstFrame);
two.frame([1, 1.7, 1], [0, 0, 0, 1], 0);
const ways = one.graph();
const sum = ways.ways.reduce((all, way) => all + way.likelihood, ways.likelihoodNone);
assert.ok(ways.ways.length > 1 && Math.abs(sum - 1) < 1e-5);
assert.throws(() => navmesh.session({space: room}), (error) => error instanceof ForewalkError && /user_limit/.test(error.message));
assert.throws(() => navmesh.session({horizon: -1}), /horizon of -1 m cannot work/);
assert.throws(() => navmesh.session({controller: 's3c'}), /"s3c" is not known/);
assert.throws(() => one.teleport([1e4, 0, 0]), /not within 0.5 m of a walkable floor/);
assert.throws(() => forewalk.navmesh(bytes.subarray(0, 100)), /fwmesh in memory: byte/);
const damaged = Uint8Array.from(bytes);
damaged[200] ^= 1;
assert.throws(() => forewalk.navmesh(damaged), /checksum/);
one.setLinks([{id: 1, entry: [7, 0, 12], exit: [9, 0, 12], length: 1}]);
one.setStanding([{foot: [7, 0, 11], radius: 0.4}]);
one.teleport([9, 0, 12]);
one.enter(navmesh);

// Frames make hardly any garbage: some boxed numbers, no objects.
const still = navmesh.session({start});
const p = [0, 1.7, 0], q = [0, 0, 0, 1];
let at = 0;
const frames = (count) => {
  for (let i = 0; i < count; ++i) {
    ++at;
    p[2] = -0.0001 * (at % 9000);
    still.frame(p, q, at / 90);
  }
};
frames(20000);
globalThis.gc();
const before = process.memoryUsage().heapUsed;
frames(20000);
const grown = (process.memoryUsage().heapUsed - before) / 20000;
console.log(`${grown.toFixed(0)} bytes of garbage a frame`);
assert.ok(grown < 160);
