// Prints one hash for each sense, of what it computes: the same on every processor and with every compiler.
// docs/determinism.md says what holds where.
//
//   determinism_probe                    the hashes
//   determinism_probe --expect FILE      compares with those kept there; INTAGLIO_KEEP_HASHES=1 keeps these
//   determinism_probe --all-kernels      the sound with each of the resonator's kernels, which must be equal
//   determinism_probe --threads N        everything N times at once, which must be equal
//   determinism_probe --numbers FOLDER   also writes the numbers behind the hashes, a text file a sense
//   determinism_probe --libm             hashes of libm's own functions: they do depend on the processor
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "core/hash.h"
#include "core/portable_math.h"
#include "sound/resonator_kernel.h"
#include "tests/determinism/senses.h"

using namespace intaglio;
using determinism::Outcome;
using determinism::Sense;

namespace {

// Debian compiles Bullet for ARM with fused multiply-add: what it computes is then its own.
#ifdef __aarch64__
constexpr bool bullet_is_fused = true;
#else
constexpr bool bullet_is_fused = false;
#endif

using Hashes = std::map<std::string, std::string>;

std::string text(std::uint64_t hash) {
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(hash));
  return out;
}

Hashes read(const std::string& file) {
  Hashes out;
  std::ifstream in(file);
  for (std::string name, hash; in >> name >> hash;) out[name] = hash;
  return out;
}

// Functions of the C library that no sense calls any more.
int libm() {
  Hash doubles;
  Random random(1);
  for (int k = 0; k < 500'000; ++k) {
    const double x = random.uniform(-20, 20), y = random.uniform(0.1, 3);
    for (const double value : {std::sin(x), std::exp(x), std::log(y), std::pow(y, x), std::atan2(x, y)})
      doubles.add(value);
  }
  std::printf("libm doubles %s\n", text(doubles.value()).c_str());
  // Bullet turns bodies by sines of single precision, of an eighth of a turn at most: here are all of those.
  Hash floats;
  for (float x = 1e-9f; x < 0.4f; x = std::nextafterf(x, 1)) {
    float both[2];
    both[0] = ::sinf(x);
    both[1] = ::cosf(x);
    floats.add(std::span<const float>(both));
  }
  std::printf("libm sines of Bullet's floats %s\n", text(floats.value()).c_str());
  return 0;
}

int all_kernels(const std::vector<Sense>& senses) {
  std::map<std::uint64_t, int> seen;
  for (const std::string& target : sound::ring_targets()) {
    sound::use_ring_target(target);
    for (const Sense& sense : senses) {
      if (sense.name != "audio") continue;
      const std::uint64_t hash = sense.run().hash;
      ++seen[hash];
      std::printf("%-12s %s\n", target.c_str(), text(hash).c_str());
    }
  }
  return seen.size() == 1 ? 0 : 1;
}

int in_threads(const std::vector<Sense>& senses, int count) {
  std::vector<std::string> out(std::size_t(count));
  std::vector<std::thread> threads;
  for (std::string& all : out)
    threads.emplace_back([&] {
      for (const Sense& sense : senses) all += sense.name + " " + text(sense.run().hash) + "\n";
    });
  for (std::thread& thread : threads) thread.join();
  std::printf("%s", out[0].c_str());
  for (const std::string& all : out)
    if (all != out[0]) return std::printf("threads differ:\n%s", all.c_str()), 1;
  return 0;
}

}  // namespace

int main(int count, char** words) {
  const std::string verb = count > 1 ? words[1] : "", value = count > 2 ? words[2] : "";
  const std::vector<Sense> senses = determinism::senses();
  if (verb == "--libm") return libm();
  if (verb == "--all-kernels") return all_kernels(senses);
  if (verb == "--threads") return in_threads(senses, std::max(1, std::atoi(value.c_str())));
  const Hashes expected = verb == "--expect" ? read(value) : Hashes{};
  Hashes got;
  int differ = 0;
  for (const Sense& sense : senses) {
    const Outcome outcome = sense.run();
    const std::string hash = got[sense.name] = text(outcome.hash);
    const bool is_other =
        verb == "--expect" && (!expected.contains(sense.name) || expected.at(sense.name) != hash);
    const bool is_bullets = is_other && sense.asks_bullet && bullet_is_fused;
    differ += is_other && !is_bullets ? 1 : 0;
    std::printf("%-10s %s  %s%s\n", sense.name.c_str(), hash.c_str(), sense.about.c_str(),
                is_bullets ? "  differs, as this libbullet does"
                : is_other ? "  DIFFERS"
                           : "");
    std::fflush(stdout);
    if (verb == "--numbers") {
      std::ofstream file(std::filesystem::path(value) / (sense.name + ".txt"));
      file.precision(17);
      for (const double x : outcome.numbers) file << x << '\n';
    }
  }
  if (verb == "--expect" && std::getenv("INTAGLIO_KEEP_HASHES") != nullptr) {
    std::ofstream file(value);
    for (const Sense& sense : senses) file << sense.name << ' ' << got[sense.name] << '\n';
    return 0;
  }
  if (differ > 0)
    std::printf(
        "%d of %zu differ from %s. If what is computed was changed on purpose, keep the new ones:\n"
        "INTAGLIO_KEEP_HASHES=1 %s --expect %s\n",
        differ, senses.size(), value.c_str(), words[0], value.c_str());
  return differ > 0 ? 1 : 0;
}
