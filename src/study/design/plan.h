// The session of one participant: its steps in order, each with all that a runner needs.
//
// A plan follows from the design and the participant's number alone, the same on every machine; a store keeps
// only its hash. Only the amounts of an adaptive procedure are not in it, because they depend on answers:
// study/design/procedure.h makes them as the session goes. Values only, any thread. Microseconds a step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "study/design/design.h"

namespace intaglio::study {

// A scene that the person meets: the only one of a trial, or one of those between which they switch.
struct PlannedItem {
  std::string material;             // name; empty: none
  std::vector<std::string> levels;  // "removed=sound", a factor each
  Overrides set;                    // of the step's scene; all but placeholders
};

struct PlannedStep {
  StepKind kind = StepKind::instructions;
  bool is_trial = false;  // of a block or practice; otherwise a page
  std::size_t step = 0;   // of Design::steps; their number for the end
  std::string name;       // of that step
  int trial = 0;          // of the session's trials outside practice, from 1; 0: none
  int place = 0;          // within its block, from 1; 0: no trial
  int listed = 0;         // the number of its condition as the block lists them, from 1; 0: no trial
  std::vector<PlannedItem> items;
  std::vector<std::string> shown;    // materials that the pen's button cycles, the first one first
  std::vector<std::string> notices;  // keys of the texts that are said before
  std::vector<std::string> ask;      // questions afterwards
  std::vector<std::string> ask_item;
  std::string answer;                // the right material; empty: there is none
  std::string track;                 // of an adaptive procedure; empty: none
  bool is_catch = false;             // the procedure's amount is its lowest
  std::optional<double> time_limit;  // s
  double least_seconds = 0;          // of a break or practice
};

struct Plan {
  int participant = 1;
  std::vector<PlannedStep> steps;
};

// Errors: a participant's number out of 1 to most_participants, constraints that no order keeps.
Result<Plan> plan(const Design& design, int participant);

// All of a plan as text, one step a line, and its hash (16 hexadecimal digits).
std::string plan_text(const Plan& plan);
std::string plan_hash(const Plan& plan);

// The level of a split factor at which a participant meets a material (its number in the design).
int split_level(const Design& design, const Factor& factor, int participant, int material);

// The scene of an item: the design's, the step's and the item's keys. `amount` fills the placeholder of an
// adaptive procedure, `shown` names the material that is looked at; both only where the step has them.
Result<scene::Scene> scene_of(const Design& design, const PlannedStep& step, std::size_t item,
                              std::optional<double> amount = std::nullopt, const std::string& shown = {});

}  // namespace intaglio::study
