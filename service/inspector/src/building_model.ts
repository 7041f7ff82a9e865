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
// What stands for walls where only the navmesh is known, metres.
const CURB = 0.12;

/** What a group of a scene is, from its name; unnamed things are furniture. */
export function partOf(group: string): Part {
  if (/floor|slab|stairs|ground$|ramp/i.test(group) && !/wall|furniture/i.test(group)) return 'floor';
  if (/wall|spine|partition|column|railing|washroom/i.test(group)) return 'wall';
  return 'furniture';
}

export class BuildingModel extends Group {
  private readonly plane = new Plane(new Vector3(0, -1, 0), Infinity);
  private readonly lambert: Record<Part, MeshLambertMaterial>;
  private readonly cutFaces: MeshBasicMaterial;
  private readonly walkableMaterial: MeshBasicMaterial;
  private readonly portalMaterial: LineBasicMaterial;
  private readonly borderMaterial: LineBasicMaterial;
  private readonly capped: Mesh[] = [];
  /** The polygons' surface, to pick from: three corners after the other, no index. */
  readonly walkable: Mesh;
  /** For each triangle of `walkable`, its polygon. */
  readonly polygonOfTriangle: Uint32Array;

  constructor(building: Building, polygons: readonly Polygon[], theme: BuildingTheme) {
    super();
    this.name = building.id;
    const lambert = () => new MeshLambertMaterial({side: FrontSide});
    this.lambert = {floor: lambert(), wall: lambert(), furniture: lambert()};
    // A floor without thickness is seen from below as well, from a storey beneath.
    this.lambert.floor.side = DoubleSide;
    this.cutFaces = new MeshBasicMaterial({side: BackSide});
    this.walkableMaterial = new MeshBasicMaterial({
      transparent: true, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1,
    });
    this.portalMaterial = new LineBasicMaterial({transparent: true, opacity: 0.55});
    this.borderMaterial = new LineBasicMaterial();

    for (const [part, geometry] of parts(building, polygons)) {
      const mesh = new Mesh(geometry, this.lambert[part]);
      mesh.name = part;
      this.add(mesh);
      if (part === 'floor') continue;
      const cap = new Mesh(geometry, this.cutFaces);
      cap.name = `${part} cut`;
      cap.visible = false;
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
    for (const part of ['floor', 'wall', 'furniture'] as const) this.lambert[part].color.set(theme[part]);
    this.cutFaces.color.set(theme.cut);
    this.walkableMaterial.color.set(theme.walkable);
    this.walkableMaterial.opacity = theme.walkableOpacity;
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
    for (const material of this.materials()) {
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

  private materials(): Material[] {
    return [...Object.values(this.lambert), this.cutFaces, this.walkableMaterial, this.portalMaterial,
      this.borderMaterial];
  }
}

/**
 * The model of a building whose navmesh has these polygons (`navmesh.polygons()`). World axes, metres. A building
 * whose scene is not known gets curbs where its walkable ground ends. Some ten milliseconds for the bundled ones.
 */
export function makeBuildingModel(building: Building, polygons: readonly Polygon[],
                                  theme: BuildingTheme): BuildingModel {
  return new BuildingModel(building, polygons, theme);
}

/** Light to see it in: soft from above, and a sun that tells the walls' sides apart. */
export function makeLights(theme: BuildingTheme): Group {
  const lights = new Group();
  const sun = new DirectionalLight(new Color('#ffffff'), 1.3);
  sun.position.set(-0.5, 1, 0.3);
  lights.add(new HemisphereLight(new Color(theme.sky), new Color(theme.ground), 2.2), sun);
  return lights;
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
