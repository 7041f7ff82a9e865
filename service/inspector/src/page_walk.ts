// A walk in the page: a session of the WebAssembly library, and a body that walks. As fast as asked, 90 frames a
// second of its own time.
import {emptyFrame, type Frame, type Graph, type Session} from 'forewalk';
import type {Ground} from './ground';
import {RATE, sessionSettings, settingsJson, type Body, type LiveSettings, type Source} from './source';
import {SteeredBody} from './steered_body';
import {emptyWalkFrame, INSTRUCTIONS, Walk, type WalkFrame} from './walk';
import {Walker} from './walker';

// Made at most in one call, so that the page answers while it catches up.
const MOST_FRAMES = 90;

/** A body for a walk on this ground; where it has no tour to follow, it wanders by `graph`. */
export function makeBody(ground: Ground, settings: LiveSettings, graph: () => Graph): Body {
  if (settings.walker === 'keys') return new SteeredBody();
  const {tour} = ground.building;
  return settings.walker === 'tour' && tour.length > 0
    ? new Walker(ground.navmesh, {tour, loop: true, seed: settings.seed})
    : new Walker(ground.navmesh, {graph, seed: settings.seed});
}

/** What a session answered, into a frame of a walk. */
export function fillFrame(out: WalkFrame, seconds: number, body: Body, frame: Frame): void {
  out.seconds = seconds;
  out.physical.set(body.position, 0);
  out.physical.set(body.orientation, 3);
  out.virtual.set(frame.position, 0);
  out.virtual.set(frame.orientation, 3);
  out.flags = frame.flags;
  out.gains[0] = frame.translation;
  out.gains[1] = frame.rotation;
  out.gains[2] = frame.curvature;
  out.gains[3] = frame.bending;
  out.injectedYaw = frame.injectedYaw;
  out.injected.set(frame.injectedTranslation);
  out.turning = frame.resetting;
  out.instruction = Math.max(0, INSTRUCTIONS.indexOf(frame.instruction));
  out.remaining = frame.resetRemaining;
  out.turned = frame.resetTurned;
  out.resets = frame.resetCount;
  out.nodes = frame.graphNodes;
}

export class PageWalk implements Source {
  readonly walk: Walk;
  readonly title: string;
  readonly live = true;
  readonly rate = RATE;
  readonly body: Body;
  private readonly session: Session;
  private readonly frame = emptyFrame();
  private readonly row = emptyWalkFrame();

  /** Throws ForewalkError where a session cannot be made of the settings. 0.1 to 0.3 s with a predictive controller. */
  constructor(ground: Ground, settings: LiveSettings) {
    const {start} = ground.building;
    this.session = ground.navmesh.session(sessionSettings(settings, start));
    this.body = makeBody(ground, settings, () => this.session.graph());
    this.title = `${ground.building.name}, walked in this page`;
    this.walk = new Walk({
      session: crypto.getRandomValues(new Uint32Array(2)).reduce((text, word) => text + word.toString(16).padStart(8, '0'), ''),
      scene: `${ground.building.id}.obj`, navmesh: ground.hash, settings: settingsJson(settings, start),
    }, settings.room);
    this.step();
  }

  reach(time: number): void {
    for (let made = 0; made < MOST_FRAMES && this.walk.duration + 0.5 / RATE < time; ++made) this.step();
  }

  release(): void {
    this.session.release();
  }

  private step(): void {
    const seconds = this.walk.length / RATE;
    this.session.frame(this.body.position, this.body.orientation, seconds, this.frame);
    fillFrame(this.row, seconds, this.body, this.frame);
    this.walk.append(this.row);
    this.body.advance(1 / RATE, this.frame);
  }
}
