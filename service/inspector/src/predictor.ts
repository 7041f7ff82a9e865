// The prediction graph at any frame of a walk.
//
// Recordings hold no graphs. A session of our own is fed the walk's virtual heads, so that its map from physical to
// virtual stays the identity, and predicts what the recorded one predicted there: the graph follows from where the
// user stands. Names and likelihoods of ways follow from how they came there: after a leap in time it is led there
// from a second before.
import type {Graph, Session} from 'forewalk';
import type {Ground} from './ground';
import {headingOf, POSE, type Walk} from './walk';

/** Frames that lie closer are run through, one by one; seconds. */
const NEAR = 1.5;
/** How long before the frame a leap lands, and the step of frames from there on, seconds. */
const SETTLE = 1;
const SETTLE_STEP = 1 / 30;
/**
 * The graph time is the mean of so many frames, because browsers' timers tick too coarsely for one; without the slowest
 * few, in which something else had the processor.
 */
const MEAN_FRAMES = 24;
const LEFT_OUT = 3;

export class Predictor {
  private session: Session | null = null;
  private last = -1;
  private landed = false;    // the next frame is the first after a leap
  private graph: Graph | null = null;
  // Filled again and again.
  private readonly latest: Graph = {horizon: 0, completeTo: 0, nodes: [], edges: [], fronts: [], ways: [], likelihoodNone: 1};
  private clock = 0;
  private readonly times = new Float64Array(MEAN_FRAMES);
  private readonly sorted = new Float64Array(MEAN_FRAMES);
  private timed = 0;
  private readonly head = new Float64Array(3);
  private readonly looking = new Float64Array([0, 0, 0, 1]);

  constructor(private readonly ground: Ground, private readonly walk: Walk) {}

  /** Null where there is none: off the navmesh, or after the world changed. Valid until the next call. */
  at(frame: number): Graph | null {
    const {walk} = this;
    if (frame >= walk.length || frame >= walk.worldChanged) return null;
    if (frame === this.last) return this.graph;
    const ahead = this.last < 0 ? Infinity : walk.time[frame] - walk.time[this.last];
    const led = this.session && frame > this.last && ahead <= NEAR ? this.runTo(frame, 0) : this.leapTo(frame);
    this.graph = led && this.session ? this.session.graph(this.latest) : null;
    return this.graph;
  }

  /** Frees the session. */
  release(): void {
    this.session?.release();
    this.session = null;
    this.last = -1;
  }

  private leapTo(frame: number): boolean {
    const {walk} = this;
    let from = walk.frameAt(walk.time[frame] - SETTLE);
    for (const landed of walk.teleports.keys()) if (landed <= frame && landed > from) from = landed;
    // Where the walk is off the navmesh, from where it is on it again.
    while (from < frame && !this.putAt(from)) ++from;
    return from === frame ? this.putAt(frame) && this.runTo(frame, 0) : this.runTo(frame, SETTLE_STEP);
  }

  /** Puts the session's next frame at this one, from nowhere; false where that is no floor. */
  private putAt(frame: number): boolean {
    const {walk} = this;
    this.standAs(frame);
    const floor = [this.head[0], this.head[1] - walk.physical[POSE * frame + 1], this.head[2]];
    if (!floor.every(Number.isFinite)) return false;
    const heading = headingOf(walk.virtual, POSE * frame);
    try {
      if (this.session) this.session.teleport(floor, heading);
      else this.session = this.makeSession(floor, heading);
    } catch {
      return false;
    }
    this.last = frame - 1;
    this.landed = true;
    return true;
  }

  /** Where the recorded session predicted from: where the user was before this frame's gains moved them on. */
  private standAs(frame: number): void {
    const {walk, head} = this;
    for (let k = 0; k < 3; ++k) head[k] = walk.virtual[POSE * frame + k] - walk.injected[3 * frame + k];
  }

  private lookAs(frame: number): void {
    for (let k = 0; k < 4; ++k) this.looking[k] = this.walk.virtual[POSE * frame + 3 + k];
  }

  private makeSession(floor: number[], heading: number): Session {
    const {settings} = this.walk.head;
    return this.ground.navmesh.session({
      controller: 'none', resets: false, alwaysPredict: true, likelihoods: true, width: 10000, depth: 10000,
      horizon: settings.horizon_m ?? 10, method: settings.method ?? 'polygon',
      persistence: settings.persistence_m, polygonLimit: settings.polygon_limit, start: {floor, heading},
    });
  }

  /** Walks on to a frame, with at least `step` seconds between two; false where the session is not on the ground. */
  private runTo(frame: number, step: number): boolean {
    const {walk, session, head, looking} = this;
    if (!session) return false;
    let landed = this.landed ? this.last + 1 : -1;
    for (let i = this.last + 1; i <= frame; ++i) {
      if (walk.teleports.has(i) && this.putAt(i)) landed = i;
      if (i < frame && i > 0 && walk.time[i] - this.clock < step && walk.time[i] > this.clock) continue;
      this.standAs(i);
      // Who is turned by a reset looks everywhere and means nothing by it.
      if (walk.turning[i] === 0 || i === landed) this.lookAs(i);
      const begin = performance.now();
      session.frame(head, looking, walk.time[i]);
      this.times[this.timed++ % MEAN_FRAMES] = performance.now() - begin;
      this.clock = walk.time[i];
    }
    this.landed = false;
    walk.graphTime[frame] = this.meanTime();
    this.last = frame;
    return true;
  }

  private meanTime(): number {
    const count = Math.min(this.timed, MEAN_FRAMES);
    if (count < MEAN_FRAMES) return NaN;
    this.sorted.set(this.times);
    this.sorted.sort();
    let sum = 0;
    for (let i = 0; i < count - LEFT_OUT; ++i) sum += this.sorted[i];
    return sum / (count - LEFT_OUT);
  }
}

/**
 * How likely each node's way is taken: the sum over the ways that lead through it. 1 for the source; without
 * likelihoods, by the number of ways. `out` is filled and grown where it is too short.
 */
export function nodeLikelihoods(graph: Graph, out: Float32Array): Float32Array {
  const count = graph.nodes.length;
  const likelihood = out.length >= count ? out : new Float32Array(2 * count);
  likelihood.fill(0, 0, count);
  const known = graph.ways.length > 0;
  let whole = 0;
  const add = (node: number, share: number): void => {
    whole += share;
    let at: number | null = node;
    while (at !== null) {
      likelihood[at] += share;
      at = graph.nodes[at].prev;
    }
  };
  if (known) for (const way of graph.ways) add(way.node, way.likelihood);
  else graph.nodes.forEach((node, id) => { if (node.kind === 'terminal') add(id, 1); });
  if (!known && whole > 0) for (let i = 0; i < count; ++i) likelihood[i] /= whole;
  return likelihood;
}
