// The user in the building: a figure with a field of view, and the trail behind.
import {
  BufferAttribute, BufferGeometry, CapsuleGeometry, Color, DoubleSide, Group, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, SphereGeometry,
} from 'three';
import {Ribbons} from './ribbons';
import type {Theme} from './theme';
import {headingOf, POSE, type Walk} from './walk';

const SEEN = 3.2;           // of the field of view, metres
const FIELD = 70 * Math.PI / 180;
const SHOULDERS = 1.42;     // where the body ends and the head begins, below the eyes by the rest
const TRAIL_SECONDS = 60;
const TRAIL_POINTS = 600;   // at most
const TRAIL_WIDTH = 0.16;
const JUMP = 1;             // between two points of the trail that are not joined, metres

function fieldOfView(): BufferGeometry {
  const steps = 16;
  const positions = [0, 0, 0];
  const colors = [1, 1, 1, 0.5];
  const index: number[] = [];
  for (let i = 0; i <= steps; ++i) {
    const angle = (i / steps - 0.5) * FIELD;
    positions.push(-SEEN * Math.sin(angle), 0, -SEEN * Math.cos(angle));
    colors.push(1, 1, 1, 0);
    if (i > 0) index.push(0, i, i + 1);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 4));
  geometry.setIndex(index);
  return geometry;
}

export class WalkerModel extends Group {
  private readonly figure = new Group();
  private readonly body = new MeshLambertMaterial();
  private readonly view = new MeshBasicMaterial({
    vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide,
  });
  private readonly trail = new Ribbons(0.035, 0.25, 3);
  private readonly color = new Color();

  constructor(theme: Theme) {
    super();
    const torso = new Mesh(new CapsuleGeometry(0.2, SHOULDERS - 0.4 - 0.1, 4, 16), this.body);
    torso.position.y = SHOULDERS / 2 - 0.05;
    const head = new Mesh(new SphereGeometry(0.15, 20, 14), this.body);
    head.position.y = SHOULDERS + 0.17;
    const nose = new Mesh(new SphereGeometry(0.05, 10, 8), this.body);
    nose.position.set(0, SHOULDERS + 0.17, -0.16);
    const view = new Mesh(fieldOfView(), this.view);
    view.position.y = 0.06;
    view.renderOrder = 2;
    this.figure.add(torso, head, nose, view);
    this.add(this.trail, this.figure);
    this.setTheme(theme);
  }

  setTheme(theme: Theme): void {
    this.color.set(theme.user);
    this.body.color.copy(this.color);
    this.view.color.copy(this.color);
  }

  /** Shows a frame: the figure where the virtual head is, its trail of the last minute behind. */
  show(walk: Walk, frame: number): void {
    const at = POSE * frame;
    const x = walk.virtual[at], z = walk.virtual[at + 2];
    const floor = floorOf(walk, frame);
    if (Number.isFinite(x + z + floor)) {
      this.figure.position.set(x, floor, z);
      this.figure.rotation.y = headingOf(walk.virtual, at);
    }
    this.showTrail(walk, frame);
  }

  private showTrail(walk: Walk, frame: number): void {
    const {trail} = this;
    trail.clearBands();
    trail.begin(TRAIL_WIDTH, this.color, 1);
    const first = walk.frameAt(walk.time[frame] - TRAIL_SECONDS);
    // Points stay where they are from frame to frame: what is left out depends on the frame, not on the end.
    const step = Math.max(1, Math.ceil((frame - first) / TRAIL_POINTS));
    let lastX = NaN, lastZ = NaN;
    for (let i = Math.ceil(first / step) * step; ; i += step) {
      const k = Math.min(i, frame);
      const x = walk.virtual[POSE * k], z = walk.virtual[POSE * k + 2], y = floorOf(walk, k);
      if (Number.isFinite(x + y + z)) {
        const moved = Math.hypot(x - lastX, z - lastZ);
        if (moved > JUMP * step) {
          trail.end();
          trail.begin(TRAIL_WIDTH, this.color, 1);
        }
        if (!(moved < 0.03) || k === frame) {
          const age = (walk.time[frame] - walk.time[k]) / TRAIL_SECONDS;
          trail.point(x, y, z, 0.75 * (1 - age) * (1 - age));
          lastX = x;
          lastZ = z;
        }
      }
      if (k === frame) break;
    }
    trail.end();
    trail.finish();
  }
}

/** Height of the virtual floor under a frame's head: the map from physical to virtual lifts by it. Metres. */
export const floorOf = (walk: Walk, frame: number): number =>
  walk.virtual[POSE * frame + 1] - walk.physical[POSE * frame + 1];
