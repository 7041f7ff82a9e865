// The button: why it can't be pressed, what it asks, and the walk that follows.
import type {Controller, Forewalk} from 'forewalk';
import type {Building} from '../buildings';
import {VrDialog} from './dialog';
import {Prepared, requestSession, VrWalk, whyNoVr, type Choice} from './enter';

const SOON = 150;  // milliseconds after the last change until a choice is prepared

/**
 * Makes `button` start VR. `chosen`: what the page shows at the moment, to begin with. `say`: shows a sentence to
 * the person. Each walk is also told to `document` as an event, forewalk:vr, its detail the VrWalk.
 */
export function offerVr(button: HTMLButtonElement, forewalk: Forewalk, buildings: readonly Building[],
                        chosen: () => {building?: string; controller?: Controller} = () => ({}),
                        say: (sentence: string) => void = () => {}): void {
  let dialog: VrDialog | null = null;
  let walking = false;
  let prepared: Prepared | null = null;
  let timer = 0;

  const check = async () => {
    const reason = await whyNoVr();
    button.disabled = reason !== null || walking;
    button.title = reason ?? 'Walk the building in your own room, with a headset';
    button.setAttribute('aria-description', button.title);
  };
  const drop = () => {
    clearTimeout(timer);
    prepared?.dispose();
    prepared = null;
  };
  const prepare = (choice: Choice) => {
    if (prepared?.choice === choice) return prepared;
    drop();
    return prepared = new Prepared(choice, (building) => forewalk.navmesh(building.fwmesh));
  };

  const prepareAhead = (choice: Choice) => {
    try {
      prepare(choice);
    } catch {  // start() says why
    }
  };

  const start = async (choice: Choice) => {
    walking = true;
    clearTimeout(timer);
    // First of all: browsers grant sessions only while they deal with the click.
    const asked = requestSession();
    try {
      const ready = prepare(choice);
      const walk = await VrWalk.begin(await asked, ready);
      prepared = null;  // the walk's, from here on
      document.dispatchEvent(new CustomEvent('forewalk:vr', {detail: walk}));
      await walk.ended;
    } catch (error) {
      say(`VR could not begin. ${(error as Error).message}`);
      asked.then((session) => session.end()).catch(() => {});
      drop();
    } finally {
      walking = false;
      await check();
    }
  };

  button.addEventListener('click', () => {
    if (!dialog) {
      dialog = new VrDialog(buildings);
      document.body.append(dialog.element);
      dialog.element.addEventListener('close', () => {
        if (!walking) drop();
      });
      dialog.onChoice = (choice) => {
        clearTimeout(timer);
        if (choice) timer = window.setTimeout(() => prepareAhead(choice), SOON);
      };
      dialog.onStart = (choice) => void start(choice);
    }
    const {building, controller} = chosen();
    dialog.open(building, controller);
  });
  document.addEventListener('forewalk:notice', (event) => say((event as CustomEvent<string>).detail));
  navigator.xr?.addEventListener('devicechange', () => void check());
  void check();
}
