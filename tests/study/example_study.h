// A small study for the tests of the store: a design, people, steps and answers.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "study/store/store.h"

namespace intaglio::tests {

inline study::DesignRow example_design() {
  return {"d0c5", "example", "[study]\nname = \"example\"\n", 7};
}

inline study::NewSession example_person(const std::string& id, std::int64_t number) {
  study::NewSession person;
  person.participant = id;
  person.participant_number = number;
  person.design_hash = example_design().hash;
  person.build = "intaglio 0.0 (test)";
  person.device = "mouse";
  person.settings = "full_screen = true";
  person.consent_version = "2";
  person.consent_hash = "abcd";
  return person;
}

inline study::StepRow example_step(const std::string& session, std::int64_t number) {
  study::StepRow step;
  step.session = session;
  step.number = number;
  step.kind = "trial";
  step.block = "main";
  step.trial = number + 1;
  step.material = number % 2 == 0 ? "brick" : "gravel";
  step.representation = "relief";
  step.cues = "all";
  step.conditions = {{"pen_sound", "off"}, {"size", "0.5"}};
  step.started_s = 10.0 * double(number);
  return step;
}

// A session with `steps` finished steps of two answers each; returns its id. It has not ended.
inline std::string example_session(study::Store& store, const std::string& id, std::int64_t number,
                                   std::int64_t steps, bool synthetic = false) {
  REQUIRE(store.add_design(example_design()));
  study::NewSession person = example_person(id, number);
  person.synthetic = synthetic;
  const auto session = store.begin_session(person);
  REQUIRE(session);
  for (std::int64_t k = 0; k < steps; ++k) {
    const double time = 10.0 * double(k);
    REQUIRE(store.begin_step(example_step(*session, k)));
    REQUIRE(store.answer(
        {.session = *session, .step = k, .item = "material", .value = "brick", .seconds = time + 3}));
    REQUIRE(
        store.answer({.session = *session, .step = k, .item = "ease", .value = "7", .seconds = time + 5}));
    REQUIRE(
        store.finish_step(*session, k, time + 5, {k + 1, time + 5, "", "state of " + std::to_string(k + 1)}));
  }
  return *session;
}

}  // namespace intaglio::tests
