// The design of an experiment: what is varied, what each participant goes through, and what is to be tested.
//
// A design is a TOML file beside the files that it names (a scene, texts in other languages, pictures).
// Keys, ranges and defaults: docs/study-design.md. Reading checks all that can be wrong before a participant
// sits down: names that refer to nothing, scene keys that do not exist, texts that a language lacks, orders
// that cannot be had. The same files give the same design and hash on every machine. Values only, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"
#include "study/design/overrides.h"

namespace intaglio::study {

// Bounds of a design, which hostile files meet.
inline constexpr std::size_t most_materials = 64, most_factors = 8, most_levels = 32, most_questions = 128,
                             most_steps = 64, most_texts = 512, most_trials = 512 /* of a block */,
                             most_session_trials = 2048, most_languages = 16;
inline constexpr int most_participants = 10'000;

struct StudyMaterial {
  std::string name;    // also the default of its texture
  std::string label;   // shown to participants; empty: none
  std::string family;  // materials that sound alike
  Overrides set;       // surface.texture, and what else belongs to it
};

struct Level {
  std::string name;
  std::string say;  // key of the text that is shown before a trial; empty: nothing is said
  Overrides set;
  std::string line;  // "file:line", for errors
};

struct Factor {
  // cross: a block's trials have its levels, in turn. split: each person meets a material at one level
  // only, and each level with an equal share of the materials.
  enum class Assign { cross, split };
  std::string name;
  Assign assign = Assign::cross;
  std::vector<Level> levels;
};

struct Question {
  enum class Kind { choice, yes_no, rating, frequency, tlx, text };
  std::string name;
  Kind kind = Kind::rating;
  std::string text;                  // key of the text that asks
  int low = 1, high = 10;            // of a rating, in steps of 1
  std::string low_says, high_says;   // keys; empty: none
  std::vector<std::string> choices;  // keys; of a frequency: from always to never
  bool is_required = true;
  bool has_weights = false;  // of tlx: the 15 comparisons of pairs are asked, too
};

enum class Order { fixed, latin, williams, shuffle };

// An order that a shuffle must have.
struct Constraints {
  int max_run = 0;  // at most so many trials of one condition in a row; 0: any number
  int apart = 0;    // trials of one material are at least so far apart (2: never in a row); 0: anyhow
};

struct Adaptive {
  enum class Method { staircase, quest };
  Method method = Method::staircase;
  Overrides set;                         // with the placeholder for the amount
  std::string question;                  // whose answer says whether it was noticed
  double low = 0, high = 1;              // of the amount
  double start = 0.5;                    // of a staircase
  double step = 0.1;                     // of a staircase, at first
  double smallest_step = 0.01;           // halved down to this at each reversal
  int down = 2, up = 1;                  // noticed so often: less; missed so often: more
  int reversals = 8;                     // of a staircase: stops after so many
  int grid = 61;                         // amounts that QUEST+ may present, from low to high
  double guess = 0.02;                   // noticed though there is nothing
  double lapse = 0.02;                   // missed though it is plain
  double slope_low = 1, slope_high = 8;  // of the Weibull function, a grid of 12 between them
  double precision = 0;    // QUEST+ stops when the threshold's deviation is below this share of it; 0: never
  double catch_share = 0;  // of the trials: the amount is `low`, and "noticed" is a false alarm
};

// When a practice is over.
struct Criterion {
  double seconds = 0;                    // at least
  int contacts = 0;                      // of pen and surface, at least
  int correct = 0, of = 0, at_most = 0;  // so many right among the last so many trials; 0: none is asked
  bool ends_session = false;             // where it is not met in at_most trials; otherwise the study goes on
};

enum class StepKind { consent, instructions, preview, practice, block, pause, questionnaire, end };
const char* name_of(StepKind kind);

// A [[step]] of the session.
struct StepDesign {
  StepKind kind = StepKind::instructions;
  std::string name;
  std::string text;                   // key of what is said; empty: nothing
  std::vector<std::string> pictures;  // file names beside the design
  std::string scene;                  // file of its own, otherwise the design's
  std::string scene_text;             // that file's content
  Overrides set;
  double seconds = 0;                 // expected, or least of a pause; 0: estimated
  std::optional<double> time_limit;   // s a trial, a practice or a preview
  bool ends_with_answer = true;       // at the limit an answer is asked; otherwise the trial is missed
  std::vector<std::string> ask;       // questions after each trial, or of the questionnaire
  std::vector<std::string> ask_item;  // of free switching: questions about each item
  Criterion criterion;
  // Blocks and practices with trials:
  std::vector<std::string> factors;    // crossed, the first slowest
  std::vector<std::string> levels;     // of a single factor: the trials one by one, instead of crossing
  std::vector<std::string> materials;  // that the trials take in turn; empty: all
  int trials = 0;                      // 0: as many as levels or crossings (at least one for each material)
  int repeats = 1;
  Order order = Order::fixed, material_order = Order::latin;
  Constraints constraints;
  bool is_free = false;  // the trials are one step, between which the person switches at will
  Overrides show;        // with the placeholder for the texture that the pen's button cycles
  std::optional<Adaptive> adaptive;
  int break_after = 0;        // trials; 0: no breaks
  double break_seconds = 30;  // at least
  std::string break_text;
  std::string line;
};

struct Consent {
  std::string version, text;  // text: a key
};

struct Devices {
  enum class Pen { any, mouse, vrpn, gamepad };
  Pen pen = Pen::any;
  bool needs_force = false, needs_sound = true, needs_calibration = false;
};

// Data that the analysis leaves out, decided before they are seen.
struct Exclude {
  std::optional<double> faster_than, slower_than;                           // s, a trial
  std::optional<int> dropped_audio, guard_trips, reconnects, focus_losses;  // more than so many in a trial
  std::optional<double> late_frames;                                        // more than this share in a trial
  std::optional<double> rate_below;          // a person's share of right answers
  std::optional<double> false_alarms_above;  // a person's share in catch trials
  std::optional<int> missing_above;          // a person's trials without an answer
  bool practice_failed = false;              // a person who did not meet a criterion
};

struct Family {
  enum class Correction { holm, bonferroni, none };
  std::string name;
  double alpha = 0.05;
  Correction correction = Correction::holm;
};

struct Hypothesis {
  enum class Test { paired, independent, welch, wilcoxon, mann_whitney, mixed, chance };
  enum class Direction { two_sided, greater, less };
  std::string name, family;
  std::string says;     // in words
  std::string measure;  // "correct", "time", "threshold" or a question
  std::string factor;
  std::vector<std::string> compare;  // two levels of the factor; one for Test::chance
  Test test = Test::paired;
  Direction direction = Direction::two_sided;
  std::optional<double> margin;  // claims no difference beyond this (equivalence)
  std::optional<double> effect;  // that is expected, instead of AnalysisPlan's
};

// For the power: an effect in deviations, or rates of right answers that are simulated.
struct AnalysisPlan {
  std::optional<double> effect;         // Cohen's d: of differences for paired tests, of groups otherwise
  std::map<std::string, double> rates;  // of right answers, by level
  double person_deviation = 0;          // of persons' log odds, for rates
  double power = 0.8;                   // that is wanted
};

struct StopRule {
  int participants = 12;
  std::optional<double> session_minutes;  // then the session goes on at its questionnaire
};

// Every file that a design consists of.
struct DesignFile {
  std::string name, sha256;
};

struct Design {
  std::string name;  // path, for messages
  std::string title = "Untitled";
  std::uint64_t seed = 1;
  std::string scene;       // file of the scene of all trials; empty: the default scene
  std::string scene_text;  // its content
  Overrides set;
  std::string language = "en";
  std::map<std::string, std::string> language_files;                // of the other languages
  std::map<std::string, std::map<std::string, std::string>> texts;  // language, key
  std::optional<Consent> consent;
  Devices devices;
  StopRule stop;
  std::vector<StudyMaterial> materials;
  std::vector<Factor> factors;
  std::vector<Question> questions;
  std::vector<StepDesign> steps;
  Exclude exclude;
  std::vector<Family> families;
  std::vector<Hypothesis> hypotheses;
  AnalysisPlan analysis;
  std::vector<DesignFile> files;  // the design itself, then those that it names, in its order
  std::string hash;               // SHA-256 over all of them

  const StudyMaterial* find_material(std::string_view name) const;
  const Factor* find_factor(std::string_view name) const;
  const Question* find_question(std::string_view name) const;
  // The text of a key in a language; empty for an empty key.
  const std::string& text(const std::string& key, const std::string& language) const;
};

// A design from text alone: the files that it names are not looked at. `name` is the file, for errors.
Result<Design> parse_design(std::string_view text, const std::string& name);
// Adds the texts of a language; each key of the design's own language must be there, and no other.
Result<void> parse_texts(std::string_view text, const std::string& name, const std::string& language,
                         Design& design);
// A design with all its files, each of which is looked for in the working folder, then beside it.
Result<Design> read_design(const std::filesystem::path& path);

// The trial scenes' own check: every combination of a step's levels and materials makes a scene.
Result<void> check_scenes(const Design& design);

}  // namespace intaglio::study
