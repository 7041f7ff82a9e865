// What the page has to say beside what it shows: something went wrong, something is being read.
const find = <E extends HTMLElement>(selector: string): E => document.querySelector(selector) as E;

export interface Choice {
  label: string;
  act: () => void;
}

/** One clear sentence, with what can be done; always with a button that puts it away. */
export function notice(sentence: string, choices: Choice[] = []): void {
  const box = find('#notice');
  const buttons = find('#notice .notice-actions');
  find('#notice p').textContent = sentence;
  buttons.replaceChildren(...[...choices, {label: 'Close', act: () => undefined}].map(({label, act}) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = label;
    button.addEventListener('click', () => {
      clearNotice();
      act();
    });
    return button;
  }));
  box.hidden = false;
}

export function clearNotice(): void {
  find('#notice').hidden = true;
}

/** For those who hear the page. */
export function announce(sentence: string): void {
  find('#announcer').textContent = sentence;
}

/** Shows that a file is being read; `stop` is for who does not want to wait. Returns what moves and what ends it. */
export function showProgress(name: string, stop: () => void): {move: (share: number) => void; end: () => void} {
  const box = find('#progress');
  const bar = find<HTMLProgressElement>('#progress progress');
  find('#progress label span').textContent = `Reading ${name}`;
  bar.value = 0;
  box.hidden = false;
  const button = find<HTMLButtonElement>('#progress button');
  button.onclick = stop;
  return {move: (share) => { bar.value = share; }, end: () => { box.hidden = true; }};
}
