// The room that is walked in: what is tracked, and which part of it a head may use.
//
// Places are [x, z] of the WebXR reference space, metres, as in the page's other rooms (src/room.ts). Rings have no
// closing repeat and run in either direction.
import {
  areaD, ClipType, Clipper, EndType, FillRule, JoinType, PolyTreeD, type PathD, type PathsD, type PolyPathD,
} from 'clipper2-ts';
import type {Point2} from 'forewalk';
import {extentOf, rectangle, type Room} from '../room';

/** A room as it is. Obstacles may overlap each other and the border. */
export interface TrackedRoom {
  /** For people. */
  name: string;
  border: Point2[];
  obstacles: Point2[][];
}

/** Where heads may go: a border with holes that neither cross nor touch. */
export interface FreeFloor extends Room {
  /** m^2, without the holes. */
  area: number;
  /** The place farthest from every border and hole, and how far that is, metres. */
  middle: Point2;
  clearance: number;
}

/** Kept from walls and furniture unless told otherwise, metres: a head is no point, and feet stop late. */
export const MARGIN = 0.1;

const BODY = 0.2;       // metres; narrower than twice this nobody stands
const CLEARANCE = 0.5;  // metres; of a floor whose widest place is narrower nothing can be made
const FARTHEST = 50;    // metres from the origin; what lies beyond is no room
const DIGITS = 4;       // of coordinates, in metres

const path = (ring: readonly Point2[]): PathD => ring.map(([x, y]) => ({x, y}));
const ring = (points: PathD): Point2[] => points.map(({x, y}) => [x, y]);

/** Grows (or with less than 0 shrinks) rings; corners stay corners. */
const grown = (paths: PathsD, metres: number): PathsD =>
  Clipper.inflatePathsD(paths, metres, JoinType.Miter, EndType.Polygon, 4, DIGITS);

/** A rectangle about the origin, metres. */
export const rectangularRoom = (width: number, depth: number): TrackedRoom =>
  ({name: `${width} m x ${depth} m`, border: rectangle(width, depth).border, obstacles: []});

/** m^2 inside a ring, less than 0 where it runs clockwise as drawn with z up (counter-clockwise from above). */
export const areaOf = (corners: readonly Point2[]): number => areaD(path(corners));

const turn = (a: Point2, b: Point2, c: Point2): number =>
  (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

const cross = (a: Point2, b: Point2, c: Point2, d: Point2): boolean =>
  turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;

const spoken = ([x, z]: Point2): string => `${x.toFixed(2)} m right, ${(-z).toFixed(2)} m ahead`;

/** Why a border can't be walked in, a sentence for people; null where it can. */
export function problemOf(border: readonly Point2[]): string | null {
  if (border.length < 3) return `The room has ${border.length} corners; at least 3 are needed.`;
  const far = border.find((corner) => !corner.every((value) => Math.abs(value) <= FARTHEST));
  if (far) return `A corner lies ${spoken(far)}; give metres within ${FARTHEST} m.`;
  const count = border.length;
  for (let i = 0; i < count; ++i) {
    for (let j = i + 2; j < count; ++j) {
      if (i === 0 && j === count - 1) continue;
      if (cross(border[i], border[i + 1], border[j], border[(j + 1) % count])) {
        return `Two walls cross: the one from ${spoken(border[i])} and the one from ${spoken(border[j])}.`;
      }
    }
  }
  const {clearance} = freest(outlines([border]));
  if (clearance >= CLEARANCE) return null;
  return `The room is too narrow: its widest place is ${clearance.toFixed(2)} m from a wall, and ${CLEARANCE} m are ` +
    'needed.';
}

/** The place farthest from all rings, by shrinking them until nothing is left. */
function freest(rings: PathsD): {middle: Point2; clearance: number} {
  let clearance = 0, most = FARTHEST, left = rings;
  while (most - clearance > 1e-3) {
    const tried = 0.5 * (clearance + most);
    const shrunk = grown(rings, -tried);
    if (shrunk.length > 0) [clearance, left] = [tried, shrunk];
    else most = tried;
  }
  const corners = left[0] ?? [];
  const middle: Point2 = [0, 1].map((axis) =>
    corners.reduce((sum, {x, y}) => sum + (axis === 0 ? x : y), 0) / Math.max(1, corners.length)) as Point2;
  return {middle, clearance};
}

/** The parts of a floor, each its outline and then its holes; the largest first. */
function parts(tree: PolyTreeD): PathsD[] {
  const found: PathsD[] = [];
  const visit = (outline: PolyPathD) => {
    const rings: PathsD = [outline.poly!];
    for (let i = 0; i < outline.count; ++i) {
      const hole = outline.child(i);
      rings.push(hole.poly!);
      for (let j = 0; j < hole.count; ++j) visit(hole.child(j));
    }
    found.push(rings);
  };
  for (let i = 0; i < tree.count; ++i) visit(tree.child(i));
  const floor = (rings: PathsD) => rings.reduce((sum, points) => sum + areaD(points), 0);
  return found.sort((a, b) => floor(b) - floor(a));
}

function combined(type: ClipType, subject: PathsD, clip: PathsD): PathsD[] {
  const tree = new PolyTreeD();
  Clipper.booleanOpDWithPolyTree(type, subject, clip, tree, FillRule.NonZero, DIGITS);
  return parts(tree);
}

/**
 * The largest connected part of the room in which a body fits and which keeps `margin` metres from walls and
 * obstacles. Throws, with a sentence for people, where none is left.
 */
export function freeFloor(room: TrackedRoom, margin = MARGIN): FreeFloor {
  const inner = grown(outlines([room.border]), -margin);
  const taken = grown(combined(ClipType.Union, outlines(room.obstacles), []).flat(), margin);
  // Slits that nobody fits through are filled: shrunk by half a body and grown again.
  const all = combined(ClipType.Difference, inner, taken);
  const fitting = combined(ClipType.Union, grown(all.flat(), -BODY), [])[0];
  const floor = fitting && combined(ClipType.Intersection, grown(fitting, BODY), all.flat())[0];
  const {middle, clearance} = floor ? freest(floor) : {middle: [0, 0] as Point2, clearance: 0};
  if (!floor || clearance < CLEARANCE - margin) {
    throw new Error(`${room.name}: too little of the floor is free. At its widest place ${clearance.toFixed(2)} m ` +
      `are left on each side; ${(CLEARANCE - margin).toFixed(2)} m are needed. Move furniture out, or draw a larger ` +
      'room.');
  }
  const [border, ...holes] = floor.map(ring);
  const area = floor.reduce((sum, points) => sum + areaD(points), 0);
  return {border, holes, area, middle, clearance};
}

/** All rings the same way round, as what is filled. */
const outlines = (rings: readonly (readonly Point2[])[]): PathsD =>
  rings.map((corners) => areaOf(corners) < 0 ? path(corners).reverse() : path(corners));

/**
 * The room that a headset says it has (XRBoundedReferenceSpace.boundsGeometry), or why it can't be used: it says
 * none, crosses itself, or measures less than 2 m.
 */
export function roomFromBounds(
    bounds: readonly {x: number; z: number}[] | null | undefined): TrackedRoom | {problem: string} {
  if (!bounds || bounds.length < 3) return {problem: 'The headset says no bounds of its room.'};
  const border = bounds.map(({x, z}): Point2 => [x, z]);
  const problem = problemOf(border);
  if (problem) return {problem: `The headset's bounds can't be used. ${problem}`};
  const {left, right, front, back} = extentOf({border, holes: []});
  const sides = [right - left, back - front];
  if (Math.min(...sides) < 2) {
    const measured = sides.map((side) => `${side.toFixed(1)} m`).join(' x ');
    return {problem: `The headset's bounds measure ${measured}; 2 m are needed.`};
  }
  return {name: 'as the headset says', border, obstacles: []};
}
