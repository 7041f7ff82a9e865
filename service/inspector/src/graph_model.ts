// The prediction graph in the building: ways as bands as wide as they are likely, branch nodes red, terminals green,
// dead ends hollow, meetings violet. Redrawn every frame into buffers that are kept.
import {
  CircleGeometry, Color, DynamicDrawUsage, Group, InstancedMesh, Matrix4, MeshBasicMaterial, type BufferGeometry,
} from 'three';
import type {Graph, GraphNode} from 'forewalk';
import {nodeLikelihoods} from './predictor';
import {Ribbons} from './ribbons';
import type {Theme} from './theme';

// Of bands nobody takes and everybody takes, and of loops, metres.
const NARROWEST = 0.05;
const WIDEST = 0.55;
const LOOP = 0.035;
// Of discs, metres.
const NODE = 0.19;
const HALO = 1.32;
const LIFT = 0.07;

export class GraphModel extends Group {
  private readonly ways = new Ribbons(0.05, 0.3, 4);
  private halos!: InstancedMesh;
  private discs!: InstancedMesh;
  private readonly circle: BufferGeometry = new CircleGeometry(1, 24).rotateX(-Math.PI / 2);
  private likelihoods: Float32Array = new Float32Array(256);
  private readonly placed = new Matrix4();
  private readonly colors = {
    way: new Color(), branch: new Color(), terminal: new Color(), deadEnd: new Color(), join: new Color(),
    source: new Color(), background: new Color(),
  };

  constructor(theme: Theme) {
    super();
    this.add(this.ways);
    this.reserve(128);
    this.setTheme(theme);
  }

  setTheme(theme: Theme): void {
    for (const name of ['way', 'branch', 'terminal', 'deadEnd', 'join', 'background'] as const) {
      this.colors[name].set(theme[name]);
    }
    this.colors.source.set(theme.user);
  }

  /** Shows a graph; null: nothing. */
  show(graph: Graph | null): void {
    this.ways.clearBands();
    const count = graph?.nodes.length ?? 0;
    if (graph) this.fill(graph);
    this.ways.finish();
    for (const mesh of [this.discs, this.halos]) {
      mesh.count = count;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  }

  private fill(graph: Graph): void {
    const {ways, colors} = this;
    if (graph.nodes.length > this.discs.instanceMatrix.count) this.reserve(2 * graph.nodes.length);
    this.likelihoods = nodeLikelihoods(graph, this.likelihoods);
    for (const edge of graph.edges) {
      const likelihood = edge.loop ? 0 : this.likelihoods[edge.from];
      const width = edge.loop ? LOOP : NARROWEST + (WIDEST - NARROWEST) * likelihood;
      ways.begin(width, edge.loop ? colors.join : colors.way, edge.loop ? 0.45 : 0.55 + 0.4 * Math.sqrt(likelihood));
      for (const point of edge.path) ways.point(point[0], point[1], point[2]);
      ways.end();
    }
    graph.nodes.forEach((node, i) => {
      const size = NODE * (node.kind === 'source' ? 0.7 : 0.75 + 0.5 * Math.sqrt(this.likelihoods[i]));
      const color = this.colorOf(node);
      const hollow = node.kind === 'terminal' && node.reason === 'dead-end';
      this.put(this.halos, i, node.position, HALO * size, 0, hollow ? color : colors.background);
      this.put(this.discs, i, node.position, size, 0.005, hollow ? colors.background : color);
    });
  }

  private colorOf(node: GraphNode): Color {
    const {colors} = this;
    if (node.kind === 'source') return colors.source;
    if (node.kind === 'branch') return colors.branch;
    if (node.kind === 'join' || node.reason === 'meeting') return colors.join;
    return node.reason === 'dead-end' ? colors.deadEnd : colors.terminal;
  }

  private put(mesh: InstancedMesh, i: number, position: number[], size: number, lift: number, color: Color): void {
    this.placed.makeScale(size, 1, size).setPosition(position[0], position[1] + LIFT + lift, position[2]);
    mesh.setMatrixAt(i, this.placed);
    mesh.setColorAt(i, color);
  }

  private reserve(nodes: number): void {
    const make = (order: number): InstancedMesh => {
      const material = new MeshBasicMaterial({transparent: true, depthWrite: false});
      const mesh = new InstancedMesh(this.circle, material, nodes);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.renderOrder = order;
      mesh.count = 0;
      return mesh;
    };
    if (this.discs) {
      this.remove(this.discs, this.halos);
      this.discs.dispose();
      this.halos.dispose();
    }
    this.halos = make(5);
    this.discs = make(6);
    this.add(this.halos, this.discs);
  }
}
