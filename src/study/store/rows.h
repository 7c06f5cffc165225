// The rows of a study store, as the runner gives them and as analyses read them. docs/study-store.md has the
// tables. The store gives no meaning to keys, items and values: they are the design's words.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace intaglio::study {

struct DesignRow {
  std::string hash;  // by which sessions name it
  std::string name;
  std::string text;  // the design file
  std::int64_t seed = 0;
};

// Before a session begins: who, under which design, with what.
struct NewSession {
  std::string participant;              // pseudonymous: letters, digits, - and _; at most 32
  std::int64_t participant_number = 0;  // the one that the order is derived from
  std::string design_hash;              // of a design that add_design() has stored
  std::string build;                    // version of the program
  std::string device;                   // how the surface was touched
  std::string settings;                 // of the session, as text
  std::string consent_version, consent_hash;
  bool synthetic = false;  // no person
};

struct SessionRow : NewSession {
  std::string id;               // 32 hexadecimal digits, random
  std::string origin;           // the store in which it was made
  std::int64_t started_ms = 0;  // ms since 1970, UTC, by this machine's clock at that time
  std::optional<std::int64_t> ended_ms;
  std::string outcome;  // "running" until end_session()
};

// A step of a session's plan: a trial, a page of instructions, a questionnaire.
struct StepRow {
  std::string session;
  std::int64_t number = 0;  // from 0, in the plan's order
  std::string kind;         // "trial", "practice", "questionnaire", ...
  std::string block;
  std::optional<std::int64_t> trial;  // the number of the trial, from 1
  std::string material, representation, cues;
  std::map<std::string, std::string> conditions;  // scene keys and what the design adds
  double started_s = 0;                           // seconds of the session's clock
  std::optional<double> ended_s;
  std::int64_t attempts = 1;  // how often it was begun: more than one after a resume
  bool synthetic = false;
};

struct AnswerRow {
  std::string session;
  std::int64_t step = 0;
  std::string item;    // the question
  std::string value;   // the answer
  double seconds = 0;  // of the session's clock
  std::int64_t wall_ms = 0;
  bool synthetic = false;
};

struct EventRow {
  std::string session;
  std::string kind;  // pause, resume, skip, note, unblind, device_lost, ...
  std::optional<std::int64_t> step;
  std::string detail;
  double seconds = 0;
  std::int64_t wall_ms = 0;
  bool synthetic = false;
};

// A counter of a step: dropped_audio, late_frames, guard_trips, reconnects, focus_losses.
struct QualityRow {
  std::string session;
  std::int64_t step = 0;
  std::string counter;
  std::int64_t value = 0;
};

// Where a session goes on, with what the runner needs for it.
struct Checkpoint {
  std::int64_t next_step = 0;
  double seconds = 0;      // of the session's clock
  std::string procedures;  // the state of adaptive procedures, in the runner's form
  std::string generator;   // the state of the random generator
};

struct StreamRow {
  std::string session, stream;
  std::int64_t step = 0, attempt = 1;
  std::string file;                   // in the folder beside the store
  std::optional<std::string> sha256;  // none: still open
  std::int64_t bytes = 0, records = 0, dropped = 0;
  bool is_complete = false;  // false: its process was killed
};

struct ExportRow {
  std::int64_t made_ms = 0;
  std::string kind, target;
};

}  // namespace intaglio::study
