#include "evaluate/evaluation_page.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <utility>

#include "report/html.h"

namespace intaglio::evaluate {

namespace {

using report::escape_html;
using report::format_number;

constexpr double shown_seconds = 1;

constexpr std::string_view evaluation_css = R"css(
:root { --flat: #7d766e; --papers: #c26a00; --ours: #1769c2; --meshes: #2a8657; --alarm: #c22a1e; }
@media (prefers-color-scheme: dark) {
  :root { --flat: #aaa298; --papers: #eda33f; --ours: #61a8f2; --meshes: #6ccb97; --alarm: #ff7b6b; }
}
.flat { --c: var(--flat); } .papers { --c: var(--papers); } .ours { --c: var(--ours); } .meshes { --c: var(--meshes); }
h1 { overflow-wrap: anywhere; } h1 b { color: var(--c); font-weight: 650; }
.lead { color: var(--ink); margin-bottom: 10px; }
.fault { border-left: 4px solid var(--alarm); padding: 4px 0 4px 14px; margin: 18px 0; }
.hero { display: grid; grid-template-columns: minmax(0, 1.25fr) minmax(0, 1fr); gap: 24px 48px; margin-top: 30px; }
.hero h2, .smalls h3 { font-size: 16px; font-weight: 650; margin: 0 0 8px; }
.hero .key { margin: 10px 0 0; gap: 4px 20px; }
.plot .strong { font-weight: 650; }
.conflict .label:not(.strong) { paint-order: stroke; stroke: var(--paper); stroke-width: 5; stroke-linejoin: round; }
.feature { stroke: var(--grid); stroke-width: 1; }
.behind { fill: var(--paper); opacity: .86; }
.truth { fill: none; stroke: var(--soft); stroke-width: 5; opacity: .32; stroke-linejoin: round; }
.traces .curve { stroke-width: 1.7; }
.late { stroke: var(--alarm); stroke-width: 4; opacity: .7; }
.missed { stroke: var(--alarm); stroke-width: 1.8; }
.calm { fill: var(--ink); opacity: .05; } rect.chosen { fill: var(--ours); opacity: .12; }
.track { stroke: var(--grid); stroke-width: 1; }
.bar { stroke: var(--c); stroke-width: 3; opacity: .45; }
.interval { stroke: var(--c); stroke-width: 9; opacity: .38; }
.swatch { width: 24px; height: 5px; border-radius: 2px; background: var(--soft); opacity: .5; }
.swatch.line { height: 2px; background: var(--c); opacity: 1; } .swatch.tick { width: 1px; height: 15px; background: var(--soft); }
.swatch.gap { height: 4px; width: 14px; background: var(--alarm); opacity: 1; } .cross { color: var(--alarm); font-weight: 650; }
.smalls { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 244px), 1fr)); gap: 30px 32px; }
.smalls h3 { font-size: 15px; white-space: nowrap; }
.smalls h3 .dot { width: 10px; height: 10px; margin-right: 7px; }
.wide { margin-bottom: 0; }
.wide:last-child table { width: 100%; min-width: 0; }
.wide:last-child .compare { table-layout: fixed; min-width: 940px; }
.compare thead td { width: 17%; }
.compare th, .compare td { padding: 6px 10px 6px 0; line-height: 1.3; }
.compare tr:has(+ .more) > * { border-bottom: 0; }
.more th, .more td { padding-top: 0; font-size: 12px; color: var(--soft); }
.compare th[scope=row], .compare thead td { position: sticky; left: 0; background: var(--paper); font-weight: 400; white-space: normal; }
.compare thead th { color: var(--ink); font-weight: 600; vertical-align: bottom; white-space: nowrap; }
.compare thead .dot { width: 9px; height: 9px; margin-right: 6px; }
small { display: block; color: var(--soft); font-size: 12px; font-weight: 400; }
.group th, .group td { padding-top: 20px; color: var(--soft); font-size: 13px; letter-spacing: .03em; }
.group th { position: sticky; left: 0; }
.compare .chosen { background: color-mix(in srgb, var(--ours) 9%, transparent); }
.best b, b.best { font-weight: 700; text-decoration: underline 2px var(--meshes); text-underline-offset: 3px; }
.sources td:last-child { white-space: normal; min-width: 300px; } cite { color: var(--soft); }
.read { display: grid; grid-template-columns: minmax(0, 12rem) minmax(0, 1fr); gap: 8px 28px; margin: 0; max-width: 112ch; }
.read dt { font-weight: 600; } .read dd { margin: 0; }
pre { overflow-x: auto; background: var(--panel); border: 1px solid var(--rule); border-radius: 6px; padding: 12px 16px; margin: 0; }
@media screen and (max-width: 760px) {
  main { padding: 24px 16px 48px; } h1 { font-size: 27px; } .lead { font-size: 17px; } section { margin-top: 40px; }
  .hero { grid-template-columns: minmax(0, 1fr); }
  .hero .plot { font-size: 20px; } .what { display: none; } .hero .conflict { font-size: 18px; }
  .read { grid-template-columns: minmax(0, 1fr); gap: 2px; } .read dd { margin-bottom: 12px; }
  .wide:last-child .compare { min-width: 930px; } .compare thead td { width: 120px; } .compare thead th { font-size: 13px; }
}
@media print {
  .wide { overflow: visible; } .wide:last-child .compare { min-width: 0; } table { font-size: 9pt; } small { font-size: 7pt; }
  .compare th, .compare td { padding: 3px 8px 3px 0; position: static !important; white-space: normal; }
  .smalls { grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 16px 28px; }
  .smalls figure, .hero > *, .read > * { break-inside: avoid; }
  .compare thead th { white-space: normal; font-size: 7.5pt; } .compare thead .dot { display: block; margin: 0 0 2px auto; }
  section { margin-top: 28px; } section > .note { break-after: avoid; } .hero { gap: 16px 24px; }
  pre { white-space: pre-wrap; }
}
)css";

std::string phrase(Kind kind) {
  switch (kind) {
    case Kind::flat:
      return "a flat surface";
    case Kind::normal_paper:
      return "a normal map, the paper’s way";
    case Kind::normal:
      return "our normal map";
    case Kind::relief_paper:
      return "a relief, the paper’s way";
    case Kind::relief:
      return "our relief";
    case Kind::mesh_256:
      return "a coarse mesh, 256²";
    case Kind::mesh_512:
      return "a fine mesh, 512²";
  }
  return "";
}

// A sentence of what may begin in lower case and has no full stop.
std::string sentence(std::string text) {
  if (text.empty()) return text;
  text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
  if (text.back() != '.') text += '.';
  return escape_html(text);
}

std::string quoted_for_shell(const std::string& word) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./=,+:@";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command(const EvaluateOptions& options) {
  const SubjectOptions& subject = options.subject;
  std::string out = "intaglio evaluate " + quoted_for_shell(subject.texture);
  if (subject.size != 1) out += fmt::format(" --size {}", subject.size);
  if (subject.depth) out += fmt::format(" --depth {}", *subject.depth);
  if (subject.material) out += " --material " + quoted_for_shell(subject.material->name);
  if (options.seed != 1) out += fmt::format(" --seed {}", options.seed);
  if (options.quick) out += " --quick";
  if (options.wanted_runs) out += fmt::format(" --runs {}", *options.wanted_runs);
  if (const std::string faults = scene::fault_text(options.faults); !faults.empty())
    out += " --fault " + quoted_for_shell(faults);
  if (thresholds_table(options.thresholds) != thresholds_table(builtin_thresholds()))
    out += " --thresholds FILE";
  return out + " --html evaluation.html --json evaluation.json";
}

std::string section(std::string_view id, std::string_view title, std::string_view body) {
  return fmt::format("<section aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1}</h2>\n{2}</section>\n", id, title,
                     body);
}

std::string heading(const Evaluation& evaluation) {
  const EvaluateOptions& options = evaluation.options;
  const RepresentationResult& best = chosen(evaluation);
  std::string out = fmt::format("<h1>Recommended for {}: <b class=\"{}\">{}</b></h1>\n<p class=\"lead\">",
                                escape_html(options.subject.texture), family_of(best.candidate),
                                phrase(best.candidate.kind));
  for (const std::string& reason : evaluation.recommendation.reasons) out += sentence(reason) + " ";
  out += fmt::format(
      "</p>\n<p class=\"note\">How well what is seen, felt and heard of one surface agrees, in seven representations of "
      "it: {0} strokes of a pen and {0} rolls of a ball, seed {1}{2}; side {3} m, relief {4} mm deep.</p>\n",
      options.runs(), options.seed, options.quick ? ", quick" : "",
      fmt::format("{:.4g}", options.subject.size), format_number(1000 * evaluation.depth));
  if (const auto changes = scene::cue_changes(options.faults); !changes.empty()) {
    out += "<p class=\"fault\"><b>With faults:</b> ";
    for (std::size_t k = 0; k < changes.size(); ++k) out += (k > 0 ? ", " : "") + escape_html(changes[k]);
    out += ". All agreement below is of the faulty senses.</p>\n";
  }
  return out;
}

std::string hero(const Evaluation& evaluation, const report::Range& seconds) {
  const RepresentationResult& best = chosen(evaluation);
  const double whole = best.example.rate > 0 ? best.example.seconds() : 0;
  return fmt::format(
      "<div class=\"hero {}\">\n<div>\n<h2>One stroke of the pen over {}</h2>\n{}<ul class=\"key\">"
      "<li><span class=\"swatch\"></span>reference</li><li><span class=\"swatch line\"></span>delivered</li>"
      "<li><span class=\"swatch tick\"></span>a feature is crossed</li><li><span class=\"dot\"></span>where it is "
      "delivered</li><li><span class=\"swatch gap\"></span>too late or too early</li><li><span class=\"cross\">×</span>"
      "missed</li></ul>\n<p class=\"note\">{} s of {} s; medians at the right are of the whole stroke.</p>\n</div>\n"
      "<div>\n<h2>Conflict between the senses</h2>\n{}<p class=\"note\">Mean difference x of two senses; 1 is what "
      "people just notice. Thick: 95 % interval over the runs.</p>\n</div>\n</div>\n",
      family_of(best.candidate), phrase(best.candidate.kind),
      trace_plot(best, evaluation.options.thresholds, seconds), format_number(seconds.size(), 1),
      format_number(whole, 1), conflict_plot(evaluation));
}

std::string small_traces(const Evaluation& evaluation, const report::Range& part) {
  std::string out =
      "<p>As above, with the same features; each family of representations has its colour.</p>\n<div "
      "class=\"smalls\">\n";
  for (const RepresentationResult& result : evaluation.representations)
    out += fmt::format("<figure class=\"{}\"><h3><span class=\"dot\"></span>{}</h3>\n{}</figure>\n",
                       family_of(result.candidate), escape_html(result.candidate.title),
                       trace_plot(result, evaluation.options.thresholds, part, {.width = 300, .lane = 56}));
  return out + "</div>\n";
}

// Each metric in a sentence, with its threshold and source.
constexpr std::pair<std::string_view, std::string_view> readings[] = {
    {"x",
     "Two senses present one feature dt apart in time and ds apart in the hand; x = √((dt/T)² + (ds/S)²), with T and S "
     "the thresholds of the pair below. At 1 people just notice; a feature that a sense misses counts 3, a "
     "convention of ours."},
    {"Missed",
     "Around the feature, what the sense delivers correlates less than 0.5 with the reference at every lag within "
     "±100 ms, or hardly varies. Criteria of ours."},
    {"False alarms",
     "The sound is excited strongly where no feature lies within 100 ms. A criterion of ours."},
    {"Features with x ≥ 1",
     "The share of features at which people notice that at least two senses disagree."},
    {"Depth, normals, silhouette",
     "Pictures beside those of the reference from steep to grazing: depth along the view (root mean "
     "square), angle of the normals that the shading shows, and pixels that only one of "
     "them covers. No threshold holds for all scenes."},
    {"FLIP",
     "How different two pictures look in turn at one place, 0 to 1: Andersson et al., FLIP, Proc. ACM CGIT 3(2), "
     "2020. It has no threshold."},
    {"Place and height after 0.1 s",
     "How far a ball is from the reference’s 0.1 s after both started in one state (root mean "
     "square). One arcminute, which acuity 1.0 resolves (ISO 8596), is 0.2 mm at 0.7 m."},
    {"Contact normals",
     "Angle between the deepest contact’s normal and the reference’s. No threshold is known to us."},
    {"Force",
     "Root mean square of the difference of the forces on the hand. People notice from about 7 % of a force (Pang, Tan and "
     "Durlach 1991): 0.07 N at a load of 1 N."},
    {"Force direction",
     "People tell directions apart from 25.6° by touch alone and 18.4° with a picture that agrees (Barbagli, "
     "Salisbury, Ho, Spence and Tan 2006)."},
    {"Buzz",
     "Force above 100 Hz beyond the reference’s: what the hand feels as a vibration that the surface does not have."},
    {"Vibration spectrum",
     "Distance of the energies in nine bands from 10 to 500 Hz, of which arXiv 2605.23804 finds that they predict "
     "judged realism best; the edges are ours."},
    {"Vibration intensity",
     "Steps of 20 %, the least that is noticed (Forta, Griffin and Morioka 2012), between the intensities "
     "that two channels feel (Hollins and Roy 1996)."},
    {"Energy of a closed loop",
     "What the hand gains on a closed path. Above 0 the surface feeds the hand, and can buzz by "
     "itself."},
    {"Sound: spectrum",
     "Root mean square of level differences in Zwicker’s 24 critical bands (Zwicker 1961), at equal loudness of the "
     "whole. No threshold holds for all sounds."},
    {"Sound: loudness",
     "Distance of loudness over time, after ISO 532-1. 1 sone is the loudness of 1 kHz at 40 dB."},
    {"As displayed",
     "Half of a frame of 60 Hz and half of a picture for what is seen, 1 ms for touch, and two blocks of 256 samples "
     "at 44.1 kHz for sound."},
};

std::string how_to_read() {
  std::string out = "<dl class=\"read\">\n";
  for (const auto& [metric, text] : readings) out += fmt::format("<dt>{}</dt><dd>{}</dd>\n", metric, text);
  return out + "</dl>\n";
}

std::string reference_text(const Evaluation& evaluation) {
  std::string out = fmt::format(
      "<p>{} Half the grid differs by {} µm (root mean square), half the motion’s rate by {} mm after 0.1 s: smaller "
      "differences mean nothing.</p>\n",
      sentence(evaluation.reference), format_number(evaluation.reference_error.height_um),
      format_number(evaluation.reference_error.motion_mm));
  if (!evaluation.notes.empty()) {
    out += "<ul>\n";
    for (const std::string& note : evaluation.notes) out += fmt::format("<li>{}</li>\n", sentence(note));
    out += "</ul>\n";
  }
  return out;
}

}  // namespace

std::string evaluation_html(const Evaluation& evaluation) {
  const EvaluateOptions& options = evaluation.options;
  std::string out = report::page_head("How well the senses agree: " + options.subject.texture,
                                      std::string(report::report_css) + std::string(evaluation_css));
  if (evaluation.representations.empty())
    return out + "<h1>Nothing was measured</h1>\n" + std::string(report::page_end);
  const report::Range part = busiest_part(chosen(evaluation).example, shown_seconds);
  out += heading(evaluation) + hero(evaluation, part);
  out += section("agreement", "Do the senses agree?", agreement_table(evaluation));
  out += section("truth", "Is each sense true?", truth_table(evaluation));
  out += section("cost", "What does it cost?", cost_table(evaluation));
  out += section("traces", "The same stroke in all representations", small_traces(evaluation, part));
  out += section("read", "How to read it", how_to_read());
  out += section(
      "thresholds", "Thresholds that ruled",
      "<p>What people just notice between two senses; the spread is that of studies and conditions.</p>\n" +
          thresholds_table(options.thresholds));
  out += section("reference", "Reference and import", reference_text(evaluation));
  out += section(
      "again", "Make this page again",
      fmt::format(
          "<pre><code>{}</code></pre>\n<p class=\"note\">It took {} s. All but computing times is the "
          "same again. “The paper” is Sterling and Lin, Integrated multimodal interaction using "
          "texture representations, 2016.</p>\n",
          escape_html(command(options)), format_number(evaluation.seconds, 0)));
  return out + std::string(report::page_end);
}

}  // namespace intaglio::evaluate
