/**
 * Redirected walking in WebAssembly: the frame side of forewalk, with the semantics of its C interface
 * (service/capi/forewalk.h). Metres, seconds, radians; axes by default those of WebXR: right-handed, +Y up,
 * forward -Z.
 */

/** x, y, z. */
export type Vector3 = ArrayLike<number>;
/** x, y, z, w; a unit quaternion. */
export type Quaternion = ArrayLike<number>;
/** [right, forward] of the tracked room: x and -z in WebXR's axes. */
export type Point2 = [number, number];

export type Axes = 'openxr' | 'unity' | 'unreal';
export type Controller = 'none' | 's2c' | 's2o' | 's2c-predictive' | 's2o-predictive' | 's2mt' | 's2mt+c' |
  'zigzag' | 'p2r' | 'messinger' | 'dynamic-apf' | 'haptics' | 'arc' | 'visibility' | 'foresight' | 'mpcred' |
  'force';
export type Reset = 'two-one-turn' | 'freeze-turn' | 'freeze-backup' | 'r2c' | 'mr2c' | 'r2g' | 'sfr2g' |
  'r2fd' | 'ahead';

/** The room that is walked in: a rectangle about the origin, or a border, with pillars inside. */
export interface Room {
  /** Metres along right and forward; 4 each where nothing is given. */
  width?: number;
  depth?: number;
  border?: Point2[];
  holes?: Point2[][];
}

/** Virtual over physical, 0 < min <= 1 <= max; curvature in 1/metre to either side. */
export interface Limits {
  translationMin?: number;
  translationMax?: number;
  rotationMin?: number;
  rotationMax?: number;
  curvatureMax?: number;
  bendingMin?: number;
  bendingMax?: number;
}

export interface SessionSettings extends Room {
  axes?: Axes;
  controller?: Controller;
  reset?: Reset;
  /** A preset's name, or numbers of your own. */
  limits?: 'steinicke' | 'laboratory' | 'neth' | 'toolkit' | Limits;
  /** Of prediction, metres along the virtual path, (0, 1000]; 10 by default. */
  horizon?: number;
  /** Where the first frame's head is put in the virtual world; without, virtual is physical at first. */
  start?: {floor: Vector3; heading?: number};
  /** A room shared with other sessions, in the place of width, depth, border and holes. */
  space?: Space;
  polygonLimit?: number;
  resets?: boolean;
  alwaysPredict?: boolean;
  method?: 'polygon' | 'front';
  persistence?: number;
  /** Names and likelihoods of ways in every frame, for graph(). */
  likelihoods?: boolean;
  headingSource?: 'head' | 'chest' | 'walking';
}

export interface SpaceSettings extends Room {
  axes?: Axes;
  /** How near the middles of two bodies may come, metres; 0.5 by default. */
  bodyRadius?: number;
  /** Most sessions at one time, 1 to 64; 16 by default. */
  userLimit?: number;
}

export interface Frame {
  /** Bits of Flags. */
  flags: number;
  /** The virtual head: what to render from. */
  position: Float32Array;
  orientation: Float32Array;
  /** Gains as applied. */
  translation: number;
  rotation: number;
  curvature: number;
  bending: number;
  injectedYaw: number;
  injectedTranslation: Float32Array;
  resetting: boolean;
  instruction: 'none' | 'turn-around' | 'keep-turning' | 'walk-back' | 'step-back' | 'turn-left' | 'turn-right';
  /** Physical radians to go, and turned since it began. */
  resetRemaining: number;
  resetTurned: number;
  resetCount: number;
  graphNodes: number;
  resetPhase: 'none' | 'near' | 'outside' | 'backward' | 'turn' | 'turning';
  /** Metres to step back before the turn. */
  resetBack: number;
  /** Where the user will face when the turn is done: a unit vector of the room; zero without one. */
  resetDirection: Float32Array;
}

export interface GraphNode {
  position: number[];
  /** Of the shortest path from the user, metres. */
  distance: number;
  /** The branch node or source before it; null for the source. */
  prev: number | null;
  polygon: number | null;
  kind: 'source' | 'branch' | 'terminal' | 'join';
  reason: 'horizon' | 'dead-end' | 'meeting' | null;
  branch: boolean;
}

export interface Graph {
  horizon: number;
  completeTo: number;
  /** nodes[0] is the user. */
  nodes: GraphNode[];
  edges: {from: number; to: number; length: number; width: number; loop: boolean; path: number[][]}[];
  fronts: {node: number; length: number; from: number[]; to: number[]}[];
  /** With `likelihoods`, or a controller that uses them. */
  ways: {id: number; node: number; likelihood: number; born: boolean}[];
  likelihoodNone: number;
}

export interface Link {
  id: number;
  entry: Vector3;
  exit: Vector3;
  /** Metres of walking that it counts for. */
  length: number;
  bothWays?: boolean;
  closed?: boolean;
}

export interface Standing {
  foot: Vector3;
  /** Of the floor that others cannot use, metres. */
  radius: number;
  /** 0 or missing: closed; else metres for each metre. */
  cost?: number;
}

export interface Polygon {
  /** Convex; counter-clockwise seen from above. */
  corners: number[][];
  /** Ways out of it; `edge` runs from that corner to the next, left and right as one walks out. */
  portals: {to: number; edge: number; left: number[]; right: number[]}[];
  /** The surface at its true height, three corners each. */
  triangles: number[][][];
}

/** What is made by the library lives in its memory until it is released. */
export interface Handle {
  release(): void;
}

export interface Navmesh extends Handle {
  readonly polygonCount: number;
  /** The walkable polygons, to draw and to pick from; GraphNode.polygon is a place in it. A copy. */
  polygons(axes?: Axes): Polygon[];
  session(settings?: SessionSettings): Session;
}

export interface Space extends Handle {}

export interface Session extends Handle {
  /**
   * One frame: the tracked head and the time of that pose in seconds. Fills and returns `frame`, by default one of
   * the session's own, so that frames make hardly any garbage. Odd input is reported in its flags.
   */
  frame(position: Vector3, orientation: Quaternion, seconds: number, frame?: Frame): Frame;
  /** Puts the user's next frame at another place of the virtual floor. Throws where there is no floor. */
  teleport(floor: Vector3, heading?: number): void;
  /** Directions of the tracked room; null: not known. */
  setGaze(direction: Vector3 | null): void;
  setChest(direction: Vector3 | null): void;
  setLinks(links: Link[]): void;
  setStanding(people: Standing[]): void;
  /** Goes on in another navmesh of the same building. */
  enter(navmesh: Navmesh): void;
  /**
   * The graph that the latest frame predicted, as plain objects: a copy, for drawing. Fills and returns `into`, by
   * default a new one: whoever draws every frame hands in the last and makes hardly any garbage.
   */
  graph(into?: Graph): Graph;
}

export interface Forewalk {
  readonly version: string;
  /** From the bytes of a .fwmesh (`forewalk build SCENE --out FILE.fwmesh`). Throws where they are damaged. */
  navmesh(bytes: Uint8Array): Navmesh;
  space(settings?: SpaceSettings): Space;
}

export class ForewalkError extends Error {
  /** forewalk_status of forewalk.h. */
  readonly status: number;
  constructor(status: number, message: string);
}

export const Flags: Readonly<Record<
  'firstFrame' | 'timeStoodStill' | 'timeRanBackwards' | 'timeGap' | 'trackingJump' | 'poseNotFinite' |
  'orientationNotUnit' | 'orientationUnusable' | 'outsideSpace' | 'borderNear' | 'offNavmesh' | 'snapped' |
  'graphLimit' | 'groundTaken', number>>;

/** A frame to hand to Session.frame. */
export function emptyFrame(): Frame;

/** Compiles the module; once for a page. */
export function load(): Promise<Forewalk>;
