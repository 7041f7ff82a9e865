// A simulated person, for pages without a headset and for tests.
//
// A walker lives in two spaces, as in rdw/walker.h. It sees only the virtual pose that a session answers and plans
// there; its body moves in the room. So a curvature gain bends the body's way while the walk seems straight, and a
// reset turns somebody who has to react, brake and turn like a person.
//
//   const frame = session.frame(walker.position, walker.orientation, seconds);
//   walker.advance(1 / 90, frame);
import type {Frame, Graph, Navmesh} from 'forewalk';
import {distanceToSegment, Ways, type Place} from './ways';

/** How a body moves, and where to. Metres, seconds, radians. */
export interface WalkerSettings {
  /** Of the body, m/s; 1 by default. */
  speed?: number;
  /** Of turns on the spot and in walking, rad/s; 100 degrees a second by default. */
  turnRate?: number;
  /** Corners sharper than this are turned on the spot, rad; 30 degrees by default. */
  stopAngle?: number;
  /** Walked on after a reset begins, seconds; 0.25 by default. */
  reactionTime?: number;
  /** Of setting off and of stopping for a reset, m/s^2; 2 and 3 by default. */
  acceleration?: number;
  deceleration?: number;
  /** Above the room's floor; 1.65 by default. */
  eyeHeight?: number;
  /** Where the body begins in the room: metres right and forward of its origin, radians left of forward; 0 each. */
  body?: {right: number; forward: number; heading: number};
  /** Places of the virtual floor to walk to, one after the other, [x, y, z]. */
  tour?: readonly number[][];
  /** After the tour's last place on to its first, for ever; false by default. */
  loop?: boolean;
  /**
   * The graph of the session's latest frame, `() => session.graph()`: asked where there is no tour, each time the
   * last goal is reached. The next goal is the end of one of its ways, drawn by likelihood.
   */
  graph?: () => Graph;
  /** Of what is drawn, an integer; 1 by default. Same seed, same frames: same walk. */
  seed?: number;
}

const ARRIVED = 0.01;   // metres; nearer than this a goal is reached
const STRAYED = 0.3;    // metres beside the planned way at which it is planned anew
const OVER = 1e-4;      // turned or stepped beyond the end of a reset, so that rounding leaves no remainder
const EVENTS = 64;      // arrivals and turns in one frame; no honest frame has more

/** Uniform numbers in [0, 1), mulberry32: the same on every machine. */
export function uniformNumbers(seed: number): () => number {
  let state = seed | 0;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** In (-pi, pi]. */
const wrapped = (angle: number): number => angle - 2 * Math.PI * Math.ceil(angle / (2 * Math.PI) - 0.5);

/** Radians left of -Z that a head looks, whichever way it is tilted. */
export function headingOf(q: ArrayLike<number>): number {
  const x = q[0], y = q[1], z = q[2], w = q[3];
  return Math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y));
}

export class Walker {
  /** The head in the room, to hand to Session.frame: x, y, z, and a quaternion x, y, z, w. Overwritten by advance. */
  readonly position = new Float64Array(3);
  readonly orientation = new Float64Array(4);

  private readonly ways: Ways;
  private readonly is: Required<Omit<WalkerSettings, 'tour' | 'graph' | 'body'>>;
  private readonly tour: Place[];
  private readonly graph: (() => Graph) | undefined;
  private readonly uniform: () => number;
  private stop = 0;                    // of the tour, walked to next
  private heading: number;             // of the body
  private speed = 0;
  private path: number[][] = [];       // to the goal, virtual
  private next = 0;                    // point of `path` walked to
  private goalPlace: Place | null = null;
  private legFrom: number[] = [0, 0, 0];
  private walking = false;             // false: turning on the spot
  private resetting = false;
  private reactionLeft = 0;            // seconds
  private stoppingWay = 0;             // walked on after the last reset began, metres
  private lastSide = 1;                // of the last turn on the spot; +1 left
  private walkedMetres = 0;
  private done = false;
  // What the session answered, as far as walking goes; plan coordinates are (x, -z).
  private seenX = 0;
  private seenY = 0;
  private seenHeading = 0;

  /**
   * Somebody who walks over `navmesh`. Throws where there is neither a tour nor a graph, and where a place of the
   * tour lies beside the floor or cannot be reached from the one before. O(polygons) and a way per leg of the tour.
   */
  constructor(navmesh: Navmesh, settings: WalkerSettings) {
    this.is = {
      speed: settings.speed ?? 1,
      turnRate: settings.turnRate ?? 100 * Math.PI / 180,
      stopAngle: settings.stopAngle ?? Math.PI / 6,
      reactionTime: settings.reactionTime ?? 0.25,
      acceleration: settings.acceleration ?? 2,
      deceleration: settings.deceleration ?? 3,
      eyeHeight: settings.eyeHeight ?? 1.65,
      loop: settings.loop ?? false,
      seed: settings.seed ?? 1,
    };
    for (const name of ['speed', 'turnRate', 'acceleration', 'deceleration', 'eyeHeight'] as const) {
      if (!(this.is[name] > 0)) throw new Error(`walker: ${name} is ${this.is[name]}; it has to be more than 0.`);
    }
    this.ways = new Ways(navmesh.polygons());
    this.uniform = uniformNumbers(this.is.seed);
    this.graph = settings.graph;
    this.tour = (settings.tour ?? []).map((floor, i) => this.placeOf(floor, `place ${i + 1} of the tour`));
    if (this.tour.length === 0 && !this.graph) {
      throw new Error('walker: give a tour to follow, or a graph to wander by.');
    }
    for (let i = 1; i < this.tour.length; ++i) {
      if (this.ways.route(this.tour[i - 1], this.tour[i])) continue;
      throw new Error(`walker: there is no way to place ${i + 1} of the tour from the one before.`);
    }
    const {right, forward, heading} = settings.body ?? {right: 0, forward: 0, heading: 0};
    this.position[0] = right;
    this.position[1] = this.is.eyeHeight;
    this.position[2] = -forward;
    this.heading = heading;
    this.look();
  }

  /** The body in the room: metres right and forward of the origin, radians left of forward. */
  get body(): {right: number; forward: number; heading: number} {
    return {right: this.position[0], forward: -this.position[2], heading: this.heading};
  }

  /** Nothing is left to walk. */
  get finished(): boolean {
    return this.done;
  }

  /** Metres that the body has walked, steps back included. */
  get walked(): number {
    return this.walkedMetres;
  }

  /** The place of the virtual floor walked to, [x, y, z]; null where there is none. */
  get goal(): readonly number[] | null {
    return this.goalPlace?.floor ?? null;
  }

  /**
   * Moves the body on by `seconds`, having seen `frame`: the session's answer to `position` and `orientation` as they
   * are now. During resets it does what the frame asks: reacts, brakes, steps back, turns until told. Allocates only
   * where a new way is planned.
   */
  advance(seconds: number, frame: Frame): void {
    if (frame.resetting) {
      this.obey(seconds, frame);
    } else {
      this.seenX = frame.position[0];
      this.seenY = -frame.position[2];
      this.seenHeading = headingOf(frame.orientation);
      if (!this.done) this.walk(seconds, frame);
      this.resetting = false;
    }
    this.look();
  }

  private placeOf(floor: ArrayLike<number>, what: string): Place {
    const place = this.ways.locate(floor);
    if (place) return place;
    throw new Error(`walker: ${what}, ${Array.from(floor).join(', ')}, is not within a metre of the walkable floor.`);
  }

  private look(): void {
    this.orientation[1] = Math.sin(0.5 * this.heading);
    this.orientation[3] = Math.cos(0.5 * this.heading);
  }

  private step(metres: number): void {
    this.position[0] -= metres * Math.sin(this.heading);
    this.position[2] -= metres * Math.cos(this.heading);
    this.walkedMetres += Math.abs(metres);
  }

  // What the gains will do to this frame is not known yet, so those of the last are expected; what is left over is
  // made good in the next.
  private walk(left: number, frame: Frame): void {
    const rotation = Math.max(frame.rotation, 0.1), translation = Math.max(frame.translation, 0.1);
    const {speed, acceleration, turnRate, stopAngle} = this.is;
    if (this.goalPlace === null) this.planNext(frame);
    else if (this.resetting && this.overshot()) this.arrive(frame);
    else if (this.strayed()) this.replan(frame);

    for (let event = 0; event < EVENTS && left > 0 && !this.done; ++event) {
      const target = this.path[this.next];
      const x = target[0] - this.seenX, y = -target[2] - this.seenY;
      const distance = Math.hypot(x, y);
      if (distance < ARRIVED) {
        this.arrive(frame);
        continue;
      }
      const error = wrapped(Math.atan2(-x, y) - this.seenHeading);
      if (Math.abs(error) > stopAngle) this.walking = false;
      const needed = Math.abs(error) / rotation;
      const turned = Math.min(needed, turnRate * left);
      this.heading = wrapped(this.heading + Math.sign(error) * turned);
      this.seenHeading += Math.sign(error) * turned * rotation;
      if (!this.walking) {
        this.speed = 0;
        this.lastSide = error < 0 ? -1 : 1;
        left -= turned / turnRate;
        this.walking = turned === needed;
        continue;
      }
      const settingOff = Math.min(left, (speed - this.speed) / acceleration);
      const reached = this.speed + acceleration * settingOff;
      const mean = (0.5 * (this.speed + reached) * settingOff + reached * (left - settingOff)) / left;
      const metres = Math.min(mean * left, distance / translation);
      this.step(metres);
      this.seenX -= translation * metres * Math.sin(this.seenHeading);
      this.seenY += translation * metres * Math.cos(this.seenHeading);
      const walkedFor = metres / mean;
      this.speed = Math.min(speed, this.speed + acceleration * walkedFor);
      left -= walkedFor;
    }
  }

  // Nobody stops at once: a reaction, then braking, both straight on, then what the reset asks for.
  private obey(left: number, frame: Frame): void {
    const {reactionTime, deceleration, turnRate, speed} = this.is;
    if (!this.resetting) {
      this.resetting = true;
      this.reactionLeft = reactionTime;
      this.walking = false;
      this.stoppingWay = this.speed * reactionTime + this.speed * this.speed / (2 * deceleration);
    }
    const reacting = Math.min(left, this.reactionLeft);
    this.reactionLeft -= reacting;
    left -= reacting;
    if (this.speed > 0) {
      const braking = Math.min(left, this.speed / deceleration);
      this.step(this.speed * (reacting + braking) - 0.5 * deceleration * braking * braking);
      this.speed = braking < left ? 0 : Math.max(0, this.speed - deceleration * braking);
      left -= braking;
    }
    if (left <= 0) return;
    if (frame.resetBack > 0) {
      this.step(-Math.min(speed * left, frame.resetBack + OVER));
      return;
    }
    const turned = Math.min(turnRate * left, frame.resetRemaining + OVER);
    this.heading = wrapped(this.heading + this.sideOf(frame) * turned);
  }

  private sideOf(frame: Frame): number {
    if (frame.instruction === 'turn-left') return 1;
    if (frame.instruction === 'turn-right') return -1;
    return frame.resetTurned !== 0 ? Math.sign(frame.resetTurned) : this.lastSide;
  }

  // Who had to stop for a reset may have walked past the point they were going to. They do not go back for it: in
  // the reset's new direction that could lead out of the room again, and so for ever.
  private overshot(): boolean {
    const target = this.path[this.next];
    const x = target[0] - this.seenX, y = -target[2] - this.seenY;
    const ahead = -x * Math.sin(this.seenHeading) + y * Math.cos(this.seenHeading);
    return Math.hypot(x, y) <= this.stoppingWay + ARRIVED && ahead <= 0;
  }

  private strayed(): boolean {
    seen[0] = this.seenX;
    seen[2] = -this.seenY;
    return distanceToSegment(seen, this.legFrom, this.path[this.next]) > STRAYED;
  }

  private floorOf(frame: Frame): number[] {
    return [frame.position[0], frame.position[1] - this.position[1], frame.position[2]];
  }

  private arrive(frame: Frame): void {
    this.legFrom = this.path[this.next];
    if (++this.next === this.path.length) this.planNext(frame);
  }

  private planNext(frame: Frame): void {
    const here = this.goalPlace ?? this.ways.locate(this.floorOf(frame));
    const goal = here && (this.tour.length > 0 ? this.nextStop() : this.nextEnd());
    const path = goal && this.ways.route(here, goal);
    this.done = !path;
    if (!path) return;
    if (this.goalPlace === null) this.legFrom = this.floorOf(frame);
    this.goalPlace = goal;
    this.path = path;
    this.next = 0;
  }

  private replan(frame: Frame): void {
    this.legFrom = this.floorOf(frame);
    const here = this.ways.locate(this.legFrom);
    const path = here && this.ways.route(here, this.goalPlace!);
    if (!path) return;
    this.path = path;
    this.next = 0;
  }

  private nextStop(): Place | null {
    if (this.stop === this.tour.length && this.is.loop) this.stop = 0;
    return this.tour[this.stop++] ?? null;
  }

  // Without likelihoods every end is as likely.
  private nextEnd(): Place | null {
    const {nodes, ways} = this.graph!();
    const ends = ways.length > 0 ? ways.map(({node, likelihood}) => ({at: nodes[node], likelihood})) :
      nodes.filter(({kind}) => kind === 'terminal').map((at) => ({at, likelihood: 1}));
    let left = this.uniform() * ends.reduce((sum, {likelihood}) => sum + likelihood, 0);
    const drawn = ends.find(({likelihood}) => (left -= likelihood) < 0) ?? ends.at(-1);
    return drawn ? this.ways.locate(drawn.at.position) : null;
  }
}

const seen = [0, 0, 0];  // scratch of strayed()
