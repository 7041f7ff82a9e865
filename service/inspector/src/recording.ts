// Recordings, `forewalk.session/1` (service/daemon/PROTOCOL.md): read from disk in pieces while the page stays live, and
// written from a walk.
import {roomFromJson} from './room';
import {emptyWalkFrame, INSTRUCTIONS, POSE, Walk, type RecordedSettings, type WalkFrame, type WalkHead} from './walk';

/** What is wrong with a file, for people: where, what, what to try. */
export class RecordingError extends Error {}

const FORMAT = 'forewalk.session/1';
// Read on for so long before the page gets its turn, milliseconds.
const SLICE = 10;

const shortened = (text: string): string => text.length > 60 ? `${text.slice(0, 57)}…` : text;

// Lets what is waiting run; timers would wait 4 ms each time.
const channel = new MessageChannel();
const turns: (() => void)[] = [];
channel.port1.onmessage = () => turns.shift()?.();
const pageTurn = (): Promise<void> => new Promise((resolve) => {
  turns.push(resolve);
  channel.port2.postMessage(0);
});

interface Line {
  in?: {seconds: number | null; position: (number | null)[]; orientation: (number | null)[]};
  out?: {
    flags: number; position: (number | null)[]; orientation: (number | null)[];
    gains: {translation: number; rotation: number; curvature: number; bending: number};
    injected_yaw: number; injected_translation: number[];
    reset: {turning: boolean; instruction: string; remaining: number; turned: number; count: number};
    graph_nodes: number;
  };
  teleport?: {position: number[]; heading: number};
  world?: string;
}

/** Reads lines into a walk. */
class Reader {
  walk: Walk | null = null;
  private line = 0;
  private readonly frame = emptyWalkFrame();
  private teleport: number[] | null = null;

  constructor(private readonly name: string) {}

  read(text: string): void {
    ++this.line;
    if (text.length === 0) return;
    let json: unknown;
    try {
      json = JSON.parse(text);
    } catch {
      throw this.error(`this is not JSON: ${shortened(text)}`);
    }
    if (typeof json !== 'object' || json === null) throw this.error(`this is no JSON object: ${shortened(text)}`);
    if (!this.walk) this.begin(json as Record<string, unknown>);
    else this.add(this.walk, json as Line);
  }

  private begin(head: Record<string, unknown>): void {
    if (head.format !== FORMAT) {
      const said = typeof head.format === 'string' ? `its format is "${shortened(head.format)}"` : 'it names no format';
      throw this.error(`this is no recording: ${said}, ${FORMAT} is read here. forewalk serve --record and ` +
        'forewalk_session_record make one.');
    }
    const settings = (typeof head.settings === 'object' && head.settings !== null ? head.settings : {}) as RecordedSettings;
    const known: WalkHead = {
      session: String(head.session ?? ''), scene: String(head.scene ?? ''), navmesh: String(head.navmesh ?? ''), settings,
    };
    this.walk = new Walk(known, roomFromJson(known.settings.space));
  }

  private add(walk: Walk, line: Line): void {
    if (line.in && line.out) {
      try {
        fill(this.frame, line.in, line.out);
      } catch (fault) {
        throw this.error(`this frame lacks a field of PROTOCOL.md: ${(fault as Error).message}`);
      }
      if (this.teleport) walk.teleports.set(walk.length, this.teleport);
      this.teleport = null;
      walk.append(this.frame);
    } else if (line.teleport) {
      this.teleport = [...line.teleport.position, line.teleport.heading];
    } else if (line.world === 'changed') {
      walk.worldChanged = Math.min(walk.worldChanged, walk.length);
    }  // later versions may know more kinds of lines
  }

  private error(what: string): RecordingError {
    return new RecordingError(`${this.name}:${this.line}: ${what}`);
  }
}

function fill(frame: WalkFrame, told: NonNullable<Line['in']>, answer: NonNullable<Line['out']>): void {
  const number = (value: number | null): number => value ?? NaN;
  frame.seconds = number(told.seconds);
  for (let i = 0; i < POSE; ++i) {
    const q = i - 3;
    frame.physical[i] = number(i < 3 ? told.position[i] : told.orientation[q]);
    frame.virtual[i] = number(i < 3 ? answer.position[i] : answer.orientation[q]);
  }
  frame.flags = answer.flags;
  frame.gains[0] = answer.gains.translation;
  frame.gains[1] = answer.gains.rotation;
  frame.gains[2] = answer.gains.curvature;
  frame.gains[3] = answer.gains.bending;
  frame.injectedYaw = answer.injected_yaw;
  for (let i = 0; i < 3; ++i) frame.injected[i] = answer.injected_translation[i] ?? 0;
  frame.turning = answer.reset.turning;
  frame.instruction = Math.max(0, INSTRUCTIONS.indexOf(
    answer.reset.instruction.replaceAll('_', '-') as typeof INSTRUCTIONS[number]));
  frame.remaining = answer.reset.remaining;
  frame.turned = answer.reset.turned;
  frame.resets = answer.reset.count;
  frame.nodes = answer.graph_nodes;
}

/**
 * Reads a file into a walk. `progress` is told the share that is read, [0, 1], again and again; `stop` ends it with an
 * AbortError. A last line that is cut off is left out. Throws RecordingError for what is no recording, or has no frame.
 * An hour at 90 Hz takes some seconds, during which the page goes on.
 */
export async function readRecording(file: File, progress: (share: number) => void, stop: AbortSignal): Promise<Walk> {
  const reader = new Reader(file.name);
  const decoder = new TextDecoder();
  const stream = file.stream().getReader();
  let text = '';
  let bytes = 0;
  let turn = performance.now();
  try {
    for (;;) {
      const {done, value} = await stream.read();
      stop.throwIfAborted();
      if (value) bytes += value.length;
      text += decoder.decode(value, {stream: !done});
      let from = 0;
      for (let end = text.indexOf('\n'); end >= 0; end = text.indexOf('\n', from)) {
        reader.read(text.charCodeAt(end - 1) === 13 ? text.slice(from, end - 1) : text.slice(from, end));
        from = end + 1;
        if (performance.now() - turn < SLICE) continue;
        progress(bytes / file.size);
        await pageTurn();
        stop.throwIfAborted();
        turn = performance.now();
      }
      text = text.slice(from);
      if (done) break;
      // What has no line end by now is no recording, and need not be read to its end.
      if (text.length > 1 << 24) throw new RecordingError(`${file.name}: a line of more than 16 MB: this is no recording.`);
    }
  } finally {
    stream.cancel().catch(() => undefined);
  }
  if (!reader.walk && text.length > 0) reader.read(text);  // says what is wrong with the only line
  if (!reader.walk) throw new RecordingError(`${file.name}: it is empty; a recording has a line a frame.`);
  if (reader.walk.length === 0) {
    throw new RecordingError(`${file.name}: it has a recording's first line, and no frame after it.`);
  }
  return reader.walk;
}

/** As the library writes a float: as short as reads back to the same one, -0 apart from 0. */
function floatText(value: number): string {
  if (!Number.isFinite(value)) return 'null';
  if (Object.is(value, -0)) return '-0.0';
  let shortest = value;
  for (let digits = 6; digits < 9; ++digits) {
    const rounded = Number(value.toPrecision(digits));
    if (Math.fround(rounded) !== value) continue;
    shortest = rounded;
    break;
  }
  if (shortest === value) shortest = Number(value.toPrecision(9));
  const size = Math.abs(shortest);
  if (size === 0 || size >= 1e-4 && size < 1e16) return String(shortest);
  return shortest.toExponential().replace(/e([+-])(\d)$/, 'e$10$2');
}

/** A walk as the text of a recording, in pieces of some thousand lines for a Blob. O(frames), a second for an hour. */
export function recordingText(walk: Walk): string[] {
  const pieces = [JSON.stringify({
    format: FORMAT, session: walk.head.session, scene: walk.head.scene, navmesh: walk.head.navmesh,
    settings: walk.head.settings, state: null,
  }) + '\n'];
  const numbers = (column: Float32Array, from: number, count: number): string => {
    let text = '';
    for (let i = from; i < from + count; ++i) text += (i > from ? ',' : '') + floatText(column[i]);
    return `[${text}]`;
  };
  let piece = '';
  for (let i = 0; i < walk.length; ++i) {
    const teleport = walk.teleports.get(i);
    if (teleport) piece += `{"teleport":{"position":[${teleport.slice(0, 3)}],"heading":${teleport[3]}}}\n`;
    const seconds = Number.isFinite(walk.clock[i]) ? walk.clock[i] : null;
    piece += `{"in":{"sequence":${i},"seconds":${seconds},"position":${numbers(walk.physical, POSE * i, 3)},` +
      `"orientation":${numbers(walk.physical, POSE * i + 3, 4)}},"out":{"sequence":${i},"flags":${walk.flags[i]},` +
      `"position":${numbers(walk.virtual, POSE * i, 3)},"orientation":${numbers(walk.virtual, POSE * i + 3, 4)},` +
      `"gains":{"translation":${floatText(walk.translation[i])},"rotation":${floatText(walk.rotation[i])},` +
      `"curvature":${floatText(walk.curvature[i])},"bending":${floatText(walk.bending[i])}},` +
      `"injected_yaw":${floatText(walk.injectedYaw[i])},` +
      `"injected_translation":${numbers(walk.injected, 3 * i, 3)},"reset":{"turning":${walk.turning[i] === 1},` +
      `"instruction":"${INSTRUCTIONS[walk.instruction[i]].replaceAll('-', '_')}",` +
      `"remaining":${floatText(walk.remaining[i])},"turned":${floatText(walk.turned[i])},"count":${walk.resets[i]}},` +
      `"graph_nodes":${walk.nodes[i]}}}\n`;
    if (i % 4096 !== 4095) continue;
    pieces.push(piece);
    piece = '';
  }
  pieces.push(piece);
  return pieces;
}
