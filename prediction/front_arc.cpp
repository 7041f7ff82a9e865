#include "prediction/front_arc.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace forewalk::prediction {

namespace {

glm::vec2 turned(glm::vec2 v, float cosine, float sine) {
  return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
}

// Four numbers worked out at once, which compilers do not find of themselves here.
using Four = float __attribute__((vector_size(16)));
using FourMasks = std::int32_t __attribute__((vector_size(16)));

Four all(float value) { return Four{value, value, value, value}; }
Four chosen(FourMasks mask, Four a, Four b) {
  return Four((mask & FourMasks(a)) | (~mask & FourMasks(b)));
}
Four larger(Four a, Four b) { return chosen(a > b, a, b); }
Four smaller(Four a, Four b) { return chosen(a < b, a, b); }

/// Evenly spaced points along the arc from the first of `points`, which is known, to `b`, on the
/// circle that goes on through `c`.
void fillArc(std::span<glm::vec2> points, glm::vec2 b, glm::vec2 c) {
  const glm::vec2 a = points.front();
  const auto steps = static_cast<float>(points.size() - 1);
  // The angle of the arc is twice that under which c sees it (inscribed angle theorem).
  const glm::vec2 ca = a - c, cb = b - c;
  const float angle = 2.0f * std::atan2(ca.x * cb.y - ca.y * cb.x, glm::dot(ca, cb));
  constexpr float kStraight = 1e-2f;
  glm::vec2 step = (b - a) / steps;
  float cosine = 1.0f, sine = 0.0f;
  if (std::abs(angle) > kStraight) {
    const float each = angle / steps;
    const float first = 0.5f * (each - angle);  // off the chord
    step = turned(b - a, std::cos(first), std::sin(first)) *
           (std::sin(0.5f * each) / std::sin(0.5f * angle));
    cosine = std::cos(each);
    sine = std::sin(each);
  }
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    points[i] = points[i - 1] + step;
    step = turned(step, cosine, sine);
  }
  points.back() = b;
}

}  // namespace

FrontLine frontLine(const PredictionGraph& graph, std::size_t order) {
  const glm::vec2 middle = graph.node(graph.terminals[order]).plan;
  FrontLine line;
  line.fill(middle);
  if (graph.fronts.size() != graph.terminals.size()) return line;
  const Front& front = graph.fronts[order];
  if (!(front.length > 0.0f)) return line;
  const std::span<glm::vec2> points(line);
  line.front() = front.from;
  if (front.from == front.to) {
    // It is closed: half a circle there and half back, with the middle across from its ends.
    const glm::vec2 centre = 0.5f * (front.from + middle);
    const glm::vec2 aside = turned(front.from - centre, 0.0f, 1.0f);
    fillArc(points.first(kFrontPoints / 2 + 1), middle, centre - aside);
    fillArc(points.subspan(kFrontPoints / 2), front.to, centre + aside);
    return line;
  }
  fillArc(points.first(kFrontPoints / 2 + 1), middle, front.to);
  fillArc(points.subspan(kFrontPoints / 2), front.to, front.from);
  return line;
}

float distanceToLine(glm::vec2 point, std::span<const glm::vec2> line) {
  const glm::vec2 first = line[0] - point;
  const float toFirst = glm::dot(first, first);
  const std::size_t pieces = line.size() - 1;
  Four least = all(toFirst);
  for (std::size_t begin = 0; begin < pieces; begin += 4) {
    Four x, y, nextX, nextY;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t i = std::min(begin + k, pieces - 1);
      x[k] = line[i].x;
      y[k] = line[i].y;
      nextX[k] = line[i + 1].x;
      nextY[k] = line[i + 1].y;
    }
    const Four alongX = nextX - x, alongY = nextY - y;
    const Four toX = all(point.x) - x, toY = all(point.y) - y;
    constexpr float kTiny = 1e-36f;  // square metres: two points that are one
    const Four length = larger(alongX * alongX + alongY * alongY, all(kTiny));
    const Four dot = toX * alongX + toY * alongY;
    const Four share = smaller(larger(dot / length, all(0.0f)), all(1.0f));
    const Four offX = toX - share * alongX, offY = toY - share * alongY;
    least = smaller(least, offX * offX + offY * offY);
  }
  return std::sqrt(std::min(std::min(least[0], least[1]), std::min(least[2], least[3])));
}

}  // namespace forewalk::prediction
