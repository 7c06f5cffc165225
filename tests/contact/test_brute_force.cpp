#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "core/portable_math.h"
#include "tests/contact/bodies.h"
#include "tests/contact/brute.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

struct Tally {
  int apart = 0, wrong = 0, beyond = 0, overlapping = 0, deep = 0, missed = 0;
  double worst = 0, deepest_missed = 0;
};

using SharedSurface = std::shared_ptr<const surface::Surface>;

std::vector<SharedSurface> surfaces() {
  return {tests::brick_surface(64), tests::rough_surface(37, 53, surface::Edge::clamp),
          tests::rough_surface(64, 48, surface::Edge::wrap, 0.02)};
}

struct Sample {
  std::size_t surface;
  double margin;
  Pose pose;
};

// Describes a pose that fails, so that it can be repeated.
std::string text(const std::string& name, const Sample& s) {
  const Vec3& p = s.pose.position;
  const Quat& q = s.pose.orientation;
  return fmt::format(
      "{{\"{}\", {{{}, {:.17g}, {{Vec3({:.17g}, {:.17g}, {:.17g}), Quat({:.17g}, {:.17g}, {:.17g}, {:.17g})}}}}}},",
      name, s.surface, s.margin, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
}

// A pose over the middle of the rectangle in which the body's lowest point is about as high as the relief.
Pose near_pose(const surface::Surface& s, const Shape& shape, Random& random, double play) {
  const double inside = 0.25;
  const surface::Placement& place = s.placement();
  Pose pose{Vec3(random.uniform(inside, 1 - inside) * place.size_u(),
                 random.uniform(inside, 1 - inside) * place.size_v(), 0),
            tests::any_turn(random)};
  pose.position = place.to_world({pose.position.x(), pose.position.y(), 0.5});
  double low = -0.1, high = 0.3;
  while (high - low > 2e-4) {
    const double z = 0.5 * (low + high);
    Pose at = pose;
    at.position += (z - 0.5) * place.n();
    const ContactSet set = relief_contacts(s, shape, at, 0.001);
    (set.count > 0 || set.status != 0 ? low : high) = z;
  }
  pose.position += (high - 0.501 + random.uniform(-play, play)) * place.n();
  return pose;
}

// Apart, the first contact is as far as brute force finds; overlapping, there is one that overlaps.
void check_sample(const surface::Surface& s, const tests::Body& body, const Sample& sample, Tally& tally) {
  const ContactSet set = relief_contacts(s, body.shape, sample.pose, sample.margin);
  const double brute = tests::brute_distance(s, body.shape, sample.pose, sample.margin);
  const auto told = [&] {
    return fmt::format("brute force {:.9f}, {} contacts, first {:.9f}, status {}: {}", brute, set.count,
                       set.points[0].distance, set.status, text(body.name, sample));
  };
  if (brute >= sample.margin) {
    ++tally.beyond;
    const bool right = set.count == 0 || std::abs(set.points[0].distance - sample.margin) < 1e-7;
    CHECK_MESSAGE(right, told());
  } else if (brute > 1e-7) {
    ++tally.apart;
    const double off = set.count > 0 ? std::abs(set.points[0].distance - brute) : sample.margin;
    tally.worst = std::max(tally.worst, off);
    tally.wrong += off > 1e-6 ? 1 : 0;
    CHECK_MESSAGE(off <= 1e-6, told());
  } else if (brute < (body.name == "mesh" ? 1e-8 : -1e-7)) {
    ++tally.overlapping;
    tally.deep += (set.status & status::deep) != 0 ? 1 : 0;
    const bool seen = set.count > 0 && set.points[0].distance < 0;
    tally.missed += seen ? 0 : 1;
    if (!seen) tally.deepest_missed = std::min(tally.deepest_missed, brute);
    CHECK_MESSAGE(seen, told());
  }
}

void check_distance(const std::string& name) {
  const tests::Body body = tests::body(name, 0.12);
  Tally tally;
  const char* wanted = std::getenv("INTAGLIO_POSES");
  const int count = wanted != nullptr ? std::atoi(wanted) : tests::poses(40, 34000);
  const auto all = surfaces();
  for (std::size_t n = 0; n < all.size(); ++n) {
    Random random(200 + n);
    for (int k = 0; k < count; ++k) {
      const double margin = random.uniform(0.0005, 0.006);
      check_sample(*all[n], body, {n, margin, near_pose(*all[n], body.shape, random, 0.004)}, tally);
    }
  }
  MESSAGE(name << ": " << tally.apart << " apart, " << tally.wrong << " off by more than 1e-6, at worst "
               << tally.worst << " m; " << tally.overlapping << " overlapping, " << tally.deep
               << " of them by no least gap, " << tally.missed << " missed, the deepest "
               << tally.deepest_missed << "; " << tally.beyond << " beyond the margin");
  CHECK(tally.apart > count / 2);
}

}  // namespace

// Poses that were wrong once.
TEST_CASE("distance equals brute force: poses that were wrong once") {
  const std::vector<std::pair<std::string, Sample>> poses = {
      // An edge under a crease that is no local minimum of the gap, and no corner of either in the other.
      {"box",
       {0,
        0.0016287551933115779,
        {Vec3(-0.19835365026709001, 0.048320552039974374, 0.097541243506843789),
         Quat(-0.10872044688947122, -0.0071561856485222539, 0.21345924312423167, -0.97085725261747302)}}},
      {"box",
       {0,
        0.0047239311912259281,
        {Vec3(0.073059648436946123, 0.075232221334552152, -0.15508371661218012),
         Quat(0.19788457633107562, 0.70123206102499147, 0.65690984657377027, -0.19386785322827185)}}},
      {"box",
       {0,
        0.0018515114964058055,
        {Vec3(0.16828557616474549, 0.063616731956307571, -0.19030746867520698),
         Quat(0.18612723719083848, 0.24568499263520549, -0.2019960636291972, -0.92961988266594942)}}},
      {"cylinder",
       {0,
        0.0044749011328883235,
        {Vec3(0.01696841879664357, 0.033168614930386697, 0.2376365144192335),
         Quat(-0.87250436731789205, -0.06201504680189545, 0.47998862962489586, 0.067090822115829341)}}},
      {"cylinder",
       {0,
        0.0055779285586385896,
        {Vec3(0.24530325025528377, 0.04635021940846773, 0.17373372618356225),
         Quat(-0.38684700259510479, 0.62487634097903, -0.11714428476699948, 0.66794922832073855)}}},
      {"cylinder",
       {0,
        0.0054597031830634288,
        {Vec3(-0.11908806032566988, 0.046578712449428683, -0.091447298967208601),
         Quat(0.21925044520629522, 0.59950658387277911, 0.26106741176438564, 0.72413044728465625)}}},
      {"cylinder",
       {0,
        0.0029400498468253786,
        {Vec3(0.176496175997362, 0.037616692085694126, 0.10151742689666043),
         Quat(-0.18812576937911124, 0.2334263615423646, -0.18741455230746717, 0.93541253691406256)}}},
  };
  const auto all = surfaces();
  Tally tally;
  for (const auto& [name, sample] : poses)
    check_sample(*all[sample.surface], tests::body(name, 0.12), sample, tally);
  CHECK(tally.apart + tally.overlapping == int(poses.size()));
}
TEST_CASE("distance equals brute force: sphere") {
  check_distance("sphere");
}
TEST_CASE("distance equals brute force: capsule") {
  check_distance("capsule");
}
TEST_CASE("distance equals brute force: box") {
  check_distance("box");
}
TEST_CASE("distance equals brute force: cylinder") {
  check_distance("cylinder");
}
TEST_CASE("distance equals brute force: hull") {
  check_distance("hull");
}
TEST_CASE("distance equals brute force: mesh") {
  check_distance("mesh");
}
TEST_CASE("distance equals brute force: compound") {
  check_distance("compound");
}
