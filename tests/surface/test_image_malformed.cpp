// Each broken image file gives an error of one line or an image; none causes an allocation of its claimed
// size.
#include <doctest/doctest.h>

#include <algorithm>

#include "surface/image/image_file.h"
#include "tests/count_allocations.h"
#include "tests/surface/image_corpus.h"

using namespace intaglio;
using namespace intaglio::surface;
using namespace intaglio::surface::corpus;

TEST_CASE("malformed files give an error of one line or an image, without large allocations") {
  const Corpus corpus = make_corpus();
  CHECK(corpus.size() >= 100);
  std::size_t errors = 0;
  for (const BadFile& file : corpus) {
    CAPTURE(file.name);
    forget_allocations();
    const auto image = decode_image(file.bytes, file.name);
    CHECK(largest_allocation() < (256u << 20));
    if (file.expect == Expect::error) CHECK_FALSE(image);
    if (image) continue;
    ++errors;
    const std::string message = image.error().message();
    CAPTURE(message);
    CHECK(message.find(file.name + ": ") == 0);
    CHECK(std::none_of(message.begin(), message.end(), [](char c) { return c == '\n' || c == '\r'; }));
    const bool says_where =
        message.find("byte") != std::string::npos || message.find("pixel") != std::string::npos;
    CHECK((says_where || file.name.ends_with(".jpg")));
  }
  MESSAGE(corpus.size() << " malformed files, " << errors << " errors");
}
