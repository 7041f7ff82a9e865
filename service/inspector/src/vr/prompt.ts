// What to ask of somebody during a reset, in words and in the world: a card before the eyes, and a marker that stands
// still in the room where they will face. service/capi/guide/resets.md says what is drawn when.
import {
  CanvasTexture, CircleGeometry, Group, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, RingGeometry,
  SRGBColorSpace, type Quaternion, type Vector3,
} from 'three';
import type {Frame} from 'forewalk';

/** A prompt: what it says, and what its ring shows. */
export interface Prompt {
  text: string;
  /** Beneath it: how much is left. */
  detail: string;
  /** The way to turn: +1 left, -1 right, 0 either or none. */
  side: number;
  /** Radians left to turn; null: no ring, somebody walks. */
  angle: number | null;
}

/** What to show somebody who sees `frame`; null: nothing. */
export function promptOf(frame: Frame): Prompt | null {
  const {resetPhase: phase, instruction, resetRemaining, resetTurned, resetBack} = frame;
  if (phase === 'outside') return {text: 'Walk back into your room', detail: 'toward the light', side: 0, angle: null};
  if (phase === 'backward') {
    return {text: 'Please step back', detail: `${Math.max(0.1, resetBack).toFixed(1)} m`, side: 0, angle: null};
  }
  if (phase !== 'turn' && phase !== 'turning') return null;
  const side = instruction === 'turn-left' ? 1 : instruction === 'turn-right' ? -1 :
    instruction === 'keep-turning' ? Math.sign(resetTurned) : 0;
  const way = side > 0 ? 'left' : side < 0 ? 'right' : 'around';
  // Ever five degrees, so that the card is drawn now and then rather than in every frame.
  const degrees = Math.ceil(resetRemaining * 36 / Math.PI) * 5;
  return {
    text: phase === 'turn' ? `Please turn ${way}` : `Keep turning ${way}`, detail: `${degrees}\u00b0`, side,
    angle: resetRemaining,
  };
}

const AWAY = 1.25;           // metres from the eyes to the card
const BELOW = 0.1;           // of its middle beneath the eyes, metres
const WIDTH = 0.72;          // of the card, metres: 33 degrees
const HEIGHT = 0.54;
const PIXELS = 1024;         // across the card
const RING = 0.145;          // radius, metres
const RING_UP = 0.07;        // its middle above the card's
const SEGMENTS = 120;        // of a whole turn
const LAG = 0.07;            // seconds behind the head, so that it seems to float
const MARKER_AWAY = 1.6;     // metres from the head to the marker
const INK = '#ffffff';
const ACCENT = '#ffb35c';

const flat = (color: string, opacity = 1) => new MeshBasicMaterial({
  color, opacity, transparent: true, depthTest: false, depthWrite: false, fog: false, toneMapped: false,
});

/** The card and the marker. Belongs under the rig; a few draw calls while shown, none otherwise. */
export class ResetPrompt extends Group {
  private readonly card = new Group();
  private readonly marker: Mesh;
  private readonly arc: Mesh<RingGeometry, MeshBasicMaterial>;
  private readonly track: Mesh;
  private readonly arrow: Mesh;
  private readonly canvas: HTMLCanvasElement;
  private readonly texture: CanvasTexture;
  private shownText = '';
  private yaw: number | null = null;

  constructor() {
    super();
    this.name = 'prompt';
    this.visible = false;
    this.canvas = document.createElement('canvas');
    this.canvas.width = PIXELS;
    this.canvas.height = PIXELS * HEIGHT / WIDTH;
    this.texture = new CanvasTexture(this.canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.minFilter = LinearFilter;
    this.texture.generateMipmaps = false;
    const face = flat(INK);
    face.map = this.texture;
    const ring = (from: number, to: number, color: string, opacity: number) =>
      new Mesh(new RingGeometry(from, to, SEGMENTS, 1, Math.PI / 2, 2 * Math.PI), flat(color, opacity));
    this.track = ring(RING - 0.012, RING + 0.012, INK, 0.22);
    this.arc = ring(RING - 0.016, RING + 0.016, ACCENT, 1);
    this.arrow = new Mesh(new CircleGeometry(0.042, 3), flat(ACCENT));
    const plate = new Mesh(new PlaneGeometry(WIDTH, HEIGHT), face);
    this.card.add(plate, this.track, this.arc, this.arrow);
    [plate, this.track, this.arc, this.arrow].forEach((part, i) => {
      part.renderOrder = 1000 + i;
      part.frustumCulled = false;
      if (i > 0) part.position.set(0, RING_UP, 0.002 * i);
    });
    this.marker = ring(0.1, 0.13, ACCENT, 0.9);
    const dot = new Mesh(new CircleGeometry(0.035, 32), this.marker.material);
    this.marker.add(dot);
    for (const part of [this.marker, dot]) part.renderOrder = 950;
    this.add(this.card, this.marker);
  }

  /** Whether somebody is asked for anything. */
  get shown(): boolean {
    return this.visible;
  }

  /** What the card says; empty while it is hidden. */
  get text(): string {
    return this.visible ? this.shownText.split('\n')[0] : '';
  }

  /**
   * Shows `prompt` to a head of the room, `seconds` after the frame before; null hides it. `direction`: where the user
   * will face, of the room; zero without one.
   */
  update(prompt: Prompt | null, head: Vector3, gaze: Quaternion, direction: ArrayLike<number>, seconds: number): void {
    this.visible = prompt !== null;
    if (!prompt) {
      this.yaw = null;
      return;
    }
    this.draw(prompt);
    this.place(head, gaze, seconds);
    this.turnRing(prompt);
    this.marker.visible = direction[0] !== 0 || direction[2] !== 0;
    this.marker.position.set(
      head.x + MARKER_AWAY * direction[0], head.y - BELOW, head.z + MARKER_AWAY * direction[2]);
    this.marker.rotation.y = Math.atan2(-direction[0], -direction[2]);
  }

  dispose(): void {
    this.texture.dispose();
    this.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      part.geometry.dispose();
      part.material.dispose();
    });
  }

  // Upright before the head, turning after it with a little delay.
  private place(head: Vector3, gaze: Quaternion, seconds: number): void {
    const {x, y, z, w} = gaze;
    const heading = Math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y));
    if (this.yaw === null) this.yaw = heading;
    const off = Math.atan2(Math.sin(heading - this.yaw), Math.cos(heading - this.yaw));
    this.yaw += off * (1 - Math.exp(-seconds / LAG));
    this.card.position.set(head.x - AWAY * Math.sin(this.yaw), head.y - BELOW, head.z - AWAY * Math.cos(this.yaw));
    this.card.rotation.set(0, this.yaw, 0);
  }

  // What is left to turn, from the top to the side that is turned to, an arrowhead at its end.
  private turnRing({side, angle}: Prompt): void {
    const {arc, arrow, track} = this;
    const turning = angle !== null;
    arc.visible = arrow.visible = track.visible = turning;
    if (!turning) return;
    const left = side >= 0;
    const share = Math.min(1, angle / (2 * Math.PI));
    const segments = Math.max(1, Math.round(share * SEGMENTS));
    const first = left ? 0 : SEGMENTS - segments;
    arc.geometry.setDrawRange(6 * first, 6 * segments);
    const end = Math.PI / 2 + (left ? 1 : -1) * 2 * Math.PI * share;
    arrow.position.set(RING * Math.cos(end), RING_UP + RING * Math.sin(end), 0.006);
    arrow.rotation.z = end + (left ? Math.PI / 2 : -Math.PI / 2);
  }

  private draw({text, detail, angle}: Prompt): void {
    const said = `${text}\n${detail}`;
    if (said === this.shownText) return;
    this.shownText = said;
    const {canvas} = this;
    const context = canvas.getContext('2d')!;
    const {width, height} = canvas;
    context.clearRect(0, 0, width, height);
    context.fillStyle = 'rgba(18, 22, 30, 0.82)';
    context.beginPath();
    context.roundRect(8, 8, width - 16, height - 16, 56);
    context.fill();
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillStyle = INK;
    const metre = PIXELS / WIDTH;
    if (angle !== null) {
      context.font = '600 118px system-ui, sans-serif';
      context.fillText(detail, width / 2 + 14, height / 2 - RING_UP * metre);
      context.font = '600 86px system-ui, sans-serif';
      context.fillText(text, width / 2, height - 98, width - 80);
    } else {
      context.font = '600 104px system-ui, sans-serif';
      context.fillText(text, width / 2, height * 0.42, width - 80);
      context.fillStyle = ACCENT;
      context.font = '600 84px system-ui, sans-serif';
      context.fillText(detail, width / 2, height * 0.68);
    }
    this.texture.needsUpdate = true;
  }
}
