// Drawing one's room: corners on a metre grid, by pointer or keyboard.
import type {Point2} from 'forewalk';
import {onTheme} from '../theme';
import {freeFloor, type FreeFloor, type TrackedRoom} from './room';

const SNAP = 0.1;      // metres
const GRASP = 14;      // CSS pixels around a corner or wall within which it is taken
const SIZE = 340;      // of the drawing, CSS pixels
const SMALLEST = 2.5;  // metres from the middle to the edge of what is seen

const snapped = (metres: number): number => Math.round(metres / SNAP) * SNAP;

/** A drawing of a room, and while `editable` the means to change it. Seen from above, the way ahead up. */
export class RoomEditor {
  readonly canvas = document.createElement('canvas');
  /** Said to screen readers, and shown: what a key or the pointer did. */
  readonly said = document.createElement('p');
  editable = true;

  private room: TrackedRoom = {name: '', border: [], obstacles: []};
  private free: FreeFloor | null = null;
  private selected = 0;
  private dragged = false;
  private reach = SMALLEST;  // metres from the middle to the edge of the drawing

  /** `changed` is called after every change of the border. */
  constructor(private readonly changed: (border: Point2[]) => void) {
    const {canvas} = this;
    canvas.className = 'room-drawing';
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'application');
    canvas.setAttribute('aria-label', 'Your room from above. Arrow keys move the selected corner, N and P select ' +
      'the next and previous one, Insert adds one after it, Delete removes it.');
    this.said.className = 'room-said';
    this.said.setAttribute('aria-live', 'polite');
    canvas.addEventListener('pointerdown', (event) => this.take(event));
    canvas.addEventListener('pointermove', (event) => this.drag(event));
    canvas.addEventListener('pointerup', () => this.letGo());
    canvas.addEventListener('pointercancel', () => this.letGo());
    canvas.addEventListener('dblclick', () => this.remove());
    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('focus', () => this.draw());
    canvas.addEventListener('blur', () => this.draw());
    onTheme(() => this.draw());
  }

  /** Shows a room; its corners are copied. */
  show(room: TrackedRoom, editable: boolean): void {
    this.room = {...room, border: room.border.map(([x, z]): Point2 => [x, z])};
    this.editable = editable;
    this.selected = 0;
    this.said.textContent = editable ?
      'Drag corners; a click on a wall adds one, a double click removes one. You stand at the arrow, looking along ' +
      'it.' :
      'Scanned with a headset; furniture is left out.';
    this.refresh();
  }

  private refresh(): void {
    const {border} = this.room;
    this.reach = Math.max(SMALLEST, ...border.flat().map(Math.abs)) + 0.5;
    try {
      this.free = freeFloor(this.room);
    } catch {  // whoever owns the editor says why
      this.free = null;
    }
    this.draw();
  }

  private edited(): void {
    this.refresh();
    const [x, z] = this.room.border[this.selected];
    this.said.textContent = `Corner ${this.selected + 1} of ${this.room.border.length}: ` +
      `${Math.abs(x).toFixed(1)} m ${x < 0 ? 'left' : 'right'}, ` +
      `${Math.abs(z).toFixed(1)} m ${z > 0 ? 'behind' : 'ahead'}.`;
    this.changed(this.room.border);
  }

  private at(event: PointerEvent): Point2 {
    const box = this.canvas.getBoundingClientRect();
    const metres = 2 * this.reach / box.width;
    return [(event.clientX - box.left) * metres - this.reach, (event.clientY - box.top) * metres - this.reach];
  }

  private take(event: PointerEvent): void {
    if (!this.editable) return;
    const [x, z] = this.at(event);
    const {border} = this.room;
    const grasp = GRASP * 2 * this.reach / SIZE;
    const distance = ([u, v]: Point2) => Math.hypot(u - x, v - z);
    const nearest = border.reduce((best, corner, i) => distance(corner) < distance(border[best]) ? i : best, 0);
    if (distance(border[nearest]) < grasp) {
      this.selected = nearest;
    } else {
      const wall = this.wallAt(x, z, grasp);
      if (wall < 0) return;
      this.selected = wall + 1;
      border.splice(wall + 1, 0, [snapped(x), snapped(z)]);
    }
    this.dragged = true;
    this.canvas.setPointerCapture(event.pointerId);
    this.edited();
  }

  private wallAt(x: number, z: number, grasp: number): number {
    const {border} = this.room;
    return border.findIndex(([ax, az], i) => {
      const [bx, bz] = border[(i + 1) % border.length];
      const length = Math.hypot(bx - ax, bz - az);
      if (length < SNAP) return false;
      const along = ((x - ax) * (bx - ax) + (z - az) * (bz - az)) / length;
      const beside = ((x - ax) * (bz - az) - (z - az) * (bx - ax)) / length;
      return along > 0 && along < length && Math.abs(beside) < grasp;
    });
  }

  private drag(event: PointerEvent): void {
    if (!this.dragged) return;
    const [x, z] = this.at(event);
    this.room.border[this.selected] = [snapped(x), snapped(z)];
    this.draw();
  }

  private letGo(): void {
    if (!this.dragged) return;
    this.dragged = false;
    this.edited();
  }

  private remove(): void {
    if (!this.editable || this.room.border.length <= 3) return;
    this.room.border.splice(this.selected, 1);
    this.selected %= this.room.border.length;
    this.edited();
  }

  private key(event: KeyboardEvent): void {
    const {border} = this.room;
    if (!this.editable || border.length === 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 5 * SNAP : SNAP;
    const move: Record<string, Point2> = {
      ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step],
    };
    if (event.key in move) {
      const [x, z] = border[this.selected];
      border[this.selected] = [snapped(x + move[event.key][0]), snapped(z + move[event.key][1])];
    } else if (/^[np]$/i.test(event.key)) {
      this.selected = (this.selected + (/n/i.test(event.key) ? 1 : border.length - 1)) % border.length;
    } else if (event.key === 'Insert' || event.key === '+') {
      const [ax, az] = border[this.selected], [bx, bz] = border[(this.selected + 1) % border.length];
      border.splice(++this.selected, 0, [snapped((ax + bx) / 2), snapped((az + bz) / 2)]);
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      if (border.length > 3) border.splice(this.selected, 1);
      this.selected %= border.length;
    } else {
      return;
    }
    event.preventDefault();
    this.edited();
  }

  private draw(): void {
    const {canvas, room, free, reach} = this;
    const dense = window.devicePixelRatio || 1;
    if (canvas.width !== SIZE * dense) canvas.width = canvas.height = SIZE * dense;
    const context = canvas.getContext('2d')!;
    const style = getComputedStyle(canvas);
    const color = (name: string) => style.getPropertyValue(name);
    const scale = SIZE * dense / (2 * reach);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.setTransform(scale, 0, 0, scale, canvas.width / 2, canvas.height / 2);
    const pixel = dense / scale;
    context.lineWidth = pixel;
    for (let metre = -Math.ceil(reach); metre <= reach; ++metre) {
      context.strokeStyle = color('--grid');
      context.beginPath();
      context.moveTo(metre, -reach);
      context.lineTo(metre, reach);
      context.moveTo(-reach, metre);
      context.lineTo(reach, metre);
      context.stroke();
    }
    const trace = (...rings: Point2[][]) => {
      context.beginPath();
      for (const ring of rings) {
        ring.forEach(([x, z], i) => i === 0 ? context.moveTo(x, z) : context.lineTo(x, z));
        context.closePath();
      }
    };
    trace(room.border);
    context.fillStyle = color('--wall-fill');
    context.fill();
    if (free) {
      trace(free.border, ...free.holes);
      context.fillStyle = color('--free-fill');
      context.fill('evenodd');
    }
    for (const obstacle of room.obstacles) {
      trace(obstacle);
      context.fillStyle = color('--obstacle');
      context.fill();
    }
    trace(room.border);
    context.strokeStyle = color('--wall');
    context.lineWidth = 2 * pixel;
    context.stroke();
    this.drawPerson(context, color('--wall'), pixel);
    if (!this.editable) return;
    const focused = document.activeElement === canvas;
    room.border.forEach(([x, z], i) => {
      context.beginPath();
      context.arc(x, z, (i === this.selected && (focused || this.dragged) ? 7 : 5) * pixel, 0, 2 * Math.PI);
      context.fillStyle = color(i === this.selected && (focused || this.dragged) ? '--accent' : '--wall');
      context.fill();
    });
  }

  private drawPerson(context: CanvasRenderingContext2D, color: string, pixel: number): void {
    context.beginPath();
    context.moveTo(0, -11 * pixel);
    context.lineTo(7 * pixel, 8 * pixel);
    context.lineTo(0, 4 * pixel);
    context.lineTo(-7 * pixel, 8 * pixel);
    context.closePath();
    context.fillStyle = color;
    context.fill();
  }
}
