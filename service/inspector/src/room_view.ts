// The tracked room from above: its border and pillars, the body and where it has been, where it was turned round, and
// how far the nearest border is. Forward is up.
import {extentOf, nearestBorder, type Nearest, type Room} from './room';
import type {Theme} from './theme';
import {headingOf, POSE, type Walk} from './walk';

const TRAIL_SECONDS = 30;
const TRAIL_BANDS = 12;      // of equal fading
const MARKS = 60;            // resets shown, the latest
const MARGIN = 30;           // pixels about the room
const JUMP = 1;              // between two points that are not joined, metres

export class RoomView {
  private readonly context: CanvasRenderingContext2D;
  private room: Room | null = null;
  private outline = new Path2D();
  private grid = new Path2D();
  private scale = 50;        // pixels a metre
  private centerX = 0;
  private centerZ = 0;
  private width = 0;
  private height = 0;
  private ratio = 1;
  private dirty = true;
  private readonly nearest: Nearest = {x: 0, z: 0, distance: 0};

  constructor(private readonly canvas: HTMLCanvasElement, private theme: Theme) {
    this.context = canvas.getContext('2d')!;
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.dirty = true;
  }

  setRoom(room: Room | null): void {
    this.room = room;
    this.width = 0;  // fitted anew
    this.dirty = true;
  }

  /** Draws a frame. */
  show(walk: Walk | null, frame: number): void {
    this.dirty = this.fit() || this.dirty;
    const {context: c, theme} = this;
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.clearRect(0, 0, this.width, this.height);
    if (!this.room) {
      c.fillStyle = theme.quiet;
      c.textAlign = 'center';
      c.font = this.font(13);
      c.fillText('The room is not known.', this.width / 2, this.height / 2);
      return;
    }
    this.drawRoom();
    if (!walk || walk.length === 0) return;
    this.drawMarks(walk, frame);
    this.drawTrail(walk, frame);
    const at = POSE * frame;
    const x = walk.physical[at], z = walk.physical[at + 2];
    if (!Number.isFinite(x + z)) return;
    this.drawNearest(x, z);
    this.drawBody(x, z, headingOf(walk.physical, at), walk.turning[frame] === 1 ? walk.remaining[frame] : 0);
  }

  private x(x: number): number {
    return this.width / 2 + (x - this.centerX) * this.scale;
  }

  private z(z: number): number {
    return this.height / 2 + (z - this.centerZ) * this.scale;
  }

  private font(size: number): string {
    return `${size}px ${getComputedStyle(this.canvas).fontFamily}`;
  }

  /** Takes the canvas' size; true where it changed. */
  private fit(): boolean {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const ratio = Math.max(1, devicePixelRatio);
    if (width === this.width && height === this.height && ratio === this.ratio) return false;
    this.width = width;
    this.height = height;
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    if (!this.room) return true;
    const extent = extentOf(this.room);
    this.scale = Math.max(1, Math.min((width - 2 * MARGIN) / (extent.right - extent.left),
      (height - 2 * MARGIN) / (extent.back - extent.front)));
    this.centerX = (extent.left + extent.right) / 2;
    this.centerZ = (extent.front + extent.back) / 2;
    this.outline = new Path2D();
    for (const ring of [this.room.border, ...this.room.holes]) {
      ring.forEach(([x, z], i) => i === 0 ? this.outline.moveTo(this.x(x), this.z(z)) : this.outline.lineTo(this.x(x), this.z(z)));
      this.outline.closePath();
    }
    this.grid = new Path2D();
    for (let x = Math.ceil(extent.left); x <= extent.right; ++x) {
      this.grid.moveTo(this.x(x), this.z(extent.front));
      this.grid.lineTo(this.x(x), this.z(extent.back));
    }
    for (let z = Math.ceil(extent.front); z <= extent.back; ++z) {
      this.grid.moveTo(this.x(extent.left), this.z(z));
      this.grid.lineTo(this.x(extent.right), this.z(z));
    }
    return true;
  }

  private drawRoom(): void {
    const {context: c, theme, room} = this;
    c.save();
    c.fillStyle = theme.floor;
    c.fill(this.outline, 'evenodd');
    c.clip(this.outline, 'evenodd');
    c.strokeStyle = theme.rule;
    c.lineWidth = 1;
    c.stroke(this.grid);
    c.restore();
    c.strokeStyle = theme.ink;
    c.lineWidth = 2;
    c.lineJoin = 'round';
    c.stroke(this.outline);
    const extent = extentOf(room!);
    c.fillStyle = theme.quiet;
    c.font = this.font(11.5);
    c.textAlign = 'center';
    c.fillText(`${metres(extent.right - extent.left)} m`, this.x(this.centerX), this.z(extent.back) + 18);
    c.save();
    c.translate(this.x(extent.left) - 10, this.z(this.centerZ));
    c.rotate(-Math.PI / 2);
    c.fillText(`${metres(extent.back - extent.front)} m`, 0, 0);
    c.restore();
  }

  private drawMarks(walk: Walk, frame: number): void {
    const {context: c, theme} = this;
    let count = 0;
    c.strokeStyle = theme.reset;
    c.lineWidth = 1.5;
    // Those up to the frame, the latest first.
    let low = 0, high = walk.resetFrames.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (walk.resetFrames[middle] <= frame) low = middle + 1;
      else high = middle;
    }
    for (let k = low - 1; k >= 0 && count < MARKS; --k, ++count) {
      const at = POSE * walk.resetFrames[k];
      const x = this.x(walk.physical[at]), z = this.z(walk.physical[at + 2]);
      c.globalAlpha = 0.9 * (1 - count / MARKS);
      c.beginPath();
      c.moveTo(x - 4, z - 4);
      c.lineTo(x + 4, z + 4);
      c.moveTo(x + 4, z - 4);
      c.lineTo(x - 4, z + 4);
      c.stroke();
    }
    c.globalAlpha = 1;
  }

  private drawTrail(walk: Walk, frame: number): void {
    const {context: c, theme} = this;
    c.strokeStyle = theme.body;
    c.lineWidth = 2.5;
    c.lineCap = 'round';
    const now = walk.time[frame];
    let from = walk.frameAt(now - TRAIL_SECONDS);
    for (let band = 0; band < TRAIL_BANDS; ++band) {
      const to = band === TRAIL_BANDS - 1 ? frame : walk.frameAt(now - TRAIL_SECONDS * (1 - (band + 1) / TRAIL_BANDS));
      const step = Math.max(1, Math.floor((to - from) / 40));
      c.globalAlpha = 0.08 + 0.72 * ((band + 1) / TRAIL_BANDS) ** 2;
      c.beginPath();
      let lastX = NaN, lastZ = NaN;
      for (let i = from; ; i = Math.min(to, i + step)) {
        const x = walk.physical[POSE * i], z = walk.physical[POSE * i + 2];
        if (Math.hypot(x - lastX, z - lastZ) < JUMP * step) c.lineTo(this.x(x), this.z(z));
        else c.moveTo(this.x(x), this.z(z));
        lastX = x;
        lastZ = z;
        if (i >= to) break;
      }
      c.stroke();
      from = to;
    }
    c.globalAlpha = 1;
  }

  private drawNearest(x: number, z: number): void {
    const {context: c, theme} = this;
    const {nearest} = this;
    nearestBorder(this.room!, x, z, nearest);
    c.strokeStyle = nearest.distance < 0.5 ? theme.reset : theme.quiet;
    c.lineWidth = 1.25;
    c.setLineDash([4, 4]);
    c.beginPath();
    c.moveTo(this.x(x), this.z(z));
    c.lineTo(this.x(nearest.x), this.z(nearest.z));
    c.stroke();
    c.setLineDash([]);
    const label = `${nearest.distance.toFixed(2)} m`;
    c.font = this.font(12);
    c.textAlign = 'center';
    // On the line where there is room for it, else on the body's other side.
    const apart = Math.abs(nearest.distance) * this.scale;
    const beside = 24 + 16 * Math.abs(nearest.x - x) / Math.max(Math.abs(nearest.distance), 1e-6);
    const away = apart > 60 || apart < 1 ? -0.5 : beside / apart;
    const labelX = this.x(x + away * (x - nearest.x)), labelZ = this.z(z + away * (z - nearest.z)) + (away < 0 ? -6 : 4);
    c.lineWidth = 4;
    c.lineJoin = 'round';
    c.strokeStyle = theme.floor;
    c.strokeText(label, labelX, labelZ);
    c.fillStyle = nearest.distance < 0.5 ? theme.reset : theme.ink;
    c.fillText(label, labelX, labelZ);
  }

  /** `turn`: radians still to turn in a reset. */
  private drawBody(x: number, z: number, heading: number, turn: number): void {
    const {context: c, theme} = this;
    c.save();
    c.translate(this.x(x), this.z(z));
    if (turn > 0.01) {
      c.strokeStyle = theme.reset;
      c.lineWidth = 4;
      c.beginPath();
      c.arc(0, 0, 22, -Math.PI / 2, -Math.PI / 2 + turn);
      c.stroke();
    }
    c.rotate(-heading);
    c.fillStyle = theme.body;
    c.beginPath();
    c.moveTo(0, -15);
    c.lineTo(6.5, -5);
    c.lineTo(-6.5, -5);
    c.closePath();
    c.fill();
    c.beginPath();
    c.arc(0, 0, 7.5, 0, 2 * Math.PI);
    c.fill();
    c.strokeStyle = theme.background;
    c.lineWidth = 1.5;
    c.stroke();
    c.restore();
  }
}

const metres = (length: number): string => String(Math.round(100 * length) / 100);
