// Controllers and hands, as plain shapes that follow the rig.
import {
  CylinderGeometry, Group, InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, SphereGeometry, type Object3D,
  type WebGLRenderer,
} from 'three';

const JOINTS = 25;  // of a hand

interface Hand {
  visible: boolean;
  /** By the names of WebXR; in the room. */
  joints: Record<string, Object3D | undefined>;
}

/** Both sides. Belongs under the rig; one draw call a controller, one for both hands. */
export class Inputs extends Group {
  private readonly joints = new InstancedMesh(
    new SphereGeometry(0.008, 8, 6), new MeshLambertMaterial({color: '#d9b79a'}), 2 * JOINTS);
  private readonly hands: Hand[] = [];
  private readonly place = new Matrix4();

  constructor(renderer: WebGLRenderer) {
    super();
    this.name = 'inputs';
    const shape = new CylinderGeometry(0.014, 0.02, 0.12, 12).rotateX(-Math.PI / 2).translate(0, 0, 0.03);
    const material = new MeshLambertMaterial({color: '#3a3f48'});
    for (const i of [0, 1]) {
      const grip = renderer.xr.getControllerGrip(i);
      grip.clear();
      const body = new Mesh(shape, material);
      body.visible = false;
      grip.addEventListener('connected', ({data}) => body.visible = !data.hand);
      grip.addEventListener('disconnected', () => body.visible = false);
      const hand = renderer.xr.getHand(i);
      this.hands.push(hand as unknown as Hand);
      this.add(grip.add(body), hand);
    }
    this.joints.frustumCulled = false;
    this.joints.count = 0;
    this.add(this.joints);
  }

  /** Once a frame: puts the hands' joints where they are tracked. */
  update(): void {
    let count = 0;
    for (const {joints, visible} of this.hands) {
      if (!visible) continue;
      for (const name in joints) {
        const joint = joints[name];
        if (joint?.visible && count < 2 * JOINTS) this.joints.setMatrixAt(count++, this.place.copy(joint.matrix));
      }
    }
    this.joints.count = count;
    this.joints.visible = count > 0;
    if (count > 0) this.joints.instanceMatrix.needsUpdate = true;
  }
}
