// Which frame is shown: play, pause, scrub, step. Playing past the end of a live walk makes more of it.
import type {Source} from './source';

// A page that was away, or busy, does not leap, seconds.
const LONGEST_TICK = 0.25;

export class Player {
  source: Source | null = null;
  /** Of the walk, seconds. */
  time = 0;
  frame = 0;
  playing = false;
  /** Walk seconds a second. */
  speed = 1;
  /** Told when it starts or stops playing. */
  onPlaying: (playing: boolean) => void = () => undefined;

  private last = NaN;

  /** Shows another source from its beginning; playing goes on. */
  open(source: Source | null): void {
    this.source?.release();
    this.source = source;
    this.time = 0;
    this.frame = 0;
    if (!source) this.play(false);
  }

  play(playing: boolean): void {
    if (!this.source) playing = false;
    if (playing && !this.source!.live && this.time >= this.source!.walk.duration) this.seek(0);
    if (playing === this.playing) return;
    this.playing = playing;
    this.last = NaN;
    this.onPlaying(playing);
  }

  /** To a time, as far as there are frames. */
  seek(time: number): void {
    if (!this.source) return;
    this.time = Math.min(Math.max(0, time), this.source.walk.duration);
    this.frame = this.source.walk.frameAt(this.time);
  }

  /** By so many frames; stops playing. At the end of a live walk, forward makes new ones. */
  step(frames: number): void {
    const {source} = this;
    if (!source) return;
    this.play(false);
    const wanted = this.frame + frames;
    if (source.live && wanted >= source.walk.length) {
      source.reach(source.walk.duration + (wanted - source.walk.length + 1) / source.rate);
    }
    this.frame = Math.min(Math.max(0, wanted), source.walk.length - 1);
    this.time = source.walk.time[this.frame] ?? 0;
  }

  /** The time of a new picture, milliseconds. True where the frame is another than before. */
  tick(now: number): boolean {
    const {source} = this;
    const seconds = Number.isNaN(this.last) ? 0 : Math.min(LONGEST_TICK, (now - this.last) / 1000);
    this.last = now;
    if (!source || !this.playing) return false;
    const wanted = this.time + seconds * this.speed;
    if (source.live && wanted > source.walk.duration) source.reach(wanted);
    const before = this.frame;
    this.seek(wanted);
    if (!source.live && wanted > source.walk.duration) this.play(false);
    return this.frame !== before;
  }
}
