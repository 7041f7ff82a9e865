// The page's keys. What has the focus comes first: fields take their letters, buttons their space, the building its
// arrows (building_view.ts).
export interface Keys {
  togglePlay(): void;
  step(frames: number): void;
  seekBy(seconds: number): void;
  toStart(): void;
  toEnd(): void;
  /** To the reset before (-1) or to the next (1). */
  toReset(direction: number): void;
  zoom(factor: number): void;
  toggleFollow(): void;
  help(): void;
  /** A key that steers went down or up; true where it was one. */
  steer(code: string, down: boolean): boolean;
  letGo(): void;
}

const ZOOM = 1.2;
const SEEK = 5;  // seconds

export function listenToKeys(keys: Keys): void {
  addEventListener('keydown', (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector('dialog[open]')) return;
    const target = event.target as HTMLElement;
    if (target.matches('select, textarea, input:not([type="range"])')) return;
    if (act(keys, event, target.matches('button'))) event.preventDefault();
  });
  addEventListener('keyup', (event) => { keys.steer(event.code, false); });
  addEventListener('blur', () => keys.letGo());
}

function act(keys: Keys, event: KeyboardEvent, onButton: boolean): boolean {
  if (keys.steer(event.code, true)) return true;
  switch (event.key) {
    case ' ':
      if (onButton) return false;
      keys.togglePlay();
      return true;
    case 'ArrowLeft':
    case 'ArrowRight': {
      const direction = event.key === 'ArrowLeft' ? -1 : 1;
      if (event.shiftKey) keys.seekBy(SEEK * direction);
      else keys.step(direction);
      return true;
    }
    case 'Home': keys.toStart(); return true;
    case 'End': keys.toEnd(); return true;
    case '[': keys.toReset(-1); return true;
    case ']': keys.toReset(1); return true;
    case '+':
    case '=': keys.zoom(ZOOM); return true;
    case '-': keys.zoom(1 / ZOOM); return true;
    case 'f':
    case 'F': keys.toggleFollow(); return true;
    case '?': keys.help(); return true;
    default: return false;
  }
}
