// The numbers beside the room: where the walk is and what the session does.
import type {Graph} from 'forewalk';
import {clockText} from './charts';
import {describeReset, fixed} from './describe';
import type {Walk} from './walk';

// Numbers that change faster cannot be read, milliseconds.
const EVERY = 80;

export class StatusLine {
  private readonly fields = new Map<string, HTMLElement>();
  private written = -Infinity;

  /** Writes a frame's numbers; `now` in milliseconds. `settled`: nothing follows soon, so do not leave it for later. */
  show(walk: Walk, frame: number, graph: Graph | null, now: number, settled: boolean): void {
    if (!settled && now - this.written < EVERY) return;
    this.written = now;
    const resets = walk.resetsAt(frame);
    const metres = walk.walkedVirtual[frame];
    this.put('clock', `${clockText(walk.time[frame])}.${hundredths(walk.time[frame])} / ${clockText(Math.round(walk.duration))}`);
    this.put('walked-virtual', `${metres.toFixed(1)} m`);
    this.put('walked-physical', `${walk.walkedPhysical[frame].toFixed(1)} m`);
    this.put('resets', String(resets));
    this.put('resets-per', metres >= 5 ? (100 * resets / metres).toFixed(1) : '–');
    this.put('translation', walk.translation[frame].toFixed(3));
    this.put('rotation', walk.rotation[frame].toFixed(3));
    this.put('curvature', `${fixed(walk.curvature[frame], 3)}/m`);
    const border = walk.border[frame];
    this.put('border', Number.isFinite(border) ? `${fixed(border, 2)} m` : '–', border < 0.5);
    this.put('nodes', graph ? `${graph.nodes.length} nodes` : '–');
    const time = walk.graphTime[frame];
    this.put('graph-time', Number.isFinite(time) ? time.toFixed(3) : '–');
    this.put('instruction', describeReset(walk, frame), walk.turning[frame] === 1);
  }

  private put(id: string, text: string, warned = false): void {
    let field = this.fields.get(id);
    if (!field) {
      field = document.getElementById(id)!;
      this.fields.set(id, field);
    }
    if (field.textContent !== text) field.textContent = text;
    if (field.classList.contains('warned') !== warned) field.classList.toggle('warned', warned);
  }
}

const hundredths = (seconds: number): string => String(Math.floor(100 * seconds) % 100).padStart(2, '0');
