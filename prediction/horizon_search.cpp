#include "prediction/horizon_search.h"

#include <algorithm>
#include <cassert>

namespace forewalk::prediction {

using navmesh::KeyQueue;
using navmesh::kNoChain;
using navmesh::NavGraph;

HorizonSearch::HorizonSearch(const NavGraph& graph, std::uint32_t polygonLimit)
    : graph_(&graph), limit_(std::max(1u, std::min(polygonLimit, graph.polygonCount()))) {
  for (std::uint32_t polygon = 0; polygon < graph.polygonCount(); ++polygon) {
    mostNeighbours_ =
        std::max(mostNeighbours_, graph.portalStart[polygon + 1] - graph.portalStart[polygon]);
  }
  reach_.resize(graph.polygonCount());
  // States have other chains, never more than polygons.
  chains_.resize(std::size_t{graph.polygonCount()} + 2);
  touchedChains_.resize(std::size_t{graph.polygonCount()} + 2);
  // Each half-portal of a settled polygon is pushed at most once. That many for the whole limit
  // would be wasteful in large graphs; a queue that fills up is reported like a tree that does.
  // Links come with the states; few are waiting at a time.
  queue_.reserve(std::min<std::size_t>(graph.portalCount(), std::size_t{8} * limit_) +
                 mostNeighbours_ + 4 * navmesh::kMostLinkWays + 1);
  tree_.resize(limit_);
  funnels_.reserve(limit_);
}

void HorizonSearch::reset() {
  for (const SearchNode& node : tree()) reach_[index(node.polygon)] = Reach{};
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t entry = index(KeyQueue::polygonOf(queue_.at(i)));
    if (entry < kArrival) reach_[entry] = Reach{};
  }
  for (std::uint32_t i = 0; i < touchedCount_; ++i) chains_[touchedChains_[i]] = ChainReach{};
  touchedCount_ = 0;
  count_ = 0;
  queue_.clear();
  relaxed_ = 0;
  limitReached_ = false;
  completeTo_ = std::numeric_limits<float>::infinity();
  latestKey_ = 0.0f;
}

std::uint32_t HorizonSearch::settle(PolygonId polygon, std::uint32_t parent, std::uint32_t portal,
                                    float key) {
  reach_[index(polygon)].treeIndex = count_;
  if (count_ > 0) funnels_.add({parent, portal});
  // Field by field into its place: built aside and copied, it would wait for the store buffer.
  SearchNode& node = tree_[count_];
  const SearchNode& before = tree_[parent];
  node.polygon = polygon;
  node.parent = parent;
  node.portal = portal;
  node.key = key;
  node.corner = kNone;
  node.prevPG = before.branch ? parent : before.prevPG;
  node.within = true;
  node.branch = false;
  node.hasWithinChild = false;
  node.hasCutChild = false;
  node.dropped = false;
  return count_++;
}

/// Puts an entry in the place of the one being relaxed, or beside it where that is taken.
void HorizonSearch::enqueue(float key, std::uint32_t entry) {
  if (topTaken_) {
    queue_.push(KeyQueue::entryOf(key, PolygonId{entry}));
  } else {
    queue_.replaceTop(KeyQueue::entryOf(key, PolygonId{entry}));
    topTaken_ = true;
  }
}

/// Offers a polygon a way.
void HorizonSearch::label(PolygonId polygon, float key, std::uint32_t portal,
                          std::uint32_t parent) {
  Reach& reach = reach_[index(polygon)];
  if (key >= reach.key) return;
  reach.key = key;
  reach.portal = portal;
  reach.parent = parent;
  enqueue(key, index(polygon));
}

/// What is known of the chain, or the part of it, that is entered by a directed chain's first row.
HorizonSearch::ChainReach& HorizonSearch::chainReach(std::uint32_t directed) {
  const std::uint32_t chain = directed / 2;
  return chains_[chain == ownChain_ ? waysThrough_->chainCount() + directed % 2 : chain];
}

/// Goes from tree node `node` into a chain; `key` is that of its first portal.
void HorizonSearch::enterChain(std::uint32_t directed, float key, std::uint32_t node) {
  ChainReach& chain = chainReach(directed);
  if (chain.passage == ChainReach::kUntouched) {
    startChain(chain, directed, waysThrough_->directed[directed].begin, key, node);
  } else if (chain.passage == ChainReach::kEntered) {
    settleMeeting(chain, directed, key, node);
  } else if (chain.passage == ChainReach::kCut) {
    settleRest(chain, directed, key, node);
  }
}

void HorizonSearch::touch(ChainReach& chain, ChainReach::Passage passage) {
  touchedChains_[touchedCount_++] = static_cast<std::uint32_t>(&chain - chains_.data());
  chain.passage = passage;
}

void HorizonSearch::startChain(ChainReach& chain, std::uint32_t directed, std::uint32_t begin,
                               float key, std::uint32_t node) {
  touch(chain, ChainReach::kEntered);
  chain.directed = directed;
  chain.begin = begin;
  chain.node = node;
  chain.key = key;
  const navmesh::DirectedChain& way = waysThrough_->directed[directed];
  if (way.exit == kNoChain) {
    settleChain(chain);  // nobody can come from the other end
  } else {
    enqueue(key + way.exitLength, kArrival | directed);
  }
}

/// Settles rows [begin, end) of a directed chain after tree node `node`, up to the first that is
/// beyond the horizon. A row's key is `key` and its length.
HorizonSearch::Walked HorizonSearch::settleRows(std::uint32_t directed, std::uint32_t begin,
                                                std::uint32_t end, float key, std::uint32_t node) {
  // By keys all of the chain is within, mostly, and then it is so by taut lengths.
  const bool within = key + waysThrough_->directed[directed].farthest <= horizon_;
  const navmesh::ChainRow* rows = waysThrough_->rows.data();
  for (std::uint32_t row = begin; row < end; ++row) {
    if (count_ == limit_) {
      tree_[node].dropped = true;
      dropQueue();
      return {node, row, true};
    }
    const std::uint32_t before = node;
    node = settle(rows[row].polygon, before, rows[row].portal, key + rows[row].length);
    if (within) {
      tree_[before].hasWithinChild = true;
    } else if (!judge(node)) {
      return {node, row + 1, true};
    }
    relaxed_ += 2;
  }
  return {node, end, false};
}

/// Settles all of a chain the way it was entered.
HorizonSearch::Walked HorizonSearch::settleChain(ChainReach& chain) {
  const std::uint32_t end = waysThrough_->directed[chain.directed].end;
  const Walked walked = settleRows(chain.directed, chain.begin, end, chain.key, chain.node);
  chain.passage = walked.cut ? ChainReach::kCut : ChainReach::kSettled;
  chain.begin = walked.row;
  return walked;
}

/// Settles what lies beyond the cut of a chain, entered from its other end by `directed`.
void HorizonSearch::settleRest(ChainReach& chain, std::uint32_t directed, float key,
                               std::uint32_t node) {
  const std::uint32_t back = waysThrough_->directed[directed].begin;
  const std::uint32_t end = waysThrough_->directed[chain.directed].end;
  settleRows(directed, back, back + end - chain.begin, key, node);
  chain.passage = ChainReach::kSettled;
}

/// Settles a chain that was entered from one end and now, at `key`, from the other by `directed`:
/// each polygon from where it is nearer, or from where it can be reached.
void HorizonSearch::settleMeeting(ChainReach& chain, std::uint32_t directed, float key,
                                  std::uint32_t node) {
  const navmesh::ChainRow* rows = waysThrough_->rows.data();
  const std::uint32_t end = waysThrough_->directed[chain.directed].end;
  const std::uint32_t back = waysThrough_->directed[directed].begin;
  const std::uint32_t mirror = back + end - 1;
  std::uint32_t meeting = chain.begin;
  while (meeting < end && chain.key + rows[meeting].length <= key + rows[mirror - meeting].length) {
    ++meeting;
  }
  const Walked here = settleRows(chain.directed, chain.begin, meeting, chain.key, chain.node);
  const std::uint32_t backEnd = mirror + 1 - (here.cut ? here.row : meeting);
  if (limitReached_) {
    tree_[node].dropped = true;
    return;
  }
  const Walked there = settleRows(directed, back, backEnd, key, node);
  if (there.cut && !here.cut && !limitReached_) {
    settleRows(chain.directed, meeting, mirror + 1 - there.row, chain.key, here.node);
  }
  chain.passage = ChainReach::kSettled;
}

void HorizonSearch::useStates(const navmesh::PolygonStates* states, PolygonId source) {
  states_ = states == nullptr || states->allOpen() ? nullptr : states;
  assert(states_ == nullptr || states_->cost.size() == graph_->polygonCount());
  waysThrough_ = states_ == nullptr ? &graph_->chains : &states_->chains;
  neighbourCount_ = (states_ == nullptr ? graph_->neighbourCount : states_->openNeighbours).data();
  leaves_ = states_ != nullptr && states_->isClosed(source) ? source : navmesh::kNoPolygon;
  const bool linked = states_ != nullptr && !states_->links.empty();
  ways_ = linked ? states_->links.ways.data() : nullptr;
  mostOffered_ = mostNeighbours_ + (linked ? navmesh::kMostLinkWays : 0);
}

bool HorizonSearch::isEntered(std::uint32_t portal) const {
  return states_ == nullptr || !states_->isClosed(graph_->portalTo[portal]);
}

/// Of a polygon within the horizon, in no chain.
bool HorizonSearch::isBranch(PolygonId polygon) const {
  const std::uint32_t count = neighbourCount_[index(polygon)];
  if (leaves_ == navmesh::kNoPolygon || count != 2) return count > 2;
  const PolygonId* to = graph_->portalTo.data();
  const PolygonId* end = to + graph_->portalStart[index(polygon) + 1];
  if (std::find(to + graph_->portalStart[index(polygon)], end, leaves_) != end) return true;
  const auto ways = states_->links.from(polygon);
  return std::any_of(ways.begin(), ways.end(),
                     [&](const navmesh::LinkWay& way) { return way.to == leaves_; });
}

/// Offers what lies behind a half-portal a way.
inline void HorizonSearch::offer(std::uint32_t portal, float key, std::uint32_t node) {
  const std::uint32_t directed = waysThrough_->enteredBy[portal];
  if (directed != kNoChain) {
    enterChain(directed, key, node);
  } else {
    label(graph_->portalTo[portal], key, portal, node);
  }
}

void HorizonSearch::relaxFromSource(const navmesh::Location& source) {
  const std::uint32_t begin = graph_->portalStart[index(source.polygon)];
  const std::uint32_t end = graph_->portalStart[index(source.polygon) + 1];
  const bool leaves = leaves_ != navmesh::kNoPolygon;
  const float cost = states_ == nullptr || leaves ? 1.0f : states_->costOf(source.polygon);
  topTaken_ = true;
  for (std::uint32_t portal = begin; portal < end && !limitReached_; ++portal) {
    if (!isEntered(portal)) continue;
    ++relaxed_;
    const float key = cost * glm::distance(source.plan, graph_->portalMidpoint[portal]);
    if (ownChain_ != kNoChain) {
      enterOwnChain(portal, key);
    } else if (leaves) {
      label(graph_->portalTo[portal], key, portal, 0);
    } else {
      offer(portal, key, 0);
    }
  }
  if (ways_ != nullptr && !limitReached_) relaxLinks(0, source.plan, 0.0f, cost);
}

/// Offers what lies behind the links out of a node's polygon a way; `key` is that of the node,
/// where the walk is at `from`.
void HorizonSearch::relaxLinks(std::uint32_t node, glm::vec2 from, float key, float cost) {
  for (const navmesh::LinkWay& way : states_->links.from(tree_[node].polygon)) {
    if (way.to == way.from || states_->isClosed(way.to)) continue;
    ++relaxed_;
    // An exit lies in no chain.
    label(way.to, key + cost * glm::distance(from, way.entry) + way.length,
          kByLink | static_cast<std::uint32_t>(&way - ways_), node);
  }
}

/// The same from the middle of a chain.
void HorizonSearch::enterOwnChain(std::uint32_t portal, float key) {
  const navmesh::Chains& chains = *waysThrough_;
  const std::uint32_t even = 2 * ownChain_;
  const std::uint32_t row = chains.rowOf[index(tree_[0].polygon)];
  const std::uint32_t mirror = chains.directed[even + 1].begin + chains.directed[even].end - 1;
  for (const std::uint32_t directed : {even, even + 1}) {
    const std::uint32_t begin = (directed == even ? row : mirror - row) + 1;
    const navmesh::DirectedChain& way = chains.directed[directed];
    const bool leaves = begin == way.end;
    if (portal != (leaves ? way.exit : chains.rows[begin].portal)) continue;
    // The part between the user and the far end, as it is entered from there.
    ChainReach& part = chainReach(directed ^ 1);
    if (leaves) {
      touch(part, ChainReach::kSettled);
      label(graph_->portalTo[portal], key, portal, 0);
    } else {
      startChain(part, directed, begin, key - chains.rows[begin].length, 0);
    }
    return;
  }
}

/// Looks at the neighbours of the node whose entry is still the queue's top, and takes that out.
void HorizonSearch::relax(std::uint32_t node) {
  const SearchNode& from = tree_[node];
  const std::uint32_t begin = graph_->portalStart[index(from.polygon)];
  const std::uint32_t end = graph_->portalStart[index(from.polygon) + 1];
  const float* length = graph_->successorLength.data() + graph_->successorStart[from.portal];
  const float key = from.key;
  relaxed_ += end - begin;
  topTaken_ = false;
  for (std::uint32_t portal = begin; portal < end; ++portal) {
    offer(portal, key + length[portal - begin], node);
  }
  if (!topTaken_) queue_.pop();
}

/// The same where polygons are closed or cost more.
void HorizonSearch::relaxByCost(std::uint32_t node) {
  const SearchNode& from = tree_[node];
  const std::uint32_t begin = graph_->portalStart[index(from.polygon)];
  const std::uint32_t end = graph_->portalStart[index(from.polygon) + 1];
  const bool byLink = from.portal >= kByLink;
  const float* length =
      byLink ? nullptr : graph_->successorLength.data() + graph_->successorStart[from.portal];
  const glm::vec2 entered =
      byLink ? ways_[from.portal & ~kByLink].exit : graph_->portalMidpoint[from.portal];
  const float cost = states_->costOf(from.polygon);
  const float key = from.key;
  // Who leaves a closed polygon may come into the middle of a chain, of which the states' chains
  // know nothing. That is rare, and then all polygons go through the queue.
  const bool plain = leaves_ != navmesh::kNoPolygon;
  topTaken_ = false;
  for (std::uint32_t portal = begin; portal < end; ++portal) {
    if (!isEntered(portal)) continue;
    ++relaxed_;
    const float step =
        byLink ? glm::distance(entered, graph_->portalMidpoint[portal]) : length[portal - begin];
    const float there = key + cost * step;
    if (plain) {
      label(graph_->portalTo[portal], there, portal, node);
    } else {
      offer(portal, there, node);
    }
  }
  if (ways_ != nullptr) relaxLinks(node, entered, key, cost);
  if (!topTaken_) queue_.pop();
}

/// From the midpoint of the portal, or the exit of the link, that a node was entered by.
inline float HorizonSearch::stepToCentroid(const SearchNode& node) const {
  if (node.portal < kByLink) return graph_->portalToCentroid[node.portal];
  return glm::distance(ways_[node.portal & ~kByLink].exit, graph_->centroid[index(node.polygon)]);
}

bool HorizonSearch::isWithin(std::uint32_t node) {
  SearchNode& at = tree_[node];
  if (at.key + stepToCentroid(at) <= horizon_) return true;
  if (by_ == Limit::kKey) return false;
  const glm::vec2 centroid = graph_->centroid[index(at.polygon)];
  const std::vector<Corner>& corners = *corners_;
  if (at.portal < kByLink) {
    // A link may lead farther than one can walk.
    if (ways_ == nullptr && glm::distance(source_, centroid) > horizon_) return false;
    // The way by the last bend that all paths through the parent share is no longer than the taut
    // path.
    const Corner& shared = corners[funnels_.cornerShared(at.parent)];
    if (shared.distance + glm::distance(shared.plan, centroid) > horizon_) return false;
  }
  at.corner = cornerBefore(node, centroid, horizon_);
  const Corner& before = corners[at.corner];
  return before.distance + glm::distance(before.plan, centroid) <= horizon_;
}

/// Finds whether a node that was just settled is within the horizon, and tells its parent.
bool HorizonSearch::judge(std::uint32_t node) {
  SearchNode& at = tree_[node];
  at.within = isWithin(node);
  SearchNode& parent = tree_[at.parent];
  parent.hasWithinChild = parent.hasWithinChild || at.within;
  parent.hasCutChild = parent.hasCutChild || !at.within;
  return at.within;
}

/// The limit stops the search: the ways that are not settled yet are dropped.
void HorizonSearch::dropQueue() {
  limitReached_ = true;
  // What has a smaller key than the latest polygon of the queue is settled, or waits in a chain.
  completeTo_ = latestKey_;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t entry = index(KeyQueue::polygonOf(queue_.at(i)));
    if (entry < kArrival && reach_[entry].treeIndex == kNone) {
      tree_[reach_[entry].parent].dropped = true;
    }
  }
  for (std::uint32_t i = 0; i < touchedCount_; ++i) {
    const ChainReach& chain = chains_[touchedChains_[i]];
    if (chain.passage != ChainReach::kEntered) continue;
    tree_[chain.node].dropped = true;
    completeTo_ = std::min(completeTo_, tree_[chain.node].key);
  }
}

/// Settles the polygon that the queue's top stands for, and looks at its neighbours.
void HorizonSearch::settleTop(PolygonId polygon, const Reach& reach) {
  if (count_ == limit_ || queue_.size() + mostOffered_ > queue_.capacity()) {
    tree_[reach.parent].dropped = true;
    dropQueue();
    return;
  }
  const std::uint32_t node = settle(polygon, reach.parent, reach.portal, reach.key);
  if (judge(node)) {
    tree_[node].branch = isBranch(polygon);
    if (states_ == nullptr) {
      relax(node);
    } else {
      relaxByCost(node);
    }
  } else {
    queue_.pop();
  }
}

/// The way through a chain, the queue's top, has come to its end.
void HorizonSearch::arrive(std::uint32_t directed, float key) {
  // From the user's own chain a way goes toward the far end of the part it is in.
  ChainReach& chain = directed / 2 == ownChain_ ? chainReach(directed ^ 1) : chainReach(directed);
  if (chain.passage != ChainReach::kEntered) {
    queue_.pop();
    return;
  }
  const Walked walked = settleChain(chain);
  const navmesh::DirectedChain& way = waysThrough_->directed[directed];
  Reach& reach = reach_[index(way.exitTo)];
  if (walked.cut || key >= reach.key) {
    queue_.pop();
    return;
  }
  reach.key = key;
  reach.portal = way.exit;
  reach.parent = walked.node;
  settleTop(way.exitTo, reach);
}

void HorizonSearch::run(const navmesh::Location& source, float horizon,
                        std::vector<Corner>& corners, Limit limit,
                        const navmesh::PolygonStates* states) {
  assert(index(source.polygon) < graph_->polygonCount());
  reset();
  useStates(states, source.polygon);
  funnels_.restart(*graph_, source.plan, source.height, corners, ways_);
  source_ = source.plan;
  horizon_ = horizon;
  by_ = limit;
  corners_ = &corners;
  ownChain_ = waysThrough_->ofPolygon[index(source.polygon)];

  reach_[index(source.polygon)].key = 0.0f;
  settle(source.polygon, 0, kNone, 0.0f);
  tree_[0].prevPG = 0;
  relaxFromSource(source);

  while (!queue_.empty() && !limitReached_) {
    const KeyQueue::Entry top = queue_.top();
    const std::uint32_t entry = index(KeyQueue::polygonOf(top));
    latestKey_ = KeyQueue::keyOf(top);
    if (entry >= kArrival) {
      arrive(entry & ~kArrival, latestKey_);
    } else if (reach_[entry].treeIndex == kNone) {
      settleTop(PolygonId{entry}, reach_[entry]);
    } else {
      queue_.pop();  // stale: settled by a better key
    }
  }
}

}  // namespace forewalk::prediction
