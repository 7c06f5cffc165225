#include <vector>

#include "core/file.h"
#include "intaglio/report.h"
#include "report/inspect_page.h"
#include "report/report.h"
#include "session/api.h"
#include "surface/inspect.h"

namespace intaglio {

Result<void> save_report(const Recording& recording, const std::filesystem::path& html,
                         const ReportOptions& options) {
  std::vector<std::uint8_t> video;
  if (!options.video.empty()) {
    auto bytes = read_file(options.video);
    if (!bytes) return tl::unexpected(bytes.error());
    video = std::move(*bytes);
  }
  return write_file(html, report::report_html(recording.impl().recording, video));
}

Result<void> save_texture_page(const std::filesystem::path& texture, const std::filesystem::path& html) {
  const auto found = surface::inspect(texture, {});
  if (!found) return tl::unexpected(found.error());
  return write_file(html, report::inspection_html(*found, texture.filename().string()));
}

Result<std::string> texture_json(const std::filesystem::path& texture) {
  return surface::inspect(texture, {}).map([](const surface::Inspection& found) {
    return report::inspection_json(found);
  });
}

}  // namespace intaglio
