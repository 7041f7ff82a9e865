// Enter VR: an immersive session in which somebody walks a building in their own room.
//
// Every frame: the head's pose in the room goes to the session, and the rig goes where the head then is at the
// session's virtual pose. Eyes, controllers, hands, the border's grid and the prompts are under the rig; the building
// stands still.
import {Group, Matrix4, PerspectiveCamera, Quaternion, Vector3, WebGLRenderer} from 'three';
import type {Controller, Navmesh} from 'forewalk';
import type {Building} from '../buildings';
import {nearestBorder, type Nearest} from '../room';
import {BorderGrid} from './border_grid';
import {Fade} from './fade';
import {Inputs} from './input';
import {promptOf, ResetPrompt, type Prompt} from './prompt';
import {Redirection, type VirtualPlace} from './redirection';
import {freeFloor, roomFromBounds, type FreeFloor, type TrackedRoom} from './room';
import {Scenery} from './scenery';

const CLOSE = 0.55;   // metres to the border within which it is shown, walking toward it or not
const LONGEST = 0.1;  // seconds; after longer gaps nothing is eased as if it had gone on
const NOTICE = 6;     // seconds that a notice is shown in the world

/** What is walked, where, and how. */
export interface Choice {
  building: Building;
  controller: Controller;
  /** The room that is walked in; where `asked`, only if the headset says none that can be used. */
  room: TrackedRoom;
  /** Whether the headset is asked for its bounds. */
  asked: boolean;
}

/** All of a choice that takes time: made before the session begins. */
export class Prepared {
  readonly navmesh: Navmesh;
  readonly scenery: Scenery;
  readonly redirection: Redirection;

  /** 0.2 to 0.6 s. Throws, with a sentence for people, where the room can't be walked in. */
  constructor(readonly choice: Choice, navmeshOf: (building: Building) => Navmesh) {
    const room = freeFloor(choice.room);
    this.navmesh = navmeshOf(choice.building);
    this.redirection = new Redirection(this.navmesh, choice.controller, room, choice.building.start);
    this.scenery = new Scenery(choice.building, this.navmesh.polygons());
  }

  dispose(): void {
    this.redirection.release();
    this.scenery.dispose();
    this.navmesh.release();
  }
}

/** Why there is no VR here, a sentence for people; null where there is. */
export async function whyNoVr(): Promise<string | null> {
  if (!window.isSecureContext) return 'Headsets are only reached from https:// pages and from localhost.';
  if (!navigator.xr) return 'This browser has no WebXR. Open the page in the browser of a headset.';
  const supported = await navigator.xr.isSessionSupported('immersive-vr').catch(() => false);
  return supported ? null :
    'No headset found. Plug one in, open the page in its browser, or try an emulator: the extension Immersive Web ' +
    'Emulator.';
}

/** Asks for a session. Has to be called from a click, before anything is waited for. */
export function requestSession(): Promise<XRSession> {
  return navigator.xr!.requestSession('immersive-vr', {
    requiredFeatures: ['local-floor'], optionalFeatures: ['bounded-floor', 'hand-tracking'],
  });
}

/** Somebody who is walking. Ends with the session, from either side. */
export class VrWalk {
  readonly camera = new PerspectiveCamera(70, 1, 0.05, 250);
  readonly rig = new Group();
  readonly prompt = new ResetPrompt();
  readonly fade = new Fade();
  grid: BorderGrid;
  redirection: Redirection;
  /** Resolves when it is over. */
  readonly ended: Promise<void>;

  private readonly inputs: Inputs;
  private readonly origin = new Matrix4();  // of `space`, seen from the one that was asked for
  private readonly head = new Vector3();
  private readonly gaze = new Quaternion();
  private readonly nearest: Nearest = {x: 0, z: 0, distance: 0};
  private readonly ahead = [0, 0, 0];
  private last = -Infinity;      // seconds, of the latest frame
  private noticeLeft = 0;
  private notice: Prompt | null = null;

  private constructor(readonly session: XRSession, readonly prepared: Prepared, readonly renderer: WebGLRenderer,
                      private space: XRReferenceSpace) {
    this.redirection = prepared.redirection;
    this.grid = new BorderGrid(this.redirection.room);
    this.inputs = new Inputs(renderer);
    this.rig.matrixAutoUpdate = false;
    this.rig.add(this.camera, this.grid, this.prompt, this.fade, this.inputs);
    prepared.scenery.add(this.rig);
    // Later, once three.js has taken leave of the session as well.
    this.ended = new Promise((resolve) => session.addEventListener('end', () => setTimeout(() => {
      this.dispose();
      resolve();
    })));
    session.addEventListener('visibilitychange', () => {
      if (session.visibilityState === 'hidden') this.redirection.away();
    });
    this.watch(space);
  }

  /** Begins to draw. Takes over `prepared`, which is given back when the session ends. */
  static async begin(session: XRSession, prepared: Prepared): Promise<VrWalk> {
    const {choice} = prepared;
    const bounded = choice.asked ? await spaceOf(session, 'bounded-floor') : null;
    const space = bounded ?? await spaceOf(session, 'local-floor');
    if (!space) throw new Error('The headset tracks no floor.');
    const renderer = new WebGLRenderer({antialias: true, powerPreference: 'high-performance'});
    renderer.xr.enabled = true;
    renderer.xr.setReferenceSpaceType('local-floor');
    const walk = new VrWalk(session, prepared, renderer, space);
    if (choice.asked) walk.takeBounds(bounded as XRBoundedReferenceSpace | null);
    await renderer.xr.setSession(session);
    renderer.xr.setReferenceSpace(space);
    renderer.setAnimationLoop((milliseconds, frame) => {
      if (frame) walk.frame(milliseconds / 1000, frame);
    });
    return walk;
  }

  end(): Promise<void> {
    return this.session.end();
  }

  /** One frame: where the head is, what the session says, what to show. */
  private frame(seconds: number, frame: XRFrame): void {
    const {head, gaze, redirection, renderer} = this;
    const since = Math.min(LONGEST, Math.max(0, seconds - this.last));
    this.last = seconds;
    const pose = frame.getViewerPose(this.space);
    // Guessed positions and frames that nobody sees are no walk either.
    const lost = !pose || pose.emulatedPosition || this.session.visibilityState === 'hidden';
    if (pose) {
      const {position, orientation} = pose.transform;
      head.set(position.x, position.y, position.z);
      gaze.set(orientation.x, orientation.y, orientation.z, orientation.w);
    }
    if (lost) {
      redirection.away();
    } else {
      const answer = redirection.step(head, gaze, seconds);
      this.rig.matrix.copy(redirection.rig);
      this.rig.matrixWorldNeedsUpdate = true;
      const asked = promptOf(answer);
      this.noticeLeft -= since;
      const shown = asked ?? (this.noticeLeft > 0 ? this.notice : null);
      const direction = answer.resetPhase === 'outside' ? this.inward() : asked ? answer.resetDirection : nowhere;
      this.prompt.update(shown, head, gaze, direction, since);
      const {distance} = nearestBorder(redirection.room, head.x, head.z, this.nearest);
      this.grid.update(answer.resetPhase !== 'none' || distance < CLOSE, head, since);
      this.inputs.update();
    }
    this.fade.update(lost, head, since);
    renderer.render(this.prepared.scenery, this.camera);
  }

  /** From the head to the nearest point of the border, a unit vector of the room. */
  private inward(): number[] {
    const {head, nearest, ahead} = this;
    nearestBorder(this.redirection.room, head.x, head.z, nearest);
    const x = nearest.x - head.x, z = nearest.z - head.z;
    const length = Math.max(Math.hypot(x, z), 1e-6);
    ahead[0] = x / length;
    ahead[2] = z / length;
    return ahead;
  }

  /** The headset's bounds as the room, where they can be used; says so where they can't. */
  private takeBounds(bounded: XRBoundedReferenceSpace | null): void {
    const found = roomFromBounds(bounded?.boundsGeometry);
    try {
      if ('problem' in found) throw new Error(found.problem);
      this.moveInto(freeFloor(found));
    } catch (error) {
      this.say((error as Error).message, `Walking in ${this.prepared.choice.room.name}`);
    }
  }

  /** Goes on in another room, from the same place of the building. Takes as long as a session to make. */
  private moveInto(room: FreeFloor): void {
    const place: VirtualPlace = this.redirection.place();
    const {navmesh, choice} = this.prepared;
    const next = new Redirection(navmesh, choice.controller, room, place);
    this.redirection.release();
    this.redirection = next;
    this.rig.remove(this.grid);
    this.grid.dispose();
    this.grid = new BorderGrid(room);
    this.rig.add(this.grid);
    this.fade.update(true, this.head, Infinity);
  }

  private say(text: string, detail: string): void {
    this.notice = {text, detail, side: 0, angle: null};
    this.noticeLeft = NOTICE;
    document.dispatchEvent(new CustomEvent('forewalk:notice', {detail: `${text} ${detail}.`}));
  }

  // The reference space's origin has moved: somebody recentred, or set up their room anew. Where the headset says by
  // how much, the room is walked on in as it was; else it is taken to lie about the new origin.
  private watch(space: XRReferenceSpace): void {
    space.addEventListener('reset', (event) => {
      const {transform} = event as XRReferenceSpaceEvent;
      if (transform) {
        // The old origin, seen from the new one.
        this.origin.premultiply(new Matrix4().fromArray(transform.inverse.matrix));
        const place = new Vector3(), turn = new Quaternion();
        this.origin.decompose(place, turn, new Vector3());
        this.space = space.getOffsetReferenceSpace(new XRRigidTransform(place, turn));
        this.renderer.xr.setReferenceSpace(this.space);
        return;
      }
      this.origin.identity();
      this.space = space;
      this.renderer.xr.setReferenceSpace(space);
      const bounds = (space as XRBoundedReferenceSpace).boundsGeometry;
      if (this.prepared.choice.asked && bounds?.length) this.takeBounds(space as XRBoundedReferenceSpace);
      else this.moveInto(this.redirection.room);
    });
  }

  private dispose(): void {
    this.renderer.setAnimationLoop(null);
    this.grid.dispose();
    this.prompt.dispose();
    this.fade.dispose();
    this.redirection.release();
    this.prepared.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

const nowhere = [0, 0, 0];

async function spaceOf(session: XRSession, type: XRReferenceSpaceType): Promise<XRReferenceSpace | null> {
  return session.requestReferenceSpace(type).catch(() => null) as Promise<XRReferenceSpace | null>;
}
