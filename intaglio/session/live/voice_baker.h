// Makes a scene's modal models in a thread of its own, one scene at a time (the solver below stands no
// second one), and never makes anybody wait: what nobody wants any more is finished, kept in the cache, and
// dropped. One thread asks (the window's).
//
// A model that is being made when the baker dies cannot be interrupted: its thread is left behind. A program
// that ends then should do so by std::_Exit; is_busy() tells.
#pragma once

#include <memory>
#include <optional>

#include "intaglio/session/voices.h"

namespace intaglio::session {

class VoiceBaker {
 public:
  VoiceBaker();
  ~VoiceBaker();
  VoiceBaker(const VoiceBaker&) = delete;
  VoiceBaker& operator=(const VoiceBaker&) = delete;

  // Asks for these voices instead of any before; the ticket is for take().
  std::uint64_t ask(const Scene& scene, const SceneSurface& surface, const std::filesystem::path& cache);
  // Once they are there, once.
  std::optional<Result<Voices>> take(std::uint64_t ticket);
  bool is_busy() const;

 private:
  struct Shared;
  static void work(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;
};

}  // namespace intaglio::session
