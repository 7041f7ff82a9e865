// The form of a walk in the page: scene, controller, horizon, room, walker; filled from the page's address.
import type {Controller} from 'forewalk';
import {buildings} from './buildings';
import {get} from './dom';
import {rectangle, type Room} from './room';
import type {LiveSettings} from './source';
import type {RecordedSettings} from './walk';

const CONTROLLERS: readonly [Controller, string][] = [
  ['foresight', 'foresight'], ['none', 'none'], ['s2c', 'steer to center'], ['s2o', 'steer to orbit'],
  ['s2c-predictive', 's2c, predictive'], ['s2o-predictive', 's2o, predictive'], ['s2mt', 's2mt'], ['s2mt+c', 's2mt+c'],
  ['zigzag', 'zigzag'], ['p2r', 'p2r'], ['messinger', 'messinger'], ['dynamic-apf', 'dynamic APF'],
  ['haptics', 'haptics'], ['arc', 'arc'], ['visibility', 'visibility'], ['mpcred', 'mpcred'], ['force', 'force'],
];

const ROOMS: readonly [string, string, Room][] = [
  ['4x4', '4 × 4 m', rectangle(4, 4)], ['5x5', '5 × 5 m', rectangle(5, 5)], ['6x6', '6 × 6 m', rectangle(6, 6)],
  ['6x4', '6 × 4 m', rectangle(6, 4)], ['8x8', '8 × 8 m', rectangle(8, 8)], ['10x10', '10 × 10 m', rectangle(10, 10)],
  ['L', 'L, 6 × 6 m', {border: [[-3, 3], [3, 3], [3, 0], [0.5, 0], [0.5, -3], [-3, -3]], holes: []}],
  ['pillar', '6 × 6 m, pillar', {...rectangle(6, 6), holes: [[[1, -1], [1.5, -1], [1.5, -1.5], [1, -1.5]]]}],
];

/** The building that the daemon walks in, in the list of scenes. */
export const DAEMON = 'daemon';
const RECORDED = 'recorded';

export class Controls {
  /** Told when somebody chose something else that can be walked. */
  onChange: () => void = () => undefined;

  private readonly scene = get<HTMLSelectElement>('scene');
  private readonly controller = get<HTMLSelectElement>('controller');
  private readonly horizon = get<HTMLInputElement>('horizon');
  private readonly room = get<HTMLSelectElement>('room');
  private readonly walker = get<HTMLSelectElement>('walker');
  private readonly rooms = new Map<string, Room>(ROOMS.map(([id, , room]) => [id, room]));
  private seed = 1;

  constructor(address: URLSearchParams) {
    for (const building of buildings) this.scene.add(new Option(building.name, building.id));
    for (const [id, name] of CONTROLLERS) this.controller.add(new Option(name, id));
    for (const [id, name] of ROOMS) this.room.add(new Option(name, id));
    this.room.value = '5x5';
    for (const name of ['scene', 'controller', 'horizon', 'walker'] as const) {
      const value = address.get(name);
      if (value === null) continue;
      const before = this[name].value;
      this[name].value = value;
      if (this[name].value !== value) this[name].value = before;  // a word that is not known
    }
    const room = address.get('room');
    if (room !== null) this.addRoom(room);
    this.seed = Number.parseInt(address.get('seed') ?? '1', 10) || 1;
    get('controls').addEventListener('change', () => {
      if (this.horizon.checkValidity()) this.onChange();
      else this.horizon.reportValidity();
    });
    get('controls').addEventListener('submit', (event) => event.preventDefault());
  }

  /** A building's id, or DAEMON. */
  get sceneId(): string {
    return this.scene.value;
  }

  /** Offers the daemon's building, and picks it. */
  addDaemon(name: string): void {
    this.scene.add(new Option(`${name}, at the daemon`, DAEMON), 0);
    this.scene.value = DAEMON;
  }

  addBuilding(name: string, id: string): void {
    this.scene.add(new Option(name, id));
  }

  /** Shows what a recording was made with, as far as it is among the choices: a change then begins from there. */
  reflect(settings: RecordedSettings, room: Room | null, scene: string | null): void {
    const pick = (select: HTMLSelectElement, value: string): void => {
      if ([...select.options].some((option) => option.value === value)) select.value = value;
    };
    if (scene !== null) pick(this.scene, scene);
    if (settings.controller) pick(this.controller, settings.controller);
    if (settings.horizon_m) this.horizon.value = String(settings.horizon_m);
    if (!room) return;
    if (!this.rooms.has(RECORDED)) this.room.add(new Option('as recorded', RECORDED));
    this.rooms.set(RECORDED, room);
    this.room.value = RECORDED;
  }

  /** Of the next walk. */
  get settings(): LiveSettings {
    return {
      controller: this.controller.value as Controller, horizon: this.horizon.valueAsNumber,
      room: this.rooms.get(this.room.value)!, walker: this.walker.value as LiveSettings['walker'], seed: this.seed,
    };
  }

  private addRoom(text: string): void {
    const sides = /^(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)$/.exec(text)?.slice(1).map(Number);
    if (!this.rooms.has(text)) {
      if (!sides || Math.min(...sides) < 0.5 || Math.max(...sides) > 1000) return;
      this.rooms.set(text, rectangle(sides[0], sides[1]));
      this.room.add(new Option(`${sides[0]} × ${sides[1]} m`, text));
    }
    this.room.value = text;
  }
}
