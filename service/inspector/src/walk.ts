// A walk: what a session was told and what it answered, frame after frame.
//
// An hour at 90 Hz is 324,000 frames, so they lie in flat arrays that grow by doubling (some 140 bytes a frame), and
// whatever the page shows of them is found by index. Nothing here draws or reads files.
import type {Frame} from 'forewalk';
import {nearestBorder, type Nearest, type Room} from './room';

/** Of the session, as recordings say it: a simulation file's keys (rdw/simulation_config.h). */
export interface RecordedSettings {
  space?: unknown;
  controller?: string;
  horizon_m?: number;
  method?: 'polygon' | 'front';
  persistence_m?: number;
  polygon_limit?: number;
  [key: string]: unknown;
}

export interface WalkHead {
  session: string;
  /** The scene's file. */
  scene: string;
  /** FNV-1a of the navmesh, 16 hexadecimal digits; or "moving". */
  navmesh: string;
  settings: RecordedSettings;
}

/** One frame, to be filled again and again. Poses are x, y, z and a quaternion x, y, z, w; NaN was lost. */
export interface WalkFrame {
  seconds: number;
  physical: Float64Array;
  virtual: Float64Array;
  flags: number;
  /** Translation, rotation, curvature (1/m), bending. */
  gains: Float64Array;
  injectedYaw: number;
  injected: Float64Array;
  turning: boolean;
  /** Index into INSTRUCTIONS. */
  instruction: number;
  remaining: number;
  turned: number;
  resets: number;
  nodes: number;
}

export const INSTRUCTIONS: readonly Frame['instruction'][] =
  ['none', 'turn-around', 'keep-turning', 'walk-back', 'step-back', 'turn-left', 'turn-right'];

export const POSE = 7;

export const emptyWalkFrame = (): WalkFrame => ({
  seconds: 0, physical: new Float64Array(POSE), virtual: new Float64Array(POSE), flags: 0,
  gains: new Float64Array([1, 1, 0, 1]), injectedYaw: 0, injected: new Float64Array(3), turning: false,
  instruction: 0, remaining: 0, turned: 0, resets: 0, nodes: 0,
});

type Column = Float32Array | Float64Array | Uint32Array | Uint8Array;

// A longer step between two frames was no walking: a teleport, or tracking that came back elsewhere, metres.
const LONGEST_STEP = 1;

export class Walk {
  readonly head: WalkHead;
  /** Null: not known in a form that can be drawn; there are no border distances then. */
  readonly room: Room | null;
  length = 0;
  /** Since the walk began; never runs backwards, whatever `clock` says. Seconds. */
  time = new Float64Array(1024);
  /** As the session was told. */
  clock = new Float64Array(1024);
  /** POSE numbers a frame. */
  physical = new Float32Array(POSE * 1024);
  virtual = new Float32Array(POSE * 1024);
  flags = new Uint32Array(1024);
  translation = new Float32Array(1024);
  rotation = new Float32Array(1024);
  curvature = new Float32Array(1024);
  bending = new Float32Array(1024);
  injectedYaw = new Float32Array(1024);
  injected = new Float32Array(3 * 1024);
  turning = new Uint8Array(1024);
  instruction = new Uint8Array(1024);
  remaining = new Float32Array(1024);
  turned = new Float32Array(1024);
  resets = new Uint32Array(1024);
  nodes = new Uint32Array(1024);
  /** Distance of the body to the nearest border, metres; NaN where it is not known. */
  border = new Float32Array(1024);
  /** Metres walked since the beginning, on the plan. */
  walkedVirtual = new Float32Array(1024);
  walkedPhysical = new Float32Array(1024);
  /** What the graph of this frame cost in this page, milliseconds; NaN: it was not asked for. */
  graphTime = new Float32Array(1024);
  /** Frames at which a reset began. */
  readonly resetFrames: number[] = [];
  /** Frames before which the user was put elsewhere, and where to: [x, y, z, heading]. */
  readonly teleports = new Map<number, number[]>();
  /** The frame from which on the world is another one than the navmesh says; Infinity: never. */
  worldChanged = Infinity;

  private virtualMetres = 0;
  private physicalMetres = 0;
  private readonly nearest: Nearest = {x: 0, z: 0, distance: 0};

  constructor(head: WalkHead, room: Room | null) {
    this.head = head;
    this.room = room;
  }

  /** Seconds from the first frame to the last. */
  get duration(): number {
    return this.length === 0 ? 0 : this.time[this.length - 1];
  }

  append(frame: WalkFrame): void {
    const i = this.length;
    if (i === this.time.length) this.grow();
    this.clock[i] = frame.seconds;
    const step = i === 0 ? 0 : frame.seconds - this.clock[i - 1];
    this.time[i] = i === 0 ? 0 : this.time[i - 1] + (step > 0 ? step : 0);
    this.physical.set(frame.physical, POSE * i);
    this.virtual.set(frame.virtual, POSE * i);
    this.flags[i] = frame.flags;
    this.translation[i] = frame.gains[0];
    this.rotation[i] = frame.gains[1];
    this.curvature[i] = frame.gains[2];
    this.bending[i] = frame.gains[3];
    this.injectedYaw[i] = frame.injectedYaw;
    this.injected.set(frame.injected, 3 * i);
    this.turning[i] = frame.turning ? 1 : 0;
    this.instruction[i] = frame.instruction;
    this.remaining[i] = frame.remaining;
    this.turned[i] = frame.turned;
    this.resets[i] = frame.resets;
    this.nodes[i] = frame.nodes;
    this.graphTime[i] = NaN;
    const x = frame.physical[0], z = frame.physical[2];
    this.border[i] = this.room && Number.isFinite(x + z) ? nearestBorder(this.room, x, z, this.nearest).distance : NaN;
    if (i > 0) {
      this.virtualMetres += this.stepOf(this.virtual, i);
      this.physicalMetres += this.stepOf(this.physical, i);
      if (frame.resets > this.resets[i - 1]) this.resetFrames.push(i);
    }
    this.walkedVirtual[i] = this.virtualMetres;
    this.walkedPhysical[i] = this.physicalMetres;
    this.length = i + 1;
  }

  /** The last frame that is not later than `time`, 0 before the first. O(log frames). */
  frameAt(time: number): number {
    let low = 0;
    let high = this.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return Math.max(low, 0);
  }

  /** How many resets had begun at a frame, counted from the walk's first. */
  resetsAt(frame: number): number {
    return this.length === 0 ? 0 : this.resets[frame] - this.resets[0];
  }

  private stepOf(poses: Float32Array, i: number): number {
    const a = POSE * (i - 1);
    const b = POSE * i;
    const step = Math.hypot(poses[b] - poses[a], poses[b + 2] - poses[a + 2]);
    return step <= LONGEST_STEP ? step : 0;  // NaN is no step either
  }

  private grow(): void {
    const larger = <C extends Column>(column: C): C => {
      const copy = new (column.constructor as new (length: number) => C)(2 * column.length);
      copy.set(column as never);
      return copy;
    };
    this.time = larger(this.time);
    this.clock = larger(this.clock);
    this.physical = larger(this.physical);
    this.virtual = larger(this.virtual);
    this.flags = larger(this.flags);
    this.translation = larger(this.translation);
    this.rotation = larger(this.rotation);
    this.curvature = larger(this.curvature);
    this.bending = larger(this.bending);
    this.injectedYaw = larger(this.injectedYaw);
    this.injected = larger(this.injected);
    this.turning = larger(this.turning);
    this.instruction = larger(this.instruction);
    this.remaining = larger(this.remaining);
    this.turned = larger(this.turned);
    this.resets = larger(this.resets);
    this.nodes = larger(this.nodes);
    this.border = larger(this.border);
    this.walkedVirtual = larger(this.walkedVirtual);
    this.walkedPhysical = larger(this.walkedPhysical);
    this.graphTime = larger(this.graphTime);
  }
}

/** Heading of the orientation at `at` in `poses`: 0 = -Z, counter-clockwise positive seen from above, radians. */
export function headingOf(poses: ArrayLike<number>, at: number): number {
  const x = poses[at + 3], y = poses[at + 4], z = poses[at + 5], w = poses[at + 6];
  // Where -Z is turned to.
  return Math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y));
}
