// What the page says in words: of a place on the floor, of a reset, of a frame.
import type {Graph, Polygon} from 'forewalk';
import {nodeLikelihoods} from './predictor';
import {INSTRUCTIONS, type Walk} from './walk';

const KINDS = {source: 'the user', branch: 'branch node', terminal: 'terminal node', join: 'join'} as const;
const REASONS = {horizon: 'at the horizon', 'dead-end': 'a dead end', meeting: 'where ways meet'} as const;

/** As toFixed, but nothing is less than nothing. */
export const fixed = (value: number, digits: number): string => value.toFixed(digits).replace(/^-(?=[0.]*$)/, '');

const metres = (length: number): string => `${length.toFixed(2)} m`;
const width = (portal: Polygon['portals'][number]): number =>
  Math.hypot(portal.left[0] - portal.right[0], portal.left[2] - portal.right[2]);

/** A click's answer: the polygon, its portals, and its node in the graph shown. */
export function describePolygon(id: number, polygon: Polygon, point: number[], graph: Graph | null): string {
  const portals = polygon.portals.length === 0 ? 'no portal' :
    `${polygon.portals.length} ${polygon.portals.length === 1 ? 'portal' : 'portals'}: ` +
    polygon.portals.map((portal) => `to ${portal.to} (${metres(width(portal))})`).join(', ');
  return `Polygon ${id} at ${point.map((x) => x.toFixed(2)).join(', ')}. ${portals}. ${describeNode(id, graph)}`;
}

function describeNode(polygon: number, graph: Graph | null): string {
  if (!graph) return 'There is no graph at this frame.';
  const at = graph.nodes.findIndex((node) => node.polygon === polygon);
  if (at < 0) return 'No node of the graph.';
  const node = graph.nodes[at];
  const likelihood = nodeLikelihoods(graph, new Float32Array(0))[at];
  const kind = node.reason ? `${KINDS[node.kind]}, ${REASONS[node.reason]}` : KINDS[node.kind];
  if (node.kind === 'source') return `Node ${at}: the user.`;
  return `Node ${at}: ${kind}, ${metres(node.distance)} on foot, ${Math.round(100 * likelihood)} % likely.`;
}

const PHRASES: Record<typeof INSTRUCTIONS[number], string> = {
  'none': 'walking', 'turn-around': 'stop, turn around', 'keep-turning': 'keep turning', 'walk-back': 'walk back in',
  'step-back': 'step back', 'turn-left': 'turn left', 'turn-right': 'turn right',
};

/** What the user is told at a frame. */
export function describeReset(walk: Walk, frame: number): string {
  const phrase = PHRASES[INSTRUCTIONS[walk.instruction[frame]]];
  if (walk.turning[frame] === 0) return phrase;
  return `${phrase}, ${Math.round(walk.remaining[frame] * 180 / Math.PI)}°`;
}
