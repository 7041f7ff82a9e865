// Black before the eyes while there is nothing to be seen that would be true.
import {BackSide, Mesh, MeshBasicMaterial, SphereGeometry, type Vector3} from 'three';

const EASE = 0.25;  // seconds

/** A sphere around the head. Belongs under the rig. */
export class Fade extends Mesh<SphereGeometry, MeshBasicMaterial> {
  constructor() {
    super(new SphereGeometry(0.4, 12, 8), new MeshBasicMaterial({
      color: '#000000', opacity: 1, transparent: true, side: BackSide, depthTest: false, depthWrite: false, fog: false,
    }));
    this.name = 'fade';
    this.renderOrder = 2000;
    this.frustumCulled = false;
  }

  /** Eases to black or away from it. At once with `seconds` infinite. */
  update(dark: boolean, head: Vector3, seconds: number): void {
    this.position.copy(head);
    const step = seconds / EASE;
    this.material.opacity = Math.min(1, Math.max(0, this.material.opacity + (dark ? step : -step)));
    this.visible = this.material.opacity > 0;
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }
}
