// A building to stand in: opaque, in daylight, with patterns on floor and walls by which one sees oneself move.
//
// For headsets that draw with a phone's means: the building is three draw calls, lit without shadows; patterns are two
// small textures, and the darker foot of the walls is in the corners' colours.
import {
  BackSide, BufferAttribute, CanvasTexture, Color, DirectionalLight, Fog, Group, HemisphereLight, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry, RepeatWrapping, Scene, SphereGeometry, SRGBColorSpace,
  type BufferGeometry,
} from 'three';
import type {Polygon} from 'forewalk';
import {makeBuildingModel, type BuildingModel, type BuildingTheme} from '../building_model';
import type {Building} from '../buildings';
import {uniformNumbers} from '../walker';

const theme: BuildingTheme = {
  floor: '#cfae86', wall: '#fbf8f1', furniture: '#7d9aa3', cut: '#000000', walkable: '#000000', walkableOpacity: 0,
  portal: '#000000', border: '#000000', sky: '#eef4ff', ground: '#b3a48e',
};
const ZENITH = '#7fb0e6', HORIZON = '#e6eef5', EARTH = '#8d9a80';
const FAR = 90;  // metres to where the fog has taken all

/** A scene with sky, light and the building in it. Give it back with `dispose`. */
export class Scenery extends Scene {
  private readonly model: BuildingModel;

  constructor(building: Building, polygons: readonly Polygon[]) {
    super();
    this.model = makeBuildingModel(building, polygons, theme);
    this.model.showWalkable(building.scene === null);
    for (const part of this.model.children) {
      if (!(part instanceof Mesh) || !(part.material instanceof MeshLambertMaterial)) continue;
      pattern(part.geometry as BufferGeometry, part.name === 'floor' ? 3 : 2);
      part.material.map = part.name === 'floor' ? planks() : part.name === 'wall' ? plaster() : null;
      part.material.vertexColors = true;
      part.material.needsUpdate = true;
    }
    this.fog = new Fog(HORIZON, FAR / 3, FAR);
    this.add(this.model, daylight(), surroundings());
    this.matrixWorldAutoUpdate = true;
  }

  dispose(): void {
    this.model.dispose();
    this.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      part.geometry.dispose();
      part.material.map?.dispose();
      part.material.dispose();
    });
  }
}

// Brighter than over the plans of the page: walls are white, and seen from within.
function daylight(): Group {
  const sun = new DirectionalLight('#fff3df', 1.6);
  sun.position.set(-0.6, 1, 0.35);
  return new Group().add(new HemisphereLight(theme.sky, theme.ground, 3), sun);
}

function surroundings(): Group {
  const group = new Group();
  const dome = new SphereGeometry(FAR * 2, 24, 12);
  const height = dome.getAttribute('position');
  const colors = new Float32Array(3 * height.count);
  const zenith = new Color(ZENITH), horizon = new Color(HORIZON), mixed = new Color();
  for (let i = 0; i < height.count; ++i) {
    const up = Math.max(0, height.getY(i) / (FAR * 2));
    mixed.lerpColors(horizon, zenith, Math.sqrt(up)).toArray(colors, 3 * i);
  }
  dome.setAttribute('color', new BufferAttribute(colors, 3));
  const sky = new Mesh(
    dome, new MeshBasicMaterial({vertexColors: true, side: BackSide, fog: false, depthWrite: false}));
  sky.renderOrder = -1;
  const earth = new Mesh(new PlaneGeometry(4 * FAR, 4 * FAR), new MeshBasicMaterial({color: EARTH}));
  earth.rotation.x = -Math.PI / 2;
  earth.position.y = -0.15;
  group.add(sky, earth);
  return group;
}

/** Lays a pattern that repeats every `metres` on all faces, and darkens what is near a floor. */
function pattern(geometry: BufferGeometry, metres: number): void {
  const position = geometry.getAttribute('position'), normal = geometry.getAttribute('normal');
  const uv = new Float32Array(2 * position.count), shade = new Float32Array(3 * position.count);
  for (let i = 0; i < position.count; ++i) {
    const x = position.getX(i), y = position.getY(i), z = position.getZ(i);
    const nx = Math.abs(normal.getX(i)), ny = Math.abs(normal.getY(i)), nz = Math.abs(normal.getZ(i));
    const upright = ny < Math.max(nx, nz);
    uv[2 * i] = (upright && nx > nz ? z : x) / metres;
    uv[2 * i + 1] = (upright ? y : z) / metres;
    shade.fill(upright && y < 0.2 ? 0.84 : 1, 3 * i, 3 * i + 3);
  }
  geometry.setAttribute('uv', new BufferAttribute(uv, 2));
  geometry.setAttribute('color', new BufferAttribute(shade, 3));
}

function texture(side: number, draw: (context: CanvasRenderingContext2D) => void): CanvasTexture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = side;
  draw(canvas.getContext('2d')!);
  const made = new CanvasTexture(canvas);
  made.wrapS = made.wrapT = RepeatWrapping;
  made.colorSpace = SRGBColorSpace;
  made.anisotropy = 8;
  return made;
}

/** Boards, 3 m of them: rows of 0.2 m. */
const planks = () => texture(512, (context) => {
  const uniform = uniformNumbers(7);
  const rows = 15, row = 512 / rows;
  context.fillStyle = '#b5aa9c';
  context.fillRect(0, 0, 512, 512);
  for (let i = 0; i < rows; ++i) {
    const offset = uniform() * 512;
    for (let j = 0; j < 3; ++j) {
      const light = 222 + 30 * uniform();
      context.fillStyle = `rgb(${light}, ${light - 3}, ${light - 8})`;
      for (const wrap of [-512, 0, 512]) {
        context.fillRect(offset + j * 512 / 3 + wrap, i * row, 512 / 3 - 1.5, row - 1.5);
      }
    }
    context.fillStyle = 'rgba(70, 50, 30, 0.05)';
    for (let j = 0; j < 14; ++j) context.fillRect(uniform() * 512, i * row + uniform() * row, 40 + 120 * uniform(), 1);
  }
});

/** Panels of 1 m, in 2 m of wall. */
const plaster = () => texture(512, (context) => {
  const uniform = uniformNumbers(11);
  context.fillStyle = '#fbfaf7';
  context.fillRect(0, 0, 512, 512);
  for (let i = 0; i < 2500; ++i) {
    context.fillStyle = `rgba(120, 110, 95, ${0.03 * uniform()})`;
    context.fillRect(512 * uniform(), 512 * uniform(), 3 + 9 * uniform(), 2 + 4 * uniform());
  }
  context.fillStyle = 'rgba(90, 80, 65, 0.22)';
  for (const x of [0, 256]) context.fillRect(x, 0, 1.5, 512);
});
