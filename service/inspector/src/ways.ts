// Shortest ways over the polygons of a navmesh, for whoever walks in the page.
//
// As navmesh/corridor.h and navmesh/funnel.h do it: A* over portals, each a step between their midpoints, then the
// corridor pulled taut. Everything is on the plan (x, -z); heights only tell storeys apart.
import type {Polygon, Vector3} from 'forewalk';

/** A place on the floor: which polygon, and where, [x, y, z] in metres. */
export interface Place {
  polygon: number;
  floor: number[];
}

const REACH = 1;  // metres beside or above the floor within which a place still counts as on it

/** Twice the area of a, b, c seen from above; positive where c lies left of the way from a to b. */
const turn = (a: Vector3, b: Vector3, c: Vector3): number =>
  (b[0] - a[0]) * (a[2] - c[2]) - (a[2] - b[2]) * (c[0] - a[0]);

const apart = (a: Vector3, b: Vector3): number => Math.hypot(a[0] - b[0], a[2] - b[2]);

/** Of the point to the segment, on the plan. */
export function distanceToSegment(point: Vector3, a: Vector3, b: Vector3): number {
  const x = b[0] - a[0], z = b[2] - a[2];
  const squared = x * x + z * z;
  const along = squared > 0 ? ((point[0] - a[0]) * x + (point[2] - a[2]) * z) / squared : 0;
  const share = Math.min(1, Math.max(0, along));
  return Math.hypot(point[0] - a[0] - share * x, point[2] - a[2] - share * z);
}

interface Half {
  to: number;
  left: number[];
  right: number[];
  middle: number[];
}

/** The ways over one navmesh. Made once, O(corners); finding a way costs O(n log n) of the portals looked at. */
export class Ways {
  private readonly halves: Half[] = [];
  private readonly first: number[] = [0];  // of a polygon's portals in `halves`
  private readonly length: Float64Array;
  private readonly previous: Int32Array;
  private readonly settled: Uint8Array;

  /** `cornerMargin`: metres kept from corners of walls, by at most a third of a portal's width. */
  constructor(private readonly polygons: readonly Polygon[], cornerMargin = 0.2) {
    const walls = this.wallCorners();
    for (const polygon of polygons) {
      for (const {to, left, right} of polygon.portals) {
        const width = apart(left, right);
        const share = width > 0 ? Math.min(cornerMargin / width, 1 / 3) : 0;
        const toward = (a: number[], b: number[]) =>
          walls.has(a.join()) ? a.map((value, i) => value + share * (b[i] - value)) : a;
        const middle = left.map((value, i) => 0.5 * (value + right[i]));
        this.halves.push({to, left: toward(left, right), right: toward(right, left), middle});
      }
      this.first.push(this.halves.length);
    }
    this.length = new Float64Array(this.halves.length);
    this.previous = new Int32Array(this.halves.length);
    this.settled = new Uint8Array(this.halves.length);
  }

  /** Both ends of every edge that leads nowhere. */
  private wallCorners(): Set<string> {
    const walls = new Set<string>();
    for (const {corners, portals} of this.polygons) {
      const open = new Set(portals.map((portal) => portal.edge));
      corners.forEach((corner, edge) => {
        if (open.has(edge)) return;
        walls.add(corner.join());
        walls.add(corners[(edge + 1) % corners.length].join());
      });
    }
    return walls;
  }

  /** The place of the floor nearest to `point`, beside and above together; null where none is within a metre. */
  locate(point: Vector3): Place | null {
    let best: Place | null = null;
    let least = REACH;
    this.polygons.forEach((polygon, index) => {
      const at = nearestOn(polygon, point);
      const y = heightAt(polygon, at);
      const off = apart(point, at) + Math.abs(y - point[1]);
      if (off < least) {
        least = off;
        best = {polygon: index, floor: [at[0], y, at[2]]};
      }
    });
    return best;
  }

  /** The points to walk to from `from` to `to`, the first left out, `to` the last; null where there is no way. */
  route(from: Place, to: Place): number[][] | null {
    const corridor = this.corridor(from, to);
    return corridor && pullTaut(from.floor, to.floor, corridor);
  }

  private corridor(from: Place, to: Place): Half[] | null {
    if (from.polygon === to.polygon) return [];
    const {halves, first, length, previous, settled} = this;
    length.fill(Infinity);
    settled.fill(0);
    const heap = new Heap();
    const relax = (half: number, reached: number, before: number) => {
      if (settled[half] || length[half] <= reached) return;
      length[half] = reached;
      previous[half] = before;
      heap.push(reached + apart(halves[half].middle, to.floor), half);
    };
    for (let half = first[from.polygon]; half < first[from.polygon + 1]; ++half) {
      relax(half, apart(from.floor, halves[half].middle), -1);
    }
    for (let half = heap.pop(); half >= 0; half = heap.pop()) {
      if (settled[half]) continue;
      settled[half] = 1;
      const {to: polygon, middle} = halves[half];
      if (polygon === to.polygon) {
        const corridor: Half[] = [];
        for (let i = half; i >= 0; i = previous[i]) corridor.unshift(halves[i]);
        return corridor;
      }
      for (let next = first[polygon]; next < first[polygon + 1]; ++next) {
        relax(next, length[half] + apart(middle, halves[next].middle), half);
      }
    }
    return null;
  }
}

function inside(polygon: Polygon, point: Vector3): boolean {
  const {corners} = polygon;
  return corners.every((corner, i) => turn(corner, corners[(i + 1) % corners.length], point) >= 0);
}

function nearestOn(polygon: Polygon, point: Vector3): Vector3 {
  if (inside(polygon, point)) return point;
  const {corners} = polygon;
  let least = Infinity;
  let nearest: Vector3 = corners[0];
  corners.forEach((a, i) => {
    const b = corners[(i + 1) % corners.length];
    const off = distanceToSegment(point, a, b);
    if (off >= least) return;
    least = off;
    const x = b[0] - a[0], z = b[2] - a[2];
    const along = ((point[0] - a[0]) * x + (point[2] - a[2]) * z) / Math.max(x * x + z * z, 1e-12);
    const share = Math.min(1, Math.max(0, along));
    nearest = a.map((value, axis) => value + share * (b[axis] - value));
  });
  return nearest;
}

/** Of the surface over a point of the polygon; where rounding leaves it beside all triangles, of the next corner. */
function heightAt({triangles, corners}: Polygon, point: Vector3): number {
  for (const [a, b, c] of triangles as [number[], number[], number[]][]) {
    const area = turn(a, b, c);
    const u = turn(point, b, c) / area, v = turn(point, c, a) / area, w = 1 - u - v;
    if (u > -1e-6 && v > -1e-6 && w > -1e-6) return u * a[1] + v * b[1] + w * c[1];
  }
  return corners.reduce((best, corner) => apart(corner, point) < apart(best, point) ? corner : best)[1];
}

/** The funnel algorithm; as in navmesh/funnel.cpp, portals beyond a corner are looked at again. */
function pullTaut(start: number[], goal: number[], corridor: Half[]): number[][] {
  const path: number[][] = [];
  let apex = start, left = start, right = start;
  let leftAt = 0, rightAt = 0;  // portals that the tip lies beyond or on
  const bendAt = (corner: number[]) => {
    if (apart(path.at(-1) ?? start, corner) > 0) path.push(corner);
    apex = left = right = corner;
  };
  for (let i = 0; i <= corridor.length;) {
    const portal = corridor[i] ?? {left: goal, right: goal};
    ++i;
    if (turn(apex, right, portal.right) >= 0) {
      if (turn(apex, left, portal.right) > 0) {
        bendAt(left);
        i = rightAt = leftAt;
        continue;
      }
      right = portal.right;
      rightAt = i;
    }
    if (turn(apex, left, portal.left) <= 0) {
      if (turn(apex, right, portal.left) < 0) {
        bendAt(right);
        i = leftAt = rightAt;
        continue;
      }
      left = portal.left;
      leftAt = i;
    }
  }
  path.push(goal);
  return path;
}

/** The least key first; of equal keys the smaller value. */
class Heap {
  private readonly keys: number[] = [];
  private readonly values: number[] = [];

  push(key: number, value: number): void {
    let at = this.keys.length;
    this.keys.push(key);
    this.values.push(value);
    while (at > 0 && this.before(at, (at - 1) >> 1)) at = this.swap(at, (at - 1) >> 1);
  }

  /** -1 where nothing is left. */
  pop(): number {
    const last = this.keys.length - 1;
    if (last < 0) return -1;
    this.swap(0, last);
    this.keys.pop();
    const value = this.values.pop()!;
    for (let at = 0;;) {
      let least = at;
      if (2 * at + 1 < last && this.before(2 * at + 1, least)) least = 2 * at + 1;
      if (2 * at + 2 < last && this.before(2 * at + 2, least)) least = 2 * at + 2;
      if (least === at) return value;
      at = this.swap(at, least);
    }
  }

  private before(a: number, b: number): boolean {
    const {keys, values} = this;
    return keys[a] !== keys[b] ? keys[a] < keys[b] : values[a] < values[b];
  }

  private swap(a: number, b: number): number {
    const {keys, values} = this;
    [keys[a], keys[b]] = [keys[b], keys[a]];
    [values[a], values[b]] = [values[b], values[a]];
    return b;
  }
}
