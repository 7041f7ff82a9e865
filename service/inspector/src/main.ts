import {load} from 'forewalk';
import {buildings} from './buildings';
import {offerVr} from './vr/offer';

const forewalk = await load();
const main = document.getElementById('inspector')!;
main.textContent = buildings.map((building) =>
  `${building.name}: ${forewalk.navmesh(building.fwmesh).polygonCount} polygons`).join(', ');
offerVr(document.querySelector<HTMLButtonElement>('#enter-vr')!, forewalk, buildings);
