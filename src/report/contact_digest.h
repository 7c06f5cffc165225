// The contact events as the report keeps them: impacts of balls, their strongest contacts, audible touches.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "intaglio/event.h"
#include "report/bounded.h"
#include "report/touches.h"

namespace intaglio::report {

// An impact of a ball. Contacts that begin within 10 ms count as one: a ball may touch at several points.
struct Impact {
  double time = 0;  // s, of its first contact
  BodyId body = 0;
  double impulse = 0;  // N s, over its first 10 ms
};

// The strongest `count` that are at least a tenth of the greatest and `apart` seconds from a stronger one; in
// order of time. `impacts`: the strongest first.
std::vector<Impact> strongest(const std::vector<Impact>& impacts, std::size_t count, double apart);

// A step of a contact.
struct Hit {
  double time = 0;  // s
  BodyId body = 0;
  Vec3 point = Vec3::Zero();  // m
  double impulse = 0;         // N s
};

class ContactDigest {
 public:
  explicit ContactDigest(BodyId pen) : pen_(pen) {}

  void add(const ContactEvent& event);
  // After the last event.
  void finish();

  std::size_t count() const { return count_; }
  // The strongest first. The 40 impacts that are 30 ms apart are among these: each of them may have seven
  // stronger neighbours of every ball at most.
  std::vector<Impact> impacts() const { return impacts_.sorted(); }
  // The strongest 500 of all bodies but the pen, the strongest first; rolling is many small contacts, which
  // are left out where they are below a fiftieth of the largest.
  std::vector<Hit> hits() const;
  double largest_impulse() const { return largest_impulse_; }  // N s, of all bodies but the pen
  const TouchFinder& touches() const { return touches_; }
  // Bodies that took part in a contact.
  const std::set<BodyId>& touched() const { return touched_; }

 private:
  struct OpenImpact {
    Impact impact;
    std::size_t rank;
  };
  void add_to_impact(const ContactEvent& event, double impulse);

  BodyId pen_;
  std::size_t count_ = 0;
  double largest_impulse_ = 0;
  std::map<BodyId, OpenImpact> open_;  // the last of each ball
  Strongest<Impact> impacts_{1 << 13};
  Strongest<Hit> hits_{500};
  TouchFinder touches_;
  std::set<BodyId> touched_;
};

}  // namespace intaglio::report
