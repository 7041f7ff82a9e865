// A body in the room that somebody steers with the keyboard: W and S walk, A and D turn.
import type {Body} from './source';

const SPEED = 1.1;                        // m/s
const TURN = 100 * Math.PI / 180;         // rad/s
const EYES = 1.65;                        // metres
const SETTLE = 0.12;                      // seconds until a key has its full effect

export class SteeredBody implements Body {
  readonly position = new Float64Array([0, EYES, 0]);
  readonly orientation = new Float64Array([0, 0, 0, 1]);
  private readonly pressed = new Set<string>();
  private heading = 0;
  private speed = 0;
  private turning = 0;

  /** A key of `KEYS` went down or up; true where it is one. */
  key(code: string, down: boolean): boolean {
    if (!['KeyW', 'KeyA', 'KeyS', 'KeyD'].includes(code)) return false;
    if (down) this.pressed.add(code);
    else this.pressed.delete(code);
    return true;
  }

  /** Nothing is pressed any more: the page lost the keyboard. */
  letGo(): void {
    this.pressed.clear();
  }

  advance(seconds: number): void {
    const held = (code: string): number => this.pressed.has(code) ? 1 : 0;
    const blend = 1 - Math.exp(-seconds / SETTLE);
    this.speed += (SPEED * (held('KeyW') - 0.6 * held('KeyS')) - this.speed) * blend;
    this.turning += (TURN * (held('KeyA') - held('KeyD')) - this.turning) * blend;
    this.heading += this.turning * seconds;
    this.position[0] -= this.speed * seconds * Math.sin(this.heading);
    this.position[2] -= this.speed * seconds * Math.cos(this.heading);
    this.orientation[1] = Math.sin(this.heading / 2);
    this.orientation[3] = Math.cos(this.heading / 2);
  }
}
