// The parts of an evaluation's page: plots and tables as HTML, each complete without a script or a request to
// others.
//
// One colour names one family of representations everywhere: flat, the paper's, ours, meshes. Values that are
// not finite are printed as "–". Pure functions; any thread; a whole page takes some milliseconds and 0.5 MB.
#pragma once

#include <string>

#include "evaluate/evaluation.h"
#include "report/axis.h"

namespace intaglio::evaluate {

// CSS class: "flat", "papers", "ours" or "meshes".
const char* family_of(const Candidate& candidate);

// The representation that is recommended; the first one if that was not measured. There must be one.
const RepresentationResult& chosen(const Evaluation& evaluation);

// Mean x of each representation with its interval, and the threshold.
std::string conflict_plot(const Evaluation& evaluation);

// The part of a crossing that plots show: `seconds` of it (or all), where it crosses most features.
report::Range busiest_part(const Traces& traces, double seconds);

struct TracePlotSize {
  double width = 560, lane = 92;  // drawing units; below 400 wide lanes have short names
};
// The output of each sense in the representation's example over the reference, one lane a sense; vertical
// lines where features are crossed, and in each lane where the sense delivers them.
std::string trace_plot(const RepresentationResult& result, const Thresholds& thresholds,
                       const report::Range& seconds, const TracePlotSize& size = {});

std::string truth_table(const Evaluation& evaluation);
std::string agreement_table(const Evaluation& evaluation);
std::string cost_table(const Evaluation& evaluation);
std::string thresholds_table(const Thresholds& thresholds);

}  // namespace intaglio::evaluate
