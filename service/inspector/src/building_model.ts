// A building as a three.js model: what is seen (floor, walls, furniture) and where one can walk (the navmesh's
// polygons with their edges).
//
// A handful of draw calls whatever the building's size: the scene's groups are merged by what they are. Walls can be
// cut at a height, as an architect's plan is: whoever looks from above sees in. The cut faces are the walls' inner
// sides in one flat colour, which looks solid because the walls are closed boxes.
import {
  BackSide, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, FrontSide, Group, HemisphereLight,
  LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, Plane, Vector3, type Material,
} from 'three';
import {OBJLoader} from 'three/examples/jsm/loaders/OBJLoader.js';
import {mergeGeometries} from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import type {Polygon} from 'forewalk';
import type {Building} from './buildings';

/** Colours as CSS writes them. */
export interface BuildingTheme {
  floor: string;
  wall: string;
  furniture: string;
  /** Of what a cut goes through. */
  cut: string;
  /** The walkable polygons, laid over the floor with this opacity, 0 to 1. */
  walkable: string;
  walkableOpacity: number;
  /** Edges of polygons: what one walks through, and where it ends. */
  portal: string;
  border: string;
  /** Of the light from above and from below. */
  sky: string;
  ground: string;
}

export type Part = 'floor' | 'wall' | 'furniture';

// The polygons lie a little over the floor, so that neither shows through the other, metres.
const LIFT = 0.02;
// Light from above and below, and from a sun that tells the walls' sides apart.
const DAYLIGHT = 2.2;
const SUN = 1.3;
const SUN_FROM = new Vector3(-0.5, 1, 0.3).normalize();
// What stands for walls where only the navmesh is known, metres.
const CURB = 0.12;

/** What a group of a scene is, from its name; unnamed things are furniture. */
export function partOf(group: string): Part {
  if (/floor|slab|stairs|ground$|ramp/i.test(group) && !/wall|furniture/i.test(group)) return 'floor';
  if (/wall|spine|partition|column|railing|washroom/i.test(group)) return 'wall';
  return 'furniture';
}

/**
 * How walls are lit: by the lights of the scene they are in, or with `makeLights`' light painted on, which costs less for
 * every pixel.
 */
export type Lighting = 'lights' | 'painted';

export class BuildingModel extends Group {
  private readonly plane = new Plane(new Vector3(0, -1, 0), Infinity);
  private readonly surfaces: Record<Part, MeshLambertMaterial | MeshBasicMaterial>;
  /** Whether floors lie above floors, which a cut has to take away. */
  private readonly storeys: boolean;
  private readonly cutFaces: MeshBasicMaterial;
  private readonly walkableMaterial: MeshBasicMaterial;
  private readonly portalMaterial: LineBasicMaterial;
  private readonly borderMaterial: LineBasicMaterial;
  private readonly capped: Mesh[] = [];
  /** The polygons' surface, to pick from: three corners after the other, no index. */
  readonly walkable: Mesh;
  /** For each triangle of `walkable`, its polygon. */
  readonly polygonOfTriangle: Uint32Array;

  constructor(building: Building, polygons: readonly Polygon[], theme: BuildingTheme, lighting: Lighting) {
    super();
    this.name = building.id;
    const material = () => lighting === 'lights' ? new MeshLambertMaterial({side: FrontSide})
      : new MeshBasicMaterial({side: FrontSide, vertexColors: true});
    this.surfaces = {floor: material(), wall: material(), furniture: material()};
    this.storeys = areStoreys(polygons);
    // A floor without thickness is seen from below as well, from a storey beneath.
    if (this.storeys) this.surfaces.floor.side = DoubleSide;
    this.cutFaces = new MeshBasicMaterial({side: BackSide});
    this.walkableMaterial = new MeshBasicMaterial();
    this.portalMaterial = new LineBasicMaterial({transparent: true, opacity: 0.55});
    this.borderMaterial = new LineBasicMaterial();

    for (const [part, geometry] of parts(building, polygons)) {
      const mesh = new Mesh(geometry, this.surfaces[part]);
      mesh.name = part;
      mesh.renderOrder = part === 'floor' ? 0 : -2;  // what hides others first
      this.add(mesh);
      if (part === 'floor') continue;
      const cap = new Mesh(geometry, this.cutFaces);
      cap.name = `${part} cut`;
      cap.visible = false;
      cap.renderOrder = -2;
      this.capped.push(cap);
      this.add(cap);
    }
    [this.walkable, this.polygonOfTriangle] = surface(polygons, this.walkableMaterial);
    const [portals, borders] = edges(polygons);
    this.add(this.walkable, lines('portals', portals, this.portalMaterial),
      lines('borders', borders, this.borderMaterial));
    this.setTheme(theme);
  }

  setTheme(theme: BuildingTheme): void {
    for (const part of ['floor', 'wall', 'furniture'] as const) this.surfaces[part].color.set(theme[part]);
    for (const child of this.children) {
      if (child instanceof Mesh && Object.values<Material>(this.surfaces).includes(child.material as Material) &&
        child.material instanceof MeshBasicMaterial) paint(child.geometry as BufferGeometry, theme);
    }
    this.cutFaces.color.set(theme.cut);
    // Laid over the floor as one opaque colour: nothing is drawn twice.
    const lit = new Color(theme.floor).multiply(lightOn(0, 1, 0, theme, new Color())).convertLinearToSRGB();
    const tint = new Color(theme.walkable).convertLinearToSRGB();
    this.walkableMaterial.color.copy(lit.lerp(tint, theme.walkableOpacity).convertSRGBToLinear());
    this.portalMaterial.color.set(theme.portal);
    this.borderMaterial.color.set(theme.border);
  }

  /**
   * Takes away all that is higher than `height`, metres; null: nothing. Only where the renderer has
   * `localClippingEnabled`. Cheap where the height changes from frame to frame.
   */
  cutAt(height: number | null): void {
    const planes = height === null ? null : [this.plane];
    if (height !== null) this.plane.constant = height;
    for (const cap of this.capped) cap.visible = height !== null;
    if (this.cutFaces.clippingPlanes === planes || (planes && this.cutFaces.clippingPlanes)) return;
    for (const material of this.cutMaterials()) {
      material.clippingPlanes = planes;
      material.needsUpdate = true;
    }
  }

  /** Whether the polygons and their edges are seen; they can be picked all the same. */
  showWalkable(shown: boolean): void {
    this.walkableMaterial.visible = shown;
    this.portalMaterial.visible = shown;
    this.borderMaterial.visible = shown;
  }

  /** Gives back what it holds on the graphics card. */
  dispose(): void {
    this.traverse((object) => {
      if (object instanceof Mesh || object instanceof LineSegments) object.geometry.dispose();
    });
    for (const material of this.materials()) material.dispose();
  }

  private cutMaterials(): Material[] {
    return this.storeys ? this.materials() : [this.surfaces.wall, this.surfaces.furniture, this.cutFaces];
  }

  private materials(): Material[] {
    return [...Object.values(this.surfaces), this.cutFaces, this.walkableMaterial, this.portalMaterial,
      this.borderMaterial];
  }
}

/**
 * The model of a building whose navmesh has these polygons (`navmesh.polygons()`). World axes, metres. A building
 * whose scene is not known gets curbs where its walkable ground ends. Some ten milliseconds for the bundled ones.
 */
export function makeBuildingModel(building: Building, polygons: readonly Polygon[], theme: BuildingTheme,
                                  lighting: Lighting = 'lights'): BuildingModel {
  return new BuildingModel(building, polygons, theme, lighting);
}

/** Light to see it in, for `lighting` 'lights', and for what else is in the scene. */
export function makeLights(theme: BuildingTheme): Group {
  const lights = new Group();
  const sun = new DirectionalLight(new Color('#ffffff'), SUN);
  sun.position.copy(SUN_FROM);
  lights.add(new HemisphereLight(new Color(theme.sky), new Color(theme.ground), DAYLIGHT), sun);
  return lights;
}

/** What of it falls on a side with this normal, as three's Lambert material has it. */
function lightOn(x: number, y: number, z: number, theme: BuildingTheme, light: Color): Color {
  const sun = SUN * Math.max(0, x * SUN_FROM.x + y * SUN_FROM.y + z * SUN_FROM.z);
  light.set(theme.ground).lerp(new Color(theme.sky), 0.5 * y + 0.5).multiplyScalar(DAYLIGHT);
  return light.setRGB(light.r + sun, light.g + sun, light.b + sun).multiplyScalar(1 / Math.PI);
}

/** Paints that light on a geometry's corners. */
function paint(geometry: BufferGeometry, theme: BuildingTheme): void {
  const normals = geometry.getAttribute('normal');
  const colors = new Float32Array(3 * normals.count);
  const light = new Color();
  for (let i = 0; i < normals.count; ++i) {
    lightOn(normals.getX(i), normals.getY(i), normals.getZ(i), theme, light).toArray(colors, 3 * i);
  }
  geometry.setAttribute('color', new BufferAttribute(colors, 3));
}

/** Whether one polygon's floor lies more than a person above another's. */
function areStoreys(polygons: readonly Polygon[]): boolean {
  const heights = polygons.flatMap((polygon) => polygon.corners.map((corner) => corner[1]));
  const low = heights.reduce((a, b) => Math.min(a, b), Infinity);
  const high = heights.reduce((a, b) => Math.max(a, b), -Infinity);
  return high - low > 1.8;
}

function parts(building: Building, polygons: readonly Polygon[]): Map<Part, BufferGeometry> {
  const merged = new Map<Part, BufferGeometry>();
  if (building.scene === null) {
    merged.set('wall', curbs(polygons));
    return merged;
  }
  const found = new Map<Part, BufferGeometry[]>();
  new OBJLoader().parse(building.scene).traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const geometry = object.geometry as BufferGeometry;
    geometry.deleteAttribute('uv');
    geometry.deleteAttribute('color');
    geometry.clearGroups();
    const part = partOf(object.name);
    found.set(part, [...found.get(part) ?? [], geometry]);
  });
  for (const [part, geometries] of found) {
    merged.set(part, mergeGeometries(geometries));
    for (const geometry of geometries) geometry.dispose();
  }
  return merged;
}

function surface(polygons: readonly Polygon[], material: Material): [Mesh, Uint32Array] {
  const count = polygons.reduce((sum, polygon) => sum + polygon.triangles.length, 0);
  const positions = new Float32Array(9 * count);
  const owners = new Uint32Array(count);
  let at = 0;
  polygons.forEach((polygon, owner) => {
    for (const triangle of polygon.triangles) {
      owners[at] = owner;
      triangle.forEach((corner, i) => positions.set([corner[0], corner[1] + LIFT, corner[2]], 9 * at + 3 * i));
      ++at;
    }
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  const mesh = new Mesh(geometry, material);
  mesh.name = 'walkable';
  return [mesh, owners];
}

/** Ends of edges that one walks through, once each, and of those where the ground ends. */
function edges(polygons: readonly Polygon[]): [number[], number[]] {
  const portals: number[] = [];
  const borders: number[] = [];
  const add = (list: number[], a: number[], b: number[]) =>
    list.push(a[0], a[1] + 1.5 * LIFT, a[2], b[0], b[1] + 1.5 * LIFT, b[2]);
  polygons.forEach((polygon, id) => {
    for (const portal of polygon.portals) if (id < portal.to) add(portals, portal.left, portal.right);
    for (const [a, b] of borderEdges(polygon)) add(borders, a, b);
  });
  return [portals, borders];
}

function borderEdges(polygon: Polygon): [number[], number[]][] {
  const open = new Set(polygon.portals.map((portal) => portal.edge));
  return polygon.corners.flatMap((corner, i): [number[], number[]][] =>
    open.has(i) ? [] : [[corner, polygon.corners[(i + 1) % polygon.corners.length]]]);
}

function curbs(polygons: readonly Polygon[]): BufferGeometry {
  const positions: number[] = [];
  for (const polygon of polygons) {
    for (const [a, b] of borderEdges(polygon)) {
      const wall = [a[0], a[1], a[2], b[0], b[1], b[2], b[0], b[1] + CURB, b[2],
        a[0], a[1], a[2], b[0], b[1] + CURB, b[2], a[0], a[1] + CURB, a[2]];
      positions.push(...wall);
      // The same from its other side.
      for (let corner = 0; corner < 18; corner += 9) {
        for (const from of [0, 6, 3]) positions.push(...wall.slice(corner + from, corner + from + 3));
      }
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  geometry.computeVertexNormals();
  return geometry;
}

function lines(name: string, positions: number[], material: LineBasicMaterial): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  const object = new LineSegments(geometry, material);
  object.name = name;
  return object;
}
