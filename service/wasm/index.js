// forewalk's C interface for JavaScript. index.d.ts says what everything means; service/capi/forewalk.h is
// the contract underneath.
import forewalkCore from './forewalk_core.js';

const AXES = {openxr: 0, unity: 1, unreal: 2};
const CONTROLLERS = ['none', 's2c', 's2o', 's2c-predictive', 's2o-predictive', 's2mt', 's2mt+c', 'zigzag',
  'p2r', 'messinger', 'dynamic-apf', 'haptics', 'arc', 'visibility', 'foresight', 'mpcred', 'force'];
const RESETS = ['two-one-turn', 'freeze-turn', 'freeze-backup', 'r2c', 'mr2c', 'r2g', 'sfr2g', 'r2fd', 'ahead'];
const LIMITS = ['steinicke', 'laboratory', 'neth', 'toolkit'];
const CUSTOM_LIMITS = 4;
const METHODS = ['polygon', 'front'];
const HEADINGS = ['head', 'chest', 'walking'];
const INSTRUCTIONS = ['none', 'turn-around', 'keep-turning', 'walk-back', 'step-back', 'turn-left', 'turn-right'];
const PHASES = ['none', 'near', 'outside', 'backward', 'turn', 'turning'];
const KINDS = ['source', 'branch', 'terminal', 'join'];
const REASONS = [null, 'horizon', 'dead-end', 'meeting'];
const NONE = 0xffffffff;

/** Bits of Frame.flags. */
export const Flags = Object.freeze({
  firstFrame: 1, timeStoodStill: 2, timeRanBackwards: 4, timeGap: 8, trackingJump: 16, poseNotFinite: 32,
  orientationNotUnit: 64, orientationUnusable: 128, outsideSpace: 256, borderNear: 512, offNavmesh: 1024,
  snapped: 2048, graphLimit: 4096, groundTaken: 8192,
});

/** What the library refused, in its own words. `status` is forewalk_status. */
export class ForewalkError extends Error {
  constructor(status, message) {
    super(message);
    this.name = 'ForewalkError';
    this.status = status;
  }
}

const indexOf = (list, name, what) => {
  const index = list.indexOf(name);
  if (index < 0) throw new ForewalkError(100, `${what} "${name}" is not known: give one of ${list.join(', ')}.`);
  return index;
};

// Memory of the module for the length of one call.
class Scratch {
  constructor(core) {
    this.core = core;
    this.taken = [];
  }
  take(bytes) {
    const at = this.core._malloc(Math.max(bytes, 1));
    if (at === 0) throw new ForewalkError(101, `out of memory: ${bytes} bytes.`);
    this.taken.push(at);
    return at;
  }
  floats(values) {
    const at = this.take(4 * values.length);
    this.core.HEAPF32.set(values, at >> 2);
    return at;
  }
  free() {
    for (const at of this.taken) this.core._free(at);
  }
}

class Library {
  constructor(core) {
    this.core = core;
    this.layout = JSON.parse(core.UTF8ToString(core._forewalk_wasm_layout()));
    this.structs = {};  // the same by struct and field
    for (const [name, offset] of Object.entries(this.layout)) {
      const [struct, field] = name.split('.');
      (this.structs[struct] ??= {})[field] = offset;
    }
    const version = core._forewalk_version();
    this.version = `${version >>> 16}.${(version >>> 8) & 255}.${version & 255}`;
    this.pointer = core._malloc(8);
    // Structs that are handed over by value go as addresses.
    this.position = core._malloc(12);
    this.orientation = core._malloc(16);
    this.out = core._malloc(this.layout['frame_out.size']);
    this.view = core._malloc(this.layout['graph_view.size']);
    core.HEAPU32[this.out >> 2] = this.layout['frame_out.size'];
    core.HEAPU32[this.view >> 2] = this.layout['graph_view.size'];
  }

  check(status) {
    if (status !== 0) {
      throw new ForewalkError(status, this.core.UTF8ToString(this.core._forewalk_last_error()));
    }
  }

  with(body) {
    const scratch = new Scratch(this.core);
    try {
      return body(scratch);
    } finally {
      scratch.free();
    }
  }

  // Fills the struct at `at`; `put` writes fields by their C names.
  writer(struct, at) {
    const {core, layout} = this;
    const place = (name) => {
      const offset = layout[`${struct}.${name}`];
      if (offset === undefined) throw new ForewalkError(102, `${struct} has no ${name}.`);
      return at + offset;
    };
    return {
      int: (name, value) => { core.HEAP32[place(name) >> 2] = value; },
      uint: (name, value) => { core.HEAPU32[place(name) >> 2] = value; },
      float: (name, value) => { core.HEAPF32[place(name) >> 2] = value; },
      floats: (name, values) => { core.HEAPF32.set(values, place(name) >> 2); },
    };
  }

  // A tracked space in `put`, which is that of a session's or a space's settings.
  putRoom(put, room, scratch) {
    if (room.width !== undefined) put.float('width', room.width);
    if (room.depth !== undefined) put.float('depth', room.depth);
    if (room.border) {
      put.uint('border', scratch.floats(room.border.flat()));
      put.uint('border_count', room.border.length);
    }
    if (room.holes && room.holes.length > 0) {
      const sizes = scratch.take(4 * room.holes.length);
      this.core.HEAPU32.set(room.holes.map((hole) => hole.length), sizes >> 2);
      put.uint('hole_points', scratch.floats(room.holes.flat(2)));
      put.uint('hole_sizes', sizes);
      put.uint('hole_count', room.holes.length);
    }
  }

  navmesh(bytes) {
    return this.with((scratch) => {
      const at = scratch.take(bytes.length);
      this.core.HEAPU8.set(bytes, at);
      this.check(this.core._forewalk_navmesh_from_fwmesh(at, bytes.length, this.pointer));
      return new Navmesh(this, this.core.HEAPU32[this.pointer >> 2]);
    });
  }

  space(settings = {}) {
    return this.with((scratch) => {
      const size = this.layout['space_settings.size'];
      const at = scratch.take(size);
      this.core._forewalk_space_settings_init(at, size);
      const put = this.writer('space_settings', at);
      if (settings.axes) put.int('axes', indexOf(Object.keys(AXES), settings.axes, 'axes'));
      this.putRoom(put, settings, scratch);
      if (settings.bodyRadius !== undefined) put.float('body_radius', settings.bodyRadius);
      if (settings.userLimit !== undefined) put.uint('user_limit', settings.userLimit);
      this.check(this.core._forewalk_space_create(at, this.pointer));
      return new Space(this, this.core.HEAPU32[this.pointer >> 2]);
    });
  }
}

class Handle {
  constructor(library, at, end) {
    this.library = library;
    this.at = at;
    this.end = end;
  }
  get handle() {
    if (this.at === 0) throw new ForewalkError(100, 'used after it was released.');
    return this.at;
  }
  release() {
    if (this.at !== 0) this.end(this.at);
    this.at = 0;
  }
}

class Navmesh extends Handle {
  constructor(library, at) {
    super(library, at, library.core._forewalk_navmesh_release);
  }
  get polygonCount() {
    return this.library.core._forewalk_navmesh_polygon_count(this.handle);
  }
  polygons(axes = 'openxr') {
    const {library} = this;
    const {core, layout} = library;
    return library.with((scratch) => {
      const size = layout['navmesh_view.size'];
      const view = scratch.take(size);
      core.HEAPU32[view >> 2] = size;
      library.check(core._forewalk_navmesh_polygons(
        this.handle, indexOf(Object.keys(AXES), axes, 'axes'), view));
      const {HEAPF32: f, HEAPU32: u} = core;
      const field = (name) => u[(view + layout[`navmesh_view.${name}`]) >> 2];
      const vector = (at) => [f[at >> 2], f[(at >> 2) + 1], f[(at >> 2) + 2]];
      const rows = (start, list, bytes, polygon, make) => {
        const first = u[(field(start) >> 2) + polygon];
        const end = u[(field(start) >> 2) + polygon + 1];
        return Array.from({length: end - first}, (_, i) => make(field(list) + (first + i) * bytes));
      };
      const portal = (at) => ({
        to: u[(at + layout['portal.to']) >> 2],
        edge: u[(at + layout['portal.edge']) >> 2],
        left: vector(at + layout['portal.left']),
        right: vector(at + layout['portal.right']),
      });
      const triangle = (at) => [vector(at), vector(at + 12), vector(at + 24)];
      return Array.from({length: field('polygon_count')}, (_, polygon) => ({
        corners: rows('corner_start', 'corners', 12, polygon, vector),
        portals: rows('portal_start', 'portals', layout['portal.size'], polygon, portal),
        triangles: rows('triangle_start', 'triangles', 36, polygon, triangle),
      }));
    });
  }
  session(settings = {}) {
    const {library} = this;
    const {core} = library;
    return library.with((scratch) => {
      const size = library.layout['session_settings.size'];
      const at = scratch.take(size);
      core._forewalk_session_settings_init(at, size);
      const put = library.writer('session_settings', at);
      if (settings.axes) put.int('axes', indexOf(Object.keys(AXES), settings.axes, 'axes'));
      if (settings.controller) put.int('controller', indexOf(CONTROLLERS, settings.controller, 'controller'));
      if (settings.reset) put.int('reset', indexOf(RESETS, settings.reset, 'reset'));
      if (typeof settings.limits === 'string') {
        put.int('limits', indexOf(LIMITS, settings.limits, 'limits'));
      } else if (settings.limits) {
        put.int('limits', CUSTOM_LIMITS);
        for (const [name, field] of [['translationMin', 'translation_min'], ['translationMax', 'translation_max'],
          ['rotationMin', 'rotation_min'], ['rotationMax', 'rotation_max'], ['curvatureMax', 'curvature_max'],
          ['bendingMin', 'bending_min'], ['bendingMax', 'bending_max']]) {
          if (settings.limits[name] !== undefined) put.float(field, settings.limits[name]);
        }
      }
      if (settings.horizon !== undefined) put.float('horizon', settings.horizon);
      if (settings.space) put.uint('space', settings.space.handle);
      library.putRoom(put, settings, scratch);
      if (settings.start) {
        put.int('has_start', 1);
        put.floats('start_floor', settings.start.floor);
        put.float('start_heading', settings.start.heading ?? 0);
      }
      if (settings.polygonLimit !== undefined) put.uint('polygon_limit', settings.polygonLimit);
      if (settings.resets !== undefined) put.int('resets', settings.resets ? 1 : 0);
      if (settings.alwaysPredict !== undefined) put.int('always_predict', settings.alwaysPredict ? 1 : 0);
      if (settings.method) put.int('method', indexOf(METHODS, settings.method, 'method'));
      if (settings.persistence !== undefined) put.float('persistence', settings.persistence);
      if (settings.likelihoods !== undefined) put.int('likelihoods', settings.likelihoods ? 1 : 0);
      if (settings.headingSource) {
        put.int('heading_source', indexOf(HEADINGS, settings.headingSource, 'headingSource'));
      }
      library.check(core._forewalk_session_create(this.handle, at, library.pointer));
      return new Session(library, core.HEAPU32[library.pointer >> 2]);
    });
  }
}

class Space extends Handle {
  constructor(library, at) {
    super(library, at, library.core._forewalk_space_release);
  }
}

/** A frame's answer to be filled again and again. */
export const emptyFrame = () => ({
  flags: 0, position: new Float32Array(3), orientation: new Float32Array(4), translation: 1, rotation: 1,
  curvature: 0, bending: 1, injectedYaw: 0, injectedTranslation: new Float32Array(3), resetting: false,
  instruction: 'none', resetRemaining: 0, resetTurned: 0, resetCount: 0, graphNodes: 0, resetPhase: 'none',
  resetBack: 0, resetDirection: new Float32Array(3),
});

class Session extends Handle {
  constructor(library, at) {
    super(library, at, library.core._forewalk_session_destroy);
    this.last = emptyFrame();
    this.at_ = {};
    for (const [name, offset] of Object.entries(library.layout)) {
      if (name.startsWith('frame_out.')) this.at_[name.slice('frame_out.'.length)] = (library.out + offset) >> 2;
    }
  }

  frame(position, orientation, seconds, frame = this.last) {
    const {library, at_} = this;
    const {core} = library;
    const p = library.position >> 2;
    const q = library.orientation >> 2;
    let f = core.HEAPF32;
    f[p] = position[0];
    f[p + 1] = position[1];
    f[p + 2] = position[2];
    f[q] = orientation[0];
    f[q + 1] = orientation[1];
    f[q + 2] = orientation[2];
    f[q + 3] = orientation[3];
    library.check(core._forewalk_frame(this.handle, library.position, library.orientation, seconds, library.out));
    f = core.HEAPF32;  // memory may have grown
    const u = core.HEAPU32;
    frame.flags = u[at_.flags];
    const pose = at_.virtual_pose;
    for (let i = 0; i < 3; ++i) frame.position[i] = f[pose + i];
    for (let i = 0; i < 4; ++i) frame.orientation[i] = f[pose + 3 + i];
    frame.translation = f[at_.translation];
    frame.rotation = f[at_.rotation];
    frame.curvature = f[at_.curvature];
    frame.bending = f[at_.bending];
    frame.injectedYaw = f[at_.injected_yaw];
    for (let i = 0; i < 3; ++i) frame.injectedTranslation[i] = f[at_.injected_translation + i];
    frame.resetting = u[at_.resetting] !== 0;
    frame.instruction = INSTRUCTIONS[u[at_.instruction]];
    frame.resetRemaining = f[at_.reset_remaining];
    frame.resetTurned = f[at_.reset_turned];
    frame.resetCount = u[at_.reset_count];
    frame.graphNodes = u[at_.graph_nodes];
    frame.resetPhase = PHASES[u[at_.reset_phase]];
    frame.resetBack = f[at_.reset_back];
    for (let i = 0; i < 3; ++i) frame.resetDirection[i] = f[at_.reset_direction + i];
    return frame;
  }

  teleport(floor, heading = 0) {
    const {library} = this;
    library.core.HEAPF32.set(floor, library.position >> 2);
    library.check(library.core._forewalk_session_teleport(this.handle, library.position, heading));
  }

  setGaze(direction) {
    this.direct('_forewalk_session_set_gaze', direction);
  }
  setChest(direction) {
    this.direct('_forewalk_session_set_chest', direction);
  }
  direct(name, direction) {
    const {library} = this;
    if (direction) library.core.HEAPF32.set(direction, library.position >> 2);
    library.check(library.core[name](this.handle, direction ? library.position : 0));
  }

  setLinks(links) {
    const {library} = this;
    library.with((scratch) => {
      const size = library.layout['link.size'];
      const at = scratch.take(size * links.length);
      links.forEach((link, i) => {
        const put = library.writer('link', at + i * size);
        put.uint('id', link.id);
        put.floats('entry', link.entry);
        put.floats('exit', link.exit);
        put.float('length', link.length);
        put.int('both_ways', link.bothWays ? 1 : 0);
        put.int('closed', link.closed ? 1 : 0);
      });
      library.check(library.core._forewalk_session_set_links(this.handle, at, links.length));
    });
  }

  setStanding(people) {
    const {library} = this;
    library.with((scratch) => {
      const size = library.layout['standing.size'];
      const at = scratch.take(size * people.length);
      people.forEach((person, i) => {
        const put = library.writer('standing', at + i * size);
        put.floats('foot', person.foot);
        put.float('radius', person.radius);
        put.float('cost', person.cost ?? 0);
      });
      library.check(library.core._forewalk_session_set_standing(this.handle, at, people.length));
    });
  }

  enter(navmesh) {
    this.library.check(this.library.core._forewalk_session_enter(this.handle, navmesh.handle));
  }

  graph(into = {horizon: 0, completeTo: 0, nodes: [], edges: [], fronts: [], ways: [], likelihoodNone: 1}) {
    const {library} = this;
    const {core, structs} = library;
    library.check(core._forewalk_graph(this.handle, library.view));
    const {HEAPF32: f, HEAPU32: u, HEAPU8: b} = core;
    const {graph_view: view, node: inNode, edge: inEdge, front: inFront, way: inWay} = structs;
    const field = (offset) => (library.view + offset) >> 2;
    const number = (at) => u[at >> 2] === NONE ? null : u[at >> 2];
    const vector = (out, at) => {
      out[0] = f[at >> 2];
      out[1] = f[(at >> 2) + 1];
      out[2] = f[(at >> 2) + 2];
    };
    // Rows that are there are filled anew: whoever hands in the last graph makes hardly any garbage.
    const rows = (list, size, first, count, make, fill) => {
      for (let i = 0; i < count; ++i) fill(i < list.length ? list[i] : (list[i] = make()), first + i * size, i);
      list.length = count;
    };
    rows(into.nodes, inNode.size, u[field(view.nodes)], u[field(view.node_count)], () => ({
      position: [0, 0, 0], distance: 0, prev: null, polygon: null, kind: KINDS[0], reason: null, branch: false,
    }), (node, at) => {
      vector(node.position, at + inNode.position);
      node.distance = f[(at + inNode.distance) >> 2];
      node.prev = number(at + inNode.prev);
      node.polygon = number(at + inNode.polygon);
      node.kind = KINDS[b[at + inNode.kind]];
      node.reason = REASONS[b[at + inNode.reason]];
      node.branch = b[at + inNode.branch] !== 0;
    });
    const points = u[field(view.points)];
    const widths = u[field(view.widths)] >> 2;
    rows(into.edges, inEdge.size, u[field(view.edges)], u[field(view.edge_count)], () => ({
      from: 0, to: 0, length: 0, width: 0, loop: false, path: [],
    }), (edge, at, i) => {
      edge.from = u[(at + inEdge.from) >> 2];
      edge.to = u[(at + inEdge.to) >> 2];
      edge.length = f[(at + inEdge.length) >> 2];
      edge.width = f[widths + i];
      edge.loop = u[(at + inEdge.loop) >> 2] !== 0;
      rows(edge.path, 12, points + 12 * u[(at + inEdge.path_start) >> 2], u[(at + inEdge.path_count) >> 2],
        () => [0, 0, 0], vector);
    });
    rows(into.fronts, inFront.size, u[field(view.fronts)], u[field(view.front_count)], () => ({
      node: 0, length: 0, from: [0, 0, 0], to: [0, 0, 0],
    }), (front, at) => {
      front.node = u[(at + inFront.node) >> 2];
      front.length = f[(at + inFront.length) >> 2];
      vector(front.from, at + inFront.from);
      vector(front.to, at + inFront.to);
    });
    rows(into.ways, inWay.size, u[field(view.ways)], u[field(view.way_count)], () => ({
      id: 0, node: 0, likelihood: 0, born: false,
    }), (way, at) => {
      way.id = u[(at + inWay.id) >> 2];
      way.node = u[(at + inWay.node) >> 2];
      way.likelihood = f[(at + inWay.likelihood) >> 2];
      way.born = b[at + inWay.born] !== 0;
    });
    into.horizon = f[field(view.horizon)];
    into.completeTo = f[field(view.complete_to)];
    into.likelihoodNone = f[field(view.likelihood_none)];
    return into;
  }
}

/** Compiles the module; once for a page. */
export async function load() {
  return new Library(await forewalkCore());
}
