// Somebody in a headset, redirected: the session, and the rig that puts what the headset renders where the session
// says.
import {Matrix4, Quaternion, Vector3} from 'three';
import type {Controller, Frame, Navmesh, Session} from 'forewalk';
import {roomForSession} from '../room';
import type {FreeFloor} from './room';

/** A place of the virtual floor, [x, y, z], and a heading, radians left of -Z. */
export interface VirtualPlace {
  floor: number[];
  heading: number;
}

/** Those that know the likely ways, and so where it is best to face. */
const PLANNERS: readonly Controller[] = ['foresight', 'mpcred'];

const MOVED = 0.3;  // metres; who was away and comes back farther off goes on where they were in the building

export class Redirection {
  /** From the room (the reference space) to the virtual world: turned about +Y and moved, never tilted. */
  readonly rig = new Matrix4();
  /** The latest answer of the session; filled again and again. */
  frame: Frame | null = null;
  /** Metres through the virtual world, and of the body, so far; jumps of tracking left out. */
  virtualMetres = 0;
  physicalMetres = 0;

  private readonly session: Session;
  private readonly turned = new Quaternion();
  private readonly physical = new Quaternion();
  private readonly body = new Vector3();       // of the latest frame
  private readonly virtual = new Vector3();
  private readonly scratch = new Vector3();
  private wasAway = false;

  /**
   * A walk through `navmesh` from `start` on, by a head that keeps to `room`. Takes 0.1 to 0.3 s for controllers that
   * predict: not in a frame. Throws (ForewalkError) where room or start can't be used.
   */
  constructor(navmesh: Navmesh, controller: Controller, readonly room: FreeFloor, readonly start: VirtualPlace,
              horizon = 10) {
    const reset = PLANNERS.includes(controller) ? 'ahead' : 'two-one-turn';
    this.session = navmesh.session({controller, reset, horizon, start, ...roomForSession(room)});
  }

  /**
   * One frame: the tracked head in the room, metres and a quaternion, and its time in seconds. Afterwards `rig` takes
   * that head to the session's virtual pose.
   */
  step(position: Vector3, orientation: Quaternion, seconds: number): Frame {
    const {rig, turned, scratch} = this;
    if (this.wasAway) this.comeBack(position);
    const first = this.frame === null;
    const frame = this.frame = this.session.frame(position.toArray(head, 0), orientation.toArray(gaze, 0), seconds);
    scratch.fromArray(frame.position);
    if (!first && !this.wasAway) {
      const step = Math.hypot(position.x - this.body.x, position.z - this.body.z);
      if (step < MOVED) {
        this.physicalMetres += step;
        this.virtualMetres += Math.hypot(scratch.x - this.virtual.x, scratch.z - this.virtual.z);
      }
    }
    this.wasAway = false;
    this.virtual.copy(scratch);
    this.body.copy(position);

    // virtual * inverse(physical): a turn about +Y but for rounding, which is dropped so that the world stays level.
    turned.fromArray(frame.orientation).multiply(this.physical.copy(orientation).conjugate());
    turned.set(0, turned.y, 0, turned.w).normalize();
    scratch.copy(position).applyQuaternion(turned);
    rig.makeRotationFromQuaternion(turned).setPosition(
      this.virtual.x - scratch.x, this.virtual.y - scratch.y, this.virtual.z - scratch.z);
    return frame;
  }

  /** Tracking is lost, or the headset is off: frames stop. Who is elsewhere at the next one is put back. */
  away(): void {
    this.wasAway = this.frame !== null;
  }

  /** Where the person is in the virtual world; the start before the first frame. */
  place(): VirtualPlace {
    if (!this.frame) return this.start;
    const [x, y, z, w] = this.frame.orientation;
    return {
      floor: [this.virtual.x, this.virtual.y - this.body.y, this.virtual.z],
      heading: Math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y)),
    };
  }

  release(): void {
    this.session.release();
  }

  private comeBack(position: Vector3): void {
    if (Math.hypot(position.x - this.body.x, position.z - this.body.z) <= MOVED) return;
    const {floor, heading} = this.place();
    try {
      this.session.teleport(floor, heading);
    } catch {  // they had left the walkable floor
      this.session.teleport(this.start.floor, this.start.heading);
    }
  }
}

const head = [0, 0, 0];     // scratch of step()
const gaze = [0, 0, 0, 1];
