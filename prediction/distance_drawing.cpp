#include "prediction/distance_drawing.h"
#include "navmesh/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

namespace forewalk::prediction {
namespace {

using glm::dvec2;
using navmesh::cross;
using navmesh::NavGraph;

constexpr double kTau = 6.283185307179586477;
constexpr double kSame = 1e-3;  // metres; of lengths that are equal but for rounding

// An angle in [0, 2 pi) from the direction `from` counter-clockwise to `to`.
double turn(dvec2 from, dvec2 to) {
  const double angle = std::atan2(cross(from, to), glm::dot(from, to));
  return angle < 0.0 ? angle + kTau : angle;
}

// Keeps what lies to the left of the ray from `root` along `ray`; `piece` is convex.
void clip(std::vector<dvec2>& piece, dvec2 root, dvec2 ray, std::vector<dvec2>& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const dvec2 a = piece[i], b = piece[(i + 1) % piece.size()];
    const double sideA = cross(ray, a - root), sideB = cross(ray, b - root);
    if (sideA >= 0.0) scratch.push_back(a);
    if ((sideA > 0.0 && sideB < 0.0) || (sideA < 0.0 && sideB > 0.0)) {
      scratch.push_back(glm::mix(a, b, sideA / (sideA - sideB)));
    }
  }
  piece.swap(scratch);
}

// The part of a polygon that a window sees: convex, counter-clockwise; empty where it is nothing.
struct Piece {
  PolygonId polygon;
  std::uint32_t corner;
  dvec2 root;
  double rootDistance;
  double nearest, farthest;  // from the source, metres
  std::vector<dvec2> ring;
};

double nearestOf(const std::vector<dvec2>& ring, dvec2 point) {
  double nearest = 1e300;
  bool inside = true;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const dvec2 a = ring[i], along = ring[(i + 1) % ring.size()] - a;
    inside = inside && cross(along, point - a) >= 0.0;
    const double squared = glm::dot(along, along);
    const double share =
        squared > 0.0 ? std::clamp(glm::dot(point - a, along) / squared, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, glm::distance(a + share * along, point));
  }
  return inside ? 0.0 : nearest;
}

template <typename Visit>
void forEachPiece(const NavGraph& graph, const DistanceField& field, const Visit& visit) {
  Piece piece;
  std::vector<dvec2> scratch;
  for (const PolygonId polygon : field.polygons()) {
    for (std::uint32_t w = field.firstWindow(polygon); w != kNone; w = field.windows()[w].next) {
      const Window& window = field.windows()[w];
      const Corner& corner = field.corners()[window.corner];
      piece.polygon = polygon;
      piece.corner = window.corner;
      piece.root = dvec2(corner.plan);
      piece.rootDistance = static_cast<double>(corner.distance);
      piece.ring.clear();
      for (const glm::vec2 point : graph.ringOf(polygon)) piece.ring.emplace_back(point);
      if (window.portal != kNone) {
        clip(piece.ring, piece.root, window.right, scratch);
        clip(piece.ring, piece.root, -window.left, scratch);
      }
      if (piece.ring.size() < 3) continue;
      piece.nearest = piece.rootDistance + nearestOf(piece.ring, piece.root);
      piece.farthest = 0.0;
      for (const dvec2 point : piece.ring) {
        piece.farthest =
            std::max(piece.farthest, piece.rootDistance + glm::distance(point, piece.root));
      }
      if (piece.nearest < field.completeTo()) visit(std::as_const(piece));
    }
  }
}

// Stretches of a ring's edges within a circle, in order. Between the end of one and the beginning
// of the next the circle runs inside the ring, unless the two are one point.
struct Stretch {
  dvec2 from, to;
};

void stretchesWithin(const std::vector<dvec2>& ring, dvec2 centre, double radius,
                     std::vector<Stretch>& stretches) {
  stretches.clear();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    const dvec2 along = b - a, off = a - centre;
    const double squared = glm::dot(along, along);
    if (squared <= 0.0) continue;
    const double middle = -glm::dot(off, along) / squared;
    const double inner = middle * middle - (glm::dot(off, off) - radius * radius) / squared;
    if (inner <= 0.0) continue;
    const double half = std::sqrt(inner);
    const double from = std::max(0.0, middle - half), to = std::min(1.0, middle + half);
    if (from >= to) continue;
    stretches.push_back({from > 0.0 ? a + from * along : a, to < 1.0 ? a + to * along : b});
  }
}

// Arcs of a circle within a ring, as pairs of angles.
template <typename Visit>
void forEachArc(const std::vector<dvec2>& ring, dvec2 centre, double radius,
                std::vector<Stretch>& stretches, const Visit& visit) {
  stretchesWithin(ring, centre, radius, stretches);
  if (stretches.empty()) {
    if (nearestOf(ring, centre) <= 0.0) visit(-0.5 * kTau, 0.5 * kTau);
    return;
  }
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const dvec2 from = stretches[i].to - centre;
    const dvec2 to = stretches[(i + 1) % stretches.size()].from - centre;
    if (glm::distance(from, to) < 1e-9 * radius) continue;
    const double begin = std::atan2(from.y, from.x);
    visit(begin, begin + turn(from, to));
  }
}

// Path data in tenths of a pixel, whole numbers from point to point: a third of the bytes of
// moveTo and lineTo. To be drawn within a group that scales by 0.1.
class FinePath {
 public:
  explicit FinePath(const PlanPage& page) : page_(&page) {}

  void moveTo(dvec2 plan) {
    at_ = rounded(plan);
    fmt::format_to(std::back_inserter(data_), "M{} {}", at_.x, at_.y);
  }
  void lineTo(dvec2 plan) {
    const glm::ivec2 step = stepTo(plan);
    if (step != glm::ivec2(0)) fmt::format_to(std::back_inserter(data_), "l{} {}", step.x, step.y);
  }
  // Counter-clockwise on the plan.
  void arcTo(dvec2 plan, double radius, bool large) {
    const glm::ivec2 step = stepTo(plan);
    if (step == glm::ivec2(0)) return;
    const double pixels = 10.0 * radius * page_->scale();
    fmt::format_to(std::back_inserter(data_), "a{0:.0f} {0:.0f} 0 {1} 0 {2} {3}", pixels,
                   large ? 1 : 0, step.x, step.y);
  }
  void close() { data_ += 'z'; }
  const std::string& data() const { return data_; }

 private:
  glm::ivec2 rounded(dvec2 plan) const { return glm::ivec2(glm::round(10.0 * page_->at(plan))); }
  glm::ivec2 stepTo(dvec2 plan) {
    const glm::ivec2 to = rounded(plan), step = to - at_;
    at_ = to;
    return step;
  }

  const PlanPage* page_;
  glm::ivec2 at_{0};
  std::string data_;
};

void addArc(FinePath& path, const IsoArc& arc) {
  // Half a turn at a time: SVG cannot draw a whole one.
  const int parts = arc.to - arc.from > 0.45 * kTau ? 3 : 1;
  path.moveTo(arc.at(arc.from));
  for (int i = 1; i <= parts; ++i) {
    path.arcTo(arc.at(glm::mix(arc.from, arc.to, static_cast<double>(i) / parts)), arc.radius,
               false);
  }
}

void addDisc(FinePath& path, const Piece& piece, double radius, std::vector<Stretch>& stretches) {
  stretchesWithin(piece.ring, piece.root, radius, stretches);
  if (stretches.empty()) {
    if (nearestOf(piece.ring, piece.root) > 0.0) return;
    addArc(path, {piece.root, radius, -0.5 * kTau, 0.5 * kTau, 0.0, piece.polygon});
    path.close();
    return;
  }
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (i == 0) path.moveTo(stretches[i].from);
    path.lineTo(stretches[i].to);
    const dvec2 from = stretches[i].to - piece.root;
    const dvec2 to = stretches[(i + 1) % stretches.size()].from - piece.root;
    if (glm::distance(from, to) < 1e-9 * radius) continue;
    path.arcTo(piece.root + to, radius, turn(from, to) > 0.5 * kTau);
  }
  path.close();
}

// Marks the bands in which a piece is the nearest way somewhere, or hardly longer than it.
void markBands(const Piece& piece, const DistanceField& field, double step,
               std::vector<char>& bands) {
  constexpr double kSpacing = 0.2, kHardly = 0.03;  // metres
  const auto look = [&](dvec2 point) {
    const double length = piece.rootDistance + glm::distance(point, piece.root);
    const double exact = static_cast<double>(field.distanceAt(piece.polygon, glm::vec2(point)));
    if (length > exact + kHardly) return;
    const auto band = static_cast<std::size_t>(std::max(0.0, length / step));
    if (band < bands.size()) bands[band] = 1;
  };
  for (std::size_t i = 1; i + 1 < piece.ring.size(); ++i) {
    const dvec2 a = piece.ring[0], b = piece.ring[i], c = piece.ring[i + 1];
    const double longest =
        std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    const int rows = std::clamp(static_cast<int>(longest / kSpacing) + 1, 3, 200);
    for (int row = 0; row <= rows; ++row) {
      for (int column = 0; column <= row; ++column) {
        // A little inside: corners belong to other pieces as well.
        const double s = 0.01 + 0.97 * row / rows;
        const double t = row == 0 ? 0.5 : 0.01 + 0.98 * column / row;
        look(a + s * (glm::mix(b, c, t) - a));
      }
    }
  }
}

std::string hexOf(glm::dvec3 linear) {
  std::string text = "#";
  for (int i = 0; i < 3; ++i) {
    const double value = std::clamp(linear[i], 0.0, 1.0);
    const double encoded =
        value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
    fmt::format_to(std::back_inserter(text), "{:02x}", std::lround(255.0 * encoded));
  }
  return text;
}

}  // namespace

std::vector<IsoArc> isoLine(const NavGraph& graph, const DistanceField& field, double distance,
                            std::span<const char> storeyOf) {
  struct Found {
    std::uint32_t corner;
    char storey;
    IsoArc arc;
  };
  std::vector<Found> found;
  if (!(distance > 0.0) || distance > static_cast<double>(field.completeTo()) + kSame) return {};
  std::vector<Stretch> stretches;
  forEachPiece(graph, field, [&](const Piece& piece) {
    const double radius = distance - piece.rootDistance;
    if (radius <= 0.0 || piece.nearest > distance || piece.farthest < distance) return;
    // Distances and places are floats.
    const double rounding =
        2e-5 + 1e-6 * (distance + std::abs(piece.root.x) + std::abs(piece.root.y));
    const auto isNearest = [&](double angle) {
      const dvec2 point = piece.root + radius * dvec2(std::cos(angle), std::sin(angle));
      return static_cast<double>(field.distanceAt(piece.polygon, glm::vec2(point))) >=
             distance - rounding;
    };
    // The last angle from `here`, where it is nearest, toward `there`, where it is not.
    const auto border = [&](double here, double there) {
      for (int i = 0; i < 24; ++i) {
        const double middle = 0.5 * (here + there);
        (isNearest(middle) ? here : there) = middle;
      }
      return here;
    };
    forEachArc(piece.ring, piece.root, radius, stretches, [&](double from, double to) {
      constexpr double kSpacing = 0.05;  // metres
      const int count = std::clamp(static_cast<int>(radius * (to - from) / kSpacing), 2, 4000);
      const auto keep = [&](double begin, double end) {
        if (begin >= end) return;
        found.push_back({piece.corner,
                         storeyOf.empty() ? char{0} : storeyOf[index(piece.polygon)],
                         {piece.root, radius, begin, end, distance, piece.polygon}});
      };
      std::optional<double> begin;
      double last = from;
      for (int i = 0; i <= count; ++i) {
        // Ends lie on borders, where rounding decides.
        const double share = std::clamp(static_cast<double>(i) / count, 1e-6, 1.0 - 1e-6);
        const double angle = from + share * (to - from);
        const bool nearest = isNearest(angle);
        if (nearest && !begin) begin = i == 0 ? from : border(angle, last);
        if (!nearest && begin) keep(*std::exchange(begin, std::nullopt), border(last, angle));
        last = angle;
      }
      if (begin) keep(*begin, to);
    });
  });
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return std::tuple(a.corner, a.storey, a.arc.from) < std::tuple(b.corner, b.storey, b.arc.from);
  });
  std::vector<IsoArc> arcs;
  const Found* before = nullptr;
  for (const Found& next : found) {
    const bool touches = before != nullptr && before->corner == next.corner &&
                         before->storey == next.storey &&
                         next.arc.from - arcs.back().to < kSame / next.arc.radius;
    before = &next;
    if (touches) {
      arcs.back().to = std::min(std::max(arcs.back().to, next.arc.to), arcs.back().from + kTau);
    } else {
      arcs.push_back(next.arc);
    }
  }
  return arcs;
}

std::string distanceColour(double share) {
  const double t = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 1.0;
  // OKLCh: lightness falls, hue goes from yellow by green and blue to violet.
  const double lightness = 0.965 - 0.475 * t;
  const double chroma = 0.075 + 0.05 * t;
  const double hue = glm::radians(98.0 + 190.0 * t);
  const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return hexOf({4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s});
}

double isoStep(double horizon) { return roundStep(std::max(horizon / 25.0, 1e-3)); }

void drawDistances(SvgDrawing& drawing, const PlanPage& page, const NavGraph& graph,
                   const DistanceField& field, std::span<const char> shown) {
  const auto horizon = static_cast<double>(field.completeTo());
  if (!(horizon > 0.0)) return;
  const double step = isoStep(horizon);
  const auto bandCount = static_cast<std::size_t>(std::ceil(horizon / step - 1e-6));
  const auto isShown = [&](PolygonId polygon) { return shown.empty() || shown[index(polygon)]; };
  std::vector<FinePath> bands(bandCount, FinePath(page));
  std::vector<char> marked;
  std::vector<Stretch> stretches;
  forEachPiece(graph, field, [&](const Piece& piece) {
    if (!isShown(piece.polygon)) return;
    marked.assign(bandCount, 0);
    markBands(piece, field, step, marked);
    for (std::size_t band = 0; band < bandCount; ++band) {
      const double radius =
          std::min(horizon, static_cast<double>(band + 1) * step) - piece.rootDistance;
      if (marked[band] && radius > 0.0) addDisc(bands[band], piece, radius, stretches);
    }
  });
  drawing.beginClip(page.corner(), page.mapSize());
  drawing.beginGroup("transform=\"scale(.1)\"");
  for (std::size_t band = bandCount; band-- > 0;) {
    // The stroke closes hairlines between pieces.
    const double middle = (static_cast<double>(band) + 0.5) / static_cast<double>(bandCount);
    drawing.path(bands[band].data(), fmt::format("fill=\"{0}\" stroke=\"{0}\" stroke-width=\"6\"",
                                                 distanceColour(middle)));
  }
  drawing.endGroup();

  struct Label {
    dvec2 at;
    std::string words;
  };
  std::vector<Label> labels;
  std::vector<IsoArc> fine, bold;
  for (int i = 1; i * step < horizon + kSame; ++i) {
    const bool isBold = i % 5 == 0;
    for (const IsoArc& arc : isoLine(graph, field, i * step, shown)) {
      if (!isShown(arc.polygon)) continue;
      (isBold ? bold : fine).push_back(arc);
      // The last line has its number in the legend, and the ends of ways on it.
      const double pixels = arc.radius * (arc.to - arc.from) * page.scale();
      if (!isBold || pixels < 34.0 || (i + 0.5) * step > horizon) continue;
      const dvec2 at = page.at(arc.at(0.5 * (arc.from + arc.to)));
      const bool crowded = std::any_of(labels.begin(), labels.end(), [&](const Label& other) {
        return glm::distance(other.at, at) < 120.0;
      });
      if (!crowded) labels.push_back({at, fmt::format("{:g} m", i * step)});
    }
  }
  constexpr std::string_view kLine = "stroke=\"#14304a\" stroke-opacity=\"0.34\"";
  drawArcs(drawing, page, fine, fmt::format("{} stroke-width=\"7\"", kLine));
  drawArcs(drawing, page, bold, fmt::format("{} stroke-width=\"17\"", kLine));
  drawing.beginGroup(
      "paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-opacity=\"0.55\"");
  for (const Label& label : labels) {
    drawing.text(label.at + dvec2(0, 3.6), label.words, 10, Anchor::kMiddle, "fill=\"#14304a\"");
  }
  drawing.endGroup();
  drawing.endGroup();
}

void drawArcs(SvgDrawing& drawing, const PlanPage& page, std::span<const IsoArc> arcs,
              std::string_view style) {
  FinePath path(page);
  for (const IsoArc& arc : arcs) addArc(path, arc);
  drawing.beginGroup("transform=\"scale(.1)\" fill=\"none\" stroke-linecap=\"butt\"");
  drawing.path(path.data(), style);
  drawing.endGroup();
}

void drawDistanceLegend(SvgDrawing& drawing, const PlanPage& page, double horizon) {
  if (!(horizon > 0.0)) return;
  const double step = isoStep(horizon);
  const auto bandCount = static_cast<int>(std::ceil(horizon / step - 1e-6));
  constexpr double kWidth = 240, kHeight = 11;
  const dvec2 corner = {page.corner().x + page.mapSize().x - kWidth - 14, 20};
  const auto x = [&](double distance) { return corner.x + kWidth * distance / horizon; };
  for (int band = 0; band < bandCount; ++band) {
    const double from = x(band * step), to = x(std::min(horizon, (band + 1) * step));
    drawing.rectangle({from, corner.y}, {to - from, kHeight},
                      fmt::format("fill=\"{}\"", distanceColour((band + 0.5) / bandCount)));
  }
  drawing.rectangle(corner, {kWidth, kHeight},
                    "fill=\"none\" stroke=\"#14304a\" stroke-opacity=\"0.5\" stroke-width=\"0.8\"");
  for (int i = 0; i * step < horizon + kSame; i += 5) {
    drawing.line({x(i * step), corner.y + kHeight}, {x(i * step), corner.y + kHeight + 3},
                 "stroke=\"#14304a\" stroke-opacity=\"0.5\" stroke-width=\"0.8\"");
    drawing.text({x(i * step), corner.y + kHeight + 14},
                 fmt::format("{:g}{}", i * step, i == 0 ? " m" : ""), 11, Anchor::kMiddle,
                 "fill=\"#5a6675\"");
  }
  drawing.text({corner.x - 10, corner.y + 10}, "walking distance", 12, Anchor::kEnd,
               "fill=\"#5a6675\"");
}

}  // namespace forewalk::prediction
