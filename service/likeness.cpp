#include "service/likeness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "agents/evaluation/dtw.h"
#include "service/experiment/statistics.h"
#include "service/parallel.h"

namespace forewalk::service {
namespace {

constexpr double kTold = 0.05;

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

Errand errandOf(const rdw::Walk& walk, const WalkLeg& leg, double speed) {
  const auto& samples = walk.samples;
  Errand errand{samples[leg.first].plan, samples[leg.last].plan, 0.0, speed, 20.0};
  // The heading of who has walked half a metre: at the very start a head looks about.
  std::size_t ahead = leg.first;
  while (ahead < leg.last && glm::distance(samples[ahead].plan, errand.from) < 0.5) ++ahead;
  const glm::dvec2 moved = samples[ahead].plan - errand.from;
  if (glm::length(moved) > 0.0) errand.heading = std::atan2(-moved.x, moved.y);
  errand.rate = static_cast<double>(leg.last - leg.first) /
                (samples[leg.last].seconds - samples[leg.first].seconds);
  return errand;
}

SentWalker tautWalker() {
  return {"taut path",
          [](const RecordedBuilding& building, const WalkLeg& leg, const Errand& errand) {
            LonePath path;
            const auto taut = tautPath(*building.world, errand.from, errand.to);
            path.arrived = !taut.empty();
            path.seconds = leg.shortestWay / errand.speed;
            path.points = path.arrived ? agents::resampleByLength(taut, errand.speed / errand.rate)
                                       : std::vector<glm::dvec2>{errand.from};
            return path;
          }};
}

std::vector<std::size_t> from(std::size_t first, std::size_t count) {
  std::vector<std::size_t> indices(count);
  std::iota(indices.begin(), indices.end(), first);
  return indices;
}

// Paths of the people of a set, and rows of who walks in their place.
std::vector<ComparedPath> peopleOf(const RecordedBuilding& building, const LegSet& set,
                                   const std::string& setName) {
  std::vector<ComparedPath> paths;
  for (const WalkLeg& leg : set.legs) {
    const rdw::Walk& walk = building.walks[leg.walk];
    ComparedPath path{setName + " " + walk.walker, building.name, setName, walk.walker, {}};
    for (std::size_t i = leg.first; i <= leg.last; ++i) path.points.push_back(walk.samples[i].plan);
    paths.push_back(std::move(path));
  }
  return paths;
}

/// Numbers of persons, over all buildings.
class Persons {
 public:
  explicit Persons(const std::vector<RecordedBuilding>& buildings) {
    std::size_t people = 0;
    for (const RecordedBuilding& building : buildings) {
      first_.push_back(people);
      people += building.walks.size();
    }
  }
  std::size_t number(std::size_t building, std::size_t walk) const {
    return first_[building] + walk;
  }

 private:
  std::vector<std::size_t> first_;
};

agents::MatchedLegs matchedLegs(const ComparedSet& set, std::size_t table, std::size_t walker,
                                const Persons& persons) {
  const std::size_t n = set.legs.legs.size();
  agents::MatchedLegs legs{&set.tables[table].table, from(0, n), from((walker + 1) * n, n), {}};
  for (const WalkLeg& leg : set.legs.legs) {
    legs.walkers.push_back(persons.number(set.building, leg.walk));
  }
  return legs;
}

// Everything that is said of one set alone.
void judge(ComparedSet& set, std::size_t walkers, const Persons& persons,
           const ComparisonSettings& settings) {
  const std::size_t n = set.legs.legs.size();
  for (std::size_t t = 0; t < set.tables.size(); ++t) {
    const agents::DistanceTable& table = set.tables[t].table;
    const std::vector<std::size_t> people = from(0, n);
    const std::vector<double> apart = agents::meanDistancesTo(table, people);
    set.peopleApart.push_back(
        std::accumulate(apart.begin(), apart.begin() + static_cast<long>(n), 0.0) /
        static_cast<double>(n));
    set.walkers.emplace_back();
    for (std::size_t w = 0; w < walkers; ++w) {
      SetLikeness likeness;
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          if (i != j) sum += table.at(i, (w + 1) * n + j);
        }
      }
      likeness.toPeople = sum / static_cast<double>(n * (n - 1));
      const agents::MatchedLegs legs = matchedLegs(set, t, w, persons);
      agents::SeparationSettings one = settings.separation;
      likeness.superiority = agents::matchedSeparation({&legs, 1}, one).superiority;
      likeness.separation = agents::separation(table, people, legs.models, settings.separation);
      set.walkers.back().push_back(likeness);
    }
  }
}

void judgeOverall(Likeness& likeness, const Persons& persons, const ComparisonSettings& settings) {
  const std::size_t tables = likeness.sets.front().tables.size();
  for (std::size_t t = 0; t < tables; ++t) {
    std::vector<double> farther, apart;
    for (std::size_t w = 0; w < likeness.walkers.size(); ++w) {
      OverallLikeness overall;
      std::vector<double> ratios, p;
      std::vector<agents::MatchedLegs> legs;
      for (const ComparedSet& set : likeness.sets) {
        ratios.push_back(set.walkers[t][w].toPeople / set.peopleApart[t]);
        p.push_back(set.walkers[t][w].separation.p);
        legs.push_back(matchedLegs(set, t, w, persons));
      }
      const std::vector<double> adjusted = holm(p);
      for (std::size_t s = 0; s < adjusted.size(); ++s) {
        likeness.sets[s].walkers[t][w].holm = adjusted[s];
        overall.toldApart += adjusted[s] < kTold ? 1 : 0;
      }
      overall.ratio = medianOf(ratios);
      overall.matched = agents::matchedSeparation(legs, settings.separation);
      farther.push_back(overall.matched.farther);
      apart.push_back(overall.matched.apart);
      likeness.walkers[w].overall.push_back(overall);
    }
    const std::vector<double> fartherHolm = holm(farther), apartHolm = holm(apart);
    for (std::size_t w = 0; w < likeness.walkers.size(); ++w) {
      likeness.walkers[w].overall[t].farther = fartherHolm[w];
      likeness.walkers[w].overall[t].apart = apartHolm[w];
    }
  }
}

}  // namespace

std::vector<SentWalker> sentWalkers() {
  std::vector<SentWalker> walkers{tautWalker()};
  for (LoneModel& model : loneModels()) {
    const std::string name = model.name;
    walkers.push_back({name, [model = std::move(model)](const RecordedBuilding& building,
                                                        const WalkLeg&, const Errand& errand) {
                         return walkErrand(building.world, building.walkerRadius, model, errand);
                       }});
  }
  return walkers;
}

tl::expected<Likeness, Error> compareWithPeople(const std::vector<RecordedBuilding>& buildings,
                                                const std::vector<SentWalker>& walkers,
                                                const LegRule& rule,
                                                const ComparisonSettings& settings,
                                                const ComparisonProgress& progress) {
  Likeness likeness;
  likeness.rule = rule;
  const Persons persons(buildings);
  std::vector<std::vector<double>> speeds;
  for (std::size_t b = 0; b < buildings.size(); ++b) {
    const RecordedBuilding& building = buildings[b];
    WalkLegs cut = cutLegs(building.walks, rule, [&](glm::dvec2 start, glm::dvec2 goal) {
      const auto taut = tautPath(*building.world, start, goal);
      return taut.empty() ? std::numeric_limits<double>::infinity() : agents::pathLength(taut);
    });
    BuildingSummary summary{building.name,
                            building.walks.size(),
                            std::move(cut.regions),
                            cut.rests,
                            cut.sets.size(),
                            0,
                            {}};
    for (const rdw::Walk& walk : building.walks) summary.speeds.push_back(comfortSpeed(walk));
    for (LegSet& legs : cut.sets) {
      ComparedSet set;
      set.building = b;
      set.name = fmt::format("{} {}>{}", building.name, legs.from, legs.to);
      set.paths = peopleOf(building, legs, set.name);
      set.shortestWay = 0.0;
      for (const WalkLeg& leg : legs.legs) {
        set.shortestWay += leg.shortestWay / static_cast<double>(legs.legs.size());
      }
      summary.legs += legs.legs.size();
      set.legs = std::move(legs);
      likeness.sets.push_back(std::move(set));
    }
    likeness.buildings.push_back(std::move(summary));
  }
  if (likeness.sets.empty()) {
    return tl::unexpected(Error{
        ErrorCode::kSettingOutOfRange,
        fmt::format("no {} people walked {:g} m or more between the same two places where they "
                    "rested, in any of {} buildings; ask for fewer, or give more walks.",
                    rule.walkers, rule.shortest, buildings.size())});
  }

  // Everybody on every errand.
  struct Job {
    std::size_t set, walker, leg;
  };
  std::vector<Job> jobs;
  for (std::size_t s = 0; s < likeness.sets.size(); ++s) {
    for (std::size_t w = 0; w < walkers.size(); ++w) {
      for (std::size_t k = 0; k < likeness.sets[s].legs.legs.size(); ++k) jobs.push_back({s, w, k});
    }
  }
  std::vector<LonePath> walked(jobs.size());
  std::mutex reporting;
  std::size_t done = 0;
  onThreads(settings.threads)(jobs.size(), [&](std::size_t j) {
    const ComparedSet& set = likeness.sets[jobs[j].set];
    const RecordedBuilding& building = buildings[set.building];
    const WalkLeg& leg = set.legs.legs[jobs[j].leg];
    const Errand errand =
        errandOf(building.walks[leg.walk], leg, likeness.buildings[set.building].speeds[leg.walk]);
    walked[j] = walkers[jobs[j].walker].walk(building, leg, errand);
    if (!progress) return;
    const std::lock_guard lock(reporting);
    progress(++done, jobs.size());
  });
  for (const SentWalker& walker : walkers) likeness.walkers.push_back({walker.name, 0, 0, 1.0, {}});
  std::vector<double> metres(walkers.size(), 0.0);
  double shortest = 0.0, peoples = 0.0;
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    ComparedSet& set = likeness.sets[jobs[j].set];
    const WalkLeg& leg = set.legs.legs[jobs[j].leg];
    WalkerSummary& summary = likeness.walkers[jobs[j].walker];
    ++summary.legs;
    summary.arrived += walked[j].arrived ? 1 : 0;
    metres[jobs[j].walker] += agents::pathLength(walked[j].points);
    if (jobs[j].walker == 0) {
      shortest += leg.shortestWay;
      peoples += leg.metres;
    }
    const std::string& person = buildings[set.building].walks[leg.walk].walker;
    set.paths.push_back({fmt::format("{} {} for {}", set.name, summary.name, person),
                         buildings[set.building].name, set.name, summary.name,
                         std::move(walked[j].points)});
  }
  likeness.peopleDetour = peoples / shortest;
  for (std::size_t w = 0; w < walkers.size(); ++w) {
    likeness.walkers[w].detour = metres[w] / shortest;
  }
  for (ComparedSet& set : likeness.sets) {
    auto tables = tablesOf(set.paths, settings);
    if (!tables) return tl::unexpected(std::move(tables.error()));
    set.tables = std::move(*tables);
    judge(set, walkers.size(), persons, settings);
  }
  judgeOverall(likeness, persons, settings);
  return likeness;
}

std::vector<SceneLikeness> compareInScenes(double spacing, unsigned threads) {
  const std::vector<LoneModel> models = loneModels();
  std::vector<SceneLikeness> scenes;
  for (const agents::AvatarScene& scene : agents::avatarScenes()) {
    if (scene.name.substr(0, 4) != "test") continue;
    SceneLikeness likeness{&scene, {}, {}, {}};
    for (const LoneModel& model : models) likeness.walkers.push_back(model.name);
    likeness.walkers.push_back("thesis");
    const std::size_t n = likeness.walkers.size();
    likeness.walked.resize(n);
    onThreads(threads)(n, [&](std::size_t w) {
      likeness.walked[w] =
          w < models.size() ? walkScene(scene, models[w]) : walkSceneAsAvatar(scene);
    });
    likeness.normalised = agents::makeDistanceTable(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        likeness.normalised.at(i, j) = likeness.normalised.at(j, i) =
            agents::normalisedDtw(likeness.walked[i].points, likeness.walked[j].points, spacing);
      }
    }
    scenes.push_back(std::move(likeness));
  }
  return scenes;
}

}  // namespace forewalk::service
