// The wire format against frames written by hand from its description.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <limits>

#include "haptics/vrpn/client.h"
#include "haptics/vrpn/message.h"
#include "tests/haptics/vrpn_reencode.h"

using namespace intaglio;
using namespace intaglio::haptics::vrpn;

namespace {

Bytes bytes_of(std::string_view hex) {
  Bytes out;
  std::string digits;
  for (const char c : hex) {
    if (c == ' ') continue;
    digits += c;
    if (digits.size() < 2) continue;
    out.push_back(std::uint8_t(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return out;
}

std::string text_after(const Bytes& head, std::string_view text) {
  return std::string(text_of(head)) + std::string(text);
}

template <class T>
Bytes payload_of(const T& message) {
  Bytes out;
  encode(out, message);
  return out;
}

constexpr double quiet_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr float not_a_float = std::numeric_limits<float>::quiet_NaN();

}  // namespace

TEST_CASE("the cookie has 24 bytes and is compared up to the last dot") {
  const auto ours = our_cookie();
  CHECK(std::string_view(reinterpret_cast<const char*>(ours.data()), 24) ==
        std::string_view("vrpn: ver. 07.38  0\0\0\0\0\0", 24));
  const auto match = [](std::string text) {
    text.resize(cookie_size, '\0');
    return read_cookie(Bytes(text.begin(), text.end())).match;
  };
  CHECK(match("vrpn: ver. 07.38  0") == CookieMatch::same);
  CHECK(match("vrpn: ver. 07.38  3") == CookieMatch::same);
  CHECK(match("vrpn: ver. 07.35  0") == CookieMatch::other_minor_version);
  CHECK(match("vrpn: ver. 06.38  0") == CookieMatch::not_vrpn);
  CHECK(match("vrpn: ver. 07.38  4") == CookieMatch::not_vrpn);
  CHECK(match("GET / HTTP/1.1\r\nHost: a") == CookieMatch::not_vrpn);
  CHECK(match("") == CookieMatch::not_vrpn);
}

TEST_CASE("a button change has the bytes of its description") {
  //                               length   seconds  microsec sender   type     sequence button   state
  const Bytes frame = bytes_of("00000020 00000001 00000002 00000003 00000004 00000005 00000001 00000001");
  const ParsedMessage parsed = parse_message(frame);
  REQUIRE(parsed.frame == Frame::complete);
  CHECK(parsed.size == 32);
  CHECK(parsed.message.time.seconds == 1);
  CHECK(parsed.message.time.microseconds == 2);
  CHECK(parsed.message.sender == 3);
  CHECK(parsed.message.type == 4);
  CHECK(parsed.message.sequence == 5);
  const auto change = decode_button_change(parsed.message.payload);
  REQUIRE(change);
  CHECK(change->button == 1);
  CHECK(change->state == 1);
  Bytes again;
  append_message(again, parsed.message);
  CHECK(again == frame);
}

TEST_CASE("a name is padded to a multiple of eight, and the length does not count the padding") {
  // 24 + 4 + "Phantom0\0"
  const std::string frame =
      text_after(bytes_of("00000025 00000000 00000000 00000001 ffffffff 00000000 00000009"),
                 std::string_view("Phantom0\0\0\0\0", 12));
  Bytes out, payload;
  encode_name(payload, "Phantom0");
  append_message(out, {{}, 1, sender_description, 0, payload});
  CHECK(std::string(text_of(out)) == frame);
  const ParsedMessage parsed = parse_message(out);
  CHECK(parsed.size == 40);
  CHECK(decode_name(parsed.message.payload) == "Phantom0");
  CHECK(parse_message(ByteView(out).first(39)).frame == Frame::partial);
}

TEST_CASE("poses, forces and planes have the bytes of their descriptions") {
  const Bytes pose = bytes_of(
      "00000001 00000001 3ff0000000000000 4000000000000000 c000000000000000"
      "0000000000000000 0000000000000000 0000000000000000 3ff0000000000000");
  const auto decoded = decode_pos_quat(pose);
  REQUIRE(decoded);
  CHECK(decoded->sensor == 1);
  CHECK(decoded->position == Vec3(1, 2, -2));
  CHECK(decoded->quat == WireQuat{0, 0, 0, 1});
  CHECK(payload_of(*decoded) == pose);

  const Bytes force = bytes_of("3ff0000000000000 0000000000000000 bff0000000000000");
  CHECK(decode_force(force)->newtons == Vec3(1, 0, -1));
  CHECK(payload_of(ForceReport{{1, 0, -1}}) == force);

  const Bytes plane =
      bytes_of("00000000 3f800000 00000000 bf000000 3f4ccccd 3a83126f 00000000 00000000 00000003 00000001");
  const auto p = decode_plane(plane);
  REQUIRE(p);
  CHECK(p->b == 1);
  CHECK(p->d == -0.5f);
  CHECK(p->kspring == 0.8f);
  CHECK(p->kdamp == 0.001f);
  CHECK(p->index == 3);
  CHECK_FALSE(p->off());
  CHECK(payload_of(*p) == plane);

  CHECK(payload_of(ForceField{}).size() == 64);
  CHECK(payload_of(ContactPose{}).size() == 56);
  CHECK(payload_of(PlaneEffects{}).size() == 24);
  CHECK(payload_of(Motion{}).size() == 72);
  CHECK(payload_of(Text{}).size() == 1032);
  CHECK(payload_of(std::vector<std::int32_t>{0, 1}) == bytes_of("00000002 00000000 00000001"));
  CHECK(payload_of(ForceError::force_too_high) == bytes_of("00000002"));
}

TEST_CASE("a length is valid from 24 to 64,000 bytes") {
  Bytes frame(64008);
  const auto with_length = [&](std::int32_t length) {
    Bytes head;
    put(head, length);
    std::copy(head.begin(), head.end(), frame.begin());
    return parse_message(frame);
  };
  for (const std::int32_t bad : {-2147483647 - 1, -24, -1, 0, 23, 64001, 65536, 2147483647}) {
    CHECK(with_length(bad).frame == Frame::bad);
    CHECK(with_length(bad).size == header_size);
  }
  CHECK(with_length(24).size == 24);
  CHECK(with_length(25).size == 32);
  CHECK(with_length(64000).size == 64000);
}

TEST_CASE("numbers that are not finite, and indices out of range, are rejected") {
  for (const double bad : {quiet_nan, infinite, -infinite}) {
    CHECK_FALSE(decode_force(payload_of(ForceReport{{0, bad, 0}})));
    CHECK_FALSE(decode_pos_quat(payload_of(PosQuat{0, {bad, 0, 0}, {}})));
    CHECK_FALSE(decode_pos_quat(payload_of(PosQuat{0, {0, 0, 0}, {0, 0, 0, bad}})));
    CHECK_FALSE(decode_motion(payload_of(Motion{.dt = bad})));
    CHECK_FALSE(decode_scp(payload_of(ContactPose{{0, 0, bad}, {}})));
  }
  CHECK_FALSE(decode_plane(payload_of(PlaneMessage{.kspring = not_a_float})));
  CHECK_FALSE(decode_plane_effects(payload_of(PlaneEffects{.buzz_frequency = not_a_float})));
  ForceField field;
  field.jacobian(2, 1) = not_a_float;
  CHECK_FALSE(decode_force_field(payload_of(field)));
  for (const std::int32_t bad : {-1, plane_limit, 1 << 30})
    CHECK_FALSE(decode_plane(payload_of(PlaneMessage{.index = bad})));
  for (const std::int32_t bad : {-1, button_limit})
    CHECK_FALSE(decode_button_change(payload_of(ButtonChange{bad, 1})));
  for (const std::int32_t bad : {-1, sensor_limit})
    CHECK_FALSE(decode_pos_quat(payload_of(PosQuat{bad, {}, {}})));
  CHECK_FALSE(decode_button_states(bytes_of("7fffffff 00000000")));
  CHECK_FALSE(decode_button_states(bytes_of("00000003 00000000")));
  CHECK_FALSE(decode_force_error(bytes_of("00000005")));
  CHECK_FALSE(decode_update_rate(bytes_of("8000000000000000")));
}

TEST_CASE("names are checked for length, NUL and characters, and ids are bounded") {
  const auto name = [](std::int32_t length, std::string_view text) -> std::optional<std::string> {
    Bytes out;
    put(out, length);
    put(out, text);
    const auto decoded = decode_name(out);
    return decoded ? std::optional(std::string(*decoded)) : std::nullopt;
  };
  CHECK(name(3, std::string_view("ab\0", 3)) == "ab");
  CHECK_FALSE(name(2, std::string_view("ab\0", 3)));
  CHECK_FALSE(name(4, std::string_view("ab\0", 3)));
  CHECK_FALSE(name(2147483647, "ab"));
  CHECK_FALSE(name(-1, "ab"));
  CHECK_FALSE(name(1, std::string_view("\0", 1)));
  CHECK_FALSE(name(3, "abc"));
  CHECK_FALSE(name(4, std::string_view("a\x1b"
                                       "b\0",
                                       4)));
  CHECK(name(100, std::string(99, 'x') + std::string(1, '\0')));
  CHECK_FALSE(name(101, std::string(100, 'x') + std::string(1, '\0')));
  PeerNames names;
  CHECK(names.learn_type(1999, "vrpn_Tracker Pos_Quat"));
  CHECK(names.type(1999) == Type::pos_quat);
  CHECK_FALSE(names.type(3));
  for (const std::int32_t bad : {-1, -2147483647 - 1, 2000, 2147483647}) {
    CHECK_FALSE(names.learn_type(bad, "vrpn_Tracker Pos_Quat"));
    CHECK_FALSE(names.learn_sender(bad, "Phantom0"));
    CHECK_FALSE(names.type(bad));
    CHECK(names.sender(bad).empty());
  }
  for (std::size_t k = 0; k < type_names.size(); ++k) CHECK(find_type(type_names[k]) == static_cast<Type>(k));
}

TEST_CASE("texts end at their NUL, and control characters do not reach a terminal") {
  const auto again = decode_text(payload_of(Text{1, 7, "hot\x1b[31m motor"}));
  REQUIRE(again);
  CHECK(again->severity == 1);
  CHECK(again->level == 7);
  CHECK(again->text == "hot [31m motor");
  CHECK(decode_text(payload_of(Text{0, 0, std::string(5000, 'x')}))->text == std::string(1023, 'x'));
  CHECK_FALSE(decode_text(payload_of(Text{3, 0, ""})));
}

TEST_CASE("a quaternion of any length is a rotation") {
  CHECK(orientation({0, 0, 0, 0}).isApprox(Quat::Identity()));
  CHECK(orientation({0, 0, 1e300, 1e300}).isApprox(Quat(Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitZ()))));
  CHECK(orientation({0, 3, 0, 0}).isApprox(Quat(0, 0, 1, 0)));
}

TEST_CASE("addresses of devices parse, and malformed ones are rejected") {
  CHECK(parse_address("Phantom0@localhost")->text() == "Phantom0@localhost:3883");
  CHECK_FALSE(parse_address("Phantom0@localhost")->tcp_only);
  const auto tcp = parse_address("Phantom0@tcp://10.0.0.7:4500");
  REQUIRE(tcp);
  CHECK(tcp->tcp_only);
  CHECK(tcp->host == "10.0.0.7");
  CHECK(tcp->port == 4500);
  for (const char* bad :
       {"", "Phantom0", "@host", "a@", "a@host:", "a@host:0", "a@host:70000", "a@host:12x", "a@:12"}) {
    CAPTURE(bad);
    CHECK_FALSE(parse_address(bad));
  }
}

TEST_CASE("every payload decodes to what was encoded, and a truncated one is rejected") {
  CHECK(rc::check("round trips", [] {
    const auto number = [] { return *rc::gen::inRange(-1000000, 1000000) / 1024.0; };
    const auto vec = [&] { return Vec3(number(), number(), number()); };
    const auto real = [&] { return float(number()); };
    ForceField field;
    field.origin = vec().cast<float>();
    field.jacobian(1, 2) = real();
    field.radius = std::abs(real());
    const std::vector<std::pair<Type, Bytes>> payloads = {
        {Type::pos_quat, payload_of(PosQuat{*rc::gen::inRange(0, 256), vec(), {number(), 0, 0, number()}})},
        {Type::velocity, payload_of(Motion{*rc::gen::inRange(0, 256), vec(), {0, 0, 0, number()}, number()})},
        {Type::force, payload_of(ForceReport{vec()})},
        {Type::scp, payload_of(ContactPose{vec(), {number(), 0, 0, 1}})},
        {Type::plane, payload_of(PlaneMessage{real(), real(), real(), real(), real(), real(), real(), real(),
                                              *rc::gen::inRange(0, 4), 1})},
        {Type::plane2, payload_of(PlaneEffects{real(), real(), real(), real(), real(), real()})},
        {Type::force_field, payload_of(field)},
        {Type::button_change,
         payload_of(ButtonChange{*rc::gen::inRange(0, 256), *rc::gen::arbitrary<int>()})},
        {Type::button_states,
         payload_of(*rc::gen::container<std::vector<std::int32_t>>(rc::gen::arbitrary<int>()))},
    };
    for (const auto& [type, payload] : payloads) {
      RC_ASSERT(reencode(type, payload) == payload);
      RC_ASSERT_FALSE(reencode(type, ByteView(payload).first(payload.size() - 1)));
      Bytes longer = payload;
      longer.push_back(0);
      RC_ASSERT_FALSE(reencode(type, longer));
    }
  }));
}
