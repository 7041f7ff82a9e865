// Evaluations for people and programs: table, CSV, JSON and figures.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "service/evaluation.h"
#include "service/plot.h"

namespace forewalk::service {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kColours[] = {"#9aa3ad", "#c98a1b", "#2f5fb3", "#6a4c93", "#2a8c4a"};

std::string number(double value, int digits = 3) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

Json jsonOf(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json jsonOf(const Interval& interval) {
  return {{"mean", jsonOf(interval.mean)},
          {"low", jsonOf(interval.low)},
          {"high", jsonOf(interval.high)}};
}

Json jsonOf(const Scores& scores) {
  return {{"samples", scores.samples},
          {"nll", jsonOf(scores.nll)},
          {"brier", jsonOf(scores.brier)},
          {"top1", jsonOf(scores.top1)},
          {"top3", jsonOf(scores.top3)}};
}

std::string difference(const Interval& interval) {
  if (!std::isfinite(interval.low)) return "-";
  return fmt::format("{:+.3f} [{:+.3f}, {:+.3f}]", interval.mean, interval.low, interval.high);
}

double perMetre(std::size_t count, const WayTurnover& turnover) {
  return turnover.metres > 0.0 ? static_cast<double>(count) / turnover.metres : 0.0;
}

}  // namespace

std::string toTable(const Evaluation& e) {
  const std::size_t settled = e.samples - e.unsettled;
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  };
  std::string text = fmt::format(
      "{} walkers, {:.0f} m, horizon {:g} m{}\n"
      "On the navmesh: {:.1f} % of {} frames as they are, {:.1f} % moved onto it (by {:.2f} m at "
      "most), {:.1f} % not.\n"
      "Ways: {:.1f} a frame; per metre walked {:.3f} born, {:.3f} split off, {:.3f} died, {:.3f} "
      "merged.\n"
      "{} samples, {} of them not settled before the recording ends. The graph contained {:.1f} % "
      "of {} ways taken;\n"
      "{:.1f} % of those lie behind. None of the ways was given {:.3f} on average, and came true "
      "in "
      "{:.3f}.\n",
      e.walkers.size(), e.turnover.metres, e.horizon,
      e.folds ? ", each walker predicted by a fit on the others" : "",
      share(e.frames - e.snapped - e.offMesh, e.frames), e.frames, share(e.snapped, e.frames),
      e.worstSnap, share(e.offMesh, e.frames),
      static_cast<double>(e.turnover.ways) /
          static_cast<double>(std::max<std::size_t>(1, e.turnover.frames)),
      perMetre(e.turnover.births, e.turnover), perMetre(e.turnover.splits, e.turnover),
      perMetre(e.turnover.deaths, e.turnover), perMetre(e.turnover.merges, e.turnover), e.samples,
      e.unsettled, share(e.contained, settled), settled, 100.0 * e.behind, e.noneSaid,
      1.0 - share(e.contained, settled) / 100.0);
  for (const bool forward : {true, false}) {
    text += fmt::format("\n{} junctions: {} samples\n", forward ? "Forward" : "All",
                        forward ? e.forwardJunctions : e.junctions);
    text += fmt::format("{:<18} {:>6} {:>6} {:>6} {:>6}", "", "NLL", "Brier", "top-1", "top-3");
    text += forward ? "   likelihood minus this: NLL [95 %]     top-1 [95 %]\n"
                    : "   calibration  by direction\n";
    for (const GuessReport& g : e.guesses) {
      if (g.guess == Guess::kConstantVelocity) continue;
      const Scores& s = forward ? g.forward : g.all;
      text += fmt::format("{:<18} {:>6} {:>6} {:>6} {:>6}", nameOf(g.guess), number(s.nll),
                          number(s.brier), number(s.top1), number(s.top3));
      if (!forward) {
        text +=
            fmt::format("   {:>11} {:>13}\n", number(g.calibration), number(g.classCalibration));
      } else if (g.guess != Guess::kLikelihood) {
        text += fmt::format("   {:<26} {}\n", difference(g.nllDifference),
                            difference(g.top1Difference));
      } else {
        text += "\n";
      }
    }
  }
  text += "\nForward NLL by walker";
  for (const std::string& walker : e.walkers) text += fmt::format(" {:>7}", walker);
  text += "\n";
  for (const GuessReport& g : e.guesses) {
    if (g.guess == Guess::kConstantVelocity || g.guess == Guess::kLeastDeviation) continue;
    text += fmt::format("{:<21}", nameOf(g.guess));
    for (const Scores& s : g.forwardOfWalker) text += fmt::format(" {:>7}", number(s.nll));
    text += "\n";
  }
  text += fmt::format("\n{:<18}", "Off at the end, m");
  for (const double t : kSecondsAhead) text += fmt::format(" {:>5.1f}s", t);
  text += "   likelihood minus this at 3.2 s [95 %]\n";
  for (const GuessReport& g : e.guesses) {
    text += fmt::format("{:<18}", nameOf(g.guess));
    for (const double off : g.places.final) text += fmt::format(" {:>6}", number(off, 2));
    text += g.guess == Guess::kLikelihood ? "\n"
                                          : fmt::format("   {}\n", difference(g.finalDifference));
  }
  text += fmt::format("{:<18}", "Off on average, m");
  for (const double t : kSecondsAhead) text += fmt::format(" {:>5.1f}s", t);
  text += "\n";
  for (const GuessReport& g : e.guesses) {
    text += fmt::format("{:<18}", nameOf(g.guess));
    for (const double off : g.places.average) text += fmt::format(" {:>6}", number(off, 2));
    text += "\n";
  }
  text += fmt::format("{:<18}", "Off along, median");
  for (const double m : kMetresAhead) text += fmt::format(" {:>5.1f}m", m);
  text += "  mean";
  for (const double m : kMetresAhead) text += fmt::format(" {:>5.1f}m", m);
  text += "\n";
  for (const GuessReport& g : e.guesses) {
    text += fmt::format("{:<18}", nameOf(g.guess));
    for (const double off : g.places.alongMedian) text += fmt::format(" {:>6}", number(off, 2));
    text += "      ";
    for (const double off : g.places.along) text += fmt::format(" {:>6}", number(off, 2));
    text += "\n";
  }
  return text;
}

std::string toCsv(const Evaluation& e) {
  std::string csv = "guess,walker,horizon_m,forward_samples,nll,brier,top1,top3\n";
  const auto row = [&](const GuessReport& g, std::string walker, const Scores& s) {
    // Names come from a recording: quoted, so that a comma in one moves no column.
    std::string quoted;
    for (const char c : walker) quoted += c == '"' ? "\"\"" : std::string(1, c);
    csv += fmt::format("{},\"{}\",{:g},{},{},{},{},{}\n", nameOf(g.guess), quoted, e.horizon,
                       s.samples, number(s.nll, 6), number(s.brier, 6), number(s.top1, 6),
                       number(s.top3, 6));
  };
  for (const GuessReport& g : e.guesses) {
    if (g.guess == Guess::kConstantVelocity) continue;
    for (std::size_t w = 0; w < e.walkers.size(); ++w) row(g, e.walkers[w], g.forwardOfWalker[w]);
    row(g, "all", g.forward);
  }
  return csv;
}

std::string toJson(const Evaluation& e) {
  Json json;
  json["format"] = "forewalk.evaluation/1";
  json["horizon"] = e.horizon;
  json["folds"] = e.folds;
  json["walkers"] = e.walkers;
  json["frames"] = {{"count", e.frames},
                    {"snapped", e.snapped},
                    {"off_mesh", e.offMesh},
                    {"worst_snap", e.worstSnap}};
  json["samples"] = {
      {"count", e.samples},       {"unsettled", e.unsettled},      {"contained", e.contained},
      {"junctions", e.junctions}, {"forward", e.forwardJunctions}, {"behind", e.behind},
      {"none_said", e.noneSaid}};
  json["ways"] = {{"metres", e.turnover.metres}, {"frames", e.turnover.frames},
                  {"ways", e.turnover.ways},     {"births", e.turnover.births},
                  {"splits", e.turnover.splits}, {"deaths", e.turnover.deaths},
                  {"merges", e.turnover.merges}, {"returns", e.turnover.returns}};
  json["seconds_ahead"] = kSecondsAhead;
  json["metres_ahead"] = kMetresAhead;
  Json guesses = Json::array();
  for (const GuessReport& g : e.guesses) {
    Json one;
    one["name"] = nameOf(g.guess);
    if (g.guess != Guess::kConstantVelocity) {
      one["forward"] = jsonOf(g.forward);
      one["all"] = jsonOf(g.all);
      Json walkers = Json::array();
      for (std::size_t w = 0; w < e.walkers.size(); ++w) {
        Json walker = jsonOf(g.forwardOfWalker[w]);
        walker["walker"] = e.walkers[w];
        walkers.push_back(walker);
      }
      one["walkers"] = walkers;
      one["calibration"] = jsonOf(g.calibration);
      one["calibration_by_direction"] = jsonOf(g.classCalibration);
      Json bins = Json::array();
      for (const ReliabilityBin& bin : g.reliability) {
        bins.push_back({{"count", bin.count}, {"said", bin.said}, {"came", bin.came}});
      }
      one["reliability"] = bins;
      one["nll_difference"] = jsonOf(g.nllDifference);
      one["top1_difference"] = jsonOf(g.top1Difference);
    }
    one["final_displacement"] = g.places.final;
    one["average_displacement"] = g.places.average;
    one["along_mean"] = g.places.along;
    one["along_median"] = g.places.alongMedian;
    one["final_difference"] = jsonOf(g.finalDifference);
    guesses.push_back(one);
  }
  json["guesses"] = guesses;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string reliabilityPlot(const Evaluation& e) {
  LinePlot plot;
  plot.title = "What was said, and how often it came true";
  plot.subtitle = fmt::format("All ways at {} junctions, horizon {:g} m", e.junctions, e.horizon);
  plot.xName = "probability given to a way";
  plot.yName = "share that was taken";
  plot.series.push_back({"ideal", "#c3c9d0", {{0.0, 0.0}, {1.0, 1.0}}, true, false});
  for (std::size_t g = 0; g < e.guesses.size(); ++g) {
    if (e.guesses[g].guess != Guess::kCosine && e.guesses[g].guess != Guess::kLikelihood) continue;
    PlotSeries series{nameOf(e.guesses[g].guess), kColours[g], {}};
    for (const ReliabilityBin& bin : e.guesses[g].reliability) {
      if (bin.count > 0) series.points.emplace_back(bin.said, bin.came);
    }
    plot.notes.push_back(fmt::format("{}: expected calibration error {}",
                                     nameOf(e.guesses[g].guess), number(e.guesses[g].calibration)));
    plot.series.push_back(std::move(series));
  }
  return toSvg(plot);
}

std::string displacementPlot(const Evaluation& e) {
  LinePlot plot;
  plot.title = "How far off the predicted place is";
  plot.subtitle = fmt::format("{} samples, horizon {:g} m", e.samples, e.horizon);
  plot.xName = "seconds ahead";
  plot.yName = "mean distance, m";
  for (std::size_t g = 0; g < e.guesses.size(); ++g) {
    PlotSeries series{nameOf(e.guesses[g].guess), kColours[g], {{0.0, 0.0}}};
    for (std::size_t t = 0; t < kSecondsAhead.size(); ++t) {
      series.points.emplace_back(kSecondsAhead[t], e.guesses[g].places.final[t]);
    }
    plot.series.push_back(std::move(series));
  }
  return toSvg(plot);
}

std::string scorePlot(const Evaluation& e) {
  BarPlot plot;
  plot.title = "Which way is taken: negative log-likelihood";
  plot.subtitle =
      fmt::format("{} samples at forward junctions, horizon {:g} m", e.forwardJunctions, e.horizon);
  plot.yName = "nats, less is better";
  std::vector<const GuessReport*> shown;
  for (std::size_t g = 0; g < e.guesses.size(); ++g) {
    const Guess guess = e.guesses[g].guess;
    if (guess == Guess::kConstantVelocity || guess == Guess::kLeastDeviation) continue;
    plot.barNames.emplace_back(nameOf(guess));
    plot.colours.emplace_back(kColours[g]);
    shown.push_back(&e.guesses[g]);
  }
  const auto group = [&](const std::string& name, const auto& scoresOf) {
    BarGroup bars{name, {}};
    for (const GuessReport* g : shown) {
      const double nll = scoresOf(*g).nll;
      bars.values.push_back(std::isfinite(nll) ? nll : 0.0);
    }
    plot.groups.push_back(std::move(bars));
  };
  for (std::size_t w = 0; w < e.walkers.size(); ++w) {
    group(e.walkers[w], [w](const GuessReport& g) { return g.forwardOfWalker[w]; });
  }
  group("all", [](const GuessReport& g) { return g.forward; });
  return toSvg(plot);
}

}  // namespace forewalk::service
