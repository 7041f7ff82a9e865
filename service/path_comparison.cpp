#include "service/path_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "agents/evaluation/dtw.h"
#include "navmesh/file_text.h"
#include "rdw/walk_file.h"
#include "service/files.h"
#include "service/parallel.h"

namespace forewalk::service {
namespace {

constexpr double kMostPoints = 1e6;  // of a resampled path
constexpr const char* kModel = "model";

tl::unexpected<Error> refused(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

bool isModel(const std::string& name) {
  return std::equal(name.begin(), name.end(), kModel,
                    kModel + std::char_traits<char>::length(kModel),
                    [](unsigned char a, char b) { return std::tolower(a) == b; });
}

// Files by their stems; where two have the same, with their folder; else as given.
std::vector<std::string> labelsOf(const std::vector<std::string>& files) {
  const auto stem = [](const std::string& file) {
    return std::filesystem::path(file).stem().string();
  };
  const auto withFolder = [&](const std::string& file) {
    const std::string folder = std::filesystem::path(file).parent_path().filename().string();
    return folder.empty() ? stem(file) : folder + "/" + stem(file);
  };
  std::map<std::string, int> stems, folders;
  for (const std::string& file : files) {
    ++stems[stem(file)];
    ++folders[withFolder(file)];
  }
  std::vector<std::string> labels;
  for (const std::string& file : files) {
    labels.push_back(stems[stem(file)] == 1           ? stem(file)
                     : folders[withFolder(file)] == 1 ? withFolder(file)
                                                      : file);
  }
  return labels;
}

// A few names, for a message.
std::string someOf(const std::vector<ComparedPath>& paths) {
  constexpr std::size_t kShown = 6;
  std::string some;
  for (std::size_t i = 0; i < std::min(kShown, paths.size()); ++i) {
    some += (i > 0 ? ", " : "") + inQuotes(paths[i].name);
  }
  return paths.size() > kShown ? fmt::format("{}, ... ({} in all)", some, paths.size()) : some;
}

// The paths that `mention` means.
tl::expected<std::vector<std::size_t>, Error> find(const std::vector<ComparedPath>& paths,
                                                   const std::string& mention) {
  std::vector<std::size_t> named, inFile, walkers;
  std::set<std::string> files;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const ComparedPath& path = paths[i];
    if (path.name == mention) named.push_back(i);
    if (!path.file.empty() && (path.file == mention || path.label == mention)) inFile.push_back(i);
    if (!path.walker.empty() && path.walker == mention) {
      walkers.push_back(i);
      files.insert(path.file);
    }
  }
  if (!named.empty()) return named;
  if (!inFile.empty()) return inFile;
  if (files.size() > 1) {
    return refused(fmt::format("{} walks in {} files; say which, as in {}.", inQuotes(mention),
                               files.size(), inQuotes(paths[walkers.front()].name)));
  }
  if (!walkers.empty()) return walkers;
  return refused(fmt::format("{} is no path, file or walker here; there are {}.", inQuotes(mention),
                             someOf(paths)));
}

std::vector<GroupMentions::Group> groupsToMake(const std::vector<ComparedPath>& paths,
                                               const GroupMentions& mentions, std::string& people) {
  std::vector<GroupMentions::Group> made;
  if (!mentions.model.empty()) made.push_back({kModel, mentions.model});
  made.insert(made.end(), mentions.groups.begin(), mentions.groups.end());
  if (!made.empty()) return made;

  GroupMentions::Group model{kModel, {}};
  std::vector<std::string> labels;
  for (const ComparedPath& path : paths) {
    if (isModel(path.name) || isModel(path.walker)) model.members.push_back(path.name);
    if (labels.empty() || labels.back() != path.label) labels.push_back(path.label);
  }
  if (!model.members.empty()) return {model};
  if (labels.size() > 1) people = labels.front();
  for (std::size_t i = 1; i < labels.size(); ++i) made.push_back({labels[i], {labels[i]}});
  return made;
}

OneWayTests testsOf(agents::Groups samples, double confidence) {
  OneWayTests tests;
  tests.anova = agents::anova(samples);
  tests.levene = agents::levene(samples);
  tests.leveneMedian = agents::levene(samples, agents::Centre::kMedian);
  tests.welch = agents::welch(samples);
  tests.brownForsythe = agents::brownForsythe(samples);
  tests.tukey = agents::tukeyHsd(samples, confidence);
  tests.gamesHowell = agents::gamesHowell(samples, confidence);
  return tests;
}

}  // namespace

tl::expected<std::vector<ComparedPath>, Error> readPaths(const std::vector<std::string>& files) {
  const std::vector<std::string> labels = labelsOf(files);
  std::vector<ComparedPath> paths;
  std::set<std::string> names;
  for (std::size_t f = 0; f < files.size(); ++f) {
    for (std::size_t before = 0; before < f; ++before) {
      if (files[before] == files[f]) {
        return refused(fmt::format(
            "{} is given twice; its paths would be compared with themselves.", files[f]));
      }
    }
    const auto bytes = readFile(files[f]);
    if (!bytes) return tl::unexpected(bytes.error());
    auto walks = rdw::parseWalks(*bytes, files[f], rdw::WalkTimes::kOptional);
    if (!walks) return tl::unexpected(std::move(walks.error()));
    for (rdw::Walk& walk : *walks) {
      ComparedPath path{{}, files[f], labels[f], std::move(walk.walker), {}};
      path.name = path.walker.empty() ? path.label
                  : files.size() == 1 ? path.walker
                                      : path.label + ":" + path.walker;
      // Whoever calls a file "a:b" beside a walker b of "a" still gets two names.
      while (!names.insert(path.name).second) path.name += "'";
      for (const rdw::WalkSample& sample : walk.samples) path.points.push_back(sample.plan);
      paths.push_back(std::move(path));
    }
    if (paths.size() > kMostPaths) {
      return tl::unexpected(Error{ErrorCode::kTooLarge,
                                  fmt::format("{}: up to here there are {} paths, {} at most are "
                                              "compared; leave some out.",
                                              files[f], paths.size(), kMostPaths)});
    }
  }
  return paths;
}

tl::expected<std::vector<PathGroup>, Error> groupPaths(const std::vector<ComparedPath>& paths,
                                                       const GroupMentions& mentions) {
  std::vector<PathGroup> groups{{"people", {}}};
  std::vector<std::size_t> groupOf(paths.size(), 0);
  const auto toMake = groupsToMake(paths, mentions, groups.front().name);
  for (const GroupMentions::Group& group : toMake) {
    for (const PathGroup& other : groups) {
      if (other.name == group.name) {
        return refused(fmt::format("two groups are named {}; whoever is in no group is in \"{}\".",
                                   inQuotes(group.name), groups.front().name));
      }
    }
    groups.push_back({group.name, {}});
    for (const std::string& mention : group.members) {
      const auto found = find(paths, mention);
      if (!found) return tl::unexpected(found.error());
      for (const std::size_t path : *found) {
        if (groupOf[path] != 0 && groupOf[path] + 1 != groups.size()) {
          return refused(fmt::format("{} is put in two groups, {} and {}.",
                                     inQuotes(paths[path].name),
                                     inQuotes(groups[groupOf[path]].name), inQuotes(group.name)));
        }
        groupOf[path] = groups.size() - 1;
      }
    }
  }
  for (std::size_t path = 0; path < paths.size(); ++path) {
    groups[groupOf[path]].paths.push_back(path);
  }
  if (groups.front().paths.size() < 2) {
    return refused(
        fmt::format("{} of {} paths are left as people (group \"{}\"); two are needed. Name fewer "
                    "models, or give "
                    "more recordings.",
                    groups.front().paths.size(), paths.size(), groups.front().name));
  }
  return groups;
}

tl::expected<std::vector<NamedTable>, Error> tablesOf(const std::vector<ComparedPath>& paths,
                                                      const ComparisonSettings& settings,
                                                      const ComparisonProgress& progress) {
  using Points = std::vector<std::vector<glm::dvec2>>;
  Points raw, even;
  for (const ComparedPath& path : paths) {
    if (settings.raw) raw.push_back(path.points);
    if (!settings.normalised) continue;
    const double length = agents::pathLength(path.points);
    if (length / settings.spacing > kMostPoints) {
      return refused(fmt::format(
          "path {} is {:.6g} m long, more than {:g} points at a spacing of {:g} m; give a spacing "
          "of "
          "{:.2g} m or more.",
          inQuotes(path.name), length, kMostPoints, settings.spacing, 1.1 * length / kMostPoints));
    }
    even.push_back(agents::resampleByLength(path.points, settings.spacing));
  }

  struct Job {
    const Points* points;
    std::size_t table, i, j;
    std::size_t cells() const { return (*points)[i].size() * (*points)[j].size(); }
  };
  std::vector<NamedTable> tables;
  std::vector<Job> jobs;
  std::size_t total = 0;
  for (const auto& [name, points] : {std::pair("raw", &raw), std::pair("normalised", &even)}) {
    if (points->empty()) continue;
    tables.push_back({name, agents::makeDistanceTable(paths.size())});
    for (std::size_t i = 0; i < paths.size(); ++i) {
      for (std::size_t j = i + 1; j < paths.size(); ++j) {
        jobs.push_back({points, tables.size() - 1, i, j});
        total += jobs.back().cells();
      }
    }
  }
  std::mutex reporting;
  std::size_t done = 0;
  onThreads(settings.threads)(jobs.size(), [&](std::size_t k) {
    const Job& job = jobs[k];
    const auto& a = (*job.points)[job.i];
    const auto& b = (*job.points)[job.j];
    double distance = agents::dtw(a, b);
    if (job.points == &even) distance /= 0.5 * static_cast<double>(a.size() + b.size());
    agents::DistanceTable& table = tables[job.table].table;
    table.at(job.i, job.j) = table.at(job.j, job.i) = distance;
    if (!progress) return;
    const std::lock_guard lock(reporting);
    done += job.cells();
    progress(done, total);
  });
  return tables;
}

PathComparison comparePaths(std::vector<ComparedPath> paths, std::vector<PathGroup> groups,
                            std::vector<NamedTable> tables, const ComparisonSettings& settings) {
  PathComparison comparison;
  comparison.confidence = settings.confidence;
  const bool fromFiles = !paths.empty() && !paths.front().points.empty();
  if (fromFiles && settings.normalised) comparison.spacing = settings.spacing;
  for (NamedTable& named : tables) {
    TableComparison one;
    one.name = std::move(named.name);
    if (fromFiles) one.unit = one.name == "raw" ? "m x samples" : "m";
    one.table = std::move(named.table);
    one.meanToPeople = agents::meanDistancesTo(one.table, groups.front().paths);
    for (std::size_t g = 1; g < groups.size(); ++g) {
      one.separations.push_back(agents::separation(one.table, groups.front().paths, groups[g].paths,
                                                   settings.separation));
    }
    one.columns = testsOf(agents::columnsOf(one.table), settings.confidence);
    std::vector<std::vector<double>> samples;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (groups[g].paths.size() < 2) continue;
      one.tested.push_back(g);
      samples.emplace_back();
      for (const std::size_t path : groups[g].paths)
        samples.back().push_back(one.meanToPeople[path]);
    }
    if (samples.size() >= 2) one.groups = testsOf(samples, settings.confidence);
    comparison.tables.push_back(std::move(one));
  }
  comparison.paths = std::move(paths);
  comparison.groups = std::move(groups);
  return comparison;
}

}  // namespace forewalk::service
