// How many pixels the building is drawn with: all of them where the machine keeps up, fewer while it moves where it does
// not, and all of them again for a still picture.

const SLOW = 22;             // milliseconds between pictures that are too many
const STILL = 250;           // without a picture: nothing moves
const SETTLED = 10;          // pictures until the mean says something
const COARSER = 0.75;
const COARSEST = 0.45;       // of the full ratio
const TRY_AGAIN = 20_000;    // whether it could be finer, milliseconds; doubled each time it could not

export class Sharpness {
  /** Of the full resolution. */
  share = 1;
  private moving = 1;        // the share while pictures follow each other
  private last = -Infinity;
  private mean = 0;
  private pictures = 0;
  private changed = 0;
  private patience = TRY_AGAIN;

  /** `still`: the share for still pictures; more than 1 smooths the edges of what is not smoothed otherwise. */
  constructor(private readonly still: number) {}

  /** A picture is about to be drawn. */
  draws(now: number): void {
    const between = now - this.last;
    this.last = now;
    if (between > STILL) {
      this.pictures = 0;
      this.share = this.moving;
      return;
    }
    ++this.pictures;
    this.mean += (between - this.mean) / Math.min(this.pictures, SETTLED);
    if (this.pictures < SETTLED) return;
    if (this.mean > SLOW && this.moving > COARSEST) {
      if (now - this.changed < 1000) this.patience *= 2;
      this.change(Math.max(COARSEST, this.moving * COARSER), now);
    } else if (this.mean < SLOW && this.moving < 1 && now - this.changed > this.patience) {
      this.change(Math.min(1, this.moving / COARSER), now);
    }
  }

  /** Nothing was drawn. True where the last picture should be drawn again, as a still one. */
  rests(now: number): boolean {
    if (this.share === this.still || now - this.last <= STILL) return false;
    this.share = this.still;
    return true;
  }

  private change(share: number, now: number): void {
    this.moving = share;
    this.share = share;
    this.pictures = 0;
    this.changed = now;
  }
}
