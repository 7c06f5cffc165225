#include "intaglio/contact/relief.h"

#include "intaglio/contact/question.h"
#include "intaglio/contact/round_pairs.h"

namespace intaglio::contact {

namespace {

struct Pairs {
  const surface::Surface& surface;
  Candidates& found;

  void operator()(const Shape& shape, const Frame& frame, int child) const {
    if (const auto* sphere = std::get_if<Sphere>(&shape))
      ball_pairs(surface, frame.origin, sphere->radius, 0, child, found);
  }
};

}  // namespace

ContactSet relief_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                           double margin) {
  ContactSet set;
  const Question question(surface, shape, pose, margin);
  set.status = question.wrong;
  if (question.hopeless) return set;
  Candidates found(question.margin);
  set.status |= for_each_part(shape, question.frame, Pairs{surface, found});
  if (found.overflowed()) set.status |= status::limit;
  found.choose(surface, set);
  return set;
}

}  // namespace intaglio::contact
