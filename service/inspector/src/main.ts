// Puts the page together: its address, its controls, and where frames come from.
import {load} from 'forewalk';
import './style.css';
import {buildings, type Building} from './buildings';
import {Controls, DAEMON} from './controls';
import {DaemonWalk, daemonNavmesh, type Access} from './daemon_walk';
import {get} from './dom';
import {buildingOf, bundledHashes, groundOfRecording, hashOf} from './ground';
import {Inspector} from './inspector';
import {listenToKeys} from './keyboard';
import {announce, clearNotice, notice} from './notices';
import {listenToFiles, saveRecording} from './open_files';
import {PageWalk} from './page_walk';
import {recordingSource} from './source';
import {SteeredBody} from './steered_body';
import {offerVr} from './vr/offer';
import type {Walk} from './walk';

const address = new URLSearchParams(location.search);
const forewalk = await load();
const inspector = new Inspector(forewalk);
const controls = new Controls(address);
const {player} = inspector;
const access: Access = {token: address.get('token')};
const others = new Map<string, Building>();   // opened from disk, by hash
let daemon: Building | null = null;
let waiting: {name: string; walk: Walk} | null = null;   // a recording whose navmesh is missing

/** Begins a walk of what the controls say. */
function walkHere(): void {
  waiting = null;
  clearNotice();
  const {sceneId, settings} = controls;
  const building = sceneId === DAEMON ? daemon
    : buildings.find(({id}) => id === sceneId) ?? [...others.values()].find(({id}) => id === sceneId);
  if (!building) return;
  try {
    const ground = inspector.groundOf(building);
    if (sceneId !== DAEMON) {
      inspector.open(new PageWalk(ground, settings), ground);
      return;
    }
    const walk = new DaemonWalk(ground, settings, access);
    walk.onConnection = (state, message) => {
      if (state === 'open') clearNotice();
      if (message) announce(message);
      if (state === 'lost' || state === 'refused') notice(message, [{label: 'Reconnect', act: () => walk.connect()}]);
    };
    inspector.open(walk, ground);
    walk.reach(1 / 90);
  } catch (fault) {
    notice((fault as Error).message);
  }
}

function openRecording(name: string, walk: Walk): void {
  const [bundled, missing] = groundOfRecording(walk.head.scene, walk.head.navmesh);
  const building = bundled ?? others.get(walk.head.navmesh) ?? null;
  waiting = building ? null : {name, walk};
  inspector.open(recordingSource(walk, `${name}: ${walk.head.scene.replace(/^.*[\\/]/, '')}, ` +
    `${walk.head.settings.controller ?? 'no controller'}`), building && inspector.groundOf(building));
  controls.reflect(walk.head.settings, walk.room, building && building.id);
  announce(`${name}: ${walk.length} frames.`);
  if (!building && missing) notice(missing, [{label: 'Open .fwmesh…', act: () => get('file').click()}]);
  else clearNotice();
}

function openNavmesh(name: string, bytes: Uint8Array): void {
  const hash = hashOf(bytes);
  try {
    if (!bundledHashes.has(hash) && !others.has(hash)) {
      const id = name.replace(/\.fwmesh$/, '');
      const navmesh = forewalk.navmesh(bytes);
      others.set(hash, buildingOf(id, id, bytes, navmesh.polygons()));
      navmesh.release();
      controls.addBuilding(id, id);
    }
  } catch (fault) {
    notice(`${name}: ${(fault as Error).message}`);
    return;
  }
  if (!waiting) announce(`${name} is among the scenes now.`);
  else if (waiting.walk.head.navmesh === hash) openRecording(waiting.name, waiting.walk);
  else {
    notice(`${name} is the navmesh ${hash}, the recording was made in ${waiting.walk.head.navmesh}: ` +
      'build it with the settings of then.');
  }
}

/** Asks the daemon for its navmesh, and the user for the token where it needs one. */
async function findDaemon(): Promise<void> {
  for (;;) {
    try {
      const bytes = await daemonNavmesh(access);
      if (!bytes) return;
      const known = bundledHashes.get(hashOf(bytes));
      const navmesh = forewalk.navmesh(bytes);
      daemon = known ? {...known} : buildingOf('Scene', 'scene', bytes, navmesh.polygons());
      navmesh.release();
      controls.addDaemon(daemon.name);
      return;
    } catch (fault) {
      if ((fault as Error).message !== 'access') {
        notice(`The daemon's navmesh: ${(fault as Error).message}`);
        return;
      }
    }
    const dialog = get<HTMLDialogElement>('access');
    dialog.showModal();
    await new Promise((resolve) => dialog.addEventListener('close', resolve, {once: true}));
    if (dialog.returnValue !== 'use') return;
    access.token = get<HTMLInputElement>('access-token').value;
  }
}

const toEnd = (): void => inspector.seek(Infinity);
const steered = (): SteeredBody | null => {
  const source = player.source;
  const body = source instanceof PageWalk || source instanceof DaemonWalk ? source.body : null;
  return body instanceof SteeredBody ? body : null;
};
const help = (): void => get<HTMLDialogElement>('help').showModal();

player.onPlaying = (playing) => {
  get('play').setAttribute('aria-pressed', String(playing));
  get('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
};
if (inspector.building) {
  inspector.building.onFollow = (follows) => get('follow').setAttribute('aria-pressed', String(follows));
}
controls.onChange = walkHere;
listenToFiles({navmesh: openNavmesh, recording: openRecording});
listenToKeys({
  togglePlay: () => player.play(!player.playing),
  step: (frames) => inspector.step(frames),
  seekBy: (seconds) => inspector.seek(player.time + seconds),
  toStart: () => inspector.seek(0),
  toEnd,
  toReset: (direction) => inspector.toReset(direction),
  zoom: (factor) => inspector.building?.zoom(factor),
  toggleFollow: () => inspector.building?.follow(!inspector.building.following),
  help,
  steer: (code, down) => steered()?.key(code, down) ?? false,
  letGo: () => steered()?.letGo(),
});
const onClick = (id: string, act: () => void): void => get(id).addEventListener('click', act);
onClick('play', () => player.play(!player.playing));
onClick('to-start', () => inspector.seek(0));
onClick('to-end', toEnd);
onClick('step-back', () => inspector.step(-1));
onClick('step-on', () => inspector.step(1));
onClick('zoom-in', () => inspector.building?.zoom(1.25));
onClick('zoom-out', () => inspector.building?.zoom(0.8));
onClick('follow', () => inspector.building?.follow(!inspector.building.following));
onClick('show-help', help);
onClick('save', () => { if (player.source) saveRecording(player.source.walk); });
get<HTMLInputElement>('scrub').addEventListener('input', (event) =>
  inspector.seek((event.target as HTMLInputElement).valueAsNumber));
get<HTMLSelectElement>('speed').addEventListener('change', (event) => {
  player.speed = Number((event.target as HTMLSelectElement).value);
});
get<HTMLSelectElement>('span').addEventListener('change', (event) => {
  const {value} = event.target as HTMLSelectElement;
  inspector.setSpan(value === 'all' ? Infinity : Number(value));
});

offerVr(get<HTMLButtonElement>('enter-vr'), forewalk, buildings,
  () => ({building: controls.sceneId, controller: controls.settings.controller}), notice);
document.addEventListener('forewalk:vr', () => player.play(false));

// For scripts and tests: what is shown, and the means to show something else.
Object.assign(globalThis, {inspector, forewalk});

await findDaemon();
walkHere();
const play = address.get('play') ?? (matchMedia('(prefers-reduced-motion: reduce)').matches ? '0' : '1');
player.play(play === '1');
document.documentElement.dataset.ready = 'true';
