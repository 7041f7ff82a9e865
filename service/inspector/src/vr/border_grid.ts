// The room's border as a soft grid, seen through the virtual walls, where the body is close.
import {BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, ShaderMaterial, Vector3} from 'three';
import type {Point2} from 'forewalk';
import type {Room} from '../room';

const HEIGHT = 2.2;  // metres
const CELL = 0.25;   // metres between lines
const REACH = 1.1;   // metres from the body within which it is seen
const EASE = 0.2;    // seconds to appear

const vertexShader = `
  varying vec3 place;
  varying vec2 along;
  void main() {
    place = position;
    along = uv;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const fragmentShader = `
  uniform vec3 head;
  uniform vec3 color;
  uniform float strength;
  varying vec3 place;
  varying vec2 along;
  void main() {
    vec2 cells = along / ${CELL.toFixed(2)};
    vec2 width = fwidth(cells);
    vec2 line = smoothstep(width * 2.0, width * 0.6, abs(fract(cells - 0.5) - 0.5));
    float far = distance(place.xz, head.xz);
    float near = smoothstep(${REACH.toFixed(2)}, 0.25, far);
    float foot = smoothstep(0.0, 0.1, place.y);
    float top = smoothstep(${HEIGHT.toFixed(2)}, ${(HEIGHT - 0.7).toFixed(2)}, place.y);
    float alpha = (0.10 + 0.75 * max(line.x, line.y)) * near * (0.35 + 0.65 * foot * top) * strength;
    if (alpha < 0.004) discard;
    gl_FragColor = vec4(color, alpha);
    #include <colorspace_fragment>
  }`;

/** A wall of lines over every edge of the room. Belongs under the rig: it stands still in the room. One draw call. */
export class BorderGrid extends Mesh<BufferGeometry, ShaderMaterial> {
  constructor(room: Room) {
    super(walls(room), new ShaderMaterial({
      vertexShader, fragmentShader, transparent: true, depthTest: false, depthWrite: false, side: DoubleSide,
      uniforms: {head: {value: new Vector3()}, color: {value: new Color('#ffb35c')}, strength: {value: 0}},
    }));
    this.name = 'border grid';
    this.renderOrder = 900;
    this.frustumCulled = false;
    this.visible = false;
  }

  /** Shows it or not, with the head here, [x, y, z] of the room, `seconds` after the frame before. */
  update(shown: boolean, head: Vector3, seconds: number): void {
    const {head: place, strength} = this.material.uniforms;
    place.value.copy(head);
    const step = seconds / EASE;
    strength.value = Math.min(1, Math.max(0, strength.value + (shown ? step : -step)));
    this.visible = strength.value > 0;
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }
}

function walls({border, holes}: Room): BufferGeometry {
  const positions: number[] = [], uvs: number[] = [];
  const wall = ([ax, az]: Point2, [bx, bz]: Point2, from: number) => {
    const to = from + Math.hypot(bx - ax, bz - az);
    positions.push(ax, 0, az, bx, 0, bz, bx, HEIGHT, bz, ax, 0, az, bx, HEIGHT, bz, ax, HEIGHT, az);
    uvs.push(from, 0, to, 0, to, HEIGHT, from, 0, to, HEIGHT, from, HEIGHT);
    return to;
  };
  for (const ring of [border, ...holes]) {
    ring.reduce((from, corner, i) => wall(corner, ring[(i + 1) % ring.length], from), 0);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute('uv', new BufferAttribute(new Float32Array(uvs), 2));
  return geometry;
}
