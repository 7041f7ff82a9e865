#include "service/crowd_files.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "navmesh/plan.h"
#include "prediction/plan_drawing.h"
#include "service/files.h"
#include "service/plot.h"
#include "service/timing.h"

namespace forewalk::service {
namespace {

using Ring = std::vector<glm::dvec2>;

double areaOf(const Ring& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

bool inside(const Ring& ring, glm::dvec2 point) {
  bool in = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    if ((a.y > point.y) != (b.y > point.y) &&
        point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) {
      in = !in;
    }
  }
  return in;
}

/// Closed rows of standing walls, and circles as polygons of 32 corners, clockwise.
std::vector<Ring> ringsOf(std::span<const agents::Wall> walls) {
  std::vector<Ring> rings;
  std::vector<char> seen(walls.size(), 0);
  for (std::uint32_t first = 0; first < walls.size(); ++first) {
    const agents::Wall& wall = walls[first];
    if (seen[first] || wall.velocity != glm::vec2(0.0f)) continue;
    Ring ring;
    if (wall.isCircle()) {
      for (int k = 0; k < 32; ++k) {
        const double angle = -2.0 * 3.14159265358979323846 * k / 32.0;
        ring.push_back(glm::dvec2(wall.from) - static_cast<double>(wall.clearance) *
                                                   glm::dvec2(std::cos(angle), std::sin(angle)));
      }
    } else {
      std::uint32_t at = first;
      while (at != agents::kNoWall && !seen[at]) {
        seen[at] = 1;
        ring.push_back(walls[at].from);
        at = walls[at].next;
      }
      if (at != first) continue;  // a loose end
    }
    if (std::abs(areaOf(ring)) > 1e-6) rings.push_back(std::move(ring));
  }
  return rings;
}

std::string textOf(const Ring& ring) {
  std::string text = "(";
  for (const glm::dvec2 corner : ring) text += fmt::format("{:.6g} {:.6g}, ", corner.x, corner.y);
  return text + fmt::format("{:.6g} {:.6g})", ring[0].x, ring[0].y);
}

prediction::PlanBounds boundsOf(const CrowdRecording& recording) {
  prediction::PlanBounds bounds;
  for (const CrowdSample& sample : recording.samples) bounds.add(glm::dvec2(sample.plan));
  if (bounds.empty()) bounds.add(glm::dvec2(0.0));
  return bounds;
}

/// Within SQLite's signed 64 bits.
std::int64_t hashOf(std::string_view text) {
  return static_cast<std::int64_t>(contentHash(text) >> 1);
}

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

/// The open file; after something failed, nothing more is done.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) : file_(file) {
    sqlite3* opened = nullptr;
    code_ = sqlite3_open(file.string().c_str(), &opened);
    database_.reset(opened);
  }

  void run(const std::string& sql) {
    if (code_ == SQLITE_OK) {
      code_ = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
    }
  }

  /// Runs one statement `count` times; bind(statement, row) sets its values.
  template <typename Bind>
  void insert(const char* sql, std::size_t count, const Bind& bind) {
    if (code_ != SQLITE_OK) return;
    sqlite3_stmt* prepared = nullptr;
    code_ = sqlite3_prepare_v2(database_.get(), sql, -1, &prepared, nullptr);
    const std::unique_ptr<sqlite3_stmt, FinishStatement> statement(prepared);
    for (std::size_t row = 0; row < count && code_ == SQLITE_OK; ++row) {
      bind(prepared, row);
      const int stepped = sqlite3_step(prepared);
      code_ = stepped == SQLITE_DONE ? sqlite3_reset(prepared) : stepped;
    }
  }

  tl::expected<void, Error> done() const {
    if (code_ == SQLITE_OK) return {};
    return tl::unexpected(
        Error{ErrorCode::kFileUnwritable,
              fmt::format("{}: the database cannot be written: {}.", file_.string(),
                          database_ ? sqlite3_errmsg(database_.get()) : sqlite3_errstr(code_))});
  }

 private:
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  int code_ = SQLITE_OK;
};

}  // namespace

std::string trajectoriesCsv(const CrowdRecording& recording, const CrowdConfig& config) {
  std::string csv = "walker_id,t,x,z,y,heading,group\n";
  for (std::size_t frame = 0; frame < recording.frames(); ++frame) {
    for (std::uint32_t agent = 0; agent < recording.agents; ++agent) {
      const CrowdSample& sample = recording.at(frame, agent);
      std::string group = config.groups[recording.group[agent]].name;
      for (char& c : group) {
        if (c == ',' || c == '"' || c < ' ') c = ' ';
      }
      const glm::vec3 at = navmesh::toSpace(sample.plan, sample.height);
      csv += fmt::format("{},{:.9g},{:.6f},{:.6f},{:.4f},{:.5f},{}\n", agent,
                         static_cast<double>(frame) * recording.tick, at.x, at.z, at.y,
                         sample.heading, group);
    }
  }
  return csv;
}

std::string walkableArea(std::span<const agents::Wall> walls, const CrowdRecording& recording) {
  struct Piece {
    Ring outline;
    std::vector<Ring> holes;
  };
  std::vector<Piece> pieces;
  std::vector<Ring> holes;
  for (Ring& ring : ringsOf(walls)) {
    if (areaOf(ring) > 0.0) {
      pieces.push_back({std::move(ring), {}});
    } else {
      holes.push_back(std::move(ring));
    }
  }
  if (pieces.empty()) {
    const prediction::PlanBounds bounds = boundsOf(recording);
    const glm::dvec2 low = bounds.low - 2.0, high = bounds.high + 2.0;
    pieces.push_back({{low, {high.x, low.y}, high, {low.x, high.y}}, {}});
  }
  for (Ring& hole : holes) {
    // The smallest outline around it: an island in a courtyard belongs to the island.
    Piece* around = nullptr;
    for (Piece& piece : pieces) {
      if (inside(piece.outline, hole[0]) &&
          (!around || areaOf(piece.outline) < areaOf(around->outline))) {
        around = &piece;
      }
    }
    if (around) around->holes.push_back(std::move(hole));
  }
  std::string text;
  for (const Piece& piece : pieces) {
    text += text.empty() ? "(" : ", (";
    text += textOf(piece.outline);
    for (const Ring& hole : piece.holes) text += ", " + textOf(hole);
    text += ")";
  }
  return pieces.size() == 1 ? "POLYGON " + text : "MULTIPOLYGON (" + text + ")";
}

tl::expected<void, Error> writeTrajectoryDatabase(const std::filesystem::path& file,
                                                  const CrowdRecording& recording,
                                                  std::span<const agents::Wall> walls) {
  if (auto writable = checkWritable(file); !writable) return writable;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  Database database(file);
  database.run(
      "BEGIN;"
      "CREATE TABLE trajectory_data(frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT "
      "NULL, pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL);"
      "CREATE TABLE metadata(key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);"
      "CREATE TABLE geometry(hash INTEGER NOT NULL, wkt TEXT NOT NULL);"
      "CREATE TABLE frame_data(frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);");
  database.insert(
      "INSERT INTO trajectory_data VALUES(?, ?, ?, ?, ?, ?)", recording.samples.size(),
      [&](sqlite3_stmt* statement, std::size_t row) {
        const CrowdSample& sample = recording.samples[row];
        const glm::vec2 facing = navmesh::directionOf(sample.heading);
        sqlite3_bind_int64(statement, 1, static_cast<sqlite3_int64>(row / recording.agents));
        sqlite3_bind_int64(statement, 2, static_cast<sqlite3_int64>(row % recording.agents));
        const double values[] = {sample.plan.x, sample.plan.y, facing.x, facing.y};
        for (int k = 0; k < 4; ++k) sqlite3_bind_double(statement, 3 + k, values[k]);
      });
  const prediction::PlanBounds bounds = boundsOf(recording);
  const std::pair<const char*, std::string> metadata[] = {
      {"version", "2"},
      {"fps", fmt::format("{:.9g}", 1.0 / recording.tick)},
      {"xmin", fmt::format("{:.6g}", bounds.low.x)},
      {"xmax", fmt::format("{:.6g}", bounds.high.x)},
      {"ymin", fmt::format("{:.6g}", bounds.low.y)},
      {"ymax", fmt::format("{:.6g}", bounds.high.y)}};
  database.insert("INSERT INTO metadata VALUES(?, ?)", std::size(metadata),
                  [&](sqlite3_stmt* statement, std::size_t row) {
                    sqlite3_bind_text(statement, 1, metadata[row].first, -1, SQLITE_TRANSIENT);
                    sqlite3_bind_text(statement, 2, metadata[row].second.c_str(), -1,
                                      SQLITE_TRANSIENT);
                  });
  const std::string area = walkableArea(walls, recording);
  const std::int64_t hash = hashOf(area);
  database.insert("INSERT INTO geometry VALUES(?, ?)", 1,
                  [&](sqlite3_stmt* statement, std::size_t) {
                    sqlite3_bind_int64(statement, 1, hash);
                    sqlite3_bind_text(statement, 2, area.c_str(), -1, SQLITE_TRANSIENT);
                  });
  database.insert("INSERT INTO frame_data VALUES(?, ?)", recording.frames(),
                  [&](sqlite3_stmt* statement, std::size_t row) {
                    sqlite3_bind_int64(statement, 1, static_cast<sqlite3_int64>(row));
                    sqlite3_bind_int64(statement, 2, hash);
                  });
  database.run("CREATE INDEX frame_id_idx ON trajectory_data(frame, id); COMMIT;");
  return database.done();
}

std::vector<DiagramRow> fundamentalDiagram(std::span<const DensitySample> samples) {
  constexpr double kStep = 0.25;  // 1/m^2
  std::vector<DiagramRow> rows;
  for (const DensitySample& sample : samples) {
    const auto bin = static_cast<std::size_t>(static_cast<double>(sample.density) / kStep);
    if (bin >= rows.size()) rows.resize(bin + 1, {0.0, 0.0, 0.0, 0});
    rows[bin].density += static_cast<double>(sample.density);
    rows[bin].speed += static_cast<double>(sample.speed);
    rows[bin].flow += static_cast<double>(sample.density * sample.speed);
    ++rows[bin].samples;
  }
  rows.erase(
      std::remove_if(rows.begin(), rows.end(), [](const auto& row) { return row.samples == 0; }),
      rows.end());
  for (DiagramRow& row : rows) {
    const auto count = static_cast<double>(row.samples);
    row.density /= count;
    row.speed /= count;
    row.flow /= count;
  }
  return rows;
}

std::string metricsJson(const CrowdMetrics& metrics) {
  using Json = nlohmann::ordered_json;
  const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6; };
  const auto summary = [&](std::vector<double> values) {
    Json json;
    json["mean"] = rounded(mean(values));
    json["median"] = rounded(quantile(values, 0.5));
    json["least"] = rounded(quantile(values, 0.0));
    json["largest"] = rounded(quantile(values, 1.0));
    return json;
  };
  Json json;
  json["format"] = "forewalk.crowd_metrics/1";
  json["agents"] = metrics.agents;
  json["humans"] = metrics.humans;
  json["seconds"] = rounded(metrics.seconds);
  json["with_goal"] = metrics.withGoal;
  json["arrived"] = metrics.arrived;
  json["arrival_s"] = metrics.arrivals.empty() ? Json() : summary(metrics.arrivals);
  json["arrivals_s"] = Json::array();
  for (const double seconds : metrics.arrivals) json["arrivals_s"].push_back(rounded(seconds));
  json["path_efficiency"] = metrics.efficiency.empty() ? Json() : summary(metrics.efficiency);
  json["collisions"] = metrics.collisions;
  json["overlap_pair_ticks"] = metrics.overlaps.pairSteps;
  json["deepest_overlap"] = rounded(static_cast<double>(metrics.overlaps.deepest));
  json["least_separation_m"] = metrics.overlaps.leastGap > 1e29f
                                   ? Json()
                                   : Json(rounded(static_cast<double>(metrics.overlaps.leastGap)));
  json["walls_entered"] = metrics.wallsEntered;
  json["mean_speed_m_per_s"] = rounded(metrics.meanSpeed);
  json["fundamental_diagram"] = Json::array();
  for (const DiagramRow& row : fundamentalDiagram(metrics.diagram)) {
    json["fundamental_diagram"].push_back({{"density_per_m2", rounded(row.density)},
                                           {"speed_m_per_s", rounded(row.speed)},
                                           {"flow_per_m_s", rounded(row.flow)},
                                           {"samples", row.samples}});
  }
  json["hash"] = fmt::format("{:016x}", metrics.hash);
  return json.dump(1) + "\n";
}

std::string diagramPlot(std::span<const DiagramRow> rows, const std::string& subtitle) {
  LinePlot plot;
  plot.title = "Fundamental diagram";
  plot.subtitle = subtitle;
  plot.xName = "density, 1/m²";
  plot.yName = "speed, m/s; flow, 1/(m s)";
  PlotSeries speed{"speed", "#2f5fb3", {}}, flow{"flow", "#e2711d", {}};
  std::size_t samples = 0;
  for (const DiagramRow& row : rows) {
    speed.points.push_back({row.density, row.speed});
    flow.points.push_back({row.density, row.flow});
    samples += row.samples;
  }
  plot.series = {speed, flow};
  plot.notes = {
      fmt::format("Means over {} moments with somebody in the measured area, in steps of "
                  "0.25 per m².",
                  samples)};
  return toSvg(plot);
}

}  // namespace forewalk::service
