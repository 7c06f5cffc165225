#include "session/recording.h"

#include <doctest/doctest.h>

#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using namespace intaglio;
using namespace intaglio::session;

namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t from = 0;
  for (std::size_t at = 0; at <= line.size(); ++at) {
    if (at < line.size() && line[at] != ',') continue;
    fields.push_back(line.substr(from, at - from));
    from = at + 1;
  }
  return fields;
}

// The rows of a log, each by the names of its columns.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  REQUIRE(std::getline(lines, line));
  const std::vector<std::string> names = split(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(lines, line)) {
    const std::vector<std::string> fields = split(line);
    REQUIRE(fields.size() == names.size());
    std::map<std::string, std::string> row;
    for (std::size_t k = 0; k < names.size(); ++k) row[names[k]] = fields[k];
    CHECK(row.size() == names.size());  // no name twice
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("the event log holds every field of a contact to the bit; NaN is an empty column") {
  Recording recording;
  ContactEvent first;
  first.time = 0.1 + 0.2;
  first.body = 3;
  first.other = first_surface_body + 1;
  first.point = {1.0 / 3, -2e-9, 5};
  first.uv = {0.25, 0.75};
  first.v_t = {1, 2, 3};
  first.spin = {-1, -2, -0.1};
  first.impulse = {0, 1e-9, 0};
  first.duration = 1.0 / 480;
  first.touch_age = 1.0 / 960;
  ContactEvent second = first;
  second.phase = ContactPhase::end;
  second.other = floor_body;
  second.touch_age = std::numeric_limits<double>::quiet_NaN();
  recording.events = {first, second};

  const auto rows = rows_of(events_csv(recording));
  REQUIRE(rows.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto number = [&](const char* name) { return std::stod(rows[k].at(name)); };
    const ContactEvent& e = recording.events[k];
    CHECK(number("time_s") == e.time);
    CHECK(number("body") == e.body);
    CHECK(number("other") == e.other);
    CHECK(Vec3(number("x_m"), number("y_m"), number("z_m")) == e.point);
    CHECK(Vec2(number("u"), number("v")) == e.uv);
    CHECK(Vec3(number("n_gx"), number("n_gy"), number("n_gz")) == e.n_g);
    CHECK(Vec3(number("n_sx"), number("n_sy"), number("n_sz")) == e.n_s);
    CHECK(Vec3(number("v_tx_m_s"), number("v_ty_m_s"), number("v_tz_m_s")) == e.v_t);
    CHECK(Vec3(number("spin_x_m_s"), number("spin_y_m_s"), number("spin_z_m_s")) == e.spin);
    CHECK(Vec3(number("impulse_x_N_s"), number("impulse_y_N_s"), number("impulse_z_N_s")) == e.impulse);
    CHECK(number("duration_s") == e.duration);
  }
  CHECK(std::stod(rows[0].at("touch_age_s")) == first.touch_age);
  CHECK(rows[1].at("touch_age_s").empty());
  CHECK(rows[0].at("phase") == "begin");
  CHECK(rows[1].at("phase") == "end");
}
