// A session at the daemon that served this page (service/daemon/PROTOCOL.md): the body walks here, frames go there and
// come back as JSON. Cut off, it keeps what it has and goes on with the last token.
import {emptyFrame, type Frame, type Graph} from 'forewalk';
import type {Ground} from './ground';
import {fillFrame, makeBody} from './page_walk';
import {Predictor} from './predictor';
import {RATE, settingsJson, type Body, type LiveSettings, type Source} from './source';
import {emptyWalkFrame, Walk} from './walk';

// Where an answer says "step back" but not how far, a step at a time is taken, metres.
const STEP_BACK = 0.05;

const NOWHERE: Graph = {horizon: 0, completeTo: 0, nodes: [], edges: [], fronts: [], ways: [], likelihoodNone: 1};

/** The access token, for a page that was asked for one; null: none was needed so far. */
export interface Access {
  token: string | null;
}

export type Connection = 'opening' | 'open' | 'lost' | 'refused';

const withToken = (access: Access): HeadersInit => access.token ? {Authorization: `Bearer ${access.token}`} : {};

/** The navmesh that the daemon walks in; null: this page was not served by one. Throws Error('access') for a token. */
export async function daemonNavmesh(access: Access): Promise<Uint8Array | null> {
  if (!location.protocol.startsWith('http')) return null;
  const answer = await fetch('/v1/navmesh', {headers: withToken(access)}).catch(() => null);
  if (answer?.status === 401) throw new Error('access');
  if (!answer?.ok || answer.headers.get('Content-Type') !== 'application/octet-stream') return null;
  return new Uint8Array(await answer.arrayBuffer());
}

interface Answer {
  format?: string;
  code?: string;
  message?: string;
  navmesh: string;
  session: string;
  resumed: boolean;
  flags: number;
  position: number[];
  orientation: number[];
  gains: {translation: number; rotation: number; curvature: number; bending: number};
  injected_yaw: number;
  injected_translation: number[];
  reset: {turning: boolean; instruction: string; remaining: number; turned: number; count: number};
  graph_nodes: number;
  token: string;
}

function read(answer: Answer, frame: Frame): void {
  frame.flags = answer.flags;
  frame.position.set(answer.position);
  frame.orientation.set(answer.orientation);
  frame.translation = answer.gains.translation;
  frame.rotation = answer.gains.rotation;
  frame.curvature = answer.gains.curvature;
  frame.bending = answer.gains.bending;
  frame.injectedYaw = answer.injected_yaw;
  frame.injectedTranslation.set(answer.injected_translation);
  frame.resetting = answer.reset.turning;
  frame.instruction = answer.reset.instruction.replaceAll('_', '-') as Frame['instruction'];
  frame.resetRemaining = answer.reset.remaining;
  frame.resetTurned = answer.reset.turned;
  frame.resetCount = answer.reset.count;
  frame.resetBack = frame.instruction === 'step-back' ? STEP_BACK : 0;
  frame.graphNodes = answer.graph_nodes;
}

export class DaemonWalk implements Source {
  readonly walk: Walk;
  readonly title: string;
  readonly live = true;
  readonly rate = RATE;
  readonly body: Body;
  /** Told of every change, with a sentence for people where something went wrong. */
  onConnection: (state: Connection, message: string) => void = () => undefined;

  private socket: WebSocket | null = null;
  private state: Connection = 'lost';
  private token: string | null = null;
  private wanted = 0;          // the walk is to reach, seconds
  private underWay = false;    // a frame was sent and not answered
  private said = '';           // the last error, before the connection closes
  private released = false;
  private idle = false;        // cut off because nothing was asked for
  private readonly predictor: Predictor;
  private readonly hello: Record<string, unknown>;
  private readonly frame = emptyFrame();
  private readonly row = emptyWalkFrame();

  constructor(ground: Ground, settings: LiveSettings, private readonly access: Access) {
    const {start} = ground.building;
    this.hello = settingsJson(settings, start);
    this.title = `${ground.building.name}, walked at ${location.host}`;
    this.walk = new Walk({session: '', scene: `${ground.building.id}.obj`, navmesh: ground.hash, settings: this.hello}, settings.room);
    // Answers say no likelihoods: who wanders goes by what is predicted here.
    this.predictor = new Predictor(ground, this.walk);
    this.body = makeBody(ground, settings, () => this.predictor.at(this.walk.length - 1) ?? NOWHERE);
    this.connect();
  }

  /** Begins, or goes on where the connection was lost. */
  connect(): void {
    if (this.released || this.state === 'opening' || this.state === 'open') return;
    this.change('opening', '');
    this.said = '';
    this.idle = false;
    this.underWay = false;
    const protocols = this.access.token ? ['forewalk.1', `token.${this.access.token}`] : ['forewalk.1'];
    const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/v1/session`, protocols);
    this.socket = socket;
    socket.onopen = () => socket.send(JSON.stringify({
      format: 'forewalk.hello/1', session: this.hello, ...(this.token ? {token: this.token} : {}),
    }));
    socket.onmessage = (event) => this.take(JSON.parse(event.data as string) as Answer);
    socket.onclose = () => {
      if (this.socket !== socket || this.released) return;
      this.socket = null;
      this.underWay = false;
      this.change(this.said === '' ? 'lost' : 'refused', this.said ||
        'The daemon is gone: the walk so far stays. Start it again and reconnect.');
    };
  }

  reach(time: number): void {
    this.wanted = time;
    if (this.idle) this.connect();
    else this.send();
  }

  release(): void {
    this.released = true;
    this.socket?.close(1000);
    this.predictor.release();
  }

  private change(state: Connection, message: string): void {
    this.state = state;
    this.onConnection(state, message);
  }

  private send(): void {
    const {body, walk} = this;
    if (this.state !== 'open' || this.underWay || walk.duration + 0.5 / RATE >= this.wanted && walk.length > 0) return;
    this.underWay = true;
    this.socket!.send(JSON.stringify({
      sequence: walk.length, seconds: walk.length / RATE, position: Array.from(body.position),
      orientation: Array.from(body.orientation),
    }));
  }

  private take(answer: Answer): void {
    if (answer.format === 'forewalk.error/1') {
      this.said = `The daemon says: ${answer.message}`;
      // A token that is no longer good is not sent again.
      if (answer.code === 'token') this.token = null;
      this.idle = answer.code === 'limit.idle_seconds';
    } else if (answer.format === 'forewalk.welcome/1') {
      this.walk.head.session = answer.session;
      if (answer.navmesh !== this.walk.head.navmesh) {
        this.said = 'The daemon walks in another navmesh than this page drew: reload the page.';
        this.socket?.close(1000);
        return;
      }
      this.change('open', answer.resumed ? 'The walk goes on where it was cut off.' : '');
      this.send();
    } else {
      this.underWay = false;
      this.token = answer.token;
      read(answer, this.frame);
      fillFrame(this.row, this.walk.length / RATE, this.body, this.frame);
      this.walk.append(this.row);
      this.body.advance(1 / RATE, this.frame);
      this.send();
    }
  }
}
