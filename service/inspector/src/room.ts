// The tracked room as the page draws it: corners [x, z] in metres, as recordings have them.
import type {Point2, SessionSettings} from 'forewalk';

export interface Room {
  border: Point2[];
  holes: Point2[][];
}

/** The nearest point of the room's edges to a body, filled in by `nearestBorder`. */
export interface Nearest {
  x: number;
  z: number;
  /** Metres; below 0 outside the room and in its holes. */
  distance: number;
}

// As the library makes a circle (rdw/tracked_space.h).
const CIRCLE_CORNERS = 96;

export const rectangle = (width: number, depth: number): Room => ({
  border: [[-width / 2, depth / 2], [width / 2, depth / 2], [width / 2, -depth / 2], [-width / 2, -depth / 2]],
  holes: [],
});

const isPoint = (value: unknown): value is Point2 =>
  Array.isArray(value) && value.length === 2 && value.every(Number.isFinite);
const isRing = (value: unknown): value is Point2[] => Array.isArray(value) && value.length >= 3 && value.every(isPoint);

/** The room of a recording's settings, `forewalk.space/1` without its format; null where it cannot be drawn. */
export function roomFromJson(space: unknown): Room | null {
  if (space === undefined) return rectangle(6, 6);  // as sessions have it by default
  if (typeof space !== 'object' || space === null) return null;
  const {rectangle: sides, circle, polygon, holes} = space as Record<string, unknown>;
  if (isPoint(sides)) return rectangle(sides[0], sides[1]);
  if (typeof circle === 'number') {
    return {
      border: Array.from({length: CIRCLE_CORNERS}, (_, i): Point2 => {
        const angle = 2 * Math.PI * i / CIRCLE_CORNERS;
        return [-circle * Math.sin(angle), -circle * Math.cos(angle)];
      }),
      holes: [],
    };
  }
  if (!isRing(polygon)) return null;
  return {border: polygon, holes: Array.isArray(holes) ? holes.filter(isRing) : []};
}

export const roomToJson = (room: Room): object => ({polygon: room.border, holes: room.holes});

/** The same for a session of the library, whose second axis is forward. */
export function roomForSession(room: Room): Pick<SessionSettings, 'border' | 'holes'> {
  const forward = (ring: Point2[]): Point2[] => ring.map(([x, z]): Point2 => [x, -z]);
  return {border: forward(room.border), holes: room.holes.map(forward)};
}

/** Smallest and largest x and z. */
export function extentOf(room: Room): {left: number; right: number; front: number; back: number} {
  const xs = room.border.map(([x]) => x);
  const zs = room.border.map(([, z]) => z);
  return {left: Math.min(...xs), right: Math.max(...xs), front: Math.min(...zs), back: Math.max(...zs)};
}

function visit(ring: Point2[], x: number, z: number, nearest: Nearest): boolean {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const ax = ring[j][0], az = ring[j][1], bx = ring[i][0], bz = ring[i][1];
    const dx = bx - ax, dz = bz - az;
    const squared = dx * dx + dz * dz;
    const along = squared > 0 ? Math.min(1, Math.max(0, ((x - ax) * dx + (z - az) * dz) / squared)) : 0;
    const px = ax + along * dx, pz = az + along * dz;
    const distance = Math.hypot(x - px, z - pz);
    if (distance < nearest.distance) {
      nearest.distance = distance;
      nearest.x = px;
      nearest.z = pz;
    }
    if ((az > z) !== (bz > z) && x < ax + (z - az) * dx / dz) inside = !inside;
  }
  return inside;
}

/** Fills `nearest`. O(corners); makes nothing. */
export function nearestBorder(room: Room, x: number, z: number, nearest: Nearest): Nearest {
  nearest.distance = Infinity;
  let free = visit(room.border, x, z, nearest);
  for (const hole of room.holes) if (visit(hole, x, z, nearest)) free = false;
  if (!free) nearest.distance = -nearest.distance;
  return nearest;
}
