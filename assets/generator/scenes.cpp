#include "scenes.h"

#include <array>
#include <nlohmann/json.hpp>

#include "floor_plan.h"
#include "maze.h"
#include "obj_writer.h"

namespace forewalk::assets {
namespace {

using Json = nlohmann::ordered_json;

const char* const kOrigin = "Made by assets/generator for forewalk; MIT licence.";

Json metres(Point p) { return Json::array({p.x / 1000.0, p.y / 1000.0, p.z / 1000.0}); }

Json roomsOf(const FloorPlan& plan, int storey) {
  Json list = Json::array();
  for (const Room& room : plan.rooms()) {
    const Rect a = room.area;
    list.push_back({{"name", room.name},
                    {"storey", storey},
                    {"probe", metres(room.probe)},
                    {"min", {a.x0 / 1000.0, a.z0 / 1000.0}},
                    {"max", {a.x1 / 1000.0, a.z1 / 1000.0}}});
  }
  return list;
}

/// The head that every scenario shares. Headings: 0 is -Z, counter-clockwise positive.
Json scenario(const std::string& scene, const std::string& about, Point start, double headingDeg,
              const std::vector<Point>& waypoints, double horizon) {
  Json json;
  json["format"] = "forewalk.scenario/1";
  json["scene"] = "../scenes/" + scene + ".obj";
  json["about"] = about;
  json["licence"] = "MIT";
  json["start"] = {{"position", metres(start)}, {"heading_deg", headingDeg}};
  json["waypoints"] = Json::array();
  for (const Point p : waypoints) json["waypoints"].push_back(metres(p));
  json["horizon"] = horizon;
  return json;
}

/// Indented, but with each point on one line.
std::string readable(const Json& json) {
  const std::string wide = json.dump(1);
  std::string text;
  for (std::size_t i = 0; i < wide.size(); ++i) {
    const std::size_t bracket = wide[i] == '[' ? wide.find_first_of("[]{", i + 1) : i;
    if (wide[i] != '[' || wide[bracket] != ']') {
      text += wide[i];
      continue;
    }
    for (; i < bracket; ++i) {
      if (wide[i] == '\n' || wide[i] == ' ') continue;
      text += wide[i];
      if (wide[i] == ',') text += ' ';
    }
    text += ']';
  }
  return text + "\n";
}

void add(std::vector<File>& files, const std::string& name, const ObjWriter& obj,
         const Json& json) {
  files.push_back({"scenes/" + name + ".obj", obj.text()});
  files.push_back({"scenarios/" + name + ".json", readable(json)});
}

// Furniture. Tops that would be ground for a walker are broken up by what stands on them, so that
// no piece of it becomes an island of its own up there: a top is safe where no spot of it is a
// walker's radius and a voxel (0.35 m) from its edges over more than half a square metre.

Rect around(int x, int z, int width, int depth) {
  return {x - width / 2, z - depth / 2, x + width / 2, z + depth / 2};
}

/// Four desks face to face with screens between them; 3.2 x 1.6 m.
void deskCluster(ObjWriter& out, int base, int x, int z) {
  out.box(around(x, z, 3200, 1600), base, base + 740);
  out.box(around(x, z, 3200, 40), base + 740, base + 1200);
  out.box(around(x, z, 40, 1600), base + 740, base + 1200);
}

/// A meeting table with chairs pushed under it and a row of plants along its middle.
void meetingTable(ObjWriter& out, int base, int x, int z, int length, bool alongX) {
  const auto part = [&](int dx, int dz, int w, int d, int y0, int y1) {
    out.box(alongX ? around(x + dx, z + dz, w, d) : around(x + dz, z + dx, d, w), base + y0,
            base + y1);
  };
  part(0, 0, length, 1200, 0, 740);
  part(0, 0, length - 400, 200, 740, 1100);
  const int chairs = length / 800;
  for (int i = 0; i < chairs; ++i) {
    const int along = -length / 2 + length * (2 * i + 1) / (2 * chairs);
    for (const int side : {-1, 1}) part(along, side * 650, 450, 450, 0, 450);
  }
}

/// A desk against nothing: 1.6 x 0.8 m with a chair half under it.
void singleDesk(ObjWriter& out, int base, int x, int z) {
  out.box(around(x, z, 1600, 800), base, base + 740);
  out.box(around(x, z + 450, 500, 500), base, base + 450);
}

/// A display case, 1.8 x 0.8 m.
void displayCase(ObjWriter& out, int x, int z, bool alongX) {
  out.box(alongX ? around(x, z, 1800, 800) : around(x, z, 800, 1800), 0, 1150);
}

/// A statue on its plinth, 0.9 x 0.9 m.
void statue(ObjWriter& out, int x, int z) {
  out.box(around(x, z, 900, 900), 0, 900);
  out.box(around(x, z, 500, 500), 900, 2600);
}

void office(std::vector<File>& files) {
  FloorPlan plan(0, 2800, {});
  const auto r = [&](const char* name, int x0, int z0, int x1, int z1) {
    return plan.room(name, {x0, z0, x1, z1});
  };
  // The corridor ring, and the passage through the core.
  const auto north = r("corridor north", 6000, 6000, 34000, 8000);
  const auto south = r("corridor south", 6000, 17000, 34000, 19000);
  const auto west = r("corridor west", 6000, 8000, 8000, 17000);
  const auto east = r("corridor east", 32000, 8000, 34000, 17000);
  const auto through = r("passage", 19000, 8000, 21000, 17000);
  plan.open(north, west);
  plan.open(north, east);
  plan.open(south, west);
  plan.open(south, east);
  plan.open(north, through);
  plan.open(south, through);

  // North: offices; the corner offices are reached through their neighbours.
  const auto cornerNw = r("corner office north-west", 0, 0, 6000, 6000);
  const auto anteNw = r("front office west", 6000, 0, 10000, 6000);
  const auto n1 = r("office 1", 10000, 0, 14000, 6000);
  const auto n2 = r("office 2", 14000, 0, 17500, 6000);
  const auto board = r("board room", 17500, 0, 24500, 6000);
  const auto n3 = r("office 3", 24500, 0, 27500, 6000);
  const auto n4 = r("office 4", 27500, 0, 30500, 6000);
  const auto anteNe = r("front office east", 30500, 0, 34000, 6000);
  const auto cornerNe = r("corner office north-east", 34000, 0, 40000, 6000);
  plan.door(cornerNw, anteNw, 4000, 900);
  plan.door(anteNw, north, 8000, 900);
  plan.door(n1, north, 12000, 900);
  plan.door(n2, north, 15000, 900);
  plan.door(board, north, 18600, 1200);
  plan.door(board, north, 23400, 1200);
  plan.door(n3, north, 26000, 900);
  plan.door(n4, north, 29000, 900);
  plan.door(anteNe, north, 32500, 900);
  plan.door(cornerNe, anteNe, 4000, 900);

  // West and east wings.
  const auto lab = r("workshop", 0, 6000, 6000, 12000);
  const auto archive = r("archive", 0, 12000, 6000, 19000);
  plan.door(lab, west, 10000, 1000);
  plan.door(archive, west, 14500, 1000);
  plan.door(lab, archive, 2500, 900);
  const auto e1 = r("office 5", 34000, 6000, 40000, 10000);
  const auto e2 = r("office 6", 34000, 10000, 40000, 13500);
  const auto training = r("training room", 34000, 13500, 40000, 25000);
  plan.door(e1, east, 9000, 900);
  plan.door(e2, east, 11500, 900);
  plan.door(training, east, 15500, 1200);

  // South: the open-plan area and a meeting room.
  const auto openPlan = r("open-plan area", 0, 19000, 27000, 25000);
  const auto meetingS = r("meeting room south", 27000, 19000, 34000, 25000);
  plan.door(openPlan, south, 9500, 2400);
  plan.door(openPlan, south, 20000, 2400);
  plan.door(openPlan, archive, 3000, 1600);
  plan.door(meetingS, south, 29000, 1000);
  plan.door(meetingS, training, 23000, 1000);

  // The core.
  const auto meetingW = r("meeting room west", 8000, 8000, 13000, 12500);
  const auto kitchen = r("kitchen", 13000, 8000, 19000, 12500);
  const auto store = r("store", 8000, 12500, 11000, 17000);
  const auto wc1 = r("washroom 1", 11000, 12500, 15000, 17000);
  const auto wc2 = r("washroom 2", 15000, 12500, 19000, 17000);
  const auto hall = r("town hall", 21000, 8000, 27500, 17000);
  const auto print = r("print room", 27500, 8000, 32000, 12000);
  const auto lounge = r("lounge", 27500, 12000, 32000, 17000);
  plan.door(meetingW, north, 9500, 900);
  plan.door(kitchen, north, 14500, 1000);
  plan.door(kitchen, through, 10500, 1200);
  plan.door(store, west, 15000, 900);
  plan.door(wc1, south, 12500, 900);
  plan.door(wc2, south, 17000, 900);
  plan.door(hall, through, 12500, 1800);
  plan.door(hall, south, 24000, 1800);
  plan.door(print, north, 29000, 1000);
  plan.door(lounge, east, 14500, 1000);
  plan.door(lounge, hall, 15500, 1000);

  ObjWriter out("forewalk office: one floor, 40 x 25 m, a corridor ring and rooms around it",
                kOrigin);
  out.group("floor");
  out.floor(plan.footprint(), 0);
  out.group("walls");
  plan.writeWalls(out);

  out.group("desks");
  for (const int x : {5800, 11000, 16200, 21400}) {
    deskCluster(out, 0, x, 22000);
    plan.island();
  }
  for (const auto& [x, z] : {std::pair{3000, 2400},
                             {11700, 2400},
                             {37000, 2400},
                             {32250, 2600},
                             {37000, 7800},
                             {37400, 11700}}) {
    singleDesk(out, 0, x, z);
    plan.island();
  }
  // Desks in the narrow offices stand against the wall.
  for (const int x : {15700, 26000, 29000}) out.box({x - 800, 100, x + 800, 900}, 0, 740);
  out.box({9140, 1200, 9940, 2800}, 0, 740);

  out.group("tables");
  meetingTable(out, 0, 21000, 2900, 4000, true);
  meetingTable(out, 0, 10500, 10300, 2400, true);
  meetingTable(out, 0, 30500, 22000, 3200, true);
  meetingTable(out, 0, 16500, 10000, 1600, true);
  for (int i = 0; i < 4; ++i) plan.island();
  for (const int z : {17000, 19400, 21800}) {
    out.box(around(37300, z, 3000, 700), 0, 740);
    plan.island();
  }

  out.group("cupboards");
  out.box({13060, 12000, 18200, 12440}, 0, 900);   // kitchen counter
  out.box({13060, 11300, 13660, 12000}, 0, 1900);  // refrigerator
  for (const int z : {14000, 15800}) {             // archive shelves
    out.box(around(2800, z, 3200, 500), 0, 2200);
    plan.island();
  }
  out.box({8060, 16340, 10940, 16940}, 0, 2200);   // store shelves
  out.box({100, 6500, 700, 11500}, 0, 900);        // work bench along the wall
  out.box(around(3200, 8800, 1800, 900), 0, 900);  // work bench in the middle
  plan.island();
  out.box({31340, 8600, 31940, 10400}, 0, 1200);    // printers
  out.box({27560, 12800, 28260, 14400}, 0, 800);    // sofa against the wall
  out.box(around(30000, 14400, 900, 600), 0, 400);  // low table
  plan.island();

  out.group("washrooms");
  for (const int x : {11000, 15000}) {
    for (const int dx : {60, 1060, 2060}) {
      out.box({x + dx + 960, 12560, x + dx + 1000, 14000}, 0, 2000);
      out.box({x + dx + 300, 12560, x + dx + 700, 13160}, 0, 420);
    }
  }

  out.group("columns");
  for (const int x : {3200, 8400, 13600, 18800, 24200}) {
    out.box(around(x, 22000, 400, 400), 0, 2800);
    plan.island();
  }

  plan.probe(cornerNw, 1200, 1200);
  plan.probe(anteNw, 7300, 3000);
  plan.probe(n1, 12000, 4600);
  plan.probe(n2, 15500, 3500);
  plan.probe(board, 18200, 4800);
  plan.probe(cornerNe, 38800, 1200);
  plan.probe(anteNe, 32300, 4800);
  plan.probe(lab, 1800, 7300);
  plan.probe(archive, 1000, 17900);
  plan.probe(e1, 35000, 9300);
  plan.probe(e2, 35000, 12900);
  plan.probe(training, 35000, 24000);
  plan.probe(openPlan, 8500, 20000);
  plan.probe(meetingS, 27900, 24200);
  plan.probe(meetingW, 8900, 8800);
  plan.probe(kitchen, 14300, 9000);
  plan.probe(store, 9500, 14000);
  plan.probe(wc1, 12500, 15800);
  plan.probe(wc2, 16500, 15800);
  plan.probe(lounge, 29500, 13000);
  plan.probe(print, 29500, 10000);

  Json json = scenario(
      "office",
      "A round over the office: along the ring, through the core, into offices, "
      "across the open-plan area, and back.",
      {7000, 0, 16500}, 0.0,
      {{7000, 0, 7000},   {12000, 0, 4600},  {12000, 0, 7000},  {20000, 0, 7000}, {20000, 0, 12500},
       {24000, 0, 12500}, {24000, 0, 18000}, {33000, 0, 18000}, {33000, 0, 9000}, {35000, 0, 9300},
       {33000, 0, 7000},  {21000, 0, 7000},  {18600, 0, 4800},  {18600, 0, 7000}, {14500, 0, 9000},
       {20000, 0, 10500}, {20000, 0, 20200}, {8500, 0, 20200},  {3000, 0, 19900}, {3000, 0, 17700},
       {7000, 0, 14500},  {7000, 0, 16500}},
      20.0);
  json["answer"] = {{"components", 1},
                    {"rooms", plan.rooms().size()},
                    {"loops", plan.loops()},
                    {"walkable_height_max", 0.1}};
  json["rooms"] = roomsOf(plan, 0);
  add(files, "office", out, json);
}

void museum(std::vector<File>& files) {
  FloorPlan plan(0, 3000, {.outerWall = 200, .innerWall = 200, .doorHead = 2400, .windows = false});
  const auto r = [&](const char* name, int x0, int z0, int x1, int z1) {
    return plan.room(name, {x0, z0, x1, z1});
  };
  const auto stone = r("stone", 0, 0, 12000, 11000);
  const auto bronze = r("bronze", 12000, 0, 23000, 9000);
  const auto script = r("manuscripts", 23000, 0, 33000, 9000);
  const auto paintN = r("paintings north", 33000, 0, 45000, 12000);
  const auto wing = r("west wing", 0, 11000, 12000, 24000);
  const auto atrium = r("atrium", 12000, 9000, 33000, 26000);
  const auto paintS = r("paintings south", 33000, 12000, 45000, 26000);
  const auto textile = r("textiles", 0, 24000, 12000, 35000);
  const auto foyer = r("foyer", 12000, 26000, 31000, 35000);
  const auto shop = r("shop", 31000, 26000, 38000, 35000);
  const auto cafe = r("cafe", 38000, 26000, 45000, 35000);
  plan.door(stone, bronze, 4500, 1500);
  plan.door(bronze, script, 4500, 1500);
  plan.door(script, paintN, 4500, 1500);
  plan.door(paintN, paintS, 39000, 2000);
  plan.door(stone, wing, 6000, 2000);
  plan.door(wing, textile, 6000, 2000);
  plan.door(textile, foyer, 30000, 1500);
  plan.door(foyer, atrium, 21500, 2500);
  plan.door(foyer, shop, 30000, 1500);
  plan.door(shop, cafe, 30000, 1500);
  plan.door(cafe, paintS, 41500, 1500);
  plan.door(wing, atrium, 17500, 2500);
  plan.door(atrium, paintS, 17500, 2500);
  plan.door(bronze, atrium, 17500, 1500);
  plan.door(script, atrium, 28000, 1500);

  ObjWriter out("forewalk museum: galleries with loops around an atrium, 45 x 35 m", kOrigin);
  out.group("floor");
  out.floor(plan.footprint(), 0);
  out.group("walls");
  plan.writeWalls(out);

  out.group("statues");
  for (const auto& [x, z] : {std::pair{3000, 3000},
                             {6000, 6500},
                             {9000, 3000},
                             {3000, 8500},
                             {9000, 8500},
                             {15000, 2500},
                             {20500, 2500},
                             {15000, 6500},
                             {20500, 6500},
                             {14500, 12000},
                             {30500, 12000},
                             {14500, 23000},
                             {30500, 23000}}) {
    statue(out, x, z);
    plan.island();
  }
  out.group("cases");
  for (const auto& [x, z] : {std::pair{25500, 3000},
                             {30500, 3000},
                             {25500, 6200},
                             {30500, 6200},
                             {3500, 27500},
                             {8500, 27500},
                             {3500, 32000},
                             {8500, 32000}}) {
    displayCase(out, x, z, true);
    plan.island();
  }
  for (const auto& [x, z] : {std::pair{3000, 14500}, {3000, 20500}, {9000, 14500}, {9000, 20500}}) {
    displayCase(out, x, z, false);
    plan.island();
  }
  out.group("partitions");  // free-standing walls that carry the paintings
  out.box(around(39000, 4000, 6000, 200), 0, 2600);
  out.box(around(39000, 8000, 6000, 200), 0, 2600);
  out.box(around(37000, 19000, 200, 7000), 0, 2600);
  out.box(around(41000, 19000, 200, 7000), 0, 2600);
  out.box(around(6000, 17500, 200, 4000), 0, 2600);
  for (int i = 0; i < 5; ++i) plan.island();

  out.group("great hall");  // two large pieces under hipped roofs of glass, benches around them
  out.lidded({18000, 12500, 27000, 16000}, 0, 1200, 3600);
  out.lidded({19000, 18800, 26000, 21800}, 0, 1200, 3400);
  plan.island();
  plan.island();
  for (const int x : {16000, 29000}) {
    out.box(around(x, 17500, 600, 2000), 0, 450);
    plan.island();
  }
  out.group("foyer");
  out.box(around(21500, 32400, 4000, 700), 0, 1100);  // ticket counter
  plan.island();
  for (const int x : {15000, 28000}) {
    out.box(around(x, 29000, 500, 500), 0, 3000);
    plan.island();
  }
  out.group("shop and cafe");
  for (const int z : {28200, 32500}) {
    out.box(around(34500, z, 3000, 700), 0, 1300);
    plan.island();
  }
  for (const auto& [x, z] : {std::pair{40000, 32600}, {43000, 32600}, {43200, 28600}}) {
    out.box(around(x, z, 800, 800), 0, 740);
    plan.island();
  }

  plan.probe(stone, 6000, 4500);
  plan.probe(wing, 3000, 17500);
  plan.probe(atrium, 22500, 17400);
  plan.probe(bronze, 17750, 4500);
  plan.probe(paintN, 39000, 6000);
  plan.probe(paintS, 39000, 19000);
  plan.probe(textile, 6000, 30000);
  plan.probe(foyer, 21500, 29500);
  plan.probe(shop, 34500, 30300);

  Json json =
      scenario("museum", "A visit: around the galleries, twice across the atrium, to the cafe.",
               {21500, 0, 34000}, 0.0,
               {{18500, 0, 31000}, {21500, 0, 28000}, {21500, 0, 24500}, {17000, 0, 20500},
                {14000, 0, 17500}, {10500, 0, 17500}, {6000, 0, 12500},  {6000, 0, 4500},
                {12000, 0, 4500},  {17500, 0, 4500},  {17500, 0, 10500}, {28000, 0, 10500},
                {28000, 0, 4500},  {33000, 0, 4500},  {34500, 0, 6000},  {39000, 0, 6000},
                {43500, 0, 6000},  {39000, 0, 12000}, {39000, 0, 17000}, {39000, 0, 24000},
                {41500, 0, 26500}, {41500, 0, 30000}, {34500, 0, 30000}, {29000, 0, 30300},
                {21500, 0, 29500}, {13000, 0, 30000}, {6000, 0, 30000},  {6000, 0, 23000},
                {7500, 0, 17500},  {13500, 0, 17500}, {22500, 0, 17400}, {31500, 0, 17500},
                {28500, 0, 24000}, {21500, 0, 25000}, {21500, 0, 29000}},
               20.0);
  json["answer"] = {{"components", 1},
                    {"rooms", plan.rooms().size()},
                    {"loops", plan.loops()},
                    {"walkable_height_max", 0.1}};
  json["rooms"] = roomsOf(plan, 0);
  add(files, "museum", out, json);
}

void twoStorey(std::vector<File>& files) {
  constexpr int kRise = 170, kTread = 290, kStorey = 18 * kRise, kSlab = 260;
  FloorPlan ground(0, kStorey - kSlab, {});
  FloorPlan upper(kStorey, 2700, {});

  const auto g = [&](const char* name, int x0, int z0, int x1, int z1) {
    return ground.room(name, {x0, z0, x1, z1});
  };
  const auto hallG = g("hall", 6500, 0, 11500, 12000);
  const auto kitchen = g("kitchen", 0, 0, 6500, 5500);
  const auto living = g("living room", 0, 5500, 6500, 12000);
  const auto study = g("study", 11500, 0, 18000, 4500);
  const auto dining = g("dining room", 11500, 4500, 18000, 12000);
  ground.door(hallG, kitchen, 4700, 900);
  ground.door(hallG, living, 8500, 1400);
  ground.door(kitchen, living, 2500, 1000);
  ground.door(hallG, study, 2500, 900);
  ground.door(hallG, dining, 8000, 1200);

  const auto u = [&](const char* name, int x0, int z0, int x1, int z1) {
    return upper.room(name, {x0, z0, x1, z1});
  };
  const auto hallU = u("landing", 6500, 0, 11500, 12000);
  const auto bed1 = u("bedroom 1", 0, 0, 6500, 5000);
  const auto bath = u("bathroom", 0, 5000, 6500, 7800);
  const auto bed2 = u("bedroom 2", 0, 7800, 6500, 12000);
  const auto bed3 = u("bedroom 3", 11500, 0, 18000, 6000);
  const auto bed4 = u("bedroom 4", 11500, 6000, 18000, 12000);
  upper.door(hallU, bed1, 4300, 900);
  upper.door(hallU, bath, 6400, 900);
  upper.door(hallU, bed2, 9500, 900);
  upper.door(hallU, bed3, 3000, 900);
  upper.door(hallU, bed4, 9000, 900);
  upper.door(bed3, bed4, 15000, 900);

  // Two flights of 1.25 m around a spine wall, with a half-way landing at the north wall.
  const Rect well{6560, 100, 9160, 3820};
  const int spine0 = 7810, spine1 = 7910, flightNorth = 1500;

  ObjWriter out("forewalk two-storey house, 18 x 12 m, storeys 3.06 m apart, real stairs", kOrigin);
  out.group("floor ground");
  out.floor(ground.footprint(), 0);
  out.group("walls ground");
  ground.writeWalls(out);

  const Rect foot = upper.footprint();
  out.group("slab");
  const int under = kStorey - kSlab;
  out.box({foot.x0, foot.z0, well.x0, foot.z1}, under, kStorey);
  out.box({well.x1, foot.z0, foot.x1, foot.z1}, under, kStorey);
  out.box({well.x0, foot.z0, well.x1, well.z0}, under, kStorey);
  out.box({well.x0, well.z1, well.x1, foot.z1}, under, kStorey);
  out.group("walls upper");
  upper.writeWalls(out);

  out.group("stairs");
  for (int i = 0; i < 8; ++i) {  // the first flight goes north, up from the hall
    const int z1 = well.z1 - i * kTread;
    out.box({well.x0, z1 - kTread, spine0, z1}, 0, (i + 1) * kRise);
  }
  out.box({well.x0, well.z0, well.x1, flightNorth}, 0, 9 * kRise);
  for (int i = 0; i < 8; ++i) {  // the second comes back south, up to the slab
    const int z0 = flightNorth + i * kTread;
    out.box({spine1, z0, well.x1, z0 + kTread}, 0, (10 + i) * kRise);
  }
  out.group("spine");
  out.box({spine0, flightNorth, spine1, well.z1}, 0, kStorey + 1000);
  out.group("railings");
  out.box({well.x1, well.z0, well.x1 + 50, well.z1}, kStorey, kStorey + 1000);
  out.box({well.x0, well.z1, spine0, well.z1 + 50}, kStorey, kStorey + 1000);

  out.group("furniture ground");
  out.box({100, 100, 700, 4500}, 0, 900);          // kitchen counter
  out.box(around(3400, 2700, 1200, 800), 0, 900);  // kitchen block
  ground.island();
  out.box(around(2600, 9300, 1200, 700), 0, 420);  // low table
  ground.island();
  out.box({100, 8000, 900, 10600}, 0, 800);  // sofa against the wall
  meetingTable(out, 0, 14800, 8300, 2400, true);
  ground.island();
  out.box({14000, 100, 15800, 900}, 0, 740);  // desk
  out.group("furniture upper");
  // Beds with their heads to the wall, wardrobes along walls; a mattress is no ground to walk on.
  const auto bed = [&](int x0, int z0, int x1, int z1) {
    out.lidded({x0, z0, x1, z1}, kStorey, kStorey + 300, kStorey + 1400);
  };
  bed(100, 1600, 2100, 3200);
  bed(100, 8900, 2100, 10700);
  bed(15900, 1500, 17900, 3100);
  bed(15900, 8200, 17900, 10000);
  out.box({3000, 100, 5400, 700}, kStorey, kStorey + 2000);
  out.box({12200, 11300, 14600, 11900}, kStorey, kStorey + 2000);
  out.box({100, 5060, 900, 6760}, kStorey, kStorey + 560);  // bath tub

  ground.probe(hallG, 9500, 7000);
  ground.probe(kitchen, 5200, 2700);
  ground.probe(living, 4500, 9300);
  ground.probe(dining, 12600, 10800);
  upper.probe(hallU, 9500, 8000);
  upper.probe(bed1, 4500, 2500);
  upper.probe(bath, 3500, 6400);
  upper.probe(bed2, 4500, 10000);
  upper.probe(bed3, 13500, 3000);
  upper.probe(bed4, 13500, 9000);

  Json json = scenario(
      "two_storey",
      "From the living room up the stairs into a bedroom, and down again to the dining room.",
      {4500, 0, 9300}, -90.0,
      {{7800, 0, 8500},
       {7180, 0, 5000},
       {7180, 9 * kRise, 800},
       {8530, 9 * kRise, 800},
       {8530, kStorey, 4800},
       {10300, kStorey, 5500},
       {10300, kStorey, 9000},
       {13500, kStorey, 9000},
       {15000, kStorey, 5000},
       {13500, kStorey, 3000},
       {10300, kStorey, 3000},
       {8530, kStorey, 4800},
       {8530, 9 * kRise, 800},
       {7180, 9 * kRise, 800},
       {7180, 0, 5000},
       {9500, 0, 7000},
       {12600, 0, 10800}},
      20.0);
  const auto box = [](Rect r, int y0, int y1) {
    return Json{{"min", {r.x0 / 1000.0, y0 / 1000.0, r.z0 / 1000.0}},
                {"max", {r.x1 / 1000.0, y1 / 1000.0, r.z1 / 1000.0}}};
  };
  json["answer"] = {{"components", 1},
                    {"components_without_stairs", 2},
                    {"rooms", ground.rooms().size() + upper.rooms().size()},
                    // The stairs join two storeys that were apart, which adds no loop.
                    {"loops", ground.loops() + upper.loops()},
                    {"storeys", Json::array({0.0, kStorey / 1000.0})},
                    {"rise", kRise / 1000.0},
                    {"tread", kTread / 1000.0},
                    {"walkable_height_max", kStorey / 1000.0 + 0.1}};
  // All that makes the stairs, and nothing else, lies wholly in here.
  json["stairs"] = box(well, 0, kStorey - kRise);
  json["rooms"] = roomsOf(ground, 0);
  for (const Json& room : roomsOf(upper, 1)) json["rooms"].push_back(room);
  add(files, "two_storey", out, json);
}

void corridor(std::vector<File>& files) {
  constexpr int kLength = 60000, kWidth = 2500, kWall = 200, kHeight = 2700;
  // Drawn by hand, not from rooms, so that the clear width is exactly that.
  const Rect inner{-kLength / 2, -kWidth / 2, kLength / 2, kWidth / 2};
  ObjWriter out("forewalk corridor: straight, 60 x 2.5 m between its walls", kOrigin);
  out.group("floor");
  out.floor({inner.x0 - kWall, inner.z0 - kWall, inner.x1 + kWall, inner.z1 + kWall}, 0);
  out.group("walls");
  out.box({inner.x0 - kWall, inner.z0, inner.x0, inner.z1}, 0, kHeight);
  out.box({inner.x1, inner.z0, inner.x1 + kWall, inner.z1}, 0, kHeight);
  out.box({inner.x0 - kWall, inner.z0 - kWall, inner.x1 + kWall, inner.z0}, 0, kHeight);
  // The south wall has windows: a sill all along, piers, and a lintel.
  out.box({inner.x0 - kWall, inner.z1, inner.x1 + kWall, inner.z1 + kWall}, 0, 900);
  out.box({inner.x0 - kWall, inner.z1, inner.x1 + kWall, inner.z1 + kWall}, 2200, kHeight);
  for (int x = inner.x0; x <= inner.x1; x += 3000) {
    out.box({x - 200, inner.z1, x + 200, inner.z1 + kWall}, 900, 2200);
  }

  Json json = scenario("corridor", "To and fro in a straight corridor.", {0, 0, 0}, -90.0,
                       {{25000, 0, 0}, {-25000, 0, 0}, {0, 0, 0}}, 20.0);
  json["answer"] = {{"components", 1},           {"loops", 0},     {"length", kLength / 1000.0},
                    {"width", kWidth / 1000.0},  {"terminals", 2}, {"terminal_distance", 20.0},
                    {"walkable_height_max", 0.1}};
  add(files, "corridor", out, json);
}

void maze(std::vector<File>& files) {
  constexpr int kColumns = 15, kRows = 11, kExtra = 9, kPassage = 1500, kWall = 150;
  constexpr int kPitch = kPassage + kWall;
  constexpr std::uint64_t kSeed = 2016;
  const Maze grid(kColumns, kRows, kExtra, kSeed);
  const auto middle = [](Cell c) {
    return Point{c.column * kPitch + kPitch / 2, 0, c.row * kPitch + kPitch / 2};
  };

  ObjWriter out("forewalk maze: 15 x 11 cells, passages 1.5 m, seed 2016", kOrigin);
  out.group("floor");
  out.floor({-kWall / 2, -kWall / 2, kColumns * kPitch + kWall / 2, kRows * kPitch + kWall / 2}, 0);
  out.group("walls");
  for (const Rect wall : grid.walls(kPitch, kWall)) out.box(wall, 0, 2700);

  // The goal is the dead end that takes most steps from the start; the first one in rows of those.
  const Cell start{0, 0};
  const std::vector<int> steps = grid.steps(start);
  Cell goal = start;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Cell c{column, row};
      if (grid.degree(c) == 1 && grid.stepsTo(steps, c) > grid.stepsTo(steps, goal)) goal = c;
    }
  }
  Json deadEnds = Json::array();
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Cell c{column, row};
      if (c != start && grid.degree(c) == 1) deadEnds.push_back(metres(middle(c)));
    }
  }
  // A walker's middle keeps 0.25 m from walls; a builder may round that to its voxels.
  const Maze::Bounds bounds = grid.shortestWalk(start, goal, kPitch / 1000.0, kWall / 1000.0, 0.12);

  Json json = scenario("maze", "From one corner to the dead end that is farthest from it.",
                       middle(start), -90.0, {middle(goal), middle(start)}, 20.0);
  json["goal"] = metres(middle(goal));
  const auto rounded = [](double v) {
    return static_cast<double>(static_cast<long>(v * 1000.0 + 0.5)) / 1000.0;
  };
  json["answer"] = {{"components", 1},
                    {"loops", grid.loops()},
                    {"cells", kColumns * kRows},
                    {"dead_ends", deadEnds},
                    {"steps_to_goal", grid.stepsTo(steps, goal)},
                    {"shortest_at_least", rounded(bounds.lower)},
                    {"shortest_at_most", rounded(bounds.upper)},
                    {"walkable_height_max", 0.1}};
  add(files, "maze", out, json);
}

}  // namespace

std::vector<File> generateScenes() {
  std::vector<File> files;
  office(files);
  museum(files);
  twoStorey(files);
  corridor(files);
  maze(files);
  return files;
}

}  // namespace forewalk::assets
