// index.d.ts is sound, and says what index.js does: compiled, not run.
import {emptyFrame, Flags, Forewalk, ForewalkError, Frame, Graph, load, Navmesh, Session} from '../../../service/wasm/index.js';

async function walk(bytes: Uint8Array): Promise<number> {
  const forewalk: Forewalk = await load();
  const navmesh: Navmesh = forewalk.navmesh(bytes);
  const room = forewalk.space({width: 6, depth: 6, bodyRadius: 0.5, userLimit: 2});
  const session: Session = navmesh.session({
    controller: 'foresight', reset: 'ahead', limits: {curvatureMax: 0.1}, horizon: 12, space: room,
    start: {floor: [7, 0, 12], heading: 0.4}, method: 'front', likelihoods: true, headingSource: 'walking',
  });
  session.setGaze([0, 0, -1]);
  session.setGaze(null);
  const mine: Frame = emptyFrame();
  const frame = session.frame([0, 1.7, 0], new Float32Array([0, 0, 0, 1]), 0.011, mine);
  if ((frame.flags & Flags.offNavmesh) !== 0) throw new ForewalkError(9, 'no floor');
  if (frame.resetPhase === 'turn') console.log(frame.resetDirection[0], frame.instruction);
  session.setLinks([{id: 1, entry: [0, 0, 0], exit: [1, 0, 0], length: 2, bothWays: true}]);
  session.setStanding([{foot: [0, 0, 0], radius: 0.5}]);
  session.teleport([1, 0, 1]);
  session.enter(navmesh);
  const graph: Graph = session.graph();
  const likely = graph.ways.reduce((sum, way) => sum + way.likelihood, graph.likelihoodNone);
  for (const node of graph.nodes) if (node.prev !== null) console.log(graph.nodes[node.prev].kind, node.reason);
  session.release();
  room.release();
  navmesh.release();
  // @ts-expect-error no such controller
  navmesh.session({controller: 's3c'});
  return likely + navmesh.polygonCount;
}

walk(new Uint8Array()).catch(console.error);
