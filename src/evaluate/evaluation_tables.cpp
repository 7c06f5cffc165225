#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "evaluate/evaluation_page.h"
#include "report/html.h"

namespace intaglio::evaluate {

namespace {

using report::escape_html;
using report::format_number;

// As printed: three digits, but nothing finer than a thousandth of the unit.
std::string figure_text(double value) {
  if (value != 0 && std::abs(value) < 0.001) return value > 0 ? "< 0.001" : "> −0.001";
  return format_number(value);
}

struct Cell {
  double value = 0;
  std::string text, small;  // HTML
};

Cell cell(double value, std::string small = {}) {
  return {value, figure_text(value), std::move(small)};
}

Cell cell(const Measured& measured) {
  const std::string low = figure_text(measured.interval.low), high = figure_text(measured.interval.high);
  const bool is_known = std::isfinite(measured.interval.low) && low != high;
  return cell(measured.value, is_known ? fmt::format("{} – {}", low, high) : "");
}

// With two decimals, as in the plot of conflict.
Cell x_cell(const Measured& x) {
  const std::string low = format_number(x.interval.low, 2), high = format_number(x.interval.high, 2);
  const bool is_known = std::isfinite(x.interval.low) && low != high;
  return {x.value, format_number(x.value, 2), is_known ? fmt::format("{} – {}", low, high) : ""};
}

Cell count_cell(std::size_t count) {
  return {double(count), std::to_string(count), ""};
}

using CellOf = std::function<Cell(const RepresentationResult&)>;

enum class Best { none, least };

// A table with a column for each representation.
class ComparisonTable {
 public:
  ComparisonTable(const Evaluation& evaluation, std::string_view caption) : evaluation_(evaluation) {
    out_ = fmt::format(
        "<p class=\"note\">{}</p>\n<div class=\"wide\" tabindex=\"0\">\n<table class=\"compare\">\n<thead><tr><td></td>",
        caption);
    for (const RepresentationResult& result : evaluation.representations) {
      const std::string title = escape_html(result.candidate.title);
      const std::size_t comma = title.find(", ");
      out_ += fmt::format("<th scope=\"col\" class=\"figure {}{}\"><span class=\"dot\"></span>{}{}</th>",
                          family_of(result.candidate), mark(result), title.substr(0, comma),
                          comma == std::string::npos ? "" : "<small>" + title.substr(comma + 2) + "</small>");
    }
    out_ += "</tr></thead>\n";
  }

  void group(std::string_view name) {
    out_ += fmt::format(
        "{}<tbody>\n<tr class=\"group\"><th scope=\"colgroup\">{}</th><td colspan=\"{}\"></td></tr>\n",
        is_open_ ? "</tbody>\n" : "", name, evaluation_.representations.size());
    is_open_ = true;
  }

  // `unit` in small print below the heading. The least of the values, and what prints alike, is emphasised.
  void row(std::string_view heading, std::string_view unit, const CellOf& cell_of, Best best = Best::least) {
    const std::string small = unit.empty() ? "" : fmt::format("<small>{}</small>", unit);
    add(fmt::format("<tr><th scope=\"row\">{}{}</th>", heading, small), cell_of, best);
  }

  // Continues the row above it, in small print.
  void more(std::string_view heading, const CellOf& cell_of) {
    add(fmt::format("<tr class=\"more\"><th scope=\"row\">{}</th>", heading), cell_of, Best::none);
  }

  std::string finish() { return std::move(out_) + (is_open_ ? "</tbody>\n" : "") + "</table>\n</div>\n"; }

 private:
  void add(const std::string& start, const CellOf& cell_of, Best best) {
    std::vector<Cell> cells;
    for (const RepresentationResult& result : evaluation_.representations) cells.push_back(cell_of(result));
    const std::string least = best == Best::least ? least_text(cells) : "";
    out_ += start;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const Cell& one = cells[k];
      const bool is_best = !least.empty() && one.text == least;
      out_ += fmt::format("<td class=\"figure{}{}\">{}{}</td>", mark(evaluation_.representations[k]),
                          is_best ? " best" : "", is_best ? "<b>" + one.text + "</b>" : one.text,
                          one.small.empty() ? "" : "<small>" + one.small + "</small>");
    }
    out_ += "</tr>\n";
  }

  std::string_view mark(const RepresentationResult& result) const {
    return &result == &chosen(evaluation_) ? " chosen" : "";
  }

  // Empty when all print alike: then none is best.
  static std::string least_text(const std::vector<Cell>& cells) {
    const Cell* least = nullptr;
    bool differ = false;
    for (const Cell& one : cells) {
      if (!std::isfinite(one.value)) continue;
      differ = differ || (least != nullptr && one.text != least->text);
      if (least == nullptr || one.value < least->value) least = &one;
    }
    return differ ? least->text : "";
  }

  const Evaluation& evaluation_;
  std::string out_;
  bool is_open_ = false;
};

template <class Part>
CellOf measured(Part RepresentationResult::*part, Measured Part::*value) {
  return [=](const RepresentationResult& result) { return cell(result.*part.*value); };
}

const PairAgreement* pair_of(const ProbeAgreement& probe, Sense first, Sense second) {
  const auto& pairs = probe.all.pairs;
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const PairAgreement& pair) {
    return pair.first == first && pair.second == second;
  });
  return found == pairs.end() ? nullptr : &*found;
}

Cell pair_cell(const PairAgreement* pair) {
  if (pair == nullptr) return cell(std::numeric_limits<double>::quiet_NaN());
  const std::string apart = pair->ms.empty()
                                ? ""
                                : fmt::format("{} ms<br>{} mm<br>", format_number(quantile(pair->ms, 0.5), 2),
                                              format_number(quantile(pair->mm, 0.5), 2));
  const double value = mean(pair->jnd);
  return {value, format_number(value, 2), fmt::format("{}{} missed", apart, pair->missed)};
}

// Median of the features that both senses deliver.
Cell displayed_cell(const ProbeAgreement& probe, Sense first, Sense second) {
  std::vector<double> all;
  for (const FeatureCrossed& feature : probe.all.features) {
    const auto a = feature.delay[std::size_t(first)], b = feature.delay[std::size_t(second)];
    if (a && b) all.push_back(1000 * std::abs(*a + displayed_late(first) - *b - displayed_late(second)));
  }
  return {quantile(all, 0.5), format_number(quantile(all, 0.5), 2), ""};
}

void add_probe(ComparisonTable& table, const Evaluation& evaluation,
               ProbeAgreement RepresentationResult::*probe, const std::string& name) {
  table.group(name);
  table.row(
      "Features crossed", "", [&](const auto& r) { return count_cell((r.*probe).all.features.size()); },
      Best::none);
  // The pairs that any representation has, in their order.
  std::vector<std::pair<Sense, Sense>> pairs;
  for (const RepresentationResult& result : evaluation.representations)
    for (const PairAgreement& pair : (result.*probe).all.pairs)
      if (const std::pair key(pair.first, pair.second);
          std::find(pairs.begin(), pairs.end(), key) == pairs.end())
        pairs.push_back(key);
  for (const auto& [first, second] : pairs) {
    table.row(fmt::format("{} and {}", name_of(first), name_of(second)), "x, median ms and mm",
              [&, a = first, b = second](const auto& r) { return pair_cell(pair_of(r.*probe, a, b)); });
    table.more("as displayed, ms",
               [&, a = first, b = second](const auto& r) { return displayed_cell(r.*probe, a, b); });
  }
  table.row("False alarms", "", [&](const auto& r) { return count_cell((r.*probe).all.false_alarms); });
}

}  // namespace

Cell percent_cell(double fraction) {
  return cell(100 * fraction);
}

// A share that did not rest is not an error by itself: it says how many the rows below are of.
void add_rest(ComparisonTable& table) {
  const auto of = [](Measured RestTruth::*value) {
    return [=](const RepresentationResult& r) { return cell(r.motion.rest.*value); };
  };
  table.row(
      "Rest, bodies that do", "% after 3 s",
      [](const auto& r) {
        return Cell{r.motion.rest.all.at_rest, percent_cell(r.motion.rest.all.at_rest).text,
                    fmt::format("of {}", r.motion.rest.all.bodies)};
      },
      Best::none);
  table.row("Rest, height", "mm", of(&RestTruth::height_mm));
  table.row("Rest, tilt", "degrees, boxes and hulls", of(&RestTruth::tilt));
  table.row("Rest, sunk over 1 mm", "%", [](const auto& r) { return percent_cell(r.motion.rest.all.sunk); });
  table.row("Rest, creep", "mm in 0.5 s", of(&RestTruth::creep_mm));
}

void add_sounds(ComparisonTable& table, const std::string& name, SoundsTruth SoundTruth::*sounds) {
  const auto of = [=](Measured SoundsTruth::*value) {
    return [=](const RepresentationResult& r) { return cell(r.sound.*sounds.*value); };
  };
  table.row(name + ", onsets", "missed + false", [=](const RepresentationResult& r) {
    const SoundsTruth& s = r.sound.*sounds;
    return Cell{double(s.missed + s.false_alarms), fmt::format("{} + {}", s.missed, s.false_alarms),
                fmt::format("of {}", s.onsets)};
  });
  table.row(name + ", onsets apart", "ms", of(&SoundsTruth::late_ms));
  table.row(name + ", intervals", "ms", of(&SoundsTruth::intervals_ms));
  if (sounds != &SoundTruth::striking) return;
  table.row(name + ", decay", "|ln T1/T2|, noticed from 0.05", of(&SoundsTruth::decay));
  table.row(name + ", spectrum", "dB, gain ignored", of(&SoundsTruth::spectrum_db));
  table.row(name + ", loudness", "sone", of(&SoundsTruth::loudness_sone));
}

std::string truth_table(const Evaluation& evaluation) {
  ComparisonTable table(
      evaluation,
      "Differences from the reference: 0 is true. Small print: 95 % intervals of the mean over the "
      "runs. <b class=\"best\">Marked</b>: the least of a row.");
  const auto percent = [](double fraction) {
    const double value = 100 * fraction;
    return Cell{value, format_number(value, value < 10 ? 2 : 1), ""};
  };
  table.group("Picture");
  table.row("Depth", "mm", [](const auto& r) { return cell(r.picture.depth_mm); });
  table.row("Normals", "degrees", [](const auto& r) { return cell(r.picture.normal_angle); });
  table.row("Silhouette", "% of pixels", [&](const auto& r) { return percent(r.picture.silhouette); });
  table.row("FLIP", "0 to 1", [](const auto& r) { return cell(r.picture.flip); });
  using Result = RepresentationResult;
  table.group("Motion");
  table.row("Ball, place after 0.1 s", "mm", measured(&Result::motion, &MotionTruth::place_mm));
  table.row("Ball, height after 0.1 s", "mm", measured(&Result::motion, &MotionTruth::height_mm));
  table.row("Ball, contact normals", "degrees", measured(&Result::motion, &MotionTruth::normal_angle));
  const auto add_body = [&](const char* name, BodyTruth MotionTruth::*body) {
    const auto of = [=](Measured BodyTruth::*value) {
      return [=](const Result& r) { return cell(r.motion.*body.*value); };
    };
    const std::string heading = name;
    table.row(heading + ", place after 0.1 s", "mm", of(&BodyTruth::place_mm));
    table.row(heading + ", height after 0.1 s", "mm", of(&BodyTruth::height_mm));
    table.row(heading + ", turn after 0.1 s", "degrees", of(&BodyTruth::turn));
    table.row(heading + ", contact normals", "degrees", of(&BodyTruth::normal_angle));
  };
  add_body("Box", &MotionTruth::box);
  add_body("Hull", &MotionTruth::hull);
  table.row("Energy gained by rolling", "%", [](const auto& r) {
    const Measured s = r.motion.gained_share;
    return cell(Measured{100 * s.value, {100 * s.interval.low, 100 * s.interval.high}});
  });
  add_rest(table);
  table.group("Touch");
  table.row("Force", "N", measured(&Result::touch, &TouchTruth::force_n));
  table.row("Force direction", "degrees", measured(&Result::touch, &TouchTruth::direction));
  table.row("Buzz above 100 Hz", "N", measured(&Result::touch, &TouchTruth::buzz_n));
  table.row("Vibration spectrum", "dB, nine bands", measured(&Result::touch, &TouchTruth::bands_db));
  table.row("Vibration intensity", "noticeable steps",
            measured(&Result::touch, &TouchTruth::intensity_steps));
  table.row("Pacinian channel", "noticeable steps", measured(&Result::touch, &TouchTruth::pacinian_steps));
  table.row("Non-Pacinian channel", "noticeable steps",
            measured(&Result::touch, &TouchTruth::non_pacinian_steps));
  // A loop that takes energy from the hand is as good as any other that does.
  table.row("Energy of a closed loop", "mJ, passive up to 0", [](const auto& r) {
    const double energy = r.touch.loop_energy_mj;
    return energy <= 0 ? Cell{0, "passive", figure_text(energy)} : cell(energy);
  });
  table.group("Sound");
  table.row("Spectrum", "dB, gain ignored", measured(&Result::sound, &SoundTruth::spectrum_db));
  table.row("Loudness", "sone", measured(&Result::sound, &SoundTruth::loudness_sone));
  add_sounds(table, "Striking", &SoundTruth::striking);
  add_sounds(table, "Scraping", &SoundTruth::scraping);
  add_sounds(table, "Rolling", &SoundTruth::rolling);
  return table.finish();
}

std::string agreement_table(const Evaluation& evaluation) {
  ComparisonTable table(
      evaluation,
      "Differences between the senses of one representation. x = 1 is what people just notice; a feature that a "
      "sense misses counts 3. Each pair has two rows: as computed, and with what a screen of 60 Hz, a device and "
      "a sound card add. <b class=\"best\">Marked</b>: the least of a row.");
  table.group("Pen and ball");
  table.row("Mean x", "just noticeable differences", [](const auto& r) { return x_cell(r.mean_jnd()); });
  table.row("Features with x ≥ 1", "%", [](const auto& r) {
    const Measured s = r.score();
    return cell(Measured{100 * s.value, {100 * s.interval.low, 100 * s.interval.high}});
  });
  const auto percentiles = [](double p50, double p95) {
    return cell(p50, std::isfinite(p95) ? "p95 " + figure_text(p95) : "");
  };
  table.row("Time apart", "ms, median",
            [&](const auto& r) { return percentiles(r.percentile_ms(0.5), r.percentile_ms(0.95)); });
  table.more("as displayed, p95, ms", [](const auto& r) {
    return Cell{r.displayed_ms(), format_number(r.displayed_ms(), 1), ""};
  });
  table.row("Way apart", "mm of the hand, median",
            [&](const auto& r) { return percentiles(r.percentile_mm(0.5), r.percentile_mm(0.95)); });
  table.row("Missed by a sense", "", [](const auto& r) { return count_cell(r.missed()); });
  table.row("False alarms", "", [](const auto& r) { return count_cell(r.false_alarms()); });
  add_probe(table, evaluation, &RepresentationResult::pen, "A pen in a hand");
  add_probe(table, evaluation, &RepresentationResult::ball, "A rolling ball");
  return table.finish();
}

std::string cost_table(const Evaluation& evaluation) {
  ComparisonTable table(evaluation,
                        "Computing time of one core and memory. Small print: multiples of our relief's.");
  const auto& all = evaluation.representations;
  const auto ours = std::find_if(all.begin(), all.end(),
                                 [](const auto& result) { return result.candidate.kind == Kind::relief; });
  using Value = std::function<double(const RepresentationResult&)>;
  const auto add = [&](std::string_view heading, std::string_view unit, const Value& value) {
    table.row(heading, unit, [&](const RepresentationResult& result) {
      const double own = value(result), base = ours == all.end() ? 0 : value(*ours);
      const bool is_known =
          base > 0 && own > 0 && std::isfinite(own / base) && result.candidate.kind != Kind::relief;
      return cell(own, is_known ? "×&#8239;" + format_number(own / base, own < 10 * base ? 2 : 0) : "");
    });
  };
  table.group("At run time");
  add("A picture", "ms, 1024 × 1024", [](const auto& r) { return r.cost.picture_ms; });
  add("A step of motion", "µs", [](const auto& r) { return r.cost.motion_us; });
  add("A tick of touch", "µs", [](const auto& r) { return r.cost.touch_us; });
  add("A block of sound", "µs, 64 samples", [](const auto& r) { return r.cost.sound_us; });
  add("Memory", "MB", [](const auto& r) { return 1e-6 * double(r.cost.runtime_bytes); });
  add("Graphics memory", "MB", [](const auto& r) { return 1e-6 * double(r.picture.device_bytes); });
  table.group("Once");
  add("Import or mesh", "s", [](const auto& r) { return r.cost.offline_s; });
  return table.finish();
}

std::string thresholds_table(const Thresholds& thresholds) {
  std::string out =
      "<div class=\"wide\" tabindex=\"0\">\n<table class=\"sources\">\n<thead><tr><th scope=\"col\">Senses</th>"
      "<th scope=\"col\">First</th><th scope=\"col\" class=\"figure\">Threshold</th><th scope=\"col\" "
      "class=\"figure\">Spread</th><th scope=\"col\">Condition and source</th></tr></thead>\n<tbody>\n";
  const auto add = [&](const Threshold& threshold, const char* unit) {
    const auto text = [](double value) { return format_number(1000 * value); };
    out += fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"figure\">{} {}</td><td class=\"figure\">{} – {}</td>"
        "<td>{}. <cite>{}</cite></td></tr>\n",
        name_of(threshold.pair), name_of(threshold.first), text(threshold.value), unit, text(threshold.low),
        text(threshold.high), escape_html(threshold.condition), escape_html(threshold.source));
  };
  for (const Threshold& time : thresholds.times) add(time, "ms");
  for (const Threshold& place : thresholds.places) add(place, "mm");
  return out + "</tbody>\n</table>\n</div>\n";
}

}  // namespace intaglio::evaluate
