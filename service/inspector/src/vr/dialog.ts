// What is asked before VR begins: building, controller, and the room.
import type {Controller, Point2} from 'forewalk';
import scanned from 'virtual:scanned-rooms';
import type {Building} from '../buildings';
import './dialog.css';
import type {Choice} from './enter';
import {freeFloor, problemOf, rectangularRoom, type TrackedRoom} from './room';
import {RoomEditor} from './room_editor';

const CONTROLLERS: [Controller, string][] = [
  ['foresight', 'foresight: plans along your likely ways'],
  ['mpcred', 'mpcred: plans, as published'],
  ['s2c-predictive', 's2c-predictive: to the centre, with prediction'],
  ['s2c', 's2c: to the centre'],
  ['arc', 'arc: aligns room and building'],
  ['none', 'none: only resets'],
];
const STORED = 'forewalk.room';

const YOURS = 'your room';

/** The drawn room of this browser; 5 m x 5 m where none is kept. */
export function keptRoom(): TrackedRoom {
  try {
    const border = JSON.parse(localStorage.getItem(STORED) ?? 'null') as Point2[] | null;
    if (Array.isArray(border) && problemOf(border) === null) return {name: YOURS, border, obstacles: []};
  } catch {  // pages from disk may keep nothing, and others may have written there
  }
  return {...rectangularRoom(5, 5), name: YOURS};
}

function keepRoom(border: Point2[]): void {
  try {
    localStorage.setItem(STORED, JSON.stringify(border));
  } catch {  // then it is drawn anew next time
  }
}

type Kind = 'headset' | 'drawn' | 'scanned';

/** The dialog. `chosen` is called with each choice that can be walked, null for one that can't. */
export class VrDialog {
  readonly element = document.createElement('dialog');
  /** Called by a click on Start, with what is chosen. */
  onStart: (choice: Choice) => void = () => {};
  onChoice: (choice: Choice | null) => void = () => {};

  private readonly editor: RoomEditor;
  private border = keptRoom().border;
  private choice: Choice | null = null;

  constructor(private readonly buildings: readonly Building[]) {
    const {element} = this;
    element.className = 'vr-dialog';
    element.setAttribute('aria-labelledby', 'vr-title');
    const option = ([value, text]: readonly [string, string]) => `<option value="${value}">${text}</option>`;
    const side = (name: string, text: string) => `<label for="vr-${name}">${text}, m</label>
      <input id="vr-${name}" type="number" min="1" max="50" step="0.1" value="5">`;
    element.innerHTML = `
      <form method="dialog">
        <h2 id="vr-title">Walk it yourself</h2>
        <p class="lead">You walk the building on your own feet, in your own room. Where the room ends you are asked to
          stop and turn. Clear the floor first.</p>
        <div class="columns">
          <div>
            <div class="row"><label class="label" for="vr-building">Building</label>
              <select id="vr-building">${buildings.map(({id, name}) => option([id, name])).join('')}</select></div>
            <div class="row"><label class="label" for="vr-controller">Steering</label>
              <select id="vr-controller">${CONTROLLERS.map(option).join('')}</select></div>
            <fieldset class="row"><legend>Room</legend>
              <label class="choice"><input type="radio" name="vr-room" value="headset" checked>
                <span>As the headset says, or else as drawn</span></label>
              <label class="choice"><input type="radio" name="vr-room" value="drawn">
                <span>As drawn</span></label>
              <div class="sides">
                ${side('width', 'Width')} ${side('depth', 'Depth')}
                <button type="button" id="vr-rectangle">Rectangle</button></div>
              <label class="choice"><input type="radio" name="vr-room" value="scanned">
                <span>Somebody else's, scanned</span></label>
              <div class="sides"><label for="vr-scan">Scan</label><select id="vr-scan">
                ${scanned.map(({name}, i) => option([String(i), name])).join('')}</select></div>
            </fieldset>
          </div>
          <div class="drawing"></div>
        </div>
        <p class="state" role="status"></p>
        <div class="buttons"><button value="cancel" id="vr-cancel">Cancel</button>
          <button type="button" class="go" id="vr-start">Start</button></div>
      </form>`;
    this.editor = new RoomEditor((border) => {
      this.border = border.map(([x, z]): Point2 => [x, z]);
      if (problemOf(border) === null) keepRoom(border);
      this.choose();
    });
    element.querySelector('.drawing')!.append(this.editor.canvas, this.editor.said);
    element.addEventListener('change', (event) => {
      const {id} = event.target as HTMLElement;
      if (id === 'vr-scan') this.check('scanned');
      if (id !== 'vr-width' && id !== 'vr-depth') this.show();
    });
    this.part('vr-rectangle').addEventListener('click', () => this.makeRectangle());
    this.part('vr-start').addEventListener('click', () => {
      if (!this.choice) return;
      this.onStart(this.choice);
      element.close();
    });
  }

  /** Opens it, with building and controller as the page has them where it says so. */
  open(building?: string, controller?: Controller): void {
    const set = (id: string, value: string | undefined) => {
      const select = this.part<HTMLSelectElement>(id);
      if (value && [...select.options].some((option) => option.value === value)) select.value = value;
    };
    set('vr-building', building);
    set('vr-controller', controller);
    this.element.showModal();
    this.show();
  }

  private part<Type extends HTMLElement = HTMLElement>(id: string): Type {
    return this.element.querySelector<Type>(`#${id}`)!;
  }

  private kind(): Kind {
    return this.element.querySelector<HTMLInputElement>('input[name="vr-room"]:checked')!.value as Kind;
  }

  private check(kind: Kind): void {
    this.element.querySelector<HTMLInputElement>(`input[value="${kind}"]`)!.checked = true;
  }

  private makeRectangle(): void {
    const [width, depth] = ['vr-width', 'vr-depth'].map((id) => this.part<HTMLInputElement>(id).valueAsNumber);
    if (!(width >= 1 && width <= 50 && depth >= 1 && depth <= 50)) {
      this.say('A rectangle takes a width and a depth of 1 to 50 m.', true);
      return;
    }
    this.border = rectangularRoom(width, depth).border;
    keepRoom(this.border);
    if (this.kind() === 'scanned') this.check('drawn');
    this.show();
  }

  private room(): TrackedRoom {
    if (this.kind() === 'scanned') return scanned[Number(this.part<HTMLSelectElement>('vr-scan').value)];
    return {name: YOURS, border: this.border, obstacles: []};
  }

  private show(): void {
    this.editor.show(this.room(), this.kind() !== 'scanned');
    this.choose();
  }

  private choose(): void {
    const room = this.room();
    const problem = problemOf(room.border);
    this.choice = null;
    try {
      if (problem) throw new Error(problem);
      const {area} = freeFloor(room);
      this.choice = {
        building: this.buildings.find(({id}) => id === this.part<HTMLSelectElement>('vr-building').value)!,
        controller: this.part<HTMLSelectElement>('vr-controller').value as Controller,
        room, asked: this.kind() === 'headset',
      };
      this.say(`${area.toFixed(1)} m\u00b2 to walk in, a hand's breadth from every wall.`, false);
    } catch (error) {
      this.say((error as Error).message, true);
    }
    this.part<HTMLButtonElement>('vr-start').disabled = this.choice === null;
    this.onChoice(this.choice);
  }

  private say(text: string, bad: boolean): void {
    const state = this.element.querySelector('.state')!;
    state.textContent = text;
    state.classList.toggle('bad', bad);
  }
}
