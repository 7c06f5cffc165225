// glTF files made of the fuzzer's bytes, correct but for what the bytes make wrong: nodes, meshes, accessors
// and views; buffers inside the file and beside it. A valid mesh or one clear error on one line; nothing but
// names below the file's folder is asked for.
#include <fuzzer/FuzzedDataProvider.h>

#include <nlohmann/json.hpp>

#include "fuzz/mesh_checks.h"
#include "mesh/mesh_file.h"

using namespace intaglio;
using namespace intaglio::surface;
using fuzz::require;
using nlohmann::json;

namespace {

// One time in sixteen, something else; never once the bytes are used up.
bool is_wrong(FuzzedDataProvider& in) {
  return in.ConsumeIntegralInRange(0, 15) == 15;
}
json wild(FuzzedDataProvider& in) {
  switch (in.ConsumeIntegralInRange(0, 6)) {
    case 0:
      return in.ConsumeIntegral<std::int64_t>();
    case 1:
      return in.ConsumeFloatingPoint<double>();
    case 2:
      return in.ConsumeRandomLengthString(20);
    case 3:
      return json::array({1, -1, 1e308});
    case 4:
      return json::object();
    case 5:
      return std::uint64_t{1} << in.ConsumeIntegralInRange(0, 63);
    default:
      return nullptr;
  }
}
template <class T>
json mostly(FuzzedDataProvider& in, const T& right) {
  return is_wrong(in) ? wild(in) : json(right);
}
// An index, mostly `right`, else one up to `most`.
json index(FuzzedDataProvider& in, std::size_t right, std::size_t most) {
  return mostly(in, is_wrong(in) ? in.ConsumeIntegralInRange<std::size_t>(0, most) : right);
}
json numbers(FuzzedDataProvider& in, int count) {
  json list = json::array();
  for (int k = 0; k < count; ++k) list.push_back(mostly(in, 1 + 0.25 * in.ConsumeIntegralInRange(-8, 8)));
  return list;
}

// The first buffer has small floats and the second small indices, so that triangles have area and exist.
std::vector<std::uint8_t> buffer_bytes(FuzzedDataProvider& in, std::size_t k, std::size_t size) {
  std::vector<std::uint8_t> bytes =
      in.ConsumeBytes<std::uint8_t>(in.ConsumeIntegralInRange<std::size_t>(0, size));
  while (bytes.size() < size) bytes.push_back(std::uint8_t(89 * bytes.size()));
  for (std::size_t at = 0; k == 0 && at + 4 <= size; at += 4) {
    const float value = 0.125f * float(std::int8_t(bytes[at]));
    std::memcpy(&bytes[at], &value, sizeof value);
  }
  for (std::size_t at = 0; k == 1 && at < size; ++at)
    bytes[at] = at % 4 == 0 ? std::uint8_t(bytes[at] / 4 % 9) : 0;
  return bytes;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at + 3 <= bytes.size(); at += 3) {
    const unsigned three = bytes[at] << 16 | bytes[at + 1] << 8 | bytes[at + 2];
    for (int shift = 18; shift >= 0; shift -= 6) text += letters[three >> shift & 63];
  }
  return text;
}

constexpr std::size_t buffers = 3, views = 3, accessors = 6, meshes = 2, nodes = 5;

json make_views(FuzzedDataProvider& in, std::size_t size) {
  json list = json::array();
  for (std::size_t k = 0; k < views; ++k) {
    const auto offset = is_wrong(in) ? 4 * in.ConsumeIntegralInRange<std::size_t>(0, size / 4) : 0;
    json view{
        {"buffer", index(in, k, buffers)}, {"byteOffset", offset}, {"byteLength", mostly(in, size - offset)}};
    if (is_wrong(in)) view["byteStride"] = index(in, 16, 260);
    list.push_back(std::move(view));
  }
  return list;
}

// Positions, UVs, indices, then normals, UVs, indices.
json make_accessors(FuzzedDataProvider& in) {
  static constexpr const char* types[] = {"VEC3", "VEC2", "SCALAR"};
  const int count = 9 - 3 * in.ConsumeIntegralInRange(0, 2);
  json list = json::array();
  for (std::size_t k = 0; k < accessors; ++k) {
    const bool is_index = k % 3 == 2;
    const int component = is_index ? in.PickValueInArray({5125, 5123, 5121}) : is_wrong(in) ? 5123 : 5126;
    json accessor{{"bufferView", index(in, is_index ? 1 : 0, views)},
                  {"componentType", mostly(in, component)},
                  {"count", mostly(in, is_wrong(in) ? 3 * in.ConsumeIntegralInRange(0, 9) : count)},
                  {"type", mostly(in, types[k % 3])}};
    if (in.ConsumeBool()) accessor["byteOffset"] = index(in, 4, 40);
    if (is_wrong(in)) accessor["normalized"] = true;
    list.push_back(std::move(accessor));
  }
  return list;
}

json make_meshes(FuzzedDataProvider& in) {
  json list = json::array();
  for (std::size_t k = 0; k < meshes; ++k) {
    json attributes{{"POSITION", index(in, 0, accessors)}};
    if (in.ConsumeBool()) attributes["NORMAL"] = index(in, 3, accessors);
    if (!is_wrong(in)) attributes["TEXCOORD_0"] = index(in, 1, accessors);
    json primitive{{"attributes", attributes}};
    if (in.ConsumeBool()) primitive["indices"] = index(in, 2, accessors);
    if (is_wrong(in)) primitive["mode"] = index(in, 4, 7);
    list.push_back({{"primitives", json::array({primitive})}});
  }
  return list;
}

json make_nodes(FuzzedDataProvider& in) {
  json list = json::array();
  for (std::size_t k = 0; k < nodes; ++k) {
    json node = json::object();
    if (!in.ConsumeBool()) node["mesh"] = index(in, k % meshes, meshes);
    if (k + 1 < nodes && in.ConsumeBool()) node["children"] = json::array({index(in, k + 1, nodes)});
    if (is_wrong(in)) node["matrix"] = numbers(in, 16);
    if (in.ConsumeBool()) node["scale"] = numbers(in, 3);
    if (in.ConsumeBool()) node["rotation"] = numbers(in, 4);
    if (is_wrong(in)) node["translation"] = numbers(in, 3);
    list.push_back(std::move(node));
  }
  return list;
}

std::string side_name(FuzzedDataProvider& in) {
  static constexpr const char* outside[] = {"../a.bin", "/a.bin", "file:a", "a\\b", "%2e%2e/a", "a\n"};
  if (is_wrong(in)) return outside[in.ConsumeIntegralInRange<std::size_t>(0, std::size(outside) - 1)];
  return is_wrong(in) ? in.ConsumeRandomLengthString(20) : "b/c%20d.bin";
}

struct Side {
  std::string uri;
  std::vector<std::uint8_t> bytes;
};

struct Document {
  json root;
  std::vector<Side> sides;
  std::vector<std::uint8_t> chunk;  // of a GLB
  mutable std::size_t loads = 0;

  explicit Document(FuzzedDataProvider& in) {
    const std::size_t size = 120 - 12 * in.ConsumeIntegralInRange<std::size_t>(0, 9);
    json list = json::array();
    for (std::size_t k = 0; k < buffers; ++k) {
      const std::vector<std::uint8_t> bytes = buffer_bytes(in, k, size);
      json buffer{{"byteLength", mostly(in, size)}};
      switch (in.ConsumeIntegralInRange(0, 2)) {
        case 0:
          sides.push_back({side_name(in), bytes});
          buffer["uri"] = sides.back().uri;
          break;
        case 1:
          buffer["uri"] = "data:application/octet-stream;base64," + base64(bytes);
          break;
        default:
          chunk = bytes;
      }
      list.push_back(std::move(buffer));
    }
    root = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", json::array({{{"nodes", json::array({0})}}})},
            {"buffers", list},
            {"bufferViews", make_views(in, size)},
            {"accessors", make_accessors(in)},
            {"meshes", make_meshes(in)},
            {"nodes", make_nodes(in)}};
    if (is_wrong(in)) root.erase("scenes");
    if (is_wrong(in)) root[in.PickValueInArray({"nodes", "accessors", "buffers", "asset"})] = wild(in);
  }

  std::vector<std::uint8_t> file(bool is_glb) const {
    std::string text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    if (!is_glb) return {text.begin(), text.end()};
    std::vector<std::uint8_t> bytes;
    const auto put = [&](std::size_t value) {
      for (int shift = 0; shift < 32; shift += 8) bytes.push_back(std::uint8_t(value >> shift));
    };
    text.resize((text.size() + 3) / 4 * 4, ' ');
    for (const std::size_t word : {std::size_t{0x46546c67}, std::size_t{2}, 28 + text.size() + chunk.size(),
                                   text.size(), std::size_t{0x4e4f534a}})
      put(word);
    bytes.insert(bytes.end(), text.begin(), text.end());
    put(chunk.size());
    put(0x004e4942);
    bytes.insert(bytes.end(), chunk.begin(), chunk.end());
    return bytes;
  }

  Result<std::vector<std::uint8_t>> load(const std::string& uri, std::size_t limit) const {
    // No part is the folder above; a name such as "a..b" is one.
    require(!uri.empty() && uri.front() != '/' && ("/" + uri + "/").find("/../") == std::string::npos &&
            uri.find_first_of(":\\") == std::string::npos && limit <= max_mesh_file_bytes);
    if (uri != "b/c d.bin") return fail(uri, "no such file");
    return sides[loads++ % sides.size()].bytes;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider in(data, size);
  const bool is_glb = in.ConsumeBool();
  const MeshUse use = in.ConsumeBool() ? MeshUse::shape : MeshUse::texture;
  const Document document(in);
  std::vector<std::uint8_t> file = document.file(is_glb);
  for (int flips = in.ConsumeIntegralInRange(0, 2); flips > 0; --flips)
    file[in.ConsumeIntegralInRange<std::size_t>(0, file.size() - 1)] ^= in.ConsumeIntegral<std::uint8_t>();
  const auto load = [&](const std::string& uri, std::size_t limit) { return document.load(uri, limit); };
  fuzz::examine(parse_gltf(file, "fuzz", load, use));
  return 0;
}
