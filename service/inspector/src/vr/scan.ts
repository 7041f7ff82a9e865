// Rooms as headsets scan them: captures of @iwer/sem, which are what Meta's scene API says of a room.
//
// Walls are planes whose ends nearly meet; furniture is boxes. Pure, without the page: vite.config.ts turns the
// captures, up to 2 MB each, into some corners while building.
import type {Point2} from 'forewalk';
import {areaOf, type TrackedRoom} from './room';

interface Vector {
  x: number;
  y: number;
  z: number;
}

/** The part of a capture that is read; metres, +Y up. */
export interface Capture {
  spatialEntities: {
    semanticLabel_META?: string;
    locatable_META: {position: Vector; orientation: Vector & {w: number}};
    /** In the entity's own x and y. */
    bounded2D_META?: {offset: {x: number; y: number}; extent: {width: number; height: number}};
    bounded3D_META?: {offset: Vector; extent: {width: number; height: number; depth: number}};
  }[];
}

type Entity = Capture['spatialEntities'][number];

const MEETING = 0.3;    // metres between the ends of neighbouring walls, at most
const OVERHEAD = 2;     // metres above the floor; what hangs higher is walked under
const SAME = 0.02;      // metres between corners that are taken for one
const SMALLEST = 0.04;  // m^2 of the floor; what takes less is stepped around

/** A point of an entity, given in its own axes, in the capture's. */
function placed({locatable_META: {position, orientation: q}}: Entity, x: number, y: number, z: number): Vector {
  const tx = 2 * (q.y * z - q.z * y), ty = 2 * (q.z * x - q.x * z), tz = 2 * (q.x * y - q.y * x);
  return {
    x: position.x + x + q.w * tx + q.y * tz - q.z * ty,
    y: position.y + y + q.w * ty + q.z * tx - q.x * tz,
    z: position.z + z + q.w * tz + q.x * ty - q.y * tx,
  };
}

const plan = ({x, z}: Vector): Point2 => [x, z];
const apart = (a: Point2, b: Point2): number => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** Both ends of a wall on the plan. */
function endsOf(wall: Entity): [Point2, Point2] {
  const {offset, extent} = wall.bounded2D_META!;
  const middle = offset.y + extent.height / 2;
  return [plan(placed(wall, offset.x, middle, 0)), plan(placed(wall, offset.x + extent.width, middle, 0))];
}

/** Where the lines through two walls meet; halfway between their ends where they meet far from there. */
function corner([a, b]: [Point2, Point2], [c, d]: [Point2, Point2]): Point2 {
  const halfway: Point2 = [(b[0] + c[0]) / 2, (b[1] + c[1]) / 2];
  const x = b[0] - a[0], y = b[1] - a[1], u = d[0] - c[0], v = d[1] - c[1];
  const parallel = x * v - y * u;
  if (Math.abs(parallel) < 0.1 * Math.hypot(x, y) * Math.hypot(u, v)) return halfway;
  const along = ((c[0] - a[0]) * v - (c[1] - a[1]) * u) / parallel;
  const met: Point2 = [a[0] + along * x, a[1] + along * y];
  return apart(met, halfway) < MEETING ? met : halfway;
}

/** Walls one after the other around the room, each [from, to], and the widest gap between two of them, metres. */
export function chainOfWalls(capture: Capture): {walls: [Point2, Point2][]; gap: number} {
  const left = capture.spatialEntities.filter((entity) =>
    /^WALL_FACE$|^INVISIBLE_WALL_FACE$/.test(entity.semanticLabel_META ?? '') && entity.bounded2D_META).map(endsOf);
  const walls = left.splice(0, 1);
  let gap = 0;
  while (left.length > 0) {
    const end = walls.at(-1)![1];
    let nearest = Infinity, best = 0;
    left.forEach(([a, b], i) => {
      const off = Math.min(apart(end, a), apart(end, b));
      if (off < nearest) [nearest, best] = [off, i];
    });
    const [[a, b]] = left.splice(best, 1) as [[Point2, Point2]];
    walls.push(apart(end, a) <= apart(end, b) ? [a, b] : [b, a]);
    gap = Math.max(gap, nearest);
  }
  if (walls.length > 0) gap = Math.max(gap, apart(walls.at(-1)![1], walls[0][0]));
  return {walls, gap};
}

/** The smallest convex ring around points (Andrew 1979). */
function hull(points: Point2[]): Point2[] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (order: Point2[]) => {
    const chain: Point2[] = [];
    for (const point of order) {
      while (chain.length >= 2) {
        const [a, b] = chain.slice(-2) as [Point2, Point2];
        if ((b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) > 1e-9) break;
        chain.pop();
      }
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** What a box takes of the floor; null where nothing that matters. */
function footprint(box: Entity, floor: number): Point2[] | null {
  const {offset, extent} = box.bounded3D_META!;
  const {width, height, depth} = extent;
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
    placed(box, offset.x + (i & 1) * width, offset.y + ((i >> 1) & 1) * height, offset.z + (i >> 2) * depth));
  if (Math.min(...corners.map(({y}) => y)) - floor > OVERHEAD) return null;
  const outline = hull(corners.map(plan));
  // Of a box that leans a little, top and bottom differ by less than matters.
  const distinct = outline.filter((point, i) => apart(point, outline.at(i - 1)!) > SAME);
  return areaOf(distinct) < SMALLEST ? null : distinct;
}

/** The room of a capture, as it is. Throws where its walls do not close to one ring. */
export function roomFromCapture(name: string, capture: Capture): TrackedRoom {
  const {walls, gap} = chainOfWalls(capture);
  if (walls.length < 3) throw new Error(`${name}: ${walls.length} walls in the capture, at least 3 are needed.`);
  if (gap > MEETING) {
    throw new Error(`${name}: two walls that should meet are ${gap.toFixed(2)} m apart, at most ${MEETING} m close a ` +
      'room.');
  }
  const border = walls.map((wall, i) => corner(walls.at(i - 1)!, wall));
  const floor = capture.spatialEntities.find((entity) => entity.semanticLabel_META === 'FLOOR');
  const height = floor?.locatable_META.position.y ?? 0;
  const obstacles = capture.spatialEntities.filter((entity) => entity.bounded3D_META)
    .map((box) => footprint(box, height)).filter((outline) => outline !== null);
  return {name, border, obstacles};
}
