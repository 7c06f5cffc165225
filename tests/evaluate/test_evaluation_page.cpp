// An evaluation becomes JSON that its schema admits, and a page that is whole by itself. All is invented.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "core/file.h"
#include "evaluate/evaluation_page.h"
#include "tests/evaluate/synthetic_evaluation.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::evaluate;
using nlohmann::json;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

const Evaluation& synthetic() {
  static const Evaluation evaluation = tests::synthetic_evaluation();
  return evaluation;
}

// JSON Schema as far as docs/evaluate.schema.json uses it; any other keyword is an error.
class SchemaCheck {
 public:
  explicit SchemaCheck(const json& root) : root_(root) {}

  std::vector<std::string> errors(const json& value) {
    errors_.clear();
    check(root_, value, "");
    return errors_;
  }

 private:
  void fail(const std::string& at, const std::string& what) { errors_.push_back(at + ": " + what); }

  static bool is_type(const std::string& type, const json& value) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    if (type == "integer") return value.is_number_integer();
    return type == "number" && value.is_number();
  }

  void check(const json& schema, const json& value, const std::string& at) {
    for (const auto& [key, rule] : schema.items()) check_rule(schema, key, rule, value, at);
  }

  void check_rule(const json& schema, const std::string& key, const json& rule, const json& value,
                  const std::string& at) {
    static const std::set<std::string> notes = {"$schema", "title", "description", "$defs"};
    if (notes.contains(key)) return;
    if (key == "$ref")
      return check(root_.at(json::json_pointer(rule.get<std::string>().substr(1))), value, at);
    if (key == "type") {
      const json types = rule.is_array() ? rule : json::array({rule});
      if (std::none_of(types.begin(), types.end(), [&](const json& t) { return is_type(t, value); }))
        fail(at, "is not of type " + types.dump());
    } else if (key == "enum") {
      if (std::find(rule.begin(), rule.end(), value) == rule.end()) fail(at, "is none of " + rule.dump());
    } else if (key == "minimum") {
      if (value.is_number() && !(value >= rule)) fail(at, "is less than " + rule.dump());
    } else if (key == "maximum") {
      if (value.is_number() && !(value <= rule)) fail(at, "is more than " + rule.dump());
    } else if (key == "exclusiveMinimum") {
      if (value.is_number() && !(value > rule)) fail(at, "is not more than " + rule.dump());
    } else {
      check_members(schema, key, rule, value, at);
    }
  }

  void check_members(const json& schema, const std::string& key, const json& rule, const json& value,
                     const std::string& at) {
    if (key == "minItems") {
      if (value.is_array() && value.size() < rule) fail(at, "has too few items");
    } else if (key == "maxItems") {
      if (value.is_array() && value.size() > rule) fail(at, "has too many items");
    } else if (key == "items") {
      for (std::size_t k = 0; value.is_array() && k < value.size(); ++k)
        check(rule, value[k], at + "/" + std::to_string(k));
    } else if (key == "required") {
      for (const json& name : rule)
        if (value.is_object() && !value.contains(name)) fail(at, "lacks " + name.dump());
    } else if (key == "properties") {
      for (const auto& [name, member] : rule.items())
        if (value.is_object() && value.contains(name)) check(member, value[name], at + "/" + name);
    } else if (key == "additionalProperties") {
      REQUIRE(rule == false);
      for (const auto& [name, member] : value.items())
        if (!schema["properties"].contains(name)) fail(at, "has an unknown key " + name);
    } else {
      fail(at, "the schema has a keyword that this test does not know: " + key);
    }
  }

  const json& root_;
  std::vector<std::string> errors_;
};

const json& schema() {
  static const json parsed = [] {
    const auto text = read_text(std::string(tests::source_folder) + "/docs/evaluate.schema.json", 1u << 20);
    REQUIRE(text);
    return json::parse(*text);
  }();
  return parsed;
}

void check_schema(const json& value) {
  for (const std::string& error : SchemaCheck(schema()).errors(value)) FAIL_CHECK(error);
}

// An evaluation of which nothing could be measured.
Evaluation unmeasured() {
  Evaluation evaluation = synthetic();
  for (RepresentationResult& result : evaluation.representations) {
    RepresentationResult nothing;
    nothing.candidate = result.candidate;
    result = nothing;
    const double inf = std::numeric_limits<double>::infinity();
    result.motion.place_mm = {not_a_number, {not_a_number, not_a_number}};
    result.picture.depth_mm = not_a_number;
    result.sound.spectrum_db = {inf, {-inf, inf}};
    result.touch.loop_energy_mj = not_a_number;
    result.cost.picture_ms = inf;
  }
  evaluation.reference_error = {not_a_number, not_a_number};
  return evaluation;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// A page's markup, and its words without it.
struct Page {
  std::string tags, words;
};
Page split(const std::string& html) {
  Page page;
  bool inside = false;
  for (const char c : html) {
    inside = inside || c == '<';
    (inside ? page.tags : page.words) += c;
    if (c == '>') inside = false, page.words += ' ';
  }
  return page;
}

void check_page(const std::string& html) {
  const Page page = split(html);
  for (const char* request : {"src=", "href=", "url(", "http", "<script", "<link", "<iframe"})
    CHECK_MESSAGE(page.tags.find(request) == std::string::npos, request);
  const std::string style = html.substr(html.find("<style>"), html.find("</style>") - html.find("<style>"));
  for (const char* request : {"url(", "@import", "http"}) CHECK(style.find(request) == std::string::npos);
  for (const char* number : {"nan", "inf"})
    for (const char* before : {"\"", " ", "L", "M", ",", "-", "−"})
      for (const char* after : {"\"", " ", ",", "%", "L"}) {
        CHECK(page.tags.find(before + std::string(number) + after) == std::string::npos);
        CHECK(page.words.find(before + std::string(number) + after) == std::string::npos);
      }
  for (const char* element : {"table", "tbody", "tr", "section", "svg", "div", "figure", "dl"}) {
    const std::string open = std::string("<") + element, close = std::string("</") + element + ">";
    CHECK_MESSAGE(count(html, open + ">") + count(html, open + " ") == count(html, close), element);
  }
}

}  // namespace

TEST_CASE("the JSON of an evaluation is as its schema says") {
  const json value = json::parse(evaluation_json(synthetic()));
  check_schema(value);
  check_schema(json::parse(evaluation_json(unmeasured())));

  SUBCASE("the schema is strict: it admits no evaluation with a key more or less, or a wrong value") {
    const auto is_refused = [](const json& changed) {
      return !SchemaCheck(schema()).errors(changed).empty();
    };
    const json flat = value.flatten();
    std::size_t tried = 0;
    for (const auto& item : flat.items()) {
      const std::string& pointer = item.key();
      const json& leaf = item.value();
      json other = value;
      other[json::json_pointer(pointer)] = json::object();
      CHECK_MESSAGE((is_refused(other) || leaf.is_array()), pointer);
      if (const auto slash = pointer.rfind('/');
          std::isalpha(static_cast<unsigned char>(pointer[slash + 1]))) {
        other = value;
        json& parent = slash == 0 ? other : other[json::json_pointer(pointer.substr(0, slash))];
        parent.erase(pointer.substr(slash + 1));
        CHECK_MESSAGE(is_refused(other), pointer);
        parent = slash == 0 ? value : value[json::json_pointer(pointer.substr(0, slash))];
        parent["surplus"] = 1;
        CHECK_MESSAGE(is_refused(other), pointer);
      }
      if (++tried == 400) break;
    }
  }
}

TEST_CASE("numbers in JSON keep all their digits, and those that are not finite are null") {
  Evaluation evaluation = synthetic();
  RepresentationResult& relief = evaluation.representations[std::size_t(Kind::relief)];
  relief.motion.place_mm = {0.1 + 0.2, {1.0 / 3, not_a_number}};
  relief.cost.runtime_bytes = 9'007'199'254'740'993;
  const json value = json::parse(evaluation_json(evaluation));
  const json& place = value["representations"]["relief"]["motion"]["place_mm"];
  CHECK(place["value"] == 0.1 + 0.2);
  CHECK(place["interval"][0] == 1.0 / 3);
  CHECK(place["interval"][1].is_null());
  CHECK(value["representations"]["relief"]["cost"]["runtime_bytes"] == 9'007'199'254'740'993);
  const json& agreement = value["representations"]["relief"]["agreement"];
  CHECK(agreement["jnd"]["mean"] == relief.mean_jnd().value);
  CHECK(agreement["jnd"]["mean_interval"][1] == relief.mean_jnd().interval.high);
  CHECK(agreement["displayed_ms"] == relief.displayed_ms());
  CHECK(agreement["pen"]["pairs"].size() == 3);
  CHECK(agreement["pen"]["pairs"][1]["missed"] == relief.pen.all.pairs[1].missed);
  CHECK(agreement["features"] ==
        agreement["pen"]["features"].get<int>() + agreement["ball"]["features"].get<int>());
  const json nothing = json::parse(evaluation_json(unmeasured()));
  CHECK(nothing["representations"]["flat"]["agreement"]["ms"]["p50"].is_null());
  CHECK(nothing["representations"]["flat"]["sound"]["spectrum_db"]["interval"][0].is_null());
}

TEST_CASE("the page of an evaluation is whole by itself, whatever could be measured") {
  const std::string html = evaluation_html(synthetic());
  check_page(html);
  check_page(evaluation_html(unmeasured()));
  Evaluation empty = synthetic();
  empty.representations.clear();
  check_page(evaluation_html(empty));
  CHECK(html.size() < 2'000'000);
  // The recommendation comes first, then a plot of one crossing and one of all, later one of each.
  CHECK(html.find("Recommended for a synthetic texture: <b class=\"ours\">our relief</b>") <
        html.find("<svg"));
  CHECK(count(html, "<svg") == 2 + kinds);
  CHECK(html.find("intaglio evaluate &#39;a synthetic texture&#39; --quick") != std::string::npos);
}

TEST_CASE("the page escapes what comes from files and people, and the JSON quotes it") {
  const std::string hostile = "<script>alert(\"1\")</script>&'\x01\n";
  Evaluation evaluation = synthetic();
  evaluation.options.subject.texture = hostile;
  evaluation.reference = hostile;
  evaluation.notes = {hostile};
  evaluation.recommendation.reasons = {hostile};
  for (auto* list : {&evaluation.options.thresholds.times, &evaluation.options.thresholds.places})
    for (Threshold& threshold : *list) threshold.condition = threshold.source = hostile;
  evaluation.options.faults.touch.texture = "<img src=x>";
  const std::string html = evaluation_html(evaluation);
  check_page(html.substr(0, html.find("<title>")) + html.substr(html.find("</title>")));
  CHECK(html.find("<script") == std::string::npos);
  CHECK(html.find("<img") == std::string::npos);
  CHECK(html.find("With faults:") != std::string::npos);
  const json value = json::parse(evaluation_json(evaluation));
  check_schema(value);
  CHECK(value["surface"] == hostile);
  CHECK(value["thresholds"]["times"][0]["source"] == hostile);
}

TEST_CASE("equal evaluations give equal pages and JSON") {
  const Evaluation again = tests::synthetic_evaluation();
  CHECK(evaluation_html(again) == evaluation_html(synthetic()));
  CHECK(evaluation_json(again) == evaluation_json(synthetic()));
}

TEST_CASE("the page emphasises the least value of a row, and none where all print alike") {
  Evaluation evaluation = synthetic();
  for (std::size_t k = 0; k < kinds; ++k) {
    evaluation.representations[k].picture.depth_mm = 5 + double(k == 2 ? -1 : 1);
    evaluation.representations[k].picture.normal_angle = 7.0001 + 1e-7 * double(k);
  }
  const std::string html = truth_table(evaluation);
  const auto row = [&](const std::string& heading) {
    const std::size_t from = html.find("<th scope=\"row\">" + heading + "<");
    REQUIRE(from != std::string::npos);
    return html.substr(from, html.find("</tr>", from) - from);
  };
  CHECK(count(row("Depth"), " best\"") == 1);
  CHECK(row("Depth").find(" best\"><b>4.00<") != std::string::npos);
  CHECK(count(row("Normals"), " best\"") == 0);
}

TEST_CASE("displayed delays in the table are those of the summary") {
  const RepresentationResult& result = synthetic().representations[std::size_t(Kind::relief_paper)];
  std::vector<double> all;
  for (const ProbeAgreement* probe : {&result.pen, &result.ball})
    for (const FeatureCrossed& feature : probe->all.features)
      for (const PairAgreement& pair : probe->all.pairs)
        if (const auto a = feature.delay[std::size_t(pair.first)],
            b = feature.delay[std::size_t(pair.second)];
            a && b)
          all.push_back(1000 * std::abs(*a + displayed_late(pair.first) - *b - displayed_late(pair.second)));
  REQUIRE(!all.empty());
  CHECK(result.displayed_ms() == doctest::Approx(quantile(all, 0.95)));
}

TEST_CASE("the part of a crossing that is shown holds as many features as any other") {
  Traces traces;
  traces.rate = 1000;
  traces.start = 2;
  traces.distance.resize(4000);
  traces.features = {100, 1500, 3000, 3100, 3150, 3900};
  const report::Range part = busiest_part(traces, 0.5);
  CHECK(part.size() == doctest::Approx(0.5));
  CHECK(part.low < 5.0);
  CHECK(part.high > 5.15);
  const report::Range whole = busiest_part(traces, 10);
  CHECK(whole.low == 2);
  CHECK(whole.high == doctest::Approx(6));
}
