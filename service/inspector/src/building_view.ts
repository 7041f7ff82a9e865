// The virtual building: three.js, drawn when something has changed and not otherwise.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial, PerspectiveCamera, Raycaster, Scene,
  Vector2, Vector3, WebGLRenderer, type Group,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import type {Graph} from 'forewalk';
import {makeBuildingModel, makeLights, type BuildingModel} from './building_model';
import {GraphModel} from './graph_model';
import type {Ground} from './ground';
import {Ribbons} from './ribbons';
import {RoomOutline} from './room_outline';
import {Sharpness} from './sharpness';
import type {Theme} from './theme';
import type {Walk} from './walk';
import {floorOf, WalkerModel} from './walker_model';

// Walls are cut so high above the user's floor, metres.
const CUT = 1.25;
// The camera's distance to who it follows at first, metres; and how fast it catches up, 1/s.
const DISTANCE = 21;
const CATCH_UP = 5;
// A click that moves further was a drag, pixels.
const DRAG = 5;
const TURN = 0.12;       // radians a key
const PAN = 0.06;        // of the distance a key

/** Somewhere on the floor. */
export interface Pick {
  polygon: number;
  point: [number, number, number];
}

export class BuildingView {
  /** Told of clicks on the floor; null: beside it. */
  onPick: (pick: Pick | null) => void = () => undefined;
  /** Told when the camera stops following because somebody moved it elsewhere. */
  onFollow: (follows: boolean) => void = () => undefined;

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(38, 1, 0.5, 400);
  private readonly controls: OrbitControls;
  private readonly graph: GraphModel;
  private readonly walker: WalkerModel;
  private readonly room: RoomOutline;
  private readonly picked = new Mesh(new BufferGeometry(), new MeshBasicMaterial({
    transparent: true, opacity: 0.35, depthWrite: false, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: -2,
  }));
  private readonly pickedPortals = new Ribbons(0.06, 0.4, 2);
  private lights: Group;
  private model: BuildingModel | null = null;
  private ground: Ground | null = null;
  private readonly sharpness: Sharpness;
  private follows = true;
  private dirty = true;
  private last = 0;
  private readonly target = new Vector3();
  private readonly moved = new Vector3();
  private readonly aimed = new Vector3();  // what we had the camera look at

  /** Throws where there is no WebGL. */
  constructor(private readonly canvas: HTMLCanvasElement, private theme: Theme) {
    const slow = drawsByProcessor();
    this.sharpness = new Sharpness(slow ? 2 : 1);
    this.renderer = new WebGLRenderer({canvas, antialias: !slow, powerPreference: 'high-performance'});
    this.renderer.localClippingEnabled = true;
    this.graph = new GraphModel(theme);
    this.walker = new WalkerModel(theme);
    this.room = new RoomOutline(theme);
    this.lights = makeLights(theme);
    this.picked.renderOrder = 1;
    this.picked.frustumCulled = false;
    this.scene.add(this.lights, this.graph, this.walker, this.room, this.picked, this.pickedPortals);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = 0.49 * Math.PI;
    this.controls.minDistance = 2;
    this.controls.maxDistance = 150;
    this.controls.screenSpacePanning = false;
    this.controls.addEventListener('change', () => {
      this.dirty = true;
      // Somebody who drags the floor away means to look elsewhere.
      if (this.follows && this.controls.target.distanceTo(this.aimed) > 0.05) this.follow(false);
    });
    this.listen();
    this.setTheme(theme);
    this.lookAt(new Vector3(0, 0, 0));
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.scene.background = new Color(theme.background);
    this.scene.remove(this.lights);
    this.lights = makeLights(theme);
    this.scene.add(this.lights);
    this.model?.setTheme(theme);
    this.graph.setTheme(theme);
    this.walker.setTheme(theme);
    this.room.setTheme(theme);
    (this.picked.material as MeshBasicMaterial).color.set(theme.user);
    this.dirty = true;
  }

  /** Shows another building, or none; the camera goes to `at`. */
  setGround(ground: Ground | null, at: ArrayLike<number>): void {
    if (this.model) {
      this.scene.remove(this.model);
      this.model.dispose();
    }
    this.ground = ground;
    this.model = ground && makeBuildingModel(ground.building, ground.polygons, this.theme, 'painted');
    if (this.model) this.scene.add(this.model);
    this.select(null);
    this.graph.show(null);
    this.lookAt(new Vector3(at[0], at[1], at[2]));
  }

  /** Shows a frame of a walk and its graph. */
  show(walk: Walk, frame: number, graph: Graph | null): void {
    this.walker.show(walk, frame);
    this.room.show(walk, frame);
    this.graph.show(graph);
    const at = 7 * frame;
    const floor = floorOf(walk, frame);
    if (Number.isFinite(floor + walk.virtual[at])) this.target.set(walk.virtual[at], floor, walk.virtual[at + 2]);
    this.model?.cutAt(this.target.y + CUT);
    this.dirty = true;
  }

  get following(): boolean {
    return this.follows;
  }

  follow(follows: boolean): void {
    this.follows = follows;
    this.aimed.copy(this.controls.target);
    this.dirty = true;
    this.onFollow(follows);
  }

  /** Nearer for more than 1. */
  zoom(factor: number): void {
    const {camera, controls} = this;
    const distance = camera.position.distanceTo(controls.target);
    const wanted = Math.min(controls.maxDistance, Math.max(controls.minDistance, distance / factor));
    camera.position.sub(controls.target).multiplyScalar(wanted / distance).add(controls.target);
    this.dirty = true;
  }

  /** Turns the camera about what it looks at: to the left, and down to the floor; radians. */
  turn(left: number, down: number): void {
    const {camera, controls} = this;
    const offset = camera.position.clone().sub(controls.target);
    const distance = offset.length();
    const azimuth = Math.atan2(offset.x, offset.z) + left;
    const polar = Math.min(controls.maxPolarAngle, Math.max(0.02, Math.acos(offset.y / distance) + down));
    offset.setFromSphericalCoords(distance, polar, azimuth);
    camera.position.copy(controls.target).add(offset);
    camera.lookAt(controls.target);
    this.dirty = true;
  }

  /** Moves the camera over the floor: shares of its distance, to the right and forward. Stops following. */
  pan(right: number, forward: number): void {
    const {camera, controls} = this;
    const offset = camera.position.clone().sub(controls.target);
    const scale = offset.length();
    const azimuth = Math.atan2(offset.x, offset.z);
    this.moved.set(right * Math.cos(azimuth) - forward * Math.sin(azimuth), 0,
      -right * Math.sin(azimuth) - forward * Math.cos(azimuth)).multiplyScalar(scale);
    camera.position.add(this.moved);
    controls.target.add(this.moved);
    this.follow(false);
  }

  /** Highlights a polygon and its portals; null: none. */
  select(polygon: number | null): void {
    const shown = polygon === null ? undefined : this.ground?.polygons[polygon];
    const positions = shown ? shown.triangles.flat().flatMap(([x, y, z]) => [x, y + 0.03, z]) : [];
    this.picked.geometry.dispose();
    this.picked.geometry = new BufferGeometry();
    this.picked.geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
    this.pickedPortals.clearBands();
    const color = new Color(this.theme.user);
    for (const {left, right} of shown?.portals ?? []) {
      this.pickedPortals.begin(0.1, color, 0.9);
      this.pickedPortals.point(left[0], left[1], left[2]);
      this.pickedPortals.point(right[0], right[1], right[2]);
      this.pickedPortals.end();
    }
    this.pickedPortals.finish();
    this.dirty = true;
  }

  /** What is on the floor at a place of the canvas, -1 to 1 to the right and up; null: nothing. */
  pickAt(right: number, up: number): Pick | null {
    if (!this.model) return null;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(right, up), this.camera);
    const visible = this.walkableHeight();
    for (const hit of ray.intersectObject(this.model.walkable, false)) {
      if (hit.point.y > visible || hit.faceIndex == null) continue;
      return {polygon: this.model.polygonOfTriangle[hit.faceIndex], point: [hit.point.x, hit.point.y, hit.point.z]};
    }
    return null;
  }

  /** Where a point of the world is seen, -1 to 1 to the right and up. */
  place(point: ArrayLike<number>): [number, number] {
    this.camera.updateMatrixWorld();
    const seen = new Vector3(point[0], point[1], point[2]).project(this.camera);
    return [seen.x, seen.y];
  }

  /** Draws, if something has changed; milliseconds as of requestAnimationFrame. True where it drew. */
  draw(now: number): boolean {
    const seconds = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    if (this.follows) this.catchUp(seconds);
    if (this.dirty) this.sharpness.draws(now);
    else if (this.sharpness.rests(now)) this.dirty = true;
    this.resize();
    if (!this.dirty) return false;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  /** Draw calls and triangles of the last drawing. */
  get cost(): {calls: number; triangles: number} {
    return {calls: this.renderer.info.render.calls, triangles: this.renderer.info.render.triangles};
  }

  private walkableHeight(): number {
    return this.target.y + CUT;
  }

  private lookAt(point: Vector3): void {
    this.target.copy(point);
    this.controls.target.copy(point);
    this.aimed.copy(point);
    this.camera.position.set(point.x + 0.32 * DISTANCE, point.y + 0.8 * DISTANCE, point.z + 0.55 * DISTANCE);
    this.controls.update();
    this.dirty = true;
  }

  private catchUp(seconds: number): void {
    this.moved.subVectors(this.target, this.controls.target);
    if (this.moved.lengthSq() < 1e-4) return;  // a centimetre is not worth a picture
    this.moved.multiplyScalar(1 - Math.exp(-CATCH_UP * seconds));
    this.controls.target.add(this.moved);
    this.aimed.copy(this.controls.target);
    this.camera.position.add(this.moved);
    this.dirty = true;
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const ratio = Math.min(2, devicePixelRatio) * this.sharpness.share;
    const pixels = this.renderer.getPixelRatio();
    if (width === 0 || height === 0) return;
    if (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio) &&
      pixels === ratio) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  private listen(): void {
    const {canvas} = this;
    let downX = 0, downY = 0;
    canvas.addEventListener('pointerdown', (event) => {
      downX = event.clientX;
      downY = event.clientY;
    });
    canvas.addEventListener('pointerup', (event) => {
      if (event.button !== 0 || Math.hypot(event.clientX - downX, event.clientY - downY) > DRAG) return;
      const box = canvas.getBoundingClientRect();
      this.onPick(this.pickAt(2 * (event.clientX - box.left) / box.width - 1,
        1 - 2 * (event.clientY - box.top) / box.height));
    });
    canvas.addEventListener('keydown', (event) => this.onKey(event));
  }

  private onKey(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    };
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) this.pan(PAN * arrow[0], PAN * arrow[1]);
    else if (arrow) this.turn(-TURN * arrow[0], -TURN * arrow[1]);
    else if (event.key === 'Enter') this.onPick(this.pickAt(0, 0));
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/** Whether WebGL is made by the processor here, which smooth edges cost dear. */
function drawsByProcessor(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const names = context?.getExtension('WEBGL_debug_renderer_info');
  const renderer = context && names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(renderer);
}
