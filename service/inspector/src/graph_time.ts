// Fills the chart of graph times where nobody has looked yet: frames spread over a recording, predicted while the page
// has nothing else to do.
import type {Ground} from './ground';
import {Predictor} from './predictor';
import type {Walk} from './walk';

const SAMPLES = 240;
// At most in one go, milliseconds.
const SLICE = 6;

/** Calls `some` now and then when there is more to draw. Returns what ends it. */
export function sampleGraphTimes(ground: Ground, walk: Walk, some: () => void): () => void {
  const predictor = new Predictor(ground, walk);
  let sample = 0;
  let ended = false;
  const end = (): void => {
    if (!ended) predictor.release();
    ended = true;
  };
  // Every second, then what is between: the whole walk shows early.
  const order = (i: number): number => i < SAMPLES / 2 ? 2 * i : 2 * (i - SAMPLES / 2) + 1;
  const go = (deadline: IdleDeadline): void => {
    const until = performance.now() + Math.min(SLICE, deadline.timeRemaining());
    while (!ended && sample < SAMPLES && performance.now() < until) {
      const frame = Math.floor(order(sample++) / SAMPLES * walk.length);
      if (Number.isNaN(walk.graphTime[frame])) predictor.at(frame);
      if (sample % (SAMPLES / 4) === 0) some();
    }
    if (sample >= SAMPLES) end();
    if (!ended) requestIdleCallback(go);
  };
  requestIdleCallback(go);
  return end;
}
