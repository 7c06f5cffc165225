// The memory that a scene takes, estimated from its settings and from the headers of its textures, before
// anything is made. `tools/budget_table` prints it beside measurements. Any thread; milliseconds.
#pragma once

#include "core/budget.h"
#include "intaglio/error.h"
#include "scene/scene.h"

namespace intaglio::scene {

enum class Use {
  shown,  // simulated, drawn, and written to files as it goes
  kept,   // the same, and all of it kept until the end: session/recording.h
};

// More bodies are refused whatever memory is allowed: a physics step of so many takes a second.
inline constexpr std::size_t max_bodies = 16'384;

MemoryCost memory_cost(const Scene& scene, Use use);

// Fails beyond max_bodies, and when the cost is beyond scene.allowed_memory.
Result<void> check_cost(const Scene& scene, Use use);

}  // namespace intaglio::scene
