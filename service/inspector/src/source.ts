// Where the frames come from that the page shows: a recording, a walk in the page, or a session at the daemon. The page
// knows no more of them than this.
import type {Controller, Frame, SessionSettings} from 'forewalk';
import {roomForSession, roomToJson, type Room} from './room';
import type {Walk} from './walk';

export interface Source {
  readonly walk: Walk;
  /** For people: where it comes from. */
  readonly title: string;
  /** True: there will be more than the walk has now. */
  readonly live: boolean;
  /** Frames a second that are made. */
  readonly rate: number;
  /**
   * Sees to it that the walk reaches `time`, seconds; a live source that answers later is asked again and again.
   * Recordings have what they have.
   */
  reach(time: number): void;
  /** Frees what it holds; the walk stays. */
  release(): void;
}

/** What a live walk is made of. */
export interface LiveSettings {
  controller: Controller;
  /** Metres. */
  horizon: number;
  room: Room;
  walker: 'tour' | 'wander' | 'keys';
  seed: number;
}

/** A body that walks: `walker.ts`, or somebody at the keyboard. */
export interface Body {
  readonly position: Float64Array;
  readonly orientation: Float64Array;
  advance(seconds: number, frame: Frame): void;
}

export const RATE = 90;

const RESET = 'two-one-turn';
const LIMITS = 'steinicke';
const METHOD = 'polygon';

/** For a session of the library in the page. */
export const sessionSettings = (settings: LiveSettings, start: {floor: number[]; heading: number}): SessionSettings => ({
  controller: settings.controller, horizon: settings.horizon, ...roomForSession(settings.room), reset: RESET,
  limits: LIMITS, method: METHOD, alwaysPredict: true, likelihoods: settings.walker !== 'keys', start,
});

/** The same as recordings and the daemon's hello say it. */
export const settingsJson = (settings: LiveSettings, start: {floor: number[]; heading: number}): Record<string, unknown> => ({
  controller: settings.controller, horizon_m: settings.horizon, space: roomToJson(settings.room), reset: RESET,
  limits: LIMITS, method: METHOD, predict_always: true,
  start: {position: start.floor, heading_deg: start.heading * 180 / Math.PI},
});

/** A recording: all there is, from the beginning. */
export const recordingSource = (walk: Walk, title: string): Source => ({
  walk, title, live: false, rate: walk.length > 1 ? (walk.length - 1) / Math.max(walk.duration, 1e-9) : RATE,
  reach: () => undefined, release: () => undefined,
});
