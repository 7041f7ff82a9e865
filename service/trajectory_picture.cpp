#include "service/trajectory_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "agents/crowd.h"
#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::service {
namespace {

using agents::TrajectoryChoice;
using agents::TrajectorySituation;
using prediction::Anchor;
using prediction::PlanPage;
using prediction::SvgDrawing;

constexpr const char* kDismissed = "fill=\"none\" stroke=\"#c3c9d1\" stroke-width=\"0.7\"";
constexpr const char* kChosen = "fill=\"none\" stroke=\"#1f4fd8\" stroke-width=\"4\"";

/// The model, which remembers what one agent saw when it last planned.
class Onlooker final : public agents::Model {
 public:
  Onlooker(const agents::GolaemParameters& parameters, std::uint32_t agent,
           TrajectorySituation& seen)
      : parameters_(parameters), model_(makeGolaem(parameters)), agent_(agent), seen_(seen) {}

  const char* name() const override { return model_->name(); }
  agents::Needs needs() const override { return model_->needs(); }
  std::unique_ptr<agents::Scratch> makeScratch() const override { return model_->makeScratch(); }
  void plan(const agents::PlanInput& input, agents::Memory memory, agents::Scratch& scratch,
            std::span<agents::Plan> plans) const override {
    for (const std::uint32_t agent : input.which) {
      if (agents::number(input.agents.id[agent]) != agent_) continue;
      lookAround(parameters_, input, agent, agents::golaemRow(memory.of(agent)), seen_);
    }
    model_->plan(input, memory, scratch, plans);
  }

 private:
  agents::GolaemParameters parameters_;
  std::unique_ptr<const agents::Model> model_;
  std::uint32_t agent_;
  TrajectorySituation& seen_;
};

struct Rated {
  std::uint32_t first, second;
  agents::TrajectoryScore score;
};

std::string colourOf(float share) {
  const glm::vec3 good(34, 150, 80), middling(238, 190, 60), bad(205, 60, 70);
  const glm::vec3 c = share < 0.5f ? glm::mix(good, middling, 2.0f * share)
                                   : glm::mix(middling, bad, 2.0f * share - 1.0f);
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(c.x), static_cast<int>(c.y),
                     static_cast<int>(c.z));
}

class Picture {
 public:
  Picture(const TrajectorySituation& situation, float radius)
      : situation_(situation),
        radius_(radius),
        page_(boundsOf(situation, radius)),
        drawing_(page_.pageSize().x, page_.pageSize().y, "#ffffff") {
    search_.prepare(situation.problem);
  }

  std::string draw(const std::string& subtitle) {
    const TrajectoryChoice choice = search_.best();
    const std::uint32_t seconds =
        std::max<std::uint32_t>(1, static_cast<std::uint32_t>(situation_.second.size()));
    std::vector<Rated> free, dismissed;
    for (std::uint32_t i = 0; i < situation_.first.size(); ++i) {
      for (std::uint32_t j = 0; j < seconds; ++j) {
        const Rated rated{i, j, search_.score(i, j)};
        (rated.score.hitPoint == 0 ? free : dismissed).push_back(rated);
      }
    }
    drawing_.title("The trajectories somebody chooses from");
    prediction::drawHeading(
        drawing_, page_, "The trajectories somebody chooses from",
        fmt::format("{}; {} sampled over {:.2g} s, {} dismissed", subtitle,
                    free.size() + dismissed.size(),
                    situation_.problem.step * static_cast<float>(situation_.problem.points),
                    dismissed.size()));
    drawing_.beginClip(page_.corner(), page_.mapSize());
    drawWays();
    for (const Rated& one : dismissed) drawOne(one.first, one.second, kDismissed);
    drawOthers();
    drawFree(free);
    if (choice.kind != TrajectoryChoice::Kind::none) {
      drawOne(choice.first, choice.second,
              "fill=\"none\" stroke=\"#ffffff\" stroke-width=\"8\" stroke-linecap=\"round\"");
      drawOne(choice.first, choice.second, kChosen);
    }
    drawBody();
    drawing_.endGroup();
    drawLegend(free);
    return drawing_.finish();
  }

 private:
  static prediction::PlanBounds boundsOf(const TrajectorySituation& situation, float radius) {
    agents::TrajectorySearch search;
    search.prepare(situation.problem);
    prediction::PlanBounds bounds;
    bounds.add(glm::dvec2(-2.0 * static_cast<double>(radius)));
    bounds.add(glm::dvec2(2.0 * static_cast<double>(radius)));
    std::vector<glm::vec2> points;
    for (std::uint32_t i = 0; i < situation.first.size(); ++i) {
      search.trace(i, 0, points);
      for (const glm::vec2 point : points) bounds.add(glm::dvec2(point));
      for (std::uint32_t j = 1; j < situation.second.size(); ++j) {
        search.trace(i, j, points);
        for (const glm::vec2 point : points) bounds.add(glm::dvec2(point));
      }
    }
    bounds.low -= 0.5;
    bounds.high += 0.5;
    return bounds;
  }

  glm::dvec2 at(glm::vec2 place) const { return page_.at(glm::dvec2(place)); }

  void drawOne(std::uint32_t first, std::uint32_t second, std::string_view style) {
    search_.trace(first, second, points_);
    std::vector<glm::dvec2> line{at(glm::vec2(0.0f))};
    for (const glm::vec2 point : points_) line.push_back(at(point));
    drawing_.polyline(line, false, style);
  }

  // The worst below, the best on top.
  void drawFree(std::vector<Rated>& free) {
    if (free.empty()) return;
    std::stable_sort(free.begin(), free.end(), [](const Rated& a, const Rated& b) {
      return a.score.penalty > b.score.penalty;
    });
    const float most = free.front().score.penalty, least = free.back().score.penalty;
    for (const Rated& one : free) {
      const float share = most > least ? (one.score.penalty - least) / (most - least) : 0.0f;
      drawOne(one.first, one.second,
              fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.1\" stroke-opacity=\"0.8\"",
                          colourOf(share)));
    }
  }

  double radiusOf(const agents::PredictedDisc& disc) const {
    return std::max(0.05, static_cast<double>(disc.contact - radius_)) * page_.scale();
  }

  // The ground that others are predicted to walk over.
  void drawWays() {
    const float lasts = situation_.problem.step * static_cast<float>(situation_.problem.points);
    for (const agents::PredictedDisc& disc : situation_.discs) {
      drawing_.line(
          at(disc.position), at(disc.position + disc.velocity * lasts),
          fmt::format("stroke=\"#dfe7f3\" stroke-linecap=\"round\" stroke-width=\"{:.1f}\"",
                      2.0 * radiusOf(disc)));
    }
  }

  void drawOthers() {
    for (const agents::PredictedDisc& disc : situation_.discs) {
      drawing_.circle(at(disc.position), radiusOf(disc),
                      disc.agent ? "fill=\"#8fa3c4\" stroke=\"#5c6f91\"" : "fill=\"#5b5f66\"");
    }
    for (const agents::PredictedWall& wall : situation_.walls) {
      drawing_.line(at(wall.from), at(wall.to), "stroke=\"#2b3440\" stroke-width=\"4\"");
    }
  }

  void drawBody() {
    const agents::TrajectoryProblem& problem = situation_.problem;
    const glm::dvec2 here = at(glm::vec2(0.0f));
    if (problem.towards != glm::vec2(0.0f)) {
      drawing_.line(
          here,
          at(problem.towards * std::min(problem.remaining, problem.comfortSpeed * problem.step *
                                                               static_cast<float>(problem.points))),
          "stroke=\"#2b3440\" stroke-width=\"1.5\" stroke-dasharray=\"6 5\"");
    }
    drawing_.circle(here, static_cast<double>(radius_) * page_.scale(),
                    "fill=\"#1f4fd8\" stroke=\"#ffffff\" stroke-width=\"2\"");
    drawing_.line(here, at(problem.heading * radius_),
                  "stroke=\"#ffffff\" stroke-width=\"3\" stroke-linecap=\"round\"");
  }

  void drawLegend(const std::vector<Rated>& free) {
    prediction::LegendCursor cursor = prediction::beginLegend(page_);
    const auto entry = [&](std::string_view words, std::string_view style) {
      const glm::dvec2 sign = prediction::legendEntry(drawing_, page_, cursor, words);
      drawing_.line(sign - glm::dvec2(9.0, 0.0), sign + glm::dvec2(9.0, 0.0), style);
    };
    entry("chosen", kChosen);
    if (!free.empty()) {
      entry(fmt::format("free, penalty {:.2f}", free.back().score.penalty),
            fmt::format("stroke=\"{}\" stroke-width=\"3\"", colourOf(0.0f)));
      entry(fmt::format("free, penalty {:.2f}", free.front().score.penalty),
            fmt::format("stroke=\"{}\" stroke-width=\"3\"", colourOf(1.0f)));
    }
    entry("dismissed", "stroke=\"#c3c9d1\" stroke-width=\"3\"");
    entry("straight walk", "stroke=\"#2b3440\" stroke-width=\"1.5\" stroke-dasharray=\"6 5\"");
    entry("others, their ways", "stroke=\"#8fa3c4\" stroke-width=\"8\"");
    prediction::drawScaleBar(drawing_, page_);
  }

  const TrajectorySituation& situation_;
  float radius_;
  PlanPage page_;
  SvgDrawing drawing_;
  agents::TrajectorySearch search_;
  std::vector<glm::vec2> points_;
};

}  // namespace

std::string drawTrajectories(const TrajectorySituation& situation, float radius,
                             const std::string& subtitle) {
  return Picture(situation, radius).draw(subtitle);
}

tl::expected<std::string, Error> pictureTrajectories(const agents::CrowdScene& scene,
                                                     const TrajectoryPictureSettings& settings) {
  if (settings.agent >= scene.agents.size()) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format("agent is {}, the scene {} has {}. Give 0 to {}.", settings.agent,
                          scene.name, scene.agents.size(), scene.agents.size() - 1)});
  }
  TrajectorySituation seen;
  agents::Crowd crowd;
  populate(scene,
           crowd.addModel(std::make_unique<Onlooker>(settings.parameters, settings.agent, seen)),
           crowd);
  const int steps = static_cast<int>(settings.seconds / scene.seconds);
  for (int step = 0; step <= steps; ++step) crowd.step(scene.seconds);
  return drawTrajectories(seen, scene.agents[settings.agent].spec.radius, settings.subtitle);
}

}  // namespace forewalk::service
