#include "service/experiment/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "rdw/simulation.h"
#include "rdw/simulation_config.h"
#include "service/experiment/run_quality.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/walk_plan.h"

namespace forewalk::service {
namespace {

/// "3, 7 to 12 and 40": the first few of ascending numbers.
std::string ranges(const std::vector<std::size_t>& numbers) {
  std::string text;
  std::size_t said = 0;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (said == 5) return text + fmt::format(" and {} more", numbers.size() - i);
    if (said++ > 0) text += ", ";
    text += i == last ? fmt::format("{}", numbers[i])
                      : fmt::format("{} to {}", numbers[i], numbers[last]);
    i = last + 1;
  }
  return text;
}

/// Appends rows to a file, one write each.
class RowWriter {
 public:
  /// Cuts the file to its first `soundBytes`.
  static tl::expected<std::unique_ptr<RowWriter>, Error> open(const std::filesystem::path& file,
                                                              std::uintmax_t soundBytes) {
    auto writer = std::unique_ptr<RowWriter>(new RowWriter(file));
    std::error_code problem;
    if (std::filesystem::exists(file)) std::filesystem::resize_file(file, soundBytes, problem);
    errno = problem.value();
    if (!problem) writer->file_.reset(std::fopen(file.c_str(), "ab"));
    if (writer->file_ == nullptr) return tl::unexpected(writer->reason());
    return writer;
  }

  tl::expected<void, Error> add(const Row& row) {
    const std::string line = lineOf(row);
    errno = 0;
    const bool written = std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size() &&
                         std::fflush(file_.get()) == 0;
    if (!written) return tl::unexpected(reason());
    return {};
  }

 private:
  explicit RowWriter(std::filesystem::path name) : name_(std::move(name)) {}

  Error reason() const {
    return {
        ErrorCode::kFileUnwritable,
        fmt::format("{}: cannot be written ({}); what is done is kept, start again once it can.",
                    name_.string(), std::strerror(errno))};
  }

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path name_;
  std::unique_ptr<std::FILE, Close> file_;
};

Row failedRow(std::size_t run, std::string reason) {
  Row row;
  row.run = run;
  row.end = "failed";
  row.reason = std::move(reason);
  return row;
}

/// A folder that holds rows already must hold those of this experiment.
tl::expected<void, Error> checkFolder(const std::filesystem::path& folder,
                                      const Manifest& manifest) {
  if (!std::filesystem::exists(folder / "manifest.json")) {
    return writeFile(folder / "manifest.json", manifestJson(manifest));
  }
  const auto there = readManifest(folder);
  if (!there) return tl::unexpected(there.error());
  const auto refuse = [&](const std::string& what) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format("{}: holds results of {}; give another folder, or remove this one.",
                          folder.string(), what)});
  };
  if (there->plan != manifest.plan) return refuse("another plan");
  if (there->version != manifest.version) {
    return refuse(fmt::format("version {}, this is {}", there->version, manifest.version));
  }
  if (!(*there == manifest)) return refuse("the same plan with other scenes, rooms or recordings");
  if (there->shard != manifest.shard || there->shards != manifest.shards) {
    return refuse(fmt::format("shard {} of {}", there->shard, there->shards));
  }
  return {};
}

}  // namespace

tl::expected<Experiment, Error> Experiment::load(const std::filesystem::path& file,
                                                 const navmesh::BuildRun& run) {
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto plan = parseExperiment(*bytes, file.string());
  if (!plan) return tl::unexpected(plan.error());
  Experiment experiment;
  experiment.plan_ = std::move(*plan);
  experiment.file_ = file;
  experiment.loader_ = std::make_shared<SimulationLoader>(run);

  // A first frame of everything that has something to do with one another, so that a slip shows
  // before hours are spent. Controllers take their time to prepare, and so are tried once a scene.
  const auto count = [&](Axis axis) {
    return experiment.plan_.choices[static_cast<std::size_t>(axis)].size();
  };
  const auto at = [](std::array<std::size_t, kAxes>& chosen, Axis axis) -> std::size_t& {
    return chosen[static_cast<std::size_t>(axis)];
  };
  std::array<std::size_t, kAxes> chosen{};
  const auto forEachOf = [&](Axis axis, auto&& visit) -> tl::expected<void, Error> {
    for (at(chosen, axis) = 0; at(chosen, axis) < count(axis); ++at(chosen, axis)) {
      if (auto sound = visit(); !sound) return sound;
    }
    at(chosen, axis) = 0;
    return {};
  };
  const auto places = [&] { return experiment.tryOut(chosen, false); };
  const auto steering = [&] { return experiment.tryOut(chosen, true); };
  auto sound =
      forEachOf(
          Axis::kScene,
          [&] { return forEachOf(Axis::kUser, [&] { return forEachOf(Axis::kRoom, places); }); })
          .and_then([&] {
            return forEachOf(Axis::kScene, [&] { return forEachOf(Axis::kController, steering); });
          })
          .and_then([&] { return forEachOf(Axis::kLimits, places); })
          .and_then([&] { return forEachOf(Axis::kReset, places); })
          .and_then([&] {
            return forEachOf(Axis::kVariant, [&] { return forEachOf(Axis::kScene, steering); });
          });
  if (!sound) return tl::unexpected(sound.error());
  return experiment;
}

std::string Experiment::namesOf(const std::array<std::size_t, kAxes>& chosen) const {
  std::string names;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const Choice& choice = plan_.choices[axis][chosen[axis]];
    if (choice.name.empty()) continue;
    if (!names.empty()) names += ", ";
    names += fmt::format("{} {}", nameOf(static_cast<Axis>(axis)), choice.name);
  }
  return names;
}

tl::expected<LoadedSimulation, Error> Experiment::load(const std::array<std::size_t, kAxes>& chosen,
                                                       std::uint64_t seed) const {
  nlohmann::json simulation = plan_.simulationOf(chosen);
  simulation["seed"] = seed;
  const std::string text = simulation.dump();
  const std::string name = fmt::format("{} ({})", file_.string(), namesOf(chosen));
  const auto file =
      rdw::parseSimulation({reinterpret_cast<const std::byte*>(text.data()), text.size()}, name);
  if (!file) return tl::unexpected(file.error());
  return loader_->load(*file, file_.parent_path(), name);
}

tl::expected<LoadedSimulation, Error> Experiment::simulation(std::size_t run) const {
  return load(plan_.choicesOf(run), plan_.seedOf(run));
}

tl::expected<void, Error> Experiment::check(const LoadedSimulation& loaded,
                                            const std::array<std::size_t, kAxes>& chosen) const {
  const auto refuse = [&](const std::string& what) {
    return tl::unexpected(Error{ErrorCode::kSettingOutOfRange,
                                fmt::format("{} ({}): {}", file_.string(), namesOf(chosen), what)});
  };
  std::vector<const rdw::SimulationConfig*> users{&loaded.config};
  for (const rdw::SimulationConfig& other : loaded.others) users.push_back(&other);
  for (const rdw::SimulationConfig* user : users) {
    const double clearance = user->session.space.clearance();
    if (clearance >= kBodyRadius) continue;
    return refuse(
        fmt::format("the room is nowhere more than {:.2f} m from a wall or obstacle, a "
                    "body needs {:.2f} m; take a larger room.",
                    clearance, kBodyRadius));
  }
  const rdw::TrackedSpace& space = loaded.config.session.space;
  const auto& start = loaded.config.start.physical;
  if (start && loaded.others.empty() && !space.contains(start->position)) {
    return refuse(
        fmt::format("physical_start ({:.2f}, {:.2f}) lies outside the room, or in an "
                    "obstacle, by {:.2f} m.",
                    start->position.x, -start->position.y, -space.signedDistance(start->position)));
  }
  return {};
}

tl::expected<void, Error> Experiment::tryOut(const std::array<std::size_t, kAxes>& chosen,
                                             bool withController) const {
  auto loaded = load(chosen, plan_.seeds.front());
  if (!loaded) return tl::unexpected(loaded.error());
  if (auto sound = check(*loaded, chosen); !sound) return sound;
  rdw::SimulationConfig& config = loaded->config;
  if (!withController) config.session.controller = rdw::controllerNames().front();
  config.keepFrames = false;
  for (rdw::SimulationConfig& other : loaded->others) {
    other.session.controller = config.session.controller;
    other.keepFrames = false;
  }
  const rdw::SimulationRun first{{}, {}, [] { return true; }, nullptr};  // ends after a frame
  if (const auto walked = simulateAll(*loaded, first); !walked) {
    return tl::unexpected(
        Error{walked.error().code,
              fmt::format("{} ({}): {}", file_.string(), namesOf(chosen), walked.error().message)});
  }
  return {};
}

tl::expected<void, Error> Experiment::writeTraces(
    const std::filesystem::path& folder, std::size_t run, const LoadedSimulation& loaded,
    std::span<const rdw::SimulationResult> results) const {
  const auto chosen = plan_.choicesOf(run);
  const std::string& title =
      plan_.choice(Axis::kController, chosen[static_cast<std::size_t>(Axis::kController)]).name;
  for (std::size_t user = 0; user < results.size(); ++user) {
    const rdw::SimulationResult& result = results[user];
    const std::string stem = traceStem(plan_, run, user);
    const std::string subtitle = fmt::format(
        "{}{}; seed {}: {:.0f} m, {} resets", namesOf(chosen),
        results.size() > 1 ? fmt::format(", the {} of {}", user + 1, results.size()) : "",
        plan_.seedOf(run), result.summary.virtualMetres, result.summary.resets);
    const rdw::SimulationConfig& config = user == 0 ? loaded.config : loaded.others[user - 1];
    // Times differ from one run to the next: timing.csv has them, the traces are the same bytes.
    std::vector<rdw::FrameRecord> frames = result.frames;
    for (rdw::FrameRecord& frame : frames) {
      frame.predictMicroseconds = frame.steerMicroseconds = frame.frameMicroseconds = 0.0;
    }
    auto written = writeFile(folder / (stem + ".csv"), rdw::traceCsv(frames)).and_then([&] {
      return writeFile(folder / (stem + "-room.svg"),
                       physicalPlan(config.session.space, result.frames, title, subtitle));
    });
    if (written && loaded.world != nullptr) {
      written = writeFile(folder / (stem + "-building.svg"),
                          virtualPlan(loaded.world->graph, result.frames, title, subtitle));
    }
    if (!written) return written;
  }
  return {};
}

tl::expected<Row, Error> Experiment::walk(std::size_t run, const CampaignSettings& settings,
                                          const std::function<bool()>& interrupted,
                                          std::optional<Error>& unwritable) const {
  auto loaded = simulation(run);
  if (!loaded) return tl::unexpected(loaded.error());
  if (auto sound = check(*loaded, plan_.choicesOf(run)); !sound) {
    return tl::unexpected(sound.error());
  }
  const rdw::SimulationRun how{settings.microseconds, {}, interrupted, nullptr};
  const auto results = simulateAll(*loaded, how);
  if (!results) return tl::unexpected(results.error());
  const auto isInterrupted = [](const rdw::SimulationResult& result) {
    return result.summary.end == rdw::WalkEnd::kInterrupted;
  };
  Row row;
  if (std::any_of(results->begin(), results->end(), isInterrupted)) return row;
  const bool traced =
      plan_.traces == Traces::kAll || (plan_.traces == Traces::kFirst && plan_.isFirstSeed(run));
  if (traced) {
    if (auto written = writeTraces(settings.out / "traces", run, *loaded, *results); !written) {
      unwritable = written.error();
      return row;
    }
  }
  std::vector<const rdw::SimulationConfig*> users{&loaded->config};
  for (const rdw::SimulationConfig& other : loaded->others) users.push_back(&other);
  std::vector<const rdw::TrackedSpace*> spaces;
  for (const rdw::SimulationConfig* user : users) spaces.push_back(&user->session.space);
  row = rowOf(run, *results, spaces);
  if (plan_.quality == QualityOf::kNone || loaded->world == nullptr) return row;
  for (std::size_t i = 0; i < users.size(); ++i) {
    if (plan_.quality != QualityOf::kAll && !looksAhead(*users[i])) continue;
    setQuality(qualityOf(*loaded->world, *users[i], (*results)[i]), row.users[i]);
  }
  together(row);
  return row;
}

tl::expected<Manifest, Error> Experiment::manifest(const CampaignSettings& settings) const {
  Manifest manifest;
  manifest.version = settings.version;
  manifest.plan = plan_.text;
  manifest.runs = plan_.runCount();
  manifest.shard = settings.shard;
  manifest.shards = settings.shards;
  for (const std::filesystem::path& file : loader_->files()) {
    const auto bytes = readFile(file);
    if (!bytes) return tl::unexpected(bytes.error());
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    const std::filesystem::path beside = file.lexically_relative(file_.parent_path());
    manifest.inputs.push_back(
        {beside.empty() ? file.string() : beside.string(), contentHash(text)});
  }
  std::array<std::size_t, kAxes> chosen{};
  std::size_t& room = chosen[static_cast<std::size_t>(Axis::kRoom)];
  for (; room < plan_.choices[static_cast<std::size_t>(Axis::kRoom)].size(); ++room) {
    RoomOutline& outline = manifest.rooms.emplace_back();
    outline.name = plan_.choice(Axis::kRoom, room).name;
    const auto loaded = load(chosen, plan_.seeds.front());
    if (!loaded) return tl::unexpected(loaded.error());
    const rdw::TrackedSpace& space = loaded->config.session.space;
    for (std::size_t ring = 0; ring < space.ringCount(); ++ring) {
      outline.rings.emplace_back(space.ring(ring).begin(), space.ring(ring).end());
    }
  }
  return manifest;
}

tl::expected<CampaignEnd, Error> Experiment::carryOut(const CampaignSettings& settings) const {
  const auto manifest = this->manifest(settings);
  if (!manifest) return tl::unexpected(manifest.error());
  if (auto sound = checkFolder(settings.out, *manifest); !sound) {
    return tl::unexpected(sound.error());
  }
  auto log = readRows(settings.out);
  if (!log) return tl::unexpected(log.error());
  auto writer = RowWriter::open(settings.out / "rows.jsonl", log->soundBytes);
  if (!writer) return tl::unexpected(writer.error());

  CampaignEnd end;
  std::set<std::size_t> there;
  const auto count = [&](const Row& row) {
    ++end.done;
    end.failed += row.failed() ? 1 : 0;
    end.stuck += row.end == rdw::nameOf(rdw::WalkEnd::kStuck) ? 1 : 0;
  };
  for (const Row& row : log->rows) {
    there.insert(row.run);
    count(row);
  }
  end.before = end.done;
  std::vector<std::size_t> left;
  for (std::size_t run = settings.shard - 1; run < manifest->runs; run += settings.shards) {
    ++end.total;
    if (!there.contains(run)) left.push_back(run);
  }

  constexpr std::uintmax_t kBytesARun = 8192;  // of its row and its lines in the tables, generously
  if (auto room = checkSpace(settings.out, left.size() * kBytesARun); !room) {
    return tl::unexpected(room.error());
  }

  std::mutex mutex;
  std::atomic<bool> stop = false;
  std::optional<Error> unwritable;
  const auto interrupted = [&] {
    return stop.load() || (settings.interrupted && settings.interrupted());
  };
  onThreads(settings.threads)(left.size(), [&](std::size_t i) {
    if (interrupted()) return;
    std::optional<Error> problem;
    tl::expected<Row, Error> row;
    try {
      row = walk(left[i], settings, interrupted, problem);
    } catch (const std::exception& thrown) {
      row = failedRow(left[i], thrown.what());
    }
    if (!row) row = failedRow(left[i], row.error().message);
    const std::lock_guard lock(mutex);
    if (problem && !unwritable) unwritable = problem;
    if (unwritable) {
      stop = true;
      return;
    }
    if (row->end.empty()) return;  // interrupted
    if (auto written = (*writer)->add(*row); !written) {
      unwritable = written.error();
      stop = true;
      return;
    }
    count(*row);
    if (settings.progress) settings.progress(end.done, end.total);
  });
  if (unwritable) return tl::unexpected(*unwritable);
  if (!end.finished() || settings.shards > 1) return end;
  log = readRows(settings.out);
  if (!log) return tl::unexpected(log.error());
  if (auto written = writeTables(settings.out, plan_, log->rows); !written) {
    return tl::unexpected(written.error());
  }
  return end;
}

tl::expected<Results, Error> mergeShards(std::span<const std::filesystem::path> folders,
                                         const std::filesystem::path& out) {
  std::optional<Results> merged;
  std::map<std::size_t, std::pair<Row, std::size_t>> rows;  // with the folder it came from
  for (std::size_t f = 0; f < folders.size(); ++f) {
    auto part = readResults(folders[f]);
    if (!part) return tl::unexpected(part.error());
    if (merged && !(part->manifest == merged->manifest)) {
      return tl::unexpected(
          Error{ErrorCode::kDataDamaged,
                fmt::format("{} and {}: belong to different experiments (plan, version or files).",
                            folders[0].string(), folders[f].string())});
    }
    for (const Row& row : part->rows) {
      const auto [known, isNew] = rows.try_emplace(row.run, row, f);
      if (!isNew) {
        return tl::unexpected(
            Error{ErrorCode::kDataDamaged,
                  fmt::format("run {} is both in {} and in {}, {}; leave one of them out.", row.run,
                              folders[known->second.second].string(), folders[f].string(),
                              known->second.first.sameAs(row) ? "with the same results"
                                                              : "with different results")});
      }
    }
    if (!merged) merged = std::move(*part);
  }
  const Manifest& manifest = merged->manifest;
  std::vector<std::size_t> missing;
  std::set<std::size_t> shards;
  for (std::size_t run = 0; run < manifest.runs; ++run) {
    if (rows.contains(run)) continue;
    missing.push_back(run);
    shards.insert(run % manifest.shards + 1);
  }
  if (!missing.empty()) {
    const std::vector<std::size_t> numbers(shards.begin(), shards.end());
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged,
              fmt::format("{} of {} runs are missing: {} (shard {} of {}); finish them and merge "
                          "again.",
                          missing.size(), manifest.runs, ranges(missing), ranges(numbers),
                          manifest.shards)});
  }
  merged->manifest.shard = merged->manifest.shards = 1;
  merged->rows.clear();
  std::string lines;
  for (const auto& [run, row] : rows) {
    merged->rows.push_back(row.first);
    lines += lineOf(row.first);
  }
  auto written = writeFile(out / "manifest.json", manifestJson(merged->manifest))
                     .and_then([&] { return writeFile(out / "rows.jsonl", lines); })
                     .and_then([&] { return writeTables(out, merged->plan, merged->rows); });
  if (!written) return tl::unexpected(written.error());
  for (const std::filesystem::path& folder : folders) {
    if (!std::filesystem::is_directory(folder / "traces")) continue;
    std::error_code problem;
    std::filesystem::copy(folder / "traces", out / "traces",
                          std::filesystem::copy_options::overwrite_existing |
                              std::filesystem::copy_options::recursive,
                          problem);
    if (problem) {
      return tl::unexpected(
          Error{ErrorCode::kFileUnwritable,
                fmt::format("{}: cannot be copied to {} ({}).", (folder / "traces").string(),
                            out.string(), problem.message())});
    }
  }
  return std::move(*merged);
}

}  // namespace forewalk::service
