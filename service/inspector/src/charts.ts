// Time series of a walk: gains, border distance, graph time. One time axis, one playhead over all.
//
// A recorded hour has 324,000 frames and a chart some 800 pixels: each pixel gets the smallest and the largest value of
// its frames, so that no peak is lost. The playhead is an element of its own: moving it draws no chart anew.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import {fixed} from './describe';
import {span} from './dom';
import type {Theme} from './theme';
import type {Walk} from './walk';

interface Series {
  label: string;
  scale: string;
  values: (walk: Walk) => ArrayLike<number>;
  color: (theme: Theme) => string;
  digits: number;
  /** Down to 0. */
  filled?: boolean;
}

interface ChartSpec {
  id: string;
  title: string;
  series: Series[];
  scales: Record<string, {unit: string; range: (min: number | null, max: number | null) => [number, number]}>;
}

const padded = (least: number, most: number) => (min: number | null, max: number | null): [number, number] =>
  [Math.min(least, min ?? least), Math.max(most, max ?? most)];

export const CHARTS: ChartSpec[] = [
  {
    id: 'gains', title: 'Gains',
    scales: {
      ratio: {unit: '', range: padded(0.6, 1.4)},
      curvature: {unit: '1/m', range: (min, max) => {
        const most = Math.max(0.06, Math.abs(min ?? 0), Math.abs(max ?? 0));
        return [-most, most];
      }},
    },
    series: [
      {label: 'translation', scale: 'ratio', values: (walk) => walk.translation, color: (t) => t.series[0], digits: 3},
      {label: 'rotation', scale: 'ratio', values: (walk) => walk.rotation, color: (t) => t.series[1], digits: 3},
      {label: 'curvature 1/m', scale: 'curvature', values: (walk) => walk.curvature, color: (t) => t.series[2], digits: 3},
    ],
  },
  {
    id: 'border', title: 'Border distance',
    scales: {metres: {unit: 'm', range: padded(0, 1)}},
    series: [{label: 'metres', scale: 'metres', values: (walk) => walk.border, color: (t) => t.series[0], digits: 2, filled: true}],
  },
  {
    id: 'graph', title: 'Graph time',
    scales: {ms: {unit: 'ms', range: padded(0, 0.2)}},
    series: [{
      label: 'ms a frame, in this page', scale: 'ms', values: (walk) => walk.graphTime, color: (t) => t.series[3], digits: 3,
      filled: true,
    }],
  },
];

export const clockText = (seconds: number): string => {
  const whole = Math.floor(Math.abs(seconds));
  const hours = Math.floor(whole / 3600);
  const rest = `${String(Math.floor(whole / 60) % 60).padStart(hours ? 2 : 1, '0')}:${String(whole % 60).padStart(2, '0')}`;
  return (seconds < 0 ? '-' : '') + (hours ? `${hours}:${rest}` : rest);
};

// Between two labels of the time axis, seconds.
const TIME_STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 36000, 86400];
const LEFT = 44;    // pixels for the axes, the same in all charts, so that times lie below each other
const RIGHT = 48;

export class Charts {
  /** Told of the time that somebody clicks at or drags over, seconds. */
  onSeek: (seconds: number) => void = () => undefined;

  private walk: Walk | null = null;
  private from = 0;
  private to = 1;
  private plots: uPlot[] = [];
  private readonly values: HTMLElement[][] = [];
  private readonly swatches: [HTMLElement, Series][] = [];
  private readonly boxes: HTMLElement[] = [];
  private readonly playhead: HTMLElement;

  /** Fills `parent` with a figure per chart. */
  constructor(private readonly parent: HTMLElement, private theme: Theme) {
    for (const spec of CHARTS) {
      const figure = document.createElement('figure');
      figure.className = 'chart';
      const caption = document.createElement('figcaption');
      caption.append(span('chart-title', spec.title));
      this.values.push(spec.series.map((series) => {
        const entry = span('chart-entry', '');
        const swatch = span('swatch', '');
        this.swatches.push([swatch, series]);
        const value = span('chart-value', '–');
        entry.append(swatch, series.label, value);
        caption.append(entry);
        return value;
      }));
      const box = document.createElement('div');
      box.className = 'chart-box';
      figure.append(caption, box);
      this.boxes.push(box);
      parent.append(figure);
    }
    this.playhead = document.createElement('div');
    this.playhead.className = 'playhead';
    parent.append(this.playhead);
    new ResizeObserver(() => this.resize()).observe(parent);
    this.make();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.make();
  }

  /** Shows another walk, from and to these times. */
  show(walk: Walk | null, from: number, to: number): void {
    this.walk = walk;
    this.from = from;
    this.to = Math.max(to, from + 1);
    this.refill();
  }

  /** Draws what has been added to the walk since. */
  refill(): void {
    const {walk, from, to} = this;
    const width = Math.max(50, Math.round(this.plotWidth()));
    CHARTS.forEach((spec, i) => {
      const data: uPlot.AlignedData = walk && walk.length > 0
        ? envelopes(walk, spec.series.map((series) => series.values(walk)), from, to, width)
        : [[from, to], ...spec.series.map(() => [null, null])];
      const plot = this.plots[i];
      plot.batch(() => {
        plot.setData(data, false);
        plot.setScale('x', {min: from, max: to});
      });
    });
  }

  /** Puts the playhead to a frame and says the values there. */
  mark(walk: Walk, frame: number): void {
    const share = (walk.time[frame] - this.from) / (this.to - this.from);
    this.playhead.style.transform = `translateX(${LEFT + Math.min(1, Math.max(0, share)) * this.plotWidth()}px)`;
    CHARTS.forEach((spec, i) => spec.series.forEach((series, k) => {
      const value = series.values(walk)[frame];
      const text = Number.isFinite(value) ? fixed(value, series.digits) : '–';
      const element = this.values[i][k];
      if (element.textContent !== text) element.textContent = text;
    }));
  }

  private plotWidth(): number {
    return this.parent.clientWidth - LEFT - RIGHT;
  }

  private resize(): void {
    this.plots.forEach((plot, i) => {
      const width = this.parent.clientWidth, height = this.boxes[i].clientHeight;
      if (width > 0 && height > 0 && (plot.width !== width || plot.height !== height)) plot.setSize({width, height});
    });
    this.refill();
  }

  private make(): void {
    for (const plot of this.plots) plot.destroy();
    const {theme} = this;
    for (const [swatch, series] of this.swatches) swatch.style.background = series.color(theme);
    const font = `11px ${getComputedStyle(this.parent).fontFamily}`;
    const axis = {stroke: theme.quiet, font, grid: {stroke: theme.rule, width: 1}, ticks: {show: false}};
    this.plots = CHARTS.map((spec, index) => {
      const last = index === CHARTS.length - 1;
      const scales: uPlot.Scales = {x: {time: false}};
      const axes: uPlot.Axis[] = [{
        ...axis, size: last ? 22 : 6, gap: 2, space: 70, incrs: TIME_STEPS,
        values: (_, splits) => splits.map((split) => last ? clockText(split) : ''),
      }];
      Object.entries(spec.scales).forEach(([name, scale], i) => {
        scales[name] = {range: (_, min, max) => scale.range(min, max)};
        axes.push({
          ...axis, scale: name, side: i === 0 ? 3 : 1, size: i === 0 ? LEFT : RIGHT, gap: 4, space: 20,
          grid: i === 0 ? axis.grid : {show: false},
          values: (_, splits) => splits.map((split) => String(Math.round(1000 * split) / 1000)),
        });
      });
      if (axes.length === 2) axes.push({...axis, scale: Object.keys(spec.scales)[0], side: 1, size: RIGHT, grid: {show: false}, values: () => []});
      return new uPlot({
        width: Math.max(100, this.parent.clientWidth), height: Math.max(40, this.boxes[index].clientHeight),
        padding: [6, 0, 0, 0], legend: {show: false}, scales, axes,
        cursor: {
          sync: {key: 'forewalk'}, drag: {x: false, y: false}, y: false, points: {show: false},
          bind: {
            mousedown: (plot, _, handler) => (event) => {
              handler(event);
              this.seek(plot, event);
              return null;
            },
            mousemove: (plot, _, handler) => (event) => {
              handler(event);
              if ((event as MouseEvent).buttons === 1) this.seek(plot, event);
              return null;
            },
          },
        },
        series: [{}, ...spec.series.map((series): uPlot.Series => ({
          scale: series.scale, stroke: series.color(theme), width: 1.25, points: {show: false}, spanGaps: true,
          fill: series.filled ? `${series.color(theme)}26` : undefined,
        }))],
        hooks: {drawClear: [(plot) => this.drawResets(plot)]},
      }, [[0, 1], ...spec.series.map(() => [null, null])] as uPlot.AlignedData, this.boxes[index]);
    });
    this.refill();
  }

  private seek(plot: uPlot, event: Event): void {
    const box = plot.over.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, ((event as MouseEvent).clientX - box.left) / box.width));
    this.onSeek(this.from + share * (this.to - this.from));
  }

  /** A faint line where a reset began, in every chart. */
  private drawResets(plot: uPlot): void {
    const {walk} = this;
    if (!walk) return;
    const {ctx} = plot;
    ctx.save();
    ctx.strokeStyle = this.theme.reset;
    // Fainter where there are many, so that a recorded hour can still be read.
    const shown = walk.resetFrames.filter((frame) => walk.time[frame] >= this.from && walk.time[frame] <= this.to).length;
    ctx.globalAlpha = Math.max(0.08, Math.min(0.4, 24 / shown));
    ctx.lineWidth = devicePixelRatio;
    ctx.beginPath();
    let drawn = -Infinity;
    for (const frame of walk.resetFrames) {
      const time = walk.time[frame];
      if (time < this.from || time > this.to) continue;
      const x = Math.round(plot.valToPos(time, 'x', true));
      if (x - drawn < 1) continue;
      drawn = x;
      ctx.moveTo(x, plot.bbox.top);
      ctx.lineTo(x, plot.bbox.top + plot.bbox.height);
    }
    ctx.stroke();
    ctx.restore();
  }
}

/** Two points a pixel: the smallest and the largest value of its frames; null where there is none. O(frames shown). */
export function envelopes(walk: Walk, columns: ArrayLike<number>[], from: number, to: number,
                          pixels: number): uPlot.AlignedData {
  const first = walk.frameAt(from);
  const end = walk.frameAt(to) + 1;
  if (end - first <= 2 * pixels) {
    const x: number[] = [];
    const ys: (number | null)[][] = columns.map(() => []);
    for (let i = first; i < end; ++i) {
      x.push(walk.time[i]);
      columns.forEach((column, k) => ys[k].push(Number.isFinite(column[i]) ? column[i] : null));
    }
    return [x, ...ys];
  }
  const x: number[] = [];
  const ys: (number | null)[][] = columns.map(() => []);
  let i = first;
  for (let pixel = 0; pixel < pixels; ++pixel) {
    const until = from + (to - from) * (pixel + 1) / pixels;
    const begin = i;
    while (i < end && walk.time[i] < until) ++i;
    if (i === begin) continue;
    x.push(walk.time[begin], walk.time[i - 1] + 1e-9);
    columns.forEach((column, k) => {
      let low = Infinity, high = -Infinity;
      for (let frame = begin; frame < i; ++frame) {
        const value = column[frame];
        if (value < low) low = value;
        if (value > high) high = value;
      }
      ys[k].push(low <= high ? low : null, low <= high ? high : null);
    });
  }
  return [x, ...ys];
}
