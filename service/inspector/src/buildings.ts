// The bundled buildings, inside the page.
import corridor from '@buildings/corridor.fwmesh?bytes';
import maze from '@buildings/maze.fwmesh?bytes';
import museum from '@buildings/museum.fwmesh?bytes';
import office from '@buildings/office.fwmesh?bytes';
import twoStorey from '@buildings/two_storey.fwmesh?bytes';
import corridorTour from '@assets/scenarios/corridor.json';
import mazeTour from '@assets/scenarios/maze.json';
import museumTour from '@assets/scenarios/museum.json';
import officeTour from '@assets/scenarios/office.json';
import twoStoreyTour from '@assets/scenarios/two_storey.json';
import corridorScene from '@assets/scenes/corridor.obj?raw';
import mazeScene from '@assets/scenes/maze.obj?raw';
import museumScene from '@assets/scenes/museum.obj?raw';
import officeScene from '@assets/scenes/office.obj?raw';
import twoStoreyScene from '@assets/scenes/two_storey.obj?raw';

/** Somewhere to walk. Positions are of the floor, metres, [x, y, z]. */
export interface Building {
  /** For people. */
  name: string;
  /** As recordings name it: the scene's file without folder and ending. */
  id: string;
  /** The navmesh, a .fwmesh. */
  fwmesh: Uint8Array;
  /** What is seen, as Wavefront OBJ in metres, +Y up; null: only the navmesh is known. */
  scene: string | null;
  /** Where a walk begins; heading in radians left of -Z. */
  start: {floor: number[]; heading: number};
  /** A walk through the building, place after place; empty: none is known. */
  tour: number[][];
}

interface Scenario {
  start: {position: number[]; heading_deg: number};
  waypoints: number[][];
}

const decode = (base64: string): Uint8Array => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));

const bundled = (name: string, id: string, fwmesh: string, scene: string, scenario: Scenario): Building => ({
  name, id, scene, fwmesh: decode(fwmesh),
  start: {floor: scenario.start.position, heading: scenario.start.heading_deg * Math.PI / 180},
  tour: scenario.waypoints,
});

export const buildings: Building[] = [
  bundled('Museum', 'museum', museum, museumScene, museumTour),
  bundled('Office', 'office', office, officeScene, officeTour),
  bundled('Two storeys', 'two_storey', twoStorey, twoStoreyScene, twoStoreyTour),
  bundled('Maze', 'maze', maze, mazeScene, mazeTour),
  bundled('Corridor', 'corridor', corridor, corridorScene, corridorTour),
];
