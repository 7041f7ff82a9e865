// Flat bands on the floor: lines that have a width, which WebGL's own have not.
//
// All bands are one mesh whose buffers are kept and grown by doubling: filling it makes nothing.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, GreaterDepth, Group, Mesh, MeshBasicMaterial,
} from 'three';

// Sharper corners are cut off at this multiple of the width.
const LONGEST_MITRE = 2;

export class Ribbons extends Group {
  private positions = new Float32Array(0);
  private colors = new Float32Array(0);
  private indices = new Uint32Array(0);
  private readonly geometry = new BufferGeometry();
  private readonly material = new MeshBasicMaterial({
    vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide,
  });
  private readonly behind: MeshBasicMaterial;
  private vertices = 0;
  private used = 0;
  private first = 0;       // of the band under way
  private halfWidth = 0;
  private readonly color = new Color();
  private alpha = 1;

  /** `lift`: metres above the floor. `through`: how much is seen of what lies behind walls, 0 to 1. */
  constructor(private readonly lift: number, through: number, order: number) {
    super();
    this.behind = this.material.clone();
    this.behind.depthFunc = GreaterDepth;
    this.behind.opacity = through;
    for (const material of [this.material, this.behind]) {
      const mesh = new Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = order;
      this.add(mesh);
    }
    this.reserve(1024);
  }

  /** Begins to fill anew. */
  clearBands(): void {
    this.vertices = 0;
    this.used = 0;
  }

  /** Begins a band; `width` in metres. Its points follow. */
  begin(width: number, color: Color, alpha: number): void {
    this.first = this.vertices;
    this.halfWidth = width / 2;
    this.color.copy(color);
    this.alpha = alpha;
  }

  /** The band's next point, on the floor. `alpha` in the place of the band's. */
  point(x: number, y: number, z: number, alpha = this.alpha): void {
    if (this.vertices + 2 > this.positions.length / 3) this.reserve(this.positions.length / 3 * 2);
    const at = 3 * this.vertices;
    // Both of its vertices lie in the middle until the band ends and its corners are known.
    for (const from of [at, at + 3]) {
      this.positions[from] = x;
      this.positions[from + 1] = y + this.lift;
      this.positions[from + 2] = z;
    }
    for (let i = 0; i < 2; ++i) {
      const color = 4 * (this.vertices + i);
      this.colors[color] = this.color.r;
      this.colors[color + 1] = this.color.g;
      this.colors[color + 2] = this.color.b;
      this.colors[color + 3] = alpha;
    }
    this.vertices += 2;
  }

  /** Ends the band, which may have any number of points. */
  end(): void {
    const points = (this.vertices - this.first) / 2;
    if (points < 2) {
      this.vertices = this.first;
      return;
    }
    const {positions: p} = this;
    // Directions before and after each point, on the plan; from the middle points, so in walking order.
    let beforeX = 0, beforeZ = 0;
    for (let i = 0; i < points; ++i) {
      const at = 3 * (this.first + 2 * i);
      let afterX = beforeX, afterZ = beforeZ;
      if (i + 1 < points) {
        const dx = p[at + 6] - p[at], dz = p[at + 8] - p[at + 2];
        const length = Math.hypot(dx, dz);
        if (length > 1e-6) {
          afterX = dx / length;
          afterZ = dz / length;
        }
      }
      if (i === 0) {
        beforeX = afterX;
        beforeZ = afterZ;
      }
      const sumX = beforeX + afterX, sumZ = beforeZ + afterZ;
      const sum = Math.hypot(sumX, sumZ);
      let normalX = afterZ, normalZ = -afterX, scale = 1;
      if (sum > 1e-3) {
        normalX = sumZ / sum;
        normalZ = -sumX / sum;
        scale = Math.min(LONGEST_MITRE, 2 / sum);
      }
      const x = this.halfWidth * scale * normalX, z = this.halfWidth * scale * normalZ;
      p[at] += x;
      p[at + 2] += z;
      p[at + 3] -= x;
      p[at + 5] -= z;
      beforeX = afterX;
      beforeZ = afterZ;
      if (i + 1 < points) {
        const v = this.first + 2 * i;
        const index = this.indices;
        index[this.used++] = v;
        index[this.used++] = v + 1;
        index[this.used++] = v + 2;
        index[this.used++] = v + 1;
        index[this.used++] = v + 3;
        index[this.used++] = v + 2;
      }
    }
  }

  /** Hands what was filled in to the graphics card. */
  finish(): void {
    const {geometry} = this;
    const upload = (attribute: BufferAttribute, count: number): void => {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, count);
      attribute.needsUpdate = true;
    };
    upload(geometry.getAttribute('position') as BufferAttribute, 3 * this.vertices);
    upload(geometry.getAttribute('color') as BufferAttribute, 4 * this.vertices);
    upload(geometry.index!, this.used);
    geometry.setDrawRange(0, this.used);
  }

  private reserve(vertices: number): void {
    const grown = <A extends Float32Array | Uint32Array>(old: A, made: A): A => {
      made.set(old as never);
      return made;
    };
    this.positions = grown(this.positions, new Float32Array(3 * vertices));
    this.colors = grown(this.colors, new Float32Array(4 * vertices));
    this.indices = grown(this.indices, new Uint32Array(3 * vertices));
    this.geometry.dispose();
    const attribute = (array: Float32Array, size: number): BufferAttribute =>
      new BufferAttribute(array, size).setUsage(DynamicDrawUsage) as BufferAttribute;
    this.geometry.setAttribute('position', attribute(this.positions, 3));
    this.geometry.setAttribute('color', attribute(this.colors, 4));
    this.geometry.setIndex(new BufferAttribute(this.indices, 1).setUsage(DynamicDrawUsage) as BufferAttribute);
  }
}
