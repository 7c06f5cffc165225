// The decoders behind image_file.h, one for each format, and what they share. Internal to surface/.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "intaglio/core/error.h"
#include "intaglio/surface/image_file.h"

namespace intaglio::surface {

using Bytes = std::span<const std::uint8_t>;

bool is_png(Bytes bytes);
bool is_jpeg(Bytes bytes);
bool is_exr(Bytes bytes);
bool may_be_tga(Bytes bytes);  // the header is one that a TGA could have

Result<DecodedImage> decode_png(Bytes bytes, const std::string& name, const ImageLimits& limits);
Result<DecodedImage> decode_jpeg(Bytes bytes, const std::string& name, const ImageLimits& limits);
Result<DecodedImage> decode_tga(Bytes bytes, const std::string& name, const ImageLimits& limits);
Result<DecodedImage> decode_exr(Bytes bytes, const std::string& name, const ImageLimits& limits);

// An error at a byte of the file. What files and libraries say is made printable.
tl::unexpected<Error> fail_at(const std::string& name, std::uint64_t byte, std::string what,
                              std::string fix = {});

// Is a declared size within the limits? `where` is the file, or the file and the byte that declares the size.
Result<void> check_size(const std::string& where, std::int64_t width, std::int64_t height,
                        const ImageLimits& limits);

std::string at_byte(const std::string& name, std::uint64_t byte);  // "name: byte 12"

}  // namespace intaglio::surface
