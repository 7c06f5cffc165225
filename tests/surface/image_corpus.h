// Broken image files, made from good ones or by hand: the corpus of test_image_malformed.cpp.
#pragma once

#include <string>
#include <vector>

#include "tests/surface/image_encoders.h"

namespace intaglio::surface::corpus {

using encoders::File;

enum class Expect { error, anything };

struct BadFile {
  std::string name;
  File bytes;
  Expect expect = Expect::error;
};

using Corpus = std::vector<BadFile>;

void add_png(Corpus& corpus);
void add_jpeg(Corpus& corpus);
void add_tga(Corpus& corpus);
void add_exr(Corpus& corpus);

// A good file cut at many places, and with each of many bits flipped.
void add_damaged(Corpus& corpus, const std::string& name, const File& good);

Corpus make_corpus();  // all of these, of all formats

// The picture that is broken: 24 x 17.
Image8 small_picture(int channels);
Image<float> small_floats(int channels);

}  // namespace intaglio::surface::corpus
