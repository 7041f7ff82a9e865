// What is walked on: a building with its navmesh loaded, ready to predict on, to draw and to pick from.
import type {Forewalk, Navmesh, Polygon} from 'forewalk';
import {buildings, type Building} from './buildings';

export interface Ground {
  building: Building;
  navmesh: Navmesh;
  polygons: Polygon[];
  /** FNV-1a of the .fwmesh as recordings and daemons say it, 16 hexadecimal digits. */
  hash: string;
}

/** FNV-1a, 64 bits, as 16 hexadecimal digits: what `navmesh` of a recording says (service/daemon/session_bytes.h). */
export function hashOf(bytes: Uint8Array): string {
  // The prime is 2^40 + 0x1b3. In halves of 32 bits, whose products with 0x1b3 are exact in doubles.
  let low = 0x84222325;
  let high = 0xcbf29ce4;
  for (const byte of bytes) {
    low = (low ^ byte) >>> 0;
    const product = low * 0x1b3;
    high = (Math.imul(high, 0x1b3) + Math.floor(product / 0x100000000) + (low << 8)) >>> 0;
    low = product >>> 0;
  }
  return high.toString(16).padStart(8, '0') + low.toString(16).padStart(8, '0');
}

/** The scene's file without folder and ending: a building's `id`. */
export const idOf = (scene: string): string => scene.replace(/^.*[\\/]/, '').replace(/\.[^.]*$/, '');

export const bundledHashes: ReadonlyMap<string, Building> =
  new Map(buildings.map((building) => [hashOf(building.fwmesh), building]));

/** Loads a building's navmesh. Throws ForewalkError where its bytes are damaged. Some milliseconds. */
export function openGround(forewalk: Forewalk, building: Building): Ground {
  const navmesh = forewalk.navmesh(building.fwmesh);
  return {building, navmesh, polygons: navmesh.polygons(), hash: hashOf(building.fwmesh)};
}

/** A building of which only the navmesh is known: one starts in the middle of its first large polygon. */
export function buildingOf(name: string, id: string, fwmesh: Uint8Array, polygons: readonly Polygon[]): Building {
  const large = polygons.reduce((best, polygon) => areaOf(polygon) > areaOf(best) ? polygon : best, polygons[0]);
  const middle = [0, 1, 2].map((axis) =>
    large.corners.reduce((sum, corner) => sum + corner[axis], 0) / large.corners.length);
  return {name, id, fwmesh, scene: null, start: {floor: middle, heading: 0}, tour: []};
}

/** On the plan, square metres. */
export function areaOf(polygon: Polygon): number {
  const {corners} = polygon;
  let doubled = 0;
  corners.forEach((a, i) => {
    const b = corners[(i + 1) % corners.length];
    doubled += b[0] * a[2] - a[0] * b[2];
  });
  return Math.abs(doubled) / 2;
}

/**
 * The bundled building that a recording was made in, and null, or null and what to say: its navmesh's hash tells, for
 * buildings with the same name may have been built otherwise.
 */
export function groundOfRecording(scene: string, navmesh: string): [Building | null, string | null] {
  const same = bundledHashes.get(navmesh);
  if (same) return [same, null];
  const id = idOf(scene);
  const named = buildings.find((building) => building.id === id);
  if (named) {
    return [null, `The recording walks in ${id} with the navmesh ${navmesh}; the bundled one is another. Open the ` +
      `.fwmesh it was made with: forewalk build ${scene} --out ${id}.fwmesh, with the settings of then.`];
  }
  return [null, `The recording walks in ${scene || 'a scene without a name'}, which is not among the bundled ` +
    `buildings. Open its navmesh too: forewalk build ${scene || 'SCENE'} --out ${id || 'scene'}.fwmesh`];
}
