// The page's middle: one source of frames, the frame that is shown, and the views that show it.
import type {Forewalk, Graph} from 'forewalk';
import type {Building} from './buildings';
import {BuildingView, type Pick} from './building_view';
import {Charts} from './charts';
import {describePolygon} from './describe';
import {get} from './dom';
import {sampleGraphTimes} from './graph_time';
import {openGround, type Ground} from './ground';
import {Player} from './player';
import {Predictor} from './predictor';
import {RoomView} from './room_view';
import type {Source} from './source';
import {StatusLine} from './status_line';
import {currentTheme, onTheme} from './theme';

// Charts of a walk that grows are drawn anew so often, milliseconds; and their span of time grows by so much.
const REFILL = 500;
const GROWTH = 1.5;
const KEPT_COSTS = 1 << 16;

export class Inspector {
  readonly player = new Player();
  readonly charts: Charts;
  /** Null where the browser has no WebGL. */
  readonly building: BuildingView | null;
  /** The latest frames of the page: milliseconds between them, and of our own work in each. */
  readonly costs = {between: new Float32Array(KEPT_COSTS), work: new Float32Array(KEPT_COSTS), count: 0};
  /** Of the frame shown; filled anew for the next. */
  graph: Graph | null = null;

  private readonly room: RoomView;
  private readonly status = new StatusLine();
  private readonly grounds = new Map<Building, Ground>();
  private ground: Ground | null = null;
  private predictor: Predictor | null = null;
  private endSampling: () => void = () => undefined;
  private stale = true;       // the frame shown is another than the player's
  private span = Infinity;    // of the charts, seconds
  private shownTo = 0;
  private refilled = 0;
  private lastTick = NaN;

  constructor(private readonly forewalk: Forewalk) {
    const theme = currentTheme();
    this.building = makeBuildingView();
    this.room = new RoomView(get('room-canvas'), theme);
    this.charts = new Charts(get('charts'), theme);
    this.charts.onSeek = (time) => this.seek(time);
    onTheme((now) => {
      this.building?.setTheme(now);
      this.room.setTheme(now);
      this.charts.setTheme(now);
      this.stale = true;
    });
    new ResizeObserver(() => { this.stale = true; }).observe(get('room-canvas'));
    if (this.building) this.building.onPick = (pick) => this.say(pick);
    requestAnimationFrame((now) => this.tick(now));
  }

  /** A building's ground, loaded once. Throws ForewalkError for a damaged navmesh. */
  groundOf(building: Building): Ground {
    let ground = this.grounds.get(building);
    if (!ground) {
      ground = openGround(this.forewalk, building);
      this.grounds.set(building, ground);
    }
    return ground;
  }

  /** Shows another source; null ground: where it walks is not known, and there are no graphs. */
  open(source: Source, ground: Ground | null): void {
    this.endSampling();
    this.predictor?.release();
    this.player.open(source);
    if (ground !== this.ground || !ground) this.building?.setGround(ground, startOf(source, ground));
    this.ground = ground;
    this.predictor = ground && new Predictor(ground, source.walk);
    this.room.setRoom(source.walk.room);
    get('title').textContent = source.title;
    get('picked').textContent = '';
    this.building?.select(null);
    this.fitCharts(true);
    this.stale = true;
    if (ground && !source.live) this.endSampling = sampleGraphTimes(ground, source.walk, () => this.charts.refill());
  }

  seek(time: number): void {
    this.player.seek(time);
    this.stale = true;
  }

  step(frames: number): void {
    this.player.step(frames);
    this.stale = true;
  }

  /** To where a reset began, before or after the frame shown. */
  toReset(direction: number): void {
    const walk = this.player.source?.walk;
    if (!walk) return;
    const {frame} = this.player;
    const found = direction > 0 ? walk.resetFrames.find((at) => at > frame)
      : walk.resetFrames.filter((at) => at < frame).at(-1);
    if (found !== undefined) this.seek(walk.time[found]);
  }

  /** How much time the charts show, seconds; Infinity: all. */
  setSpan(seconds: number): void {
    this.span = seconds;
    this.fitCharts(true);
  }

  /** Says what is at a place of the floor, and shows it. */
  say(pick: Pick | null): void {
    const polygon = pick && this.ground?.polygons[pick.polygon];
    this.building?.select(polygon ? pick.polygon : null);
    get('picked').textContent = polygon ? describePolygon(pick.polygon, polygon, pick.point, this.graph)
      : 'No walkable floor here.';
  }

  private tick(now: number): void {
    requestAnimationFrame((next) => this.tick(next));
    const begin = performance.now();
    const moved = this.player.tick(now);
    const walk = this.player.source?.walk;
    if (walk && walk.length > 0 && (moved || this.stale)) {
      this.show(now, this.stale && !this.player.playing);
      this.stale = false;
    }
    this.building?.draw(now);
    const {costs} = this;
    costs.between[costs.count % KEPT_COSTS] = Number.isNaN(this.lastTick) ? 0 : now - this.lastTick;
    costs.work[costs.count % KEPT_COSTS] = performance.now() - begin;
    ++costs.count;
    this.lastTick = now;
  }

  private show(now: number, settled: boolean): void {
    const {frame} = this.player;
    const {walk, live} = this.player.source!;
    this.graph = this.predictor?.at(frame) ?? null;
    this.building?.show(walk, frame, this.graph);
    this.room.show(walk, frame);
    if (live && now - this.refilled > REFILL) {
      this.refilled = now;
      this.fitCharts(walk.duration > this.shownTo);
      this.charts.refill();
    }
    if (this.span !== Infinity) this.fitCharts(false);
    this.charts.mark(walk, frame);
    this.status.show(walk, frame, this.graph, now, settled);
    const scrub = get<HTMLInputElement>('scrub');
    if (scrub.max !== String(walk.duration)) scrub.max = String(walk.duration);
    if (document.activeElement !== scrub || this.player.playing) scrub.value = String(this.player.time);
  }

  /** Chooses what the charts show: all, or a span that the frame shown is in. */
  private fitCharts(anew: boolean): void {
    const source = this.player.source;
    if (!source) return;
    const {walk} = source;
    if (this.span === Infinity) {
      if (!anew) return;
      // A walk that grows gets room to grow into, so that its charts do not creep.
      this.shownTo = !source.live ? walk.duration
        : this.player.playing ? Math.max(30, walk.duration * GROWTH) : Math.max(10, walk.duration);
      this.charts.show(walk, 0, this.shownTo);
      return;
    }
    const page = Math.floor(this.player.time / this.span) * this.span;
    if (!anew && page + this.span === this.shownTo) return;
    this.shownTo = page + this.span;
    this.charts.show(walk, page, this.shownTo);
  }
}

/** Where a walk begins on the virtual floor, as far as it is known. */
function startOf({walk}: Source, ground: Ground | null): number[] {
  if (walk.length === 0) return ground?.building.start.floor ?? [0, 0, 0];
  return [walk.virtual[0], walk.virtual[1] - walk.physical[1], walk.virtual[2]].map((x) => Number.isFinite(x) ? x : 0);
}

function makeBuildingView(): BuildingView | null {
  try {
    return new BuildingView(get('building-canvas'), currentTheme());
  } catch {
    const instead = get('no-webgl');
    instead.textContent = 'This browser has no WebGL, so the building is not drawn; the room and the charts are. ' +
      'Switch hardware acceleration on, or try another browser.';
    instead.hidden = false;
    get('building-canvas').hidden = true;
    return null;
  }
}
