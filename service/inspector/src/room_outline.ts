// The tracked room, laid over the virtual floor as the redirection has it at a frame: where in the building the body's
// walls are. It turns and slides while gains are at work.
import {Color, Group} from 'three';
import {Ribbons} from './ribbons';
import type {Theme} from './theme';
import {headingOf, POSE, type Walk} from './walk';
import {floorOf} from './walker_model';

const WIDTH = 0.07;  // metres

export class RoomOutline extends Group {
  private readonly bands = new Ribbons(0.045, 0.35, 3);
  private readonly color = new Color();

  constructor(theme: Theme) {
    super();
    this.add(this.bands);
    this.setTheme(theme);
  }

  setTheme(theme: Theme): void {
    this.color.set(theme.ink);
  }

  show(walk: Walk, frame: number): void {
    const {bands} = this;
    bands.clearBands();
    const at = POSE * frame;
    const x = walk.virtual[at], z = walk.virtual[at + 2], floor = floorOf(walk, frame);
    const bodyX = walk.physical[at], bodyZ = walk.physical[at + 2];
    if (walk.room && Number.isFinite(x + z + floor + bodyX + bodyZ)) {
      const yaw = headingOf(walk.virtual, at) - headingOf(walk.physical, at);
      const cos = Math.cos(yaw), sin = Math.sin(yaw);
      const point = ([cornerX, cornerZ]: readonly [number, number]): void => {
        const dx = cornerX - bodyX, dz = cornerZ - bodyZ;
        bands.point(x + cos * dx + sin * dz, floor, z - sin * dx + cos * dz);
      };
      this.outline(walk.room.border, point);
      for (const hole of walk.room.holes) this.outline(hole, point);
    }
    bands.finish();
  }

  private outline(ring: readonly (readonly [number, number])[], point: (corner: readonly [number, number]) => void): void {
    this.bands.begin(WIDTH, this.color, 0.6);
    for (const corner of ring) point(corner);
    point(ring[0]);
    this.bands.end();
  }
}
